# Phase errors of the spectra's formulas against azimuth wavenumber, one panel a range, one line a formula.
#
# Variables:  output   the PNG to write
#             title    above the picture
#             panels   array: title of each panel
#             lines    array: label of each line
#             data     text file: for each panel, for each line a block of "wavenumber (1/m)  error (rad)", blocks
#                      separated by two empty lines
#             plots    folder of style.gp (default "plots")
# By hand:    gnuplot -e "output='a.png'; title='A'; array panels[1] = ['50 m']; array lines[1] = ['pca']; \
#                         data='a.txt'" plots/phase.gp

if (!exists("plots")) plots = "plots"
columns = |panels| == 1 ? 1 : 2
rows = (|panels| + columns - 1)/columns
bottom = 145
width = |panels| == 1 ? 1200 : 40 + 600*columns
height = |panels| == 1 ? 720 + bottom : bottom + 450*rows
load plots."/style.gp"
set output output

stats data using 1 name "x" nooutput
stats data using (abs($2)) name "y" nooutput
extent = y_max > 0 ? 1.1*y_max : 1

set multiplot layout rows,columns title title font ",16" offset 0,-0.4 \
    margins screen 110.0/width, screen 1 - 30.0/width, screen 1.0*bottom/height, screen 1 - 90.0/height \
    spacing screen 120.0/width, screen 115.0/height
set xlabel "azimuth wavenumber f/v (1/m)"
set ylabel "phase error (rad)"
set xrange [x_min:x_max]
set yrange [-extent:extent]
set xtics tic_step(x_max - x_min)
set ytics tic_step(2*extent)
set key at screen 0.5, screen 12.0/height center bottom maxrows 2           # one legend for all, below the panels
do for [p = 1:|panels|] {
    set title panels[p] offset 0,-0.5
    plot for [l = 1:|lines|] data index (p - 1)*|lines| + l - 1 with lines linetype l + 1 title lines[l], \
        for [bound = 1:(extent > pi/4 ? 2 : 0)] (bound == 1 ? 1 : -1)*pi/4 with lines linewidth 1 dashtype 3 linecolor rgb "#606060" \
            title (bound == 1 ? "pi/4" : "")
    unset key
}
unset multiplot
unset output
