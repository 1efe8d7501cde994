/* The journals beside an image file that is filled tile by tile: IMAGE.mat.tiles has the settings and the tiles of a
   process by itself; IMAGE.mat.tiles.N those of writer N where several fill the file. */
#ifndef SASBENCH_ECHOES_TILE_JOURNALS_H
#define SASBENCH_ECHOES_TILE_JOURNALS_H

#include <stdbool.h>
#include <sys/types.h>

#include "contract/status.h"

#define TILES_JOURNAL ".tiles" /* appended to the file's name */

/* The journal of the settings, for one process alone, or together with the other writers; writer 0 is alone. `first`:
   nobody else has it now, so that the file may be made; journal_share ends that. Errors: STATUS_INVALID where another
   program has it. */
enum status journal_take(const char *path, int writer, int *journal, bool *first);
void journal_share(int journal);
/* Remove that of the settings. */
bool journal_remove(const char *path);
/* Has another writer finished the image, and removed the journal? */
bool journal_is_gone(int journal);
/* That of writer N > 0, which is locked. Errors: as journal_take. */
enum status journal_own(const char *path, int writer, int *journal);

/* All of a file, malloc'ed, as a text; cut behind its last whole line, which ends at *end. NULL: it cannot be read. */
char *journal_read(int journal, off_t *end);
/* The tile that a line, which ends at `end`, claims, and its checksum; -1: it is no such line. */
int journal_claim(const char *line, const char *end, unsigned long *sum);
/* Call `each` with the text of each writer's journal. */
void journals_each(const char *path, void (*each)(void *with, const char *text), void *with);
/* Remove those of all writers. */
void journals_clear(const char *path);

#endif
