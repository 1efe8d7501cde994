/* What the engines should reach, beside what `bench` has measured. */
#ifndef SASBENCH_BENCH_BENCH_GOALS_H
#define SASBENCH_BENCH_BENCH_GOALS_H

#include <stdbool.h>

#include "contract/status.h"

enum { GOALS_MOST = 96 };

/* Zeroed at first. */
struct bench_goals {
    int count;
    struct bench_goal {
        char what[120];
        double value, goal;
        bool least; /* the value is to be at least the goal, else at most */
    } goal[GOALS_MOST];
};

enum bench_sense { GOAL_AT_LEAST, GOAL_AT_MOST };

/* Take down a measured value; beyond GOALS_MOST nothing is. */
void bench_goal(struct bench_goals *goals, enum bench_sense sense, double goal, double value, const char *what, ...)
    __attribute__((format(printf, 5, 6)));

/* On standard output and into DIRECTORY/goals.csv. Errors: STATUS_INVALID where it cannot be written. */
enum status bench_goals_write(const struct bench_goals *goals, const char *directory);

#endif
