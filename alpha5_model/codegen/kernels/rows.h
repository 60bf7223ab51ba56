/* The table of kernels, and how one runs on a state or on rows of states. Knows nothing of Python. */

#include <fenv.h>
#include <float.h>
#include <stddef.h>
#include <string.h>

#if FLT_EVAL_METHOD != 0
#error "this processor keeps doubles in longer registers and would round twice"
#endif

#include "generated/table.h" /* how long the arrays below get */
#define BODIES "generated/bodies.h"
#include "widths.h"

typedef int (*Function)(const double *k, const double *in, double *out);
typedef struct {
    int size, axes;
    ptrdiff_t shape[2];
} Slot;
typedef struct {
    const char *name;
    void (*prepare)(const double *parameters, double *k);
    Function rare, one[4], at[4]; /* index: that of the level */
    int upright; /* place of the one that computes it where gravity has no x and y; 0: none */
    int parameters, inputs, outputs;
    Slot slots[MOST_SLOTS]; /* inputs before outputs */
} Kernel;
typedef struct {
    int width;
    const char *name;
    int (*to_columns)(const double *rows, int size, double *columns);
    void (*to_rows)(const double *columns, int size, double *rows);
} Level;

#if WIDEST == 1
#define WIDTHS(name) name##_0, {name##_1}, {NULL}
#elif WIDEST == 2
#define WIDTHS(name) name##_0, {name##_1, name##_1}, {NULL, name##_2}
#else
#define WIDTHS(name) \
    name##_0, {name##_1, name##_1, name##_1_4, name##_1_8}, {NULL, name##_2, name##_4, name##_8}
