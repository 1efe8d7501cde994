function echoes = echoes_content(echoes)
% The variables of an echo file, from a struct of them.
  if ~isstruct(echoes) || ~isscalar(echoes)
    error('sasbench:input', 'echoes are of class %s, must be one struct of an echo file''s variables', class(echoes));
  end
  if ~isfield(echoes, 'format')
    echoes.format = 'sas-echoes 1';
  end
  for name = fieldnames(echoes)'
    if isa(echoes.(name{1}), 'string')   % files hold rows of characters
      echoes.(name{1}) = char(echoes.(name{1}));
    end
  end
end
