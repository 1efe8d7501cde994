/* Shared objects as algorithms: loading one, and reading what it states of itself. */
#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "guests/guests.h"
#include "guests/keeper.h"
#include "guests/plugin.h"

static bool name_taken(const struct plugin *plugin, uint32_t count, const char *name)
{
    bool taken = strcmp(name, "precision") == 0;
    for (uint32_t k = 0; k < count; k++)
        taken |= strcmp(plugin->params[k].name, name) == 0;
    return taken;
}

/* One setting: numbers and indices have 8 bytes of the options each, texts TEXT_SIZE behind them. */
static enum status setting_take(struct plugin *plugin, uint32_t k, const struct sas_setting *s)
{
    struct param *param = &plugin->params[k];
    const bool text = s->kind == SAS_TEXT;
    *param =
        (struct param){.name = s->name,
                       .summary = s->summary,
                       .type = s->kind == SAS_INTEGER ? PARAM_INTEGER
                               : s->kind == SAS_REAL  ? PARAM_REAL
                               : text                 ? PARAM_TEXT
                                                      : PARAM_CHOICE,
                       .offset = 8 * (size_t)(text ? plugin->theirs.setting_count : k) + (text ? k * TEXT_SIZE : 0),
                       .size = text                  ? TEXT_SIZE
                               : s->kind == SAS_REAL ? sizeof(double)
                                                     : sizeof(int),
                       .initial = s->initial,
                       .min = s->min,
                       .max = s->max,
                       .choices = s->kind == SAS_NAME ? s->names : NULL,
                       .text = s->text ? s->text : "",
                       .sweep = s->sweep};
    int names = 0;
    while (s->kind == SAS_NAME && s->names && s->names[names])
        names++;
    if (s->kind == SAS_NAME)
        param->max = names - 1;
    const char *fault = NULL;
    if (s->kind < SAS_INTEGER || s->kind > SAS_TEXT)
        fault = "its kind is none of enum sas_kind";
    else if (!s->name || !*s->name || strpbrk(s->name, "=,:| \t\n") || !s->summary || !*s->summary)
        fault = "it needs a summary, and a name without blanks, '=', ',', ':' and '|'";
    else if (name_taken(plugin, k, s->name))
        fault = "its name is that of another setting, or of precision, which all have";
    else if (!text && !(s->initial >= param->min && s->initial <= param->max))
        fault = "its default is not within its bounds, or not one of its names";
    else if (s->kind != SAS_REAL && !text && s->initial != floor(s->initial))
        fault = "its default is no whole number";
    else if (text && (strlen(param->text) >= TEXT_SIZE || strchr(param->text, ',')))
        fault = "its default text has a comma, or more than 200 characters";
    return fault ? status_set(STATUS_INVALID, "%s: setting %d, '%.60s': %s", plugin->name, (int)k + 1,
                              s->name ? s->name : "", fault)
                 : STATUS_OK;
}

static enum status settings_take(struct plugin *plugin)
{
    const struct sas_algorithm *theirs = &plugin->theirs;
    const uint32_t stride = theirs->setting_count > 0 && theirs->settings ? theirs->settings[0].size : 0;
    enum status status = STATUS_OK;
    if (theirs->setting_count > 0 && !theirs->settings)
        status = status_set(STATUS_INVALID, "%s: it has %u settings, but `settings` is NULL", plugin->name,
                            theirs->setting_count);
    else if (theirs->setting_count > SETTINGS_MOST || stride > sizeof(struct sas_setting))
        status = status_set(STATUS_INVALID,
                            "%s: it has %u settings of %u bytes each, must be at most %d of %zu bytes; a newer "
                            "sasbench.h has more",
                            plugin->name, theirs->setting_count, stride, SETTINGS_MOST, sizeof(struct sas_setting));
    for (uint32_t k = 0; k < theirs->setting_count && status == STATUS_OK; k++) {
        struct sas_setting setting = {.size = 0};
        memcpy(&setting, (const char *)theirs->settings + (size_t)k * stride, stride);
        status = setting_take(plugin, k, &setting);
    }
    return status;
}

/* Versions of the constant `what`, whose struct is `type`. */
static enum status version_check(const struct plugin *plugin, const char *what, const char *type, uint32_t abi,
                                 uint32_t size, size_t least, size_t most)
{
    if (abi < 1 || abi > SAS_ABI)
        return status_set(STATUS_INVALID, "%s: its %s has ABI %u%s; this program takes 1 to %d", plugin->name, what,
                          abi, abi > SAS_ABI ? ", of a newer sasbench.h" : "", SAS_ABI);
    if (size < least || size > most)
        return status_set(STATUS_INVALID, "%s: its struct %s has %u bytes%s; this program takes %zu to %zu",
                          plugin->name, type, size, size > least ? ", of a newer sasbench.h" : "", least, most);
    return STATUS_OK;
}

/* Its common fields go to `theirs`, which names and settings are read from. */
static enum status filter_take(struct plugin *plugin, const struct sas_filter *filter)
{
    static const size_t least = offsetof(struct sas_filter, destroy) + sizeof filter->destroy;
    const enum status status =
        version_check(plugin, "sas_filter_plugin", "sas_filter", filter->abi, filter->size, least, sizeof *filter);
    if (status != STATUS_OK)
        return status;
    memcpy(&plugin->filter, filter, filter->size);
    plugin->theirs = (struct sas_algorithm){.summary = filter->summary,
                                            .reference = filter->reference,
                                            .setting_count = filter->setting_count,
                                            .settings = filter->settings,
                                            .work = filter->work,
                                            .destroy = filter->destroy};
    if (!filter->plan || !filter->execute || !filter->work || !filter->destroy || !filter->summary
        || !filter->reference)
        return status_set(STATUS_INVALID,
                          "%s: its sas_filter_plugin leaves out summary, reference, plan, execute, work or destroy",
                          plugin->name);
    return settings_take(plugin);
}

