/* Self-collision of a chain of bodies, exact.

   A scene is made once for an arm and never changes, so that threads share it. Bodies and shapes are
   those of `alpha5_model.collision.bodies`. */

#include "convex.h"

enum { MOST_BODIES = 8, MOST_PAIRS = MOST_BODIES * MOST_BODIES };

typedef struct {
    int parent; /* -1: the body that all poses are relative to */
    Pose at;    /* in the parent, at joint position zero; the body turns about its z */
    int first, count;
    Pose box; /* of all its shapes, along the body's axes */
    double half[3];
} Body;

typedef struct {
    int bodies, pairs;
    Body body[MOST_BODIES];
    int pair[MOST_PAIRS][2];
    Shape shape[]; /* those of a body are neighbours */
} Scene;

typedef struct {
    double distance;
    int a, b; /* shapes */
    Points points; /* in the frame of the first body [m] */
} Nearest;

static void turned(const Pose *at, double angle, Pose *out)
{
    const double c = cos(angle), s = sin(angle);
    *out = *at;
    for (int i = 0; i < 3; i++) {
        out->r[3 * i] = c * at->r[3 * i] + s * at->r[3 * i + 1];
        out->r[3 * i + 1] = c * at->r[3 * i + 1] - s * at->r[3 * i];
    }
}

/* Poses of all bodies in the first one's frame. */
static void place_bodies(const Scene *scene, const double *angles, Pose *poses)
{
    poses[0] = (Pose){.r = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int i = 1; i < scene->bodies; i++) {
        Pose in_parent;
        turned(&scene->body[i].at, angles[i - 1], &in_parent);
        composed(&poses[scene->body[i].parent], &in_parent, &poses[i]);
    }
}

/* Lower bound of the distance between two balls. */
static double ball_gap(const double *a, double radius_a, const double *b, double radius_b)
{
    double between[3];
    difference(a, b, between);
    return sqrt(dot(between, between)) - radius_a - radius_b;
}

/* Distance of a ball from a box along its axes. */
static double ball_box_gap(const double *centre, double radius, const Body *body)
{
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const double beyond = fabs(centre[i] - body->box.p[i]) - body->half[i];
        square += beyond > 0.0 ? beyond * beyond : 0.0;
    }
    return sqrt(square) - radius;
}

/* The boxes of two bodies: a lower bound of the distance of all their shapes. */
static double body_gap(const Body *a, const Body *b, const Pose *b_in_a, double enough)
{
    Pose box, seen;
    composed(b_in_a, &b->box, &box);
    seen = box;
    difference(box.p, a->box.p, seen.p); /* the box of a is along a's axes */
    return box_gap(a->half, b->half, &seen, enough);
}

/* Lowers found->distance to that of two bodies, if they are nearer than it; poses are b's in a. */
static void nearest_of_bodies(const Scene *scene, const Body *a, const Body *b, const Pose *b_in_a, int any,
                              int with_points, Nearest *found)
{
    for (int j = b->first; j < b->first + b->count; j++) {
        const Shape *shape_b = &scene->shape[j];
        Pose at_b;
        placed(b_in_a, shape_b->at.p, at_b.p);
        if (ball_box_gap(at_b.p, shape_b->outer, a) > found->distance)
            continue;
        composed(b_in_a, &shape_b->at, &at_b);
        for (int i = a->first; i < a->first + a->count; i++) {
            const Shape *shape_a = &scene->shape[i];
            if (ball_gap(shape_a->at.p, shape_a->outer, at_b.p, shape_b->outer) > found->distance)
                continue;
            Pose seen;
            relative(&shape_a->at, &at_b, &seen);
            const double gap = box_gap(shape_a->half, shape_b->half, &seen, found->distance);
            if (gap > found->distance)
                continue;
            double distance = 0.0;
            Points points = {{NAN, NAN, NAN}, {NAN, NAN, NAN}}; /* what shapes that touch have */
            const int boxes = !shape_a->round && !shape_b->round;
            if (gap > 0.0 || !boxes || with_points)
                distance = shape_distance(shape_a, &shape_a->at, shape_b, &at_b, found->distance,
                                          with_points ? &points : NULL);
            if (boxes && gap <= 0.0)
                distance = 0.0; /* separating axes are exact in sign */
            if (distance > found->distance || (distance == found->distance && !any))
                continue;
            found->distance = distance;
            found->a = i;
            found->b = j;
            if (with_points)
                found->points = points;
            if (any)
                return;
        }
    }
}

