/* isa.h: statistics of a scene's pipelines on an absent GPU: registers, waves, instructions,
 * cycles, spills, from the GPU's compiler (VK_KHR_pipeline_executable_properties).
 *
 * A row is one stage of one pipeline, or one wave width of it if the compiler generates several.
 * Numbers that a driver does not report are NAN. `cycles` is for one wave: RADV's inverse
 * throughput, ANV's cycle count. Compilers guess the number of loop iterations, so it compares
 * shaders and does not predict the time of a frame. */
#ifndef MASU_ISA_H
#define MASU_ISA_H

#include "lab/isa/gpu.h"
#include "masu.h"

#include <stdio.h>

/* FIELD(ID, name, unit and meaning, its names in RADV, Intel's drivers, Turnip, V3DV; NULL: not
 * reported; V3DV's spills and fills are its bytes again). PanVK's numbers are read from the lines
 * that it prints. */
#define MASU_ISA_FIELDS(FIELD)                                                                     \
    FIELD(REGISTERS, "registers", "vector registers of a lane (Turnip: of four numbers)", "VGPRs", \
          NULL, "Registers used", NULL)                                                            \
    FIELD(WAVES, "waves",                                                                          \
          "waves that a SIMD (Turnip: a core; V3DV: a QPU, of 4) holds at once; PanVK: 2 of 2 if " \
          "32 registers are enough",                                                               \
          "Subgroups per SIMD", NULL, "Max Waves Per Core", "Thread Count")                        \
    FIELD(INSTRUCTIONS, "instructions", "instructions", "Instructions", "Instruction Count",       \
          "Instruction Count", "Instruction Count")                                                \
    FIELD(CYCLES, "cycles", "RADV: inverse throughput; Intel and PanVK: cycles",                   \
          "Inverse Throughput", "Cycle Count", NULL, NULL)                                         \
    FIELD(LATENCY, "latency", "cycles of one wave alone", "Latency", NULL, NULL, NULL)             \
    FIELD(SENDS, "sends", "messages to memory and samplers", NULL, "SEND Count", NULL, NULL)       \
    FIELD(SPILLS, "spills", "registers written to memory", "Spilled VGPRs", "Spill Count",         \
          "STP Count", NULL)                                                               \
    FIELD(FILLS, "fills", "and read again", NULL, "Fill Count", "LDP Count", NULL)          \
    FIELD(SCALAR_SPILLS, "scalar_spills", "scalar registers put into vector ones",                 \
          "Spilled SGPRs", NULL, NULL, NULL)                                                       \
    FIELD(SCRATCH, "scratch", "bytes of memory of a lane (Intel, V3DV: of a thread)",              \
          "Scratch size", "Scratch Memory Size", NULL, "Spill Size")                               \
    FIELD(LDS, "lds", "bytes of shared memory of a group", "LDS size", NULL, NULL, NULL)

typedef enum masu_isa_field {
#define MASU_ISA_ID(ID, ...) MASU_ISA_##ID,
    MASU_ISA_FIELDS(MASU_ISA_ID)
#undef MASU_ISA_ID
    MASU_ISA_FIELD_COUNT
} masu_isa_field;

extern const char *const masu_isa_field_names[MASU_ISA_FIELD_COUNT];

enum { MASU_ISA_ROWS = 256, MASU_ISA_TEXT = 48 };

typedef struct masu_isa_row {
    char pipeline[MASU_ISA_TEXT]; /* name from the renderer: of a pass, or "gbuffer, masks" */
    char stage[MASU_ISA_TEXT];    /* name from the driver: "Compute Shader", "SIMD16 Fragment
                                   * Shader" */
    uint32_t lanes;               /* per wave */
    double value[MASU_ISA_FIELD_COUNT];
} masu_isa_row;

typedef struct masu_isa_rows {
    uint32_t count;
    masu_isa_row row[MASU_ISA_ROWS];
    char failed[160]; /* the first failure; "": none */
} masu_isa_rows;

/* Compiles all pipelines of the plan, in a process with the GPU's environment. `desc` has a scene,
 * but no device or targets. `before` is called with the pass of the next pipelines, so that a
 * compiler crash can be attributed to it. On true the renderer and its device still exist: the
 * process must end by _Exit. On false `error` holds one line. */
bool masu_isa_compile(const masu_desc *desc, void (*before)(const char *pass), masu_isa_rows *rows,
                      char *error, size_t error_size);

/* Writes rows to a pipe: one line each, which starts with "isa\t". */
bool masu_isa_send(const masu_isa_rows *rows, FILE *f);
/* Reads rows and skips other lines, such as a driver's messages. Returns false if a line is
 * malformed. */
bool masu_isa_receive(const char *text, masu_isa_rows *rows);

/* A line of PanVK's statistics, one for each compiled shader: "SHADER-DB: MESA_SHADER_COMPUTE
 * shader: 90 inst, .., 12.5 cycles, .., 2 threads, 0 loops, 0:0 spills:fills". */
bool masu_isa_is_printed(const char *line);
/* Reads stage and numbers of such a line; what it lacks stays as it is. */
void masu_isa_read_printed(const char *line, masu_isa_row *row);

#endif