#endif
#if defined(__x86_64__)
#define PAIRS "sse2"
#elif defined(__aarch64__)
#define PAIRS "neon"
#else
#define PAIRS "pairs"
#endif
static const Level levels[] = {
    {1, "scalar", NULL, NULL},
#if WIDEST >= 2
    {2, PAIRS, to_columns_2, to_rows_2},
#endif
#if WIDEST == 8
    {4, "avx2", to_columns_4, to_rows_4},
    {8, "avx512", to_columns_4, to_rows_4},
#endif
};
#define PREPARE(name) static void name##_k(const double *p, double *k)
#define ENTRY(name, upright, parameters, inputs, outputs, ...) \
    {#name, name##_k, WIDTHS(name), upright, parameters, inputs, outputs, {__VA_ARGS__}}
#include "generated/table.h"

static int level;

/* The widest level that this processor has and that is at most so wide. */
static void choose(long width)
{
    int best = 0;
    for (int i = 1; i < (int)(sizeof levels / sizeof *levels) && levels[i].width <= width; i++) {
#if WIDEST == 8
        if (levels[i].width == 4 && !__builtin_cpu_supports("avx2"))
            break;
        if (levels[i].width == 8 && !(__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")))
            break;
#endif
        best = i;
    }
    level = best;
}

/* ---- rounding: another library may have left this thread with one that the sines do not hold for ---- */

#if defined(__SSE2__) || defined(_M_X64)
/* Round to nearest; returns what was before. */
static unsigned to_nearest(void)
{
    const unsigned before = _mm_getcsr() & _MM_ROUND_MASK;
    if (before != _MM_ROUND_NEAREST)
        _mm_setcsr(_mm_getcsr() & ~_MM_ROUND_MASK);
    return before;
}

static void round_as(unsigned before)
{
    if (before != _MM_ROUND_NEAREST)
        _mm_setcsr(_mm_getcsr() | before);
}
#else
static unsigned to_nearest(void)
{
    const unsigned before = (unsigned)fegetround();
    if (before != FE_TONEAREST)
        fesetround(FE_TONEAREST);
    return before;
}

static void round_as(unsigned before)
{
    if (before != FE_TONEAREST)
        fesetround((int)before);
}
#endif

/* What computes a kernel of these parameters, and the constants that they make, in k. */
static const Kernel *prepared(const Kernel *kernel, const double *parameters, double *k)
{
    const unsigned before = to_nearest();
    if (kernel->upright && parameters[GRAVITY] == 0.0 && parameters[GRAVITY + 1] == 0.0)
        kernel = &kernels[kernel->upright];
    kernel->prepare(parameters, k);
    round_as(before);
    return kernel;
}

/* ---- one state, and rows of states ---- */

/* Whether all numbers can be computed with; NaN cannot. */
static int clean(const double *x, ptrdiff_t size)
{
    int good = 1;
    for (ptrdiff_t i = 0; i < size; i++)
        good &= fabs(x[i]) <= LARGEST;
    return good;
}

/* One state, of which each input lies elsewhere; whether it can be computed. Rounding is to nearest. */
static int nearest_row(const Kernel *kernel, const double *k, const double *const *in, double *out)
{
    double x[MOST_INPUTS];
    int good = 1, end = 0;
    for (int i = 0; i < kernel->inputs; i++)
        for (int j = 0; j < kernel->slots[i].size; j++, end++)
            good &= fabs(x[end] = in[i][j]) <= LARGEST; /* not NaN */
    if (good && !kernel->one[level](k, x, out))
        kernel->rare(k, x, out);
    return good;
}

static int row(const Kernel *kernel, const double *k, const double *const *in, double *out)
{
    const unsigned before = to_nearest();
    const int good = nearest_row(kernel, k, in, out);
    round_as(before);
    return good;
}

#if WIDEST >= 2
typedef double Columns[PANEL] __attribute__((aligned(64)));

/* PANEL rows by a level; an input that steps by 0 is one row for all. */
static int panel(const Kernel *kernel, int at, const double *k, const double *const *in, const ptrdiff_t *step,
                 double *const *out)
{
    Columns x[MOST_INPUTS], y[MOST_OUTPUTS];
    const Level *by = &levels[at];
    const Slot *slot = kernel->slots;
    int good = 1, inputs = 0, outputs = 0;
    for (int i = 0; i < kernel->inputs; inputs += slot++->size, i++) {
        if (step[i] > 0) {
            good &= by->to_columns(in[i], slot->size, x[inputs]);
            continue;
        }
        good &= clean(in[i], slot->size);
        for (int j = 0; j < slot->size * PANEL; j++)
            x[inputs + j / PANEL][j % PANEL] = in[i][j / PANEL];
    }
    if (!good)
        return 0;
    for (int i = 0; i < kernel->outputs; i++)
        outputs += slot[i].size;
    for (int first = 0; first < PANEL; first += by->width) {
        if (kernel->at[at](k, &x[0][first], &y[0][first]))
            continue;
        for (int lane = first; lane < first + by->width; lane++) {
            double one[MOST_INPUTS], result[MOST_OUTPUTS];
            for (int i = 0; i < inputs; i++)
                one[i] = x[i][lane];
            kernel->rare(k, one, result);
            for (int i = 0; i < outputs; i++)
                y[i][lane] = result[i];
        }
    }
    outputs = 0;
    for (int i = 0; i < kernel->outputs; outputs += slot++->size)
        by->to_rows(y[outputs], slot->size, out[i++]);
    return 1;
}
#endif

/* n rows of each input, which steps by its size or by 0, and output; moves in and out past them. Rounding as above. */
static int nearest_rows(const Kernel *kernel, const double *k, const double **in, const ptrdiff_t *step, double **out,
                ptrdiff_t n)
{
    const Slot *results = kernel->slots + kernel->inputs;
    while (n > 0) {
        ptrdiff_t done = 1;
#if WIDEST >= 2
        if (level > 0 && n >= PANEL) {
            if (!panel(kernel, level, k, in, step, out))
                return 0;
            done = PANEL;
        } else
#endif
        {
            double y[MOST_OUTPUTS], *end = y;
            if (!nearest_row(kernel, k, in, y))
                return 0;
            for (int i = 0; i < kernel->outputs; end += results[i++].size)
                memcpy(out[i], end, results[i].size * sizeof(double));
        }
        for (int i = 0; i < kernel->inputs; i++)
            in[i] += done * step[i];
        for (int i = 0; i < kernel->outputs; i++)
            out[i] += done * results[i].size;
        n -= done;
    }
    return 1;
}

static int rows(const Kernel *kernel, const double *k, const double **in, const ptrdiff_t *step, double **out,
                ptrdiff_t n)
{
    const unsigned before = to_nearest();
    const int good = nearest_rows(kernel, k, in, step, out, n);
    round_as(before);
    return good;
}
