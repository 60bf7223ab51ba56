/* Arithmetic of four states at once, and how a kernel is compiled.

   A vector has one state in each lane. The same operations run in the same order in every lane and on every
   processor, without contraction, so that all processors give the same bits. */

#include <math.h>
#include <stdint.h>

#if defined(__GNUC__) && !defined(__clang__)
/* Kernels gain a fifth if their operations are ordered before registers are handed out. */
#pragma GCC optimize("schedule-insns", "sched-pressure")
#endif

enum { LANES = 4 };
typedef double V __attribute__((vector_size(8 * LANES)));
typedef int64_t M __attribute__((vector_size(8 * LANES))); /* -1 where something is true, else 0 */

#define INLINE static inline __attribute__((always_inline))
/* Compiled for each of these processors; which one runs is chosen when the module is loaded. */
#if defined(__x86_64__) && defined(__linux__) && !defined(ONE_PROCESSOR)
#define CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define CLONES
#endif
/* Parameters p, then n vectors of states: each x has all inputs and each y all outputs, one after the other. */
#define KERNEL(name) CLONES static void name(const double *restrict p, const V *restrict x, V *restrict y, long n)

#define SPLAT(x) ((x) - (V){0}) /* a number in all lanes, of -0.0, too; of a vector itself */
#define BITS(x) ((M)(x))
#define REAL(bits) ((V)(bits))
#define SELECT(mask, a, b) REAL((BITS(a) & (mask)) | (BITS(b) & ~(mask)))
#define IF(mask, x) REAL(BITS(SPLAT(x)) & (mask))
#define NOT(mask) ((mask) == 0)
#define ABS(x) REAL(BITS(x) & INT64_MAX)
#define COPYSIGN(x, y) REAL((BITS(x) & INT64_MAX) | (BITS(y) & INT64_MIN))

INLINE int any(M mask)
{
    int64_t found = 0;
    for (int lane = 0; lane < LANES; lane++)
        found |= mask[lane];
    return found != 0;
}

INLINE V vector_sqrt(V x)
{
    for (int lane = 0; lane < LANES; lane++)
        x[lane] = sqrt(x[lane]);
    return x;
}

INLINE V vector_min(V a, V b) { return SELECT(a < b, a, b); }
INLINE V vector_max(V a, V b) { return SELECT(b < a, a, b); }

INLINE V vector_floor(V x)
{
    const V whole = COPYSIGN(SPLAT(0x1p52), x);
    const V nearest = (x + whole) - whole;
    const V below = nearest - IF(x < nearest, 1.0);
    return SELECT(ABS(x) < 0x1p52, COPYSIGN(below, x), x);
}

/* Up to 1e5 rad: pi/2 in two parts, of which the first times a whole number of quarter turns below 2^17 is exact;
   minimax polynomials on [-pi/4, pi/4] (errors below 2e-17). Beyond, and of NaN, by libm. */
INLINE void vector_sincos(V x, V *sine, V *cosine)
{
    const V size = ABS(x);
    const V shifted = size * 0.6366197723675814 + 0x1.8p52; /* its last bits: the nearest quarter turn */
    const M quarter = BITS(shifted);
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
    const M swap = -(quarter & 1);
    *sine = REAL(BITS(SELECT(swap, c, s)) ^ (((quarter << 62) ^ BITS(x)) & INT64_MIN));
    *cosine = REAL(BITS(SELECT(swap, s, c)) ^ (((quarter + 1) << 62) & INT64_MIN));

    const M rare = NOT(size <= 1e5);
    for (int lane = 0; any(rare) && lane < LANES; lane++) {
        if (rare[lane]) {
            (*sine)[lane] = sin(x[lane]);
            (*cosine)[lane] = cos(x[lane]);
        }
    }
}

INLINE V vector_sin(V x)
{
    V sine, cosine;
    vector_sincos(x, &sine, &cosine);
    return sine;
}

INLINE V vector_cos(V x)
{
    V sine, cosine;
    vector_sincos(x, &sine, &cosine);
    return cosine;
}

/* The quotient is brought to at most tan(pi/8), where a minimax polynomial has an error below 6e-18; its terms in
   pairs, which do not wait for one another. Of 0 and 0, of huge numbers and of NaN, by libm. */
INLINE V vector_atan2(V y, V x)
{
    const V across = ABS(x), up = ABS(y);
    const M swap = across < up;
    const V big = SELECT(swap, up, across), small = SELECT(swap, across, up);
    const M steep = 0.41421356237309503 * big < small;
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
    angle = SELECT(x < 0.0, 3.141592653589793 - (angle - 1.2246467991473532e-16), angle);
    angle = COPYSIGN(angle, y);

    const M rare = NOT((0.0 < big) & (big <= 1e300));
    for (int lane = 0; any(rare) && lane < LANES; lane++)
        if (rare[lane])
            angle[lane] = atan2(y[lane], x[lane]);
    return angle;
}
