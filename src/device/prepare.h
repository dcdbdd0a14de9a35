/* prepare.h: creates the pipelines and records the frames of a renderer, one step at a time:
 * masu_init runs all steps, or masu_init_step one per call (desc.init_in_steps). */
#ifndef MASU_PREPARE_H
#define MASU_PREPARE_H

#include "device/device.h"

/* Counts the steps. Layouts must exist. */
void masu_prepare_begin(masu_device *m);

/* Runs the next step: the pipelines of one pass, or all recordings of one rung. MASU_INCOMPLETE:
 * more follow. After a failure the device is good for masu_device_destroy only. */
masu_result masu_prepare_step(masu_device *m, const masu_draws *draws, masu_detail *detail);

/* The rung itself, if its recordings exist; else the next one after it that is ready, or the last
 * one before it. UINT32_MAX: none is ready. */
uint32_t masu_ready_rung(const masu_device *m, uint32_t rung);

#endif
