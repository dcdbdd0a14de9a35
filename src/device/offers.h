/* offers.h: logs each feature that the device supports, this plan would use and the host has not
 * enabled, one line per feature. Queries the driver once, in masu_init; cannot fail. */
#ifndef MASU_OFFERS_H
#define MASU_OFFERS_H

#include "device/device.h"

void masu_report_offers(const masu_device *m);

#endif
