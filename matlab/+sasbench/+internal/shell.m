function [status, printed] = shell(command)
% A command of sh, whatever the user's own shell; what it prints is printed here where nobody asks for it.
  [status, printed] = system(['/bin/sh -c ' sasbench.internal.quoted(command) ' </dev/null']);
end
