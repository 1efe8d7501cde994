/* An imaging algorithm in a shared object of its own: all that it needs to know of sasbench. C11 and C++11.

       static int plan(const struct sas_problem *problem, void **plan) ...
       const struct sas_algorithm sas_plugin = {sizeof sas_plugin, SAS_ABI, "my back projection", ...};

   A plug-in is a shared object that defines the constant `sas_plugin`. `./sasbench run --algorithm ./my.so:taps=8`
   measures it, `./sasbench conformance ./my.so` checks the rules below.

   THE IMAGE. At each pixel of each patch, p = (x, y = r, z = 0) in the track's axes,

       image(p) = sum over pings and receivers of  s(q) exp(+j 2 pi fc tau),     q = (tau - t0[ping]) fs
       c tau = |tx - p| + |rx + velocity tau - p|           the exact delay (BP22 Eq. (1), LBF21 Eq. (1)); host->pair

   where s is the range-compressed record of that ping and receiver, read between its samples at q; taps of a kernel
   beyond the record's ends read zero. There is no 1/N: a lone unit target shows the number of its pairs, with phase 0.
   - Which pairs count: 0 <= q <= samples - 1, both ends included, and |sin theta| <= aperture_limit. theta is the
     angle at the transmitter between the pixel and the plane normal to the track, which the beam's squint turns.
     host->pair decides it; host->pairs counts all of a problem, in turned grids as well. Without SAS_APERTURE_LIMIT
     all pairs within the record may be summed.
   - Raw echoes (pulse_length > 0) are compressed first: c[n] = sum over k of s[n + k] conj(pulse[k]) / sum |pulse|^2,
     with zeros beyond the record's end, so that a unit target peaks at 1. host->compress does it.

   RULES
   - Units: m, s, Hz, rad. x runs along the track, r across it. Complex numbers are pairs of reals, real part first:
     float[2] or double[2] by the problem's precision. Delays and phases need double in either precision.
   - Arrays are dense, row by row as their comments state: [pings][receivers][samples] has the samples side by side.
     Samples and pixels are aligned to a complex number of their precision, and to no more.
   - plan does all that depends on geometry and settings: tables, transforms' plans, scratch memory for `threads`
     threads. What it receives (problem, acquisition, patches, settings, host) stays valid until destroy, read only.
   - execute is timed. It goes from samples to pixels, writes every pixel, depends on nothing but the samples, linearly,
     and keeps nothing from one run for the next: every other run images the negated echoes. It allocates and maps no
     memory, reads no sample beyond the array, writes neither into the samples nor beside the image, ends the
     threads that it began, and leaves OpenMP's settings as they are.
   - The same bits for any number of threads, and from run to run.
   - Concurrency: plan and destroy are called by one thread at a time. Several plans may live at once, and be executed
     at once by different threads. One plan is executed by one thread at a time, which may use `threads` threads.
   - No function prints, exits, throws past its caller, or keeps state outside its plan.
   - Errors: return host->fail(SAS_UNSUPPORTED, "the track bends by %g m", bend) with the reason. Never a silent zero.

   ECHOES TO ECHOES. A shared object may define `sas_filter_plugin` instead: a filter, motion compensation, autofocus.
   It stands ahead of an algorithm, `--algorithm "./notch.so:low=1e3 | bp_farrow:degree=5"`, and its time counts.
   - plan: *out begins as a copy of the problem's acquisition. It changes what its echoes have otherwise: numbers, and
     arrays, which it points to its own, valid until destroy. Sizes may change, and pulse_length = 0 tells that it
     compresses. What follows images *out on the same pixels.
   - execute writes all samples of *out, [pings][receivers][samples]. It need not be linear, but the same samples give
     the same bits, and the negated ones not the same image. It may change the values behind the arrays of *out, as an
     estimated track: what follows is then planned anew, in the time, as the stage `plan`. It never changes sizes.
   - All other rules hold. The host checks *out: at least 1 ping and receiver and 2 samples, all numbers finite.

   VERSIONS. Every struct begins with its size in bytes. Later headers only append fields, and count SAS_ABI up. The
   host takes plug-ins of older headers and refuses those of newer ones. A plug-in that must run under an older host as
   well asks by SAS_HAS whether a field is there. */
