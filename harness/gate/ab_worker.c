/* The other end of `compare --ab` (ab.c), which starts it and sends it requests. Not for the
   terminal. It prints "sasbench measure 1", then answers each line of standard input by one of standard output:

       plan SPEC SCENE     planned JOB HASH        JOB from 0; HASH of the scene's content
                           refused REASON          unknown, invalid or unsupported
       run JOB COUNT       took S compress=0.1;... seconds in all and of each stage, of COUNT runs without a pause
                           failed REASON

   and ends with its input. One thread; time in which it waits for a processor that other work has does not count. */
#include <inttypes.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/imaging.h"
#include "measure/timing.h"
#include "measure/session.h"
#include "scene/simulate.h"
#include "echoes/echo_data.h"
#include "files/paths.h"
#include "gate/ab.h"

enum { JOBS_MOST = 256 };

struct worker_scene {
    char *name; /* as it was given */
    struct scene scene;
    struct echoes echoes[2]; /* by enum precision; made when first wanted */
    struct worker_scene *next;
};

struct job {
    struct worker_scene *scene;
    struct spec spec;
    struct imaging imaging;
};

struct worker {
    struct worker_scene *scenes;
    int job_count;
    struct job jobs[JOBS_MOST];
};

static void job_free(struct job *job)
{
    imaging_close(&job->imaging);
    spec_free(&job->spec);
}

static void worker_free(struct worker *worker)
{
    for (int k = 0; k < worker->job_count; k++)
        job_free(&worker->jobs[k]);
    for (struct worker_scene *scene = worker->scenes, *next; scene; scene = next) {
        next = scene->next;
        echoes_free(&scene->echoes[PRECISION_FLOAT]);
        echoes_free(&scene->echoes[PRECISION_DOUBLE]);
        scene_free(&scene->scene);
        free(scene->name);
        free(scene);
    }
    free(worker);
}

/* The scene of this name, read and simulated once. */
static enum status scene_find(struct worker *worker, const char *name, struct worker_scene **found)
{
    for (*found = worker->scenes; *found; *found = (*found)->next)
        if (strcmp((*found)->name, name) == 0)
            return STATUS_OK;
    struct worker_scene *scene = calloc(1, sizeof *scene);
    if (!scene || !(scene->name = strdup(name))) {
        free(scene);
        return status_set(STATUS_FAILED, "no memory for the scene %s", name);
    }
    enum status status = scene_load(name, data_path(DATA_SCENES), &scene->scene);
    if (status == STATUS_OK) {
        status = scene_echoes(&scene->scene, &scene->echoes[PRECISION_DOUBLE]);
        if (status != STATUS_OK)
            scene_free(&scene->scene);
    }
    if (status != STATUS_OK) {
        free(scene->name);
        free(scene);
        return status;
    }
    scene->next = worker->scenes;
    *found = worker->scenes = scene;
    return STATUS_OK;
}

static enum status job_plan(struct worker *worker, const char *spec, const char *scene)
{
    struct job *job = &worker->jobs[worker->job_count];
    if (worker->job_count == JOBS_MOST)
        return status_set(STATUS_INVALID, "more than %d jobs", JOBS_MOST);
    *job = (struct job){0};
    enum status status = spec_asked(spec, &job->spec);
    if (status == STATUS_OK)
        status = scene_find(worker, scene, &job->scene);
    enum precision precision = job->spec.precision;
    if (status == STATUS_OK && !job->scene->echoes[PRECISION_FLOAT].samples)
        status = echoes_convert(&job->scene->echoes[PRECISION_DOUBLE], PRECISION_FLOAT,
                                &job->scene->echoes[PRECISION_FLOAT]);
    if (status == STATUS_OK) {
        const struct problem problem = session_problem(&job->scene->scene, job->spec.algorithm, precision);
        struct spec chosen;
        status = choice_resolve(&job->spec, &problem, job->scene->echoes, &chosen);
        if (status == STATUS_OK) {
            spec_free(&job->spec);
            job->spec = chosen;
            status = imaging_open(&job->spec, &problem, &job->imaging);
        }
    }
    if (status != STATUS_OK)
        job_free(job);
    else
        worker->job_count++;
    return status;
}

static void answer_plan(struct worker *worker, char *arguments)
{
    char *scene = strchr(arguments, ' ');
    if (scene)
        *scene++ = '\0';
    enum status status = scene ? job_plan(worker, arguments, scene) : status_set(STATUS_INVALID, "no scene");
    if (status == STATUS_OK)
        printf("planned %d %016" PRIx64 "\n", worker->job_count - 1,
               worker->jobs[worker->job_count - 1].scene->scene.hash);
    else
        printf("refused %s\n", status_message());
}

static void answer_run(struct worker *worker, const char *arguments)
{
    int index, count;
    if (sscanf(arguments, "%d %d", &index, &count) != 2 || index < 0 || index >= worker->job_count || count < 1) {
        printf("failed '%s' is not JOB COUNT\n", arguments);
        return;
    }
    struct job *job = &worker->jobs[index];
    const struct echoes *echoes = &job->scene->echoes[job->spec.precision];
    struct stages stages;
    enum status status = STATUS_OK;
    stages_begin(&stages);
    double begin = stages.mark;
    for (int k = 0; k < count && status == STATUS_OK; k++)
        status = imaging_execute(&job->imaging, echoes, &stages);
    if (status != STATUS_OK) {
        printf("failed %s\n", status_message());
        return;
    }
    printf("took %.9g ", seconds_now() - begin);
    for (int k = 0; k < stages.count; k++)
        printf("%s%s=%.9g", k ? ";" : "", stages.stage[k].name, stages.stage[k].seconds);
    printf("\n");
}

enum status ab_worker_serve(void)
{
    char *line = NULL;
    size_t size = 0;
    struct worker *worker = calloc(1, sizeof *worker);
    if (!worker)
        return status_set(STATUS_FAILED, "no memory for %d jobs", JOBS_MOST);
    omp_set_num_threads(1);
    seconds_skip_waiting();
    printf("sasbench measure 1\n");
    while (fflush(stdout) == 0 && getline(&line, &size, stdin) > 0) {
        line[strcspn(line, "\n")] = '\0';
        if (strncmp(line, "plan ", 5) == 0)
            answer_plan(worker, line + 5);
        else if (strncmp(line, "run ", 4) == 0)
            answer_run(worker, line + 4);
        else
            printf("failed '%s' is not a request\n", line);
    }
    free(line);
    worker_free(worker);
    return STATUS_OK;
}
