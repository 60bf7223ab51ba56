/* Reach Alpha 5: kinematics, dynamics under water and inverse kinematics in C99.
 *
 * Generated from: $document.
 * By: $package. Corrections: $corrections.
 * Fluid: $fluid_density kg/m^3. Gravity in base_link: $gravity m/s^2.
 *
 * SI units and radians. Joint vectors run from base to tip (axis_e, axis_d, axis_c, axis_b); matrices lie row by row;
 * poses are homogeneous matrices that map coordinates to base_link. Derivatives have a row for each
 * element that is differentiated. Nothing is allocated and nothing is kept: any number of threads may call.
 * An output may be the same array as an input. What is NaN or infinite is not refused: it comes back as NaN, within no limits.
 */
#ifndef ALPHA5_H
#define ALPHA5_H

#ifdef __cplusplus
extern "C" {
#endif

typedef $real alpha5_real;

/* Joint limits [rad]. */
extern const alpha5_real alpha5_lower[4];
extern const alpha5_real alpha5_upper[4];

/* Rows of the solutions of inverse kinematics: the plane of the arm faces the target or faces away, either elbow. */
enum {
$branches
};
$parameters
$functions
#ifdef __cplusplus
}
#endif

#endif
