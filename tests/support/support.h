/* support.h: shared code of the GPU tests: sessions under the validation layer, renderers on their
 * devices, readback of a frame's images, and comparisons.
 *
 * Every session validates (core and synchronisation); a message fails the test that closes it. The
 * environment selects the driver: tests/run.sh runs each program once per driver. */
#ifndef MASU_TEST_SUPPORT_H
#define MASU_TEST_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "session.h"

#define ERROR_SIZE 1024u
#define MEMORY_ROWS 256u /* capacity for a masu_memory_report */

/* $MADE/scenes/NAME.masu; static storage, four names at a time. */
const char *scene_path(const char *name);

/* A description with validation, counters and a storage target. scene may be NULL. */
masu_session_desc test_desc(const char *scene, uint32_t width, uint32_t height);

/* Opens, asserting success. Closes, asserting that the layer was active and reported nothing. */
void open_session(masu_session *s, const masu_session_desc *d);
void close_session(masu_session *s);

/* Renders one frame and waits for it. pixels (width * height * 4 bytes) may be NULL. */
void draw(masu_session *s, const masu_frame_desc *frame, masu_commands *commands, uint8_t *pixels);
/* The same with only a rung. */
void draw_rung(masu_session *s, uint32_t rung, uint8_t *pixels);

/* All rows of the renderer's memory report, asserting that they fit. Returns their number. */
uint32_t memory_rows(const masu_renderer *m, masu_memory_row rows[MEMORY_ROWS]);

/* An image of the frame in this slot, without padding between rows; valid until the slot's next
 * frame. */
const void *read_image(const masu_session *s, uint32_t slot, masu_readback_bits which);
/* draw and read_image. */
const void *draw_image(masu_session *s, const masu_frame_desc *frame, masu_readback_bits which,
                       uint8_t *pixels);
/* Converts a depth image to view depths, 0 where no surface is. */
void view_depths(const void *depth, const masu_camera *camera, float *out, size_t pixels);
masu_stats_info stats_of(const masu_session *s, uint32_t slot);

/* Sets the transform of an instance, which must exist: by a matrix, or unrotated by position and
 * size. */
void place_instance(masu_session *s, const char *name, const float rows[12]);
void move_instance(masu_session *s, const char *name, float x, float y, float z, float size);

/* Decodes a texel of MASU_READBACK_OCCLUSION: visibility of the sun and of ambient light. */
static inline double sun_share(const uint32_t *occlusion, uint32_t pixel) {
    return (occlusion[pixel] & 0xFFFF) / 65535.0;
}
static inline double ambient_share(const uint32_t *occlusion, uint32_t pixel) {
    return (occlusion[pixel] >> 16) / 65535.0;
}

/* The row of a pass, which must exist. */
const masu_plan_pass *pass_of(const masu_plan_info *plan, const char *name);

/* Opens a device without a renderer, for tests that create their own. */
void open_device(masu_session *s);

/* Whether the device is a GPU. Tests use it to run on GPUs and on the software drivers of CI. A GPU
 * divides, takes roots and filters within the errors that Vulkan allows (2.5 ulp, 3 ulp, 1/256
 * between texels), and keeps its scene in memory that the host cannot access. */
bool on_gpu(const masu_session *s);
void skip_unless_host_sees_all_memory(void); /* opens and closes a device */

/* Runs masu_load to its end, with all of its parts. Returns their number. */
uint32_t load_all(masu_session *s, masu_renderer *m);

/* Host memory aligned for masu_init; free(). */
void *host_block(uint64_t bytes);

/* A second renderer on the device of a session, loaded, with one target of size d->output. */
typedef struct own_renderer {
    masu_renderer *m;
    void *block;
    masu_headless_target target;
} own_renderer;
void make_target(masu_session *s, own_renderer *x, uint32_t width, uint32_t height, int storage);
void make_own(masu_session *s, own_renderer *x, const masu_desc *d);
void unmake_own(masu_session *s, own_renderer *x);

/* Renders one frame with each rung of such a renderer: pixels to out[rung], statistics to
 * stats[rung] unless stats is NULL. */
void draw_rungs_of(masu_session *s, const masu_desc *d, uint8_t *const *out,
                   masu_stats_info *stats);

/* Largest difference of any byte. */
uint32_t max_difference(const uint8_t *a, const uint8_t *b, size_t bytes);

#define assert_ok(call)                                                                            \
    do {                                                                                           \
        if (!(call)) fail_msg("%s: %s", #call, error);                                             \
    } while (0)

#endif
