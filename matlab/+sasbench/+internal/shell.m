function [status, printed] = shell(command)
% A command of sh, whatever the user's own shell: exit status, and what it prints.
  [status, printed] = system(['/bin/sh -c ' sasbench.internal.quoted(command) ' </dev/null']);
end
