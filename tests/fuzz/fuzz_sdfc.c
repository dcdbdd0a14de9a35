/* fuzz_sdfc.c: any bytes as an SDF scene. A refusal has a message that names the place; what is
 * accepted comes with everything that the result promises, and the same again the second time. */
#include "expect.h"

#include "sdfc/sdfc.h"

static void check_result(const masu_sdfc_result *r) {
    EXPECT(r->glsl && r->c && r->table && r->warnings);
    EXPECT(r->block_words <= MASU_SDFC_BLOCK_WORDS_MAX);
    EXPECT(r->part_count >= 1 && r->part_count <= MASU_SDFC_PARTS_MAX);
    EXPECT(r->slot_count >= r->part_count * MASU_SDFC_PART_SLOTS);
    EXPECT(r->slot_count <= MASU_SDFC_SLOTS_MAX);
    for (uint32_t i = 0; i < r->slot_count; i++) EXPECT(r->slots[i] - r->slots[i] == 0);
    for (uint32_t i = 0; i < r->part_count; i++) {
        const masu_sdfc_part *p = &r->parts[i];
        EXPECT(p->shape < r->shape_count && p->material < r->material_count);
        EXPECT(p->slot_base <= r->slot_count && p->lipschitz > 0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const masu_sdfc_options options = {.pairs = 16};
    masu_sdfc_result result, again;
    char error[1024], error_again[1024];
    bool good = masu_sdfc_compile_with((const char *)data, size, "x.sdf", &options, &result, error,
                                       sizeof error);
    bool same = masu_sdfc_compile_with((const char *)data, size, "x.sdf", &options, &again,
                                       error_again, sizeof error_again);
    EXPECT(good == same);
    if (good) {
        check_result(&result);
        EXPECT(!strcmp(result.glsl, again.glsl) && !strcmp(result.c, again.c));
    } else {
        EXPECT(!strncmp(error, "x.sdf:", 6) && !strcmp(error, error_again));
        EXPECT(!result.glsl && !result.slots);
    }
    masu_sdfc_release(&result);
    masu_sdfc_release(&again);
    return 0;
}
