% The functions of matlab/ against the program's own files and messages, and the page docs/matlab.md. Arguments: the
% program, the source folder. Runs in an empty folder, with TMPDIR an empty one.
1;

function refused(call, id, part)
% An error with this identifier and part of its message; no temporary file stays.
  try
    call();
  catch caught
    assert(strcmp(caught.identifier, id), '%s: %s', caught.identifier, caught.message);
    assert(~isempty(strfind(caught.message, part)), caught.message);
    assert(isempty(strfind(caught.message, tempdir())), caught.message);
    nothing_left();
    return
  end
  error('not refused: %s', part);
end

function nothing_left()
  left = setdiff({dir(tempdir()).name, dir('.sasbench_*').name, dir('sasbench_*').name}, {'.', '..'});
  assert(isempty(left), strjoin(left, ' '));
end

function text = cli(program, arguments)
  [status, text] = system(['"' program '" ' arguments]);
  assert(status == 0, text);
end

function image = pixels(echoes, spec)
  img = sasbench.image(echoes, spec);
  image = img.image;
end

function same_row(a, b)
% But for what two runs of a program do not share.
  names = setdiff(fieldnames(a), {'load', 'host'});
  for k = 1:numel(names)
    assert(isequaln(a.(names{k}), b.(names{k})), names{k});
  end
end

function images_are_the_programs(program)
  e = sasbench.simulate('study/quick');
  cli(program, 'simulate study/quick -o cli.mat');
  assert(isequaln(e, load('cli.mat')));
  specs = {'bp_sinc:taps=4', 'bp_sinc:taps=4,precision=double'};
  classes = {'single', 'double'};
  for k = 1:2
    cli(program, ['image -e cli.mat -o i.mat -a ' specs{k}]);
    own = load('i.mat');
    img = sasbench.image(e, specs{k}, 'threads', 1);
    assert(isa(img.image, classes{k}) && iscomplex(img.image));
    assert(isequal(img.image, own.image) && isequal(img.x, own.x) && isequal(img.r, own.r));
    assert(isequal(size(img.image), [numel(img.r), numel(img.x)]));
    assert(img.seconds > 0 && isnan(img.error) && strcmp(img.algorithm, 'bp_sinc') && img.fc == 150e3);
  end
  assert(isequal(pixels('study/quick', specs{2}), own.image));
  % Of version 7.3, which tiles are written in
  tiled = sasbench.image('cli.mat', specs{2}, 'tile', '30x13', 'output', 'tiled.mat');
  assert(isequal(tiled.image, own.image) && strcmp(tiled.algorithm, 'bp_sinc'));
  % Verified: the errors that a run measures
  img = sasbench.image(e, 'bp_sinc:taps=4', 'verify', true, 'grid', '-0.1:0.02:11,19.9:0.025:9');
  row = sasbench.score(img, e, 'grid', '-0.1:0.02:11,19.9:0.025:9');
  assert(abs(img.error / row.error - 1) < 0.01 && abs(img.error_gain / row.error_gain - 1) < 0.01);
  % Turned patches
  patches = rmfield(e, 'point_targets');
  patches.image_grid = [-0.2 0.02 9 19.9 0.025 5 0.01; 0 0.02 7 19.9 0.02 4 0.01]';
  patches.description = ['two ';'rows'];
  img = sasbench.image(patches, 'bp_nearest');
  assert(isequal(size(img), [1 2]) && isequal(size(img(2).image), [4 7]) && img(2).angle == 0.01);
  row = sasbench.score(img, patches);
  assert(row.error > 0 && row.error < 1);
  nothing_left();
end

function echoes_go_round()
  e = sasbench.simulate('study/quick', 'output', 'kept.mat');
  name = ['-a "b" ''c'' $d \e gr' char([195 188]) 'n.mat'];
  sasbench.save(name, e);
  [back, text] = sasbench.load(name);
  assert(isequaln(back, e));
  assert(~isempty(strfind(text, '256 (fast time) x 8 (receivers) x 18 (pings)')));
  assert(isequal(pixels(name, 'bp_nearest'), pixels('kept.mat', 'bp_nearest')));
  e.samples = single(e.samples);
  mkdir('away');
  symlink('away/target.mat', 'link.mat');
  sasbench.save('link.mat', rmfield(e, 'format'));
  back = sasbench.load('away/target.mat');
  assert(isa(back.samples, 'single') && isequal(back.samples, e.samples));
  assert(~isempty(readlink('link.mat')));
  nothing_left();
