function path = program(path)
% PROGRAM  Where the program is.
%   sasbench.program(PATH) takes the program at PATH from now on; '' finds it anew.
%   PATH = sasbench.program() is the one in use: what was given, else `sasbench` on PATH, else the script of the
%   clone that this folder lies in, else bin/sasbench of the place where it is installed.
%
%   Errors: sasbench:program where there is none.
%
%   Example:
%     sasbench.program('/home/me/sasbench/sasbench');
  persistent chosen
  if nargin > 0
    path = sasbench.internal.text_check(path, 'the program''s path');
    if ~isempty(path)
      path = sasbench.internal.path_check(path, 'the program''s path');
      if path(1) ~= '/'
        path = [pwd '/' path];
      end
      if ~is_program(path)
        error('sasbench:program', '%s is not a program; the path of an executable file is needed', path);
      end
    end
    chosen = path;
  end
  if isempty(chosen)
    chosen = program_find();
  end
  path = chosen;
end

function path = program_find()
  [status, path] = sasbench.internal.shell('command -v sasbench');
  path = regexprep(path, '\n$', '');
  if status == 0 && ~isempty(path) && path(1) == '/'
    return
  end
  folder = fileparts(fileparts(fileparts(mfilename('fullpath'))));   % the clone's, or share/sasbench
  places = {[folder '/sasbench'], [fileparts(fileparts(folder)) '/bin/sasbench']};
  for k = 1:numel(places)
    path = places{k};
    if is_program(path)
      return
    end
  end
  error('sasbench:program', ['sasbench is not on PATH, and neither %s nor %s is a program; ' ...
    'sasbench.program(PATH) names it'], places{1}, places{2});
end

function is = is_program(path)
  path = sasbench.internal.quoted(path);
  is = sasbench.internal.shell(['test -f ' path ' && test -x ' path]) == 0;
end
