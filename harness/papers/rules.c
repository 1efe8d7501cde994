/* BP22's and ZP15's rules on scenes from seeds (rules.h). */
#include "papers/rules.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "echoes/echo_data.h"
#include "files/paths.h"
#include "files/text_file.h"
#include "metrics/metrics.h"
#include "measure/session.h"
#include "measure/timing.h"
#include "papers/tables.h"
#include "scene/random_scene.h"

enum { SCENES = 200, SEED_FIRST = 7001, SEEDS_MOST = 300 }; /* not the seeds that the planner was made with */
static const double budget = 0.1, twice = 2;                /* error; f_s over the bandwidth, as in BP22 section 3.3 */

/* ---- the rules ---- */

static int bp22_rate(const struct acquisition *a)
{
    return upsampling_rate(a->sound_speed / (2 * a->fs), a->tx_length / 2, a->sound_speed / a->fc) + 1;
}

static int zp15_rate(const struct acquisition *a)
{
    return (int)ceil(2 * a->fc / a->fs);
}

static const struct {
    const char *algorithm, *param;
    int inserted, most; /* the rate is the setting plus `inserted`; `most`: the algorithm's largest */
    int (*rate)(const struct acquisition *a);
} rules[] = {{"bp_linear", "beta", 1, 1025, bp22_rate}, {"bp_zeropad", "factor", 0, 256, zp15_rate}};
enum { RULES = sizeof rules / sizeof *rules };

const char *const rule_names[] = {"bp22_eq20", "zp15_eighth", NULL};
const char *const rule_quantities[] = {"met", "met_2b", "error", "overpaid", NULL};

/* ---- following the rules ---- */

static const char header[] = "seed,rule,algorithm,options,oversampling,error_gain,rate,rate_enough";

/* The option for a rate: "beta=7". */
static void options_format(int rule, int rate, char *text, size_t size)
{
    snprintf(text, size, "%s=%d", rules[rule].param, rate - rules[rule].inserted);
}

static enum status spec_of(int rule, int rate, struct spec *spec)
{
    char options[40], text[80];
    options_format(rule, rate, options, sizeof options);
    snprintf(text, sizeof text, "%s:%s", rules[rule].algorithm, options);
    return spec_parse(text, spec);
}

static bool rate_suffices(const struct problem *problem, int rule, int rate)
{
    struct spec spec;
    struct forecast forecast;
    bool within = false;
    if (spec_of(rule, rate, &spec) == STATUS_OK) {
        within = algorithm_forecast(spec.algorithm, problem, spec.options, &forecast) == STATUS_OK
                 && forecast_error(&forecast) <= budget;
        spec_free(&spec);
    }
    return within;
}

/* The least rate with a predicted error within the budget; NAN without one. */
static double rate_enough(const struct problem *problem, int rule)
{
    int high = 1, low = 0; /* the least sufficient rate so far, or none; an insufficient one */
    while (!rate_suffices(problem, rule, high)) {
        if (high == rules[rule].most)
            return NAN;
        low = high;
        high = 2 * high < rules[rule].most ? 2 * high : rules[rule].most;
    }
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (rate_suffices(problem, rule, middle))
            high = middle;
        else
            low = middle;
    }
    return high;
}

static enum status rule_follow(struct session *session, int seed, int rule, FILE *file)
{
    const struct scene *scene = session->scene;
    const int asked = rules[rule].rate(&scene->acquisition), rate = asked < rules[rule].most ? asked : rules[rule].most;
    char options[40];
    struct spec spec;
    struct image image;
    double error = NAN;
    options_format(rule, rate, options, sizeof options);
    enum status status = spec_of(rule, rate, &spec);
    if (status != STATUS_OK)
        return status;
    const struct problem problem = session_problem(scene, spec.algorithm, spec.precision);
    status = session_image(session, &spec, &image);
    if (status == STATUS_OK) {
        error = metrics_error(&image, &session->reference).error_gain;
        image_free(&image);
    }
    spec_free(&spec);
    if (status == STATUS_FAILED)
        return status;
    fprintf(file, "%d,", seed);
    csv_write_fields(
        file, (const char *const[]){rule_names[rule], rules[rule].algorithm, options, NULL},
        (double[]){scene->acquisition.fs / scene->acquisition.bandwidth, error, rate, rate_enough(&problem, rule)}, 4,
        true);
    return STATUS_OK;
}

