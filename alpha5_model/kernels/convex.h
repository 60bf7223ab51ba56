/* Distances between boxes and cylinders: separating axes for boxes, GJK for all.

   Gilbert, Johnson, Keerthi: A fast procedure for computing the distance between complex objects in
   three-dimensional space, IEEE Journal of Robotics and Automation, 1988. Van den Bergen: Collision
   detection in interactive 3D environments, 2004. Gottschalk, Lin, Manocha: OBBTree, SIGGRAPH 1996.

   What is returned is a proved lower bound of the distance, never an estimate from above. */

#include <float.h>
#include <math.h>

typedef struct {
    double r[9]; /* rotation by rows */
    double p[3]; /* origin [m] */
} Pose;

typedef struct {
    int round;      /* a cylinder along its z; otherwise a box */
    double half[3]; /* half edges, or radius, radius and half length [m] */
    Pose at;        /* in its body */
    double outer;   /* of the ball about its centre that encloses it [m] */
    double inner;   /* of the ball about its centre that it encloses [m] */
} Shape;

typedef struct {
    double on_a[3], on_b[3];
} Points;

/* GJK ends where the bound is this close to the distance, relative to it. */
#define GJK_ACCURACY 1e-14
/* Distances below count as contact, and points that are closer as one [m]. */
#define GJK_CONTACT 1e-10
/* Steps after which GJK ends with the bound that it has. */
#define GJK_STEPS 128
/* Sine of the angle under which the fourth corner of a tetrahedron counts as in the plane of a face. */
#define FLAT 1e-9

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double *out)
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void difference(const double *a, const double *b, double *out)
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

/* x of a frame in the frame that holds it: R x + p. */
static void placed(const Pose *pose, const double *x, double *out)
{
    for (int i = 0; i < 3; i++)
        out[i] = dot(pose->r + 3 * i, x) + pose->p[i];
}

/* R^T x: a direction that is seen from a frame. */
static void seen_from(const double *r, const double *x, double *out)
{
    for (int i = 0; i < 3; i++)
        out[i] = r[i] * x[0] + r[3 + i] * x[1] + r[6 + i] * x[2];
}

/* A then B. */
static void composed(const Pose *a, const Pose *b, Pose *out)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->r[3 * i + j] = a->r[3 * i] * b->r[j] + a->r[3 * i + 1] * b->r[3 + j] + a->r[3 * i + 2] * b->r[6 + j];
    placed(a, b->p, out->p);
}

/* B as seen from A: A^-1 B. */
static void relative(const Pose *a, const Pose *b, Pose *out)
{
    double between[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out->r[3 * i + j] = a->r[i] * b->r[j] + a->r[3 + i] * b->r[3 + j] + a->r[6 + i] * b->r[6 + j];
    difference(b->p, a->p, between);
    seen_from(a->r, between, out->p);
}

/* The widest gap between two boxes along a face normal or a product of edges: a lower bound of their
   distance, exact in sign. Ends early where it exceeds `enough`. B is seen from the frame of A's box. */
static double box_gap(const double *half_a, const double *half_b, const Pose *b, double enough)
{
    double absolute[9], seen[3], gap = -DBL_MAX;
    for (int i = 0; i < 9; i++)
        absolute[i] = fabs(b->r[i]);
    for (int i = 0; i < 3; i++) {
        const double along = fabs(b->p[i]) - half_a[i] - dot(absolute + 3 * i, half_b);
        if (along > gap)
            gap = along;
    }
    if (gap > enough)
        return gap;
    seen_from(b->r, b->p, seen);
    for (int j = 0; j < 3; j++) {
        const double reach = absolute[j] * half_a[0] + absolute[3 + j] * half_a[1] + absolute[6 + j] * half_a[2];
        const double along = fabs(seen[j]) - half_b[j] - reach;
        if (along > gap)
            gap = along;
    }
    if (gap > enough)
        return gap;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const double square = 1.0 - b->r[3 * i + j] * b->r[3 * i + j]; /* of the product's length */
            if (square < 1e-6)
                continue; /* parallel edges: the faces say it */
            const double between = b->p[i2] * b->r[3 * i1 + j] - b->p[i1] * b->r[3 * i2 + j];
            const double reach_a = half_a[i1] * absolute[3 * i2 + j] + half_a[i2] * absolute[3 * i1 + j];
            const double reach_b = half_b[j1] * absolute[3 * i + j2] + half_b[j2] * absolute[3 * i + j1];
            const double along = (fabs(between) - reach_a - reach_b) / sqrt(square);
            if (along > gap)
                gap = along;
        }
    return gap;
}

