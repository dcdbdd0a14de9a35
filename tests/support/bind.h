/* bind.h: masu_scene_bind with checks around each call. The blob is bound as a copy that ends at an
 * unreadable page. Each call is checked for its contract: an error leaves the output unchanged and
 * fills in a useful detail; an accepted blob also passes an independent reader (scene_walk.h). */
#ifndef SUPPORT_BIND_H
#define SUPPORT_BIND_H

#include <stddef.h>

#include "masu.h"
#include "support/blob.h"

/* Group set-up: allocates the pages. */
int support_make_edge(void **state);

masu_result support_bind(const unsigned char *bytes, size_t size, masu_scene *scene,
                         masu_detail *detail);

/* Asserts that a blob is accepted. */
void support_accepted(const support_blob *blob, masu_scene *scene);

#endif
