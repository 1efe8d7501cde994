# Small JPEG copies of PNG pictures, for pages.
#
# Variables:  sources, outputs          arrays of paths
#             thumbnails                how many
#             source_width, source_height, small_width, small_height   arrays: pixels

do for [k = 1:thumbnails] {
    set terminal jpeg size small_width[k],small_height[k]
    set output outputs[k]
    unset border
    unset tics
    unset key
    unset colorbox
    set lmargin 0
    set rmargin 0
    set tmargin 0
    set bmargin 0
    set xrange [-0.5:source_width[k] - 0.5]
    set yrange [-0.5:source_height[k] - 0.5]
    # Of pixels that come together anyway only some are taken, which is three times faster.
    step = source_width[k]/small_width[k] > 1 ? source_width[k]/small_width[k] : 1
    plot sources[k] binary filetype=png every step:step with rgbimage notitle
    unset output
}
