/* Echo files: which variables they have, in which shapes. */
#include "echoes/matfile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "echoes/matvar.h"
#include "echoes/noise.h"
#include "echoes/speeds.h"

enum echo_variable {
    FORMAT,
    SAMPLES,
    COMPRESSED,
    PULSE,
    FS,
    FC,
    BANDWIDTH,
    SOUND_SPEED,
    T0,
    TX,
    RX,
    VELOCITY,
    PRI,
    TX_LENGTH,
    RX_LENGTH,
    BEAM_LIMIT,
    ECHO_SINE,
    ECHO_TAPERS,
    ECHO_SQUINT,
    AREA,
    ECHO_VARIABLES
};

static const char format_text[] = "sas-echoes 1";

static const struct wanted echo_variables[ECHO_VARIABLES] = {
    [FORMAT] = {"format", KIND_TEXT, false, "the text \"sas-echoes 1\""},
    [SAMPLES] = {"samples", KIND_COMPLEX, false, "a complex array [N x M x P] (fast time x receivers x pings)"},
    [COMPRESSED] = {"compressed", KIND_SCALAR, false, "0 (raw) or 1 (range compressed)"},
    [PULSE] = {"pulse", KIND_COMPLEX, true, "a complex array [K x 1]"},
    [FS] = {"fs", KIND_SCALAR, false, "a scalar in Hz"},
    [FC] = {"fc", KIND_SCALAR, false, "a scalar in Hz"},
    [BANDWIDTH] = {"bandwidth", KIND_SCALAR, false, "a scalar in Hz"},
    [SOUND_SPEED] = {"sound_speed", KIND_REAL, false, "a real scalar or [1 x P] in m/s"},
    [T0] = {"t0", KIND_REAL, false, "a real scalar or [1 x P] in s"},
    [TX] = {"tx", KIND_REAL, false, "a real array [3 x P] in m"},
    [RX] = {"rx", KIND_REAL, false, "a real array [3 x M x P] in m"},
    [VELOCITY] = {"velocity", KIND_REAL, false, "a real array [3 x 1] or [3 x P] in m/s"},
    [PRI] = {"pri", KIND_SCALAR, true, "a scalar in s"},
    [TX_LENGTH] = {"tx_length", KIND_SCALAR, true, "a scalar in m"},
    [RX_LENGTH] = {"rx_length", KIND_SCALAR, true, "a scalar in m"},
    [BEAM_LIMIT] = {"beam_limit", KIND_SCALAR, true, "a scalar in (0, 1]"},
    [ECHO_SINE] = {"echo_sine", KIND_SCALAR, true, "a scalar > 0, Inf where echoes come from everywhere"},
    [ECHO_TAPERS] = {"echo_tapers", KIND_SCALAR, true, "0 or 1"},
    [ECHO_SQUINT] = {"echo_squint", KIND_SCALAR, true, "a scalar between -pi/2 and pi/2 in rad"},
    [AREA] = {"area", KIND_REAL, true, "a real array [1 x 4] in m (x, r, half_x, half_r), the last two > 0,"},
};
_Static_assert((int)ECHO_VARIABLES <= (int)WANTED_MAX, "send_variables keeps a mark for each variable");

/* Its real parts, free(). NULL without memory. */
static double *reals_of(const struct variable *variable)
{
    const size_t count = variable_count(variable);
    double *reals = calloc(count + 1, sizeof *reals);
    for (size_t k = 0; k < count && reals; k++)
        reals[k] = creal(variable->values[k]);
    return reals;
}

static double scalar_or(const struct variable *variable, double missing)
{
    return variable->values ? creal(variable->values[0]) : missing;
}

/* Other shapes that have only one meaning: one receiver without its dimension, which MATLAB and SciPy leave out or
   squeeze away, and coordinates in rows [P x 3]. */
static enum status shapes_read(struct variable *v)
{
    size_t *samples = v[SAMPLES].dims, *rx = v[RX].dims;
    const size_t second = samples[1];
    const bool tx_of_pings =
        (v[TX].dims[0] == 3 && v[TX].dims[1] == second) || (v[TX].dims[1] == 3 && v[TX].dims[0] == second);
    if (samples[2] == 1 && second > 1 && tx_of_pings && variable_count(&v[RX]) == 3 * second) {
        samples[1] = 1;
        samples[2] = second;
    }
    const size_t pings = samples[2];
    enum status status = STATUS_OK;
    for (int k = 0; k < 3 && status == STATUS_OK; k++) {
        struct variable *turned = &v[k == 0 ? TX : k == 1 ? VELOCITY : RX];
        const bool in_rows = turned->dims[1] == 3 && turned->dims[0] != 3 && turned->dims[2] == 1
                             && (turned->dims[0] == pings || turned->dims[0] == 1) && (k < 2 || samples[1] == 1);
        status = in_rows ? variable_transpose(turned) : STATUS_OK;
    }
    if (samples[1] == 1 && rx[0] == 3 && rx[1] == pings && rx[2] == 1) {
        rx[1] = 1;
        rx[2] = pings;
    }
    return status;
}

