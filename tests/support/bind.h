/* bind.h: masu_scene_bind under observation. The blob is bound as a copy that ends at the
 * edge of a page that may not be read, and what every call promises is checked: a refusal leaves
 * the output alone and fills a useful detail; what is accepted, a second reader agrees with. */
#ifndef SUPPORT_BIND_H
#define SUPPORT_BIND_H

#include <stddef.h>

#include "masu.h"
#include "support/blob.h"

/* Group set-up: makes the pages. */
int support_make_edge(void **state);

masu_result support_bind(const unsigned char *bytes, size_t size, masu_scene *scene,
                         masu_detail *detail);

/* Asserts that a blob is accepted. */
void support_accepted(const support_blob *blob, masu_scene *scene);

#endif
