#include "contract/param.h"

#include <stdio.h>
#include <string.h>

void param_store(const struct param *param, void *options, double value)
{
    void *field = (char *)options + param->offset;
    if (param->type == PARAM_REAL)
        *(double *)field = value;
    else
        *(int *)field = (int)value;
}

double param_load(const struct param *param, const void *options)
{
    const void *field = (const char *)options + param->offset;
    return param->type == PARAM_REAL ? *(const double *)field : *(const int *)field;
}

int param_choice(const struct param *param, const char *name)
{
    for (int k = 0; param->choices[k]; k++)
        if (strcmp(param->choices[k], name) == 0)
            return k;
    return -1;
}

void options_fill(const struct algorithm *algorithm, void *options)
{
    if (algorithm->options_size > 0)
        memset(options, 0, algorithm->options_size);
    for (const struct param *param = algorithm->params; param && param->name; param++)
        if (param->type == PARAM_TEXT)
            snprintf((char *)options + param->offset, param->size, "%s", param->text);
        else
            param_store(param, options, param->initial);
}
