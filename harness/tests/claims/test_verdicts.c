/* Verdicts follow what was measured: each that can change does, and a fault in an algorithm changes it. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/paths.h"
#include "scene/random.h"
#include "measure/outcome.h"
#include "measure/session.h"
#include "papers/rules.h"
#include "tests/planted.h"

/* --- Faults --------------------------------------------------------------------------------------------------- */

/* A small scene that stands in for those of the claims. */
static const char scatterers[] =
    "description = \"stand-in\"; sonar = { fc = 150e3; bandwidth = 15e3; fs = 30e3; };\n"
    "pulse = { kind = \"flat\"; };\n"
    "array = { tx_length = 0.08; rx_length = 0.04; receivers = 8; first_offset = 0.06; pitch = 0.06; };\n"
    "track = { speed = 2.5; pri = 0.096; pings = 24; x_first = -2.8; };\n"
    "record = { first_sample = 520; samples = 512; };\n"
    "beam = { kind = \"txrx\"; truncation = \"tx\"; limit = 0.443; };\n"
    "targets = { fields = ( { x = [-0.3, 0.3]; r = [14.5, 19.5]; count = 60; seed = 4; } ); };\n"
    "image = { x = { first = -0.4019; step = 0.04; count = 21; };\n"
    "          r = { first = 14.5113; step = 0.0971; count = 50; }; };\n";

static enum fault { FAULT_NONE, FAULT_NO_INTERPOLATION, FAULT_PHASE, FAULT_RANGE_MIGRATION } injected;

/* A phase that grows along azimuth. */
static void phase_spoil(struct image *image)
{
    float complex *pixels = image->pixels[0];
    for (int k = 0; k < image->patches[0].r_count * image->patches[0].x_count; k++)
        pixels[k] *= (float complex)cexp(0.05 * I * (k % image->patches[0].x_count));
}

static const struct algorithm *spoiled;

static enum status spoiled_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages)
{
    enum status status = spoiled->execute(plan, echoes, image, stages);
    phase_spoil(image);
    return status;
}

/* The stand-in has scatterers alone: its error, in dB, stands for the side lobes of the targets that claims ask for. */
static void side_lobes_plant(const char *scene, const struct spec *spec, double error)
{
    const double lobes_db = 20 * log10(error);
    for (int k = 0; k < 8; k++) {
        const struct target_row target = {.scene = scene,
                                          .algorithm = spec->algorithm->name,
                                          .options = spec->text,
                                          .precision = precision_name(spec->precision),
                                          .target = k,
                                          .axis = "azimuth",
                                          .definition = "pixel",
                                          .extent_m = 3,
                                          .pslr_db = lobes_db,
                                          .islr_db = lobes_db};
        assert_int_equal(results_folder_targets(rows, &target, 1), STATUS_OK);
    }
}

/* Measure SPEC on a session whose scene has a name that claims ask for, with the fault if it concerns SPEC. */
static void measure(struct session *session, const char *spec_text)
{
    struct spec spec, used;
    struct outcome outcome;
    char text[200];
    scheme_spec(SCHEME_CORRECTED, spec_text, text, sizeof text);
    assert_int_equal(spec_parse(text, &spec), STATUS_OK);
    bool replaced = injected == FAULT_NO_INTERPOLATION && strcmp(spec.algorithm->name, "bp_linear") == 0;
    assert_int_equal(spec_parse(replaced ? NEAREST : text, &used), STATUS_OK);
    struct algorithm faulty = *used.algorithm;
    if ((injected == FAULT_PHASE && strcmp(spec.algorithm->name, "bp_zeropad") == 0)
        || (injected == FAULT_RANGE_MIGRATION && strcmp(spec.algorithm->name, "rma_lbf") == 0)) {
        spoiled = used.algorithm;
        faulty.execute = spoiled_execute;
        used.algorithm = &faulty;
    }
    outcome_measure(session, &used, EFFORT_NONE, NULL, &outcome);
    assert_string_equal(outcome.row.status, "ok");
    struct measurement row = planted_row(session->scene->name, &spec);
    row.error = outcome.row.error;
    row.error_gain = outcome.row.error_gain;
    row.phase_rms_rad = outcome.row.phase_rms_rad;
    row.width_m = outcome.row.width_m;
    row.pslr_db = outcome.row.pslr_db;
    row.islr_db = outcome.row.islr_db;
    assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
    side_lobes_plant(session->scene->name, &spec, row.error);
    outcome_free(&outcome);
    spec_free(&used);
    spec_free(&spec);
}

