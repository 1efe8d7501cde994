/* The origin of measurements: the machine, the compiler, the libraries and this very program. Rows are comparable
   where they agree. */
#include "results/provenance.h"

#include <fftw3.h>
#include <libconfig.h>
#include <matio.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "common/isa.h"
#include "files/hash.h"
#include "commit.h" /* made by the build */

#ifndef SASBENCH_FLAGS
#define SASBENCH_FLAGS "unknown"
#endif

#ifdef __clang__
#define COMPILER "" /* its __VERSION__ begins with the name */
#else
#define COMPILER "gcc "
#endif

static void machine_fill(char *text, size_t size)
{
    char line[256], model[96] = "unknown processor";
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file)) {
        char *value = strchr(line, ':');
        if (value && strncmp(line, "model name", strlen("model name")) == 0) {
            snprintf(model, sizeof model, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
            break;
        }
    }
    if (file)
        fclose(file);
    double gib = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / 1073741824.0;
    snprintf(text, size, "%s, %ld cores, %.1f GiB", model, sysconf(_SC_NPROCESSORS_ONLN), gib);
}

static void date_fill(char *text, size_t size)
{
    time_t now = time(NULL);
    struct tm utc;
    *text = '\0';
    if (gmtime_r(&now, &utc))
        strftime(text, size, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

void provenance_fill(struct provenance *provenance, int threads)
{
    *provenance = (struct provenance){.threads = threads};
    machine_fill(provenance->machine, sizeof provenance->machine);
    /* A program changed without a commit does not mix its rows with others. */
    hash_file("/proc/self/exe", provenance->program);
    snprintf(provenance->isa, sizeof provenance->isa, "%s", isa_name(isa_choose()));
    snprintf(provenance->compiler, sizeof provenance->compiler, "%s%s", COMPILER, __VERSION__);
    snprintf(provenance->flags, sizeof provenance->flags, "%s", SASBENCH_FLAGS);
    snprintf(provenance->commit, sizeof provenance->commit, "%s", SASBENCH_COMMIT);
    int matio[3];
    Mat_GetLibraryVersion(&matio[0], &matio[1], &matio[2]);
    snprintf(provenance->libraries, sizeof provenance->libraries, "%s, matio-%d.%d.%d, libconfig-%d.%d.%d",
             fftw_version, matio[0], matio[1], matio[2], LIBCONFIG_VER_MAJOR, LIBCONFIG_VER_MINOR,
             LIBCONFIG_VER_REVISION);
    date_fill(provenance->date, sizeof provenance->date);
}

void provenance_line(char text[PROVENANCE_LINE])
{
    char date[32];
    date_fill(date, sizeof date);
    snprintf(text, PROVENANCE_LINE, "sasbench %s, %s", SASBENCH_COMMIT, date);
}
