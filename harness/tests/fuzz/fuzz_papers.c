/* Any bytes as claims.csv (read and evaluated without measurements), as published.csv, and as points of `phase
   --at`. */
#include <stdio.h>

#include "claims/claims.h"
#include "papers/phase.h"
#include "tests/fuzz/input.h"

static struct measured measured; /* nothing measured; the papers' numbers */

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
    (void)count;
    (void)arguments;
    return freopen("/dev/null", "w", stdout) && published_read(&measured.published) == STATUS_OK ? 0 : -1;
}

static void claims_try(const char *path)
{
    struct claims claims;
    if (claims_read(path, &claims) == STATUS_OK)
        for (int k = 0; k < claims.count; k++)
            claim_evaluate(&claims, &claims.claims[k], SCHEME_PRINTED, &measured);
    else if (!*status_message())
        fuzz_fail("refused without a message");
    claims_free(&claims);
}

static void published_try(const char *path)
{
    struct csv csv;
    double values[4];
    if (csv_read(path, CSV_TAIL_KEEP, &csv) == STATUS_OK && csv.column_count > PUBLISHED_NOTE
        && published_values(&csv, "t", "1..2", "m", "q", values, 4) > 4)
        fuzz_fail("more values than there is room for");
    csv_free(&csv);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(0, "fuzz.csv", data, size);
    claims_try(path);
    published_try(path);
    phase_points_print(path);
    return 0;
}
