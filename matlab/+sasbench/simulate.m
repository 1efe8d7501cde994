function echoes = simulate(scene, varargin)
% SIMULATE  The echoes of a scene.
%   ECHOES = sasbench.simulate(SCENE) is a struct with the variables of an echo file (docs/echo_files.md has shapes and
%   units): samples [N x M x P] fast time x receivers x pings, complex; tx [3 x P] m; rx [3 x M x P] m; fs Hz; and so
%   on, with the scene's `image_grid` and `point_targets`. SCENE is a name ('study/quick') or a file (scenes/README.md).
%   ECHOES = sasbench.simulate(..., NAME, VALUE, ...) gives the program options by name, those of
%   `sasbench help simulate`: 'threads', 2; 'output', 'FILE.mat' keeps the file.
%
%   Errors: sasbench:input for bad input, with the program's message; sasbench:failed, sasbench:program.
%
%   Example:
%     e = sasbench.simulate('study/quick');
%     plot(abs(squeeze(e.samples(:, 1, :))));
  scene = sasbench.internal.path_check(scene, 'SCENE');
  [folder, guard] = sasbench.internal.folder_make(); %#ok<ASGLU>
  [words, output] = sasbench.internal.option_words(varargin, [folder '/echoes.mat']);
  sasbench.internal.call(folder, [{'simulate'}, words, {scene}]);
  echoes = sasbench.internal.mat_read(output);
end
