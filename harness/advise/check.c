/* Conditions and sensitivities of a scene (check.h). */
#include "advise/check.h"

#include <math.h>
#include <string.h>

#include "contract/delay.h"
#include "text/text_append.h"
#include "measure/outcome.h"
#include "measure/session.h"
#include "show/table.h"

/* ---- conditions of the scene's own targets ---- */

/* Two of them: amplitudes, and how far apart they lie. */
static int targets_conditions(const struct scene *scene, enum precision precision, struct condition *list)
{
    const struct acquisition *a = &scene->acquisition;
    double least = INFINITY, greatest = 0, pairs = (double)a->pings * a->receivers;
    double digits = precision == PRECISION_FLOAT ? 0x1p24 : 0x1p53;
    for (int k = 0; k < scene->point_count; k++) {
        double magnitude = cabs(scene->targets[k].amplitude);
        least = magnitude > 0 ? fmin(least, magnitude) : least;
        greatest = fmax(greatest, magnitude);
    }
    if (!(greatest > 0))
        return 0;
    int count = 0;
    if (precision == PRECISION_FLOAT)
        list[count++] = (struct condition){
            "float_range",
            fmax(greatest, 1 / greatest),
            0x1p40,
            false,
            SEVERITY_INFORM,
            "the strongest echo's amplitude, or 1 over it; beyond, a power of two scales samples and image",
            "nothing: the scaling is exact"};
    list[count++] = (struct condition){"dynamic",
                                       20 * log10(greatest / least),
                                       20 * log10(digits / sqrt(pairs)),
                                       false,
                                       SEVERITY_WARN,
                                       "from the strongest point target to the weakest (dB)",
                                       "precision=double"};
    return count;
}

/* Within a fifth of its limit; but not a count that is met exactly. */
static bool is_near(const struct condition *c)
{
    return condition_holds(c) && c->severity != SEVERITY_INFORM && c->limit > 0
           && (c->at_least ? c->value < 1.2 * c->limit : c->value > 0.8 * c->limit && c->value < c->limit);
}

static const char *verdict(const struct condition *condition)
{
    if (condition_holds(condition))
        return is_near(condition) ? "near" : "met";
    return condition->severity == SEVERITY_REFUSE ? "REFUSED" : condition->severity == SEVERITY_WARN ? "warns" : "note";
}

static void condition_print(FILE *stream, const struct condition *c)
{
    const bool met = condition_holds(c) && !is_near(c);
    char figures[120], words[500];
    int used = snprintf(figures, sizeof figures, "  %-7s  %-16s %10.3g (%s %.3g)", verdict(c), c->name, c->value,
                        c->at_least ? "above" : "at most", c->limit);
    used += snprintf(words, sizeof words, "%s%s%s", c->meaning, met ? "" : "; cure: ", met ? "" : c->cure);
    const bool one_line = used + 2 <= table_width(stream);
    fprintf(stream, "%s%s%s\n", figures, one_line ? "  " : "", one_line ? words : "");
    if (!one_line)
        table_text(stream, 11, words);
}

void check_warnings(FILE *stream, const struct scene *scene, bool proposed)
{
    struct problem problem = scene_problem(scene, PRECISION_DOUBLE);
    struct condition list[SCENE_CONDITIONS + CONDITIONS_MAX];
    char text[500];
    int count = scene_conditions(scene, list);
    count += conditions_sampled(&problem, list + count, CONDITIONS_MAX);
    if (proposed) { /* such pixels are no fault of the scene */
        problem.patch_count = 0;
        conditions_scene(&problem, list);
    }
    for (int k = 0; k < count; k++)
        if (list[k].severity == SEVERITY_WARN && !condition_holds(&list[k])) {
            outcome_warning(&list[k], text, sizeof text);
            table_warning(stream, text);
        }
    fflush(stream);
}

static bool condition_same(const struct condition *a, const struct condition *b)
{
    return strcmp(a->name, b->name) == 0 && a->value == b->value && a->limit == b->limit && a->severity == b->severity
           && strcmp(a->meaning, b->meaning) == 0 && strcmp(a->cure, b->cure) == 0;
}

