/* device_class.c: see device_class.h. */
#include "quality/device_class.h"

#include <stddef.h>

/* Ranges of device ids. Vendors assign ids in blocks per architecture. Ids outside these ranges
 * belong to the vendor's row for all ids, its newer architectures. */
static const struct {
    uint32_t vendor, first, last;
    masu_device_class device_class;
} ranges[] = {
    {MASU_VENDOR_AMD, 0x1300, 0x131D, MASU_DEVICE_VEGA8}, /* GCN 2 to 4, APUs and cards */
    {MASU_VENDOR_AMD, 0x15D8, 0x15DD, MASU_DEVICE_VEGA8}, /* Picasso, Raven: GCN 5 */
    {MASU_VENDOR_AMD, 0x15E7, 0x15E7, MASU_DEVICE_VEGA8}, /* Barcelo */
    {MASU_VENDOR_AMD, 0x1636, 0x1638, MASU_DEVICE_VEGA8}, /* Renoir, Cezanne */
    {MASU_VENDOR_AMD, 0x164C, 0x164C, MASU_DEVICE_VEGA8}, /* Lucienne */
    {MASU_VENDOR_AMD, 0x6600, 0x66AF, MASU_DEVICE_VEGA8}, /* GCN 1 and 2; Vega 20 */
    {MASU_VENDOR_AMD, 0x6780, 0x69AF, MASU_DEVICE_VEGA8}, /* GCN 1 to 5 */
    {MASU_VENDOR_AMD, 0x7300, 0x730F, MASU_DEVICE_VEGA8}, /* Fiji */
    {MASU_VENDOR_AMD, 0x9830, 0x98FF, MASU_DEVICE_VEGA8}, /* small APUs of GCN 2 and 3 */
    {MASU_VENDOR_AMD, 0, UINT32_MAX, MASU_DEVICE_DECK},   /* RDNA */
    /* Gen 7 to 11. For the relative costs of passes, all have the same design as Gen 9. */
    {MASU_VENDOR_INTEL, 0x0100, 0x0FFF, MASU_DEVICE_UHD620},
    {MASU_VENDOR_INTEL, 0x1600, 0x1FFF, MASU_DEVICE_UHD620}, /* Broadwell, Skylake, Apollo Lake */
    {MASU_VENDOR_INTEL, 0x22B0, 0x22BF, MASU_DEVICE_UHD620}, /* Braswell */
    {MASU_VENDOR_INTEL, 0x3184, 0x3185, MASU_DEVICE_UHD620}, /* Gemini Lake */
    {MASU_VENDOR_INTEL, 0x3E90, 0x3EAF, MASU_DEVICE_UHD620}, /* Coffee Lake */
    {MASU_VENDOR_INTEL, 0x4500, 0x45FF, MASU_DEVICE_UHD620}, /* Elkhart Lake: Gen 11 */
    {MASU_VENDOR_INTEL, 0x4E00, 0x4EFF, MASU_DEVICE_UHD620}, /* Jasper Lake: Gen 11 */
    {MASU_VENDOR_INTEL, 0x5900, 0x5AFF, MASU_DEVICE_UHD620}, /* Kaby Lake, Apollo Lake */
    {MASU_VENDOR_INTEL, 0x87C0, 0x87CF, MASU_DEVICE_UHD620}, /* Amber Lake */
    {MASU_VENDOR_INTEL, 0x8A50, 0x8A7F, MASU_DEVICE_UHD620}, /* Ice Lake: Gen 11 */
    {MASU_VENDOR_INTEL, 0x9B20, 0x9BFF, MASU_DEVICE_UHD620}, /* Comet Lake */
    {MASU_VENDOR_INTEL, 0, UINT32_MAX, MASU_DEVICE_XE80},    /* Gen 12: Tiger Lake and later */
    {MASU_VENDOR_QUALCOMM, 0, UINT32_MAX, MASU_DEVICE_MOBILE},
    {MASU_VENDOR_ARM, 0, UINT32_MAX, MASU_DEVICE_MOBILE},
    {MASU_VENDOR_IMAGINATION, 0, UINT32_MAX, MASU_DEVICE_MOBILE},
};

masu_device_class masu_device_class_of(const VkPhysicalDeviceProperties *d) {
    if (d->deviceType != VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU &&
        d->deviceType != VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU)
        return MASU_DEVICE_OTHER;
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        if (ranges[i].vendor == d->vendorID && d->deviceID >= ranges[i].first &&
            d->deviceID <= ranges[i].last)
            return ranges[i].device_class;
    }
    return MASU_DEVICE_OTHER;
}

const char *masu_device_class_name(masu_device_class device_class) {
    static const char *const names[MASU_DEVICE_CLASSES] = {
        "", "Xe80", "UHD620", "Vega8", "Deck", "low mobile"};
    return (unsigned)device_class < MASU_DEVICE_CLASSES ? names[device_class] : "";
}