/* Whether the bodies of a pair come within `most`. */
static int touches(const Scene *scene, const double *angles, double most)
{
    Pose poses[MOST_BODIES];
    place_bodies(scene, angles, poses);
    for (int k = 0; k < scene->pairs; k++) {
        const int i = scene->pair[k][0], j = scene->pair[k][1];
        const Body *a = &scene->body[i], *b = &scene->body[j];
        Pose b_in_a;
        relative(&poses[i], &poses[j], &b_in_a);
        if (body_gap(a, b, &b_in_a, most) > most)
            continue;
        Nearest found = {.distance = most, .a = -1};
        nearest_of_bodies(scene, a, b, &b_in_a, 1, 0, &found);
        if (found.a >= 0)
            return 1;
    }
    return 0;
}

/* An upper bound of the distance of two bodies: balls in their shapes. */
static double most_apart(const Scene *scene, const Body *a, const Body *b, const Pose *b_in_a)
{
    double most = INFINITY;
    for (int j = b->first; j < b->first + b->count; j++) {
        double centre[3];
        placed(b_in_a, scene->shape[j].at.p, centre);
        for (int i = a->first; i < a->first + a->count; i++) {
            const Shape *one = &scene->shape[i];
            const double gap = ball_gap(one->at.p, one->inner, centre, scene->shape[j].inner);
            if (gap < most)
                most = gap;
        }
    }
    return most > 0.0 ? most : 0.0;
}

/* All pairs of bodies at some angles: poses, and the gaps of their boxes. */
typedef struct {
    Pose first[MOST_PAIRS], seen[MOST_PAIRS]; /* of the first body, and of the second in it */
    double gap[MOST_PAIRS];
} Pairs;

static void place_pairs(const Scene *scene, const double *angles, Pairs *pairs)
{
    Pose poses[MOST_BODIES];
    place_bodies(scene, angles, poses);
    for (int k = 0; k < scene->pairs; k++) {
        const int i = scene->pair[k][0], j = scene->pair[k][1];
        pairs->first[k] = poses[i];
        relative(&poses[i], &poses[j], &pairs->seen[k]);
        pairs->gap[k] = body_gap(&scene->body[i], &scene->body[j], &pairs->seen[k], INFINITY);
    }
}

/* Numbers of pairs in the order of some values. */
static void sorted(const double *values, int n, int *order)
{
    for (int k = 0; k < n; k++) {
        int place = k;
        for (; place > 0 && values[order[place - 1]] > values[k]; place--)
            order[place] = order[place - 1];
        order[place] = k;
    }
}

/* The nearest two shapes of a pair of bodies, if they are nearer than `most`: 1 then. */
static int nearest_of_pair(const Scene *scene, const Pairs *pairs, int k, double most, Nearest *found)
{
    const Body *a = &scene->body[scene->pair[k][0]], *b = &scene->body[scene->pair[k][1]];
    const double apart = most_apart(scene, a, b, &pairs->seen[k]);
    *found = (Nearest){.distance = apart < most ? nextafter(apart, INFINITY) : most, .a = -1, .b = -1};
    nearest_of_bodies(scene, a, b, &pairs->seen[k], 0, 1, found);
    return found->a >= 0;
}

/* The nearest two shapes of all pairs of bodies, and their points in the first body's frame. */
static void nearest_bodies(const Scene *scene, const double *angles, Nearest *found)
{
    Pairs pairs;
    int order[MOST_PAIRS];
    place_pairs(scene, angles, &pairs);
    sorted(pairs.gap, scene->pairs, order);
    *found = (Nearest){.distance = INFINITY, .a = -1, .b = -1};
    for (int n = 0; n < scene->pairs; n++) {
        const int k = order[n];
        Nearest of_pair;
        if (pairs.gap[k] > found->distance || !nearest_of_pair(scene, &pairs, k, found->distance, &of_pair))
            continue;
        *found = of_pair;
        placed(&pairs.first[k], of_pair.points.on_a, found->points.on_a);
        placed(&pairs.first[k], of_pair.points.on_b, found->points.on_b);
    }
}

/* Whether the arm comes within `margin` of itself; not if an angle is NaN. */
static int in_self_collision(const Scene *scene, const double *angles, double margin)
{
    for (int i = 0; i < scene->bodies - 1; i++)
        if (!isfinite(angles[i]))
            return 0;
    return touches(scene, angles, margin);
}

/* How much farther a line is proved free from some angles on, as a share of it: the least over all pairs of
   their distance beyond the margin over `rate`, at which the line can shorten it. 0 near a contact. */
