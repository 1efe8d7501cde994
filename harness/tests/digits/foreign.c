/* FFTW as .ci/digits links it: built without the sanitizer, it leaves the sanitizer's idea of an array as it was before
   the transform. So each array that it may have written is declared unknown (the linker puts these functions in place
   of FFTW's, --wrap). The extents are those of complex arrays of contiguous lines, all that the algorithms plan. */
#include <fftw3.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

void __nsan_set_value_unknown(const unsigned char *address, size_t size);

/* What the program holds for a plan. */
struct planned {
    void *plan, *to; /* to: NULL when the call names the array */
    size_t bytes;
};

static void *planned_make(void *plan, void *to, size_t bytes)
{
    struct planned *planned = plan ? malloc(sizeof *planned) : NULL;
    if (planned)
        *planned = (struct planned){plan, to, bytes};
    return planned;
}

#define FOREIGN(name, complex)                                                                                         \
    void *__real_##name##_plan_dft_1d(int length, complex *from, complex *to, int sign, unsigned flags);               \
    void *__wrap_##name##_plan_dft_1d(int length, complex *from, complex *to, int sign, unsigned flags);               \
    void *__wrap_##name##_plan_dft_1d(int length, complex *from, complex *to, int sign, unsigned flags)                \
    {                                                                                                                  \
        return planned_make(__real_##name##_plan_dft_1d(length, from, to, sign, flags), to,                            \
                            (size_t)length * sizeof *to);                                                              \
    }                                                                                                                  \
    void *__real_##name##_plan_many_dft(int rank, const int *n, int many, complex *from, const int *inembed,           \
                                        int istride, int idist, complex *to, const int *onembed, int ostride,          \
                                        int odist, int sign, unsigned flags);                                          \
    void *__wrap_##name##_plan_many_dft(int rank, const int *n, int many, complex *from, const int *inembed,           \
                                        int istride, int idist, complex *to, const int *onembed, int ostride,          \
                                        int odist, int sign, unsigned flags);                                          \
    void *__wrap_##name##_plan_many_dft(int rank, const int *n, int many, complex *from, const int *inembed,           \
                                        int istride, int idist, complex *to, const int *onembed, int ostride,          \
                                        int odist, int sign, unsigned flags)                                           \
    {                                                                                                                  \
        return planned_make(                                                                                           \
            __real_##name##_plan_many_dft(rank, n, many, from, inembed, istride, idist, to, onembed, ostride, odist,   \
                                          sign, flags),                                                                \
            to, ((size_t)(n[0] - 1) * (size_t)ostride + (size_t)(many - 1) * (size_t)odist + 1) * sizeof *to);         \
    }                                                                                                                  \
    void __real_##name##_execute(const void *plan);                                                                    \
    void __wrap_##name##_execute(const struct planned *planned);                                                       \
    void __wrap_##name##_execute(const struct planned *planned)                                                        \
    {                                                                                                                  \
        __real_##name##_execute(planned->plan);                                                                        \
        __nsan_set_value_unknown(planned->to, planned->bytes);                                                         \
    }                                                                                                                  \
    void __real_##name##_execute_dft(const void *plan, complex *from, complex *to);                                    \
    void __wrap_##name##_execute_dft(const struct planned *planned, complex *from, complex *to);                       \
    void __wrap_##name##_execute_dft(const struct planned *planned, complex *from, complex *to)                        \
    {                                                                                                                  \
        __real_##name##_execute_dft(planned->plan, from, to);                                                          \
        __nsan_set_value_unknown((unsigned char *)to, planned->bytes);                                                 \
    }                                                                                                                  \
    void __real_##name##_destroy_plan(void *plan);                                                                     \
    void __wrap_##name##_destroy_plan(struct planned *planned);                                                        \
    void __wrap_##name##_destroy_plan(struct planned *planned)                                                         \
    {                                                                                                                  \
        if (planned)                                                                                                   \
            __real_##name##_destroy_plan(planned->plan);                                                               \
        free(planned);                                                                                                 \
    }

/* NOLINTBEGIN(readability-function-size): the parameters are those of FFTW. */
FOREIGN(fftw, fftw_complex)
FOREIGN(fftwf, fftwf_complex)
/* NOLINTEND(readability-function-size) */

/* The sanitizer's own strsep crashes at the end of a text (clang 19). */
char *__wrap_strsep(char **text, const char *separators);
char *__wrap_strsep(char **text, const char *separators)
{
    char *first = *text, *end = first ? strpbrk(first, separators) : NULL;
    *text = end ? end + 1 : NULL;
    if (end)
        *end = '\0';
    return first;
}
