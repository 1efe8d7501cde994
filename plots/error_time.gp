# Error against run time: one point for each setting, a line through each series, the Pareto front, the scalar reference loop's time.
#
# By hand:    gnuplot -c plots/error_time.gp results/sweep                   (variables: folder.gp)

if (!exists("plots")) plots = "plots"
if (!exists("folder")) folder = ARGC >= 1 ? ARG1 : "results/latest"
name = "error_time"
cost = 2
cost_title = "median run time, raw echoes to image (s)"
load plots."/error_cost.gp"