static bool speeds_fit(const struct variable *speeds, size_t pings)
{
    return variable_has_shape(speeds, 1, pings, 1) || variable_has_shape(speeds, pings, 1, 1);
}

static enum status check_echo_shapes(const char *path, const struct variable *v)
{
    const struct variable *samples = &v[SAMPLES];
    size_t receivers = samples->dims[1], pings = samples->dims[2];
    for (int i = 0; i < 3; i++)
        if (samples->dims[i] > INT_MAX)
            return status_set(STATUS_INVALID,
                              "%s: variable `samples` is [%zu x %zu x %zu]; at most %d each is accepted", path,
                              samples->dims[0], samples->dims[1], samples->dims[2], INT_MAX);
    const struct variable *pulse = &v[PULSE];
    bool is_vector = (pulse->dims[0] == 1 || pulse->dims[1] == 1) && pulse->dims[2] == 1;
    bool pulse_fits = !pulse->values || (is_vector && variable_count(pulse) <= INT_MAX);
    bool area_fits = !v[AREA].values || variable_has_shape(&v[AREA], 1, 4, 1) || variable_has_shape(&v[AREA], 4, 1, 1);
    const struct {
        enum echo_variable variable;
        bool fits;
    } shapes[] = {
        {T0, variable_has_shape(&v[T0], 1, 1, 1) || variable_has_shape(&v[T0], 1, pings, 1)
                 || variable_has_shape(&v[T0], pings, 1, 1)},
        {SOUND_SPEED, variable_has_shape(&v[SOUND_SPEED], 1, 1, 1) || speeds_fit(&v[SOUND_SPEED], pings)},
        {TX, variable_has_shape(&v[TX], 3, pings, 1)},
        {RX, variable_has_shape(&v[RX], 3, receivers, pings)},
        {VELOCITY, variable_has_shape(&v[VELOCITY], 3, 1, 1) || variable_has_shape(&v[VELOCITY], 3, pings, 1)},
        {PULSE, pulse_fits},
        {AREA, area_fits},
    };
    const size_t *tx = v[TX].dims, *rx = v[RX].dims;
    if ((rx[1] != receivers || rx[2] != pings) && tx[0] == 3 && rx[0] == 3 && rx[2] == tx[1] && tx[2] == 1) {
        return status_set(
            STATUS_INVALID,
            "%s: variable `samples` is [%zu x %zu x %zu], `tx` and `rx` have %zu receivers and %zu pings; %s is needed",
            path, samples->dims[0], receivers, pings, rx[1], tx[1], echo_variables[SAMPLES].accepted);
    }
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        const struct wanted *wanted = &echo_variables[shapes[i].variable];
        const size_t *dims = v[shapes[i].variable].dims;
        if (!shapes[i].fits) {
            return status_set(
                STATUS_INVALID, "%s: variable `%s` is [%zu x %zu x %zu], samples [%zu x %zu x %zu]; %s is needed", path,
                wanted->name, dims[0], dims[1], dims[2], samples->dims[0], receivers, pings, wanted->accepted);
        }
    }
    return STATUS_OK;
}

static enum status check_echo_scalars(const char *path, const struct variable *v)
{
    const double compressed = scalar_or(&v[COMPRESSED], 0), limit = scalar_or(&v[BEAM_LIMIT], 1);
    const double tapers = scalar_or(&v[ECHO_TAPERS], 0);
    const struct {
        enum echo_variable variable;
        bool fits;
    } scalars[] = {
        {COMPRESSED, compressed == 0 || compressed == 1},
        {BEAM_LIMIT, limit > 0 && limit <= 1},
        {ECHO_SINE, scalar_or(&v[ECHO_SINE], 1) > 0},
        {ECHO_TAPERS, tapers == 0 || tapers == 1},
        {ECHO_SQUINT, fabs(scalar_or(&v[ECHO_SQUINT], 0)) < M_PI / 2},
    };
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        const struct wanted *wanted = &echo_variables[scalars[i].variable];
        if (!scalars[i].fits) {
            return status_set(STATUS_INVALID, "%s: variable `%s` is %g; %s is needed", path, wanted->name,
                              creal(v[scalars[i].variable].values[0]), wanted->accepted);
        }
    }
    return STATUS_OK;
}

