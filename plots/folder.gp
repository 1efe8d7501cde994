# What the scripts about a results folder share: which pictures they draw.
#
# Variables:  folder   the results folder; the scripts take it from `gnuplot -c SCRIPT DIR` (default results/latest)
#             scene    one scene only (default: all of the folder)
#             output   with `scene`: the picture to write, PNG or SVG (default: both, FOLDER/SCENE-NAME.png and .svg)
#             name     set by the script: the NAME above
#             plots    folder of the scripts
# Defines:    pictures; picture_scene[], picture_output[], picture_data[]: what `load` reads for a picture (scene.awk)

load plots."/families.gp"
load plots."/quote.gp"
# In the C locale numbers have a point, and a text is its bytes.
read(one) = sprintf("< LC_ALL=C FOLDER='%s' SCENE='%s' awk -f '%s/scene.awk'", quote(folder), quote(one), quote(plots))
# The name of a picture's file: signs that a path or a shell would take otherwise become '_'.
plain(text) = strlen(text) == 0 ? "" : (strstrt("/:,= \\", text[1:1]) ? "_" : text[1:1]).plain(text[2:*])

if (exists("scene")) {
    array scenes[1] = [scene]
} else {
    load read("")
}
pictures = exists("output") ? 1 : 2*|scenes|
array picture_scene[pictures]
array picture_output[pictures]
do for [k = 1:pictures] {
    picture_scene[k] = scenes[(k + 1)/2]
    picture_output[k] = exists("output") ? output : \
        folder."/".plain(picture_scene[k])."-".name.(k%2 ? ".png" : ".svg")
}
