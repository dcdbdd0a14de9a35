/* fuzz_suite.c: any bytes as a suite of `masu conform`. A refusal is one line that names the file; each case of
 * what is accepted can be named, found again by that name, and chosen. */
#include "expect.h"

#include "conform/suite.h"

static void check(const masu_suite *suite) {
    char token[256], error[1024] = "";
    bool *marks = calloc(suite->count + 1, sizeof *marks);
    EXPECT(marks);
    for (uint32_t i = 0; i < suite->count && i < 16; i++) {
        const masu_case *c = &suite->cases[i];
        EXPECT(c->name && *c->name && c->width && c->height);
        if (!masu_replay_token(suite, c, token, sizeof token)) continue;
        EXPECT(masu_replay_find(suite, token, error, sizeof error) == (int32_t)i);
    }
    EXPECT(masu_suite_select(suite, NULL, 0, 1, marks) == suite->count);
    EXPECT(masu_suite_select(suite, "*[a-", 0, 1, marks) <= suite->count);
    free(marks);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    masu_suite suite;
    char error[1024] = "";
    if (masu_suite_parse("x.json", (const char *)data, size, &suite, error, sizeof error)) {
        check(&suite);
    } else {
        EXPECT(!strncmp(error, "x.json:", 7) && !strchr(error, '\n'));
        EXPECT(!suite.cases && !suite.root);
    }
    masu_suite_free(&suite);
    return 0;
}
