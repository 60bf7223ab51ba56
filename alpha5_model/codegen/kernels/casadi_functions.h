/* The kernels as functions that casadi.external finds in this library: `alpha5_NAME` of the inputs, then the
   parameters if there are any, each a column of its elements row by row, and what CasADi asks about it. */

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif
typedef long long casadi_int;

/* CasADi hands over NULL for zeros, and for a result that nobody wants. Like its own functions this makes NaN of NaN. */
static int casadi_row(const Kernel *kernel, const double **given, double **results)
{
    static const double zeros[MOST_INPUTS + MOST_PARAMETERS];
    const double *in[MOST_SLOTS];
    double k[MOST_CONSTANTS], y[MOST_OUTPUTS], *end = y;
    for (int i = 0; i < kernel->inputs; i++)
        in[i] = given[i] ? given[i] : zeros;
    if (kernel->parameters)
        kernel = prepared(kernel, given[kernel->inputs] ? given[kernel->inputs] : zeros, k);
    const int good = row(kernel, k, in, y);
    for (int i = 0; i < kernel->outputs; i++)
        for (int j = 0; j < kernel->slots[kernel->inputs + i].size; j++, end++)
            if (results[i])
                results[i][j] = good ? *end : (double)NAN;
    return 0;
}

static casadi_int casadi_inputs(const Kernel *kernel) { return kernel->inputs + (kernel->parameters > 0); }

/* By size: rows, columns, and 1 for a dense matrix. Filled once, when the module is loaded. */
static casadi_int casadi_columns[MOST_INPUTS + MOST_OUTPUTS + MOST_PARAMETERS][3];

static void describe_columns(void)
{
    for (int size = 0; size < (int)(sizeof casadi_columns / sizeof *casadi_columns); size++)
        memcpy(casadi_columns[size], (casadi_int[]){size, 1, 1}, sizeof *casadi_columns);
}

#define CASADI(i, name)                                                                                               \
    EXPORTED int alpha5_##name(const double **given, double **results, casadi_int *iw, double *w, int memory)         \
    {                                                                                                                 \
        (void)iw, (void)w, (void)memory;                                                                              \
        return casadi_row(&kernels[i], given, results);                                                               \
    }                                                                                                                 \
    EXPORTED casadi_int alpha5_##name##_n_in(void) { return casadi_inputs(&kernels[i]); }                             \
    EXPORTED casadi_int alpha5_##name##_n_out(void) { return kernels[i].outputs; }                                    \
    EXPORTED const casadi_int *alpha5_##name##_sparsity_in(casadi_int place)                                          \
    {                                                                                                                 \
        return casadi_columns[place < kernels[i].inputs ? kernels[i].slots[place].size : kernels[i].parameters];       \
    }                                                                                                                 \
    EXPORTED const casadi_int *alpha5_##name##_sparsity_out(casadi_int place)                                         \
    {                                                                                                                 \
        return casadi_columns[kernels[i].slots[kernels[i].inputs + place].size];                                       \
    }
EACH_KERNEL(CASADI)
