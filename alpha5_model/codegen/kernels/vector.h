/* Arithmetic of WIDTH states at once, and the bodies that are written in it. Included once for each
   width and processor, which LABEL tells apart; BODIES names the file of the bodies.

   A vector is a compiler's vector extension, at width 1 a plain double. All widths run the same
   operations in the same order, without contraction, so that they give the same bits. Sine, cosine
   and the angle of a vector hold for ordinary arguments only. For others (large, not finite, 0 / 0)
   they set the sign of `rare`, and the state is computed again at "width 0": one state at a time, by libm where
   it must be. */

#ifndef LABEL
#define LABEL WIDTH
#endif
#if WIDTH <= 1
typedef double SIZED(vector);
typedef int SIZED(mask);
#else
typedef double SIZED(vector) __attribute__((vector_size(8 * WIDTH), may_alias));
typedef int64_t SIZED(mask) __attribute__((vector_size(8 * WIDTH), may_alias));
typedef double SIZED(anywhere) __attribute__((vector_size(8 * WIDTH), may_alias, aligned(8)));
#endif
#define V SIZED(vector)
#define M SIZED(mask)

#if WIDTH <= 1
#if WIDTH == 0
typedef union { double real; int64_t bits; } reinterpreted;
static inline int64_t bits_of(double x) { return (reinterpreted){.real = x}.bits; }
static inline double real_of(int64_t b) { return (reinterpreted){.bits = b}.real; }
#endif
#define INTEGER int64_t
#define BITS(x) bits_of(x)
#define REAL(b) real_of(b)
#define SPLAT(x) ((double)(x))
#define ODD(b) ((int)((b) & 1))
#define SECOND_BIT(b) ((int64_t)((uint64_t)(b) << 62)) /* as the sign */
#define SELECT(m, a, b) ((m) ? (a) : (b))
#define LESS(a, b) ((a) < (b))
#define ORDINARY(rare) ((rare) >= 0)
#else
#define INTEGER M
#define BITS(x) ((M)(x))
#define REAL(b) ((V)(b))
#define SPLAT(x) ((x) - (V){0}) /* of -0.0, too */
#define ODD(b) (-((b) & 1))
#define SECOND_BIT(b) ((b) << 62)
#define SELECT(m, a, b) REAL((BITS(a) & (m)) | (BITS(b) & ~(m)))
#if WIDTH == 2 && defined(__SSE2__)
#define LESS(a, b) ((M)_mm_cmplt_pd(a, b)) /* of which gcc else makes two */
#else
#define LESS(a, b) ((a) < (b))
#endif
static inline int SIZED(ordinary)(M rare)
{
    int64_t any = rare[0];
    for (int lane = 1; lane < WIDTH; lane++)
        any |= rare[lane];
    return any >= 0;
}
#define ORDINARY(rare) SIZED(ordinary)(rare)
#endif
/* Negative where a number that is not negative is above a limit, infinite or NaN: as integers, the
   bits of numbers have the order of the numbers. */
#define ABOVE(size, limit) (BITS(SPLAT(limit)) - BITS(size))
#define SIGN INT64_MIN
#define ABS(x) REAL(BITS(x) & INT64_MAX)
#define COPYSIGN(x, y) REAL((BITS(x) & INT64_MAX) | (BITS(y) & SIGN))

static inline V SIZED(sqrt)(V x)
{
#if WIDTH <= 1
    return sqrt(x);
#else
    V root;
    for (int lane = 0; lane < WIDTH; lane++)
        root[lane] = sqrt(x[lane]);
    return root;
#endif
}

static inline V SIZED(fmin)(V a, V b) { return SELECT(LESS(a, b), a, b); }
static inline V SIZED(fmax)(V a, V b) { return SELECT(LESS(a, b), b, a); }

static inline V SIZED(floor)(V x)
{
    const V whole = COPYSIGN(SPLAT(0x1p52), x);
    const V nearest = (x + whole) - whole;
    const V below = nearest - SELECT(LESS(x, nearest), SPLAT(1.0), SPLAT(0.0));
    return SELECT(LESS(ABS(x), SPLAT(0x1p52)), COPYSIGN(below, x), x);
}

/* Sine and cosine up to 1e5 rad: pi/2 in two parts, of which the first times a whole number of
   quarter turns below 2^17 is exact; minimax polynomials on [-pi/4, pi/4] (errors below 2e-17). */
