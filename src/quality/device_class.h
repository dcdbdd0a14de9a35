/* device_class.h: which of the classes of GPUs that the project's times are computed for a device belongs to, by
 * vendor and device id (docs/design/20-cost-model.md). Pure; owns nothing, fails at nothing. */
#ifndef MASU_DEVICE_CLASS_H
#define MASU_DEVICE_CLASS_H

#include <vulkan/vulkan_core.h>

typedef enum masu_device_class {
    MASU_DEVICE_OTHER, /* CPUs, and GPUs of which no compiler was asked */
    MASU_DEVICE_XE80,
    MASU_DEVICE_UHD620,
    MASU_DEVICE_VEGA8,
    MASU_DEVICE_DECK,
    MASU_DEVICE_MOBILE,
    MASU_DEVICE_CLASSES
} masu_device_class;

/* That whose instructions are the device's, or the next older; of Mali and PowerVR no compiler was asked, they take
 * Adreno's. What counts of a class is how its passes compare with each other, not how fast it is: a discrete GPU of
 * the same instructions belongs to it, too. */
masu_device_class masu_device_class_of(const VkPhysicalDeviceProperties *device);

/* As the model sheet calls it; "": MASU_DEVICE_OTHER. Never NULL. */
const char *masu_device_class_name(masu_device_class device_class);

#endif
