# The one style of every picture: terminal, fonts, lines, grid, tics and colour map. Load it before anything else of a
# picture; what another picture left set is forgotten.
#
# Variables:  width, height   of the picture in pixels (default 1200 x 900)
#             format          "png" or "svg" (default: as the name in `output` ends)

reset
if (!exists("width")) { width = 1200 }
if (!exists("height")) { height = 900 }
# gnuplot takes an output that begins with '|' for a command.
if (exists("output")) { if (output[1:1] ne "/") { output = "./".output } }
if (exists("format")) { svg = format eq "svg" } else { svg = exists("output") && output[strlen(output) - 3:*] eq ".svg" }
set encoding utf8
if (svg) {
    set terminal svg noenhanced size width,height dynamic font "DejaVu Sans,Verdana,sans-serif,13" background "#ffffff"
} else {
    set terminal pngcairo noenhanced size width,height font "DejaVu Sans,13" background "#ffffff"
}

# Lines for greyscale and the colour-blind: lightness, dash and point all differ. The first
# is broad and pale, so that a reference stays visible below the lines that lie on it.
set linetype 1 linecolor "#b8b8b8" linewidth 5.0 dashtype 1 pointtype 0
set linetype 2 linecolor "#000000" linewidth 1.4 dashtype 1 pointtype 7 pointsize 1.0
set linetype 3 linecolor "#0072b2" linewidth 1.8 dashtype (12,4) pointtype 4 pointsize 1.3
set linetype 4 linecolor "#d55e00" linewidth 1.8 dashtype (6,3) pointtype 8 pointsize 1.5
set linetype 5 linecolor "#009e73" linewidth 1.8 dashtype (12,3,3,3) pointtype 6 pointsize 1.3
set linetype 6 linecolor "#cc79a7" linewidth 1.8 dashtype (3,3) pointtype 12 pointsize 1.5
set linetype 7 linecolor "#56b4e9" linewidth 1.8 dashtype (16,4,2,4,2,4) pointtype 2 pointsize 1.3
set linetype 8 linecolor "#e69f00" linewidth 1.8 dashtype (2,4) pointtype 1 pointsize 1.3
set linetype 9 linecolor "#7b3294" linewidth 1.8 dashtype (9,3,9,3,2,3) pointtype 10 pointsize 1.5
set linetype 10 linecolor "#8c510a" linewidth 1.8 dashtype (4,2,1,2) pointtype 14 pointsize 1.3
set linetype cycle 10

load plots."/families.gp"

set border linecolor "#404040"
set grid linecolor "#d0d0d0" linewidth 1 dashtype 1
set tics nomirror out
set key Left reverse samplen 4 spacing 1.2

# A step of 1, 2 or 5 times a power of ten that divides `extent` into about five.
tic_decade(extent) = 10**floor(log10(extent/5.0))
tic_step(extent) = tic_decade(extent)*(extent < 7.5*tic_decade(extent) ? 1 : extent < 15*tic_decade(extent) ? 2 : \
    extent < 37.5*tic_decade(extent) ? 5 : 10)
# As many digits as distinguish tics: six, more far from the origin.
tic_digits(farthest, step) = farthest < 1e5*step ? 6 : ceil(log10(farthest/step)) + 1
tic_format(low, high, step) = sprintf("%%.%dg", tic_digits(abs(low) > abs(high) ? abs(low) : abs(high), step))
# tic_step(extent), or the next longer one where its labels would collide on an axis of `span` drawn on so many pixels.
tic_decimals(step) = step < 1 ? ceil(-log10(step) - 1e-9) : 0
tic_collide(step, span, pixels) = span/step*(8*(tic_decimals(step) + 3) + 12) > pixels
tic_apart(extent, span, pixels) = tic_step(tic_collide(tic_step(extent), span, pixels) ? 2*extent : extent)
# Decimal tics at 1, 2 and 5 of each decade.
log_tics = "do for [decade = -9:15] { set xtics add (10.0**decade, 2*10.0**decade, 5*10.0**decade) }"
# The same on a short axis of powers of ten, which would have one label or none: eval short_tics(least, most).
short_tics(least, most) = most > 20*least ? "" : "do for [decade = -12:2] { do for [digit in '2 5'] { " \
    ."set ytics add (sprintf('%se%d', digit, decade) digit*10.0**decade) } }"

# Perceptually uniform, and monotone in lightness so that it reads in greyscale (viridis).
set palette defined ( \
    0 "#440154", 1 "#482878", 2 "#3e4989", 3 "#31688e", 4 "#26828e", 5 "#1f9e89", \
    6 "#35b779", 7 "#6ece58", 8 "#b5de2b", 9 "#fde725")
