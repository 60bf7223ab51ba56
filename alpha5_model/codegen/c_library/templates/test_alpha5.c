/* Checks alpha5.c on this machine against numbers that Pinocchio computed. Exit status 1 if one is off. */
#include "alpha5.h"

#include <math.h>
#include <stdio.h>

static int checks = 0, failures = 0;

static void check(int good, const char *name, int row)
{
    ++checks;
    if (!good) {
        ++failures;
        printf("%s, row %d: off\n", name, row);
    }
}

/* Differences as a share of the largest expected number, or of 1. */
static void compare(const char *name, int row, const alpha5_real *found, const alpha5_real *expected, int count, double bound)
{
    double scale = 1.0, largest = 0.0;
    int i;
    for (i = 0; i < count; ++i) {
        scale = fmax(scale, fabs((double)expected[i]));
    }
    for (i = 0; i < count; ++i) {
        const double off = fabs((double)found[i] - (double)expected[i]);
        largest = off <= largest ? largest : off; /* NaN stays */
    }
    check(largest <= bound * scale, name, row);
}

static const alpha5_real q[$count][4] = $q;
static const alpha5_real v[$count][4] = $v;
static const alpha5_real a[$count][4] = $a;
static const alpha5_real tau[$count][4] = $tau;
$tests
/* Position and wrist; the flags; the joint position that the target was made of, if any. */
static const struct {
    alpha5_real position[3], wrist;
    int exists[4], within_limits[4], singular, known;
    alpha5_real q[4];
} targets[] = $targets;

static void test_inverse_kinematics(void)
{
    const int count = (int)(sizeof targets / sizeof targets[0]);
    int row, i, j;
    for (row = 0; row < count; ++row) {
        alpha5_real found[4][4], pose[4][4];
        int exists[4], within_limits[4], singular, again = 0;
        alpha5_inverse_kinematics(targets[row].position, targets[row].wrist, found, exists, within_limits, &singular);
        check(singular == targets[row].singular, "singular", row);
        for (i = 0; i < 4; ++i) {
            check(exists[i] == targets[row].exists[i], "exists", row);
            check(within_limits[i] == targets[row].within_limits[i], "within_limits", row);
            if (exists[i]) {
                double off = 0.0, turn = 0.0;
                alpha5_forward_kinematics(found[i], pose);
                for (j = 0; j < 3; ++j) {
                    off = fmax(off, fabs((double)pose[j][3] - (double)targets[row].position[j]));
                }
                check(off <= (singular ? $edge : $miss), "position", row);
                for (j = 0; j < 4; ++j) {
                    turn = fmax(turn, fabs((double)found[i][j] - (double)targets[row].q[j]));
                }
                again = again || (within_limits[i] && turn <= $turn);
            } else {
                check(isnan(found[i][0]) && isnan(found[i][3]), "not a number", row);
            }
        }
        check(again || !targets[row].known, "joint position", row);
    }
}

int main(void)
{
$calls
    test_inverse_kinematics();
    printf("%d of %d checks passed\n", checks - failures, checks);
    return failures != 0;
}
