/* How a kernel runs on rows of states. Knows nothing of Python. */

#include <fenv.h>
#include <stddef.h>
#include <string.h>

#include "vector.h"

/* An input or output of each state: how many numbers, and in which shape. */
typedef struct {
    int size, axes;
    ptrdiff_t shape[2];
} Slot;

typedef struct {
    const char *name;
    void (*compute)(const double *restrict, const V *restrict, V *restrict, long);
    int parameters, inputs, outputs;
    Slot slots[8]; /* inputs before outputs */
} Kernel;

#include "generated/formulas.h"

/* Vectors that a kernel computes at a time: they fit the first cache. */
enum { VECTORS = 8, PANEL = VECTORS * LANES };

/* Whether no number is larger than that; NaN is. */
static int within(double most, const double *x, ptrdiff_t size)
{
    int good = 1;
    for (ptrdiff_t i = 0; i < size; i++)
        good &= fabs(x[i]) <= most;
    return good;
}

/* Whether all numbers can be computed with; NaN cannot. */
static int clean(const double *x, ptrdiff_t size)
{
    return within(LARGEST, x, size);
}

/* Numbers of up to PANEL rows to lanes, `stride` vectors apart; further lanes repeat the last row.
   Vectors that are read right after their lanes were written would stall the processor: `clean` reads the rows. */
static int to_lanes(const double *rows, ptrdiff_t step, int size, int n, V *x, int stride)
{
    for (int first = 0; first < n; first += LANES, x += stride)
        for (int lane = 0; lane < LANES; lane++) {
            const double *row = rows + (first + lane < n ? first + lane : n - 1) * step;
            for (int i = 0; i < size; i++)
                x[i][lane] = row[i];
        }
    return clean(rows, step == 0 ? size : (ptrdiff_t)n * size);
}

static void to_rows(const V *y, int stride, int size, int n, double *rows)
{
    for (int row = 0; row < n; row++)
        for (int i = 0; i < size; i++)
            *rows++ = y[row / LANES * stride + i][row % LANES];
}

static int total(const Slot *slots, int n)
{
    int size = 0;
    for (int i = 0; i < n; i++)
        size += slots[i].size;
    return size;
}

/* n rows of each input, which steps by its size, or by 0 if all states share it; whether all can be computed with. */
static int compute_rows(const Kernel *kernel, const double *parameters, const double **in, const ptrdiff_t *step,
                        double **out, ptrdiff_t n)
{
    V x[VECTORS * MOST_INPUTS], y[VECTORS * MOST_OUTPUTS];
    const Slot *results = kernel->slots + kernel->inputs;
    const int inputs = total(kernel->slots, kernel->inputs), outputs = total(results, kernel->outputs);
    const int rounding = fegetround(); /* another library may have left this thread with one that the sines do not hold for */
    int good = 1;
    if (rounding != FE_TONEAREST)
        fesetround(FE_TONEAREST);
    for (ptrdiff_t first = 0; good && first < n; first += PANEL) {
        const int count = n - first < PANEL ? (int)(n - first) : PANEL;
        for (int i = 0, at = 0; i < kernel->inputs; at += kernel->slots[i++].size)
            good &= to_lanes(in[i] + first * step[i], step[i], kernel->slots[i].size, count, x + at, inputs);
        if (!good)
            break;
        kernel->compute(parameters, x, y, (count + LANES - 1) / LANES);
        for (int i = 0, at = 0; i < kernel->outputs; at += results[i++].size)
            to_rows(y + at, outputs, results[i].size, count, out[i] + first * results[i].size);
    }
    if (rounding != FE_TONEAREST)
        fesetround(rounding);
    return good;
}
