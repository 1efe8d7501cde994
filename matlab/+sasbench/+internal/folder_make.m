function [folder, guard] = folder_make(place)
% A new folder, below the system's folder of temporary files unless another is given. It goes when `guard` does, on
% errors as well.
  if nargin < 1
    place = tempdir();
  end
  [~, name] = fileparts(tempname(place));
  folder = fullfile(place, ['sasbench_' name]);
  [status, message] = mkdir(folder);
  if ~status || ~isempty(message)   % it is there already: another's
    error('sasbench:input', '%s: no folder can be made there: %s', place, message);
  end
  guard = onCleanup(@() sasbench.internal.folder_remove(folder));
end
