/* motion.c: see motion.h. */
#include "measure/motion.h"

#include "settings/setting.h"

#include <stdio.h>

bool masu_motion_frame(masu_session *s, uint32_t rung, double time, double step, bool cut,
                       masu_commands *commands, char *error, size_t error_size) {
    masu_camera camera;
    if (masu_camera_at(s->m, time, &camera, NULL)) {
        snprintf(error, error_size, "the scene has no camera");
        return false;
    }
    masu_frame_desc frame = {
        .camera = &camera, .time = time, .time_step = (float)step, .rung = rung, .cut = cut};
    return masu_session_frame(s, &frame, true, commands, error, error_size);
}

/* Cascade k is rendered in frames n with n + k divisible by its refresh period. */
bool masu_motion_draw(masu_session *s, const masu_motion *motion, uint32_t rung,
                      const masu_rung *knobs, uint64_t *next, char *error, size_t error_size) {
    uint32_t period = masu_setting_period(knobs);
    bool remembers = motion->remembers || masu_setting_remembers(knobs) || period > 1;
    uint32_t frames = remembers ? motion->frames : 1;
    masu_commands commands = {0};
    if (period > 1 && frames < period) frames = period;
    while (period > 1 && (*next + frames) % period) frames++;
    for (uint32_t k = 0; k < frames; k++) {
        double time = motion->time - (double)(frames - 1 - k) * motion->step;
        if (!masu_motion_frame(s, rung, time, motion->step, k == 0, &commands, error, error_size))
            return false;
    }
    *next = commands.frame + 1;
    return true;
}
