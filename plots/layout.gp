# Where the targets of a simulated scene lie: the paper's filled, those that were added open.
#
# Variables:  csv      target,x_m,r_m,added; the first line names the columns
#             output   the picture, PNG or SVG; footer: below it (default: none)
#             plots    folder of style.gp (default "plots")
# By hand:    gnuplot -e "csv='figure-lbf21_f13.csv'; output='a.png'" plots/layout.gp

if (!exists("plots")) plots = "plots"
if (csv[1:1] ne "/") csv = "./".csv                    # one that begins with '<' would be a command
if (!exists("footer")) footer = ""
width = 1000
height = 640
load plots."/style.gp"
set output output
set datafile separator comma
stats csv using 3 name "r" nooutput
stats csv using 2 name "x" nooutput
room(low, high) = 0.12*(high - low) + 0.5
set xrange [r_min - room(r_min, r_max):r_max + room(r_min, r_max)]
set yrange [x_min - room(x_min, x_max):x_max + room(x_min, x_max)]
set xlabel "range r (m)"
set ylabel "azimuth x (m)"
set bmargin at screen 130.0/height
set key at screen 0.5, 30.0/height center bottom maxrows 1
set label 1 footer at screen 0.5, 14.0/height center font ",10" textcolor "#606060"
plot csv using ($4 == 0 ? $3 : NaN):2 with points pointtype 7 pointsize 1.6 linecolor rgb "#000000" title "of the paper, as our scenes place them", \
    csv using ($4 == 0 ? $3 : NaN):2:1 with labels offset 0,1 notitle, \
    csv using ($4 == 1 ? $3 : NaN):2 with points pointtype 6 pointsize 1.6 linecolor rgb "#000000" title "added"
unset output
