/* The command `convert`: recordings in public layouts as an echo file. */
#include <stdio.h>
#include <sys/stat.h>

#include "command/task.h"
#include "convert/layouts.h"

/* A recording must not be replaced by its echoes. */
static enum status inputs_check(const struct task *task)
{
    struct stat output, input;
    if (stat(task->output, &output) != 0)
        return STATUS_OK;
    for (int k = 0; k < task->name_count; k++)
        if (stat(task->names[k], &input) == 0 && input.st_dev == output.st_dev && input.st_ino == output.st_ino)
            return status_set(STATUS_INVALID, "convert: -o %s is the recording itself; another file is needed",
                              task->output);
    return STATUS_OK;
}

enum status command_convert(const struct task *task)
{
    struct recording recording;
    char description[200];
    enum status status = output_check("convert", task->output);
    if (status == STATUS_OK)
        status = inputs_check(task);
    if (status == STATUS_OK)
        status = recording_read(task->names, task->name_count, &recording);
    if (status != STATUS_OK)
        return status;
    const struct acquisition *a = &recording.acquisition;
    snprintf(description, sizeof description, "converted from %s", recording.layout);
    const struct echo_notes notes = {.description = description};
    status = recording.source.pings ? echo_file_stream(task->output, a, &recording.source, &notes)
                                    : echo_file_write(task->output, &recording.echoes, &notes);
    if (status == STATUS_OK)
        printf("%s: %s, %d pings, %d receiver%s, %d samples\n%s%s", task->output, recording.layout, a->pings,
               a->receivers, a->receivers == 1 ? "" : "s", a->samples, recording.note, *recording.note ? "\n" : "");
    recording_free(&recording);
    return status;
}
