/* One scene ready for imaging (session.h). */
#include "measure/session.h"

#include <stdio.h>
#include <stdlib.h>

#include "echoes/echo_data.h"
#include "measure/darkness.h"
#include "imaging/imaging.h"
#include "scene/simulate.h"

/* Where images are compared: the scene's own patches, or the part of a whole swath around its targets. */
static struct problem compared_problem(const struct scene *scene, enum precision precision)
{
    if (scene->reference_count)
        return problem_make(&scene->acquisition, scene->reference_count, scene->reference_patches, precision);
    return scene_problem(scene, precision);
}

struct problem session_problem(const struct scene *scene, const struct algorithm *algorithm, enum precision precision)
{
    if (algorithm->traits & TRAIT_EXACT)
        return compared_problem(scene, precision);
    return scene_problem(scene, precision);
}

/* Keeps the message of a failure, for later requests. */
static void choose(const struct session *session, const struct spec *spec, const struct budget *budget,
                   struct chosen *chosen)
{
    const struct problem problem = scene_problem(session->scene, spec->precision);
    *chosen = (struct chosen){.choice = {.list = NULL}};
    chosen->status = spec_copy(spec, &chosen->asked);
    if (chosen->status == STATUS_OK)
        chosen->status = choice_make(&problem, session->echoes, budget, &chosen->choice);
    if (chosen->status == STATUS_OK)
        chosen->status = choice_spec(&chosen->choice, budget, spec->precision, &chosen->spec);
    if (chosen->status != STATUS_OK)
        snprintf(chosen->message, sizeof chosen->message, "%s", status_message());
    image_free(&chosen->choice.image);
}

const struct chosen *session_chosen(struct session *session, const struct spec *spec)
{
    struct budget budget;
    if (session->memory > 0 || !choice_asked(spec, &budget)) /* tiled_check refuses choices */
        return NULL;
    budget.region = (struct region){session->scene->reference_count, session->scene->reference_patches};
    for (int k = 0; k < session->chosen_count; k++)
        if (spec_equal(&session->chosen[k].asked, spec))
            return &session->chosen[k];
    struct chosen *list = realloc(session->chosen, ((size_t)session->chosen_count + 1) * sizeof *session->chosen);
    if (!list) {
        status_set(STATUS_FAILED, "no memory for a choice");
        return NULL;
    }
    session->chosen = list;
    choose(session, spec, &budget, &list[session->chosen_count]);
    return &list[session->chosen_count++];
}

enum status session_resolve(struct session *session, const struct spec *spec, const struct spec **resolved)
{
    struct budget budget;
    *resolved = spec;
    if (!choice_asked(spec, &budget))
        return STATUS_OK;
    const struct chosen *chosen = session_chosen(session, spec);
    if (!chosen)
        return STATUS_FAILED;
    *resolved = &chosen->spec;
    return chosen->status == STATUS_OK ? STATUS_OK : status_set(chosen->status, "%s", chosen->message);
}

enum status session_image(struct session *session, const struct spec *asked, struct image *image)
{
    const struct spec *spec;
    const enum status status = session_resolve(session, asked, &spec);
    *image = (struct image){0};
    if (status != STATUS_OK)
        return status;
    struct problem problem = session_problem(session->scene, spec->algorithm, spec->precision);
    return imaging_form(spec, &problem, &session->echoes[spec->precision], image, NULL);
}

/* The exact image, by the stated track or the true one. */
static enum status form_exact(const struct session *session, const struct spec *spec,
                              const struct acquisition *acquisition, struct image *image)
{
    struct problem problem = compared_problem(session->scene, PRECISION_DOUBLE);
    struct echoes echoes = session->echoes[PRECISION_DOUBLE];
    problem.acquisition = echoes.acquisition = acquisition;
    return imaging_form(spec, &problem, &echoes, image, NULL);
}

/* A refusal of the exact image need not stop other algorithms. */
static enum status form_reference(struct session *session)
{
    const struct scene *scene = session->scene;
    struct spec spec;
    enum status status = spec_parse("reference:precision=double", &spec);
    if (status != STATUS_OK)
        return status;
    status = form_exact(session, &spec, &scene->acquisition, &session->reference);
    if (status == STATUS_OK && scene->flown)
        status = form_exact(session, &spec, scene->flown, &session->flown);
    if (status == STATUS_OK) {
        const struct darkness darkness = image_darkness(&session->echoes[PRECISION_DOUBLE], &session->reference);
        darkness_conditions(&darkness, session->conditions + session->condition_count);
        session->condition_count += DARKNESS_CONDITIONS;
    } else
        snprintf(session->no_reference, sizeof session->no_reference, "%s", status_message());
    spec_free(&spec);
    return STATUS_OK;
}

enum status session_open(const struct scene *scene, struct session *session)
{
    *session = (struct session){.scene = scene};
    session->condition_count = scene_conditions(scene, session->conditions);
    enum status status = scene_echoes_both(scene, session->echoes);
    const struct problem problem = scene_problem(scene, PRECISION_FLOAT);
    session->control = control_begin(&problem, &session->echoes[PRECISION_FLOAT]);
    if (status == STATUS_OK)
        status = form_reference(session);
    if (status != STATUS_OK)
        session_close(session);
    return status;
}

void session_open_tiled(const struct scene *scene, double memory, struct session *session)
{
    *session = (struct session){.scene = scene, .memory = memory};
    session->condition_count = scene_conditions(scene, session->conditions);
}

void session_close(struct session *session)
{
    for (int k = 0; k < session->chosen_count; k++) {
        choice_free(&session->chosen[k].choice);
        spec_free(&session->chosen[k].spec);
        spec_free(&session->chosen[k].asked);
    }
    free(session->chosen);
    control_end(&session->control);
    image_free(&session->reference);
    image_free(&session->flown);
    echoes_free(&session->echoes[PRECISION_FLOAT]);
    echoes_free(&session->echoes[PRECISION_DOUBLE]);
}
