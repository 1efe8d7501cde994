function rows = run(scenes, specs, varargin)
% RUN  Compare algorithms on scenes or echoes.
%   ROWS = sasbench.run(SCENES, SPECS) runs every algorithm of SPECS on every scene of SCENES. Each is a text or a cell
%   array of texts; {} stands for the usual ones of `sasbench run`. SCENES may also be one echo file's name (ending in
%   .mat) or a struct of its variables.
%   ROWS = sasbench.run(..., NAME, VALUE, ...) gives the program options by name, those of `sasbench help run`:
%   'threads', 2; 'output', DIR keeps the results folder, with its pictures, and goes on in one that is there: ROWS
%   are then all of its rows.
%
%   ROWS [n x 1] is a struct array, a row of measurements.csv each: numbers as double (NaN where there is none), all
%   else as char. docs/measurements.md explains the columns; times are in s, widths in m. An algorithm that refuses a
%   scene has status 'unsupported', one that failed 'failed' (and a warning sasbench:failed), with the reason.
%
%   Errors: sasbench:input for bad input, with the program's message; sasbench:failed, sasbench:program.
%
%   Example:
%     rows = sasbench.run('study/quick', {'bp_nearest', 'bp_sinc:taps=8'});
%     semilogy([rows.run_s], [rows.error_gain], 'o');
  [folder, guard] = sasbench.internal.folder_make(); %#ok<ASGLU>
  [words, output] = sasbench.internal.option_words(varargin, [folder '/results']);
  specs = sasbench.internal.texts_check(specs, 'SPECS');
  if isstruct(scenes)
    words = [sasbench.internal.source_words(scenes, folder, ''), words];
  else
    scenes = sasbench.internal.texts_check(scenes, 'SCENES');
    for k = numel(scenes):-1:1
      words = [sasbench.internal.source_words(scenes{k}, folder, ''), words]; %#ok<AGROW>
    end
  end
  for k = 1:numel(specs)
    words{end + 1} = ['--algorithm=' specs{k}]; %#ok<AGROW>
  end
  [~, status, message] = sasbench.internal.call(folder, [{'run'}, words], 1);
  file = [output '/measurements.csv'];
  if exist(file, 'file') ~= 2
    error('sasbench:failed', '%s', message);
  end
  rows = sasbench.internal.rows_read(file);
  if status ~= 0
    warning('sasbench:failed', '%s', message);
  end
end