static enum status plugin_take(struct plugin *plugin, const struct sas_algorithm *theirs)
{
    static const size_t least = offsetof(struct sas_algorithm, destroy) + sizeof theirs->destroy;
    const enum status status =
        version_check(plugin, "sas_plugin", "sas_algorithm", theirs->abi, theirs->size, least, sizeof *theirs);
    if (status != STATUS_OK)
        return status;
    memcpy(&plugin->theirs, theirs, theirs->size);
    if (!theirs->plan || !theirs->execute || !theirs->work || !theirs->destroy || !theirs->summary
        || !theirs->reference)
        return status_set(STATUS_INVALID,
                          "%s: its sas_plugin leaves out summary, reference, plan, execute, work or destroy",
                          plugin->name);
    return settings_take(plugin);
}

static size_t plugin_length(const char *spec)
{
    for (const char *at = strstr(spec, ".so"); at; at = strstr(at + 1, ".so"))
        if (at > spec && (at[3] == '\0' || at[3] == ':'))
            return (size_t)(at + 3 - spec);
    return 0;
}

/* *object stays open, also where the status is not STATUS_OK. */
static enum status object_take(struct plugin *plugin, const char *path, void **object)
{
    *object = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!*object)
        return status_set(STATUS_INVALID, "%s: cannot be loaded: %s", plugin->name, dlerror());
    const struct sas_algorithm *theirs = dlsym(*object, "sas_plugin");
    const struct sas_filter *filter = theirs ? NULL : dlsym(*object, "sas_filter_plugin");
    if (theirs)
        return plugin_take(plugin, theirs);
    if (filter)
        return filter_take(plugin, filter);
    return status_set(STATUS_INVALID,
                      "%s: defines neither `sas_plugin` nor `sas_filter_plugin`, one of which a plug-in has "
                      "(sasbench.h)",
                      plugin->name);
}

/* Load it in a child first: half of an object, a constructor or a wild pointer may end or stop what loads it. */
static enum status load_try(struct plugin *plugin, const char *path)
{
    int state = 0;
    void *object;
    bool *returned = mmap(NULL, sizeof *returned, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    const pid_t child = returned == MAP_FAILED ? -1 : fork();
    if (child == 0) {
        signals_reset();
        object_take(plugin, path, &object);
        *returned = true;
        _exit(0);
    }
    while (child > 0 && waitpid(child, &state, WUNTRACED) < 0 && errno == EINTR)
        ;
    if (child > 0 && WIFSTOPPED(state)) {
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
    }
    const bool whole = child < 0 || *returned;
    if (returned != MAP_FAILED)
        munmap(returned, sizeof *returned);
    const int number = WIFSTOPPED(state) ? WSTOPSIG(state) : WTERMSIG(state);
    if (!whole && WIFEXITED(state))
        return status_set(STATUS_INVALID, "%s: cannot be loaded: this ends the program with exit status %d",
                          plugin->name, WEXITSTATUS(state));
    return whole ? STATUS_OK
                 : status_set(STATUS_INVALID, "%s: cannot be loaded: this %s by signal %d (%s)", plugin->name,
                              WIFSTOPPED(state) ? "stops" : "ends", number, strsignal(number));
}

static void algorithm_fill(const struct plugin *plugin, struct algorithm *algorithm)
{
    const size_t count = plugin->theirs.setting_count;
    const bool filter = plugin->filter.plan;
    *algorithm = (struct algorithm){.name = plugin->name,
                                    .origin = plugin->hash,
                                    .summary = plugin->theirs.summary,
                                    .reference = plugin->theirs.reference,
                                    .traits = plugin->theirs.traits & (SAS_ANY_TRACK | SAS_APERTURE_LIMIT),
                                    .options_size = count * (8 + TEXT_SIZE),
                                    .params = plugin->params,
                                    .method = plugin,
                                    .plan = plugin_plan,
                                    .execute = filter ? NULL : plugin_execute,
                                    .filtered = filter ? plugin_filtered : NULL,
                                    .filter = filter ? plugin_filter : NULL,
                                    .work = plugin_work,
                                    .destroy = plugin_destroy};
}

enum status plugin_adopt(const char *name, const char *origin, const struct sas_algorithm *theirs,
                         struct plugin *plugin, struct algorithm *algorithm)
{
    plugin->name = name;
    snprintf(plugin->hash, sizeof plugin->hash, "%s", origin);
    const enum status status = plugin_take(plugin, theirs);
    if (status == STATUS_OK)
        algorithm_fill(plugin, algorithm);
    return status;
}

/* dlopen takes a name without a slash for one of the system's libraries. */
static enum status plugin_make(const char *name, struct algorithm *algorithm)
{
    char path[4096];
    void *object = NULL;
    struct plugin *plugin = calloc(1, sizeof *plugin);
    if (!plugin)
        return status_set(STATUS_FAILED, "%s: out of memory", name);
    plugin->name = name;
    snprintf(path, sizeof path, "%s%s", strchr(name, '/') ? "" : "./", name);
    enum status status = hash_file(path, plugin->hash)
                             ? load_try(plugin, path)
                             : status_set(STATUS_INVALID, "%s: cannot be read: %s", name, strerror(errno));
    if (status == STATUS_OK)
        status = object_take(plugin, path, &object);
    if (status != STATUS_OK) {
        if (object)
            dlclose(object);
        free(plugin);
        return status;
    }
    algorithm_fill(plugin, algorithm);
    return STATUS_OK;
}

const struct guest_kind guest_plugin = {plugin_length, plugin_make};
