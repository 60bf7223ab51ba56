
static const alpha5_real expected_$function[$count][$size] = $table;

static void test_$function(void)
{
    alpha5_real out[$size];
    int row;
    for (row = 0; row < $count; ++row) {
        $call);
$checks    }
}