#ifndef SASBENCH_H
#define SASBENCH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SAS_ABI                       2 /* 2: sas_filter_plugin */
#define SAS_HAS(pointer, type, field) ((pointer)->size >= offsetof(type, field) + sizeof((pointer)->field))

enum sas_status {
    SAS_OK = 0,
    SAS_FAILED = 1,     /* out of memory, and what else ends a run */
    SAS_INVALID = 2,    /* settings that contradict each other */
    SAS_UNSUPPORTED = 3 /* a problem that the algorithm cannot image: the reason becomes the row */
};
enum sas_precision { SAS_FLOAT = 0, SAS_DOUBLE = 1 };
enum sas_trait {
    SAS_ANY_TRACK = 2,     /* images any track in space, not only uniform straight ones along x */
    SAS_APERTURE_LIMIT = 4 /* honours aperture_limit pixel by pixel */
};

/* The recording, without its samples. */
struct sas_acquisition {
    uint32_t size;
    int32_t pings, receivers, samples; /* >= 1, >= 1, >= 2 */
    double sound_speed_m_s, carrier_hz, sampling_hz, bandwidth_hz;
    const double *t0_s;              /* [pings] of each record's first sample after its emission */
    const double *tx_m;              /* [pings][3] x, y, z of the transmitter at emission */
    const double *rx_m;              /* [pings][receivers][3] of the receivers at emission */
    const double *velocity_m_s;      /* [pings][3] of the receivers during propagation; 0: stop and hop */
    double tx_length_m, rx_length_m; /* of the elements along the track; 0: not known */
    double aperture_limit;           /* sine; infinite: all pairs */
    int32_t pulse_length;            /* samples of the replica; 0: the echoes are compressed */
    const double *pulse;             /* [pulse_length][2] the replica at sampling_hz, beginning at emission */
};

/* Row i, column j of a patch: x' = x_first + j x_step, r' = r_first + i r_step, in axes turned by angle_rad:
   x = x' cos + r' sin, r = -x' sin + r' cos (SQ18). r may have either sign. */
struct sas_grid {
    uint32_t size;
    int32_t x_count, r_count; /* >= 1 */
    double x_first_m, x_step_m, r_first_m, r_step_m, angle_rad;
};

struct sas_host;
struct sas_problem {
    uint32_t size;
    int32_t precision; /* enum sas_precision, of samples and pixels */
    const struct sas_acquisition *acquisition;
    int64_t pixels;                        /* of all patches */
    int32_t patch_count;                   /* >= 1: execute fills all of them; their steps and angles may differ */
    int32_t threads;                       /* that execute may use at most */
    const struct sas_grid *const *patches; /* [patch_count] */
    const double *numbers;                 /* [setting_count] values of SAS_INTEGER, SAS_REAL; index of SAS_NAME */
    const char *const *texts;              /* [setting_count] of SAS_TEXT; else NULL */
    const struct sas_host *host;
};

/* The host's functions; each may be called by several threads at once, and allocates nothing but in `pairs`. A record's
   number is ping * receivers + receiver; a pixel's counts row by row, through one patch after the other. */
