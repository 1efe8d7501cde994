/* What the fuzzing programs share: bytes as a file, and bytes as numbers. */
#ifndef SASBENCH_FUZZ_INPUT_H
#define SASBENCH_FUZZ_INPUT_H

#include <stddef.h>
#include <stdint.h>

/* Called by libFuzzer. */
int LLVMFuzzerInitialize(int *count, char ***arguments);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A finding: say what is wrong and abort. */
_Noreturn void fuzz_fail(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The folder of this process below TMPDIR; removed with the files in it when the process ends. */
const char *fuzz_folder(void);
/* A file `name` in it that holds exactly these bytes; the path stays valid until the next call for the same slot. */
enum { FUZZ_SLOTS = 2 };
const char *fuzz_file(int slot, const char *name, const uint8_t *data, size_t size);

/* Bytes that are taken from the front; 0 when there are none left. */
struct bytes {
    const uint8_t *next, *end;
};
uint8_t take_byte(struct bytes *bytes);
int take_integer(struct bytes *bytes, int least, int most);
/* A number in [least, most]; one in sixteen is any double at all, infinite and NaN among them. */
double take_number(struct bytes *bytes, double least, double most);

#endif
