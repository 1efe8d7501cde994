#include "advise/planned.h"
#include "files/paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "backprojection/pairs/pairs.h"
#include "files/csv.h"
#include "echoes/echo_data.h"
#include "scene/simulate.h"
#include "show/table.h"
#include "text/text_append.h"

const char *const plan_verdict_names[] = {[CANDIDATE_CHOSEN] = "chosen",
                                          [CANDIDATE_SLOWER] = "slower",
                                          [CANDIDATE_ERROR] = "error",
                                          [CANDIDATE_MEMORY] = "memory",
                                          [CANDIDATE_REFUSED] = "refused"};

/* Echoes to measure an error within the time of a plan: of some of the targets, evenly chosen, if there are more.
   Recorded ones as they are. */
enum { TARGETS_MOST = 16, SAMPLES_MOST = 30000000 };

static enum status echoes_make(const struct scene *scene, struct echoes echoes[2])
{
    struct target targets[TARGETS_MOST];
    struct scene some = *scene;
    if (scene->target_count > TARGETS_MOST) {
        for (int k = 0; k < TARGETS_MOST; k++)
            targets[k] = scene->targets[(long long)k * (scene->target_count - 1) / (TARGETS_MOST - 1)];
        some.targets = targets;
        some.target_count = TARGETS_MOST;
    }
    const enum status status = scene_echoes_both(&some, echoes);
    echoes[PRECISION_FLOAT].acquisition = echoes[PRECISION_DOUBLE].acquisition = &scene->acquisition;
    return status;
}

enum status planned_make(const struct scene *scene, const struct budget *budget, bool both, struct planned *planned)
{
    const struct acquisition *a = &scene->acquisition;
    struct echoes echoes[2] = {{0}};
    enum status status = STATUS_OK;
    *planned = (struct planned){.scene = scene, .budget = *budget};
    planned->measured = (double)a->pings * a->receivers * a->samples <= SAMPLES_MOST;
    if (planned->measured)
        status = echoes_make(scene, echoes);
    for (int precision = 0; precision < 2 && status == STATUS_OK; precision++) {
        const struct problem problem = scene_problem(scene, (enum precision)precision);
        const bool found = planned->choices[PRECISION_FLOAT].found;
        if (both || !found)
            status = choice_make(&problem, planned->measured && !found ? echoes : NULL, budget,
                                 &planned->choices[precision]);
    }
    echoes_free(&echoes[PRECISION_FLOAT]);
    echoes_free(&echoes[PRECISION_DOUBLE]);
    return status;
}

void planned_free(struct planned *planned)
{
    choice_free(&planned->choices[0]);
    choice_free(&planned->choices[1]);
}

int planned_precision(const struct planned *planned)
{
    return planned->choices[PRECISION_FLOAT].found    ? PRECISION_FLOAT
           : planned->choices[PRECISION_DOUBLE].found ? PRECISION_DOUBLE
                                                      : -1;
}

/* "2.1e-04", or "-" where unknown or none. */
static const char *error_text(double error, char text[16])
{
    if (error > 0 && error < INFINITY)
        snprintf(text, 16, "%.1e", error);
    else
        snprintf(text, 16, "-");
    return text;
}

static void candidate_print(FILE *stream, const struct candidate *candidate)
{
    char name[CANDIDATE_NAME], cells[CAUSES + 1][16];
    candidate_name(candidate, name);
    fprintf(stream, "%c %-26s", candidate->verdict == CANDIDATE_CHOSEN ? '>' : ' ', name);
    if (strlen(name) > 26) /* a line of its own */
        fprintf(stream, "\n%28s", "");
    fprintf(stream, " %8s %7s", cell_time(candidate->seconds).text, error_text(candidate->error, cells[CAUSES]));
    for (int k = 0; k < CAUSES; k++)
        fprintf(stream, " %7s", error_text(candidate->forecast.error[k], cells[k]));
    fprintf(stream, " %8s\n", cell_significant(1e-9 * candidate->flops, " GF").text);
}