static void condition_keep(struct check_found *found, const struct condition *condition, const char *algorithm)
{
    int k = 0;
    while (k < found->count && !condition_same(&found->list[k].condition, condition))
        k++;
    if (k == (int)(sizeof found->list / sizeof *found->list))
        return;
    found->count += k == found->count;
    found->list[k].condition = *condition;
    found->list[k].algorithms++;
    text_append(found->list[k].names, sizeof found->list[k].names, "%s%s", *found->list[k].names ? ", " : "",
                algorithm);
}

void check_scene(const struct scene *scene, struct check_found *found)
{
    struct condition list[SCENE_CONDITIONS];
    *found = (struct check_found){.count = 0};
    for (int k = 0, count = scene_conditions(scene, list); k < count; k++)
        condition_keep(found, &list[k], "");
}

enum status check_algorithm(const struct scene *scene, const struct spec *spec, struct check_found *found,
                            bool *refused)
{
    struct problem problem = session_problem(scene, spec->algorithm, spec->precision);
    struct condition list[CONDITIONS_MAX + 2];
    void *plan = NULL;
    int count = algorithm_conditions(spec->algorithm, &problem, spec->options, list, CONDITIONS_MAX);
    count += targets_conditions(scene, spec->precision, list + count);
    for (int k = 0; k < count; k++)
        condition_keep(found, &list[k], spec->algorithm->name);
    enum status status = STATUS_OK;
    *refused = !conditions_accept(list, count);
    if (!*refused && spec->algorithm->plan) { /* `auto` has none */
        status = algorithm_plan(spec->algorithm, &problem, spec->options, &plan);
        spec->algorithm->destroy(plan);
        *refused = status == STATUS_UNSUPPORTED;
        if (*refused)
            text_append(found->unplanned, sizeof found->unplanned, "%s\n", status_message());
    }
    found->specs++;
    found->refused += *refused;
    return *refused ? STATUS_OK : status;
}

void check_print(FILE *stream, const struct scene *scene, const struct check_found *found, bool all)
{
    static const char *const verdicts[] = {"REFUSED", "warns", "note", "near", "met"};
    const int shown = (int)(sizeof verdicts / sizeof *verdicts) - !all, specs = found->specs;
    char text[500];
    int warnings = 0;
    for (int k = 0; k < found->count; k++)
        warnings += strcmp(verdict(&found->list[k].condition), "warns") == 0;
    snprintf(text, sizeof text, "%.300s: %d of %d algorithm%s this scene; %d warning%s", scene->name,
             specs - found->refused, specs, specs == 1 ? " takes" : "s take", warnings, warnings == 1 ? "" : "s");
    table_text(stream, 0, text);
    for (const char *line = found->unplanned, *end; *line; line = *end ? end + 1 : end) { /* the last may be cut */
        end = line + strcspn(line, "\n");
        snprintf(text, sizeof text, "REFUSED  %.*s", (int)(end - line), line);
        table_text(stream, 2, text);
    }
    for (int v = 0; v < shown; v++)
        for (int k = 0; k < found->count; k++) {
            if (strcmp(verdict(&found->list[k].condition), verdicts[v]) != 0)
                continue;
            condition_print(stream, &found->list[k].condition);
            if (*found->list[k].names && found->list[k].algorithms < specs)
                table_text(stream, 11, found->list[k].names);
        }
    if (!all)
        fputs("--all: every condition, and the image's sensitivity to sound speed, track and carrier\n", stream);
}

/* ---- sensitivities ---- */

enum quantity { SOUND_SPEED, CARRIER, RANGE, SPEED, POSITION };

/* Phase (rad) of a pair after a small relative error of the quantity, or an error in metres of the transmitter's
   position. */
