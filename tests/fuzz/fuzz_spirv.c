/* fuzz_spirv.c: any bytes as a SPIR-V module, for what reads modules: masu_scene_bind, and the
 * loads of whole vectors. A module with whole vectors can be read again. */
#include "expect.h"

#include "scene/code.h"
#include "spirv/spirv.h"
#include "spirv/whole_vectors.h"

static void read_again(uint32_t *words, size_t count) {
    spirv_module m;
    EXPECT(spirv_from_words(words, count, &m));
    spirv_free(&m);
    free(words);
}

/* Where a record is put in is where it is found. */
static void read_as_bind_does(const uint32_t *words, size_t count) {
    masu_module m, again;
    uint64_t at = 0;
    const char *problem = masu_module_read(words, count, &m, &at);
    EXPECT(at <= count && (!problem || *problem));
    if (problem) return;
    EXPECT(m.bound_count <= MASU_MODULE_BOUND_MAX && m.push_bytes <= 128);
    size_t place = (size_t)masu_module_record_place(words, count);
    uint32_t *with = calloc(count + MASU_MODULE_RECORD_WORDS, sizeof *with);
    EXPECT(with && place < count);
    memcpy(with, words, 4 * place);
    with[place] = MASU_MODULE_RECORD_FIRST;
    masu_module_record(&(masu_module_counts){.kind = 11}, (char *)(with + place + 1));
    memcpy(with + place + MASU_MODULE_RECORD_WORDS, words + place, 4 * (count - place));
    EXPECT(!masu_module_read(with, count + MASU_MODULE_RECORD_WORDS, &again, &at));
    EXPECT(again.record && (m.record || again.record == with + place));
    free(with);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    size_t count = size / 4, changed = 0;
    uint32_t *words = malloc(count ? 4 * count : 1);
    spirv_module m;
    if (!words) return 0;
    memcpy(words, data, 4 * count);
    read_as_bind_does(words, count);
    if (spirv_from_words(words, count, &m)) {
        for (uint32_t id = 0; id < 8; id++) EXPECT(strlen(spirv_name(&m, id)) < size);
        spirv_free(&m);
    }
    uint32_t *whole = masu_whole_vectors(words, count, &changed);
    if (whole) read_again(whole, changed);
    free(words);
    return 0;
}
