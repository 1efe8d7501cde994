function [text, status, message] = call(folder, words, most)
% What the program prints on its output; it runs with the arguments `words`, and its streams go to files in `folder`.
% Exit status 2 is the error sasbench:input with its one message, any other the error sasbench:failed. Statuses up to
% `most` (0 unless given) are the caller's, with the message.
  if nargin < 3
    most = 0;
  end
  command = '';
  if ~sasbench.internal.is_octave()   % MATLAB's own libraries are not those that the program was built with
    command = 'unset LD_LIBRARY_PATH LD_PRELOAD; ';
  end
  for word = [{sasbench.program()}, words]
    command = [command sasbench.internal.quoted(word{1}) ' ']; %#ok<AGROW>
  end
  printed = [folder '/printed'];
  said = [folder '/said'];
  command = [command '>' sasbench.internal.quoted(printed) ' 2>' sasbench.internal.quoted(said)];
  status = sasbench.internal.shell(command);
  text = strrep(sasbench.internal.text_read(printed), [folder '/'], '');
  notes = strrep(sasbench.internal.text_read(said), [folder '/'], '');
  message = regexprep(notes, '^(?:[\s\S]*\n)?sasbench: ', '');   % behind notes, if there are any
  message = strtrim(message);
  if isempty(message)
    message = sprintf('%s ended with exit status %d', sasbench.program(), status);
  end
  if status == 126 || status == 127
    error('sasbench:program', '%s', message);
  elseif status == 2
    error('sasbench:input', '%s', message);
  elseif status < 0 || status > most
    error('sasbench:failed', '%s', message);
  end
  sasbench.internal.warnings_tell(notes);
end
