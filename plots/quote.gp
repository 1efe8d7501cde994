# quote("it's"): a text between the single quotes of a shell.

quote(text) = strstrt(text, "'") ? text[1:strstrt(text, "'") - 1]."'\\''".quote(text[strstrt(text, "'") + 1:*]) : text
# gnuplot ends a quoted field at its first comma: a CSV file whose quoted commas are semicolons, until they are drawn.
without_commas(path) = sprintf("< LC_ALL=C awk 'BEGIN { FS = OFS = \"\\\"\" } { for (k = 2; k <= NF; k += 2) gsub(/,/, \";\", $k) } 1' <'%s'", quote(path))
commas(text) = strstrt(text, ";") ? text[1:strstrt(text, ";") - 1].",".commas(text[strstrt(text, ";") + 1:*]) : text
