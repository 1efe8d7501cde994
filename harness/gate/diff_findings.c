/* Where findings are kept (diff.h), and the status that follows from them. */
#define _GNU_SOURCE /* vasprintf */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "gate/diff.h"

const char *const verdict_names[VERDICTS] = {[VERDICT_WORSE] = "worse",
                                             [VERDICT_GONE] = "gone",
                                             [VERDICT_CHANGED] = "changed",
                                             [VERDICT_WARNING] = "warning",
                                             [VERDICT_NOISY] = "too noisy to tell",
                                             [VERDICT_BETTER] = "better",
                                             [VERDICT_NEW] = "new",
                                             [VERDICT_SAME] = "same"};
const char *const class_names[] = {[CLASS_QUALITY] = "quality", [CLASS_WORK] = "work", [CLASS_TIME] = "time"};

/* Room for one more element; *array is replaced when it grows. */
static void *array_room(void *array, int count, int *room, size_t size)
{
    if (count < *room)
        return array;
    int more = *room ? 2 * *room : 64;
    void *longer = realloc(array, (size_t)more * size);
    if (longer)
        *room = more;
    else
        status_set(STATUS_FAILED, "no memory for %d findings", more);
    return longer;
}

enum status diff_add(struct diff *diff, const struct finding *finding)
{
    struct finding *findings = array_room(diff->findings, diff->finding_count, &diff->finding_room, sizeof *findings);
    if (!findings)
        return STATUS_FAILED;
    diff->findings = findings;
    findings[diff->finding_count++] = *finding;
    diff->counts[finding->class][finding->verdict]++;
    return STATUS_OK;
}

/* The text is kept; NULL without memory. */
static const char *text_keep(struct diff *diff, const char *format, va_list arguments)
{
    char **texts = array_room(diff->texts, diff->text_count, &diff->text_room, sizeof *texts);
    if (!texts)
        return NULL;
    diff->texts = texts;
    char *text;
    if (vasprintf(&text, format, arguments) < 0) {
        status_set(STATUS_FAILED, "no memory for a text");
        return NULL;
    }
    texts[diff->text_count++] = text;
    return text;
}

const char *diff_text(struct diff *diff, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const char *text = text_keep(diff, format, arguments);
    va_end(arguments);
    return text;
}

enum status diff_note(struct diff *diff, const char *format, ...)
{
    if (diff->note_count == (int)(sizeof diff->notes / sizeof *diff->notes))
        return STATUS_OK;
    va_list arguments;
    va_start(arguments, format);
    const char *text = text_keep(diff, format, arguments);
    va_end(arguments);
    if (!text)
        return STATUS_FAILED;
    diff->notes[diff->note_count++] = text;
    return STATUS_OK;
}

int diff_count(const struct diff *diff, enum verdict verdict)
{
    int count = 0;
    for (int class = 0; class < CLASSES; class ++)
        count += diff->counts[class][verdict];
    return count;
}

enum status diff_status(const struct diff *diff)
{
    int worse = diff_count(diff, VERDICT_WORSE), gone = diff_count(diff, VERDICT_GONE);
    int changed = diff->to_baseline ? diff_count(diff, VERDICT_CHANGED) : 0;
    if (worse + gone + changed == 0)
        return STATUS_OK;
    if (changed == 0)
        return status_set(STATUS_FAILED, "%d worse, %d gone", worse, gone);
    return status_set(STATUS_FAILED,
                      "%d worse, %d gone, %d changed for the better: where that is meant, ./sasbench baseline "
                      "writes a new baseline, to be reviewed",
                      worse, gone, changed);
}

void diff_free(struct diff *diff)
{
    for (int k = 0; k < diff->text_count; k++)
        free(diff->texts[k]);
    free(diff->texts);
    free(diff->findings);
    *diff = (struct diff){0};
}
