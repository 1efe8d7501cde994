/* Tasks handed out among ranks (ranks.h). */
#define _GNU_SOURCE /* SOCK_CLOEXEC */
#include "ranks/ranks.h"

#include <errno.h>
#include <omp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ranks/link.h"
#include "results/provenance.h"
#include "text/number.h"

enum { WAIT_MS = 1 };
/* Numbers that are no tasks: none is left; between parents: one is wanted, the child has ended well, all have. From a
   child: tasks are offered, one is wanted, it waits for the others. */
enum { NONE = -1, WANTED = -2, ENDED = -3, BYE = -4, OFFER = -5, JOIN = -6 };

struct list {
    int *numbers, count, next;
};

/* A rank that rank 0 hands out to. */
struct asker {
    bool waiting;
    int next; /* place in the list behind its last task */
};

/* Of this process: the parent, or its child, which has the state at its beginning. */
static struct {
    int number, count;
    int channel[2]; /* the parent's end, the child's */
    bool again;
    /* Of the child: */
    bool met;
    int first; /* task, once it has met */
    /* Of the parent: */
    struct list ours; /* tasks that its rank was given; `next`: to hand to the child again */
    bool wanting, asked, joining;
    /* Of rank 0's: */
    struct list todo; /* a number that was handed out is NONE */
    bool offered, neighbours;
    struct asker *askers; /* [count] */
    int ended;            /* ranks other than 0 */
} ranks = {.count = 1, .channel = {-1, -1}};

static int number_of(const char *variable, int otherwise)
{
    const char *text = getenv(variable);
    long long value;
    const char *end = text ? whole_read(text, 0, 1 << 30, &value) : NULL;
    return end && !*end ? (int)value : otherwise;
}

/* Open MPI's own, or Slurm's with PMIx. */
int ranks_started(void)
{
    return number_of("OMPI_COMM_WORLD_SIZE", getenv("PMIX_RANK") ? number_of("SLURM_STEP_NUM_TASKS", 1) : 1);
}

bool ranks_refuse(void)
{
    enum { FIRST_S = 3 };
    if (ranks.count == 1 && ranks_started() > 1 && number_of("OMPI_COMM_WORLD_RANK", number_of("PMIX_RANK", 0)) > 0)
        sleep(FIRST_S);
    return true;
}

int ranks_number(void)
{
    return ranks.number;
}

int ranks_count(void)
{
    return ranks.count;
}

enum status ranks_begin(void)
{
    struct provenance ours, theirs;
    const int started = ranks_started();
    if (started == 1)
        return STATUS_OK;
    if (!link_open(&ranks.number, &ranks.count))
        return status_set(STATUS_INVALID,
                          "%d ranks, but this build is without MPI: one process is accepted, or a build where "
                          "libopenmpi-dev is installed",
                          started);
    ranks.askers = calloc((size_t)ranks.count, sizeof *ranks.askers);
    if (!ranks.askers)
        return status_set(STATUS_FAILED, "no memory for %d ranks", ranks.count);
    provenance_fill(&ours, omp_get_max_threads());
    memset(ours.date, 0, sizeof ours.date);
    return link_same(&ours, &theirs, sizeof ours)
               ? STATUS_OK
               : status_set(
                   STATUS_INVALID,
                   "rank %d: %s, %s, %d threads, program %s; rank 0: %s, %s, %d threads, program %s; ranks need "
                   "the same, or shards and merge",
                   ranks.number, ours.machine, ours.isa, ours.threads, ours.program, theirs.machine, theirs.isa,
                   theirs.threads, theirs.program);
}

/* ---- The channel ---- */

static bool bytes_move(int end, void *bytes, size_t size, bool in)
{
    for (char *at = bytes; size > 0;) {
        const ssize_t moved = in ? read(end, at, size) : send(end, at, size, MSG_NOSIGNAL);
        if (moved == 0 || (moved < 0 && errno != EINTR))
            return false;
        if (moved > 0) {
            at += moved;
            size -= (size_t)moved;
        }
    }
    return true;
}

static bool number_put(int end, int number)
{
    return bytes_move(end, &number, sizeof number, false);
}

static bool numbers_get(int end, int *numbers, int count)
{
    return bytes_move(end, numbers, (size_t)count * sizeof *numbers, true);
}

bool ranks_prepare(void)
{
    if (ranks.count == 1)
        return true;
    ranks.again = ranks.channel[0] >= 0;
    for (int k = 0; k < 2 && ranks.again; k++)
        close(ranks.channel[k]);
    ranks.ours.next = 0;
    ranks.wanting = ranks.joining = false;
    return socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ranks.channel) == 0;
}

/* ---- The child ---- */

bool ranks_again(void)
{
    return ranks.again;
}

void ranks_offer(int count, const int *tasks, bool neighbours)
{
    if (ranks.count == 1 || ranks.again)
        return;
    number_put(ranks.channel[1], OFFER);
    number_put(ranks.channel[1], neighbours);
    number_put(ranks.channel[1], count);
    bytes_move(ranks.channel[1], (void *)tasks, (size_t)count * sizeof *tasks, false);
}

void ranks_meet(void)
{
    if (ranks.number == 0)
        return;
    ranks.first = ranks_next();
    ranks.met = true;
}

