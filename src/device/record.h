/* record.h: one recording: the passes of a frame in their order. */
#ifndef MASU_RECORD_H
#define MASU_RECORD_H

#include "device/recorder.h"

/* sets[pass]: those of the recorder's rung and target (masu_find_pass_sets). */
masu_result masu_record_frame(masu_recorder *rec, const VkDescriptorSet *sets, masu_detail *detail);

#endif
