# Colour, point and dash of each algorithm, the same in every picture and report. Colours and points are told apart by the colour-blind
# and in grey together with the dashes; back projections have round and square points, range migration triangles, omega-k crosses.
#
# Defines:    family_names[], family_colour[], family_filled[], family_open[] (points for float and double);
#             family_number("bp_sinc:taps=8") = 4, 0 for no algorithm of the list; family_dash[]

array family_names[17] = ["reference", "bp_nearest", "bp_linear", "bp_sinc", "bp_zeropad", "bp_farrow", "bp_fitted", \
    "bp_factorised", "rma_lbf", "rma_pca", "rma_wu", "rma_numeric", "rma_delay", "wk_classic", "wk_squint", "wk_polar", "auto"]
array family_colour[18] = ["#808080", "#000000", "#0072b2", "#009e73", "#e69f00", "#56b4e9", "#7b3294", "#8c510a", \
    "#d55e00", "#cc79a7", "#8c8c00", "#a50026", "#01665e", "#35978f", "#bf812d", "#5e3c99", "#1b7837", "#666666"]
array family_filled[18] = [15, 7, 5, 7, 5, 13, 7, 13, 9, 11, 9, 11, 9, 1, 2, 3, 15, 3]
array family_open[18] = [14, 6, 4, 6, 4, 12, 6, 12, 8, 10, 8, 10, 8, 1, 2, 3, 14, 3]
array family_dash[18] = [1, 1, 2, 4, 3, 5, 2, 4, 3, 2, 4, 5, 1, 2, 3, 4, 5, 1]
family_is(label, name) = label[1:strlen(name)] eq name \
    && (strlen(label) == strlen(name) ? 1 : strstrt(": ,", label[strlen(name) + 1:strlen(name) + 1]) > 0)
family_from(label, k) = k > |family_names| ? 0 : family_is(label, family_names[k]) ? k : family_from(label, k + 1)
family_number(label) = family_from(label, 1)
# Those that are not in the list share the last one.
family_drawn(label) = family_number(label) > 0 ? family_number(label) : |family_colour|
