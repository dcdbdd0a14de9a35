/* golden.c: see golden.h. */
#include "bench/golden.h"

#include "bench/report.h"
#include "image.h"
#include "measure/picture.h"
#include "measure/rest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 128, HEIGHT = 72, STILL_FRAMES = 64 };

static bool draw_rung(const masu_sweep_desc *d, const char *name, masu_patch patches[MASU_PATCHES],
                      uint32_t *messages, char *error, size_t error_size) {
    static masu_session s; /* static: it may not move, and is large */
    masu_session_desc of =
        masu_picture_session(d->scene_path, (VkExtent2D){WIDTH, HEIGHT}, &d->host);
    of.desc.readback = MASU_READBACK_HDR;
    of.desc.rung_count = 1;
    if (!masu_setting_parse(name, &of.desc.rungs[0], error, error_size) ||
        !masu_session_open(&of, &s, error, error_size)) {
        return false;
    }
    masu_frame_desc frame = {.time = d->time, .time_step = 1.0f / 60.0f};
    bool good = masu_rest_patches(&s, frame, STILL_FRAMES, patches, error, error_size);
    masu_session_close(&s);
    *messages += s.host.messages;
    return good;
}

bool masu_golden_rungs(const masu_sweep_desc *d, const char *path, uint32_t *messages, char *error,
                       size_t error_size) {
    static masu_patch golden[MASU_PATCHES], drawn[MASU_PATCHES];
    static masu_setting_list rungs;
    char file[4096], *text = NULL;
    size_t bytes = 0;
    if (!masu_rest_load(path, golden, error, error_size) ||
        !masu_report_rungs(d->folder, &rungs, error, error_size) ||
        !masu_sweep_path(d->folder, "reference.csv", file)) {
        return false;
    }
    FILE *f = open_memstream(&text, &bytes);
    bool good = f && fprintf(f, "setting,mean_ratio,patch_p95,patch_z2,patch_worst\n") > 0;
    for (uint32_t i = 0; i < rungs.count && good; i++) {
        if (d->progress) d->progress("rungs at rest against the reference");
        good = draw_rung(d, rungs.id[i], drawn, messages, error, error_size);
        if (!good) break;
        const masu_patch_judgement j = masu_patches_judge(golden, drawn);
        good = fprintf(f, "%s,%.6g,%.6g,%.6g,%.6g\n", rungs.id[i], j.ratio, j.p95, j.trimmed,
                       j.worst_by) > 0;
    }
    const bool closed = f && !fclose(f);
    good = good && closed && masu_file_write(file, text, bytes, error, error_size);
    free(text);
    return good;
}
