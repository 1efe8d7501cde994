/* Files that come with the program. An installed program has them in ../share/sasbench of its own folder, so that it
   may be moved with them; any other has those of the source folder that it was built from. */
#ifndef SASBENCH_FILES_PATHS_H
#define SASBENCH_FILES_PATHS_H

enum data {
    DATA_SCENES,
    DATA_BENCH,
    DATA_EXTREME,
    DATA_PLOTS,
    DATA_PUBLISHED,
    DATA_CLAIMS,
    DATA_NUMBERS,
    DATA_STABILITY,
    DATA_BASELINE,
    DATA_PAGES,
    DATA_COUNT
};

/* The path, absolute and never freed; the same for any thread. */
const char *data_path(enum data which);
/* How a user calls this program: "sasbench" once it is installed, else "./sasbench". */
const char *program_called(void);

#endif
