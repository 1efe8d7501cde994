# Colour, point and dash of each algorithm, the same in every picture and report: a row an algorithm. Colours and points differ
# by the colour-blind and in grey together with the dashes; back projections have round and square points, range migration triangles,
# omega-k crosses. Those that are not in the list share the last row, `others`.
#
# Defines:    family_names[], family_colour[], family_filled[], family_open[] (points for float and double);
#             family_number("bp_sinc:taps=8") = 4, 0 for no algorithm of the list; family_dash[]

# name            colour   float double dash
$families <<END
reference         #808080     15     14    1
bp_nearest        #000000      7      6    1
bp_linear         #0072b2      5      4    2
bp_sinc           #009e73      7      6    4
bp_zeropad        #e69f00      5      4    3
bp_farrow         #56b4e9     13     12    5
bp_fitted         #7b3294      7      6    2
bp_factorised     #8c510a     13     12    4
rma_lbf           #d55e00      9      8    3
rma_pca           #cc79a7     11     10    2
rma_wu            #8c8c00      9      8    4
rma_numeric       #a50026     11     10    5
rma_delay         #01665e      9      8    1
rma_chirp         #c51b7d     11     10    3
wk_classic        #35978f      1      1    2
wk_squint         #bf812d      2      2    3
wk_polar          #5e3c99      3      3    4
auto              #1b7837     15     14    5
others            #666666      3      3    1
END

array family_names[|$families| - 1]
array family_colour[|$families|]
array family_filled[|$families|]
array family_open[|$families|]
array family_dash[|$families|]
do for [k = 1:|$families|] {
    if (k < |$families|) { family_names[k] = word($families[k], 1) }
    family_colour[k] = word($families[k], 2)
    family_filled[k] = int(word($families[k], 3))
    family_open[k] = int(word($families[k], 4))
    family_dash[k] = int(word($families[k], 5))
}
family_is(label, name) = label[1:strlen(name)] eq name \
    && (strlen(label) == strlen(name) ? 1 : strstrt(": ,", label[strlen(name) + 1:strlen(name) + 1]) > 0)
family_from(label, k) = k > |family_names| ? 0 : family_is(label, family_names[k]) ? k : family_from(label, k + 1)
family_number(label) = family_from(label, 1)
# Those that are not in the list share the last one.
family_drawn(label) = family_number(label) > 0 ? family_number(label) : |family_colour|
