/* push.h: the push constants of a pass. */
#ifndef MASU_PUSH_H
#define MASU_PUSH_H

#include "device/recorder.h"

/* All that a compute pass, or one that draws one triangle over everything, is told. */
struct masu_push masu_push_constants(const masu_recorder *rec, uint32_t pass);
/* What a pass that draws polygons starts from: the size, and with `biased` the bias of mips. */
struct masu_push masu_push_draw(const masu_recorder *rec, int biased);

#endif
