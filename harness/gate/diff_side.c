/* Rows sorted by their keys (diff_side.h). */
#include "gate/diff_side.h"

#include <stdlib.h>
#include <string.h>

/* By measurement only. */
static int key_order_measurement(const void *a, const void *b)
{
    const struct row_key *x = a, *y = b;
    int order = strcmp(x->scene, y->scene);
    order = order ? order : strcmp(x->algorithm, y->algorithm);
    order = order ? order : strcmp(x->options, y->options);
    return order ? order : strcmp(x->precision, y->precision);
}

static int key_order(const void *a, const void *b)
{
    const struct row_key *x = a, *y = b;
    int order = key_order_measurement(a, b);
    order = order ? order : (x->target > y->target) - (x->target < y->target);
    order = order ? order : strcmp(x->axis, y->axis);
    return order ? order : strcmp(x->definition, y->definition);
}

/* Equal keys in the order of the file, so that a row given twice is reported with its first line. */
static int key_order_row(const void *a, const void *b)
{
    const struct row_key *x = a, *y = b;
    int order = key_order(a, b);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

struct row_key row_key_of(const struct results *results, int row)
{
    if (results->targets) {
        const struct target_row *t = &results->target_rows[row];
        return (struct row_key){t->scene,  t->algorithm, t->options,    t->precision,
                                t->target, t->axis,      t->definition, row};
    }
    const struct measurement *m = &results->measurements[row];
    return (struct row_key){m->scene, m->algorithm, m->options, m->precision, 0, "", "", row};
}

void side_close(struct diff_side *side)
{
    free(side->keys);
    free(side->matched);
    free(side->closed);
    results_free(&side->results);
}

enum status side_open(const char *path, struct diff_side *side)
{
    *side = (struct diff_side){0};
    enum status status = results_read(path, &side->results);
    if (status != STATUS_OK)
        return status;
    const struct csv *csv = &side->results.csv;
    size_t rows = (size_t)csv->row_count;
    side->keys = calloc(rows + 1, sizeof *side->keys);
    side->matched = calloc(rows + 1, sizeof *side->matched);
    side->closed = calloc(rows + 1, sizeof *side->closed);
    if (!side->keys || !side->matched || !side->closed)
        return status_set(STATUS_FAILED, "%s: no memory for %d rows", path, csv->row_count);
    for (int row = 0; row < csv->row_count; row++)
        side->keys[row] = row_key_of(&side->results, row);
    qsort(side->keys, rows, sizeof *side->keys, key_order_row);
    for (int k = 1; k < csv->row_count; k++)
        if (key_order(&side->keys[k - 1], &side->keys[k]) == 0)
            return status_set(STATUS_INVALID,
                              "%s:%d: the row of scene %s, algorithm %s, options '%s', precision %s "
                              "stands in line %d already; each may be given once",
                              path, csv->lines[side->keys[k].row], side->keys[k].scene, side->keys[k].algorithm,
                              side->keys[k].options, side->keys[k].precision, csv->lines[side->keys[k - 1].row]);
    return STATUS_OK;
}

const struct row_key *side_find(const struct diff_side *side, const struct row_key *key)
{
    return bsearch(key, side->keys, (size_t)side->results.csv.row_count, sizeof *side->keys, key_order);
}

const struct row_key *side_find_measurement(const struct diff_side *side, const struct row_key *key)
{
    return bsearch(key, side->keys, (size_t)side->results.csv.row_count, sizeof *side->keys, key_order_measurement);
}

/* A name may contain anything, also the colon that ends it: the hash is behind the line's last one. */
const char *side_hash(const struct diff_side *side, const char *scene)
{
    const struct csv *csv = &side->results.csv;
    const size_t length = strlen(scene);
    for (int k = 0; k < csv->comment_count; k++) {
        const char *name = csv->comments[k] + strlen("scene "), *hash = strrchr(csv->comments[k], ':');
        if (strncmp(csv->comments[k], "scene ", strlen("scene ")) == 0 && hash && hash - name == (ptrdiff_t)length
            && strncmp(name, scene, length) == 0)
            return hash + 1;
    }
    return NULL;
}