static double proved_step(const Scene *scene, const double *angles, const double *rate, double margin)
{
    const double SHORTEST = 1e-6; /* m: an accuracy that no arm has */
    Pairs pairs;
    int order[MOST_PAIRS];
    double steps[MOST_PAIRS], least = INFINITY;
    place_pairs(scene, angles, &pairs);
    for (int k = 0; k < scene->pairs; k++)
        steps[k] = (pairs.gap[k] - margin) / rate[k];
    sorted(steps, scene->pairs, order);
    for (int n = 0; n < scene->pairs && steps[order[n]] < least; n++) {
        const int k = order[n];
        Nearest found;
        if (!nearest_of_pair(scene, &pairs, k, least * rate[k] + margin, &found))
            continue;
        const double room = found.distance - margin;
        if (!(room > SHORTEST))
            return 0.0;
        if (room / rate[k] < least)
            least = room / rate[k];
    }
    return least;
}

/* The share of a straight line of joint positions that is proved to stay farther than `margin` apart: 1.0 if
   all of it is. `rates` bound how fast each joint changes the distance of each pair [m/rad]. */
static double free_share(const Scene *scene, const double *rates, const double *from, const double *to, double margin)
{
    const int n = scene->bodies - 1;
    double rate[MOST_PAIRS];
    for (int k = 0; k < scene->pairs; k++) {
        rate[k] = DBL_MIN; /* a pair that the line does not move keeps its distance */
        for (int i = 0; i < n; i++)
            rate[k] += rates[k * n + i] * fabs(to[i] - from[i]);
    }
    for (double share = 0.0;;) {
        double angles[MOST_BODIES];
        for (int i = 0; i < n; i++)
            angles[i] = from[i] + share * (to[i] - from[i]);
        const double step = proved_step(scene, angles, rate, margin);
        if (step == 0.0)
            return share;
        if (step > 1.0 - share)
            return 1.0;
        share += step;
    }
}

/* Calls from Python. */

static const char *const SCENE = "alpha5_model.self_collision.scene";

static void free_scene(PyObject *capsule)
{
    PyMem_Free(PyCapsule_GetPointer(capsule, SCENE));
}

static int real(PyObject *given, double *x)
{
    *x = PyFloat_AsDouble(given);
    if (PyErr_Occurred() == NULL)
        return 1;
    PyErr_Clear();
    return 0;
}

/* The rows of a plain float64 array (n, columns); NULL otherwise. */
static const double *table_of(PyObject *given, int columns, npy_intp *n)
{
    PyArrayObject *array = (PyArrayObject *)given;
    if (!plain(given, NPY_ARRAY_CARRAY_RO) || PyArray_NDIM(array) != 2 || PyArray_DIM(array, 1) != columns)
        return NULL;
    *n = PyArray_DIM(array, 0);
    return PyArray_DATA(array);
}

static const double *read_pose(const double *x, Pose *pose)
{
    for (int i = 0; i < 3; i++) {
        memcpy(pose->r + 3 * i, x + 4 * i, 3 * sizeof *x);
        pose->p[i] = x[4 * i + 3];
    }
    return x + 12;
}

enum { BODY_NUMBERS = 1 + 12, SHAPE_NUMBERS = 1 + 1 + 3 + 12, PAIR_NUMBERS = 2 };

static int read_bodies(Scene *scene, const double *x)
{
    for (int i = 0; i < scene->bodies; i++, x += BODY_NUMBERS) {
        scene->body[i].parent = (int)x[0];
        if (scene->body[i].parent >= i || (scene->body[i].parent < 0) != (i == 0))
            return 0;
        read_pose(x + 1, &scene->body[i].at);
    }
    return 1;
}

/* The box of a body, from how far its shapes reach along its axes. */
static void enclose(const Scene *scene, Body *body)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int s = body->first; s < body->first + body->count; s++)
        for (int i = 0; i < 3; i++) {
            double towards[3] = {0.0, 0.0, 0.0}, point[3];
            towards[i] = 1.0;
            support(&scene->shape[s], &scene->shape[s].at, towards, point);
            high[i] = fmax(high[i], point[i]);
            towards[i] = -1.0;
            support(&scene->shape[s], &scene->shape[s].at, towards, point);
            low[i] = fmin(low[i], point[i]);
        }
    body->box = (Pose){.r = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int i = 0; i < 3 && body->count > 0; i++) {
        body->box.p[i] = (low[i] + high[i]) / 2;
        body->half[i] = nextafter((high[i] - low[i]) / 2, INFINITY);
    }
}

