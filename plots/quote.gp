# quote("it's"): a text between the single quotes of a shell.

quote(text) = strstrt(text, "'") ? text[1:strstrt(text, "'") - 1]."'\\''".quote(text[strstrt(text, "'") + 1:*]) : text
