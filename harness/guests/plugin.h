/* A shared object: what it states (plugin_load.c), and struct algorithm's callbacks of it (plugin.c). */
#ifndef SASBENCH_GUESTS_PLUGIN_H
#define SASBENCH_GUESTS_PLUGIN_H

#include "contract/algorithm.h"
#include "files/hash.h"
#include "sasbench.h"

enum { SETTINGS_MOST = 60, TEXT_SIZE = 208 };

/* One shared object, kept until the program ends. */
struct plugin {
    const char *name;
    struct sas_algorithm theirs; /* fields beyond their header's are 0; of a filter, those that both structs have */
    struct sas_filter filter;    /* zeroed where it is an algorithm */
    struct param params[SETTINGS_MOST + 1];
    char hash[HASH_TEXT];
};

/* An algorithm that lies in this process already: *plugin is zeroed, and lives as long as *algorithm; so do `name` and
   what *theirs points to. `origin` identifies its code. Errors: STATUS_INVALID naming what it leaves out. */
enum status plugin_adopt(const char *name, const char *origin, const struct sas_algorithm *theirs,
                         struct plugin *plugin, struct algorithm *algorithm);

enum status plugin_plan(const struct problem *problem, const void *method, const void *options, void **out);
enum status plugin_execute(void *plan, const struct echoes *echoes, struct image *image, struct stages *stages);
enum status plugin_filtered(const void *plan, struct acquisition *out);
enum status plugin_filter(void *plan, const void *samples, void *filtered, struct stages *stages);
struct work plugin_work(const void *plan);
void plugin_destroy(void *plan);

#endif
