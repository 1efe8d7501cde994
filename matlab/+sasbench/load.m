function [echoes, text] = load(file)
% LOAD  Read an echo file, checked.
%   ECHOES = sasbench.load(FILE) is a struct with the variables of FILE (docs/echo_files.md has shapes and units):
%   samples [N x M x P] fast time x receivers x pings, tx [3 x P] m, rx [3 x M x P] m, fs Hz, and so on.
%   [ECHOES, TEXT] = sasbench.load(FILE): TEXT is what `sasbench info` prints of it, with a grid to begin with and
%   warnings of mistakes that show.
%
%   Errors: sasbench:input with the message of `sasbench info`, where FILE is not an echo file, or has a fault.
%
%   Example:
%     [e, text] = sasbench.load('recorded.mat'); disp(text)
  file = sasbench.internal.path_check(file, 'FILE');
  if ~sasbench.internal.is_mat(file)
    error('sasbench:input', 'FILE is ''%s'', must end in .mat', file);
  end
  [folder, guard] = sasbench.internal.folder_make(); %#ok<ASGLU>
  text = sasbench.internal.echoes_check(file, folder);
  echoes = sasbench.internal.mat_read(file);
end
