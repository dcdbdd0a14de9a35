/* fuzz_ladder.c: any bytes as ladder.json. A refusal is one line that names the file; what is accepted are rungs in
 * order that the library's own checks take, and texts that can stand in a comment of C. */
#include "expect.h"

#include "settings/ladder_file.h"

static void check_text(const char *text, size_t room) {
    EXPECT(memchr(text, '\0', room));
    for (; *text; text++) EXPECT((unsigned char)*text >= ' ' && !strchr("\"\\*?", *text));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static masu_ladder_file ladder;
    char error[1024] = "";
    if (!masu_ladder_parse("x.json", (const char *)data, size, &ladder, error, sizeof error)) {
        EXPECT(!strncmp(error, "x.json", 6) && !strchr(error, '\n'));
        return 0;
    }
    EXPECT(ladder.count >= 1 && ladder.count <= MASU_MAX_RUNGS);
    check_text(ladder.scene, sizeof ladder.scene);
    check_text(ladder.driver, sizeof ladder.driver);
    for (uint32_t i = 0; i < ladder.count; i++) {
        check_text(ladder.settings[i], sizeof ladder.settings[i]);
        EXPECT(ladder.ratios[i] > 0.0 && (!i || ladder.ratios[i] < ladder.ratios[i - 1]));
        EXPECT(ladder.flips[i] >= 0.0);
    }
    masu_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.bytes = sizeof desc;
    masu_ladder_give(&ladder, &desc);
    EXPECT(desc.rung_count == ladder.count);
    return 0;
}
