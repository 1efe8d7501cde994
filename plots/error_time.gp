# Error against run time: one point for each row of a scene, both axes logarithmic.
#
# Variables:  output   the PNG to write
#             csv      measurements.csv of a results folder
#             scene    which scene's rows
#             plots    folder of style.gp (default "plots")
# By hand:    gnuplot -e "output='a.png'; csv='results/latest/measurements.csv'; scene='zp15/target'" plots/error_time.gp

if (!exists("plots")) plots = "plots"
width = 1000
height = 640
load plots."/style.gp"
set output output
set datafile separator comma
names = system(sprintf("grep '^%s,' '%s' | cut -d, -f2 | awk '!seen[$0]++'", scene, csv))
machine = system(sprintf("sed -n 's/^# machine: //p' '%s'", csv))
mine(row_scene, name, row_name, value) = row_scene eq scene && row_name eq name && value > 0 ? value : NaN
set logscale xy
set format y "1e%T"
set xlabel "median run time, raw echoes to image (s)"
set ylabel "relative L2 error against the exact image"
set title scene." on ".machine
set key outside right top
plot for [k = 1:words(names)] csv \
    using (mine(strcol("scene"), word(names, k), strcol("algorithm"), column("run_s"))): \
    (mine(strcol("scene"), word(names, k), strcol("algorithm"), column("error"))) \
    with points linetype k + 1 pointtype 5 + 2*k pointsize 2 title word(names, k)
unset output
