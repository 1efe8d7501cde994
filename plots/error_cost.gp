# The body of error_time.gp and error_flops.gp.
#
# Variables:  cost         column of the rows that scene.awk prints: 2 run time, 3 FLOPs
#             cost_title   the axis's title
#             name, plots  as in folder.gp

width = 1000
load plots."/folder.gp"
do for [picture = 1:pictures] {
    load read(picture_scene[picture])
    if (!has_points) { continue }
    output = picture_output[picture]
    others = cost == 2 ? 4 : 2
    panel_px = 520
    load plots."/legend.gp"
    height = int(170 + panel_px + legend_px)
    load plots."/style.gp"
    set output output
    set logscale xy
    set format x (cost == 2 ? "%g" : "%.0s %c")
    set format y "1e%T"
    set xtics ()
    eval log_tics
    stats $rows using cost name "x" nooutput
    stats $control using (cost == 2 ? $1 : x_max) name "control" nooutput
    stats $rows using 4 name "y" nooutput
    set yrange [y_min/1.6:1.6*y_max]
    eval short_tics(y_min, y_max)
    set xrange [x_min/1.3:1.4*(control_max > x_max ? control_max : x_max)]
    set xlabel cost_title
    set ylabel "relative L2 error of the complex image"
    set title picture_scene[picture].": error against ".(cost == 2 ? "run time" : "counted operations")
    set lmargin at screen 110.0/width
    set rmargin at screen 1 - 25.0/width
    set tmargin at screen 1 - 45.0/height
    set bmargin at screen (125 + legend_px)/height
    set key at screen 0.5,(50 + legend_px)/height center top maxrows legend_rows samplen 2.5 font ",12"
    set label 1 caption at screen 0.5,12.0/height center font ",10" textcolor "#606060"
    front = cost == 2 ? "$front_run_s" : "$front_flops"
    if (cost == 2) { set arrow 1 from control_max,graph 0 to control_max,graph 1 nohead dashtype 3 linewidth 1.5 }
    plot front using 1:2 with lines linetype 1 linewidth 7 title "Pareto front", \
        for [k = 1:|series|] $rows index k - 1 using cost:4 with linespoints \
            linecolor rgb family_colour[family[k]] linewidth (precise[k] ? 1 : 1.8) dashtype 1 + (member[k] - 1)%5 \
            pointtype (precise[k] ? family_open[family[k]] : family_filled[family[k]]) \
            pointsize (precise[k] ? 1 : 1.4) title (precise[k] ? "" : series[k]), \
        for [k = 1:cost == 2 ? |series| : 0] $rows index k - 1 using 2:4:9:10 with xerrorbars pointtype 0 \
            linewidth 1 dashtype 1 linecolor rgb family_colour[family[k]] notitle, \
        for [k = 1:|series|] $rows index k - 1 using cost:4:(strcol(5 + cost)) with labels font ",10" \
            offset 0.5,0.5 left textcolor rgb family_colour[family[k]] notitle, \
        keyentry with points pointtype 6 linewidth 1 pointsize 1.2 linecolor rgb "#000000" \
            title "open, thin: in double", \
        keyentry with lines linewidth 1.5 dashtype 3 linecolor rgb "#000000" \
            title (cost == 2 ? "dots: scalar reference loop" : ""), \
        keyentry with lines linewidth 1 dashtype 1 linecolor rgb "#000000" \
            title (cost == 2 ? "bars: quartiles of the runs" : "")
    unset output
}
