# All scenes of a run side by side, with the same axes: error against speed-up over the scalar reference loop, a point for each
# algorithm, and the Pareto front. show/plot_results.c writes what it draws.
#
# Variables:  footer               a text
#             $rows, $fronts       a block for each scene: speed_up error number
#             algorithms[]         the names of the numbers
#             scenes[]             names

columns = |scenes| < 4 ? |scenes| : int(ceil(sqrt(1.55*|scenes|)))
lines = int((|scenes| + columns - 1)/columns)
width = columns < 4 ? 1000 : 1500
panel_width = int((width - 90.0)/columns) - 12
panel_height = int(columns < 4 ? 0.8*panel_width : 0.68*panel_width)
across = int((width - 40)/165)
key_rows = int((|algorithms| + 1 + across - 1)/across)
below = 75 + 23*key_rows
height = 40 + lines*(panel_height + 28) + below
load plots."/style.gp"
array drawn[|algorithms|]
do for [a = 1:|algorithms|] { drawn[a] = family_drawn(algorithms[a]) }
set output output
stats $rows using 1:2 nooutput
set logscale xy
set xrange [1.6*STATS_max_x:STATS_min_x/1.6]
set yrange [STATS_min_y/1.6:(STATS_max_y > 0.625 ? 1.6*STATS_max_y : 1)]
step = STATS_max_y/STATS_min_y > 1e3 ? 100 : 10
set ytics step font ",10"
set tics scale 0.5,0
set label 1 footer at screen 0.5, screen 14.0/height center font ",10" textcolor "#606060"
set multiplot title "Error against speed-up over the scalar reference loop: faster to the left, more exact below" font ",14" offset 0,-0.2
do for [s = 1:|scenes|] {
    left = 80 + ((s - 1)%columns)*(panel_width + 12)
    line = (s - 1)/columns
    top = 40 + line*(panel_height + 28) + 22
    set lmargin at screen left/real(width)
    set rmargin at screen (left + panel_width)/real(width)
    set tmargin at screen 1 - top/real(height)
    set bmargin at screen 1 - (top + panel_height)/real(height)
    set title scenes[s] font ",11" offset 0,-0.8
    set format y ((s - 1)%columns == 0 ? "1e%T" : "")
    bottom = s + columns > |scenes|
    set xtics () font ",10"                             # gnuplot finds none by itself on an axis that falls
    do for [decade = -9:9] { set xtics add ((decade%2 || !bottom ? "" : sprintf("%gx", 10.0**decade)) 10.0**decade) }
    if (s == 1) { set key at screen 0.5, screen 28.0/height center bottom maxrows key_rows samplen 1 font ",11" } else { unset key }
    plot $fronts index s - 1 using 1:2 with steps linetype 1 linewidth 4 title "Pareto front", \
        for [a = 1:|algorithms|] $rows index s - 1 using 1:($3 == a ? $2 : NaN) with points \
            linecolor rgb family_colour[drawn[a]] pointtype family_filled[drawn[a]] pointsize 1 linewidth 1 notitle, \
        for [a = 1:|algorithms|] keyentry with points linecolor rgb family_colour[drawn[a]] \
            pointtype family_filled[drawn[a]] pointsize 1.3 linewidth 1 title algorithms[a]
    unset label 1
}
unset multiplot
unset output
