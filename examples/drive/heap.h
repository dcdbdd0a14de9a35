/* heap.h: see heap.c. */
#ifndef DRIVE_HEAP_H
#define DRIVE_HEAP_H

#include <stdbool.h>

extern bool heap_closed; /* from here on an allocation ends the program */

#endif