struct sas_host {
    uint32_t size, abi;
    /* Does a pair count? Its exact delay, and where its record is read, go to *delay_s and *q in either case. */
    int (*pair)(const struct sas_problem *problem, int32_t record, int64_t pixel, double *delay_s, double *q);
    /* The pixel's place in the track's axes, x, y = r, z = 0. */
    void (*place)(const struct sas_problem *problem, int64_t pixel, double place_m[3]);
    /* The number of pairs that count. */
    double (*pairs)(const struct sas_problem *problem);
    /* The record, compressed, or as it is where the echoes are compressed, into double [samples][2] in either
       precision. `thread` is 0 to threads - 1: each has scratch memory of its own. */
    void (*compress)(const struct sas_problem *problem, int thread, const void *samples, int32_t record, void *row);
    /* FLOPs of compressing all records; 0 where they are compressed. */
    double (*compress_flops)(const struct sas_problem *problem);
    /* Write a pixel, rounded to the precision. */
    void (*store)(const struct sas_problem *problem, void *const *pixels, int64_t pixel, double re, double im);
    /* In execute, by its calling thread, at least once: the time since the last call, or the start, goes to this name,
       a text of the plug-in ("compress", "focus"). At most 12 names. */
    void (*stage)(void *run, const char *name);
    /* Keep the message (printf's format, one line) and return `status`. */
    int (*fail)(int status, const char *format, ...)
#ifdef __GNUC__
        __attribute__((format(printf, 2, 3)))
#endif
        ;
};

/* Counts that no machine changes. */
struct sas_work {
    uint32_t size;     /* set by the host */
    double flops;      /* real additions and multiplications of execute on samples and pixels: 5 N log2 N an FFT, 6 a
                          complex product, 8 one that is added to a sum; so at least 8 a pair. Not: delays, phase
                          factors, weights. host->compress has counts of its own: compress_flops */
    double pairs;      /* host->pairs(problem); 0 where the method sums no pairs */
    double bytes;      /* what the plan holds on one thread */
    char engine[96];   /* one word: the way chosen; may stay empty */
    char skipped[256]; /* what was left out because the problem does not need it; may stay empty */
};

/* One setting of a SPEC. An array of them has the stride of its first one's size. */
enum sas_kind {
    SAS_INTEGER,
    SAS_REAL,
    SAS_NAME, /* one of `names` */
    SAS_TEXT  /* any text without a comma, as a path: at most 200 characters */
};
struct sas_setting {
    uint32_t size;
    int32_t kind;               /* enum sas_kind */
    const char *name, *summary; /* the name without blanks, '=', ',', ':' and '|'; not "precision" */
    double initial, min, max;   /* default (of SAS_NAME: its index) and closed bounds of numbers */
    const char *const *names;   /* of SAS_NAME, NULL-terminated */
    const char *text;           /* default of SAS_TEXT; NULL: "" */
    const char *sweep;          /* values that `sweep` runs, separated by blanks; may be NULL */
};

struct sas_algorithm {
    uint32_t size, abi;                 /* sizeof(struct sas_algorithm), SAS_ABI */
    const char *summary, *reference;    /* a line each; reference: paper and equations */
    uint32_t traits;                    /* of enum sas_trait */
    uint32_t setting_count;             /* at most 60 */
    const struct sas_setting *settings; /* [setting_count] */
    int (*plan)(const struct sas_problem *problem, void **plan);
    int (*execute)(void *plan, const void *samples, void *const *pixels, void *run); /* pixels[patch][row][column] */
    void (*work)(const void *plan, struct sas_work *work);                           /* zeroed but for its size */
    void (*destroy)(void *plan);
};

/* ABI 2. Echoes to echoes. */
struct sas_filter {
    uint32_t size, abi;                 /* sizeof(struct sas_filter), SAS_ABI */
    const char *summary, *reference;    /* a line each */
    uint32_t traits;                    /* 0 */
    uint32_t setting_count;             /* at most 60 */
    const struct sas_setting *settings; /* [setting_count] */
    int (*plan)(const struct sas_problem *problem, struct sas_acquisition *out, void **plan);
    int (*execute)(void *plan, const void *samples, void *filtered, void *run);
    void (*work)(const void *plan, struct sas_work *work); /* flops and bytes; pairs stay 0 */
    void (*destroy)(void *plan);
};

#ifdef __GNUC__
#define SAS_VISIBLE __attribute__((visibility("default")))
#else
#define SAS_VISIBLE
#endif
/* A shared object defines one of them. */
extern SAS_VISIBLE const struct sas_algorithm sas_plugin;
extern SAS_VISIBLE const struct sas_filter sas_filter_plugin;

#ifdef __cplusplus
}
#endif

#endif