bool planned_nearest(const struct choice *choice, int k)
{
    const struct candidate *c = &choice->list[k];
    bool nearest = c->verdict > CANDIDATE_SLOWER;
    for (int n = 0; n < choice->count && nearest; n++) {
        const struct candidate *other = &choice->list[n];
        if (n == k || other->algorithm != c->algorithm)
            continue;
        const bool refused = isinf(c->error), better = other->error < c->error;
        nearest = other->verdict > CANDIDATE_SLOWER && !better && !(refused && isinf(other->error) && n < k);
    }
    return nearest;
}

/* Without the algorithm's name. */
static const char *reason_of(const struct candidate *c)
{
    const size_t own = strlen(c->algorithm->name);
    const bool named = strncmp(c->reason, c->algorithm->name, own) == 0 && strncmp(c->reason + own, ": ", 2) == 0;
    return c->reason + (named ? own + 2 : 0);
}

/* A reason that several algorithms share is printed once. */
static void rejected_print(FILE *stream, const struct choice *choice)
{
    const char *said = "", *by = "";
    for (int k = 0; k < choice->count; k++) {
        const struct candidate *c = &choice->list[k];
        if (planned_nearest(choice, k)) {
            char text[600], name[CANDIDATE_NAME];
            const char *reason = reason_of(c);
            candidate_name(c, name);
            if (strcmp(reason, said) == 0)
                snprintf(text, sizeof text, "%s: as %s", name, by);
            else
                snprintf(text, sizeof text, "%s: %s", name, reason);
            table_text(stream, 2, text);
            if (strcmp(reason, said) != 0) {
                said = reason;
                by = c->algorithm->name;
            }
        }
    }
}

void planned_left_out(const struct problem *problem, const struct candidate *chosen,
                      void (*line)(void *to, const char *text), void *to)
{
    const struct acquisition *a = problem->acquisition;
    const struct forecast *f = &chosen->forecast;
    char text[400];
    if (f->image_cost > 0) {
        snprintf(text, sizeof text, "the sum over pairs, for which images of subapertures are read: %.2g",
                 f->error[CAUSE_INTERPOLATION]);
        line(to, text);
    } else if (f->sums_pairs) {
        const double all = (double)a->pings * a->receivers * problem_pixels(problem);
        const double left = 100 * (1 - chosen->pairs / all);
        if (chosen->sine < 1)
            snprintf(text, sizeof text,
                     "%.3g %% of the pairs of pixels and records, which meet no sample or lie beyond "
                     "|sin theta| = %.3g: %.2g",
                     left, chosen->sine, f->error[CAUSE_APERTURE]);
        else
            snprintf(text, sizeof text, "%.3g %% of the pairs of pixels and records, which meet no sample%s: 0", left,
                     a->aperture_limit < 1 ? " inside the aperture limit" : "");
        if (left > 0)
            line(to, text);
        snprintf(text, sizeof text, "exact values between samples: %.2g", f->error[CAUSE_INTERPOLATION]);
        line(to, text);
        snprintf(text, sizeof text,
                 f->tables ? "delays of all pings but one, which repeat from ping to ping: %.2g"
                           : "delays of all pixels but those between which they are interpolated: %.2g",
                 f->error[CAUSE_DELAYS]);
        line(to, text);
    } else {
        snprintf(text, sizeof text, "the sum over pairs: %.2g by the spectrum, %.2g by blocks or terms, %.2g by Stolt",
                 f->error[CAUSE_SPECTRUM], f->error[CAUSE_BLOCKS], f->error[CAUSE_STOLT]);
        line(to, text);
    }
    if (problem->precision == PRECISION_FLOAT) {
        snprintf(text, sizeof text, "double precision: %.2g", f->error[CAUSE_FLOAT]);
        line(to, text);
    }
}

