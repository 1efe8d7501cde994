# How near the engines come to the machine's limits, on all threads: rate, fraction of the multiply-add peak, ratio to the
# scalar reference loop.
#
# By hand:    gnuplot -c plots/bench.gp results/bench/bench.csv
# Variables:  csv      what `bench` wrote
#             output   the picture, PNG or SVG (default: beside the CSV, .png); footer: below it (default: none)
#             plots    folder of the scripts

if (!exists("plots")) plots = "plots"
if (!exists("csv")) csv = ARGC >= 1 ? ARG1 : "results/bench/bench.csv"
if (csv[1:1] ne "/") csv = "./".csv                    # one that begins with '<' would be a command
if (!exists("output")) output = csv[1:strlen(csv) - 4].".png"
if (!exists("footer")) footer = ""
width = 1500
height = 620
load plots."/style.gp"
load plots."/quote.gp"
set datafile separator comma

stats csv using (column("threads")) name "threads" nooutput
set table $sets separator comma                        # the best instruction set is that of the first line below the head
plot csv using (strcol("isa")) with table
unset table
best = $sets[2]
label(method, precision, scene) = commas(method).(precision eq "double" ? " double" : "") \
    .(scene eq "bp22/full" ? " (whole aperture)" : "")
# Both engines, but on small images and for the cost of accuracy.
shown(scene, engine) = (engine eq "invariant" || engine eq "general") && !strstrt(scene, "sweep/") && !strstrt(scene, "study/") \
    && !(strstrt(scene, "bench/") && strstrt(scene, "0x"))
set table $rows separator tab                          # settings have commas
plot without_commas(csv) using (label(strcol("algorithm"), strcol("precision"), strcol("scene"))):(strcol("engine")): \
    (1e-9*column("pairs_per_s")):(column("fraction_of_peak")):(column("ratio_to_control")):(" ") \
    with table if (column("threads") == threads_max && strcol("isa") eq best && shown(strcol("scene"), strcol("engine")))
unset table
height = 210 + 24*|$rows|
load plots."/style.gp"
set datafile separator tab

array title[3] = ["rate (1e9 pairs/s)", "fraction of the multiply-add peak", "times the scalar reference loop's rate"]
array engine[2] = ["invariant", "general"]
array colour[2] = ["#0072b2", "#f0b040"]                # dark and light in grey as well
set output output
set style fill solid 0.9 noborder
set grid noytics
set yrange [|$rows| - 0.3:-0.7]
set label 1 footer at screen 0.5,14.0/height center font ",10" textcolor "#606060"
set multiplot title sprintf("Back projection of BP22's full size, %d thread%s", threads_max, threads_max > 1 ? "s" : "")
set tmargin at screen 1 - 60.0/height
set bmargin at screen 150.0/height
do for [k = 1:3] {
    set lmargin at screen (420 + 360*(k - 1))/real(width)
    set rmargin at screen (740 + 360*(k - 1))/real(width)
    set xlabel title[k]
    low = k == 3 ? 1 : 0
    if (k == 3) { set logscale x }
    set xrange [low:*]
    if (k == 2) { set xtics 0.2 } else { set xtics auto }
    if (k > 1) { set format y ""; set ytics scale 0 }
    if (k == 3) { set key at screen 0.5,80.0/height center top } else { unset key }
    plot for [e = 1:2] $rows using (low):0:(low):(strstrt(strcol(2), engine[e]) ? column(k + 2) : NaN):($0 - 0.35):($0 + 0.35): \
        ytic(k == 1 ? 1 : 6) with boxxyerror linecolor rgb colour[e] title engine[e]." engine"
    unset label 1
}
unset multiplot
unset output
