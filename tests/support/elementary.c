/* Reads pairs x, y of doubles from standard input; writes sin x, cos x, atan2(y, x), floor x, min, max and
   sqrt |x| of every pair as the kernels' `vector.h` computes them. */

#include <stdio.h>

#include "vector.h"

enum { OUTPUTS = 7 };

int main(void)
{
    double pairs[LANES][2], results[LANES][OUTPUTS];
    while (fread(pairs, sizeof pairs, 1, stdin) == 1) {
        V x, y, out[OUTPUTS];
        for (int lane = 0; lane < LANES; lane++) {
            x[lane] = pairs[lane][0];
            y[lane] = pairs[lane][1];
        }
        out[0] = vector_sin(x);
        out[1] = vector_cos(x);
        out[2] = vector_atan2(y, x);
        out[3] = vector_floor(x);
        out[4] = vector_min(x, y);
        out[5] = vector_max(x, y);
        out[6] = vector_sqrt(ABS(x));
        for (int lane = 0; lane < LANES; lane++)
            for (int i = 0; i < OUTPUTS; i++)
                results[lane][i] = out[i][lane];
        fwrite(results, sizeof results, 1, stdout);
    }
    return 0;
}