static void line_print(void *stream, const char *text)
{
    table_text(stream, 2, text);
}

/* Does the image keep up with the platform? Printed for one grid only: patches are only places of an image. */
static void passage_print(FILE *stream, const struct scene *scene, double seconds)
{
    const struct grid *g = &scene->patches[0];
    const double speed = fabs(scene->acquisition.velocity[0].x);
    double least = INFINITY, most = -INFINITY;
    for (int k = 0; k < 4; k++) {
        const double x = grid_point(g, k / 2 * (g->r_count - 1), k % 2 * (g->x_count - 1)).x;
        least = fmin(least, x);
        most = fmax(most, x);
    }
    if (scene->patch_count == 1 && most > least && speed > 0)
        fprintf(stream, "The platform passes the %s of the image along its track in %s, %.3g times the imaging time.\n",
                cell_significant(most - least, " m").text, cell_time((most - least) / speed).text,
                (most - least) / speed / seconds);
}

/* As a SPEC. */
static void spec_format(const struct candidate *candidate, int precision, char *text, size_t size)
{
    char name[CANDIDATE_NAME];
    candidate_name(candidate, name);
    snprintf(text, size, "%s%s%s", name,
             precision == PRECISION_FLOAT ? ""
             : *candidate->settings       ? ","
                                          : ":",
             precision == PRECISION_FLOAT ? "" : "precision=double");
}

/* "rma" of rma_delay. */
static bool family_same(const struct candidate *a, const struct candidate *b)
{
    const size_t length = strcspn(a->algorithm->name, "_");
    return strncmp(a->algorithm->name, b->algorithm->name, length + 1) == 0;
}

/* Of a family's algorithms but the chosen one: the fastest within the budget, or else the one nearest to it. */
static const struct candidate *runner_up(const struct choice *choice, const struct candidate *of)
{
    const struct candidate *best = NULL;
    for (int k = 0; k < choice->count; k++) {
        const struct candidate *c = &choice->list[k];
        if (!family_same(c, of) || (choice->found && c->algorithm == choice->list[0].algorithm))
            continue;
        if (c->verdict == CANDIDATE_SLOWER)
            return c;
        if (!best || c->error < best->error)
            best = c;
    }
    return best;
}

static void runner_up_print(FILE *stream, const struct candidate *c, const struct candidate *chosen)
{
    char text[700], name[CANDIDATE_NAME];
    const char *reason = reason_of(c), *cure = strstr(reason, " (cure: ");
    candidate_name(c, name);
    if (c->verdict == CANDIDATE_SLOWER && c->error < INFINITY)
        snprintf(text, sizeof text, "%s: error %.1e, %s, %.2f times as long", name, c->error,
                 cell_time(c->seconds).text, c->seconds / chosen->seconds);
    else
        snprintf(text, sizeof text, "%s: %.*s", name, cure ? (int)(cure - reason) : (int)strlen(reason), reason);
    table_text(stream, 2, text);
}

void planned_answer(FILE *stream, const struct planned *planned, const char *source)
{
    enum { FAMILIES_SHOWN = 5 };
    const int chosen = planned_precision(planned), precision = chosen >= 0 ? chosen : PRECISION_DOUBLE;
    const struct choice *choice = &planned->choices[precision];
    const struct candidate *best = &choice->list[0], *last[FAMILIES_SHOWN];
    char spec[CANDIDATE_NAME + 40], text[300], word[CANDIDATE_NAME + 60] = "";
    int shown = 0;
    if (choice->found) {
        spec_format(best, precision, spec, sizeof spec);
        snprintf(text, sizeof text, "%s: predicted error %.1e, %s, %s of memory", spec, best->error,
                 cell_time(best->seconds).text, cell_significant(1e-6 * best->bytes, " MB").text);
        table_text(stream, 0, text);
        text_append_word(word, sizeof word, spec);
        fprintf(stream, "  %s image %s -a %s -o image.mat\n", program_called(), source, word);
    } else {
        fprintf(stream, "Nothing is within an error of %.2g.\n", planned->budget.error);
    }
    fputs("The next of each family:\n", stream);
    for (int k = 0; k < choice->count && shown < FAMILIES_SHOWN; k++) {
        bool seen = false;
        for (int n = 0; n < shown; n++)
            seen |= family_same(&choice->list[k], last[n]);
        const struct candidate *next = seen ? NULL : runner_up(choice, &choice->list[k]);
        if (!next)
            continue;
        runner_up_print(stream, next, best);
        last[shown++] = next;
    }
}

