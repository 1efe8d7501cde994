function path = path_check(path, name)
% A path that no reader takes for an option; ~ is the home folder.
  path = sasbench.internal.text_check(path, name);
  if isempty(path)
    error('sasbench:input', '%s is empty, must be a path', name);
  end
  if strcmp(path, '~') || strncmp(path, '~/', 2)
    path = [getenv('HOME') path(2:end)];
  elseif path(1) == '-'
    path = ['./' path];
  end
end
