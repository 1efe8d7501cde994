/* LBF21's method as printed and corrected (schemes.h). */
#include "papers/schemes.h"

#include <stdio.h>
#include <string.h>

const char *const scheme_names[SCHEMES] = {[SCHEME_PRINTED] = "as printed", [SCHEME_CORRECTED] = "corrected"};

bool scheme_spec(enum scheme scheme, const char *text, char *spec, size_t size)
{
    static const char word[] = "LBF:";
    const size_t length = sizeof word - 1;
    if (strncmp(text, word, length) != 0) {
        snprintf(spec, size, "%s", text);
        return false;
    }
    const char *printed = strstr(text, "spacing=") ? "variant=printed,blend=off,"
                                                   : "variant=printed,spacing=uniform,"
                                                     "blend=off,";
    snprintf(spec, size, "rma_lbf:%s%s", scheme == SCHEME_PRINTED ? printed : "", text + length);
    return true;
}

bool scheme_formula(enum scheme scheme, const char *name, const char **formula)
{
    bool eq_5 = strcmp(name, "LBF") == 0, eq_7 = strcmp(name, "LBF7") == 0;
    *formula = name;
    if (eq_5 || eq_7)
        *formula = scheme == SCHEME_CORRECTED ? "lbf_F" : eq_5 ? "lbf_fc" : "lbf7_fc";
    return eq_5 || eq_7;
}