/* Of a fitting shape. */
static enum status check_area(const char *path, const struct variable *v)
{
    for (size_t i = 0; v[AREA].values && i < 4; i++) {
        double value = creal(v[AREA].values[i]);
        if (!isfinite(value) || !(value > 0 || i < 2)) {
            return status_set(STATUS_INVALID, "%s: variable `area` has %g at place %zu; %s is needed", path, value,
                              i + 1, echo_variables[AREA].accepted);
        }
    }
    return STATUS_OK;
}

static enum status check_echo_values(const char *path, const struct variable *v)
{
    const struct variable *format = &v[FORMAT];
    size_t length = variable_count(format);
    while (length > 0 && creal(format->values[length - 1]) == 0)
        length--; /* texts of a fixed length are padded */
    bool is_ours = length == strlen(format_text);
    for (size_t i = 0; is_ours && i < strlen(format_text); i++)
        is_ours = creal(format->values[i]) == format_text[i];
    if (!is_ours) {
        char text[32] = ""; /* its value, as far as it is plain text */
        for (size_t i = 0; i < length && i < sizeof text - 1; i++) {
            double code = creal(format->values[i]);
            text[i] = code >= ' ' && code <= '~' ? (char)code : '?';
        }
        return status_set(STATUS_INVALID, "%s: variable `format` is \"%s\"; %s is needed", path, text,
                          echo_variables[FORMAT].accepted);
    }
    enum status status = check_echo_scalars(path, v);
    if (status != STATUS_OK)
        return status;
    if (scalar_or(&v[COMPRESSED], 1) == 0 && !v[PULSE].values) {
        return status_set(STATUS_INVALID, "%s: variable `pulse` is missing; raw echoes (compressed 0) need %s", path,
                          echo_variables[PULSE].accepted);
    }
    return STATUS_OK;
}

enum status samples_refuse(const char *path, const size_t dims[3], size_t i, double complex z)
{
    const size_t n = i % dims[0], record = i / dims[0];
    return status_set(STATUS_INVALID, "%s: variable `samples` at (%zu, %zu, %zu) is %g%+gi; finite numbers are needed",
                      path, n + 1, record % dims[1] + 1, record / dims[1] + 1, creal(z), cimag(z));
}

/* `samples` without values: they are read later. */
static size_t samples_count(const struct variable *samples)
{
    return samples->values ? variable_count(samples) : 0;
}

static enum status check_samples(const char *path, const struct variable *samples)
{
    for (size_t i = 0; i < samples_count(samples); i++) {
        double complex z = samples->values[i];
        if (!isfinite(creal(z)) || !isfinite(cimag(z)))
            return samples_refuse(path, samples->dims, i, z);
    }
    return STATUS_OK;
}

/* Compression divides by the pulse's energy. A pulse so small or large that its squares leave the precision is brought
   to 1 by a power of two, and the samples by the same; the compressed echoes stay as they are. */
static enum status normalise_pulse(const char *path, const struct variable *v, int *exponent)
{
    const struct variable *const both[] = {&v[PULSE], &v[SAMPLES]};
    size_t pulse_count = v[PULSE].values ? variable_count(&v[PULSE]) : 0;
    const double largest = largest_part(v[PULSE].values, PRECISION_DOUBLE, pulse_count);
    *exponent = 0;
    if (!(largest > 0 && largest < INFINITY) || (largest >= 0x1p-20 && largest <= 0x1p20))
        return STATUS_OK;
    frexp(largest, exponent);
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < samples_count(both[k]); i++) {
            double re = ldexp(creal(both[k]->values[i]), -*exponent), im = ldexp(cimag(both[k]->values[i]), -*exponent);
            if (k == 1 && (!isfinite(re) || !isfinite(im)))
                return status_set(STATUS_INVALID,
                                  "%s: variable `samples` has %g%+gi, variable `pulse` at most %g; their ratio must "
                                  "fit double",
                                  path, creal(both[k]->values[i]), cimag(both[k]->values[i]), largest);
            both[k]->values[i] = __builtin_complex(re, im);
        }
    return STATUS_OK;
}

