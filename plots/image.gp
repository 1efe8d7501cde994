# An image in decibels below its peak, one panel a patch.
#
# Variables:  output   the PNG to write
#             title    above the picture
#             panels   array: a file for each patch, 4-byte floats as gnuplot's `binary matrix`: the number of
#                      columns, the azimuth of each column (m), then for each row its range (m) and its values (dB)
#             plots    folder of style.gp (default "plots")
# By hand:    gnuplot -e "output='a.png'; title='A'; array panels[1] = ['a.bin']" plots/image.gp

if (!exists("plots")) plots = "plots"
columns = |panels| == 1 ? 1 : |panels| <= 4 ? 2 : |panels| <= 6 ? 3 : 4
rows = (|panels| + columns - 1)/columns
width = |panels| == 1 ? 1200 : 160 + 550*columns
height = |panels| == 1 ? 950 : 110 + 450*rows
load plots."/style.gp"
set output output

# All lengths in pixels, from the left and from the bottom.
set multiplot layout rows,columns title title font ",16" offset 0,-0.4 \
    margins screen 130.0/width, screen 1 - 130.0/width, screen 75.0/height, screen 1 - 65.0/height \
    spacing screen 135.0/width, screen 85.0/height
set xlabel "azimuth x (m)"
set ylabel "range r (m)"
set cbrange [-60:0]
set format cb "%g dB"
set cbtics 10
set colorbox user origin screen 1 - 100.0/width, screen 75.0/height size screen 22.0/width, screen 1 - 140.0/height
unset grid
set autoscale xfix
set autoscale yfix
do for [k = 1:|panels|] {
    stats panels[k] binary matrix using 1 name "x" nooutput
    stats panels[k] binary matrix using 2 name "r" nooutput
    set xtics tic_step(x_max - x_min)
    set ytics tic_step(r_max - r_min)
    plot panels[k] binary matrix with image notitle
    unset colorbox                         # one for all
}
unset multiplot
unset output