void planned_print(FILE *stream, const struct planned *planned)
{
    const int chosen = planned_precision(planned), precision = chosen >= 0 ? chosen : PRECISION_DOUBLE;
    const struct choice *choice = &planned->choices[precision];
    int shown = 0;
    fprintf(stream, "Within the error of %.2g after one gain, in %s:\n", planned->budget.error,
            precision_name((enum precision)precision));
    fprintf(stream, "  %-26s %8s %7s %7s %7s %7s %7s %7s %7s %7s %8s\n", "candidate", "time", "error", "interp.",
            "delays", "spectr.", "blocks", "stolt", "apert.", "float", "work");
    for (int k = 0; k < choice->count; k++)
        if (choice->list[k].verdict <= CANDIDATE_SLOWER) {
            candidate_print(stream, &choice->list[k]);
            shown++;
        }
    if (shown == 0)
        fprintf(stream, "  none\n");
    fprintf(stream, "\nRejected, the nearest of each algorithm:\n");
    rejected_print(stream, choice);
    if (choice->found) {
        const struct candidate *best = &choice->list[0];
        char spec[CANDIDATE_NAME + 40];
        const struct scene *scene = planned->scene;
        const struct problem problem = scene_problem(scene, (enum precision)precision);
        fprintf(stream, "\nLeft out, and the error that it adds:\n");
        planned_left_out(&problem, best, line_print, stream);
        spec_format(best, precision, spec, sizeof spec);
        const double plan = choice->work.bytes;
        fprintf(stream, "\nChosen: %s, about %s\nThe process takes %s of memory, %s of them the plan.\n", spec,
                cell_time(best->seconds).text, cell_significant(1e-6 * best->bytes, " MB").text,
                cell_significant(1e-6 * plan, " MB").text);
        passage_print(stream, scene, best->seconds);
    }
}

void planned_write(FILE *stream, const struct planned *planned)
{
    fprintf(stream, "scene,algorithm,options,precision,verdict,seconds,error");
    for (int k = 0; k < CAUSES; k++)
        fprintf(stream, ",error_%s", cause_names[k]);
    fprintf(stream, ",flops,pairs,bytes,reason\n");
    for (int precision = 0; precision < 2; precision++)
        for (int n = 0; n < planned->choices[precision].count; n++) {
            const struct candidate *c = &planned->choices[precision].list[n];
            const char *const names[] = {planned->scene->name,
                                         c->algorithm->name,
                                         c->settings,
                                         precision_name((enum precision)precision),
                                         plan_verdict_names[c->verdict],
                                         NULL};
            double numbers[5 + CAUSES] = {isinf(c->seconds) ? NAN : c->seconds, isinf(c->error) ? NAN : c->error};
            for (int k = 0; k < CAUSES; k++)
                numbers[2 + k] = isinf(c->error) ? NAN : c->forecast.error[k];
            memcpy(numbers + 2 + CAUSES, (double[]){c->flops, c->pairs, c->bytes}, 3 * sizeof *numbers);
            csv_write_fields(stream, names, numbers, 5 + CAUSES, false);
            csv_write_fields(stream, (const char *const[]){c->reason, NULL}, NULL, 0, true);
        }
}
