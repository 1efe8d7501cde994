function content = mat_read(file)
% The variables of a MATLAB file.
  texts = {'format', 'description', 'licence', 'algorithm', 'options', 'engine', 'scene', 'scene_hash', 'commit', ...
    'date', 'status'};
  if ~any(file == '/')   % else Octave would look for it on its path
    file = ['./' file];
  end
  if exist(file, 'file') ~= 2
    [~, name, ending] = fileparts(file);
    error('sasbench:failed', '%s%s was not written', name, ending);
  end
  content = load(file);
  for name = fieldnames(content)'   % Octave reads the text of version 7.3 as numbers
    value = content.(name{1});
    if sasbench.internal.is_octave() && isnumeric(value) && any(strcmp(name{1}, texts))
      content.(name{1}) = char(value(:).');
    end
  end
end
