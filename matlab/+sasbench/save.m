function save(file, echoes)
% SAVE  Write an echo file, checked.
%   sasbench.save(FILE, ECHOES) writes the fields of the struct ECHOES as the variables of FILE, which ends in .mat.
%   docs/echo_files.md has the fields with shapes and units; `format` may be left out. `sasbench info` checks
%   them first. FILE is then whole, or as it was before: it is written in a new folder beside it, and moved. Of 2 GiB
%   and more in a variable it is of version 7.3, which Octave cannot write.
%
%   Errors: sasbench:input with the message of `sasbench info` where ECHOES has a fault, or where FILE cannot be
%   written.
%
%   Example:
%     e = sasbench.simulate('study/quick');
%     e.sound_speed = 1490;
%     sasbench.save('slower.mat', e);
  file = sasbench.internal.path_check(file, 'FILE');
  if ~sasbench.internal.is_mat(file)
    error('sasbench:input', 'FILE is ''%s'', must end in .mat', file);
  end
  [status, target] = sasbench.internal.shell(['readlink -f -- ' sasbench.internal.quoted(file)]);   % through links
  target = regexprep(target, '\n$', '');
  if status ~= 0 || exist(target, 'dir') == 7
    error('sasbench:input', '%s: cannot be written; a file in a folder that is there is needed', file);
  end
  [folder, guard] = sasbench.internal.folder_make(fileparts(target)); %#ok<ASGLU>
  whole = [folder '/echoes.mat'];
  sasbench.internal.mat_write(whole, sasbench.internal.echoes_content(echoes), '-v7');
  sasbench.internal.echoes_check(whole, folder);
  move = ['mv -fT -- ' sasbench.internal.quoted(whole) ' ' sasbench.internal.quoted(target) ' 2>&1'];
  [status, message] = sasbench.internal.shell(move);
  if status ~= 0
    error('sasbench:input', '%s: cannot be written: %s', file, strtrim(message));
  end
end
