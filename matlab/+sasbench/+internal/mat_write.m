function mat_write(file, content, version)
% A new MATLAB file: of `version` (-v6 is not packed: fast), or of 7.3 where that cannot hold a variable.
  sizes = structfun(@(value) bytes(value), content);
  if any(sizes >= 2 ^ 31 - 4096)
    if sasbench.internal.is_octave()
      error('sasbench:input', ['echoes have a variable of %.3g bytes, must be below 2 GiB, of which Octave writes ' ...
        'files; `sasbench simulate` or MATLAB writes larger ones'], max(sizes));
    end
    version = '-v7.3';
  end
  try
    save(file, '-struct', 'content', version);
  catch caught
    error('sasbench:input', 'the variables cannot be written: %s', strrep(caught.message, file, 'their file'));
  end
end

function count = bytes(value) %#ok<INUSD>
  about = whos('value');
  count = about.bytes;
end
