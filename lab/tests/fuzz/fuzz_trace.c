/* fuzz_trace.c: feeds any bytes as a trace to `masu-lab simulate`. An accepted trace has falling
 * scales and times that a controller can run on. */
#include "fuzz/expect.h"

#include "lab/simulate/trace.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static sim_trace trace;
    char error[512] = "", nothing = '\n';
    FILE *f = fmemopen(size ? (void *)(uintptr_t)data : &nothing, size ? size : 1, "r");
    EXPECT(f);
    bool good = sim_trace_parse(f, "folder/x.csv", &trace, error, sizeof error);
    fclose(f);
    if (!good) {
        EXPECT(!strncmp(error, "folder/x.csv: ", 14) && !strchr(error, '\n'));
        return 0;
    }
    EXPECT(!strcmp(trace.name, "x"));
    EXPECT(trace.columns >= 2 && trace.columns <= SIM_TRACE_RUNGS);
    EXPECT(trace.frames >= 2 && trace.frames <= SIM_FRAMES_MOST);
    EXPECT(trace.budget_ms > 0.0 && trace.budget_ms < 1e5);
    for (uint32_t i = 0; i < trace.columns; i++)
        EXPECT(trace.scale[i] > 0.0 && trace.scale[i] <= 1.0 &&
               (!i || trace.scale[i] < trace.scale[i - 1]));
    sim_model model = sim_of_trace(&trace);
    sim_result r = sim_run(&model, &sim_masu, 1, NULL, NULL);
    EXPECT(!r.invalid && r.mean_scale > 0.0);
    return 0;
}
