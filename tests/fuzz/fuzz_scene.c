/* fuzz_scene.c: any bytes as a scene blob. Bound as they are, and again with length and hash made
 * to fit, since a fuzzer will not guess those. What is refused must be refused properly; what is
 * accepted is read to the last byte by a second reader, and compiled to a frame. */
#include "expect.h"

#include "scene/blob.h"
#include "plan/compile.h"
#include "reference/scene_walk.h"

static void check_refusal(masu_result result, const masu_detail *detail, const masu_scene *scene) {
    masu_scene untouched;
    memset(&untouched, 0x5A, sizeof untouched);
    EXPECT(result == MASU_ERROR_SCENE || result == MASU_ERROR_VERSION);
    EXPECT(detail->result == result && detail->what && *detail->what);
    EXPECT(memchr(detail->text, '\0', sizeof detail->text) && *detail->text);
    EXPECT(!strchr(detail->text, '\n'));
    EXPECT(!memcmp(scene, &untouched, sizeof untouched));
}

static void check_frame(const masu_scene *scene) {
    static masu_frame_plan plan;
    VkImage image = (VkImage)(uintptr_t)1;
    VkImageView view = (VkImageView)(uintptr_t)1;
    masu_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.bytes = sizeof desc;
    desc.scene = scene;
    desc.output = (VkExtent2D){64, 64};
    desc.targets = (masu_targets){.images = &image, .views = &view, .count = 1, .storage = 1};
    EXPECT(masu_compile(&desc, 256, 256, &plan, NULL) == MASU_OK);
    EXPECT(plan.buffers[MASU_BUFFER_VERTICES].bytes <= masu_scene_data_of(scene)->blob_bytes);
    EXPECT(plan.buffers[MASU_BUFFER_INDICES].bytes <= masu_scene_data_of(scene)->blob_bytes);
}

static void bind(const uint8_t *blob, size_t size) {
    masu_scene scene;
    masu_detail detail;
    memset(&scene, 0x5A, sizeof scene);
    memset(&detail, 0, sizeof detail);
    masu_result result = masu_scene_bind(blob, size, &scene, &detail);
    if (result) {
        check_refusal(result, &detail, &scene);
        return;
    }
    const char *fault = masu_ref_walk_scene(&scene);
    if (fault) expected(__FILE__, __LINE__, fault);
    check_frame(&scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint8_t *blob = calloc(size ? size : 1, 1); /* 16-byte aligned, and exactly as long */
    if (!blob) return 0;
    if (size) memcpy(blob, data, size);
    bind(blob, size);
    masu_blob_header header;
    if (size >= sizeof header) {
        memcpy(&header, blob, sizeof header);
        header.bytes = size;
        header.hash = masu_fnv1a64(blob + sizeof header, size - sizeof header);
        memcpy(blob, &header, sizeof header);
        bind(blob, size);
    }
    free(blob);
    return 0;
}
