/* test_machine.c: the machine that runs a scene's GLSL on the CPU (tools/bake/shader/spirv.h):
 * indices of vectors at the limit and one beyond, and what it tells of its decisions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <math.h>

#include "bake/shader/spirv.h"
#include "support/files.h"

/* A buffer of an index and four floats: x, which is put into (1, 2, 3) at the index, and the first
 * component of that; the component of (1, 2, 3) at `from`; and a smooth step of x. */
static const char module_text[] = "OpCapability Shader\n"
                                  "%glsl = OpExtInstImport \"GLSL.std.450\"\n"
                                  "OpMemoryModel Logical GLSL450\n"
                                  "OpEntryPoint GLCompute %main \"main\"\n"
                                  "OpExecutionMode %main LocalSize 1 1 1\n"
                                  "OpDecorate %block Block\n"
                                  "OpMemberDecorate %block 0 Offset 0\n"
                                  "OpMemberDecorate %block 1 Offset 4\n"
                                  "OpMemberDecorate %block 2 Offset 8\n"
                                  "OpMemberDecorate %block 3 Offset 12\n"
                                  "OpMemberDecorate %block 4 Offset 16\n"
                                  "OpMemberDecorate %block 5 Offset 20\n"
                                  "OpDecorate %buffer DescriptorSet 0\n"
                                  "OpDecorate %buffer Binding 0\n"
                                  "%void = OpTypeVoid\n"
                                  "%none = OpTypeFunction %void\n"
                                  "%float = OpTypeFloat 32\n"
                                  "%uint = OpTypeInt 32 0\n"
                                  "%vec3 = OpTypeVector %float 3\n"
                                  "%block = OpTypeStruct %uint %uint %float %float %float %float\n"
                                  "%to_block = OpTypePointer StorageBuffer %block\n"
                                  "%to_uint = OpTypePointer StorageBuffer %uint\n"
                                  "%to_float = OpTypePointer StorageBuffer %float\n"
                                  "%buffer = OpVariable %to_block StorageBuffer\n"
                                  "%u0 = OpConstant %uint 0\n"
                                  "%u1 = OpConstant %uint 1\n"
                                  "%u2 = OpConstant %uint 2\n"
                                  "%u3 = OpConstant %uint 3\n"
                                  "%u4 = OpConstant %uint 4\n"
                                  "%u5 = OpConstant %uint 5\n"
                                  "%f1 = OpConstant %float 1\n"
                                  "%f2 = OpConstant %float 2\n"
                                  "%f3 = OpConstant %float 3\n"
                                  "%v = OpConstantComposite %vec3 %f1 %f2 %f3\n"
                                  "%main = OpFunction %void None %none\n"
                                  "%start = OpLabel\n"
                                  "%p0 = OpAccessChain %to_uint %buffer %u0\n"
                                  "%into = OpLoad %uint %p0\n"
                                  "%p1 = OpAccessChain %to_uint %buffer %u1\n"
                                  "%from = OpLoad %uint %p1\n"
                                  "%p2 = OpAccessChain %to_float %buffer %u2\n"
                                  "%x = OpLoad %float %p2\n"
                                  "%w = OpVectorInsertDynamic %vec3 %v %x %into\n"
                                  "%first = OpCompositeExtract %float %w 0\n"
                                  "%p3 = OpAccessChain %to_float %buffer %u3\n"
                                  "OpStore %p3 %first\n"
                                  "%taken = OpVectorExtractDynamic %float %v %from\n"
                                  "%p4 = OpAccessChain %to_float %buffer %u4\n"
                                  "OpStore %p4 %taken\n"
                                  "%step = OpExtInst %float %glsl SmoothStep %f1 %f2 %x\n"
                                  "%p5 = OpAccessChain %to_float %buffer %u5\n"
                                  "OpStore %p5 %step\n"
                                  "OpReturn\n"
                                  "OpFunctionEnd\n";

static uint32_t *words;
static masu_bake_machine *machine;
static masu_bake_cell *cells;
static char error[256];

static int make_machine(void **state) {
    size_t bytes, count;
    char path[256];
    if (make_scratch(state)) return 1;
    (void)write_text("m.spvasm", module_text);
    assert_int_equal(
        shell("cd %s && spirv-as --target-env vulkan1.1 m.spvasm -o m.spv && spirv-val "
              "--target-env vulkan1.1 m.spv",
              scratch),
        0);
    snprintf(path, sizeof path, "%s/m.spv", scratch);
    words = read_file(path, &bytes);
    machine = masu_bake_machine_make(words, bytes / 4, error, sizeof error);
    if (!machine) fail_msg("%s", error);
    cells = masu_bake_machine_buffer(machine, 0, &count);
    assert_int_equal(count, 6);
    return 0;
}

static int free_machine(void **state) {
    masu_bake_machine_free(machine);
    free(words);
    return remove_scratch(state);
}

static bool run(uint32_t into, uint32_t from, double x) {
    cells[0].u = into;
    cells[1].u = from;
    cells[2].f = x;
    return masu_bake_machine_run(machine, error, sizeof error);
}

static void an_index_is_below_the_size_of_its_vector(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 5; i++) {
        assert_int_equal(run(i, 0, 7), i < 3);
        if (i >= 3) assert_non_null(strstr(error, "outside of a vector"));
        if (i < 3) assert_true(cells[3].f == (i ? 1 : 7));
        assert_int_equal(run(0, i, 7), i < 3);
        if (i >= 3) assert_non_null(strstr(error, "outside of a vector"));
        if (i < 3) assert_true(cells[4].f == 1 + i);
    }
}

/* A smooth step bends at its two ends: the distance to the nearer one, below 0 outside. */
static void a_smooth_step_decides_at_its_ends(void **state) {
    (void)state;
    static const double x[] = {0.5, 0.875, 1.125, 1.5, 1.75, 2.25},
                        by[] = {-0.5, -0.125, 0.125, 0.5, 0.25, -0.25};
    for (size_t i = 0; i < sizeof x / sizeof *x; i++) {
        size_t count;
        assert_true(run(0, 0, x[i]));
        const uint32_t *decided = masu_bake_machine_decided(machine, &count);
        assert_int_equal(count, 1);
        assert_true(masu_bake_machine_decisions(machine, &count)[decided[0]] == by[i]);
    }
    assert_true(run(0, 0, 1.5) && cells[5].f == 0.5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_index_is_below_the_size_of_its_vector),
        cmocka_unit_test(a_smooth_step_decides_at_its_ends),
    };
    return cmocka_run_group_tests_name("machine", tests, make_machine, free_machine);
}
