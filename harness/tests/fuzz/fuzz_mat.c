/* Any bytes as a MATLAB file of version 5 or 7.3: an echo file, or an image file when the last byte, which is not part
   of the file, is odd.

   The program reads such files in a child process, because libmatio and HDF5 crash on some. Those crashes are no
   findings. So here the child's sanitizers stay on, and what they report is a finding if the stack of the fault has no
   frame of a library in it. The child hands its counters of coverage back, so that the fuzzer sees what its input did
   there. */
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/types.h>

#include "echoes/matfile.h"
#include "tests/fuzz/input.h"

enum { REPORT_SIZE = 1 << 16, COUNTERS_MOST = 1 << 20 };

/* Shared with the child. */
static struct shared {
    char report[REPORT_SIZE];        /* the fault that is ours; else empty */
    uint8_t counters[COUNTERS_MOST]; /* its counters at its end */
} * shared;

static uint8_t *counters, *counters_end; /* of this process: how often each edge of the program was taken */
static bool is_child, is_reported;

/* The linker puts these in place of the C library's (--wrap). */
pid_t __real__Fork(void);
pid_t __wrap__Fork(void);
typedef void (*handler)(int);
handler __real_signal(int number, handler handle);
handler __wrap_signal(int number, handler handle);
_Noreturn void __real__exit(int code);
_Noreturn void __wrap__exit(int code);
void __real___sanitizer_cov_8bit_counters_init(uint8_t *first, uint8_t *end);
void __wrap___sanitizer_cov_8bit_counters_init(uint8_t *first, uint8_t *end);

void __wrap___sanitizer_cov_8bit_counters_init(uint8_t *first, uint8_t *end)
{
    if (end - first > COUNTERS_MOST)
        fuzz_fail("%td counters", end - first);
    counters = first;
    counters_end = end;
    __real___sanitizer_cov_8bit_counters_init(first, end);
}

static void counters_send(void)
{
    memcpy(shared->counters, counters, (size_t)(counters_end - counters));
}

static void counters_receive(void)
{
    for (ptrdiff_t i = 0; i < counters_end - counters; i++)
        counters[i] = counters[i] > shared->counters[i] ? counters[i] : shared->counters[i];
}

/* Libraries by their own memory, and by the one that ran out of stack in them. */
static bool stack_is_foreign(const char *text)
{
    static const char *const libraries[] = {"libmatio", "libhdf5", "libz.", "libsz.", "libaec."};
    const char *first = strstr(text, "#0 "), *end = first ? strstr(first, "\n\n") : NULL;
    for (size_t k = 0; first && k < sizeof libraries / sizeof *libraries; k++) {
        const char *found = strstr(first, libraries[k]);
        if (found && (!end || found < end))
            return true;
    }
    return false;
}

static void fault_reported(const char *text)
{
    is_reported = true;
    if (!stack_is_foreign(text))
        snprintf(shared->report, REPORT_SIZE, "%s", text);
}

/* The undefined behaviour sanitizer, which watches our own code alone, ends the process without a report to hand on. */
static void child_died(void)
{
    if (!is_reported)
        snprintf(shared->report, REPORT_SIZE, "the reading process was ended by a sanitizer");
    counters_send();
}

pid_t __wrap__Fork(void)
{
    pid_t child = __real__Fork();
    if (child == 0) {
        is_child = true;
        __asan_set_error_report_callback(fault_reported);
        __sanitizer_set_death_callback(child_died);
    }
    return child;
}

void __wrap__exit(int code)
{
    if (is_child)
        counters_send();
    __real__exit(code);
}

/* The child would leave crashes to the system; the address sanitizer is to see them. */
handler __wrap_signal(int number, handler handle)
{
    return is_child ? SIG_DFL : __real_signal(number, handle);
}

const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "symbolize=0:allocator_may_return_null=1:max_allocation_size_mb=512";
}

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
    (void)count;
    (void)arguments;
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return shared != MAP_FAILED && counters ? 0 : -1;
}

static void image_try(const char *path)
{
    struct image_file file;
    if (image_file_open(path, &file) == STATUS_OK)
        image_file_close(&file);
    else if (!*status_message())
        fuzz_fail("refused without a message");
}

static void echoes_try(const char *path)
{
    struct acquisition acquisition;
    struct echoes echoes;
    struct echo_notes notes;
    if (echo_notes_read(path, &notes) == STATUS_OK)
        echo_notes_free(&notes);
    if (echo_file_read(path, &acquisition, &echoes) == STATUS_OK) {
        acquisition_free(&acquisition);
        echoes_free(&echoes);
    } else if (!*status_message())
        fuzz_fail("refused without a message");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    const char *path = fuzz_file(0, "fuzz.mat", data, size - 1);
    *shared->report = '\0';
    memset(shared->counters, 0, (size_t)(counters_end - counters));
    if (data[size - 1] % 2)
        image_try(path);
    else
        echoes_try(path);
    counters_receive();
    if (*shared->report)
        fuzz_fail("%s", shared->report);
    return 0;
}
