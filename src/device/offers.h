/* offers.h: the optional features that the physical device supports. masu_device_query returns them
 * before the device exists; masu_init logs each one that this plan would use and the host has not
 * enabled, one line per feature. */
#ifndef MASU_OFFERS_H
#define MASU_OFFERS_H

#include "device/device.h"

/* MASU_FEATURE_*: those that the device supports with all their extensions. `vk` after
 * masu_vk_load_physical. */
uint32_t masu_query_offers(const masu_vk *vk, PFN_vkGetInstanceProcAddr get_instance_proc_addr);
/* Sets extensions and extension_count of `out` to what `out->used` and Vulkan 1.0 need. */
void masu_list_extensions(const masu_vk *vk, masu_device_info *out);

void masu_report_offers(const masu_device *m); /* cannot fail */

#endif
