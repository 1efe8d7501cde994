/* The other end of `compare --ab` (ab.c), which starts it and tells it what to run. Not for the
   terminal. It says "sasbench measure 1", then answers each line of standard input by one of standard output:

       plan SPEC SCENE     planned UNIT HASH       UNIT from 0; HASH of the scene's content
                           refused REASON          unknown, invalid or unsupported
       run UNIT COUNT      took S compress=0.1;... seconds in all and of each stage, of COUNT runs without a pause
                           failed REASON

   and ends with its input. One thread; time in which it waits for a processor that other work has does not count. */
#include <inttypes.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/session.h"
#include "scene/simulate.h"
#include "data/echo_data.h"
#include "data/paths.h"
#include "gate/worker.h"

enum { UNITS_MOST = 256 };

struct site {
    char *name; /* as it was given */
    struct scene scene;
    struct echoes echoes[2]; /* by enum precision; made when first wanted */
    struct site *next;
};

struct unit {
    struct site *site;
    struct spec spec;
    void *plan;
    struct image image;
};

struct measure {
    struct site *sites;
    int unit_count;
    struct unit units[UNITS_MOST];
};

static void unit_free(struct unit *unit)
{
    if (unit->spec.algorithm)
        unit->spec.algorithm->destroy(unit->plan);
    image_free(&unit->image);
    spec_free(&unit->spec);
}

static void measure_free(struct measure *measure)
{
    for (int k = 0; k < measure->unit_count; k++)
        unit_free(&measure->units[k]);
    for (struct site *site = measure->sites, *next; site; site = next) {
        next = site->next;
        echoes_free(&site->echoes[PRECISION_FLOAT]);
        echoes_free(&site->echoes[PRECISION_DOUBLE]);
        scene_free(&site->scene);
        free(site->name);
        free(site);
    }
    free(measure);
}

/* The scene of this name, read and simulated once. */
static enum status site_find(struct measure *measure, const char *name, struct site **found)
{
    for (*found = measure->sites; *found; *found = (*found)->next)
        if (strcmp((*found)->name, name) == 0)
            return STATUS_OK;
    struct site *site = calloc(1, sizeof *site);
    if (!site || !(site->name = strdup(name))) {
        free(site);
        return status_set(STATUS_FAILED, "no memory for the scene %s", name);
    }
    enum status status = scene_load(name, SCENE_DIRECTORY, &site->scene);
    if (status == STATUS_OK) {
        status = scene_simulate(&site->scene, &site->echoes[PRECISION_DOUBLE]);
        if (status != STATUS_OK)
            scene_free(&site->scene);
    }
    if (status != STATUS_OK) {
        free(site->name);
        free(site);
        return status;
    }
    site->next = measure->sites;
    *found = measure->sites = site;
    return STATUS_OK;
}

static enum status unit_plan(struct measure *measure, const char *spec, const char *scene)
{
    struct unit *unit = &measure->units[measure->unit_count];
    if (measure->unit_count == UNITS_MOST)
        return status_set(STATUS_INVALID, "more than %d units", UNITS_MOST);
    *unit = (struct unit){0};
    enum status status = spec_parse(spec, &unit->spec);
    if (status == STATUS_OK)
        status = site_find(measure, scene, &unit->site);
    enum precision precision = unit->spec.precision;
    if (status == STATUS_OK && !unit->site->echoes[precision].samples)
        status = echoes_convert(&unit->site->echoes[PRECISION_DOUBLE], precision, &unit->site->echoes[precision]);
    if (status == STATUS_OK) {
        struct problem problem = session_problem(&unit->site->scene, unit->spec.algorithm, precision);
        status = unit->spec.algorithm->plan(&problem, unit->spec.options, &unit->plan);
        if (status == STATUS_OK)
            status = image_allocate(problem.patch_count, problem.patches, precision, &unit->image);
    }
    if (status != STATUS_OK)
        unit_free(unit);
    else
        measure->unit_count++;
    return status;
}

static void answer_plan(struct measure *measure, char *arguments)
{
    char *scene = strchr(arguments, ' ');
    if (scene)
        *scene++ = '\0';
    enum status status = scene ? unit_plan(measure, arguments, scene) : status_set(STATUS_INVALID, "no scene");
    if (status == STATUS_OK)
        printf("planned %d %016" PRIx64 "\n", measure->unit_count - 1,
               measure->units[measure->unit_count - 1].site->scene.hash);
    else
        printf("refused %s\n", status_message());
}

static void answer_run(struct measure *measure, const char *arguments)
{
    int index, count;
    if (sscanf(arguments, "%d %d", &index, &count) != 2 || index < 0 || index >= measure->unit_count || count < 1) {
        printf("failed '%s' is not UNIT COUNT\n", arguments);
        return;
    }
    struct unit *unit = &measure->units[index];
    const struct echoes *echoes = &unit->site->echoes[unit->spec.precision];
    struct stages stages;
    enum status status = STATUS_OK;
    stages_begin(&stages);
    double begin = stages.mark;
    for (int k = 0; k < count && status == STATUS_OK; k++)
        status = unit->spec.algorithm->execute(unit->plan, echoes, &unit->image, &stages);
    if (status != STATUS_OK) {
        printf("failed %s\n", status_message());
        return;
    }
    printf("took %.9g ", seconds_now() - begin);
    for (int k = 0; k < stages.count; k++)
        printf("%s%s=%.9g", k ? ";" : "", stages.stage[k].name, stages.stage[k].seconds);
    printf("\n");
}

enum status worker_serve(void)
{
    char *line = NULL;
    size_t size = 0;
    struct measure *measure = calloc(1, sizeof *measure);
    if (!measure)
        return status_set(STATUS_FAILED, "no memory for %d units", UNITS_MOST);
    omp_set_num_threads(1);
    seconds_skip_waiting();
    printf("sasbench measure 1\n");
    while (fflush(stdout) == 0 && getline(&line, &size, stdin) > 0) {
        line[strcspn(line, "\n")] = '\0';
        if (strncmp(line, "plan ", 5) == 0)
            answer_plan(measure, line + 5);
        else if (strncmp(line, "run ", 4) == 0)
            answer_run(measure, line + 4);
        else
            printf("failed '%s' is not a request\n", line);
    }
    free(line);
    measure_free(measure);
    return STATUS_OK;
}
