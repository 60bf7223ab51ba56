/* Reads pairs x, y of doubles from standard input; writes, for each width, the outputs of every pair
   as `elementary.h` computes them, and says on standard error how many were computed again by libm. */

#include <stdio.h>
#include <string.h>

#define LARGEST 1e300
#define BODIES "elementary.h"
#include "widths.h"

typedef int (*Function)(const double *k, const double *in, double *out);

static void run(int width, Function function, const double *pairs, long count)
{
    static double x[INPUTS][PANEL] __attribute__((aligned(64))), y[OUTPUTS][PANEL] __attribute__((aligned(64)));
    long again = 0;
    for (long first = 0; first < count; first += width) {
        double one[INPUTS], result[OUTPUTS];
        if (width == 1) {
            if (!function(NULL, pairs + INPUTS * first, result))
                again += elementary_0(NULL, pairs + INPUTS * first, result);
            fwrite(result, sizeof result, 1, stdout);
            continue;
        }
        for (int lane = 0; lane < width; lane++)
            for (int i = 0; i < INPUTS; i++)
                x[i][lane] = pairs[INPUTS * (first + lane) + i];
        const int ordinary = function(NULL, x[0], y[0]);
        for (int lane = 0; lane < width; lane++) {
            for (int i = 0; i < INPUTS; i++)
                one[i] = x[i][lane];
            for (int i = 0; i < OUTPUTS; i++)
                result[i] = y[i][lane];
            if (!ordinary)
                again += elementary_0(NULL, one, result);
            fwrite(result, sizeof result, 1, stdout);
        }
    }
    fprintf(stderr, "%d %ld\n", width, again);
}

int main(void)
{
    static double pairs[INPUTS * COUNT];
    if (fread(pairs, sizeof pairs, 1, stdin) != 1)
        return 1;
    run(1, elementary_1, pairs, COUNT);
    run(2, elementary_2, pairs, COUNT);
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        run(4, elementary_4, pairs, COUNT);
    if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        run(8, elementary_8, pairs, COUNT);
#endif
    return 0;
}
