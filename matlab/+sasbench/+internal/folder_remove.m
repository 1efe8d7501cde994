function folder_remove(folder)
% With all that is in it.
  if sasbench.internal.is_octave()
    confirm_recursive_rmdir(false, 'local');
  end
  [status, message] = rmdir(folder, 's');
  if ~status
    warning('sasbench:folder', '%s: cannot be removed: %s', folder, message);
  end
end
