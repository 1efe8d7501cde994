/* The files by which an external program gets a problem and its samples, and gives its image (docs/plugins.md). */
#ifndef SASBENCH_GUESTS_EXCHANGE_H
#define SASBENCH_GUESTS_EXCHANGE_H

#include "contract/algorithm.h"

/* FOLDER/problem.mat, samples.npy, image.npy. */
struct exchange {
    char folder[4096];
    int samples; /* its descriptor; -1: none */
    size_t bytes;
};

/* Make a folder of its own below TMPDIR, without a file. Errors: STATUS_FAILED; nothing to close then. */
enum status exchange_folder(struct exchange *exchange);
/* Write the problem, and zeroed samples. Errors: STATUS_FAILED, STATUS_INVALID naming the place. */
enum status exchange_open(struct exchange *exchange, const struct problem *problem);
/* Write the samples, and remove an image of before. Errors: STATUS_FAILED. */
enum status exchange_give(const struct exchange *exchange, const void *samples);
/* Read the image that is there now. Errors: STATUS_INVALID, with the reason. */
enum status exchange_take(const struct exchange *exchange, const struct image *image);
/* The last line of FOLDER/log, or the first, safe to show; empty without one. */
void exchange_log_line(const struct exchange *exchange, bool last, char *line, size_t size);
/* Append the log, but for what is ahead of its last 64 KiB, to `external.log` of a results folder, below `heading`. */
void exchange_log_keep(const struct exchange *exchange, const char *results, const char *heading);
/* Leaves the folder: it is the keeper's (keeper.h). */
void exchange_close(struct exchange *exchange);

#endif
