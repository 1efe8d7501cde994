function words = source_words(source, folder, scene)
% The option that names echoes: a struct, which is written into `folder`, or a file ending in .mat. Another text is a
% scene, behind the option `scene`, or '' where it stands alone.
  if isstruct(source)
    file = [folder '/echoes.mat'];
    source = sasbench.internal.echoes_content(source);
    remarks = intersect(fieldnames(source), {'description', 'licence'});
    source = rmfield(source, remarks);
    version = '-v6';
    if sum(structfun(@ischar, source)) > 1   % Octave's -v6 damages texts of several rows
      version = '-v7';
    end
    sasbench.internal.mat_write(file, source, version);
    words = {['--echoes=' file]};
    return
  end
  source = sasbench.internal.path_check(source, 'the name of a scene or an echo file');
  if sasbench.internal.is_mat(source)
    words = {['--echoes=' source]};
  else
    words = {[scene source]};
  end
end