static void faults_change_verdicts(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *specs[3];
    } wanted[] = {
        {"bp22/speckle", {NEAREST, LINEAR_2, LINEAR_8}},
        {"bp22/many", {NEAREST, LINEAR_2, LINEAR_8}},
        {"zp15/speckle", {ZEROPAD_8, "bp_zeropad:factor=16", "bp_zeropad:factor=32"}},
        {"lbf21/table3_near", {LBF_16, PCA_16}},
        {"lbf21/table3_far", {LBF_16, PCA_16}},
        {"lbf21/table4_near", {LBF_16, PCA_16}},
        {"lbf21/table4_far", {LBF_16, PCA_16}},
        {"lbf21/table3_near_middle", {LBF_16, PCA_16}},
        {"lbf21/table3_far_middle", {LBF_16, PCA_16}},
        {"lbf21/table4_near_middle", {LBF_16, PCA_16}},
    };
    static const struct {
        const char *claim;
        enum fault fault;
    } flips[] = {
        {"bp22-5-2", FAULT_NO_INTERPOLATION},        /* two interpolations lower the error */
        {"zp15-abstract-3", FAULT_PHASE},            /* zero padding is interpolation */
        {"lbf21-abstract-5", FAULT_RANGE_MIGRATION}, /* LBF images better than PCA */
    };
    char path[300];
    snprintf(path, sizeof path, "%s/scatterers.cfg", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(scatterers, file);
    assert_int_equal(fclose(file), 0);
    struct scene scene;
    struct session session;
    assert_int_equal(scene_load(path, ".", &scene), STATUS_OK);
    assert_int_equal(session_open(&scene, &session), STATUS_OK);
    char *name = scene.name;
    for (injected = FAULT_NONE; injected <= FAULT_RANGE_MIGRATION; injected++) {
        struct measured measured;
        planted_begin();
        for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++)
            for (int n = 0; n < 3 && wanted[k].specs[n]; n++) {
                scene.name = (char *)wanted[k].scene;
                measure(&session, wanted[k].specs[n]);
            }
        planted_end(&measured);
        for (size_t k = 0; k < sizeof flips / sizeof *flips; k++)
            (strncmp(flips[k].claim, "lbf21", 5) == 0 ? expect_corrected : expect)(
                &measured, flips[k].claim, flips[k].fault == injected ? CLAIM_FAILS : CLAIM_HOLDS);
        planted_clear(&measured);
    }
    session_close(&session);
    scene.name = name;
    scene_free(&scene);
}

/* --- Drawn measurements --------------------------------------------------------------------------------------- */

static struct random generator;

/* Even between two numbers. */
static double drawn(double low, double high)
{
    return low + (high - low) * random_uniform(&generator);
}

static bool coin(void)
{
    return random_uniform(&generator) < 0.5;
}

/* All rows that a claim asks for, with numbers to be drawn. */
static void claim_plant(const struct claims *claims, const struct claim *claim)
{
    static const char *const definitions[] = {"null", "3db", "pixel", "null"}; /* the last one along range */
    planted_begin();
    for (int k = 0; k < claim->need_count; k++) {
        struct spec spec;
        assert_int_equal(spec_own(claim->needs[k].spec, &spec), STATUS_OK);
        for (int target = 0; target < 48 && claim_has(claims, claim, "target_"); target++)
            for (int d = 0; d < 4; d++) {
                const struct target_row row = {
                    .scene = claim->needs[k].scene,
                    .algorithm = spec.algorithm->name,
                    .options = spec.text,
                    .precision = precision_name(spec.precision),
                    .target = target,
                    .axis = d < 3 ? "azimuth" : "range",
                    .definition = definitions[d],
                    .extent_m = 3,
                };
                if (target < 8 || strstr(claim->needs[k].scene, "many"))
                    assert_int_equal(results_folder_targets(rows, &row, 1), STATUS_OK);
            }
        struct measurement row = planted_row(claim->needs[k].scene, &spec);
        assert_int_equal(results_folder_add(rows, &row), STATUS_OK);
        spec_free(&spec);
    }
}

/* Sizes and energies as they are, which the first evaluation works out, or drawn. */
static void scene_numbers_draw(struct measured *measured)
{
    static double as_they_are[sizeof measured->numbers / sizeof *measured->numbers];
    static int known;
    const bool altered = coin();
    for (known = measured->number_count ? known : 0; known < measured->number_count; known++)
        as_they_are[known] = measured->numbers[known].value;
    for (int k = 0; k < known; k++) {
        struct scene_number *number = &measured->numbers[k];
        if (number->quantity >= QUANTITY_FLOPS)
            continue;
        number->value = !altered                                   ? as_they_are[k]
                        : number->quantity == QUANTITY_UPSAMPLING  ? pow(2, floor(drawn(0, 3)))
                        : number->quantity == QUANTITY_SIZE_FACTOR ? drawn(0.5, 8)
                                                                   : drawn(-30, 0);
    }
}

