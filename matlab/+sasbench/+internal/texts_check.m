function texts = texts_check(texts, name)
% One text or several as a row of cells; [] and {} are none.
  if isa(texts, 'string')
    texts = cellstr(texts);
  elseif isempty(texts)
    texts = {};
  elseif ~iscell(texts)
    texts = {texts};
  end
  for k = 1:numel(texts)
    texts{k} = sasbench.internal.text_check(texts{k}, sprintf('%s{%d}', name, k));
  end
  texts = reshape(texts, 1, []);
end
