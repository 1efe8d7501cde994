% Back projection in Octave for sasbench, each record read by a truncated sinc: external:octave-cli -qf my_bp.m
1;

function image = project(p, samples, taps)
  [count, receivers, pings] = size(samples);
  image = zeros(1, columns(p.pixels));
  near = (0:taps - 1)' - (taps / 2 - 1);
  for ping = 1:pings
    ray = p.pixels - p.tx(:, ping);
    out = sqrt(sumsq(ray)) / p.sound_speed;
    for receiver = 1:receivers
      v = p.velocity(:, min(ping, end));                   % |away + v tau| = c (tau - out), solved for tau
      away = p.rx(:, receiver, ping) - p.pixels;
      a = p.sound_speed ^ 2 - sumsq(v);
      b = p.sound_speed ^ 2 * out + v' * away;
      tau = (b + sqrt(b .^ 2 + a * (sumsq(away) - (p.sound_speed * out) .^ 2))) / a;
      q = (tau - p.t0(min(ping, end))) * p.fs;
      counts = find(q >= 0 & q <= count - 1 & ! (abs(p.normal(:, ping)' * ray) ./ (p.sound_speed * out) > p.beam_limit));
      record = [zeros(taps, 1); compress(p, samples(:, receiver, ping)); zeros(taps, 1)];
      whole = floor(q(counts));
      read = record(whole + near + taps + 1);
      value = sum(reshape(read, taps, []) .* sinc(q(counts) - whole - near), 1);
      image(counts) += value .* exp(2i * pi * mod(p.fc * tau(counts), 1));
    end
  end
end

function record = compress(p, samples)                     % raw echoes through the matched filter
  record = samples;
  if ! p.compressed
    size = 2 ^ nextpow2(numel(samples) + numel(p.pulse));
    record = ifft(fft(samples, size) .* conj(fft(p.pulse(:), size)))(1:numel(samples)) / sumsq(abs(p.pulse(:)));
  end
end

function p = problem_read(folder)                          % problem.mat, and the places of all patches, row by row
  p = load([folder '/problem.mat']);
  p.folder = folder;
  p.pixels = zeros(3, 0);
  if ! isfield(p, 'beam_limit'), p.beam_limit = Inf; end
  for g = p.image_grid
    [x, r] = ndgrid(g(1) + g(2) * (0:g(3) - 1), g(4) + g(5) * (0:g(6) - 1));
    x = x(:)'; r = r(:)';
    p.pixels = [p.pixels, [x * cos(g(7)) + r * sin(g(7)); -x * sin(g(7)) + r * cos(g(7)); 0 * x]];
  end
end

function samples = samples_read(p)                         % samples.npy: 128 bytes of text, then complex numbers
  file = fopen([p.folder '/samples.npy']);
  single = any(strfind(fread(file, 128, '*char')', '<c8'));
  numbers = fread(file, [2 Inf], {'double', 'single'}{1 + single});
  fclose(file);
  samples = reshape(complex(numbers(1, :), numbers(2, :)), [], size(p.rx, 2), size(p.tx, 2));
end

function image_write(p, image)
  text = sprintf("{'descr': '<c16', 'fortran_order': False, 'shape': (%d,), }", numel(image));
  file = fopen([p.folder '/image.npy'], 'w');
  fwrite(file, [147 double('NUMPY') 1 0], 'uint8');
  fwrite(file, numel(text), 'uint16');
  fwrite(file, text);
  fwrite(file, [real(image(:).'); imag(image(:).')], 'double');
  fclose(file);
end

function line = line_hear(file)                            % fgetl would wait for the next line's beginning
  line = '';
  while ! isempty(c = fread(file, 1, '*char')) && c != "\n", line(end + 1) = c; end
end

hears = fopen('/dev/fd/3', 'r');
says = fopen('/dev/fd/4', 'w');
taps = 8;
if ! isempty(argv()), taps = str2double(argv(){end}); end
if isnan(taps), taps = 8; end
while ! isempty(line = line_hear(hears))
  words = strsplit(line, ' ');
  if strcmp(words{2}, 'plan')
    p = problem_read(strjoin(words(3:end), ' '));
    fprintf(says, 'sasbench1 ok octave-%s\n', version());
  elseif strcmp(words{2}, 'execute')
    tic;
    image = project(p, samples_read(p), taps);
    seconds = toc;
    image_write(p, image);
    fprintf(says, 'sasbench1 took %.6f\n', seconds);
  else
    break;
  end
  fflush(says);
end