/* The farthest point of a shape in a direction. */
static void support(const Shape *shape, const Pose *at, const double *direction, double *out)
{
    double corner[3];
    seen_from(at->r, direction, corner);
    if (shape->round) {
        const double length = sqrt(corner[0] * corner[0] + corner[1] * corner[1]);
        const double scale = length > 0.0 ? shape->half[0] / length : 0.0;
        corner[0] *= scale;
        corner[1] *= scale;
        corner[2] = copysign(shape->half[2], corner[2]);
    } else
        for (int i = 0; i < 3; i++)
            corner[i] = copysign(shape->half[i], corner[i]);
    placed(at, corner, out);
}

/* Up to four differences of points of A and B, and the weights of their point nearest to the origin. */
typedef struct {
    int size;
    double w[4][3], a[4][3], weight[4];
} Simplex;

static void keep(Simplex *simplex, const int *corners, const double *weights, int size)
{
    Simplex kept;
    kept.size = size;
    for (int i = 0; i < size; i++) {
        memcpy(kept.w[i], simplex->w[corners[i]], sizeof kept.w[i]);
        memcpy(kept.a[i], simplex->a[corners[i]], sizeof kept.a[i]);
        kept.weight[i] = weights[i];
    }
    *simplex = kept;
}

/* A corner, edge or triangle of a simplex with the point of it that is nearest to the origin. */
typedef struct {
    int size, corners[3];
    double weights[3], square;
} Part;

static double square_of_point(const Simplex *simplex, const Part *part)
{
    double point[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < part->size; k++)
        for (int i = 0; i < 3; i++)
            point[i] += part->weights[k] * simplex->w[part->corners[k]][i];
    return dot(point, point);
}

static void take(const Simplex *simplex, Part *best, Part part)
{
    part.square = square_of_point(simplex, &part);
    if (part.square < best->square)
        *best = part;
}

static void corner_of(const Simplex *simplex, int i, Part *best)
{
    take(simplex, best, (Part){.size = 1, .corners = {i}, .weights = {1.0}});
}

static void edge_of(const Simplex *simplex, int i, int j, Part *best)
{
    double edge[3];
    difference(simplex->w[j], simplex->w[i], edge);
    const double length = dot(edge, edge);
    const double share = -dot(simplex->w[i], edge);
    if (share > 0.0 && share < length)
        take(simplex, best, (Part){.size = 2, .corners = {i, j}, .weights = {1.0 - share / length, share / length}});
}

/* The part of a triangle nearest to the origin: its inside, or else an edge or a corner. */
static void triangle_of(const Simplex *simplex, int i, int j, int k, Part *best)
{
    const int corners[] = {i, j, k};
    double one[3], other[3], normal[3], weights[3];
    difference(simplex->w[j], simplex->w[i], one);
    difference(simplex->w[k], simplex->w[i], other);
    cross(one, other, normal);
    int inside = dot(normal, normal) > FLAT * FLAT * dot(one, one) * dot(other, other);
    double sum = 0.0; /* n . n, but for rounding, which is large if the triangle is thin */
    for (int c = 0; c < 3 && inside; c++) { /* barycentric: n . (w1 x w2) / n . n */
        double product[3];
        cross(simplex->w[corners[(c + 1) % 3]], simplex->w[corners[(c + 2) % 3]], product);
        weights[c] = dot(normal, product);
        inside = weights[c] > 0.0;
        sum += weights[c];
    }
    if (inside) {
        take(simplex, best, (Part){.size = 3, .corners = {i, j, k},
                                   .weights = {weights[0] / sum, weights[1] / sum, weights[2] / sum}});
        return;
    }
    for (int c = 0; c < 3; c++) {
        edge_of(simplex, corners[c], corners[(c + 1) % 3], best);
        corner_of(simplex, corners[c], best);
    }
}

/* Whether the origin is beyond the face i j k of a tetrahedron, or the tetrahedron is flat. */
static int beyond_face(const Simplex *simplex, int i, int j, int k, int opposite)
{
    double one[3], other[3], normal[3], up[3];
    difference(simplex->w[j], simplex->w[i], one);
    difference(simplex->w[k], simplex->w[i], other);
    difference(simplex->w[opposite], simplex->w[i], up);
    cross(one, other, normal);
    const double height = dot(normal, up);
    if (height * height <= FLAT * FLAT * dot(normal, normal) * dot(up, up))
        return 1;
    return -dot(normal, simplex->w[i]) * height < 0.0;
}

