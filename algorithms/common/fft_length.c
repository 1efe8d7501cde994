#include "common/fft_length.h"

#include <limits.h>
#include <math.h>

int fft_length(long long n)
{
    static const int primes[] = {2, 3, 5, 7};
    for (n = n > 1 ? n : 1; n <= INT_MAX; n++) {
        long long rest = n;
        for (int i = 0; i < 4; i++)
            while (rest % primes[i] == 0)
                rest /= primes[i];
        if (rest == 1)
            return (int)n;
    }
    return 0;
}

int fft_length_fast(long long n)
{
    for (n = n > 1 ? n : 1; n <= INT_MAX; n++) {
        long long odd = n;
        while (odd % 2 == 0)
            odd /= 2;
        if (odd > 4 * (n / odd))
            continue;
        while (odd % 3 == 0)
            odd /= 3;
        while (odd % 5 == 0)
            odd /= 5;
        if (odd == 1)
            return (int)n;
    }
    return 0;
}

/* Seconds a FLOP of short transforms, by the odd part of their length, over those of powers of two. */
static double odd_slowness(int n)
{
    while (n % 2 == 0)
        n /= 2;
    return n == 1 || n == 5 ? 1 : n == 3 || n == 15 || n == 25 ? 1.5 : 1.8;
}

int fft_length_quick(long long n)
{
    enum { SHORT = 4096 }; /* longer ones differ little */
    const int least = fft_length_fast(n);
    int best = least;
    if (least == 0 || least > SHORT)
        return least;
    for (int length = least; length <= least + least / 4; length = fft_length_fast(length + 1))
        if (fft_flops(length) * odd_slowness(length) < fft_flops(best) * odd_slowness(best))
            best = length;
    return best;
}

double fft_slowness(int n)
{
    enum { SMALL = 400, LONG = 2048, OUT_OF_CACHE = 8192 };
    int rest = n, largest = 1, two = 1;
    for (int prime = 2; prime <= rest / prime; prime++)
        for (; rest % prime == 0; rest /= prime) {
            largest = prime;
            two *= prime == 2 ? 2 : 1;
        }
    largest = rest > largest ? rest : largest;
    if (largest > 7 || n / two > 4 * two)
        return largest > 31 ? 6 : largest > 13 ? 3.5 : 1.8;
    return n >= OUT_OF_CACHE ? 1.9 : n > LONG ? 1.7 : n > SMALL ? odd_slowness(n) : 1;
}

double fft_flops(double n)
{
    return 5 * n * log2(n);
}

int common_divisor(int a, int b)
{
    while (b > 0) {
        const int rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}
