#include "bench/bench_goals.h"

#include <stdarg.h>
#include <stdio.h>

#include "files/text_file.h"

void bench_goal(struct bench_goals *goals, enum bench_sense sense, double goal, double value, const char *what, ...)
{
    va_list list;
    if (goals->count == GOALS_MOST)
        return;
    struct bench_goal *next = &goals->goal[goals->count++];
    va_start(list, what);
    vsnprintf(next->what, sizeof next->what, what, list);
    va_end(list);
    next->value = value;
    next->goal = goal;
    next->least = sense == GOAL_AT_LEAST;
}

enum status bench_goals_write(const struct bench_goals *goals, const char *directory)
{
    char path[4096];
    struct text_file file;
    snprintf(path, sizeof path, "%s/goals.csv", directory);
    enum status status = text_file_open(path, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# sasbench goals 1\nwhat,value,sense,goal,held\n");
    printf("\n%-82s %9s    %9s\n", "goals", "measured", "goal");
    int held = 0;
    for (int k = 0; k < goals->count; k++) {
        const struct bench_goal *g = &goals->goal[k];
        const bool holds = g->least ? g->value >= g->goal : g->value <= g->goal;
        held += holds;
        fprintf(file.stream, "\"%s\",%.4g,%s,%g,%s\n", g->what, g->value, g->least ? "at least" : "at most", g->goal,
                holds ? "yes" : "no");
        printf("%-82s %9.3g %s %9.3g%s\n", g->what, g->value, g->least ? ">=" : "<=", g->goal, holds ? "" : "  missed");
    }
    printf("%d of %d goals are held: %s\n", held, goals->count, path);
    return text_file_close(&file, status);
}
