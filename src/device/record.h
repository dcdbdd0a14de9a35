/* record.h: records one command buffer set: the passes of a frame in order. */
#ifndef MASU_RECORD_H
#define MASU_RECORD_H

#include "device/recorder.h"

/* sets[pass]: descriptor sets of the recorder's rung and target (masu_find_pass_sets). */
masu_result masu_record_frame(masu_recorder *rec, const VkDescriptorSet *sets, masu_detail *detail);

#endif
