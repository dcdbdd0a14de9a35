/* groups.h: the tree of groups for culling.
 *
 * During baking, an instance's `group` is a tag: MASU_BLOB_NONE, MASU_BAKE_MOVING, or the index of
 * a group that the scene names. Named groups are in the GROUPS section with their full path as name
 * and their parent in `reserved`. masu_bake_groups converts all this to the final tree. */
#ifndef MASU_BAKE_GROUPS_H
#define MASU_BAKE_GROUPS_H

#include "bake/scene/content.h"

#define MASU_BAKE_MOVING 0xFFFFFFFEu /* moves in every frame: in no group */
#define MASU_BAKE_GROUP_LEVELS 8u    /* of a path */

/* True if "outer/inner" has 1 to MASU_BAKE_GROUP_LEVELS names. */
bool masu_bake_group_path(const char *path);
/* The tag of such a path, with its outer groups added as needed. */
uint32_t masu_bake_group(masu_bake_content *content, const char *path);

/* Builds the tree over the instances, which must be sorted by mesh. */
void masu_bake_groups(masu_bake_content *content);

#endif
