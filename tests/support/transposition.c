/* Turns rows of 1 to 9 numbers to columns and back, at each width, in memory of exactly that size.
   The first mistake ends the program with status 1 and a line on standard error. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST 1e300
#define BODIES "nothing.h"
#include "widths.h"

typedef int (*ToColumns)(const double *rows, int size, double *columns);
typedef void (*ToRows)(const double *columns, int size, double *rows);

static void fail(const char *what, int width, int size)
{
    fprintf(stderr, "width %d, rows of %d: %s\n", width, size, what);
    exit(1);
}

static void check(int width, ToColumns to_columns, ToRows to_rows, int size)
{
    const size_t bytes = sizeof(double) * PANEL * (size_t)size;
    double *rows = malloc(bytes);
    double *columns = aligned_alloc(64, bytes);
    double *back = malloc(bytes);
    for (int i = 0; i < PANEL * size; i++)
        rows[i] = i + 0.5;

    if (!to_columns(rows, size, columns))
        fail("ordinary numbers are refused", width, size);
    for (int row = 0; row < PANEL; row++)
        for (int i = 0; i < size; i++)
            if (columns[i * PANEL + row] != rows[row * size + i])
                fail("wrong columns", width, size);
    to_rows(columns, size, back);
    if (memcmp(rows, back, bytes))
        fail("wrong rows", width, size);

    for (int i = 0; i < PANEL * size; i++) {
        const double kept = rows[i];
        rows[i] = i % 2 ? -1e301 : 1e301;
        if (to_columns(rows, size, columns))
            fail("a number beyond the largest is taken", width, size);
        rows[i] = kept;
    }
    free(rows);
    free(columns);
    free(back);
}

int main(void)
{
    for (int size = 1; size < 10; size++) {
        check(2, to_columns_2, to_rows_2, size);
#ifdef __x86_64__
        if (__builtin_cpu_supports("avx2"))
            check(4, to_columns_4, to_rows_4, size);
#endif
    }
    return 0;
}