static int read_shapes(Scene *scene, const double *x, npy_intp n)
{
    int last = 0;
    for (npy_intp s = 0; s < n; s++, x += SHAPE_NUMBERS) {
        Shape *shape = &scene->shape[s];
        const int body = (int)x[0];
        if (body < last || body >= scene->bodies)
            return 0;
        last = body;
        if (scene->body[body].count++ == 0)
            scene->body[body].first = (int)s;
        shape->round = x[1] != 0.0;
        memcpy(shape->half, x + 2, sizeof shape->half);
        read_pose(x + 5, &shape->at);
        const double *half = shape->half;
        const double across = shape->round ? half[0] : hypot(half[0], half[1]);
        shape->outer = nextafter(hypot(across, half[2]), INFINITY);
        shape->inner = fmin(half[2], fmin(half[0], half[1]));
    }
    for (int i = 0; i < scene->bodies; i++)
        enclose(scene, &scene->body[i]);
    return 1;
}

static int read_pairs(Scene *scene, const double *x)
{
    for (int k = 0; k < scene->pairs; k++, x += PAIR_NUMBERS)
        for (int i = 0; i < 2; i++) {
            scene->pair[k][i] = (int)x[i];
            if (scene->pair[k][i] < 0 || scene->pair[k][i] >= scene->bodies)
                return 0;
        }
    return 1;
}

static PyObject *scene(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    npy_intp bodies = 0, shapes = 0, pairs = 0;
    const double *of_bodies = count == 3 ? table_of(given[0], BODY_NUMBERS, &bodies) : NULL;
    const double *of_shapes = count == 3 ? table_of(given[1], SHAPE_NUMBERS, &shapes) : NULL;
    const double *of_pairs = count == 3 ? table_of(given[2], PAIR_NUMBERS, &pairs) : NULL;
    if (of_bodies == NULL || of_shapes == NULL || of_pairs == NULL || bodies < 1 || bodies > MOST_BODIES
        || pairs > MOST_PAIRS)
        return PyErr_Format(PyExc_ValueError, "scene takes float64 arrays of bodies, shapes and pairs");
    Scene *made = PyMem_Calloc(1, sizeof(Scene) + shapes * sizeof(Shape));
    PyObject *capsule = made ? PyCapsule_New(made, SCENE, free_scene) : PyErr_NoMemory();
    if (capsule == NULL) {
        PyMem_Free(made);
        return NULL;
    }
    made->bodies = (int)bodies;
    made->pairs = (int)pairs;
    int good = read_bodies(made, of_bodies) && read_shapes(made, of_shapes, shapes) && read_pairs(made, of_pairs);
    if (!good) {
        Py_DECREF(capsule);
        return PyErr_Format(PyExc_ValueError, "scene: bodies, shapes or pairs that do not fit");
    }
    return capsule;
}

/* in_self_collision(scene, angles, margin): of one row; None if angles are not plainly one. */
static PyObject *self_collision(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    double margin;
    const Scene *scene = count == 3 ? PyCapsule_GetPointer(given[0], SCENE) : NULL;
    if (scene == NULL)
        return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_TypeError, "self_collision takes a scene, angles and a margin");
    PyArrayObject *angles = (PyArrayObject *)given[1];
    if (!plain(given[1], NPY_ARRAY_CARRAY_RO) || PyArray_NDIM(angles) != 1
        || PyArray_DIM(angles, 0) != scene->bodies - 1
        || !within(MOST_ANGLE, PyArray_DATA(angles), scene->bodies - 1)
        || !real(given[2], &margin) || !(margin >= 0.0 && margin <= LARGEST))
        Py_RETURN_NONE;
    return PyBool_FromLong(in_self_collision(scene, PyArray_DATA(angles), margin));
}

/* Results of a row of angles: one truth value, or the nearest bodies in numbers. */
enum { NEAREST_NUMBERS = 9 };
typedef struct {
    const Scene *scene;
    const double *angles;
    double margin;
    const npy_bool *asked; /* NULL: every row */
    npy_bool *hits;
    double *nearest;
    const double *rates, *to;
    double *shares;
} Rows;

static void collision_rows(const Rows *rows, npy_intp first, npy_intp last)
{
    const int angles = rows->scene->bodies - 1;
    for (npy_intp row = first; row < last; row++) {
        if (rows->hits != NULL) {
            const int asked = rows->asked == NULL || rows->asked[row];
            rows->hits[row] = asked && in_self_collision(rows->scene, rows->angles + angles * row, rows->margin);
            continue;
        }
        if (rows->shares != NULL) {
            rows->shares[row] = free_share(rows->scene, rows->rates, rows->angles + angles * row,
                                           rows->to + angles * row, rows->margin);
            continue;
        }
        Nearest found;
        double *out = rows->nearest + NEAREST_NUMBERS * row;
        nearest_bodies(rows->scene, rows->angles + angles * row, &found);
        out[0] = found.distance;
        out[1] = found.a;
        out[2] = found.b;
        memcpy(out + 3, found.points.on_a, 3 * sizeof *out);
        memcpy(out + 6, found.points.on_b, 3 * sizeof *out);
    }
}

