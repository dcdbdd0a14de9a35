/* alloc_count.c: see alloc_count.h. The counters are static, like malloc's state. */
#define _GNU_SOURCE
#include "alloc_count.h"

#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) ||                         \
    __has_feature(thread_sanitizer)
#define MASU_NO_INTERPOSER 1
#endif
#endif
#ifndef MASU_NO_INTERPOSER
#define MASU_INTERPOSER 1
#endif
#endif

static atomic_uint_fast64_t process_count;
static _Thread_local uint64_t thread_count;

bool masu_alloc_counting(void) {
#ifdef MASU_INTERPOSER
    return true;
#else
    return false;
#endif
}

uint64_t masu_allocs_of_thread(void) { return thread_count; }
uint64_t masu_allocs_of_process(void) { return atomic_load(&process_count); }

#ifdef MASU_INTERPOSER

/* glibc's names of the real functions, exported for interposers like this one. */
extern void *__libc_malloc(size_t bytes);
extern void *__libc_calloc(size_t count, size_t bytes);
extern void *__libc_realloc(void *p, size_t bytes);
extern void *__libc_memalign(size_t alignment, size_t bytes);

static void count_one(void) {
    thread_count++;
    atomic_fetch_add_explicit(&process_count, 1, memory_order_relaxed);
}

void *malloc(size_t bytes) {
    count_one();
    return __libc_malloc(bytes);
}

void *calloc(size_t count, size_t bytes) {
    count_one();
    return __libc_calloc(count, bytes);
}

void *realloc(void *p, size_t bytes) {
    count_one();
    return __libc_realloc(p, bytes);
}

void *memalign(size_t alignment, size_t bytes) {
    count_one();
    return __libc_memalign(alignment, bytes);
}

void *aligned_alloc(size_t alignment, size_t bytes) { return memalign(alignment, bytes); }

int posix_memalign(void **out, size_t alignment, size_t bytes) {
    void *p = memalign(alignment, bytes);
    if (p) *out = p;
    return p ? 0 : 12; /* ENOMEM */
}

#endif

/* ---- Vulkan callbacks ------------------------------------------------------------------------ */

/* Each block is preceded by its base and size, so that it can be reallocated and freed. */
typedef struct block_head {
    void *base;
    size_t bytes;
} block_head;

static void *VKAPI_CALL vk_allocate(void *user, size_t bytes, size_t alignment,
                                    VkSystemAllocationScope scope) {
    masu_vk_alloc_counts *counts = user;
    (void)scope;
    if (alignment < sizeof(block_head)) alignment = sizeof(block_head);
    unsigned char *base = malloc(bytes + alignment + sizeof(block_head));
    if (!base) return NULL;
    uintptr_t start =
        ((uintptr_t)base + sizeof(block_head) + alignment - 1) / alignment * alignment;
    block_head head = {base, bytes};
    memcpy((void *)(start - sizeof head), &head, sizeof head);
    counts->allocations++;
    counts->live++;
    return (void *)start;
}

static void VKAPI_CALL vk_free(void *user, void *p) {
    masu_vk_alloc_counts *counts = user;
    if (!p) return;
    block_head head;
    memcpy(&head, (unsigned char *)p - sizeof head, sizeof head);
    free(head.base);
    counts->frees++;
    counts->live--;
}

static void *VKAPI_CALL vk_reallocate(void *user, void *p, size_t bytes, size_t alignment,
                                      VkSystemAllocationScope scope) {
    masu_vk_alloc_counts *counts = user;
    if (!p) return vk_allocate(user, bytes, alignment, scope);
    if (!bytes) {
        vk_free(user, p);
        return NULL;
    }
    block_head head;
    memcpy(&head, (unsigned char *)p - sizeof head, sizeof head);
    void *grown = vk_allocate(user, bytes, alignment, scope);
    if (!grown) return NULL;
    memcpy(grown, p, head.bytes < bytes ? head.bytes : bytes);
    vk_free(user, p);
    counts->reallocations++;
    return grown;
}

VkAllocationCallbacks masu_vk_alloc_callbacks(masu_vk_alloc_counts *counts) {
    atomic_init(&counts->allocations, 0);
    atomic_init(&counts->reallocations, 0);
    atomic_init(&counts->frees, 0);
    atomic_init(&counts->live, 0);
    return (VkAllocationCallbacks){.pUserData = counts,
                                   .pfnAllocation = vk_allocate,
                                   .pfnReallocation = vk_reallocate,
                                   .pfnFree = vk_free};
}