INLINE void SIZED(sincos)(V x, V *sine, V *cosine, INTEGER *rare)
{
    const V size = ABS(x);
    *rare |= ABOVE(size, 1e5);
    const V shifted = size * 0.6366197723675814 + 0x1.8p52; /* its last bits: the nearest quarter */
    const INTEGER quarter = BITS(shifted);
    const V turns = shifted - 0x1.8p52;
    const V r = (size - turns * 0x1.921fb5444p0) - turns * 2.563344151594519e-12;
    const V z = r * r;
    const V s = r + r * z * (-0.16666666666666666 + z * (0.008333333333330948
        + z * (-0.00019841269836757408 + z * (2.7557316101788864e-06
        + z * (-2.505113166031186e-08 + z * 1.5918114512975356e-10)))));
    const V half = 0.5 * z, near = 1.0 - half;
    const V c = near + (((1.0 - near) - half) + z * z * (0.041666666666666664
        + z * (-0.0013888888888887398 + z * (2.4801587298764788e-05
        + z * (-2.755731727117512e-07 + z * (2.0876146138597195e-09
        - z * 1.1382622253261863e-11))))));
    const M swap = ODD(quarter);
    *sine = REAL(BITS(SELECT(swap, c, s)) ^ ((SECOND_BIT(quarter) ^ BITS(x)) & SIGN));
    *cosine = REAL(BITS(SELECT(swap, s, c)) ^ (SECOND_BIT(quarter + 1) & SIGN));
}

/* Angle of (x, y): the quotient is brought to at most tan(pi/8), where a minimax polynomial has an
   error below 6e-18; its terms in pairs, which do not wait for one another. */
static inline V SIZED(atan2)(V y, V x, INTEGER *rare)
{
    const V across = ABS(x), up = ABS(y);
    const M swap = LESS(across, up);
    const V big = SELECT(swap, up, across), small = SELECT(swap, across, up);
    *rare |= ABOVE(big, 1e300) | (BITS(big) - 1); /* or 0 */
    const M steep = LESS(0.41421356237309503 * big, small);
    const V t = SELECT(steep, small - big, small) / SELECT(steep, small + big, big);
    const V u = t * t;
    const V u_2 = u * u, u_4 = u_2 * u_2;
    const V turned = t + t * u * (((-0.3333333333333333 + u * 0.19999999999995777)
        + u_2 * (-0.14285714284715587 + u * 0.11111111018902899))
        + u_4 * (((-0.09090904715890517 + u * 0.07692186181608834)
        + u_2 * (-0.06664550985803099 + u * 0.05858472494123003))
        + u_4 * ((-0.050870503367025685 + u * 0.039275498366150095) - u_2 * 0.019227926341944368)));
    V angle = SELECT(steep, 0.7853981633974483 + (turned + 3.061616997868383e-17), turned);
    angle = SELECT(swap, 1.5707963267948966 - (angle - 6.123233995736766e-17), angle);
    angle = SELECT(LESS(x, SPLAT(0.0)), 3.141592653589793 - (angle - 1.2246467991473532e-16), angle);
    return COPYSIGN(angle, y);
}

INLINE V SIZED(sin)(V x, INTEGER *rare)
{
    V sine, cosine;
    SIZED(sincos)(x, &sine, &cosine, rare);
    return sine;
}

INLINE V SIZED(cos)(V x, INTEGER *rare)
{
    V sine, cosine;
    SIZED(sincos)(x, &sine, &cosine, rare);
    return cosine;
}

/* ---- the bodies at this width ---- */

