/* The generated kernels for Python: `bind` makes a function of one state, `batch` runs over rows.

   Nothing here raises for a caller's numbers: what is not plainly a float64 array of the right shape
   with finite entries of at most LARGEST is left to a fallback, or gets None or False, and Python says
   why. There is no state but the width, which is chosen once, when the module is loaded. */

#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <structmember.h>
#define NPY_NO_DEPRECATED_API NPY_1_7_API_VERSION
#include <numpy/arrayobject.h>
#include <stdint.h>
#include <time.h>

#include "rows.h"

static int plain(PyObject *object, int flags)
{
    return Py_TYPE(object) == &PyArray_Type && PyArray_TYPE((PyArrayObject *)object) == NPY_DOUBLE
           && PyArray_CHKFLAGS((PyArrayObject *)object, flags)
           && PyArray_ISNOTSWAPPED((PyArrayObject *)object);
}

/* One row for all, as numpy.broadcast_to makes it. */
static int repeated(PyObject *object)
{
    PyArrayObject *array = (PyArrayObject *)object;
    return plain(object, NPY_ARRAY_ALIGNED) && PyArray_NDIM(array) == 2 && PyArray_DIM(array, 0) > 1
           && PyArray_STRIDE(array, 0) == 0
           && (PyArray_DIM(array, 1) == 1 || PyArray_STRIDE(array, 1) == sizeof(double));
}

/* The kernel of a name and the constants that its parameters make, in k. */
static const Kernel *named(PyObject *name, PyObject *parameters, double *k)
{
    const char *text = PyUnicode_AsUTF8AndSize(name, NULL);
    if (text == NULL)
        return NULL;
    for (const Kernel *kernel = kernels; kernel < kernels + KERNELS; kernel++) {
        if (strcmp(kernel->name, text) != 0)
            continue;
        if (kernel->parameters == 0)
            return kernel;
        if (parameters == NULL || !plain(parameters, NPY_ARRAY_CARRAY_RO)
            || PyArray_SIZE((PyArrayObject *)parameters) != kernel->parameters) {
            PyErr_Format(PyExc_ValueError, "%s takes %d parameters in a float64 array", text,
                         kernel->parameters);
            return NULL;
        }
        return prepared(kernel, PyArray_DATA((PyArrayObject *)parameters), k);
    }
    PyErr_Format(PyExc_ValueError, "no kernel %R", name);
    return NULL;
}

/* What `bind` returns: called with plain states it computes; in all else it is its fallback. */
typedef PyObject *(*Call)(PyObject *, PyObject *const *, size_t, PyObject *);
typedef struct {
    PyObject_HEAD
    Call call;
    PyObject *fallback; /* NULL: None is the answer */
    const Kernel *kernel;
    double k[MOST_CONSTANTS];
} Bound;

static PyTypeObject *bound_type;

static void free_results(PyObject *owner)
{
    PyMem_Free(PyCapsule_GetPointer(owner, NULL));
}

/* A tuple of new arrays in one piece of memory, which is a fifth less work than one for each. */
static PyObject *several(const Kernel *kernel, const double *y)
{
    const Slot *slot = &kernel->slots[kernel->inputs];
    size_t size = 0;
    for (int i = 0; i < kernel->outputs; i++)
        size += slot[i].size * sizeof(double);
    double *results = PyMem_Malloc(size);
    PyObject *owner = results ? PyCapsule_New(results, NULL, free_results) : PyErr_NoMemory();
    if (owner == NULL) {
        PyMem_Free(results);
        return NULL;
    }
    memcpy(results, y, size);
    PyObject *tuple = PyTuple_New(kernel->outputs);
    for (int i = 0; tuple != NULL && i < kernel->outputs; results += slot[i++].size) {
        PyObject *array = PyArray_SimpleNewFromData(slot[i].axes, (npy_intp *)slot[i].shape, NPY_DOUBLE, results);
        if (array == NULL || PyArray_SetBaseObject((PyArrayObject *)array, Py_NewRef(owner)) < 0) {
            Py_XDECREF(array);
            Py_CLEAR(tuple);
        } else
            PyTuple_SetItem(tuple, i, array);
    }
    Py_DECREF(owner);
    return tuple;
}

