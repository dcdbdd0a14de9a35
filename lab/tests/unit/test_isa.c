/* test_isa.c: the parser of PanVK's printed statistics, on recorded lines of Mesa 25.0.7. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "lab/isa/isa.h"

static masu_isa_row read_row(const char *line) {
    masu_isa_row row;
    memset(&row, 0, sizeof row);
    for (int k = 0; k < MASU_ISA_FIELD_COUNT; k++) row.value[k] = (double)NAN;
    assert_true(masu_isa_is_printed(line));
    masu_isa_read_printed(line, &row);
    return row;
}

static void lines_of_both_generations_are_read(void **state) {
    static const struct {
        const char *line, *stage;
        double instructions, cycles, waves, spills, fills;
    } lines[] = {
        {"SHADER-DB: MESA_SHADER_POSITION shader: 75 inst, 13.000000 cycles, 0.562500 fma, "
         "0.359375 cvt, 0.187500 sfu, 0.000000 v, 0.000000 t, 13.000000 ls, 40 quadwords, 2 "
         "threads, 0 loops, 0:0 spills:fills\n",
         "Vertex Shader; position", 75, 13, 2, 0, 0},
        {"SHADER-DB: MESA_SHADER_VARYING shader: 154 inst, 16.000000 cycles, 1.109375 fma, "
         "0.906250 cvt, 0.562500 sfu, 0.000000 v, 0.000000 t, 16.000000 ls, 80 quadwords, 2 "
         "threads, 0 loops, 0:0 spills:fills\n",
         "Vertex Shader; others", 154, 16, 2, 0, 0},
        {"SHADER-DB: MESA_SHADER_FRAGMENT shader: 237 inst, 166 tuples, 23 clauses, 6.583333 "
         "cycles, 6.583333 arith, 0.000000 texture, 0.000000 vary, 4.000000 ldst, 139 quadwords, "
         "1 threads, 12 preloads, 0 loops, 0:0 spills:fills\n",
         "Fragment Shader", 237, 6.583333, 1, 0, 0},
        /* Like the others, with the numbers of a march. */
        {"SHADER-DB: MESA_SHADER_COMPUTE shader: 3054 inst, 233.000000 cycles, 38.0 fma, 20.0 "
         "cvt, 11.0 sfu, 0.0 v, 0.0 t, 233.0 ls, 1600 quadwords, 1 threads, 16 loops, 10:95 "
         "spills:fills\n",
         "Compute Shader", 3054, 233, 1, 10, 95},
    };
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        masu_isa_row row = read_row(lines[i].line);
        assert_string_equal(row.stage, lines[i].stage);
        assert_true(row.value[MASU_ISA_INSTRUCTIONS] == lines[i].instructions);
        assert_true(fabs(row.value[MASU_ISA_CYCLES] - lines[i].cycles) < 1e-9);
        assert_true(row.value[MASU_ISA_WAVES] == lines[i].waves);
        assert_true(row.value[MASU_ISA_SPILLS] == lines[i].spills);
        assert_true(row.value[MASU_ISA_FILLS] == lines[i].fills);
        assert_true(isnan(row.value[MASU_ISA_REGISTERS]) && isnan(row.value[MASU_ISA_SCRATCH]));
    }
}

static void missing_numbers_stay_unknown(void **state) {
    (void)state;
    masu_isa_row row = read_row("SHADER-DB: MESA_SHADER_GEOMETRY shader: 90 inst");
    assert_string_equal(row.stage, "(no stage)");
    for (int k = 0; k < MASU_ISA_FIELD_COUNT; k++) assert_true(isnan(row.value[k]));
    row = read_row("SHADER-DB: MESA_SHADER_COMPUTE shader: 90 inst, 1 loops, 3");
    assert_true(row.value[MASU_ISA_INSTRUCTIONS] == 90 && row.value[MASU_ISA_SPILLS] == 3);
    assert_true(isnan(row.value[MASU_ISA_FILLS]) && isnan(row.value[MASU_ISA_CYCLES]));
    assert_false(masu_isa_is_printed("MESA: warning: SHADER-DB: off"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_of_both_generations_are_read),
        cmocka_unit_test(missing_numbers_stay_unknown),
    };
    return cmocka_run_group_tests_name("isa", tests, NULL, NULL);
}
