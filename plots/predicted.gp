# Errors as predicted before any plan against the measured ones, a point an image; on the line they are the same, below it the
# prediction is too low.
#
# By hand:    gnuplot -c plots/predicted.gp results/sweep/predicted.csv
# Variables:  csv      predicted.csv of `sweep` or `reproduce`
#             output   the picture, PNG or SVG (default: beside the CSV, .png); footer: below it (default: none)
#             plots    folder of the scripts

if (!exists("plots")) plots = "plots"
if (!exists("csv")) csv = ARGC >= 1 ? ARG1 : "results/sweep/predicted.csv"
if (csv[1:1] ne "/") csv = "./".csv                    # one that begins with '<' would be a command
if (!exists("output")) output = csv[1:strlen(csv) - 4].".png"
if (!exists("footer")) footer = ""
width = 1000
height = 900
load plots."/style.gp"
set datafile separator comma
set datafile columnheaders
set output output
seen = " "                                              # the algorithms' numbers
note(number) = strstrt(seen, sprintf(" %d ", number)) ? 1 : (seen = seen.sprintf("%d ", number), 1)
stats csv using (note(family_drawn(strcol("algorithm"))) ? column("error_gain") : NaN):(column("predicted")) name "errors" nooutput
low = errors_min_x < errors_min_y ? errors_min_x : errors_min_y
high = errors_max_x > errors_max_y ? errors_max_x : errors_max_y
set label 1 footer at screen 0.5,14.0/height center font ",10" textcolor "#606060"
set bmargin 6
set title "Predicted and measured errors"
set xlabel "measured error after one gain"
set ylabel "predicted error"
set logscale xy
set format xy "%.0e"
set xrange [low/1.5:high*1.5]
set yrange [low/1.5:high*1.5]
set key outside right top
is(k) = family_drawn(strcol("algorithm")) == k
plot x with lines linecolor rgb "#404040" linewidth 1.2 title "the same", 2*x with lines linecolor rgb "#909090" dashtype 2 title "twice", \
    for [k = 1:|family_colour|] csv using (is(k) ? column("error_gain") : NaN):(column("predicted")) with points \
    linecolor rgb family_colour[k] pointtype family_open[k] pointsize 1.1 title strstrt(seen, sprintf(" %d ", k)) == 0 ? "" : k <= |family_names| ? family_names[k] : "others"
unset output