/* New arrays of the outputs. NULL, without an error, where an argument is not plainly a state. */
static PyObject *computed(const Bound *bound, PyObject *const *given)
{
    const Kernel *kernel = bound->kernel;
    const double *in[MOST_SLOTS];
    double y[MOST_OUTPUTS];
    for (int i = 0; i < kernel->inputs; i++) {
        const Slot *slot = &kernel->slots[i];
        PyArrayObject *array = (PyArrayObject *)given[i];
        if (!plain(given[i], NPY_ARRAY_CARRAY_RO) || PyArray_NDIM(array) != slot->axes
            || PyArray_DIM(array, 0) != slot->shape[0])
            return NULL;
        in[i] = PyArray_DATA(array);
    }
    if (!row(kernel, bound->k, in, y))
        return NULL;
    if (kernel->outputs > 1)
        return several(kernel, y);
    const Slot *slot = &kernel->slots[kernel->inputs];
    PyObject *array = PyArray_SimpleNew(slot->axes, (npy_intp *)slot->shape, NPY_DOUBLE);
    if (array != NULL)
        memcpy(PyArray_DATA((PyArrayObject *)array), y, slot->size * sizeof(double));
    return array;
}

static PyObject *fall_back(PyObject *self, PyObject *arguments, PyObject *keywords)
{
    PyObject *fallback = ((Bound *)self)->fallback;
    return fallback ? PyObject_Call(fallback, arguments, keywords) : Py_NewRef(Py_None);
}

static PyObject *call(PyObject *self, PyObject *const *given, size_t flagged, PyObject *names)
{
    const Bound *bound = (Bound *)self;
    Py_ssize_t count = flagged & SIZE_MAX >> 1, named = names ? PyTuple_Size(names) : 0;
    PyObject *result = named == 0 && count == bound->kernel->inputs ? computed(bound, given) : NULL;
    if (result != NULL || PyErr_Occurred())
        return result;
    PyObject *arguments = PyTuple_New(count), *keywords = PyDict_New();
    int good = arguments != NULL && keywords != NULL;
    for (Py_ssize_t i = 0; good && i < count; i++)
        PyTuple_SetItem(arguments, i, Py_NewRef(given[i]));
    for (Py_ssize_t i = 0; good && i < named; i++)
        good = PyDict_SetItem(keywords, PyTuple_GetItem(names, i), given[count + i]) == 0;
    result = good ? fall_back(self, arguments, keywords) : NULL;
    Py_XDECREF(arguments);
    Py_XDECREF(keywords);
    return result;
}

static PyObject *attribute(PyObject *self, PyObject *name)
{
    PyObject *fallback = ((Bound *)self)->fallback;
    return fallback ? PyObject_GetAttr(fallback, name) : PyObject_GenericGetAttr(self, name);
}

static PyObject *shown(PyObject *self)
{
    PyObject *fallback = ((Bound *)self)->fallback;
    return fallback ? PyObject_Repr(fallback) : PyUnicode_FromFormat("<kernel %s>", ((Bound *)self)->kernel->name);
}

/* A circle goes through objects that can be cleared: those that own the fallback. */
static int traverse(PyObject *self, visitproc visit, void *arg)
{
    Py_VISIT(Py_TYPE(self));
    Py_VISIT(((Bound *)self)->fallback);
    return 0;
}

static void release(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    PyObject_GC_UnTrack(self);
    Py_XDECREF(((Bound *)self)->fallback);
    PyObject_GC_Del(self);
    Py_DECREF(type);
}

static PyMemberDef members[] = {
    {"__vectorcalloffset__", T_PYSSIZET, offsetof(Bound, call), READONLY, NULL},
    {NULL, 0, 0, 0, NULL},
};
static PyType_Slot slots[] = {
    {Py_tp_members, members},     {Py_tp_call, fall_back},    {Py_tp_getattro, attribute}, {Py_tp_repr, shown},
    {Py_tp_traverse, traverse}, {Py_tp_dealloc, release}, {0, NULL},
};
/* 1 << 11: calls come with an array. Known by this name to the limited API since 3.12 only. */
static PyType_Spec bound_spec = {
    "alpha5_model.codegen.kernels._compiled.Bound", sizeof(Bound), 0,
    Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_DISALLOW_INSTANTIATION | Py_TPFLAGS_IMMUTABLETYPE | 1UL << 11,
    slots,
};