#if WIDTH == 0
static double sin_or_libm(double x)
{
    int64_t rare = 0;
    const double own = sin_0(x, &rare);
    return ORDINARY(rare) ? own : sin(x);
}
static double cos_or_libm(double x)
{
    int64_t rare = 0;
    const double own = cos_0(x, &rare);
    return ORDINARY(rare) ? own : cos(x);
}
static double atan2_or_libm(double y, double x)
{
    int64_t rare = 0;
    const double own = atan2_0(y, x, &rare);
    return ORDINARY(rare) ? own : atan2(y, x);
}
#define SIN(x) sin_or_libm(x)
#define COS(x) cos_or_libm(x)
#define ATAN2(y, x) atan2_or_libm(y, x)
#else
#define SIN(x) SIZED(sin)(SPLAT(x), &rare)
#define COS(x) SIZED(cos)(SPLAT(x), &rare)
#define ATAN2(y, x) SIZED(atan2)(SPLAT(y), SPLAT(x), &rare)
#endif
#define ATAN(x) ATAN2(x, 1.0)
#define SQRT(x) SIZED(sqrt)(SPLAT(x))
#define FABS(x) ABS(SPLAT(x))
#define FLOOR(x) SIZED(floor)(SPLAT(x))
#define FMIN(x, y) SIZED(fmin)(SPLAT(x), SPLAT(y))
#define FMAX(x, y) SIZED(fmax)(SPLAT(x), SPLAT(y))
#define IF(m, x) SELECT(m, SPLAT(x), SPLAT(0.0))
#define NOT(m) ((m) == 0)
#if WIDTH <= 1
#define LOAD(i) in[i]
#define STORE(i, x) out[i] = (x);
#else
#define LOAD(i) (*(const V *)(in + (i) * PANEL))
#define STORE(i, x) *(V *)(out + (i) * PANEL) = SPLAT(x);
#endif
#include BODIES

/* ---- rows to columns and back, in square blocks of 2 or 4 ---- */

#if WIDTH == 2
#define TRANSPOSE(x) { const V a = x[0], b = x[1]; x[0] = SHUFFLE(a, b, 0, 2); x[1] = SHUFFLE(a, b, 1, 3); }
#elif WIDTH == 4
#define TRANSPOSE(x) { \
    const V a = SHUFFLE(x[0], x[1], 0, 4, 2, 6), b = SHUFFLE(x[0], x[1], 1, 5, 3, 7); \
    const V c = SHUFFLE(x[2], x[3], 0, 4, 2, 6), d = SHUFFLE(x[2], x[3], 1, 5, 3, 7); \
    x[0] = SHUFFLE(a, c, 0, 1, 4, 5), x[1] = SHUFFLE(b, d, 0, 1, 4, 5); \
    x[2] = SHUFFLE(a, c, 2, 3, 6, 7), x[3] = SHUFFLE(b, d, 2, 3, 6, 7); }
#endif
#ifdef TRANSPOSE
/* PANEL rows of `size` numbers to `size` columns; whether all can be computed with. */
static int SIZED(to_columns)(const double *rows, int size, double *columns)
{
    INTEGER rare = BITS(SPLAT(0.0));
    for (int row = 0; row < PANEL; row += WIDTH, rows += WIDTH * size) {
        int i = 0;
        for (; i + WIDTH <= size; i += WIDTH) {
            V x[WIDTH];
            for (int j = 0; j < WIDTH; j++) {
                x[j] = *(const SIZED(anywhere) *)(rows + j * size + i);
                rare |= ABOVE(ABS(x[j]), LARGEST);
            }
            TRANSPOSE(x)
            for (int j = 0; j < WIDTH; j++)
                *(V *)(columns + (i + j) * PANEL + row) = x[j];
        }
        for (; i < size; i++) {
            V x = SPLAT(0.0);
            for (int j = 0; j < WIDTH; j++)
                x[j] = rows[j * size + i];
            rare |= ABOVE(ABS(x), LARGEST);
            *(V *)(columns + i * PANEL + row) = x;
        }
    }
    return ORDINARY(rare);
}

static void SIZED(to_rows)(const double *columns, int size, double *rows)
{
    for (int row = 0; row < PANEL; row += WIDTH, rows += WIDTH * size) {
        int i = 0;
        for (; i + WIDTH <= size; i += WIDTH) {
            V x[WIDTH];
            for (int j = 0; j < WIDTH; j++)
                x[j] = *(const V *)(columns + (i + j) * PANEL + row);
            TRANSPOSE(x)
            for (int j = 0; j < WIDTH; j++)
                *(SIZED(anywhere) *)(rows + j * size + i) = x[j];
        }
        for (; i < size; i++)
            for (int j = 0; j < WIDTH; j++)
                rows[j * size + i] = columns[i * PANEL + row + j];
    }
}
#undef TRANSPOSE
#endif
#undef WIDTH
#undef LABEL
#undef V
#undef M
#undef INTEGER
#undef BITS
#undef REAL
#undef SPLAT
#undef ODD
#undef SECOND_BIT
#undef SELECT
#undef LESS
#undef ORDINARY
#undef ABOVE
#undef SIGN
#undef ABS
#undef COPYSIGN
#undef SIN
#undef COS
#undef ATAN2
#undef LOAD
#undef STORE
