# The papers' question: which upsampling rate is enough? Error and ISLR against the rate, with BP22's rule (Eq. 20),
# ZP15's lambda/8 rule, the error laws and the lines that `sweep` fitted. show/plot_results.c writes what it draws.
#
# Variables:  title, footer, $rows (run_s error low high rate islr), series[], algorithms[], member[], precise[]   as of error_time.gp
#             rated[]              1 for a series that has rates
#             has_lobes, reference_islr      of the exact image
#             has_rules, bp22_rate, zp15_rate, edge_phase, linear_floor
#             has_slopes, $slopes (rate error, two for each line), $slope_labels (rate error slope, 1 for a floor)

width = 1000
rate_title = "samples for each one recorded, K = beta + 1 or factor"
panels = has_lobes ? 2 : 1
height = 45 + 420*panels + 150
load plots."/style.gp"
colour(k) = family_colour[family_drawn(algorithms[k])]
point(k) = precise[k] ? family_open[family_drawn(algorithms[k])] : family_filled[family_drawn(algorithms[k])]
slope_text(slope, floored) = sprintf(floored > 0 ? "floor, slope %.2f" : "slope %.2f", slope)
set output output
set label 1 footer at screen 0.5,12.0/height center font ",10" textcolor "#606060"
set multiplot
stats $rows using 5 name "x" nooutput
stats $rows using ($5 == $5 ? $2 : NaN) name "y" nooutput
set logscale x 2
set xrange [0.9:1.25*x_max]
set xtics 2
set lmargin at screen 125.0/width
set rmargin at screen 1 - 25.0/width
if (bp22_rate > 0) {
    set arrow 1 from bp22_rate,graph 0 to bp22_rate,graph 1 nohead dashtype 2 linecolor "#000000"
    set label 2 sprintf(" BP22 Eq. (20): K > %.3g", bp22_rate) at bp22_rate,graph 0.04 font ",11"
}
if (has_rules) {
    set arrow 2 from zp15_rate,graph 0 to zp15_rate,graph 1 nohead dashtype 4 linecolor "#000000"
    set label 3 sprintf(" ZP15, lambda/8: K > %.3g", zp15_rate) at zp15_rate,graph 0.1 font ",11"
}
if (panels == 1) { set xlabel rate_title }
set tmargin at screen 1 - 45.0/height
set bmargin at screen 1 - 400.0/height
set title title.": the upsampling rate"
set key at screen 0.5,135.0/height center top maxrows 5 samplen 4 font ",12"
set logscale y
set format y "1e%T"
set yrange [y_min/2:1]
set ylabel "relative L2 error of the complex image"
plot for [once = 1:has_rules] edge_phase/x with lines linewidth 1 dashtype 3 linecolor rgb "#000000" \
        title "phase at the band's edge, pi B/(2 fs K)", \
    for [once = 1:has_rules] linear_floor with lines linewidth 1 dashtype 5 linecolor rgb "#000000" \
        title "linear's floor, pi^2 (B/fs)^2/(12 sqrt 5)", \
    for [k = 1:|series|] $rows index k - 1 using (rated[k] ? $5 : NaN):2 with linespoints \
        linecolor rgb colour(k) linewidth (precise[k] ? 1 : 1.8) dashtype 1 + member[k]%5 \
        pointtype point(k) \
        pointsize (precise[k] ? 2.2 : 1.4) title (precise[k] || !rated[k] ? "" : series[k]), \
    for [once = 1:has_slopes] $slopes using 1:2 with lines linewidth 1 dashtype 1 linecolor rgb "#000000" \
        title "fitted lines", \
    for [once = 1:has_slopes] $slope_labels using 1:2:(slope_text($3, $4)) with labels font ",11" offset 1,1 left notitle, \
    keyentry with points pointtype 6 linewidth 1 pointsize 1.2 linecolor rgb "#000000" \
        title "open, large: in double", \
    keyentry with lines linetype 1 title (panels == 2 ? "the exact image's ISLR" : "")
if (panels == 2) {
    unset key
    unset title
    unset label
    unset logscale y
    set autoscale y
    set format y "%g"
    set xlabel rate_title
    set ylabel "ISLR (dB)"
    set tmargin at screen 1 - 465.0/height
    set bmargin at screen 1 - 820.0/height
    plot reference_islr with lines linetype 1, \
        for [k = 1:|series|] $rows index k - 1 using (rated[k] ? $5 : NaN):6 with linespoints \
            linecolor rgb colour(k) linewidth (precise[k] ? 1 : 1.8) dashtype 1 + member[k]%5 \
            pointtype point(k) \
            pointsize (precise[k] ? 2.2 : 1.4)
}
unset multiplot
unset output
