# An image in decibels below its peak, one panel a patch, and beside or below each its difference to the exact image. Both axes
# have one scale, unless that would leave less than a third of the panel: then the label states how many times one is stretched.
#
# Variables:  output   the picture to write, PNG or SVG
#             title    above the picture; footer: below it
#             panels   array: a file for each patch, 4-byte floats as gnuplot's `binary matrix`: the number of columns, the azimuth
#                      of each column (m), then for each row its range (m) and its values (dB); for curves: blocks "place dB"
#             shapes   array: "image", or "rows" or "columns" where each of the few is a curve; curves: how many
#             x_low, x_high, r_low, r_high   arrays: edges of the patch (m); turned: whether its axes are not those of the track
#             x_origin, r_origin   arrays: what to add to the places in `panels` and `differences` (m), 0 unless floats lose pixels
#             targets  array: files "x r name"; target_count: how many lie in the patch
#             range_db shown below the peak
#             has_differences, differences   files as `panels`; dB relative to the exact image's peak; difference_top: the largest
#             plots    folder of style.gp (default "plots")

if (!exists("plots")) plots = "plots"
count = |panels|
kinds = has_differences ? 2 : 1                         # rows of panels for each row of patches
beside = count == 1
columns = beside ? kinds : count < 4 ? count : 4
rows = beside ? 1 : kinds*((count + columns - 1)/columns)
panel_width = columns == 1 ? 900 : columns == 2 ? 560 : columns == 3 ? 420 : 340
panel_height = columns == 1 ? 720 : rows == 1 ? 560 : 330
between_x = beside ? 270 : 100                          # room for the colour bar of each panel, or for labels
between_y = 85
# Further pixels for the long labels of places far from the origin.
long(low, high) = abs(high) < 2e4*(high - low) ? 0 : 10*(ceil(log10(abs(high)/(high - low))) - 4)
long_x = 0
long_r = 0
do for [k = 1:count] {
    if (long(x_low[k], x_high[k]) > long_x) { long_x = long(x_low[k], x_high[k]) }
    if (long(r_low[k], r_high[k]) > long_r) { long_r = long(r_low[k], r_high[k]) }
}
left_most = 130 + long_r
between_x = between_x + long_r
width = left_most + columns*panel_width + (columns - 1)*between_x + 150
height = 75 + rows*panel_height + (rows - 1)*between_y + 95
load plots."/style.gp"
set output output

sideways(place) = place/(1.0*width)
upwards(place) = 1 - place/(1.0*height)                 # pixels from the top
least(a, b) = a < b ? a : b

set multiplot title title font ",16" offset 0,-0.4
set label 1 footer at screen 0.5, screen 14.0/height center font ",10" textcolor "#606060"
unset grid
do for [k = 1:count] {
    do for [kind = 1:kinds] {
        column_here = beside ? kind - 1 : (k - 1)%columns
        row_here = beside ? 0 : kinds*((k - 1)/columns) + kind - 1
        left = left_most + column_here*(panel_width + between_x)
        top = 75 + row_here*(panel_height + between_y)
        name = kind == 1 ? panels[k] : differences[k]
        high_db = kind == 1 ? 0 : difference_top
        low_db = high_db - range_db
        extent_x = 1.0*(x_high[k] - x_low[k])             # edges that are whole numbers are integers to gnuplot
        extent_r = 1.0*(r_high[k] - r_low[k])
        # Pixels a metre, of each axis if it filled the panel.
        scale_x = panel_width/extent_x
        scale_r = panel_height/extent_r
        metric = scale_x < 3*scale_r && scale_r < 3*scale_x
        if (metric) { scale_x = least(scale_x, scale_r); scale_r = scale_x }
        drawn_width = shapes[k] eq "image" ? extent_x*scale_x : panel_width
        drawn_height = shapes[k] eq "image" ? extent_r*scale_r : panel_height
        inset_x = (panel_width - drawn_width)/2
        inset_r = (panel_height - drawn_height)/2
        set lmargin at screen sideways(left + inset_x)
        set rmargin at screen sideways(left + inset_x + drawn_width)
        set tmargin at screen upwards(top + inset_r)
        set bmargin at screen upwards(top + inset_r + drawn_height)
        stretch_x = metric || scale_x <= scale_r ? "" : sprintf(", stretched %.2g times", scale_x/scale_r)
        stretch_r = metric || scale_r <= scale_x ? "" : sprintf(", stretched %.2g times", scale_r/scale_x)
        x_title = (turned[k] ? "turned azimuth x' (m)" : "azimuth x (m)")
        r_title = (turned[k] ? "turned range r' (m)" : "range r (m)")
        db_title = kind == 1 ? (beside ? "dB relative to the peak of this image" : "dB relative to the image's peak") : (beside ? "difference to reference, dB relative to its peak" : "difference, dB of reference's peak")
        if (shapes[k] eq "image") {
            set xlabel x_title.stretch_x offset 0,0.3
            set ylabel (beside || column_here == 0 ? r_title.stretch_r : "")
            set xrange [x_low[k]:x_high[k]]
            set yrange [r_low[k]:r_high[k]]
            step_x = tic_step(extent_x*panel_width/drawn_width/(columns > 2 ? 0.7 : 1))
            step_r = tic_step(extent_r*panel_height/drawn_height)
            set xtics step_x
            set ytics step_r
            set format x tic_format(x_low[k], x_high[k], step_x)
            set format y tic_format(r_low[k], r_high[k], step_r)
            set cbrange [low_db:high_db]
            set format cb "%g"
            set cbtics 10
            if (beside || column_here == columns - 1 || k == count) {
                set cblabel db_title font ",11"
                set colorbox user origin sideways(left + panel_width - (beside ? inset_x : 0) + 18 + long_x), screen upwards(top + panel_height) \
                    size sideways(20), screen panel_height/(1.0*height)
            } else { unset colorbox; unset cblabel }
            places = x_origin[k] == 0 && r_origin[k] == 0 ? "" : " using ($1 + x_origin[k]):($2 + r_origin[k]):3"
            names = target_count[k] == 0 ? "" : ", targets[k] using 1:2 with points pointtype 6 pointsize 2.2 linewidth 1.2 " \
                ."linecolor '#ffffff' notitle, targets[k] using 1:2:3 with labels left offset 1.2,0.6 font ',11' " \
                ."textcolor '#ffffff' notitle"
            set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb "#b8b8b8" linewidth 0  # pixels without a value
            eval "plot name binary matrix".places." with image notitle".names
        } else {
            along_x = shapes[k] eq "rows"
            set xlabel (along_x ? x_title : r_title) offset 0,0.3
            set ylabel (kind == 1 ? "dB relative to the peak" : "difference to reference, dB of its peak")
            set xrange [(along_x ? x_low[k] : r_low[k]):(along_x ? x_high[k] : r_high[k])]
            set yrange [low_db:high_db + 3]
            step = tic_step((along_x ? extent_x : extent_r)/(columns > 2 ? 0.7 : 1))
            set xtics step
            set format x (along_x ? tic_format(x_low[k], x_high[k], step) : tic_format(r_low[k], r_high[k], step))
            set ytics 10
            set format y "%g"
            set grid
            first = along_x ? r_low[k] : x_low[k]
            step = (along_x ? extent_r : extent_x)/curves[k]
            plot for [c = 1:curves[k]] name index c - 1 using 1:2 with lines linetype c + 1 dashtype 1 \
                title sprintf("%s = %.10g m", along_x ? "r" : "x", first + (c - 0.5)*step)
            unset grid
        }
        unset label 1
        unset object 1
    }
}
unset multiplot
unset output
