function text = text_check(text, name)
% A text as a row of characters, from MATLAB's strings as well.
  if isa(text, 'string') && isscalar(text)
    text = char(text);
  end
  if ~ischar(text) || ~(isempty(text) || (size(text, 1) == 1 && ndims(text) == 2)) || any(text == 0)
    error('sasbench:input', '%s is of class %s and size [%s], must be a text in one row', name, class(text), ...
      strjoin(cellfun(@int2str, num2cell(size(text)), 'UniformOutput', false), ' x '));
  end
end
