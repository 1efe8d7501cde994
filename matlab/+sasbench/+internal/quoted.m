function text = quoted(text)
% A word of the shell, with blanks and quotes.
  text = ['''' strrep(text, '''', '''\''''') ''''];
end
