# Phase errors of the spectra's formulas against azimuth wavenumber, one panel a range, one line a formula.
#
# Variables:  output   the PNG to write
#             title    above the picture
#             panels   array: title of each panel
#             lines    array: label of each line; algorithms: whose colour it has; printed: the largest error that a paper prints, 0 for none
#             footer   below the picture
#             data     array: for each panel, for each line a text file of "wavenumber (1/m)  error (rad)"
#             plots    folder of style.gp (default "plots")
# By hand:    gnuplot -e "output='a.png'; title='A'; array panels[1] = ['50 m']; array lines[1] = ['pca']; \
#                         array algorithms[1] = ['rma_pca']; array printed[1] = [0]; footer=''; array data[1] = ['a.txt']" plots/phase.gp

if (!exists("plots")) plots = "plots"
columns = |panels| == 1 ? 1 : 2
rows = (|panels| + columns - 1)/columns
bottom = 185
width = |panels| == 1 ? 1200 : 40 + 600*columns
height = |panels| == 1 ? 720 + bottom : bottom + 450*rows
load plots."/style.gp"
set output output

x_low = 0
x_high = 0
largest = 0
do for [b = 1:|data|] {
    stats data[b] using 1 name "place" nooutput         # which forgets all variables place_*
    stats data[b] using ($2 == $2 ? abs($2) : 0) name "error" nooutput
    if (place_min < x_low) { x_low = place_min }
    if (place_max > x_high) { x_high = place_max }
    if (error_max > largest) { largest = error_max }
}
array member[|lines|]
do for [l = 1:|lines|] {
    if (printed[l] > largest) { largest = printed[l] }
    member[l] = 0
    do for [k = 1:l - 1] { if (algorithms[k] eq algorithms[l]) { member[l] = member[l] + 1 } }
}
extent = largest > 0 ? 1.1*largest : 1
colour(l) = family_colour[family_drawn(algorithms[l])]
dash(l) = (family_dash[family_drawn(algorithms[l])] - 1 + member[l])%5 + 1
label(l) = lines[l].(printed[l] > 0 ? sprintf("; paper: up to %.3g rad", printed[l]) : "")

set multiplot layout rows,columns title title font ",16" offset 0,-0.4 \
    margins screen 110.0/width, screen 1 - 30.0/width, screen 1.0*bottom/height, screen 1 - 90.0/height \
    spacing screen 120.0/width, screen 115.0/height
set xlabel "azimuth wavenumber f/v (1/m)"
set ylabel "phase error (rad)"
set xrange [x_low:x_high]
set yrange [-extent:extent]
set xtics tic_step(x_high - x_low)
set ytics tic_step(2*extent)
set key at screen 0.5, screen 30.0/height center bottom maxrows 3           # one legend for all, below the panels
set label 1 footer at screen 0.5, screen 14.0/height center font ",10" textcolor "#606060"
do for [p = 1:|panels|] {
    set title panels[p] offset 0,-0.5
    plot for [l = 1:|lines|] data[(p - 1)*|lines| + l] using 1:2 with lines linecolor rgb colour(l) linewidth 1.8 dashtype dash(l) title label(l), \
        for [l = 1:|lines|] for [side = -1:(printed[l] > 0 ? 1 : -2):2] side*printed[l] with lines linewidth 1 linecolor rgb colour(l) dashtype 3 \
            notitle, \
        for [bound = 1:(extent > pi/4 ? 2 : 0)] (bound == 1 ? 1 : -1)*pi/4 with lines linewidth 1 dashtype 3 linecolor rgb "#606060" \
            title (bound == 1 ? "pi/4" : "")
    unset key
    unset label 1
}
unset multiplot
unset output
