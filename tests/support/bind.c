/* bind.c: see bind.h. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "support/bind.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

#include "reference/scene_walk.h"
#include "scene/scene.h"

static unsigned char *edge; /* the first byte that may not be read */
static size_t page_bytes;

int support_make_edge(void **state) {
    (void)state;
    page_bytes = (size_t)sysconf(_SC_PAGESIZE);
    size_t room = (SUPPORT_BLOB_ROOM + page_bytes - 1) / page_bytes * page_bytes;
    unsigned char *map =
        mmap(NULL, room + page_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (map == MAP_FAILED) return -1;
    edge = map + room;
    return mprotect(edge, page_bytes, PROT_NONE);
}

/* As close to the edge as the 16-byte alignment allows. */
static const unsigned char *at_the_edge(const unsigned char *bytes, size_t size) {
    unsigned char *to = edge - (size + MASU_BLOB_ALIGN - 1) / MASU_BLOB_ALIGN * MASU_BLOB_ALIGN;
    memset(to, 0xEE, (size_t)(edge - to));
    memcpy(to, bytes, size);
    return to;
}

masu_result support_bind(const unsigned char *bytes, size_t size, masu_scene *scene,
                         masu_detail *detail) {
    masu_scene untouched;
    memset(scene, 0x5A, sizeof *scene);
    memset(&untouched, 0x5A, sizeof untouched);
    memset(detail, 0x5A, sizeof *detail);
    const unsigned char *at = at_the_edge(bytes, size);
    masu_result result = masu_scene_bind(at, size, scene, detail);
    if (result) {
        assert_true(result == MASU_ERROR_SCENE || result == MASU_ERROR_VERSION);
        assert_memory_equal(scene, &untouched, sizeof untouched);
        assert_int_equal(detail->result, result);
        assert_int_equal(detail->vulkan, VK_SUCCESS);
        assert_non_null(memchr(detail->text, '\0', sizeof detail->text));
        assert_true(strlen(detail->text) > 10 && !strchr(detail->text, '\n'));
        assert_int_equal(masu_scene_bind(at, size, scene, NULL), result);
    } else {
        assert_ptr_equal(masu_scene_data_of(scene)->blob, at);
        assert_int_equal(masu_scene_data_of(scene)->blob_bytes, size);
        const char *fault = masu_ref_walk_scene(scene);
        if (fault) fail_msg("accepted, but %s", fault);
    }
    return result;
}

void support_accepted(const support_blob *blob, masu_scene *scene) {
    masu_detail detail;
    if (support_bind(blob->bytes, blob->size, scene, &detail))
        fail_msg("rejected: %s", detail.text);
}
