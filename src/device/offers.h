/* offers.h: what the device offers and the host has not enabled, though this plan would use it: a line each to
 * the host's log, so that nothing is lost silently. Asks the driver once, in masu_init; cannot fail. */
#ifndef MASU_OFFERS_H
#define MASU_OFFERS_H

#include "device/device.h"

void masu_report_offers(const masu_device *m);

#endif
