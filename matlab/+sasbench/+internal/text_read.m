function text = text_read(file)
% All of a file in UTF-8 as one row of characters.
  [id, message] = fopen(file, 'r', 'n', 'UTF-8');
  if id < 0
    error('sasbench:failed', '%s: cannot be read: %s', file, message);
  end
  text = fread(id, [1 Inf], '*char');
  fclose(id);
end
