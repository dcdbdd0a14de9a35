/* device_class.h: maps a device, by vendor and device id, to one of the GPU classes for which costs
 * are computed (docs/design/20-cost-model.md). Pure functions; cannot fail. */
#ifndef MASU_DEVICE_CLASS_H
#define MASU_DEVICE_CLASS_H

#include <vulkan/vulkan_core.h>

/* VkPhysicalDeviceProperties.vendorID: PCI ids. */
enum {
    MASU_VENDOR_AMD = 0x1002,
    MASU_VENDOR_INTEL = 0x8086,
    MASU_VENDOR_QUALCOMM = 0x5143,
    MASU_VENDOR_ARM = 0x13B5,
    MASU_VENDOR_BROADCOM = 0x14E4,
    MASU_VENDOR_IMAGINATION = 0x1010
};

typedef enum masu_device_class {
    MASU_DEVICE_OTHER, /* CPUs, and GPUs without a class */
    MASU_DEVICE_XE80,
    MASU_DEVICE_UHD620,
    MASU_DEVICE_VEGA8,
    MASU_DEVICE_DECK,
    MASU_DEVICE_MOBILE,
    MASU_DEVICE_CLASSES
} masu_device_class;

/* The class with the instruction set of the device, or with the next older one. Mali and PowerVR
 * use the class of Adreno, because no costs were computed for them. A class describes the
 * relative costs of passes, not speed: discrete GPUs with the same instruction set belong to it
 * too. */
masu_device_class masu_device_class_of(const VkPhysicalDeviceProperties *device);

/* The name in the cost model; "" for MASU_DEVICE_OTHER. Never NULL. */
const char *masu_device_class_name(masu_device_class device_class);

#endif
