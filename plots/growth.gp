# How back projection grows: time a pair over the image's pixels, and the plan's memory over each interpolator's setting.
#
# By hand:    gnuplot -c plots/growth.gp results/bench/growth.csv
# Variables:  csv      what `bench` wrote
#             output   the picture, PNG or SVG (default: beside the CSV, .png); footer: below it (default: none)
#             plots    folder of the scripts

if (!exists("plots")) plots = "plots"
if (!exists("csv")) csv = ARGC >= 1 ? ARG1 : "results/bench/growth.csv"
if (csv[1:1] ne "/") csv = "./".csv                    # one that begins with '<' would be a command
if (!exists("output")) output = csv[1:strlen(csv) - 4].".png"
if (!exists("footer")) footer = ""
width = 1400
height = 720
load plots."/style.gp"
set datafile separator comma

# Rows by what they measure: those of one line stand one behind the other.
kind(options) = strstrt(options, "degree=") ? " degree ".options[strstrt(options, "degree=") + 7:strstrt(options, "degree=") + 7] : ""
line(algorithm, options, engine) = algorithm.kind(options).(engine eq "general" ? ", general engine" : "")
array timed[11] = ["bp_nearest", "bp_linear", "bp_sinc", "bp_zeropad", "bp_farrow degree 3", "bp_farrow degree 5", "bp_fitted", \
    "bp_nearest, general engine", "bp_sinc, general engine", "bp_farrow degree 3, general engine", \
    "bp_farrow degree 5, general engine"]
array sized[4] = ["bp_sinc", "bp_zeropad", "bp_farrow", "bp_fitted"]
array setting[4] = ["taps", "factor", "degree", "factor"]
colour(name) = family_colour[family_drawn(name[1:(strstrt(name, " ") ? strstrt(name, " ") - 1 : strlen(name))])]
point(name) = family_filled[family_drawn(name[1:(strstrt(name, " ") ? strstrt(name, " ") - 1 : strlen(name))])]
dash(name) = strstrt(name, "general") ? 2 : 1

set output output
set label 1 footer at screen 0.5,14.0/height center font ",10" textcolor "#606060"
set multiplot
set tmargin at screen 1 - 50.0/height
set bmargin at screen 205.0/height
set key at screen 0.5,115.0/height center top maxrows 4 samplen 4 font ",12"
set lmargin at screen 125.0/width
set rmargin at screen 0.49
set logscale xy
set xlabel "pixels of the image"
set format x "1e%T"
set ylabel "nanoseconds a pair, compression included"
set title "time, float, all threads"
plot for [k = 1:|timed|] csv using (column("columns")*column("rows")): \
    (line(strcol("algorithm"), strcol("options"), strcol("engine")) eq timed[k] && strcol("setting") eq "" ? column("ns_per_pair") : NaN) \
    with linespoints linecolor rgb colour(timed[k]) pointtype point(timed[k]) dashtype dash(timed[k]) \
    linewidth (strstrt(timed[k], "degree 5") ? 1 : 2) title timed[k]
unset label 1
set lmargin at screen 0.58
set rmargin at screen 1 - 40.0/width
set format x "%g"
set logscale x 2
set key at graph 0.97,0.03 right bottom maxrows 4    # below the curves, whose axis begins at a power of ten
set xlabel "setting"
set ylabel "memory of the plan (MiB)"
set title "memory, 400 x 700 pixels"
plot for [k = 1:4] csv using (column("setting")): \
    (strcol("algorithm") eq sized[k] && strcol("setting") ne "" ? column("plan_bytes")/1048576.0 : NaN) \
    with linespoints linecolor rgb colour(sized[k]) pointtype point(sized[k]) linewidth 2 dashtype 1 title sized[k].", ".setting[k]
unset multiplot
unset output
