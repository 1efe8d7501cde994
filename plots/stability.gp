# Digits lost by every algorithm (columns) on every scene (rows), the worst of rounding modes and targets. Grey: refused; red frame:
# the image degrades; red: it fails.
#
# By hand:    gnuplot -c plots/stability.gp results/stability/stability.csv
# Variables:  csv      what `stability` wrote: the same algorithms for every scene
#             output   the picture, PNG or SVG (default: beside the CSV, .png); footer: below it (default: none)
#             plots    folder of the scripts

if (!exists("plots")) plots = "plots"
if (!exists("csv")) csv = ARGC >= 1 ? ARG1 : "results/stability/stability.csv"
if (csv[1:1] ne "/") csv = "./".csv                    # one that begins with '<' would be a command
if (!exists("output")) output = csv[1:strlen(csv) - 4].".png"
if (!exists("footer")) footer = ""
width = 1400
height = 900
load plots."/style.gp"
set datafile separator comma
set datafile columnheaders

# Rows and columns are counted: a new scene begins a row.
last = ""
row = -1
column_count = 0
place(scene) = scene eq last ? (column_now = column_now + 1, row) : (last = scene, column_now = 0, row = row + 1, row)
short(scene) = scene[(strstrt(scene, "extreme/") == 1 ? 9 : 1):*]
name(algorithm, options, precision) = algorithm.(options eq "" ? "" : ":".options).(precision eq "double" ? " double" : "")
kind(verdict) = verdict[1:5] eq "works" ? 0 : verdict[1:7] eq "refused" ? 2 : verdict[1:5] eq "fails" ? 3 : 1
why(verdict) = strstrt(verdict, ": ") ? verdict[strstrt(verdict, ": ") + 2:*] : ""
load plots."/quote.gp"
set table $cells separator tab
plot without_commas(csv) using (place(strcol("scene"))):(column_now):(strcol("digits") eq "" ? "none" : strcol("digits")):(kind(strcol("verdict"))): \
    (short(strcol("scene"))):(name(strcol("algorithm"), commas(strcol("options")), strcol("precision"))): \
    (why(strcol("verdict"))):(" ") with table
unset table
unset datafile columnheaders
set datafile separator tab
digits(text) = text[1:1] eq "n" ? NaN : real(text)
stats $cells using 1:2 name "cells" nooutput
rows = cells_max_x + 1
columns = cells_max_y + 1

width = columns < 9 ? 820 : 350 + 52*columns            # room for the title, and for the colour bar's labels
height = 575 + 22*(rows < 9 ? 9 : rows)
set terminal pngcairo noenhanced size width,height font "DejaVu Sans,12" background "#ffffff"
if (svg) { set terminal svg noenhanced size width,height dynamic font "DejaVu Sans,Verdana,sans-serif,12" background "#ffffff" }
set output output
set label 1 footer at screen 0.5,screen 14.0/height center font ",10" textcolor "#606060"
set title "Digits lost against the method's own sum in extended precision\n(grey: refused, red frame: degrades, red: fails, white: no digits are assessed)"
set lmargin at screen 190.0/width
set rmargin at screen 1 - 130.0/width
set tmargin at screen 1 - 65.0/height
set bmargin at screen 485.0/height
set xrange [-0.5:columns - 0.5]
set yrange [rows - 0.5:-0.5]
set cbrange [-3:3]
set cblabel "digits lost"
set colorbox user origin screen 1 - 110.0/width, screen 485.0/height size screen 20.0/width, screen 1 - 550.0/height
unset key
unset grid
set xtics rotate by 90 right
set style fill solid 1 noborder
box(k) = column(4) == k
# A label that is not wanted is empty: gnuplot crashes where a plot has none at all.
number(text) = text[1:1] eq "n" ? "" : sprintf("%.1f", real(text))
plot $cells using 2:1:($2 - 0.48):($2 + 0.48):($1 - 0.46):($1 + 0.46):(column(4) < 2 ? digits(strcol(3)) : NaN) \
        with boxxyerror linecolor palette, \
    "" using 2:(box(2) ? column(1) : NaN):($2 - 0.48):($2 + 0.48):($1 - 0.46):($1 + 0.46) with boxxyerror linecolor rgb "#d8d8d8", \
    "" using 2:(box(3) ? column(1) : NaN):($2 - 0.48):($2 + 0.48):($1 - 0.46):($1 + 0.46) with boxxyerror linecolor rgb "#d00000", \
    "" using 2:(box(1) ? column(1) : NaN):($2 - 0.48):($2 + 0.48):($1 - 0.46):($1 + 0.46) with boxxyerror fillstyle empty \
        border linecolor rgb "#d00000" linecolor rgb "#d00000" linewidth 2 dashtype 1, \
    "" using 2:1:(column(4) < 2 ? number(strcol(3)) : "") with labels font ",9" textcolor rgb "#ffffff", \
    "" using 2:1:(box(2) ? strcol(7)[1:9] : "") with labels font ",7" textcolor rgb "#404040", \
    "" using 2:1:(box(3) ? strcol(7)[1:9] : "") with labels font ",7" textcolor rgb "#ffffff", \
    "" using 2:1:(" "):xtic(6):ytic(5) with labels
unset output
