/* record.c: records the frame times of a scene along its path, for `masu-lab simulate`. Each moment
 * is drawn at every scale before the next, so that other load on the machine affects all scales
 * equally. */
#include "lab/simulate/record.h"

#include "clock.h"
#include "image.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { SCALES = 4, TRIES = 2 };

/* The smaller of two times, from submit to fence. */
static bool measure(masu_session *s, uint32_t rung, double time, double *ms, char *error,
                    size_t size) {
    *ms = 1e9;
    for (uint32_t i = 0; i < TRIES; i++) {
        masu_frame_desc f = {MASU_FRAME_DESC, .time = time, .rung = rung};
        masu_commands c;
        if (masu_frame(s->m, &f, &c, &s->detail)) {
            snprintf(error, size, "%s", s->detail.text);
            return false;
        }
        uint64_t start = masu_clock_ns(NULL);
        if (!masu_headless_submit(&s->host, c.buffer, c.slot, error, size) ||
            !masu_headless_wait(&s->host, c.slot, error, size))
            return false;
        double taken = (double)(masu_clock_ns(NULL) - start) / 1e6;
        if (taken < *ms) *ms = taken;
    }
    return true;
}

static int record(masu_session *s, const masu_simulate_record *r, FILE *f) {
    char error[1024];
    double ms[SCALES];
    fprintf(f, "# %s, %" PRIu32 "x%" PRIu32 ", %s: ms from submit to fence at these scales\nframe",
            r->scene, r->size.width, r->size.height, s->host.driver);
    for (uint32_t c = 0; c < SCALES; c++) fprintf(f, ",%.4f", (double)s->desc.rungs[c].scale);
    fprintf(f, "\n");
    for (uint32_t c = 0; c < SCALES; c++) { /* drivers compile at first use */
        if (!measure(s, c, 0.0, &ms[c], error, sizeof error)) return masu_cli_error("%s", error);
    }
    for (uint32_t i = 0; i < r->frames; i++) {
        masu_cli_progress("frame %" PRIu32 " of %" PRIu32, i + 1, r->frames);
        for (uint32_t c = 0; c < SCALES; c++) {
            if (!measure(s, c, i * r->time_step, &ms[c], error, sizeof error))
                return masu_cli_error("%s", error);
        }
        fprintf(f, "%" PRIu32, i);
        for (uint32_t c = 0; c < SCALES; c++) fprintf(f, ",%.2f", ms[c]);
        fprintf(f, "\n");
    }
    return MASU_CLI_OK;
}

int masu_simulate_record_run(const masu_simulate_record *r) {
    static masu_session s;
    static const float scales[SCALES] = {1.0f, 0.8f, 0.6f, 0.4f};
    char error[1024];
    masu_session_desc d = {
        .scene_path = r->scene,
        .desc = {.output = r->size, .targets = {.storage = 1}, .rung_count = SCALES}};
    d.host = r->host;
    d.host.message = masu_print_message;
    for (uint32_t c = 0; c < SCALES; c++)
        d.desc.rungs[c] = (masu_rung){.scale = scales[c], .sharpness = c ? 0.2f : 0.0f};
    masu_cli_progress("building pipelines");
    if (!masu_file_writable(r->name, error, sizeof error) ||
        !masu_session_open(&d, &s, error, sizeof error))
        return masu_cli_error("%s", error);
    FILE *f = fopen(r->name, "w");
    int code = f ? record(&s, r, f) : masu_cli_error("%s: %s", r->name, strerror(errno));
    if (f && fclose(f) && !code) code = masu_cli_error("%s: %s", r->name, strerror(errno));
    code = masu_finish_validation(&s.host, code);
    masu_session_close(&s);
    return code;
}
