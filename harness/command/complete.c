/* What may stand for the last word of a command line: shells ask by `sasbench complete WORD ...` (harness/shells). */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "claims/claims.h"
#include "command/commands.h"
#include "files/paths.h"
#include "papers/tables.h"

/* A line, if it begins with what is typed. */
static void offer(const char *typed, const char *before, const char *name, const char *after)
{
    char word[600];
    const int length = snprintf(word, sizeof word, "%s%s%s", before, name, after);
    if (length < (int)sizeof word && strncmp(word, typed, strlen(typed)) == 0)
        puts(word);
}

static void offer_commands(const char *typed)
{
    static const char *const others[] = {"help", "--help", "--version", NULL};
    for (const struct command *c = commands; c->name; c++)
        if (!c->hidden)
            offer(typed, "", c->name, "");
    for (int k = 0; others[k]; k++)
        offer(typed, "", others[k], "");
}

static void offer_scenes(const char *typed)
{
    char **names;
    int count;
    if (scene_names(data_path(DATA_SCENES), &names, &count) != STATUS_OK)
        return;
    for (int k = 0; k < count; k++)
        offer(typed, "", names[k], "");
    scene_names_free(names, count);
}

/* Tables and claims by their IDs. */
static void offer_ids(const char *typed)
{
    struct claims claims = {0};
    for (int k = 0; paper_tables[k].id; k++)
        offer(typed, "", paper_tables[k].id, "");
    if (claims_read(data_path(DATA_CLAIMS), &claims) == STATUS_OK)
        for (int k = 0; k < claims.count; k++)
            offer(typed, "", claims.claims[k].id, "");
    offer(typed, "", "sensitivity", "");
    claims_free(&claims);
}

/* The values of a setting: all of a choice, those that `sweep` runs of a number. */
static void offer_values(const char *typed, const char *before, const struct param *param)
{
    char value[80];
    for (int k = 0; param->type == PARAM_CHOICE && param->choices[k]; k++)
        offer(typed, before, param->choices[k], "");
    if (param->type == PARAM_CHOICE || !param->sweep)
        return;
    for (const char *at = param->sweep; *at; at += strspn(at, " ")) {
        const size_t length = strcspn(at, " ");
        snprintf(value, sizeof value, "%.*s", (int)length, at);
        offer(typed, before, value, "");
        at += length;
    }
}

/* "NAME:key=value,...": a name, a setting that is not there yet, or its values. */
static void offer_spec(const char *typed)
{
    static const char *const precisions[] = {"float", "double", NULL};
    static const struct param precision = {.name = "precision", .type = PARAM_CHOICE, .choices = precisions};
    char name[80], before[400], given[80];
    const char *colon = strchr(typed, ':');
    if (!colon) {
        for (int k = 0; algorithms[k]; k++)
            offer(typed, "", algorithms[k]->name, "");
        offer(typed, "", "auto", "");
        return;
    }
    snprintf(name, sizeof name, "%.*s", (int)(colon - typed), typed);
    const struct algorithm *algorithm = algorithm_find(name);
    const char *comma = strrchr(colon, ','), *key = comma ? comma + 1 : colon + 1, *equal = strchr(key, '=');
    if (!algorithm || strlen(typed) >= sizeof before)
        return;
    snprintf(before, sizeof before, "%.*s", (int)((equal ? equal + 1 : key) - typed), typed);
    for (const struct param *p = algorithm->params; p && p->name; p++) {
        snprintf(given, sizeof given, "%s=", p->name);
        if (equal && strncmp(key, given, strlen(given)) == 0)
            offer_values(typed, before, p);
        else if (!equal && !p->hidden && !strstr(before, given))
            offer(typed, before, p->name, "=");
    }
    if (equal && strncmp(key, "precision=", 10) == 0)
        offer_values(typed, before, &precision);
    else if (!equal && !strstr(before, "precision="))
        offer(typed, before, precision.name, "=");
}

static void offer_options(const char *typed, const struct command *command)
{
    for (const struct named *o = options; o->name; o++)
        if (command_takes(command, o))
            offer(typed, "--", o->name, "");
    offer(typed, "--", "help", "");
}

/* Names without an option; files are the shell's to complete. */
static void offer_names(const char *typed, const struct command *command)
{
    if (strcmp(command->name, "reproduce") == 0)
        offer_ids(typed);
    else if (strcmp(command->name, "info") == 0 || strcmp(command->name, "conformance") == 0)
        offer_spec(typed);
    else if (strcmp(command->name, "scenes") == 0)
        offer(typed, "", "random", "");
    else if (strstr(command->arguments, "SCENE"))
        offer_scenes(typed);
}

/* The option whose value the last word is; NULL: none. */
static const struct named *option_before(const char *word)
{
    for (const struct named *o = options; o->name; o++)
        if (o->value
            && (strncmp(word, "--", 2) == 0 ? strcmp(word + 2, o->name) == 0
                                            : *word == '-' && islower(o->letter) && word[1] == o->letter && !word[2]))
            return o;
    return NULL;
}

void command_complete(int count, char *const *words)
{
    const char *typed = count > 0 ? words[count - 1] : "";
    const struct command *command = commands;
    while (count > 1 && command->name && strcmp(command->name, words[0]) != 0)
        command++;
    if (count <= 1 || (count == 2 && strcmp(words[0], "help") == 0))
        offer_commands(typed);
    if (count <= 1 || !command->name)
        return;
    const struct named *option = count > 2 ? option_before(words[count - 2]) : NULL;
    if (option && strcmp(option->name, "algorithm") == 0)
        offer_spec(typed);
    else if (option && strcmp(option->name, "scene") == 0)
        offer_scenes(typed);
    else if (option && strcmp(option->name, "precision") == 0) {
        offer(typed, "", "float", "");
        offer(typed, "", "double", "");
    } else if (!option && *typed == '-')
        offer_options(typed, command);
    else if (!option)
        offer_names(typed, command);
}