end

function rows_are_the_programs()
  rows = sasbench.run('study/quick', {'bp_sinc:taps=4', 'wk_polar'}, 'output', 'res');
  again = sasbench.run({'study/quick'}, {}, 'output', 'res', 'algorithm', {'bp_sinc:taps=4', 'wk_polar'});
  assert(isequal(size(rows), [2 1]) && isequaln(rows, again));   % resumed: nothing is run again
  assert(strcmp(rows(1).options, 'taps=4,window=none') && rows(1).run_s > 0 && rows(1).error > 0);
  assert(strcmp(rows(2).status, 'unsupported') && ~isempty(strfind(rows(2).reason, 'one_receiver')));
  assert(isnan(rows(2).error));
  lines = strsplit(fileread('res/measurements.csv'), "\n");
  head = strsplit(lines{find(strncmp(lines, 'scene,', 6), 1)}, ',');
  assert(isequal(fieldnames(rows), head(:)));
  texts = head(cellfun(@(name) ischar(rows(1).(name)), head));
  assert(isequal(texts, {'scene', 'algorithm', 'options', 'precision', 'engine', 'status', 'reason', 'skipped', ...
    'stages', 'host'}));
  nothing_left();
end

function fields_of_csv()
  file = fopen('quoted.csv', 'w');
  fprintf(file, "# a \"head\nscene,reason,error,new\n\"#1\",\"a, \"\"b\"\"\",1e-3,x y\n,,,\n");
  fclose(file);
  rows = sasbench.internal.rows_read('quoted.csv');
  assert(isequaln(rows, struct('scene', {'#1'; ''}, 'reason', {'a, "b"'; ''}, 'error', {1e-3; NaN}, ...
    'new', {'x y'; NaN})));
end

function scores_are_the_programs(program)
  img = sasbench.image('study/quick', 'bp_nearest', 'output', 'mine.mat');
  text = cli(program, 'score mine.mat study/quick -o scored');
  own = sasbench.internal.rows_read('scored/measurements.csv');
  foreign = struct('image', img.image, 'x', img.x(:), 'r', img.r(:));
  same_row(sasbench.score(foreign, 'study/quick', 'name', 'mine', 'output', 'both'), own);
  other = sasbench.score(foreign, 'study/quick', 'name', 'other', 'seconds', 0.5, 'output', 'both');
  assert(strcmp(other.algorithm, 'other') && other.run_s == 0.5 && other.error == own.error);
  lastwarn('');
  foreign.image = conj(img.image);
  sasbench.score(foreign, 'study/quick');
  [message, id] = lastwarn();
  assert(strcmp(id, 'sasbench:warning') && ~isempty(strfind(message, 'complex conjugate')), message);
  foreign.image = img.image.';
  refused(@() sasbench.score(foreign, 'study/quick'), 'sasbench:input', 'is [61 x 13], must be [13 x 61]');
  foreign.image = NaN(size(img.image));
  refused(@() sasbench.score(foreign, 'study/quick'), 'sasbench:input', 'not finite');
  nothing_left();
end

function faults_are_refused(program)
  e = sasbench.simulate('study/quick');
  input = 'sasbench:input';
  refused(@() sasbench.image(e, 'bp_sinz'), input, 'did you mean ''bp_sinc''?');
  refused(@() sasbench.image(e, 'bp_sinc', 'ouput', 'x.mat'), input, 'option ''--ouput'' is not one of this command');
  refused(@() sasbench.image(e, 'bp_sinc', 'output', 'x.png'), input, 'must end in .mat');
  refused(@() sasbench.image(e, 'bp_sinc', 'threads', 1.5), input, '--threads is ''1.5''');
  refused(@() sasbench.image(e, 'bp_sinc', 'threads', []), input, 'option ''threads'' is empty');
  refused(@() sasbench.image(e, 'bp_sinc', 'threads'), input, 'must be pairs');
  refused(@() sasbench.image(e, 'bp_sinc', 3, 4), input, 'an option''s name is of class double');
  refused(@() sasbench.image(e, ['bp_sinc'; 'bp_sinc']), input, 'SPEC is of class char and size [2 x 7]');
  refused(@() sasbench.image('', 'bp_sinc'), input, 'is empty');
  refused(@() sasbench.image([e e], 'bp_sinc'), input, 'must be one struct');
  refused(@() sasbench.image('none.mat', 'bp_sinc'), input, 'none.mat: cannot be read');
  refused(@() sasbench.run(7, 'bp_sinc'), input, 'SCENES{1} is of class double');
  refused(@() sasbench.simulate('study/quik'), input, 'study/quik');
  refused(@() sasbench.image(e, 'bp_sinc', 'help', true), 'sasbench:failed', 'was not written');
  refused(@() sasbench.load('none.mat'), input, 'none.mat: cannot be read');
  sasbench.image(e, 'bp_nearest', 'output', 'image.mat');
  refused(@() sasbench.load('image.mat'), input, 'is an image file');
  bad = e;
  bad.f = @sin;
  refused(@() sasbench.save('whole.mat', bad), input, 'cannot be written');
  bad = e;
  bad.fs = NaN;
  sasbench.save('whole.mat', e);
  refused(@() sasbench.save('whole.mat', bad), input, 'fs is nan');
  assert(isequaln(sasbench.load('whole.mat'), e));   % as it was
  refused(@() sasbench.save('none/e.mat', e), input, 'none/e.mat: cannot be written');
  mkdir('folder.mat');
  refused(@() sasbench.save('folder.mat', e), input, 'folder.mat: cannot be written');
  refused(@() sasbench.program('none'), 'sasbench:program', 'none is not a program');
  assert(strcmp(sasbench.program(), program));