/* One scene; `path` is its file, which is overwritten. *count grows by one where its exact image is not empty. */
static enum status seed_follow(int seed, const char *path, FILE *file, int *count)
{
    struct text_file drawn;
    struct scene scene;
    struct session session;
    enum status status = text_file_open(path, &drawn);
    if (status != STATUS_OK)
        return status;
    random_scene_write(drawn.stream, (uint64_t)seed);
    status = text_file_close(&drawn, STATUS_OK);
    if (status == STATUS_OK)
        status = scene_load(path, data_path(DATA_SCENES), &scene);
    if (status != STATUS_OK)
        return status;
    status = session_open(&scene, &session);
    if (status == STATUS_OK) {
        const bool seen = metrics_error(&session.reference, &session.reference).error == 0;
        for (int rule = 0; rule < RULES && status == STATUS_OK && seen; rule++)
            status = rule_follow(&session, seed, rule, file);
        *count += seen;
        session_close(&session);
    }
    scene_free(&scene);
    return status;
}

enum status rules_study(const char *directory)
{
    char scene[4200];
    struct text_file file;
    int count = 0;
    enum status status = text_file_in(directory, RULES_FILE, &file);
    if (status != STATUS_OK)
        return status;
    fprintf(file.stream, "# sasbench rules on random scenes 1\n%s\n", header);
    snprintf(scene, sizeof scene, "%s/random.cfg", directory);
    for (int seed = SEED_FIRST; count < SCENES && seed < SEED_FIRST + SEEDS_MOST && status == STATUS_OK; seed++)
        status = seed_follow(seed, scene, file.stream, &count);
    place_clear(scene);
    return text_file_close(&file, status);
}

/* ---- results ---- */

double rule_value(struct measured *measured, const char *rule, const char *quantity, double number)
{
    const struct csv *csv = &measured->rules;
    double values[SCENES], error, rate, enough, oversampling;
    const int column = csv_column(csv, "rule"), error_column = csv_column(csv, "error_gain");
    const int rate_column = csv_column(csv, "rate"), enough_column = csv_column(csv, "rate_enough");
    const int oversampling_column = csv_column(csv, "oversampling");
    const bool of_2b = strcmp(quantity, "met_2b") == 0, share = of_2b || strcmp(quantity, "met") == 0;
    int count = 0, scenes = 0, met = 0;
    if (column < 0 || error_column < 0 || rate_column < 0 || enough_column < 0 || oversampling_column < 0)
        return measured_missing(measured, "the rules were not followed on scenes from seeds");
    for (int row = 0; row < csv->row_count && scenes < SCENES; row++) {
        if (strcmp(csv_cell(csv, row, column), rule) != 0
            || (of_2b && (!csv_number(csv_cell(csv, row, oversampling_column), &oversampling) || oversampling < twice)))
            continue;
        scenes++;
        if (!csv_number(csv_cell(csv, row, error_column), &error) || !isfinite(error))
            continue;
        met += error <= number;
        if (strcmp(quantity, "overpaid") != 0)
            values[count++] = error;
        else if (csv_number(csv_cell(csv, row, rate_column), &rate)
                 && csv_number(csv_cell(csv, row, enough_column), &enough) && enough > 0)
            values[count++] = rate / enough;
    }
    if (count == 0)
        return measured_missing(measured, "no scene from a seed has %s of %s", quantity, rule);
    return share ? (double)met / scenes : quantile(values, count, number);
}
