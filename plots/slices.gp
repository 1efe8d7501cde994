# Azimuth slices through point targets, one panel a target, one line an image; below each the difference to the exact image. An
# algorithm has its own colour and point (families.gp); another setting of it is dashed otherwise.
#
# Variables:  output   the picture to write
#             title    above the picture
#             panels   array: title of each panel
#             lines    array: label of each line; algorithms: whose colour it has; footer: below the picture
#             data     array: for each panel, for each line a text file of "position (m)  power (dB)  difference (dB)"
#             has_differences   whether there are any; difference_top: the upper end of their axis (dB)
#             extent   what is shown on either side of a target (m); point_interval: places of a line for each point
#             plots    folder of style.gp (default "plots")
# By hand:    gnuplot -e "output='a.png'; title='A'; array panels[1] = ['target 0']; array lines[1] = ['bp_sinc']; \
#                         array algorithms[1] = ['bp_sinc']; footer=''; has_differences=0; difference_top=0; extent=1; \
#                         point_interval=50; array data[1] = ['a.txt']" plots/slices.gp

if (!exists("plots")) plots = "plots"
columns = |panels| == 1 ? 1 : |panels| <= 4 ? 2 : |panels| <= 6 ? 3 : 4
rows = (|panels| + columns - 1)/columns
key_columns = columns == 1 ? 2 : columns
key_rows = (|lines| + key_columns - 1)/key_columns
panel_width = columns == 1 ? 1050 : 500
upper = columns == 1 ? 560 : 300
lower = has_differences ? (columns == 1 ? 260 : 170) : 0
between = has_differences ? 22 : 0
panel_height = upper + between + lower
bottom = 108 + 26*key_rows
width = 120 + columns*panel_width + (columns - 1)*95
height = 85 + rows*panel_height + (rows - 1)*115 + bottom
load plots."/style.gp"
set output output

# The lines of an algorithm's further settings.
array kind[|lines|]
array member[|lines|]
do for [l = 1:|lines|] {
    kind[l] = family_drawn(algorithms[l])
    member[l] = 0
    do for [k = 1:l - 1] { if (kind[k] == kind[l]) { member[l] = member[l] + 1 } }
}
colour(l) = kind[l] == 1 ? "#b8b8b8" : family_colour[kind[l]]        # pale and broad: what lies on it stays visible
wide(l) = kind[l] == 1 ? 5 : 1.6
dash(l) = (family_dash[kind[l]] - 1 + member[l])%5 + 1
point(l) = kind[l] == 1 ? 0 : family_open[kind[l]]

set multiplot title title font ",16" offset 0,-0.4
set label 1 footer at screen 0.5, screen 14.0/height center font ",10" textcolor "#606060"
set xrange [-extent:extent]
set xtics tic_apart(1.5*extent, 2*extent, panel_width)
do for [p = 1:|panels|] {
    left = 105 + ((p - 1)%columns)*(panel_width + 95)
    top = 85 + ((p - 1)/columns)*(panel_height + 115)
    set lmargin at screen left/(1.0*width)
    set rmargin at screen (left + panel_width)/(1.0*width)
    set tmargin at screen 1 - top/(1.0*height)
    set bmargin at screen 1 - (top + upper)/(1.0*height)
    set title panels[p] offset 0,-0.5
    set yrange [-60:3]
    set ytics 10
    set ylabel "power relative to peak (dB)"
    if (has_differences) { unset xlabel; set format x "" } else { set xlabel "azimuth from target (m)" }
    if (p == 1) { set key at screen 0.5, screen 30.0/height center bottom maxrows key_rows } else { unset key }   # one legend for all
    plot for [l = 1:|lines|] data[(p - 1)*|lines| + l] using 1:2 with linespoints linecolor rgb colour(l) \
        linewidth wide(l) dashtype dash(l) pointtype point(l) pointsize 1.2 pointinterval point_interval + l title lines[l]
    unset label 1
    if (has_differences) {
        unset key
        unset title
        set format x "%g"
        set xlabel "azimuth from target (m)"
        set ylabel "difference (dB)"
        set tmargin at screen 1 - (top + upper + between)/(1.0*height)
        set bmargin at screen 1 - (top + panel_height)/(1.0*height)
        set yrange [difference_top - 80:difference_top]
        set ytics 20
        plot for [l = 1:|lines|] data[(p - 1)*|lines| + l] using 1:3 with linespoints linecolor rgb colour(l) \
            linewidth wide(l) dashtype dash(l) pointtype point(l) pointsize 1.2 pointinterval point_interval + l notitle
    }
}
unset multiplot
unset output
