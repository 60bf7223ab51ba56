/* Inverse kinematics of one target for Python: the kernel's angles, and its flags as truth values. */

enum { BRANCHES = 4, ANGLES = 16, EXISTS = ANGLES, WITHIN = EXISTS + BRANCHES, SINGULAR = WITHIN + BRANCHES, RESULTS };

static const Kernel *solver;
static newfunc new_tuple;
static PyObject *flags[1 << BRANCHES], *singular[2]; /* shared by all answers */

static PyObject *flag(const double *b)
{
    return flags[(b[0] != 0.0) | (b[1] != 0.0) << 1 | (b[2] != 0.0) << 2 | (b[3] != 0.0) << 3];
}

static PyObject *read_only(int axes, npy_intp first, npy_intp second, const double *values)
{
    npy_intp shape[] = {first, second};
    PyObject *array = PyArray_SimpleNew(axes, shape, NPY_DOUBLE);
    if (array != NULL) {
        memcpy(PyArray_DATA((PyArrayObject *)array), values, PyArray_NBYTES((PyArrayObject *)array));
        PyArray_CLEARFLAGS((PyArrayObject *)array, NPY_ARRAY_WRITEABLE);
    }
    return array;
}

/* The same of truth values, in bytes: setflags does not unlock what all answers share. */
static PyObject *unchangeable(int axes, npy_intp size, const npy_bool *values)
{
    PyObject *bytes = PyBytes_FromStringAndSize((const char *)values, size);
    if (bytes == NULL)
        return NULL;
    PyObject *array = PyArray_New(&PyArray_Type, axes, &size, NPY_BOOL, NULL, PyBytes_AsString(bytes), 0,
                                  NPY_ARRAY_CARRAY_RO, NULL);
    if (array == NULL) {
        Py_DECREF(bytes);
        return NULL;
    }
    if (PyArray_SetBaseObject((PyArrayObject *)array, bytes) < 0) /* takes bytes in any case */
        Py_CLEAR(array);
    return array;
}

/* A float or an integer, not of a subclass. */
static int real(PyObject *given, double *x)
{
    if (!PyFloat_CheckExact(given) && !PyLong_CheckExact(given))
        return 0;
    *x = PyFloat_AsDouble(given);
    if (*x != -1.0 || PyErr_Occurred() == NULL)
        return 1;
    PyErr_Clear(); /* an integer that is too large */
    return 0;
}

/* The numbers of an array (n,), list or tuple. */
static int numbers_of(PyObject *given, int n, double *x)
{
    if (plain(given, NPY_ARRAY_CARRAY_RO)) {
        PyArrayObject *array = (PyArrayObject *)given;
        if (PyArray_NDIM(array) != 1 || PyArray_DIM(array, 0) != n)
            return 0;
        memcpy(x, PyArray_DATA(array), n * sizeof *x);
        return 1;
    }
    int good = (PyList_CheckExact(given) || PyTuple_CheckExact(given)) && PyObject_Size(given) == n;
    for (int i = 0; i < n && good; i++) {
        PyObject *item = PySequence_GetItem(given, i);
        good = item != NULL && real(item, &x[i]);
        Py_XDECREF(item);
    }
    return good;
}

/* Whether an object is a bound kernel with the inputs and outputs of the solver. */
static int solves(PyObject *object)
{
    if (Py_TYPE(object) != bound_type)
        return 0;
    const Kernel *kernel = ((Bound *)object)->kernel;
    const int slots = solver->inputs + solver->outputs;
    return kernel->inputs == solver->inputs && kernel->outputs == solver->outputs
           && memcmp(kernel->slots, solver->slots, slots * sizeof(Slot)) == 0;
}

static PyObject *inverse_kinematics(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    double x[4], y[RESULTS];
    const double *const in[] = {x, x + 3}, *k = NULL;
    const Kernel *kernel = solver;
    const int own = count == 4 && solves(given[3]);
    if ((count != 3 && !own) || !PyType_Check(given[0])
        || !PyType_IsSubtype((PyTypeObject *)given[0], &PyTuple_Type))
        return PyErr_Format(PyExc_TypeError, "inverse_kinematics takes a kind of tuple, position and wrist, "
                                             "and the bound kernel of an arm other than the catalogue's");
    if (own) {
        kernel = ((Bound *)given[3])->kernel;
        k = ((Bound *)given[3])->k;
    }
    if (!numbers_of(given[1], 3, x) || !real(given[2], x + 3) || !row(kernel, k, in, y))
        Py_RETURN_NONE;
    PyObject *arguments = Py_BuildValue("((NOOON))", read_only(2, 4, 4, y), flag(y + EXISTS), flag(y + WITHIN),
                                        singular[y[SINGULAR] != 0.0], read_only(1, 3, 0, x));
    PyObject *answer = arguments ? new_tuple((PyTypeObject *)given[0], arguments, NULL) : NULL;
    Py_XDECREF(arguments);
    return answer;
}

/* Finds the kernel, and makes what answers share; 0 after an error. */
static int share(void)
{
    for (size_t i = 0; i < KERNELS; i++)
        if (strcmp(kernels[i].name, "inverse_kinematics") == 0)
            solver = &kernels[i];
    new_tuple = (newfunc)PyType_GetSlot(&PyTuple_Type, Py_tp_new);
    for (int code = 0; code < 1 << BRANCHES; code++) {
        const npy_bool bits[] = {code & 1, code >> 1 & 1, code >> 2 & 1, code >> 3};
        flags[code] = unchangeable(1, BRANCHES, bits);
        if (flags[code] == NULL)
            return 0;
    }
    for (npy_bool one = 0; one < 2; one++)
        singular[one] = unchangeable(0, 1, &one);
    return singular[0] != NULL && singular[1] != NULL;
}