/* Rows in blocks, between which signals are answered. */
static PyObject *every_row(const Rows *rows, npy_intp n)
{
    const npy_intp at_once = rows->hits != NULL ? 8192 : 256;
    for (npy_intp first = 0; first < n; first += at_once) {
        const npy_intp last = n - first < at_once ? n : first + at_once;
        Py_BEGIN_ALLOW_THREADS
        collision_rows(rows, first, last);
        Py_END_ALLOW_THREADS
        if (last < n && PyErr_CheckSignals() < 0)
            return NULL;
    }
    Py_RETURN_TRUE;
}

/* An array of n truth values. */
static int truths(PyObject *given, npy_intp n, int flags)
{
    PyArrayObject *array = (PyArrayObject *)given;
    return Py_TYPE(given) == &PyArray_Type && PyArray_TYPE(array) == NPY_BOOL && PyArray_CHKFLAGS(array, flags)
           && PyArray_SIZE(array) == n;
}

/* self_collision_rows(scene, angles, margin, asked or None, hits): whether it was computed. */
static PyObject *self_collision_rows(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    npy_intp n = 0;
    Rows rows = {.scene = count == 5 ? PyCapsule_GetPointer(given[0], SCENE) : NULL};
    if (rows.scene == NULL)
        return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_TypeError, "self_collision_rows takes a scene and four more");
    rows.angles = table_of(given[1], rows.scene->bodies - 1, &n);
    if (rows.angles == NULL || !real(given[2], &rows.margin) || !(rows.margin >= 0.0)
        || (given[3] != Py_None && !truths(given[3], n, NPY_ARRAY_CARRAY_RO))
        || !truths(given[4], n, NPY_ARRAY_CARRAY))
        Py_RETURN_FALSE;
    if (given[3] != Py_None)
        rows.asked = PyArray_DATA((PyArrayObject *)given[3]);
    rows.hits = PyArray_DATA((PyArrayObject *)given[4]);
    return every_row(&rows, n);
}

/* nearest_bodies_rows(scene, angles, out): whether it was computed; out holds distance, two shapes, two points. */
static PyObject *nearest_bodies_rows(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    npy_intp n = 0;
    Rows rows = {.scene = count == 3 ? PyCapsule_GetPointer(given[0], SCENE) : NULL};
    if (rows.scene == NULL)
        return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_TypeError, "nearest_bodies_rows takes a scene and two more");
    PyArrayObject *out = (PyArrayObject *)given[2];
    rows.angles = table_of(given[1], rows.scene->bodies - 1, &n);
    if (rows.angles == NULL || !clean(rows.angles, n * (rows.scene->bodies - 1)) || !plain(given[2], NPY_ARRAY_CARRAY)
        || PyArray_SIZE(out) != n * NEAREST_NUMBERS)
        Py_RETURN_FALSE;
    rows.nearest = PyArray_DATA(out);
    return every_row(&rows, n);
}

/* free_shares(scene, rates, from, to, margin, shares): whether it was computed. */
static PyObject *free_shares(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    npy_intp n = 0, ends = 0, one = 0;
    Rows rows = {.scene = count == 6 ? PyCapsule_GetPointer(given[0], SCENE) : NULL};
    if (rows.scene == NULL)
        return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_TypeError, "free_shares takes a scene and five more");
    const int angles = rows.scene->bodies - 1;
    rows.rates = table_of(given[1], angles, &one);
    rows.angles = table_of(given[2], angles, &n);
    rows.to = table_of(given[3], angles, &ends);
    if (rows.rates == NULL || one != rows.scene->pairs || rows.angles == NULL || rows.to == NULL || ends != n
        || !clean(rows.angles, n * angles) || !clean(rows.to, n * angles) || !real(given[4], &rows.margin)
        || !(rows.margin >= 0.0) || !plain(given[5], NPY_ARRAY_CARRAY) || PyArray_SIZE((PyArrayObject *)given[5]) != n)
        Py_RETURN_FALSE;
    rows.shares = PyArray_DATA((PyArrayObject *)given[5]);
    return every_row(&rows, n);
}
