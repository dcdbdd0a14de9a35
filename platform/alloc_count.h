/* alloc_count.h: counts the heap allocations of a process, in total and per thread.
 *
 * If a program calls one of these functions, its malloc family is replaced by counting functions
 * (glibc, no sanitizer), for the program and for every library that it loads, including the Vulkan
 * driver. Used to prove that the library allocates nothing after masu_init, and to report the
 * driver's allocations. */
#ifndef MASU_ALLOC_COUNT_H
#define MASU_ALLOC_COUNT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

/* Returns false if nothing can be counted: another C library, or a sanitizer that replaces
 * malloc. */
bool masu_alloc_counting(void);

uint64_t masu_allocs_of_thread(
    void); /* malloc, calloc, realloc, aligned: calls by this thread since it started */
uint64_t masu_allocs_of_process(void); /* the same by all threads */

/* Callbacks that count a driver's allocations through Vulkan; pass them as VkAllocationCallbacks.
 * `counts` must outlive every object created with them. */
typedef struct masu_vk_alloc_counts {
    atomic_uint_fast64_t allocations, reallocations, frees, live; /* drivers call from any thread */
} masu_vk_alloc_counts;

VkAllocationCallbacks masu_vk_alloc_callbacks(masu_vk_alloc_counts *counts);

#endif
