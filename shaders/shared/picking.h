/* picking.h: the result of pick_tell for the host: kind, instance number, depth (near / view z),
 * xyz camera-relative position. */
#ifndef MASU_SHARED_PICKING_H
#define MASU_SHARED_PICKING_H

#define MASU_PICKED_SKY 1u
#define MASU_PICKED_SDF 2u
#define MASU_PICKED_INSTANCE 3u
#define MASU_PICKED_WORDS 6
#define MASU_PICK_BLENDED 0x80000000u /* in PICK_ID: a transparent surface */

#endif
