# The size of the legend below a plot that is 1000 pixels wide: as many columns as fit by the longest title.
#
# Variables:  others     entries beside the series, of up to 27 signs each
#             panel_px   height of the plot
#             series, precise   of scene.awk
# Defines:    legend_rows; legend_px, its height; panel_px, more where the legend would be cut

entries = others
longest = 27
do for [k = 1:|series|] {
    if (precise[k]) { continue }
    entries = entries + 1
    longest = strlen(series[k]) > longest ? strlen(series[k]) : longest
}
across = longest < 45 ? int(1000/(55.5 + 9.9*longest)) : 1     # as gnuplot reckons a sign at this size of font
legend_rows = (entries + across - 1)/across
legend_px = 22.5*legend_rows
if (panel_px < 25*legend_rows) { panel_px = 25*legend_rows }     # gnuplot makes no more rows than fit beside the plot
