function img = image(source, spec, varargin)
% IMAGE  Form an image of echoes.
%   IMG = sasbench.image(ECHOES, SPEC) images ECHOES, an echo file's name or a struct of its variables
%   (docs/echo_files.md, sasbench.load), by the algorithm and settings SPEC, 'bp_sinc:taps=16'. ECHOES may also be a
%   scene's name or file ('study/quick'). The pixels are those of `image_grid`, or of the option 'grid'.
%   IMG = sasbench.image(..., NAME, VALUE, ...) gives the program options by name, those of `sasbench help image`:
%   'grid', 'xmin:xstep:xcount,rmin:rstep:rcount'; 'threads', 2; 'verify', true; 'output', 'FILE.mat' keeps the file.
%
%   IMG is a struct, of several patches a struct array with an element for each:
%     image        [rows x columns], range x azimuth, complex; single unless SPEC has precision=double
%     x, r         [1 x columns], [1 x rows] the axes, m; angle: by which they are turned, rad
%     seconds      from the echoes in memory to the image, s, to the three digits that the program prints
%     error, error_gain   with 'verify', true: relative L2 error without and with one gain; else NaN
%     algorithm, options, engine, scene, scene_hash, commit, date, fc (Hz), sound_speed (m/s)   its origin
%     text         what the program prints
%   What it warns of is a warning sasbench:warning.
%
%   Errors: sasbench:input for bad input, with the program's message; sasbench:failed, sasbench:program.
%
%   Example:
%     e = sasbench.simulate('study/quick');
%     img = sasbench.image(e, 'bp_sinc', 'verify', true);
%     imagesc(img.x, img.r, 20 * log10(abs(img.image)));
  spec = sasbench.internal.text_check(spec, 'SPEC');
  [folder, guard] = sasbench.internal.folder_make(); %#ok<ASGLU>
  [words, output] = sasbench.internal.option_words(varargin, [folder '/image.mat']);
  if ~sasbench.internal.is_mat(output)
    error('sasbench:input', '''output'' is ''%s'', must end in .mat; `sasbench show` draws it', output);
  end
  from = sasbench.internal.source_words(source, folder, '--scene=');
  text = sasbench.internal.call(folder, [{'image'}, from, {['--algorithm=' spec]}, words]);
  img = image_read(output, text, folder);
end

function img = image_read(file, text, folder)
  content = sasbench.internal.mat_read(file);
  about = struct('seconds', seconds_read(text), 'error', number_after(text, 'after one gain[^,]*, (\S+) without'), ...
    'error_gain', number_after(text, 'Relative error (\S+) after one gain'));
  names = {'algorithm', 'options', 'engine', 'scene', 'scene_hash', 'commit', 'date', 'fc', 'sound_speed'};
  for k = 1:numel(names)
    about.(names{k}) = '';
    if isfield(content, names{k})
      about.(names{k}) = content.(names{k});
    end
  end
  about.scene = strrep(about.scene, [folder '/'], '');
  about.text = text;
  ends = '';
  patch = 0;
  while isfield(content, ['image' ends])
    patch = patch + 1;
    pixels = content.(['image' ends]);
    if isreal(pixels)
      pixels = complex(pixels);
    end
    one = struct('image', pixels, 'x', content.(['x' ends])(:).', 'r', content.(['r' ends])(:).', 'angle', 0);
    if isfield(content, ['angle' ends])
      one.angle = content.(['angle' ends]);
    end
    for name = fieldnames(about)'
      one.(name{1}) = about.(name{1});
    end
    img(patch) = one; %#ok<AGROW>
    ends = sprintf('_%d', patch + 1);
  end
end

function seconds = seconds_read(text)
  seconds = NaN;
  found = regexp(text, ', ([.\d]+) (us|ms|s)\s*\n', 'tokens', 'once');
  if ~isempty(found)
    seconds = str2double(found{1}) * [1e-6, 1e-3, 1] * strcmp(found{2}, {'us'; 'ms'; 's'});
  end
end

function value = number_after(text, pattern)
  value = NaN;
  found = regexp(text, pattern, 'tokens', 'once');
  if ~isempty(found)
    value = str2double(found{1});
  end
end
