function text = echoes_check(file, folder)
% What `sasbench info` prints of an echo file. Errors: what it finds wrong, or that it is another file.
  text = sasbench.internal.call(folder, {'info', file});
  if isempty(strfind(text, [': echoes, '])) %#ok<STREMP>
    error('sasbench:input', '%s: is an image file; an echo file is needed (docs/echo_files.md)', file);
  end
end
