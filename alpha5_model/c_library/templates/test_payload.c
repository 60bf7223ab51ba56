
static const alpha5_real payload_mass[1] = $mass, payload_com[3] = $com, payload_inertia[9] = $inertia;
static const alpha5_real payload_volume[1] = $volume, payload_cob[3] = $cob, payload_density[1] = $density;
static const alpha5_real payload_tau[$count][4] = $tau;

static void test_with_payload(void)
{
    alpha5_parameters loaded;
    int row;
    alpha5_with_payload(&alpha5_default_parameters, payload_mass[0], payload_com, payload_inertia, payload_volume[0],
                        payload_cob, payload_density[0], &loaded);
    for (row = 0; row < $count; ++row) {
        alpha5_real tau_out[4];
        alpha5_inverse_dynamics(&loaded, q[row], v[row], a[row], tau_out);
        compare("with_payload", row, tau_out, payload_tau[row], 4, $bound);
    }
}
