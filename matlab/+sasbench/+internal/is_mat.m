function is = is_mat(path)
% By its ending.
  is = numel(path) > 4 && strcmpi(path(end - 3:end), '.mat');
end
