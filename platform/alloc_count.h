/* alloc_count.h: how many heap allocations a process makes, and in which thread.
 *
 * A program that calls one of these functions has its malloc family replaced by counting ones
 * (glibc, no sanitizer), for itself and for every library it loads, the Vulkan driver included.
 * Used to prove that the library allocates nothing after masu_init, and to report what the driver
 * does. */
#ifndef MASU_ALLOC_COUNT_H
#define MASU_ALLOC_COUNT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

/* False where nothing can be counted: another C library, or a sanitizer that replaces malloc
 * itself. */
bool masu_alloc_counting(void);

uint64_t masu_allocs_of_thread(
    void); /* malloc, calloc, realloc, aligned: calls by this thread since it began */
uint64_t masu_allocs_of_process(void); /* the same by all threads */

/* Callbacks that count what a driver allocates through Vulkan; pass as VkAllocationCallbacks.
 * `counts` outlives every object made with them. */
typedef struct masu_vk_alloc_counts {
    atomic_uint_fast64_t allocations, reallocations, frees, live; /* drivers call from any thread */
} masu_vk_alloc_counts;

VkAllocationCallbacks masu_vk_alloc_callbacks(masu_vk_alloc_counts *counts);

#endif
