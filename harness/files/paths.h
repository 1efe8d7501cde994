/* Folders of this installation. */
#ifndef SASBENCH_FILES_PATHS_H
#define SASBENCH_FILES_PATHS_H

#define SCENE_DIRECTORY SASBENCH_ROOT "/scenes"
#define PLOT_DIRECTORY  SASBENCH_ROOT "/plots"
#define PAGES_DIRECTORY SASBENCH_ROOT "/docs/papers" /* that `reproduce --docs` writes */

#endif
