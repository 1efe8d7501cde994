#include "guests/guests.h"

#include <stdlib.h>
#include <string.h>

#include "text/shown_text.h"

enum { NAME_MOST = 200 }; /* file names of pictures hold it, and 255 characters at most */

static const struct guest_kind *const kinds[] = {&guest_external, &guest_plugin};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* The newest first. */
static struct guest {
    struct guest *next;
    struct algorithm algorithm;
    char name[NAME_MOST + 1];
} * guests;

const char *guest_last(const char *spec)
{
    const char *at = spec;
    for (const char *bar; guest_external.length(at) == 0 && (bar = strchr(at, '|'));) /* a command may have its own */
        at = bar + 1 + strspn(bar + 1, " \t\n");
    return at;
}

char *guest_settle(const char *spec)
{
    const char *last = guest_last(spec);
    char *text = malloc(3 * strlen(spec) + 1), *to = text;
    if (!text)
        return NULL;
    for (const char *at = spec + strspn(spec, " \t\n"); at < last; at += strspn(at, " \t\n")) {
        const size_t length = strcspn(at, "|");
        memcpy(to, at, length);
        at += length + 1;
        for (to += length; to > text && strchr(" \t\n", to[-1]);)
            to--;
        to = stpcpy(to, to > text ? " | " : "| ");
    }
    strcpy(to, last);
    return text;
}

bool guest_foreign(const char *spec)
{
    for (const char *at = spec, *bar;; at = bar + 1 + strspn(bar + 1, " \t\n")) {
        for (int k = 0; k < KINDS; k++)
            if (kinds[k]->length(at) > 0)
                return true;
        bar = strchr(at, '|');
        if (!bar)
            return false;
    }
}

/* Of the name that a SPEC begins with, and its kind: NULL for the table's. */
static size_t name_length(const char *spec, const struct guest_kind **kind)
{
    const char *last = guest_last(spec);
    if (last > spec) {
        const size_t length = name_length(last, kind);
        *kind = &guest_chain;
        return (size_t)(last - spec) + length;
    }
    *kind = NULL;
    for (int k = 0; k < KINDS; k++) {
        const size_t length = kinds[k]->length(spec);
        if (length > 0) {
            *kind = kinds[k];
            return length;
        }
    }
    return strcspn(spec, ":");
}

const struct algorithm *guest_find(const char *spec, const char **rest)
{
    const struct guest_kind *kind;
    const size_t length = name_length(spec, &kind);
    *rest = spec + length;
    for (int table = 0; table < 2 && !kind; table++)
        for (const struct algorithm *const *at = table ? algorithm_filters : algorithms; *at; at++)
            if (strlen((*at)->name) == length && strncmp((*at)->name, spec, length) == 0)
                return *at;
    for (const struct guest *guest = guests; guest; guest = guest->next)
        if (strlen(guest->name) == length && strncmp(guest->name, spec, length) == 0)
            return &guest->algorithm;
    return NULL;
}

enum status guest_invite(const char *spec)
{
    const char *rest;
    const struct guest_kind *kind;
    const size_t length = name_length(spec, &kind);
    if (!kind)
        return STATUS_OK;
    for (const char *at = spec; *at; at += shown_length(at))
        if (shown_length(at) == 0) /* rows, tables and files of results would show another text */
            return status_set(STATUS_INVALID, "SPEC '%.100s': it has a control character, or is not UTF-8", spec);
    if (guest_find(spec, &rest))
        return STATUS_OK;
    if (length > NAME_MOST)
        return status_set(STATUS_INVALID, "SPEC '%.40s...': its name has %zu characters, must have at most %d", spec,
                          length, NAME_MOST);
    struct guest *guest = calloc(1, sizeof *guest);
    if (!guest)
        return status_set(STATUS_FAILED, "SPEC '%.100s': out of memory", spec);
    memcpy(guest->name, spec, length);
    guest->algorithm.name = guest->name;
    const enum status status = kind->make(guest->name, &guest->algorithm);
    if (status != STATUS_OK) {
        free(guest);
        return status;
    }
    guest->next = guests;
    guests = guest;
    return STATUS_OK;
}