static double phase_of(const struct scene *scene, int ping, int receiver, struct vector p,
                       const double off[SENSITIVITIES])
{
    const struct acquisition *a = &scene->acquisition;
    struct vector tx = a->tx[ping], v = a->velocity[ping];
    struct vector rx = a->rx[(size_t)ping * (size_t)a->receivers + (size_t)receiver];
    tx.y -= off[POSITION];
    p.y *= 1 + off[RANGE];
    v.x *= 1 + off[SPEED];
    return 2 * M_PI * a->fc * (1 + off[CARRIER]) * delay_exact(tx, rx, v, p, a->sound_speed * (1 + off[SOUND_SPEED]));
}

/* The middle of the outermost pixels. */
static struct vector middle_of(const struct scene *scene)
{
    double x[2] = {INFINITY, -INFINITY}, r[2] = {INFINITY, -INFINITY};
    for (int k = 0; k < scene->patch_count; k++) {
        const struct grid *g = &scene->patches[k];
        for (int corner = 0; corner < 4; corner++) {
            const struct vector p = grid_point(g, corner / 2 * (g->r_count - 1), corner % 2 * (g->x_count - 1));
            x[0] = fmin(x[0], p.x);
            x[1] = fmax(x[1], p.x);
            r[0] = fmin(r[0], p.y);
            r[1] = fmax(r[1], p.y);
        }
    }
    return (struct vector){(x[0] + x[1]) / 2, (r[0] + r[1]) / 2, 0};
}

void check_sensitivities(const struct scene *scene, struct sensitivity list[SENSITIVITIES])
{
    static const struct {
        const char *quantity, *change;
        double size; /* relative; of positions m */
    } changes[SENSITIVITIES] = {
        [SOUND_SPEED] = {"sound speed", "a relative error of 1e-5", 1e-5},
        [CARRIER] = {"carrier", "a relative error of 1e-5", 1e-5},
        [RANGE] = {"range", "a relative error of 1e-5", 1e-5},
        [SPEED] = {"speed", "a relative error of 1e-2", 1e-2},
        [POSITION] = {"positions", "a transmitter 1 mm off", 1e-3},
    };
    const struct acquisition *a = &scene->acquisition;
    const struct vector middle = middle_of(scene);
    const double sine = condition_beam_sine(a);
    for (int q = 0; q < SENSITIVITIES; q++) {
        const double none[SENSITIVITIES] = {0};
        double off[SENSITIVITIES] = {0}, least = INFINITY, greatest = -INFINITY;
        off[q] = changes[q].size;
        for (int n = 0; n < 2 * a->pings; n++) {
            int m = n % 2 ? a->receivers - 1 : 0;
            if (!condition_sees(a, sine, n / 2, middle))
                continue;
            double moved = phase_of(scene, n / 2, m, middle, off) - phase_of(scene, n / 2, m, middle, none);
            least = fmin(least, moved);
            greatest = fmax(greatest, moved);
        }
        double phase = least <= greatest ? fmax(fabs(least), fabs(greatest)) : 0;
        double shared = least <= greatest ? (least + greatest) / 2 : 0;
        list[q] = (struct sensitivity){.quantity = changes[q].quantity,
                                       .change = changes[q].change,
                                       .kappa = phase / changes[q].size,
                                       .phase = phase,
                                       .spread = least <= greatest ? greatest - least : 0,
                                       .shift_m = fabs(shared) * a->sound_speed / (4 * M_PI * a->fc)};
    }
}

void check_sensitivities_print(FILE *stream, const struct scene *scene)
{
    struct sensitivity list[SENSITIVITIES];
    check_sensitivities(scene, list);
    fputs("Sensitivities of the image's middle (a spread over the aperture > pi/4 blurs):\n", stream);
    for (int q = 0; q < SENSITIVITIES; q++) {
        char text[400];
        snprintf(text, sizeof text,
                 "%s in %s moves the phase by %.3g rad, the image by %.3g mm in range; %.3g rad over the "
                 "aperture (kappa %.3g%s)",
                 list[q].change, list[q].quantity, list[q].phase, 1e3 * list[q].shift_m, list[q].spread, list[q].kappa,
                 q == POSITION ? " rad/m" : "");
        table_text(stream, 2, text);
    }
}
