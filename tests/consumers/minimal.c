/* minimal.c: the smallest program that uses an installed Masu; C and C++ at once. It links nothing
 * but what masu.pc says, so it also shows that the library needs no Vulkan loader. It asks for
 * something that cannot work (no device) and wants a clear answer instead of a crash. Built and run
 * by tests/scripts/install.sh, which compares the line it prints with the version in masu.pc. */
#include <masu.h>

#include <stdio.h>
#include <string.h>

int main(void) {
    masu_desc desc;
    masu_memory need;
    masu_detail detail;
    memset(&desc, 0, sizeof desc);
    desc.bytes = sizeof desc;
    memset(&detail, 0, sizeof detail);
    masu_result result = masu_memory_query(&desc, &need, &detail);
    if (result != MASU_ERROR_ARGUMENT || detail.result != result || !detail.text[0]) {
        printf("an empty description gives %s (%s)\n", masu_result_string(result), detail.text);
        return 1;
    }
    printf("masu %d.%d.%d: %s\n", MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH,
           masu_result_string(MASU_OK));
    return 0;
}
