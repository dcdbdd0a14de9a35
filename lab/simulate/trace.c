/* trace.c: see trace.h. */
#include "lab/simulate/trace.h"

#include "image.h"

#include <stdlib.h>
#include <string.h>

#define TRACE_BYTES_MAX ((size_t)1 << 30)

bool sim_trace_parse(FILE *file, const char *path, sim_trace *out, char *error, size_t size) {
    char line[1024];
    memset(out, 0, sizeof *out);
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    snprintf(out->name, sizeof out->name, "%.*s", (int)strcspn(name, "."), name);
    bool head = true, good = true;
    double sums[SIM_TRACE_RUNGS] = {0};
    uint32_t number = 0;
    while (good && fgets(line, sizeof line, file)) {
        number++;
        if (line[0] == '#') continue;
        char *at = line + strcspn(line, ",");
        uint32_t n = 0;
        double values[SIM_TRACE_RUNGS] = {0};
        for (; *at == ',' && n < SIM_TRACE_RUNGS; n++) {
            char *end;
            values[n] = strtod(at + 1, &end);
            good = good && end != at + 1 && values[n] > 0.0 && values[n] < 1e5;
            at = end;
        }
        if (head) {
            out->columns = n;
            for (uint32_t i = 0; i < n; i++) {
                out->scale[i] = values[i];
                good = good && values[i] <= 1.0 && (!i || values[i] < values[i - 1]);
            }
        } else if (n == out->columns && out->frames < SIM_FRAMES_MOST) {
            for (uint32_t i = 0; i < n; i++) sums[i] += values[i];
            memcpy(out->ms[out->frames++], values, sizeof values);
        } else {
            good = false;
        }
        head = false;
    }
    if (!good || out->columns < 2) {
        snprintf(error, size, "%s: line %u is no row of at least 2 and at most %u times", path,
                 number, SIM_TRACE_RUNGS);
        return false;
    }
    if (out->frames < 2) {
        snprintf(error, size, "%s: at least 2 frames are needed, it has %u", path, out->frames);
        return false;
    }
    out->budget_ms = 0.5 * (sums[0] + sums[out->columns - 1]) / out->frames;
    return true;
}

bool sim_trace_read(const char *path, sim_trace *out, char *error, size_t size) {
    uint8_t *text;
    size_t bytes;
    if (!masu_file_read(path, TRACE_BYTES_MAX, &text, &bytes, error, size)) return false;
    FILE *file = fmemopen(bytes ? (void *)text : (void *)(char[1]){0}, bytes ? bytes : 1, "r");
    bool good = file && sim_trace_parse(file, path, out, error, size);
    if (!file) snprintf(error, size, "%s: out of memory", path);
    if (file) fclose(file);
    free(text);
    return good;
}

sim_model sim_of_trace(const sim_trace *trace) {
    uint32_t frames = trace->frames < SIM_FRAMES_MOST / 2 ? 2 * trace->frames : SIM_FRAMES_MOST;
    return (sim_model){trace->name, "recorded, played twice", .frames = frames, .trace = trace};
}