static enum status acquisition_fill(const char *path, const struct variable *v, struct acquisition *a)
{
    a->sound_speed = scalar_or(&v[SOUND_SPEED], 0);
    a->fc = scalar_or(&v[FC], 0);
    a->fs = scalar_or(&v[FS], 0);
    a->bandwidth = scalar_or(&v[BANDWIDTH], 0);
    a->samples = (int)v[SAMPLES].dims[0];
    a->receivers = (int)v[SAMPLES].dims[1];
    a->pings = (int)v[SAMPLES].dims[2];
    a->pri = scalar_or(&v[PRI], 0);
    a->tx_length = scalar_or(&v[TX_LENGTH], 0);
    a->rx_length = scalar_or(&v[RX_LENGTH], 0);
    a->aperture_limit = scalar_or(&v[BEAM_LIMIT], INFINITY);
    a->echo_sine = scalar_or(&v[ECHO_SINE], 0);
    a->echo_tapers = scalar_or(&v[ECHO_TAPERS], 0) == 1;
    a->noisy = true;
    a->echo_squint = scalar_or(&v[ECHO_SQUINT], 0);
    if (v[AREA].values) {
        const double complex *area = v[AREA].values;
        a->area = (struct target_area){creal(area[0]), creal(area[1]), creal(area[2]), creal(area[3])};
    }
    a->compressed = scalar_or(&v[COMPRESSED], 0) == 1;
    a->pulse_length = v[PULSE].values ? (int)variable_count(&v[PULSE]) : 0;
    enum status status = acquisition_allocate(a);
    if (status != STATUS_OK)
        return status;
    bool one_t0 = variable_count(&v[T0]) == 1, one_velocity = variable_count(&v[VELOCITY]) == 3;
    for (size_t p = 0, receivers = (size_t)a->receivers; p < (size_t)a->pings; p++) {
        a->t0[p] = creal(v[T0].values[one_t0 ? 0 : p]);
        a->tx[p] = variable_vector(&v[TX], p);
        a->velocity[p] = variable_vector(&v[VELOCITY], one_velocity ? 0 : p);
        for (size_t m = 0; m < receivers; m++)
            a->rx[p * receivers + m] = variable_vector(&v[RX], p * receivers + m);
    }
    for (int k = 0; k < a->pulse_length; k++)
        a->pulse[k] = v[PULSE].values[k];
    return acquisition_check(a, path);
}

/* Pings with a sound speed each: the acquisition gets one, and the samples, if they are there, move to it. */
static enum status speeds_apply(const char *path, const struct variable *v, struct acquisition *a)
{
    const struct variable *pulse = a->compressed ? NULL : &v[PULSE];
    double *speeds = reals_of(&v[SOUND_SPEED]);
    enum status status = speeds ? speeds_unite(path, speeds, a) : status_set(STATUS_FAILED, "%s: no memory", path);
    if (status == STATUS_OK)
        status = acquisition_check(a, path);
    if (status == STATUS_OK && samples_count(&v[SAMPLES]) > 0)
        status = speeds_move(a, speeds, pulse ? (int)variable_count(pulse) : 0, pulse ? pulse->values : NULL, NULL,
                             PRECISION_DOUBLE, v[SAMPLES].values);
    free(speeds);
    return status;
}

/* `pings` NULL: all samples; else none. */
static enum status file_read(const char *path, const struct pings *pings, struct acquisition *acquisition,
                             struct echoes *echoes, int *exponent)
{
    *acquisition = (struct acquisition){0};
    *echoes = (struct echoes){0};
    struct variable variables[ECHO_VARIABLES];
    struct wanted wanted[ECHO_VARIABLES];
    memcpy(wanted, echo_variables, sizeof wanted);
    wanted[SAMPLES].pings = pings;
    enum status status = variables_read(path, wanted, ECHO_VARIABLES, variables);
    if (status != STATUS_OK)
        return status;
    status = check_echo_values(path, variables);
    if (status == STATUS_OK)
        status = shapes_read(variables);
    if (status == STATUS_OK)
        status = check_echo_shapes(path, variables);
    if (status == STATUS_OK)
        status = check_samples(path, &variables[SAMPLES]);
    if (status == STATUS_OK)
        status = check_area(path, variables);
    if (status == STATUS_OK)
        status = normalise_pulse(path, variables, exponent);
    if (status == STATUS_OK)
        status = acquisition_fill(path, variables, acquisition);
    if (status == STATUS_OK && variable_count(&variables[SOUND_SPEED]) > 1)
        status = speeds_apply(path, variables, acquisition);
    if (status == STATUS_OK) {
        const double wavelength = acquisition->sound_speed / acquisition->fc;
        status = positions_check(path, echo_variables[TX].name, &variables[TX], wavelength);
        if (status == STATUS_OK)
            status = positions_check(path, echo_variables[RX].name, &variables[RX], wavelength);
    }
    if (status == STATUS_OK) {
        *echoes = (struct echoes){acquisition, PRECISION_DOUBLE, variables[SAMPLES].values, 0};
        status = pings ? STATUS_OK : noise_measure(echoes, &acquisition->noise);
    }
    if (status == STATUS_OK) {
        variables[SAMPLES].values = NULL;
    } else {
        *echoes = (struct echoes){0};
        acquisition_free(acquisition);
    }
    variables_free(variables, ECHO_VARIABLES);
    return status;
}

