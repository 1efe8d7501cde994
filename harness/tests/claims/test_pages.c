/* The pages of the papers: what a folder's files say is on them, and nothing is written of half a folder. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "files/paths.h"
#include "claims/reproduce.h"
#include "tests/planted.h"

static struct claims claims;

/* All claims hold, but for the first of BP22, which does not, and the second, which is undecided. */
static void verdicts_plant(int count)
{
    FILE *file = fopen(path_of("claims.csv"), "w");
    assert_non_null(file);
    fputs("# sasbench claims 1\n# commit: abc123\n# date: today\n"
          "id,paper,section,claim,verdict,corrected,basis,evidence\n",
          file);
    for (int k = 0; k < count; k++) {
        const struct claim *claim = &claims.claims[k];
        char evidence[4000];
        snprintf(evidence, sizeof evidence, "x = %d; criterion: %s%s%s; %d above 0: yes; settings: bp_<b>%s", k,
                 claim->criterion, *claim->changed ? "; criterion changed " : "", claim->changed, k,
                 claim->by_scheme ? " | corrected: y = 7; criterion: none" : "");
        csv_write_fields(file,
                         (const char *const[]){claim->id, claim->paper, claim->section, claim->claim,
                                               claim_verdict_names[k == 0   ? CLAIM_FAILS
                                                                   : k == 1 ? CLAIM_UNDECIDED
                                                                            : CLAIM_HOLDS],
                                               claim->by_scheme ? "does not hold" : "", "measured", evidence, NULL},
                         NULL, 0, true);
    }
    fclose(file);
}

static void folder_plant(void)
{
    verdicts_plant(claims.count);
    support_write("reproduced.csv", "table,item,quantity,definition,unit,paper,ours,difference,assumption\n"
                                    "bp22_t3,\"T1, sinc\",pslr_db,null,dB,-14.8,-13.3,1.5,far\n"
                                    "bp22_t3,\"T1, sinc\",pslr_db,pixel,dB,-14.8,-14.75,0.05,far\n"
                                    "bp22_t3,\"T2, sinc\",pslr_db,pixel,dB,-14.8,,,far; no value: failed\n"
                                    "bp22_t4,sinc,time_ratio,fast engines,1,2,2.5,0.5,far\n"
                                    "zp15_f4,sinc,pslr_db,null,dB,,-13.3,,far\n");
    char text[400];
    snprintf(text, sizeof text,
             "claim,scheme,assumption,verdict\n%s,as printed,as it is,does not hold\n%s,as printed,colder,holds\n"
             "%s,as printed,as it is,holds\n%s,as printed,colder,holds\n",
             claims.claims[0].id, claims.claims[0].id, claims.claims[2].id, claims.claims[2].id);
    support_write("sensitivity.csv", text);
    support_write("figure-bp22_f9.png", "slices");
    support_write("figure-bp22_f9.svg", "slices");
    support_write("figure-bp22_f8-table3-sinc.png", "image");
    support_write("phase-lbf21__phase_short-receiver1.png", "first");
    support_write("phase-lbf21__phase_short-receiver66.png", "last");
}

static void wanted_in(const char *name, const char *text)
{
    char *page = support_read(name);
    assert_non_null(page);
    if (!strstr(page, text)) {
        fputs(page, stderr);
        fail_msg("'%s' is not in %s", text, name);
    }
    free(page);
}

static void pages_say_what_files_say(void **state)
{
    (void)state;
    char text[600], to[4200];
    folder_plant();
    snprintf(to, sizeof to, "%s", path_of("docs"));
    assert_int_equal(pages_write(folder, to, &claims), STATUS_OK);
    wanted_in("docs/bp22.md", "- date: today\n- commit: abc123\n- machine: unknown");
    wanted_in("docs/bp22.md", "\n| as printed | 42 | 40 | 0 | 0 | 1 | 1 |\n"
                              "| those that depend on LBF21's scheme, corrected | 1 | 0 | 0 | 0 | 1 | 0 |\n\n"
                              "1 of the verdicts as printed change under another assumption.");
    snprintf(
        text, sizeof text,
        "What does not hold:\n\n- `%s`: %s (corrected: does not hold); another assumption changes it\n\nWhat cannot",
        claims.claims[0].id, claims.claims[0].claim);
    wanted_in("docs/bp22.md", text);
    wanted_in("docs/bp22.md",
              "\n| `bp22_t3` | pslr_db | null | 1 | 0 | 0 |\n| `bp22_t3` | pslr_db | pixel | 2 | 1 | 1 |\n"
              "| `bp22_t4` | time_ratio | fast engines | 1 | 0 | 0 |\n");
    wanted_in("docs/bp22.md", "\n| pslr_db (dB) | paper | null | pixel |\n|---|---|---|---|\n"
                              "| T1, sinc | -14.8 | -13.3 (+1.5) | -14.75 (+0.05) |\n"
                              "| T2, sinc | -14.8 | | no value |\n");
    wanted_in("docs/bp22.md", "](figure-bp22_f9.png)\n");
    wanted_in("docs/bp22.md", "](figure-bp22_f8-table3-sinc.png)\n");
    snprintf(text, sizeof text, "\n### %s: does not hold as printed; corrected: does not hold\n", claims.claims[0].id);
    wanted_in("docs/bp22.md", text);
    wanted_in("docs/bp22.md",
              "\n- Measured, as printed: x = 0\n- Decided, as printed: 0 above 0: yes; settings: bp\\_&lt;b&gt;\n"
              "- Measured, corrected: y = 7; criterion: none\n- Other assumptions, as printed: colder: **holds**.\n");
    wanted_in("docs/bp22.md", "\n- Other assumptions: the same verdict under all that were tried.\n");
    wanted_in("docs/zp15.md", "| sinc | not printed | -13.3 |\n");
    wanted_in("docs/lbf21.md", "receiver66.png)");
    assert_true(support_exists("docs/figure-bp22_f9.png"));
    assert_false(support_exists("docs/figure-bp22_f9.svg"));
    unlink(path_of("sensitivity.csv"));
    assert_int_equal(pages_write(folder, to, &claims), STATUS_OK);
    wanted_in("docs/bp22.md", "Other assumptions were not tried");
}

static void halves_are_refused(void **state)
{
    (void)state;
    folder_plant();
    verdicts_plant(claims.count - 1);
    assert_int_equal(pages_write(folder, path_of("none"), &claims), STATUS_INVALID);
    assert_non_null(strstr(status_message(), claims.claims[claims.count - 1].id));
    assert_false(support_exists("none"));
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_make, folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {IN_FOLDER(pages_say_what_files_say), IN_FOLDER(halves_are_refused)};
    if (claims_read(data_path(DATA_CLAIMS), &claims) != STATUS_OK)
        return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    claims_free(&claims);
    return failed;
}