end

function program_is_found(program, source)
  before = getenv('PATH');
  mkdir('bin of mine');
  symlink(program, 'bin of mine/sasbench');
  setenv('PATH', [pwd '/bin of mine:' before]);
  assert(strcmp(sasbench.program(''), [pwd '/bin of mine/sasbench']));
  setenv('PATH', before);
  if system('command -v sasbench >/dev/null') ~= 0
    assert(strcmp(sasbench.program(''), [source '/sasbench']));
  end
  assert(strcmp(sasbench.program('bin of mine/sasbench'), [pwd '/bin of mine/sasbench']));
  sasbench.program(program);
end

function image = direct_sum(e, img)
% Every compressed record at the exact delay of every pixel, by the sinc of all its samples.
  [x, r] = meshgrid(img.x, img.r);
  image = zeros(size(x));
  samples = (0:size(e.samples, 1) - 1)';
  for ping = 1:size(e.tx, 2)
    for receiver = 1:size(e.rx, 2)
      place = @(point, tau) sqrt((point(1) + e.velocity(1) * tau - x) .^ 2 + (point(2) - r) .^ 2 + point(3) ^ 2);
      out = place(e.tx(:, ping), 0);
      tau = 2 * out / e.sound_speed;
      for turn = 1:10
        tau = (out + place(e.rx(:, receiver, ping), tau)) / e.sound_speed;
      end
      weights = sinc((tau(:).' - e.t0) * e.fs - samples);
      read = reshape(e.samples(:, receiver, ping).' * weights, size(x));
      image = image + read .* exp(2i * pi * e.fc * tau);
    end
  end
end

function page_is_true(file)
% What a page's code prints is what the page shows behind it.
  page = fileread(file);
  blocks = regexp(page, '```(matlab|text)\n(.*?)\n```', 'tokens');
  printed = '';
  shown = 0;
  for number = 1:numel(blocks)
    if strcmp(blocks{number}{1}, 'matlab')
      printed = [printed evalc(blocks{number}{2})];
    else
      printed = regexprep(printed, '\s+$', '');
      assert(strcmp(printed, blocks{number}{2}), '%s shows\n%s\nbut its code prints\n%s\n', file, ...
        blocks{number}{2}, printed);
      printed = '';
      shown++;
    end
  end
  assert(shown >= 4);
  % Its recording, imaged on a few pixels by nothing but the sum
  img = sasbench.image(e, 'bp_farrow:precision=double', 'grid', '3.9:0.02:11,19.9:0.03:8');
  exact = direct_sum(e, img);
  off = norm(img.image(:) - exact(:)) / norm(exact(:));
  assert(off > 0 && off < 1e-3, 'differs from the direct sum by %g', off);
  nothing_left();
end

arguments = argv();
warning('off', 'Octave:shadowed-function');
addpath([arguments{2} '/matlab']);
program = sasbench.program(arguments{1});
images_are_the_programs(program);
echoes_go_round();
rows_are_the_programs();
fields_of_csv();
scores_are_the_programs(program);
faults_are_refused(program);
program_is_found(program, arguments{2});
page_is_true([arguments{2} '/docs/matlab.md']);
