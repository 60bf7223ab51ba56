/* Inverse kinematics for Python: the kernel's angles, and the signs of its margins as truth values. */

enum { BRANCHES = 4, ANGLES = 16, REACH = 16, LIMITS = 18, CLEARANCE = 22, RESULTS = 23 };

static const Kernel *solver;
static newfunc new_tuple;
static PyObject *flags[1 << BRANCHES], *regular; /* read-only, shared by all answers */

/* Angles of a branch that does not reach become NaN. */
static void signs(const double *reach, const double *limits, double *angles, npy_bool *exists, npy_bool *within)
{
    const npy_bool reached[] = {reach[0] > 0.0, reach[1] > 0.0};
    for (int branch = 0; branch < BRANCHES; branch++) {
        exists[branch] = reached[branch & 1];
        within[branch] = reached[branch & 1] & (limits[branch] >= 0.0);
    }
    if (reached[0] & reached[1])
        return;
    for (int i = 0; i < ANGLES; i++)
        if (!reached[i >> 2 & 1])
            angles[i] = NAN;
}

static PyObject *flag(const npy_bool *b)
{
    return flags[b[0] | b[1] << 1 | b[2] << 2 | b[3] << 3];
}

static PyObject *read_only(int axes, npy_intp first, npy_intp second, int type, const void *values)
{
    npy_intp shape[] = {first, second};
    PyObject *array = PyArray_SimpleNew(axes, shape, type);
    if (array != NULL) {
        memcpy(PyArray_DATA((PyArrayObject *)array), values, PyArray_NBYTES((PyArrayObject *)array));
        PyArray_CLEARFLAGS((PyArrayObject *)array, NPY_ARRAY_WRITEABLE);
    }
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

/* x, y, z of an array, list or tuple. */
static int three(PyObject *given, double *x)
{
    if (plain(given, NPY_ARRAY_CARRAY_RO)) {
        PyArrayObject *array = (PyArrayObject *)given;
        if (PyArray_NDIM(array) != 1 || PyArray_DIM(array, 0) != 3)
            return 0;
        memcpy(x, PyArray_DATA(array), 3 * sizeof *x);
        return 1;
    }
    int good = (PyList_CheckExact(given) || PyTuple_CheckExact(given)) && PyObject_Size(given) == 3;
    for (int i = 0; i < 3 && good; i++) {
        PyObject *item = PySequence_GetItem(given, i);
        good = item != NULL && real(item, &x[i]);
        Py_XDECREF(item);
    }
    return good;
}

static PyObject *inverse_kinematics(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    double x[4], y[RESULTS];
    const double *const in[] = {x, x + 3};
    npy_bool exists[BRANCHES], within[BRANCHES];
    if (count != 3 || !PyType_Check(given[0])
        || !PyType_IsSubtype((PyTypeObject *)given[0], &PyTuple_Type))
        return PyErr_Format(PyExc_TypeError, "inverse_kinematics takes a kind of tuple, position and wrist");
    if (!three(given[1], x) || !real(given[2], x + 3) || !row(solver, NULL, in, y) || !(y[CLEARANCE] > 0.0))
        Py_RETURN_NONE;
    signs(y + REACH, y + LIMITS, y, exists, within);
    PyObject *arguments = Py_BuildValue("((NOOON))", read_only(2, 4, 4, NPY_DOUBLE, y), flag(exists), flag(within),
                                        regular, read_only(1, 3, 0, NPY_DOUBLE, x));
    PyObject *answer = arguments ? new_tuple((PyTypeObject *)given[0], arguments, NULL) : NULL;
    Py_XDECREF(arguments);
    return answer;
}

/* The kernel on n rows; nothing is clear of an edge where a number is too large. */
static void solve(const double *position, const double *wrist, npy_intp n, double *const *to)
{
    const double *in[] = {position, wrist};
    double *out[] = {to[0], to[1], to[2], to[3]};
    if (rows(solver, NULL, in, out, n))
        return;
    for (npy_intp i = 0; i < n; i++) {
        double *one[] = {to[0] + ANGLES * i, to[1] + 2 * i, to[2] + BRANCHES * i, to[3] + i};
        in[0] = position + 3 * i, in[1] = wrist + i;
        one[1][0] = one[1][1] = one[3][0] = 0.0;
        rows(solver, NULL, in, one, 1);
    }
}

static PyObject *inverse_kinematics_rows(PyObject *module, PyObject *const *given, Py_ssize_t count)
{
    (void)module;
    static const int width[] = {3, 1, ANGLES, BRANCHES, BRANCHES, 1};
    npy_intp length[6];
    char *data[6];
    int fits = count == 6;
    for (int i = 0; i < 6 && fits; i++) {
        PyArrayObject *array = (PyArrayObject *)given[i];
        fits = Py_TYPE(given[i]) == &PyArray_Type && PyArray_TYPE(array) == (i < 3 ? NPY_DOUBLE : NPY_BOOL)
               && PyArray_CHKFLAGS(array, i < 2 ? NPY_ARRAY_CARRAY_RO : NPY_ARRAY_CARRAY)
               && PyArray_SIZE(array) % width[i] == 0;
        length[i] = fits ? PyArray_SIZE(array) / width[i] : 0;
        data[i] = fits ? PyArray_DATA(array) : NULL;
        fits &= length[i] == length[0] || (i == 1 && length[i] == 1) || (i == 2 && length[i] == 0);
    }
    if (!fits)
        return PyErr_Format(PyExc_TypeError,
                            "inverse_kinematics_rows takes position (n, 3), wrist (n,) or (1,), q (n, 4, 4) or "
                            "(0, 4, 4), exists (n, 4), within (n, 4) and near (n,)");
    const double *position = (double *)data[0], *wrist = (double *)data[1];
    double *q = length[2] ? (double *)data[2] : NULL;
    npy_bool *exists = (npy_bool *)data[3], *within = (npy_bool *)data[4], *near = (npy_bool *)data[5];
    const int each = length[1] == length[0];
    Py_BEGIN_ALLOW_THREADS
    double angles[ANGLES * PANEL], reach[2 * PANEL], limits[BRANCHES * PANEL] = {0}, clearance[PANEL], same[PANEL];
    for (int i = 0; i < PANEL && !each; i++)
        same[i] = *wrist;
    for (npy_intp first = 0; first < length[0]; first += PANEL) {
        const npy_intp n = length[0] - first < PANEL ? length[0] - first : PANEL;
        double *const out[] = {q ? q + ANGLES * first : angles, reach, limits, clearance};
        solve(position + 3 * first, each ? wrist + first : same, n, out);
        for (npy_intp i = 0, at = BRANCHES * first; i < n; i++, at += BRANCHES) {
            signs(reach + 2 * i, limits + BRANCHES * i, out[0] + ANGLES * i, exists + at, within + at);
            near[first + i] = !(clearance[i] > 0.0);
        }
    }
    Py_END_ALLOW_THREADS
    Py_RETURN_NONE;
}

/* Finds the kernel, and makes what answers share; 0 after an error. */
static int share(void)
{
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
        if (strcmp(kernels[i].name, "inverse_kinematics") == 0)
            solver = &kernels[i];
    new_tuple = (newfunc)PyType_GetSlot(&PyTuple_Type, Py_tp_new);
    for (int code = 0; code < 1 << BRANCHES; code++) {
        const npy_bool bits[] = {code & 1, code >> 1 & 1, code >> 2 & 1, code >> 3};
        flags[code] = read_only(1, BRANCHES, 0, NPY_BOOL, bits);
        if (flags[code] == NULL)
            return 0;
    }
    regular = read_only(0, 0, 0, NPY_BOOL, &(npy_bool){0});
    return regular != NULL;
}
