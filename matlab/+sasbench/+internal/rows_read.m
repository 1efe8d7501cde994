function rows = rows_read(file)
% The rows of a results file, [n x 1]: numbers as double, of columns of text as char.
  texts = {'scene', 'algorithm', 'options', 'precision', 'engine', 'status', 'reason', 'skipped', 'stages', 'host'};
  lines = strsplit(sasbench.internal.text_read(file), char(10));
  lines = lines(~cellfun(@(line) isempty(line) || line(1) == '#', lines));
  columns = fields_read(lines{1});
  cells = cell(numel(lines) - 1, numel(columns));
  for k = 1:size(cells, 1)
    cells(k, :) = fields_read(lines{k + 1});
  end
  for k = find(~ismember(columns, texts))
    numbers = str2double(cells(:, k));
    other = isnan(numbers) & ~cellfun(@(cell) isempty(cell) || strcmpi(cell, 'nan'), cells(:, k));
    cells(~other, k) = num2cell(numbers(~other));
  end
  rows = cell2struct(cells, columns, 2);
end

function fields = fields_read(line)
  fields = regexp([line ','], '(?:"[^"]*(?:""[^"]*)*"|[^,"]*),', 'match');
  fields = cellfun(@(field) field(1:end - 1), fields, 'UniformOutput', false);
  for k = find(~cellfun(@isempty, fields))
    if fields{k}(1) == '"'
      fields{k} = strrep(fields{k}(2:end - 1), '""', '"');
    end
  end
end