int ranks_next(void)
{
    int task = NONE;
    if (ranks.met) {
        ranks.met = false;
        return ranks.first;
    }
    if (ranks.count == 1 || !number_put(ranks.channel[1], WANTED) || !numbers_get(ranks.channel[1], &task, 1))
        return NONE;
    return task;
}

void ranks_join(void)
{
    int all;
    if (ranks.count > 1 && number_put(ranks.channel[1], JOIN))
        numbers_get(ranks.channel[1], &all, 1);
}

/* ---- The parent ---- */

/* Without memory the run cannot be right. */
static void list_take(struct list *list, int count)
{
    int *numbers = realloc(list->numbers, ((size_t)list->count + (size_t)count + 1) * sizeof *numbers);
    if (!numbers) {
        fprintf(stderr, "sasbench: rank %d: no memory for %d tasks\n", ranks.number, count);
        link_abort(1);
    }
    list->numbers = numbers;
    list->count += count;
}

/* What the child sent. */
static void child_serve(void)
{
    int what, neighbours, count;
    if (!numbers_get(ranks.channel[0], &what, 1))
        return;
    ranks.wanting |= what == WANTED;
    ranks.joining |= what == JOIN;
    if (what != OFFER || !numbers_get(ranks.channel[0], &neighbours, 1) || !numbers_get(ranks.channel[0], &count, 1))
        return;
    list_take(&ranks.todo, count);
    ranks.neighbours = neighbours;
    ranks.offered = numbers_get(ranks.channel[0], ranks.todo.numbers, count);
}

/* A task for this rank's child. */
static void task_got(int task)
{
    list_take(&ranks.ours, 1);
    ranks.ours.numbers[ranks.ours.count - 1] = task;
    ranks.asked = false;
}

/* Does a rank go on at this place of the list? */
static bool is_next(int place)
{
    for (int k = 0; k < ranks.count; k++)
        if (ranks.askers[k].next == place)
            return true;
    return false;
}

/* The place of a rank's next task. Among neighbours it goes on where it is; where there is nothing left, it takes the
   longest stretch that is left, or the second half of one where another rank goes on. */
static int place_next(int asker)
{
    const struct list *todo = &ranks.todo;
    int place = ranks.neighbours ? ranks.askers[asker].next : todo->next, longest = 0;
    if (!ranks.neighbours || (place > 0 && place < todo->count && todo->numbers[place] != NONE))
        return place;
    place = todo->count;
    for (int first = 0, end; first < todo->count; first = end + 1) {
        for (end = first; end < todo->count && todo->numbers[end] != NONE; end++)
            ;
        if (end - first <= longest)
            continue;
        longest = end - first;
        place = first > 0 && is_next(first) ? first + longest / 2 : first;
    }
    return place;
}

static int todo_next(int asker)
{
    const int place = place_next(asker);
    if (place >= ranks.todo.count)
        return NONE;
    const int task = ranks.todo.numbers[place];
    ranks.todo.numbers[place] = NONE;
    ranks.todo.next = ranks.askers[asker].next = place + 1;
    return task;
}

/* What other parents sent. */
static void others_serve(void)
{
    int from, value;
    while (link_take(&from, &value)) {
        ranks.askers[from].waiting |= value == WANTED;
        ranks.ended += value == ENDED;
        if (value >= NONE)
            task_got(value);
    }
    for (int k = 1; k < ranks.count && ranks.offered; k++)
        if (ranks.askers[k].waiting) {
            ranks.askers[k].waiting = false;
            link_send(k, todo_next(k));
        }
}

/* What the child waits for. */
static void child_answer(void)
{
    if (ranks.wanting && ranks.ours.next == ranks.ours.count && !ranks.asked) {
        if (ranks.number > 0)
            link_send(0, WANTED);
        else if (ranks.offered)
            task_got(todo_next(0));
        ranks.asked = ranks.number > 0;
    }
    if (ranks.wanting && ranks.ours.next < ranks.ours.count) {
        ranks.wanting = false;
        number_put(ranks.channel[0], ranks.ours.numbers[ranks.ours.next++]);
    }
    if (ranks.joining && ranks.ended == ranks.count - 1) {
        ranks.joining = false;
        number_put(ranks.channel[0], NONE);
    }
}

pid_t ranks_wait(pid_t child, int *state)
{
    if (ranks.count == 1)
        return waitpid(child, state, 0);
    for (;;) {
        const pid_t ended = waitpid(child, state, WNOHANG);
        if (ended != 0)
            return ended;
        struct pollfd sent = {ranks.channel[0], POLLIN, 0};
        if (poll(&sent, 1, WAIT_MS) > 0)
            child_serve();
        others_serve();
        child_answer();
    }
}

void ranks_end(int status)
{
    int from = 0, value = 0;
    if (ranks.count == 1)
        return;
    if (ranks.number == 0 && ranks.ended == ranks.count - 1) {
        for (int k = 1; k < ranks.count; k++)
            link_send(k, BYE);
    } else if (status != 0 || ranks.number == 0) {
        link_abort(status);
    } else {
        link_send(0, ENDED);
        while (!link_take(&from, &value) || value != BYE) /* MPI's own wait would hold a processor */
            poll(NULL, 0, WAIT_MS);
    }
    link_close();
}
