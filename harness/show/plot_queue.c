/* Pictures that are drawn later (plot_queue.h). */
#include "show/plot_queue.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { PROCESSES_MOST = 16 };

struct queued_plot {
    struct plot plot; /* its path is ours */
    bool started, done;
};

static void queued_end(struct queued_plot *queued)
{
    plot_end(&queued->plot);
    free((char *)queued->plot.path);
}

/* Takes over the plot, even on failure. */
static enum status add(struct plot_queue *queue, struct plot *plot, const char *plots_directory, const char *script)
{
    if (!queue->list)
        queue->list = malloc(PLOT_QUEUE_MOST * sizeof *queue->list);
    char *path = queue->list ? strdup(plot->path) : NULL;
    enum status status = path ? plot_prepare(plot, plots_directory, script)
                              : status_set(STATUS_FAILED, "plot: '%.300s': no memory", plot->path);
    if (status != STATUS_OK) {
        free(path);
        plot_end(plot);
        return status;
    }
    struct queued_plot *queued = &queue->list[queue->count++];
    *queued = (struct queued_plot){.plot = *plot};
    queued->plot.path = path;
    return STATUS_OK;
}

enum status plot_finish(struct plot *plot, enum status status, struct plot_queue *queue, const char *plots_directory,
                        const char *script)
{
    if (status == STATUS_OK && queue)
        return add(queue, plot, plots_directory, script);
    if (status == STATUS_OK)
        status = plot_draw(plot, plots_directory, script);
    plot_end(plot);
    return status;
}

/* One step of a picture: it is started, asked whether it is ready, put into its place. */
static enum status advance(struct queued_plot *queued)
{
    bool ended = false;
    enum status status = STATUS_OK;
    if (!queued->started)
        status = plot_start(&queued->plot);
    else
        status = plot_poll(&queued->plot, &ended);
    queued->started = true;
    if (status == STATUS_OK && ended)
        status = plot_place(&queued->plot);
    queued->done = ended || status != STATUS_OK;
    return status;
}

void plot_queue_draw(struct plot_queue *queue, void (*failed)(void *to), void *to)
{
    /* The last first: a scene's slices take longest. */
    const int threads = omp_get_max_threads(), most = threads < PROCESSES_MOST ? threads : PROCESSES_MOST;
    for (int done = 0; done < queue->count;) {
        int running = 0;
        done = 0;
        for (int k = queue->count - 1; k >= 0 && running < most; k--) {
            if (!queue->list[k].done && advance(&queue->list[k]) != STATUS_OK)
                failed(to);
            running += !queue->list[k].done;
        }
        for (int k = 0; k < queue->count; k++)
            done += queue->list[k].done;
        if (done < queue->count)
            gnuplot_pause();
    }
    plot_queue_free(queue);
}

void plot_queue_free(struct plot_queue *queue)
{
    for (int k = 0; k < queue->count; k++)
        queued_end(&queue->list[k]);
    free(queue->list);
    *queue = (struct plot_queue){NULL, 0};
}
