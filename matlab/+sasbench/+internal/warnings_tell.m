function warnings_tell(text)
% Warn of what the program warns of, on either of its streams, a warning each; its tables wrap them.
  text = regexprep(text, '\n {4}(?!warning: )(?=\S)', ' ');
  for found = regexp(text, '(?:^|\n)(?: {4}|sasbench: )warning: ([^\n]*)', 'tokens')
    warning('sasbench:warning', '%s', found{1}{1});
  end
end
