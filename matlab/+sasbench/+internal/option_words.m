function [words, output, value] = option_words(pairs, output, name, value)
% Name-value pairs as options of the program: numbers as text, true and false as options without a value, an option for
% each of several texts. --output is `output` unless it is given. `value` is that of the option `name`, where it is
% given.
  words = {};
  if mod(numel(pairs), 2) ~= 0
    error('sasbench:input', 'options are %d names and values, must be pairs of a name and a value', numel(pairs));
  end
  for k = 1:2:numel(pairs)
    option = sasbench.internal.text_check(pairs{k}, 'an option''s name');
    if isempty(regexp(option, '^[a-z][a-z_-]*$', 'once'))
      error('sasbench:input', 'an option''s name is ''%s'', must be as in `sasbench help`, without --', option);
    end
    given = pairs{k + 1};
    if islogical(given) && isscalar(given)
      words = [words, repmat({['--' option]}, 1, double(given))]; %#ok<AGROW>
      continue
    elseif isnumeric(given) && isscalar(given) && isreal(given)
      given = sprintf('%.17g', given);
    end
    if ~ischar(given) && isempty(given)
      error('sasbench:input', 'option ''%s'' is empty, must have a value', option);
    end
    given = sasbench.internal.texts_check(given, ['option ''' option '''']);
    if isempty(given)
      given = {''};
    end
    if strcmp(option, 'output')
      output = sasbench.internal.path_check(given{end}, 'option ''output''');
      continue
    end
    if nargin > 2 && strcmp(option, name)
      value = given{end};
    end
    words = [words, strcat(['--' option '='], given)]; %#ok<AGROW>
  end
  words{end + 1} = ['--output=' output];
end
