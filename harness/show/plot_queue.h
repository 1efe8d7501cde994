/* Pictures that are drawn later, several at a time. Their data are written when they are added. Used within show/
   only. */
#ifndef SASBENCH_SHOW_PLOT_QUEUE_H
#define SASBENCH_SHOW_PLOT_QUEUE_H

#include "show/plot_script.h"

enum { PLOT_QUEUE_MOST = 48 };

/* Accepts zeroes; emptied by plot_queue_draw or plot_queue_free. */
struct plot_queue {
    struct queued_plot *list; /* [count] */
    int count;
};

/* End a plot whose data and variables were written with `status`: without a queue it is drawn, else taken over and
   drawn later; `plots_directory` and `script` are borrowed until then. The queue must hold fewer than PLOT_QUEUE_MOST.
   Errors: `status`; as plot_draw; STATUS_FAILED for a full disk or no memory. */
enum status plot_finish(struct plot *plot, enum status status, struct plot_queue *queue, const char *plots_directory,
                        const char *script);
/* Draw all, as many at a time as OpenMP has threads. `failed` is called for each that cannot be drawn, with
   status_message() saying why. */
void plot_queue_draw(struct plot_queue *queue, void (*failed)(void *to), void *to);
/* Drop what is not drawn. */
void plot_queue_free(struct plot_queue *queue);

#endif
