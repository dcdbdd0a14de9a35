/* piece.h: pieces of a scene (an imported model, a mesh made by formula) are appended to it with a
 * placement and with what the scene changes of their materials. The scene owns what it is given; a
 * piece stays the caller's. */
#ifndef MASU_BAKE_PIECE_H
#define MASU_BAKE_PIECE_H

#include "bake/scene/content.h"

#define MASU_BAKE_MATCH 64u

/* Replaces the fields that a scene gives; zero: none. */
typedef struct masu_bake_override {
    masu_blob_material value;
    bool base_color, roughness, metallic, emissive, specular, coat, coat_roughness, meso;
    masu_bake_maps maps; /* pictures of the scene, by its own numbers */
    bool map[MASU_BAKE_MAPS], alpha, cutoff, detail, opacity, single, relief_of, shadowless, thickness, ior;
    bool unlit, depth_bias, repeat;
    /* whether the detail is of colour and emission too is given; and is so */
    bool detail_color, color_repeats;
    char name[MASU_BAKE_MATCH];  /* that the host finds it by; "": its own */
    char match[MASU_BAKE_MATCH]; /* of the material's name or its colour's picture; "": all */
} masu_bake_override;

/* Applied one after the other; the caller's. */
typedef struct masu_bake_overrides {
    masu_bake_override *items;
    size_t count;
} masu_bake_overrides;

/* Whether it is for any material of the piece. */
bool masu_bake_override_matches(const masu_bake_content *piece, const masu_bake_override *override);
bool masu_bake_overrides_equal(const masu_bake_overrides *a, const masu_bake_overrides *b);

/* Where a piece already lies in the scene, for the second and later placements with the same
 * override. Zero at first; with another override, one whose has_meshes is false again, of
 * vertices whose texture coordinates are not scaled. */
typedef struct masu_bake_residence {
    uint32_t first_vertex, first_mesh;
    bool has_vertices, has_meshes, scaled;
} masu_bake_residence;

/* Appends `piece` to `scene`: vertices and meshes where the residence says that they are
 * missing, instances every time. `prefix` goes before the instances' names; may be NULL. Returns
 * NULL or what is wrong. */
const char *masu_bake_place(masu_bake_content *scene, const masu_bake_content *piece,
                            masu_bake_residence *residence, const masu_bake_affine *placement,
                            const masu_bake_overrides *overrides, const char *prefix);

/* The same of a piece's lights, after it; those of instances stay with them. factor: of their
 * colours; 0: without them. A range of 0 becomes masu_bake_light_range's. Returns NULL or what
 * is wrong. */
const char *masu_bake_place_lights(masu_bake_content *scene, const masu_bake_content *piece,
                                   const masu_bake_affine *placement, uint32_t first_instance,
                                   double factor, const char *prefix);
#define MASU_BAKE_LIGHT_COLOR_MAX 1e9

/* Where instances go, their lights stay behind: into the piece's own space. */
void masu_bake_detach_lights(masu_bake_content *piece);
/* Where a white surface that faces a light of that colour has a radiance of a hundredth, metres. */
double masu_bake_light_range(masu_bake_vec3 color);
double masu_bake_area_range(const masu_blob_light *light);

#endif
