# Error against the operations that the plan counts, which no machine changes; otherwise as error_time.gp.
#
# By hand:    gnuplot -c plots/error_flops.gp results/sweep                  (variables: folder.gp)

if (!exists("plots")) plots = "plots"
if (!exists("folder")) folder = ARGC >= 1 ? ARG1 : "results/latest"
name = "error_flops"
cost = 3
cost_title = "counted operations (FLOP)"
load plots."/error_cost.gp"
