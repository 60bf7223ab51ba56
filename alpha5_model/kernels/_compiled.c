/* The generated kernels for Python, over rows of states; and the exact test of self-collision. */

#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#define NPY_NO_DEPRECATED_API NPY_1_7_API_VERSION
#include <numpy/arrayobject.h>

#include "rows.h"

static PyObject *kernel_error; /* alpha5_model.errors.KernelError */

static int plain(PyObject *object, int flags)
{
    return Py_TYPE(object) == &PyArray_Type && PyArray_TYPE((PyArrayObject *)object) == NPY_DOUBLE
           && PyArray_CHKFLAGS((PyArrayObject *)object, flags)
           && PyArray_ISNOTSWAPPED((PyArrayObject *)object);
}

static PyObject *refused(PyObject *name, const char *expected)
{
    PyObject *arguments = Py_BuildValue("(Os)", name, expected);
    if (arguments != NULL) {
        PyErr_SetObject(kernel_error, arguments);
        Py_DECREF(arguments);
    }
    return NULL;
}

/* A C-contiguous array of rows, or one row for all as numpy.broadcast_to makes it; how far rows are apart. */
static int is_rows(PyObject *object, int size, npy_intp n, ptrdiff_t *step)
{
    PyArrayObject *array = (PyArrayObject *)object;
    *step = size;
    if (!plain(object, NPY_ARRAY_ALIGNED) || PyArray_NDIM(array) < 1 || PyArray_DIM(array, 0) != n
        || PyArray_SIZE(array) != n * size)
        return 0;
    if (PyArray_CHKFLAGS(array, NPY_ARRAY_C_CONTIGUOUS))
        return 1;
    *step = 0;
    return PyArray_NDIM(array) == 2 && PyArray_STRIDE(array, 0) == 0
           && (size == 1 || PyArray_STRIDE(array, 1) == sizeof(double));
}

enum { AT_ONCE = 100000 }; /* rows between two looks at signals: a few milliseconds */

/* The kernel on all rows; 0 after an error. */
static int run(const Kernel *kernel, PyObject *name, const double *parameters, const double **in, const ptrdiff_t *step,
               double **out, npy_intp n)
{
    for (npy_intp done = 0; done < n; done += AT_ONCE) {
        const npy_intp count = n - done < AT_ONCE ? n - done : AT_ONCE;
        int good;
        Py_BEGIN_ALLOW_THREADS
        good = compute_rows(kernel, parameters, in, step, out, count);
        Py_END_ALLOW_THREADS
        if (!good)
            return refused(name, "finite numbers that are not huge") != NULL;
        for (int i = 0; i < kernel->inputs; i++)
            in[i] += count * step[i];
        for (int i = 0; i < kernel->outputs; i++)
            out[i] += count * kernel->slots[kernel->inputs + i].size;
        if (done + count < n && PyErr_CheckSignals() < 0)
            return 0;
    }
    return 1;
}

static PyObject *rows(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    const char *name = count < 3 ? NULL : PyUnicode_AsUTF8AndSize(given[0], NULL);
    if (name == NULL)
        return PyErr_Occurred() ? NULL : PyErr_Format(PyExc_TypeError, "rows takes a name, parameters and inputs");
    const Kernel *kernel = kernels, *const end = kernels + sizeof kernels / sizeof *kernels;
    while (kernel < end && strcmp(kernel->name, name) != 0)
        kernel++;
    if (kernel == end)
        return refused(given[0], "the name of a kernel");
    if (!plain(given[1], NPY_ARRAY_CARRAY_RO) || PyArray_SIZE((PyArrayObject *)given[1]) != kernel->parameters)
        return refused(given[0], "its number of parameters, float64");

    const double *in[MOST_SLOTS];
    double *out[MOST_SLOTS];
    ptrdiff_t step[MOST_SLOTS];
    npy_intp n = 0;
    int good = count - 2 == kernel->inputs;
    for (int i = 0; good && i < kernel->inputs; i++) {
        PyArrayObject *array = (PyArrayObject *)given[i + 2];
        if (i == 0 && plain(given[2], 0) && PyArray_NDIM(array) > 0)
            n = PyArray_DIM(array, 0);
        good = is_rows(given[i + 2], kernel->slots[i].size, n, &step[i]);
        if (good)
            in[i] = PyArray_DATA(array);
    }
    if (!good)
        return refused(given[0], "its inputs as C-contiguous float64 rows");

    PyObject *results = PyTuple_New(kernel->outputs);
    for (int i = 0; results != NULL && i < kernel->outputs; i++) {
        const Slot *slot = &kernel->slots[kernel->inputs + i];
        npy_intp shape[3] = {n, slot->shape[0], slot->shape[1]};
        PyObject *array = PyArray_SimpleNew(1 + slot->axes, shape, NPY_DOUBLE);
        if (array == NULL) {
            Py_CLEAR(results);
            break;
        }
        out[i] = PyArray_DATA((PyArrayObject *)array);
        PyTuple_SetItem(results, i, array);
    }
    if (results != NULL && !run(kernel, given[0], PyArray_DATA((PyArrayObject *)given[1]), in, step, out, n))
        Py_CLEAR(results);
    return results;
}

