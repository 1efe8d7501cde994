function row = score(img, source, varargin)
% SCORE  Measure an image that another program formed, as `sasbench score` does.
%   ROW = sasbench.score(IMG, SOURCE) measures IMG against the exact image of SOURCE: a scene's name or file, an echo
%   file that `simulate` wrote, or a struct of its variables.
%   IMG is a struct, of several patches a struct array, with the fields
%     image        [rows x columns], range x azimuth, complex
%     x, r         [1 x columns], [1 x rows] the axes, m
%     angle        optional: by which they are turned, rad
%   ROW = sasbench.score(..., NAME, VALUE, ...) gives the program options by name, those of `sasbench help score`:
%   'name', 'mine'; 'seconds', 0.5; 'output', DIR adds the row to a results folder.
%
%   ROW is a struct, a row of measurements.csv, as those of sasbench.run: error, error_gain, phase_rms_rad, width_m,
%   pslr_db and more (docs/measurements.md).
%
%   What the program warns of, such as an image of the conjugate phase, is a warning sasbench:warning.
%
%   Errors: sasbench:input for bad input, with the program's message; sasbench:failed, sasbench:program.
%
%   Example:
%     img = sasbench.image('study/quick', 'bp_nearest');      % stands for an image of yours
%     row = sasbench.score(struct('image', img.image, 'x', img.x, 'r', img.r), 'study/quick', 'name', 'mine');
  [folder, guard] = sasbench.internal.folder_make(); %#ok<ASGLU>
  [words, output, name] = sasbench.internal.option_words(varargin, [folder '/results'], 'name', 'image');
  from = sasbench.internal.source_words(source, folder, '');
  sasbench.internal.mat_write([folder '/image.mat'], image_content(img), '-v6');
  text = sasbench.internal.call(folder, [{'score'}, words, {[folder '/image.mat']}, from]);
  sasbench.internal.warnings_tell(text);
  rows = sasbench.internal.rows_read([output '/measurements.csv']);
  row = rows(find(strcmp({rows.algorithm}, name), 1, 'last'));   % rows are added at the end
end

function content = image_content(img)
  if ~isstruct(img) || isempty(img) || ~all(isfield(img, {'image', 'x', 'r'}))
    error('sasbench:input', 'IMG is of class %s, must be a struct with the fields image, x and r', class(img));
  end
  ends = '';
  for k = 1:numel(img)
    if ~isequal(size(img(k).image), [numel(img(k).r), numel(img(k).x)])
      error('sasbench:input', 'IMG(%d).image is [%s], must be [%d x %d] as its axes r and x', k, ...
        strjoin(cellfun(@int2str, num2cell(size(img(k).image)), 'UniformOutput', false), ' x '), ...
        numel(img(k).r), numel(img(k).x));
    end
    content.(['image' ends]) = img(k).image;
    content.(['x' ends]) = img(k).x(:).';
    content.(['r' ends]) = img(k).r(:).';
    if isfield(img, 'angle') && ~isempty(img(k).angle) && ~isequal(img(k).angle, 0)
      content.(['angle' ends]) = img(k).angle;
    end
    ends = sprintf('_%d', k + 1);
  end
end
