/* One scene ready for imaging (session.h). */
#include "measure/session.h"

#include <stdio.h>

#include "echoes/echo_data.h"
#include "measure/darkness.h"
#include "measure/imaging.h"
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

enum status session_image(const struct session *session, const struct spec *spec, struct image *image)
{
    struct problem problem = session_problem(session->scene, spec->algorithm, spec->precision);
    return imaging_form(spec, &problem, &session->echoes[spec->precision], image, NULL);
}

/* What refuses the exact image may well allow others. */
static enum status form_reference(struct session *session)
{
    struct spec spec;
    enum status status = spec_parse("reference:precision=double", &spec);
    if (status != STATUS_OK)
        return status;
    status = session_image(session, &spec, &session->reference);
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
    const double begin = seconds_now();
    enum status status = scene_echoes(scene, &session->echoes[PRECISION_DOUBLE]);
    if (status == STATUS_OK)
        status = echoes_convert(&session->echoes[PRECISION_DOUBLE], PRECISION_FLOAT, &session->echoes[PRECISION_FLOAT]);
    /* Images of a session keep the power of two that its echoes were divided by: they are only compared with each
       other. */
    const int exponent = session->echoes[PRECISION_DOUBLE].exponent;
    session->echoes[PRECISION_DOUBLE].exponent = 0;
    session->echoes[PRECISION_FLOAT].exponent -= exponent;
    const struct problem problem = scene_problem(scene, PRECISION_FLOAT);
    session->control = control_begin(&problem, &session->echoes[PRECISION_FLOAT]);
    const double made = seconds_now();
    session->spent.echoes = made - begin;
    if (status == STATUS_OK)
        status = form_reference(session);
    session->spent.reference = seconds_now() - made;
    if (status != STATUS_OK)
        session_close(session);
    return status;
}

void session_close(struct session *session)
{
    control_end(&session->control);
    image_free(&session->reference);
    echoes_free(&session->echoes[PRECISION_FLOAT]);
    echoes_free(&session->echoes[PRECISION_DOUBLE]);
}

void session_spent(const struct session *session, struct spent *sum)
{
    sum->echoes += session->spent.echoes;
    sum->reference += session->spent.reference;
    sum->planning += session->spent.planning;
    sum->imaging += session->spent.imaging;
    sum->control += session->control.spent_s;
}
