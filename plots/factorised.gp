# Factorised back projection beside the others: error against time for an aperture of thousands of pings, on a straight track and on one
# that sways. Draws results/factorised.csv, whose head states how it was measured.
#
# By hand:    gnuplot -c plots/factorised.gp results/factorised.csv
# Variables:  csv      scene,algorithm,options,error,cpu_s
#             output   the picture, PNG or SVG (default: beside the CSV, .png)
#             plots    folder of the scripts

if (!exists("plots")) plots = "plots"
if (!exists("csv")) csv = ARGC >= 1 ? ARG1 : "results/factorised.csv"
if (csv[1:1] ne "/") csv = "./".csv                    # one that begins with '<' would be a command
if (!exists("output")) output = csv[1:strlen(csv) - 4].".png"
width = 1400
height = 640
load plots."/style.gp"
set datafile separator comma

array scenes[2] = ["study/rail", "study/rail_sway"]
array titles[2] = ["uniform straight track", "track that sways by 0.2 m"]
array names[8] = ["bp_nearest", "bp_linear", "bp_sinc", "bp_farrow", "bp_factorised", "rma_lbf", "rma_pca", "rma_delay"]
shown(options) = options[(strstrt(options, "=") > 0 ? strstrt(options, "=") + 1 : 1):(strstrt(options, ",") > 0 ? strstrt(options, ",") - 1 : strlen(options))]

set output output
set multiplot
set tmargin at screen 1 - 50.0/height
set bmargin at screen 125.0/height
set logscale xy
set xrange [0.3:20]
set yrange [3e-5:0.2]
set format y "1e%T"
set xlabel "time on one core, echoes to image (s)"
set key at screen 0.5,50.0/height center top maxrows 2 samplen 4 font ",12"
do for [n = 1:2] {
    set lmargin at screen (n == 1 ? 115.0/width : 0.56)
    set rmargin at screen (n == 1 ? 0.50 : 1 - 25.0/width)
    set ylabel (n == 1 ? "relative L2 error of the complex image" : "")
    set title titles[n].": 2048 pings, 2048 x 2048 pixels"
    plot for [k = 1:|names|] csv using (column("cpu_s")): \
        (strcol("scene") eq scenes[n] && strcol("algorithm") eq names[k] ? column("error") : NaN) \
        with linespoints linecolor rgb family_colour[family_drawn(names[k])] pointtype family_filled[family_drawn(names[k])] \
        linewidth (names[k] eq "bp_factorised" ? 3 : 1.5) dashtype 1 title (n == 1 ? names[k] : ""), \
        csv using (column("cpu_s")):(strcol("scene") eq scenes[n] ? column("error") : NaN):(shown(strcol("options"))) \
        with labels left offset 0.8,0.5 font ",10" textcolor "#606060" notitle
}
unset multiplot
unset output
