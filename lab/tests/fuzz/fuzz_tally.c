/* fuzz_tally.c: feeds any bytes as a SPIR-V module to the cost model: the cost of its instructions,
 * with and without specialization constants, and the added counters. A module with counters must be
 * readable again. */
#include "fuzz/expect.h"

#include "lab/model/spirv_reach.h"
#include "lab/model/spirv_tally.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    size_t count = size / 4;
    uint32_t *words = malloc(count ? 4 * count : 1);
    spirv_module m, again;
    masu_tally tally;
    if (!words) return 0;
    memcpy(words, data, 4 * count);
    if (spirv_from_words(words, count, &m)) {
        const uint32_t value = 1;
        const VkSpecializationMapEntry entry = {.constantID = 0, .size = sizeof value};
        const VkSpecializationInfo special = {1, &entry, sizeof value, &value};
        masu_spirv_cost all = masu_spirv_cost_straight(&m),
                        some = masu_spirv_cost_reached(&m, NULL);
        EXPECT(masu_spirv_cost_reached(&m, &special).plain != UINT32_MAX || all.plain ||
               some.plain);
        spirv_free(&m);
    }
    if (masu_tally_make(words, count, 3, 64, &tally)) {
        EXPECT(spirv_from_words(tally.words, tally.word_count, &again));
        spirv_free(&again);
        free(tally.words);
    }
    free(words);
    return 0;
}