/* One draw: methods differ by much or little, and so do targets. */
static void numbers_draw(struct measured *measured)
{
    struct results *images = &measured->measurements, *targets = &measured->targets;
    const double methods = pow(10, drawn(-4, 1.5)) * coin(), places = pow(10, drawn(-5, 0)) * coin();
    const double slowness = exp(drawn(-3, 5)), times = coin() ? 0.05 : 4;
    static char stages[64][100];
    scene_numbers_draw(measured);
    assert_true(images->csv.row_count <= 64);
    for (int k = 0; k < images->csv.row_count; k++) {
        struct measurement *m = &images->measurements[k];
        m->error = m->error_gain = 0.05 * exp(drawn(-5, 4));
        m->phase_rms_rad = 0.1 * exp(drawn(-3, 3));
        m->run_s = m->run_min_s = slowness * exp(times * drawn(-1, 1));
        snprintf(stages[k], sizeof *stages, "compress=1;focus=%.9g;bulk=0;differential=0;reconstruct=0", m->run_s);
        m->stages = stages[k];
        m->control_s = m->flops_published = 1;
        m->flops = exp(drawn(-1, 1)) * (strstr(m->scene, "real_size") ? 3.4e11 : 1); /* as of the plan by nearest */
        m->bytes = exp(drawn(-1, 1));
        m->width_m = 0.04 * exp(drawn(-1, 1));
        m->entropy = drawn(4, 5);
        m->peak_over_median = exp(drawn(5, 9));
        m->pslr_db = -14 + methods * drawn(-1, 1);
        m->islr_db = -10 + methods * drawn(-1, 1);
        const double width = drawn(-1, 1), shift = drawn(-1, 1);
        for (int n = 0; n < targets->csv.row_count; n++) {
            struct target_row *t = &targets->target_rows[n];
            if (strcmp(t->scene, m->scene) != 0 || strcmp(t->algorithm, m->algorithm) != 0
                || strcmp(t->options, m->options) != 0)
                continue;
            t->pslr_db = m->pslr_db + places * drawn(-1, 1);
            t->islr_db = m->islr_db + places * drawn(-1, 1);
            t->width_m = 0.04 * (1 + methods * width * 0.3 + places * drawn(0, 0.01));
            t->position_error_m = 0.01 * (methods * shift + places * drawn(-1, 1));
        }
    }
}

/* Phase errors that grow or fall with range and Doppler, now and then without order. */
static void phases_draw(struct measured *measured)
{
    static const char *const files[] = {"phase-lbf21__phase_short.csv", "phase-lbf21__phase_long.csv"};
    static const double ranges[] = {50, 135, 220, 300}, shares[] = {0, 0.25, 0.5, 0.75, 1};
    for (int setup = 0; setup < 2; setup++) {
        FILE *file = fopen(path_of(files[setup]), "w");
        assert_non_null(file);
        fputs("receiver,r_m,nu_per_m,lbf_fc_error_rad,lbf_F_error_rad,lbf7_fc_error_rad,pca_error_rad\n", file);
        for (int receiver = 0; receiver < 2; receiver++) {
            double size[4], by_range[4], by_share[4];
            for (int f = 0; f < 4; f++) {
                size[f] = pow(10, drawn(-2.3, 0.2));
                by_range[f] = drawn(-1.5, 1.5);
                by_share[f] = coin() ? drawn(0, 3) : 0; /* 0: all of it within a quarter of the band */
            }
            for (int r = 0; r < 4; r++)
                for (int s = 0; s < 5; s++) {
                    fprintf(file, "%s,%g,%g", receiver ? "66" : "1", ranges[r], 10 * shares[s]);
                    for (int f = 0; f < 4; f++)
                        fprintf(file, ",%.9g",
                                size[f] * pow(ranges[r] / 150, by_range[f]) * pow(shares[s] + 1e-3, by_share[f]));
                    fputc('\n', file);
                }
        }
        assert_int_equal(fclose(file), 0);
        csv_free(&measured->phase[setup]);
        assert_int_equal(csv_read(path_of(files[setup]), CSV_TAIL_KEEP, &measured->phase[setup]), STATUS_OK);
    }
}

