/* record.h: all command buffers of a renderer. */
#ifndef MASU_RECORD_H
#define MASU_RECORD_H

#include "device/device.h"

/* Descriptor sets, queries, recordings of frames and of loading; pipelines come before. */
masu_result masu_record(masu_device *m, const masu_draws *draws, masu_detail *detail);

/* The frames once more, as plan and targets are by now, on an idle device; all that is loaded stays. On
 * failure some are not whole: none may be submitted. */
masu_result masu_record_again(masu_device *m, const masu_draws *draws, masu_detail *detail);

#endif