static PyObject *bind(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    if (count < 1 || count > 3)
        return PyErr_Format(PyExc_TypeError, "bind takes a name, parameters and a fallback");
    Bound *bound = PyObject_GC_New(Bound, bound_type);
    if (bound == NULL)
        return NULL;
    bound->call = call;
    bound->fallback = count > 2 && arguments[2] != Py_None ? Py_NewRef(arguments[2]) : NULL;
    bound->kernel = named(arguments[0], count > 1 ? arguments[1] : NULL, bound->k);
    PyObject_GC_Track(bound);
    if (bound->kernel == NULL)
        Py_CLEAR(bound);
    return (PyObject *)bound;
}

/* Nanoseconds of a clock on the wall. */
static int64_t now(void)
{
    struct timespec time;
    timespec_get(&time, TIME_UTC);
    return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

enum { BLOCK = 128 * PANEL, PATIENCE = 20000000 }; /* rows between two looks at the clock; ns between two at signals */

/* The first of n rows, for as long as PATIENCE: how many; 0 if one of them cannot be computed. */
static npy_intp some_rows(const Kernel *kernel, const double *k, const double **in, const ptrdiff_t *step, double **out,
                          npy_intp n)
{
    int64_t start = 0, time = 0;
    npy_intp done = 0;
    while ((uint64_t)(time - start) < PATIENCE) { /* not after the clock was set back */
        const npy_intp block = n - done < BLOCK ? n - done : BLOCK;
        if (!rows(kernel, k, in, step, out, block))
            return 0;
        done += block;
        if (done == n)
            break;
        time = now();
        if (start == 0)
            start = time;
    }
    return done;
}

static PyObject *batch(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    double k[MOST_CONSTANTS];
    const double *in[MOST_SLOTS];
    double *out[MOST_SLOTS];
    ptrdiff_t step[MOST_SLOTS];
    npy_intp n = 0;
    if (count < 3)
        return PyErr_Format(PyExc_TypeError, "batch takes a name, parameters and arrays");
    const Kernel *kernel = named(arguments[0], arguments[1], k);
    if (kernel == NULL)
        return NULL;
    if (count - 2 != kernel->inputs + kernel->outputs)
        Py_RETURN_FALSE;
    for (int i = 0; i < count - 2; i++) {
        PyArrayObject *array = (PyArrayObject *)arguments[i + 2];
        int given = i < kernel->inputs, same = given && repeated(arguments[i + 2]);
        if (!(same || plain(arguments[i + 2], given ? NPY_ARRAY_CARRAY_RO : NPY_ARRAY_CARRAY))
            || PyArray_NDIM(array) < 1)
            Py_RETURN_FALSE;
        if (i == 0)
            n = PyArray_DIM(array, 0);
        if (PyArray_DIM(array, 0) != n || PyArray_SIZE(array) != n * kernel->slots[i].size)
            Py_RETURN_FALSE;
        if (given)
            in[i] = PyArray_DATA(array), step[i] = same ? 0 : kernel->slots[i].size;
        else
            out[i - kernel->inputs] = PyArray_DATA(array);
    }
    while (n > 0) {
        npy_intp done;
        Py_BEGIN_ALLOW_THREADS
        done = some_rows(kernel, k, in, step, out, n);
        Py_END_ALLOW_THREADS
        if (done == 0)
            Py_RETURN_FALSE;
        n -= done;
        if (n > 0 && PyErr_CheckSignals() < 0)
            return NULL;
    }
    Py_RETURN_TRUE;
}

static PyObject *is_state(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    long length = -1;
    for (Py_ssize_t i = 2; i < count; i++) {
        PyArrayObject *array = (PyArrayObject *)arguments[i];
        if (i < 4)
            length = PyLong_AsLong(arguments[i - 2]);
        if (!plain(arguments[i], NPY_ARRAY_CARRAY_RO) || PyArray_NDIM(array) != 1
            || PyArray_DIM(array, 0) != length || !clean(PyArray_DATA(array), length))
            return PyErr_Occurred() ? NULL : PyBool_FromLong(0);
    }
    return PyBool_FromLong(length >= 0);
}

static PyObject *width(PyObject *module, PyObject *most)
{
    (void)module;
    long asked = PyLong_AsLong(most);
    if (asked == -1 && PyErr_Occurred())
        return NULL;
    if (asked > 0)
        choose(asked);
    return PyUnicode_FromString(levels[level].name);
}

#include "casadi_functions.h"
#include "inverse_kinematics.h"
#include "self_collision.h"

static PyMethodDef methods[] = {
    {"bind", (PyCFunction)(void (*)(void))bind, METH_FASTCALL,
     "bind(name, parameters=None, fallback=None) -> function of one state: see `alpha5_model.codegen.kernels.choice.module`."},
    {"batch", (PyCFunction)(void (*)(void))batch, METH_FASTCALL,
     "batch(name, parameters, *inputs, *outputs) -> whether it was computed: see `alpha5_model.codegen.kernels.choice.module`."},
    {"is_state", (PyCFunction)(void (*)(void))is_state, METH_FASTCALL,
     "is_state(nq, nv, q, *rates) -> bool: see `alpha5_model.codegen.kernels.choice.module`."},
    {"inverse_kinematics", (PyCFunction)(void (*)(void))inverse_kinematics, METH_FASTCALL,
     "inverse_kinematics(kind, position, wrist[, arm]) -> kind, a named tuple of the five arrays of Solutions.\n\n"
     "arm is what bind makes of the kernel and the numbers of an arm other than the catalogue's.\n"
     "None where position is not a float64 array (3,) or a list or tuple of three floats, wrist not a\n"
     "float, or a number too large or not finite."},
    {"scene", (PyCFunction)(void (*)(void))scene, METH_FASTCALL,
     "scene(bodies, shapes, pairs, *tables) -> scene: see `alpha5_model.collision.compiled`."},
    {"self_collision", (PyCFunction)(void (*)(void))self_collision, METH_FASTCALL,
     "self_collision(scene, angles, margin) -> bool; None where angles are not a row of finite float64."},
    {"self_collision_rows", (PyCFunction)(void (*)(void))self_collision_rows, METH_FASTCALL,
     "self_collision_rows(scene, angles, margin, asked, hits) -> whether it was computed.\n\n"
     "A row with NaN does not collide, nor does one that is not asked for."},
    {"best_solution", (PyCFunction)(void (*)(void))best_solution, METH_FASTCALL,
     "best_solution(scene, solutions, q_reference, allow_collision) -> (4,); None where one target is not plainly solved."},
    {"nearest_bodies_rows", (PyCFunction)(void (*)(void))nearest_bodies_rows, METH_FASTCALL,
     "nearest_bodies_rows(scene, angles, out) -> whether it was computed.\n\n"
     "Each row of out holds the distance, the numbers of two shapes and their nearest points."},
    {"free_shares", (PyCFunction)(void (*)(void))free_shares, METH_FASTCALL,
     "free_shares(scene, rates, from, to, margin, shares) -> whether it was computed.\n\n"
     "Each of shares is how much of the line between two rows is proved free of self-collision."},
    {"width", width, METH_O,
     "width(most) -> name of the instructions in use. For tests: a positive number chooses the\n"
     "widest that this processor has of at most so many doubles, for all threads; 0 leaves it."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT, "_compiled",
                                        "The generated kernels, compiled.", -1, methods,
                                        NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__compiled(void)
{
    import_array();
    choose(8);
    describe_columns();
    bound_type = (PyTypeObject *)PyType_FromSpec(&bound_spec);
    if (bound_type == NULL || !share())
        return NULL;
    PyObject *module = PyModule_Create(&definition);
    if (module != NULL && PyModule_AddStringConstant(module, "SOURCES", SOURCES) < 0)
        Py_CLEAR(module);
    return module;
}
