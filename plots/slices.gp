# Azimuth slices through point targets, one panel a target, one line an image.
#
# Variables:  output   the PNG to write
#             title    above the picture
#             panels   array: title of each panel
#             lines    array: label of each line
#             data     text file: for each panel, for each line a block of "position (m)  power (dB)", blocks
#                      separated by two empty lines
#             plots    folder of style.gp (default "plots")
# By hand:    gnuplot -e "output='a.png'; title='A'; array panels[1] = ['target 0']; array lines[1] = ['bp_sinc']; \
#                         data='a.txt'" plots/slices.gp

if (!exists("plots")) plots = "plots"
columns = |panels| == 1 ? 1 : |panels| <= 4 ? 2 : |panels| <= 6 ? 3 : 4
rows = (|panels| + columns - 1)/columns
key_columns = columns == 1 ? 2 : columns
key_rows = (|lines| + key_columns - 1)/key_columns
bottom = 90 + 26*key_rows
width = |panels| == 1 ? 1200 : 40 + 600*columns
height = |panels| == 1 ? 720 + bottom : bottom + 450*rows
load plots."/style.gp"
set output output

# Show what matters: all panels out to the last place where a line is above -30 dB, with a dozen points a line.
stats data using ($2 > -30 ? abs($1) : NaN) name "shown" nooutput
extent = exists("shown_max") && shown_max > 0 ? 1.15*shown_max : 1
stats data using (abs($1) <= extent && $2 == $2 ? 1 : NaN) name "sample" nooutput
point_interval = (exists("sample_records") ? sample_records : 0)/(12*|panels|*|lines|)

set multiplot layout rows,columns title title font ",16" offset 0,-0.4 \
    margins screen 95.0/width, screen 1 - 30.0/width, screen 1.0*bottom/height, screen 1 - 90.0/height \
    spacing screen 105.0/width, screen 115.0/height
set xlabel "azimuth from target (m)"
set ylabel "power relative to peak (dB)"
set xrange [-extent:extent]
set yrange [-60:3]
set xtics tic_step(1.5*extent)
set ytics 10
set key at screen 0.5, screen 12.0/height center bottom maxrows key_rows    # one legend for all, below the panels
do for [p = 1:|panels|] {
    set title panels[p] offset 0,-0.5
    plot for [l = 1:|lines|] data index (p - 1)*|lines| + l - 1 with linespoints linetype l \
        pointinterval point_interval + l title lines[l]
    unset key
}
unset multiplot
unset output
