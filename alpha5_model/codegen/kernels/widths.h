/* BODIES at every width up to WIDEST: see vector.h. On x86-64 the wider ones are compiled for
   processors that have them, whatever the compiler's flags, and so is the one of single states, which
   their further registers make up to half faster; which one runs is chosen at load. */

#include <math.h>
#include <stdint.h>
#if defined(__SSE2__) || defined(_M_X64)
#include <immintrin.h>
#endif

#if defined(__GNUC__) && !defined(__clang__)
/* Most bodies gain a fifth where they are ordered before registers are handed out. Not by push_options
   for some: gcc then leaves their upper registers dirty and slows all code that follows. */
#pragma GCC optimize("schedule-insns", "sched-pressure")
#endif
#ifdef __GNUC__
#define INLINE static inline __attribute__((always_inline)) /* where a body has many, too */
#else
#define INLINE static inline
#endif
#ifndef WIDEST /* that this compiler can make */
#if defined(__GNUC__) && defined(__x86_64__)
#define WIDEST 8
#elif defined(__GNUC__)
#define WIDEST 2
#else
#define WIDEST 1
#endif
#endif
#define PANEL 32 /* rows of a batch that are turned to columns at once; they fit the first cache */
#define PASTE(name, width) name##_##width
#define EXPANDED(name, width) PASTE(name, width)
#define SIZED(name) EXPANDED(name, LABEL)
/* What goes out lies nowhere in what comes in: values may be stored as soon as they are known, and read late. */
#define KERNEL(name) \
    static int SIZED(name)(const double *restrict k, const double *restrict in, double *restrict out)
#if defined(__clang__) || __GNUC__ >= 12
#define SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define SHUFFLE(a, b, ...) __builtin_shuffle(a, b, (M){__VA_ARGS__})
#endif
#ifdef __clang__
#define BEGIN(set) DO(clang attribute push(__attribute__((target(set))), apply_to = function))
#define END DO(clang attribute pop)
#else
#define BEGIN(set) DO(GCC push_options) DO(GCC target(set))
#define END DO(GCC pop_options)
#endif
#define DO(x) _Pragma(#x)

#define WIDTH 0
#include "vector.h"
#define WIDTH 1
#include "vector.h"
#if WIDEST >= 2
#define WIDTH 2
#include "vector.h"
#endif
#if WIDEST == 8
BEGIN("avx2")
#define WIDTH 1
#define LABEL 1_4
#include "vector.h"
#define WIDTH 4
#include "vector.h"
END
BEGIN("avx512f,avx512dq,avx512vl")
#define WIDTH 1
#define LABEL 1_8
#include "vector.h"
#define WIDTH 8
#include "vector.h"
END
#endif