enum status echo_file_read(const char *path, struct acquisition *acquisition, struct echoes *echoes)
{
    int exponent;
    return file_read(path, NULL, acquisition, echoes, &exponent);
}

enum status echo_file_open(const char *path, struct acquisition *acquisition, int *exponent)
{
    struct echoes none;
    return file_read(path, &(struct pings){.count = 0}, acquisition, &none, exponent);
}

bool echo_file_is_read_whole(const char *path)
{
    char head[10] = "";
    FILE *stream = fopen(path, "rbe");
    const bool is_read = stream && fread(head, sizeof head, 1, stream) == 1;
    if (stream)
        fclose(stream);
    return is_read && memcmp(head, "MATLAB 5.0", sizeof head) == 0;
}

/* The same of pings that were just read; the file's other variables are as they were when it was opened. */
static enum status pings_move(const char *path, const struct variable *v, const struct acquisition *a,
                              const struct pings *pings)
{
    const size_t count = (size_t)pings->count, times = variable_count(&v[T0]);
    const bool raw = scalar_or(&v[COMPRESSED], 0) == 0;
    struct acquisition whole = *a; /* `a` may be a part of the file's */
    if (!speeds_fit(&v[SOUND_SPEED], count) || (times != 1 && times != count) || (raw && !v[PULSE].values))
        return status_set(STATUS_INVALID, "%s: has been replaced meanwhile", path);
    whole.pings = pings->count;
    whole.t0 = calloc(count, sizeof *whole.t0);
    double *speeds = reals_of(&v[SOUND_SPEED]);
    for (size_t p = 0; p < count && whole.t0; p++)
        whole.t0[p] = creal(v[T0].values[times == 1 ? 0 : p]);
    for (size_t k = 0; raw && k < variable_count(&v[PULSE]); k++)
        v[PULSE].values[k] *= ldexp(1, -pings->exponent);
    const enum status status =
        speeds && whole.t0 ? speeds_move(&whole, speeds, raw ? (int)variable_count(&v[PULSE]) : 0,
                                         raw ? v[PULSE].values : NULL, pings->read, pings->precision, pings->samples)
                           : status_set(STATUS_FAILED, "%s: no memory for its sound speeds", path);
    free(speeds);
    free(whole.t0);
    return status;
}

enum status echo_file_read_pings(const char *path, const struct acquisition *a, const struct pings *pings)
{
    static const enum echo_variable needed[] = {SAMPLES, SOUND_SPEED, T0, COMPRESSED, PULSE};
    enum { NEEDED = sizeof needed / sizeof *needed };
    struct wanted wanted[NEEDED];
    struct variable read[NEEDED], v[ECHO_VARIABLES] = {{.values = NULL}};
    for (int k = 0; k < NEEDED; k++)
        wanted[k] = echo_variables[needed[k]];
    wanted[0].pings = pings;
    enum status status = variables_read(path, wanted, NEEDED, read);
    if (status != STATUS_OK)
        return status;
    for (int k = 0; k < NEEDED; k++)
        v[needed[k]] = read[k];
    if (v[SAMPLES].dims[0] != (size_t)a->samples)
        status = status_set(STATUS_INVALID, "%s: has been replaced meanwhile", path);
    else if (variable_count(&v[SOUND_SPEED]) > 1)
        status = pings_move(path, v, a, pings);
    variables_free(read, NEEDED);
    return status;
}

enum status echo_file_is(const char *path, bool *is)
{
    /* A file with `t0` alone is one, too: its reader reports what is missing. */
    struct wanted either[] = {echo_variables[FORMAT], echo_variables[T0]};
    struct variable variables[2];
    either[0].is_optional = either[1].is_optional = true;
    enum status status = variables_read(path, either, 2, variables);
    *is = status == STATUS_OK && (variables[0].values || variables[1].values);
    if (status == STATUS_OK)
        variables_free(variables, 2);
    return status;
}
