# What a setting costs in side lobes: how far PSLR and ISLR lie from the exact image's, against run time. What is nearer
# than 1e-4 dB is drawn there.
#
# By hand:    gnuplot -c plots/lobes_time.gp results/sweep                   (variables: folder.gp)

if (!exists("plots")) plots = "plots"
if (!exists("folder")) folder = ARGC >= 1 ? ARG1 : "results/latest"
name = "lobes_time"
width = 1000
load plots."/folder.gp"
array quantity[2] = ["PSLR", "ISLR"]
do for [picture = 1:pictures] {
    load read(picture_scene[picture])
    if (!has_lobes) { continue }
    output = picture_output[picture]
    others = 1
    panel_px = 355
    load plots."/legend.gp"
    height = int(230 + 2*panel_px + legend_px)
    load plots."/style.gp"
    set output output
    set label 1 caption at screen 0.5,12.0/height center font ",10" textcolor "#606060"
    array exact[2] = [reference_pslr, reference_islr]
    set multiplot
    set logscale xy
    set format x "%g"
    set format y "1e%T"
    set xtics ()
    eval log_tics
    stats $rows using 2 name "x" nooutput
    set xrange [x_min/1.3:1.4*x_max]
    set yrange [8e-5:*]
    set ytics add ("≤1e-4" 1e-4)
    shown(value) = value > 1e-4 ? value : 1e-4
    set lmargin at screen 110.0/width
    set rmargin at screen 1 - 25.0/width
    do for [panel = 1:2] {
        top = 45 + (panel_px + 65)*(panel - 1)
        set tmargin at screen 1 - top/(1.0*height)
        set bmargin at screen 1 - (top + panel_px)/(1.0*height)
        set ylabel sprintf("|%s - exact image's| (dB)", quantity[panel])
        set xlabel (panel == 1 ? "" : "median run time, raw echoes to image (s)")
        set title (panel == 1 ? \
            picture_scene[picture].": side lobes against run time, median over the targets, azimuth" : "")
        if (panel == 1) { unset key } else {
            set key at screen 0.5,(35 + legend_px)/height center top maxrows legend_rows samplen 2.5 font ",12"
        }
        plot for [k = 1:|series|] $rows index k - 1 using 2:(shown(abs(column(4 + panel) - exact[panel]))) \
            with linespoints linecolor rgb family_colour[family[k]] \
            linewidth (precise[k] ? 1 : 1.8) dashtype 1 + (member[k] - 1)%5 \
            pointtype (precise[k] ? family_open[family[k]] : family_filled[family[k]]) pointsize (precise[k] ? 1 : 1.4) \
            title (precise[k] ? "" : series[k]), \
            for [k = 1:|series|] $rows index k - 1 using 2:(shown(abs(column(4 + panel) - exact[panel]))):9:10 \
            with xerrorbars pointtype 0 linewidth 1 dashtype 1 linecolor rgb family_colour[family[k]] notitle, \
            keyentry with points pointtype 6 linewidth 1 pointsize 1.2 linecolor rgb "#000000" \
                title "open, thin: in double"
        unset label 1
    }
    unset multiplot
    unset output
}