/* Errors around a tenth on three scenes. */
static void rules_draw(struct measured *measured)
{
    FILE *file = fopen(path_of(RULES_FILE), "w");
    assert_non_null(file);
    fputs("seed,rule,algorithm,options,oversampling,error_gain,rate,rate_enough\n", file);
    const double size = pow(10, drawn(-1, 1));
    for (int scene = 0; scene < 3; scene++)
        for (int k = 0; rule_names[k]; k++)
            fprintf(file, "%d,%s,a,b=1,%d,%.9g,%.9g,2\n", scene, rule_names[k], 1 + scene, size * drawn(1, 0.3),
                    drawn(2, 9));
    assert_int_equal(fclose(file), 0);
    csv_free(&measured->rules);
    assert_int_equal(csv_read(path_of(RULES_FILE), CSV_TAIL_KEEP, &measured->rules), STATUS_OK);
}

/* Every claim that measurements decide holds by some and fails by others. */
static void each_verdict_can_flip(void **state)
{
    (void)state;
    enum { DRAWS_MAX = 6000 };
    struct claims claims;
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (int k = 0; k < claims.count; k++) {
        const struct claim *claim = &claims.claims[k];
        struct measured measured;
        bool seen[CLAIM_VERDICTS] = {false};
        int draws = 0;
        if (!comparison_decides(claim->comparison) || comparison_identity(claim->comparison))
            continue;
        generator = random_seed(1, (uint64_t)k);
        claim_plant(&claims, claim);
        planted_end(&measured);
        bool both = false;
        for (; draws < DRAWS_MAX && !both; draws++) {
            numbers_draw(&measured);
            if (claim->phases)
                phases_draw(&measured);
            if (claim->rules)
                rules_draw(&measured);
            seen[claim_evaluate(&claims, claim, SCHEME_PRINTED, &measured).verdict] = true;
            both = (seen[CLAIM_FAILS] || seen[CLAIM_UNDECIDED]) && (seen[CLAIM_HOLDS] || seen[CLAIM_ASSUMED]);
        }
        if (draws == DRAWS_MAX)
            fail_msg("%s never %s; %s", claim->id, seen[CLAIM_FAILS] ? "holds" : "fails",
                     claim_evaluate(&claims, claim, SCHEME_PRINTED, &measured).evidence);
        planted_clear(&measured);
    }
    claims_free(&claims);
}

static void contains(const struct claim *claim, const char *evidence, const char *text)
{
    if (!strstr(evidence, text))
        fail_msg("%s: '%s' is not in its evidence: %s", claim->id, text, evidence);
}

/* The evidence of each claim says what was compared with what: numbers by name, criterion, answers, settings, scenes
   with what these assume, how slices are measured, printed tables. */
static void evidence_is_whole(void **state)
{
    (void)state;
    struct claims claims;
    assert_int_equal(claims_read(data_path(DATA_CLAIMS), &claims), STATUS_OK);
    for (int k = 0; k < claims.count; k++) {
        const struct claim *claim = &claims.claims[k];
        struct measured measured;
        if (claim_has(&claims, claim, "flops") || claim_has(&claims, claim, "planned(")
            || claim_has(&claims, claim, "filtered(")) /* full-size plans and filters, which take seconds */
            continue;
        generator = random_seed(2, (uint64_t)k);
        claim_plant(&claims, claim);
        planted_end(&measured);
        numbers_draw(&measured);
        if (claim->phases)
            phases_draw(&measured);
        if (claim->rules)
            rules_draw(&measured);
        for (enum scheme scheme = 0; scheme < (claim->by_scheme ? SCHEMES : 1); scheme++) {
            const struct evaluation found = claim_evaluate(&claims, claim, scheme, &measured);
            char name[40];
            assert_true(strlen(found.evidence) < sizeof found.evidence - 1);
            snprintf(name, sizeof name, "%.*s", (int)strcspn(claim->arguments, "=;") % 38, claim->arguments);
            contains(claim, found.evidence, name);
            contains(claim, found.evidence, claim->criterion);
            if (comparison_decides(claim->comparison))
                contains(claim, found.evidence,
                         strstr(found.evidence, ": yes")  ? "; criterion: "
                         : strstr(found.evidence, ": no") ? "; criterion: "
                                                          : ": within the noise");
            if (claim->need_count > 0 || claim->phases || claim->rules)
                contains(claim, found.evidence, "; settings: ");
            if (claim->need_count > 0 || claim->phases || claim_has(&claims, claim, "scene("))
                contains(claim, found.evidence, " (c 1500 m/s, beam ");
            if (claim_has(&claims, claim, "target_pslr_db(") || claim_has(&claims, claim, "target_islr_db("))
                contains(claim, found.evidence, "; slices: ");
            if (claim_has(&claims, claim, " published(") || claim_has(&claims, claim, "(published("))
                contains(claim, found.evidence, "; printed numbers: ");
        }
        planted_clear(&measured);
    }
    claims_free(&claims);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_FOLDER(faults_change_verdicts),
        IN_FOLDER(each_verdict_can_flip),
        IN_FOLDER(evidence_is_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