/* Two turns: larger angles are most likely degrees. */
static const double MOST_ANGLE = 4 * 3.14159265358979323846;

static PyObject *is_state(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    if (count < 3)
        return PyBool_FromLong(0);
    long nq = PyLong_AsLong(arguments[0]);
    long nv = PyLong_AsLong(arguments[1]);
    if (PyErr_Occurred())
        return NULL;
    long of_base = nq == nv ? 0 : 7; /* position and quaternion */
    for (Py_ssize_t i = 2; i < count; i++) {
        PyArrayObject *array = (PyArrayObject *)arguments[i];
        long length = i == 2 ? nq : nv;
        if (!plain(arguments[i], NPY_ARRAY_CARRAY_RO) || PyArray_NDIM(array) != 1
            || PyArray_DIM(array, 0) != length)
            return PyBool_FromLong(0);
        const double *x = PyArray_DATA(array);
        if (!clean(x, length) || (i == 2 && !within(MOST_ANGLE, x + of_base, length - of_base)))
            return PyBool_FromLong(0);
    }
    return PyBool_FromLong(1);
}

#include "self_collision.h"

static PyMethodDef methods[] = {
    {"rows", (PyCFunction)(void (*)(void))rows, METH_FASTCALL,
     "rows(name, parameters, *inputs) -> outputs: see `alpha5_model.kernels.choice.rows`."},
    {"is_state", (PyCFunction)(void (*)(void))is_state, METH_FASTCALL,
     "is_state(nq, nv, q, *rates) -> bool: whether they are plain float64 (nq,), (nv,), ... that can be computed with, and angles of at most two turns."},
    {"scene", (PyCFunction)(void (*)(void))scene, METH_FASTCALL,
     "scene(bodies, shapes, pairs) -> scene: see `alpha5_model.collision.self_collision`."},
    {"self_collision", (PyCFunction)(void (*)(void))self_collision, METH_FASTCALL,
     "self_collision(scene, angles, margin) -> bool; None if angles are not a row of float64 of at most two turns."},
    {"self_collision_rows", (PyCFunction)(void (*)(void))self_collision_rows, METH_FASTCALL,
     "self_collision_rows(scene, angles, margin, asked, hits) -> whether it was computed.\n\n"
     "A row with NaN does not collide, nor does one that is not asked for."},
    {"nearest_bodies_rows", (PyCFunction)(void (*)(void))nearest_bodies_rows, METH_FASTCALL,
     "nearest_bodies_rows(scene, angles, out) -> whether it was computed.\n\n"
     "Each row of out holds the distance, the numbers of two shapes and their nearest points."},
    {"free_shares", (PyCFunction)(void (*)(void))free_shares, METH_FASTCALL,
     "free_shares(scene, rates, from, to, margin, shares) -> whether it was computed.\n\n"
     "Each of shares is how much of the line between two rows is proved free of self-collision."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT, "_compiled",
                                        "The generated kernels, compiled.", -1, methods,
                                        NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__compiled(void)
{
    import_array();
    PyObject *errors = PyImport_ImportModule("alpha5_model.errors");
    kernel_error = errors ? PyObject_GetAttrString(errors, "KernelError") : NULL;
    Py_XDECREF(errors);
    PyObject *module = kernel_error ? PyModule_Create(&definition) : NULL;
    if (module != NULL && PyModule_AddStringConstant(module, "SOURCES", SOURCES) < 0)
        Py_CLEAR(module);
    return module;
}
