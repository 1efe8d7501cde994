# Error against run time of one scene: a point for each setting, a line through each series, the Pareto front, the scalar reference loop's
# time. show/plot_results.c writes what it draws.
#
# Variables:  title, footer        texts
#             panel_width, panel_height, x_low, x_high, y_low, y_high     the panel: pixels, and its axes
#             $rows                a block for each series: run_s error, quartiles of run_s
#             series[], algorithms[], member[], precise[], counts[]   of each: texts; which of its algorithm's; 1 for double; points
#             $front               run_s error
#             control_s            the scalar reference loop's time, or NaN
#             $labels, names[]     x y (of the panel) series; from the point, x y and how far it is, where a line leads there

entries = 2                                            # of the legend, which only series of several points need
longest = 27
do for [k = 1:|series|] {
    if (precise[k] || counts[k] < 2) { continue }
    entries = entries + 1
    longest = strlen(series[k]) > longest ? strlen(series[k]) : longest
}
has_legend = entries > 2
across = longest < 45 ? int(1000/(55.5 + 9.9*longest)) : 1     # as gnuplot reckons a sign at this size of font
legend_rows = has_legend ? (entries + 2 + across - 1)/across : 1
if (panel_height < 25*legend_rows) { panel_height = 25*legend_rows }     # gnuplot makes no more rows than fit beside the plot
below = 130 + 22.5*legend_rows
width = 110 + panel_width + 25
height = int(95 + panel_height + below)
load plots."/style.gp"
do for [k = 1:|series|] { family = family_drawn(algorithms[k]); member[k] = 1 + member[k]%5; algorithms[k] = family }
colour(k) = family_colour[algorithms[k]]
point(k) = precise[k] ? family_open[algorithms[k]] : family_filled[algorithms[k]]
set output output
set logscale xy
set format x "%g"
set format y "1e%T"
set xtics ()
eval log_tics
eval short_tics(y_low, y_high)
set xrange [x_low:x_high]
set yrange [y_low:y_high]
set xlabel "median run time, echoes to image (s)"
set ylabel "relative L2 error of the complex image"
set title title.": error against run time"
scale = control_s == control_s ? control_s : 1
set logscale x2                                        # the same axis as speed-up, above
set x2range [scale/x_low:scale/x_high]
if (control_s == control_s) {
    set x2tics ()                                      # gnuplot finds none by itself on an axis that falls
    do for [decade = -9:9] { set x2tics add (10.0**decade) }
    set format x2 "%gx"
    set x2label "speed-up over the scalar reference loop"
}
set lmargin at screen 110.0/width
set rmargin at screen 1 - 25.0/width
set tmargin at screen 1 - 95.0/height
set bmargin at screen below/height
set key at screen 0.5,(below - 75)/height center top maxrows legend_rows samplen 2.5 font ",12"
set label 1 footer at screen 0.5,14.0/height center font ",10" textcolor "#606060"
if (control_s == control_s) { set arrow 1 from control_s,graph 0 to control_s,graph 1 nohead dashtype 3 linewidth 1.5 }
at_x(share) = x_low*(x_high/x_low)**share
at_y(share) = y_low*(y_high/y_low)**share
plot $front using (scale/$1):2 axes x2y1 with points pointtype 0 notitle, \
    $front using 1:2 with steps linetype 1 linewidth 5 title "Pareto front", \
    $labels using (at_x($4)):(at_y($5)):(at_x($4 + $6) - at_x($4)):(at_y($5 + $7) - at_y($5)) with vectors nohead \
        linewidth 0.8 dashtype 1 linecolor rgb "#a0a0a0" notitle, \
    for [k = 1:|series|] $rows index k - 1 using 1:2:3:4 with xerrorbars pointtype 0 \
        linewidth 1 dashtype 1 linecolor rgb colour(k) notitle, \
    for [k = 1:|series|] $rows index k - 1 using 1:2 with linespoints \
        linecolor rgb colour(k) linewidth (precise[k] ? 1 : 1.8) dashtype member[k] \
        pointtype point(k) pointsize (precise[k] ? 1 : 1.4) title (precise[k] || counts[k] < 2 ? "" : series[k]), \
    for [k = 1:|series|] $labels using (at_x($1)):($3 == k ? at_y($2) : NaN):(names[int($0) + 1]) with labels font ",10" \
        left textcolor rgb colour(k) notitle, \
    keyentry with points pointtype 6 linewidth 1 pointsize 1.2 linecolor rgb "#000000" title (has_legend ? "open, thin: in double" : ""), \
    keyentry with lines linewidth 1.5 dashtype 3 linecolor rgb "#000000" title (control_s == control_s ? "dots: scalar reference loop" : ""), \
    keyentry with lines linewidth 1 dashtype 1 linecolor rgb "#000000" title "bars: quartiles of the runs"
unset output