/* Reduces a simplex to the part nearest to the origin, and gives that point; 0 if the origin is inside. */
static int nearest_part(Simplex *simplex, double *point)
{
    Part best = {.size = 0, .square = DBL_MAX};
    if (simplex->size == 4) {
        static const int faces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
        for (int f = 0; f < 4; f++)
            if (beyond_face(simplex, faces[f][0], faces[f][1], faces[f][2], faces[f][3]))
                triangle_of(simplex, faces[f][0], faces[f][1], faces[f][2], &best);
        if (best.size == 0)
            return 0;
    } else if (simplex->size == 3)
        triangle_of(simplex, 0, 1, 2, &best);
    else {
        for (int i = 0; i < simplex->size; i++)
            corner_of(simplex, i, &best);
        if (simplex->size == 2)
            edge_of(simplex, 0, 1, &best);
    }
    keep(simplex, best.corners, best.weights, best.size);
    for (int i = 0; i < 3; i++) {
        point[i] = 0.0;
        for (int k = 0; k < simplex->size; k++)
            point[i] += simplex->weight[k] * simplex->w[k][i];
    }
    return 1;
}

static int already_in(const Simplex *simplex, const double *w)
{
    for (int k = 0; k < simplex->size; k++) {
        double between[3];
        difference(w, simplex->w[k], between);
        if (dot(between, between) <= GJK_CONTACT * GJK_CONTACT)
            return 1;
    }
    return 0;
}

static void add_corner(Simplex *simplex, const Shape *a, const Pose *at_a, const Shape *b, const Pose *at_b,
                       const double *v, double *w)
{
    const double towards[] = {-v[0], -v[1], -v[2]};
    double on_a[3], on_b[3];
    support(a, at_a, towards, on_a);
    support(b, at_b, v, on_b);
    difference(on_a, on_b, w);
    if (simplex->size < 4 && !already_in(simplex, w)) {
        memcpy(simplex->a[simplex->size], on_a, sizeof on_a);
        memcpy(simplex->w[simplex->size], w, 3 * sizeof *w);
        simplex->weight[simplex->size++] = 1.0;
    }
}

/* The nearest points that a simplex stands for. */
static void points_of(const Simplex *simplex, Points *points)
{
    for (int i = 0; i < 3; i++) {
        points->on_a[i] = points->on_b[i] = 0.0;
        for (int k = 0; k < simplex->size; k++) {
            points->on_a[i] += simplex->weight[k] * simplex->a[k][i];
            points->on_b[i] += simplex->weight[k] * (simplex->a[k][i] - simplex->w[k][i]);
        }
    }
}

/* A lower bound of the distance between two shapes, exact to GJK_ACCURACY unless it exceeds `enough`;
   0 if they touch. Both poses are in one frame, and so are the points, which may be NULL. */
static double shape_distance(const Shape *a, const Pose *at_a, const Shape *b, const Pose *at_b, double enough,
                             Points *points)
{
    Simplex simplex = {.size = 0};
    double v[3], w[3], bound = 0.0;
    difference(at_a->p, at_b->p, v);
    add_corner(&simplex, a, at_a, b, at_b, v, w);
    memcpy(v, w, sizeof v);
    for (int step = 0; step < GJK_STEPS; step++) {
        const double square = dot(v, v);
        if (square <= GJK_CONTACT * GJK_CONTACT)
            return 0.0;
        const int size = simplex.size;
        add_corner(&simplex, a, at_a, b, at_b, v, w);
        const double along = dot(v, w);
        if (along > 0.0 && along > bound * sqrt(square)) {
            bound = along / sqrt(square);
            if (bound > enough)
                break;
        }
        if (square - along <= GJK_ACCURACY * square || simplex.size == size)
            break; /* nothing is closer, or no corner is new */
        const Simplex before = simplex;
        double next[3];
        if (!nearest_part(&simplex, next))
            return 0.0;
        if (!(dot(next, next) < square)) {
            simplex = before; /* rounding ends the descent */
            simplex.size = size;
            break;
        }
        memcpy(v, next, sizeof v);
    }
    if (points != NULL) {
        double nearest[3];
        nearest_part(&simplex, nearest);
        points_of(&simplex, points);
    }
    return bound;
}
