/* piece.h: appends pieces of a scene (an imported model, a procedural mesh) with a placement and
 * with the scene's changes to their materials. The scene owns its copy; the piece remains the
 * caller's. */
#ifndef MASU_BAKE_PIECE_H
#define MASU_BAKE_PIECE_H

#include "bake/scene/content.h"

#define MASU_BAKE_MATCH 64u

/* Replaces the fields that a scene specifies; zero: none. */
typedef struct masu_bake_override {
    masu_blob_material value;
    bool base_color, roughness, metallic, emissive, specular, coat, coat_roughness, meso;
    masu_bake_maps maps; /* images of the scene, by the scene's indices */
    bool map[MASU_BAKE_MAPS], alpha, cutoff, detail, opacity, single, relief_of, shadowless,
        thickness, ior;
    bool unlit, depth_bias, repeat;
    /* whether "the detail includes colour and emission" is specified; its value */
    bool detail_color, color_repeats;
    char name[MASU_BAKE_MATCH];  /* the name for the host; "": the material's own */
    char match[MASU_BAKE_MATCH]; /* pattern for the material's name or its colour image; "": all */
} masu_bake_override;

/* Applied in order; owned by the caller. */
typedef struct masu_bake_overrides {
    masu_bake_override *items;
    size_t count;
} masu_bake_overrides;

/* True if it matches any material of the piece. */
bool masu_bake_override_matches(const masu_bake_content *piece, const masu_bake_override *override);
bool masu_bake_overrides_equal(const masu_bake_overrides *a, const masu_bake_overrides *b);

/* The position of a piece in the scene, for later placements with the same override. Zero at first.
 * For another override: a copy with has_meshes false, of vertices whose texture coordinates are not
 * scaled. */
typedef struct masu_bake_residence {
    uint32_t first_vertex, first_mesh;
    bool has_vertices, has_meshes, scaled;
} masu_bake_residence;

/* Appends `piece` to `scene`: vertices and meshes unless the residence has them already, instances
 * every time. `prefix` is put before the instances' names; may be NULL. Returns NULL or the
 * error. */
const char *masu_bake_place(masu_bake_content *scene, const masu_bake_content *piece,
                            masu_bake_residence *residence, const masu_bake_affine *placement,
                            const masu_bake_overrides *overrides, const char *prefix);

/* Appends a piece's lights, after the piece; lights of instances keep their parents. factor: of
 * their colours; 0: no lights. A range of 0 becomes masu_bake_light_range's. Returns NULL or the
 * error. */
const char *masu_bake_place_lights(masu_bake_content *scene, const masu_bake_content *piece,
                                   const masu_bake_affine *placement, uint32_t first_instance,
                                   double factor, const char *prefix);
#define MASU_BAKE_LIGHT_COLOR_MAX 1e9

/* Before instances are removed: moves their lights to the piece's own space. */
void masu_bake_detach_lights(masu_bake_content *piece);
/* The distance, in metres, at which a white surface that faces a light of that colour has a
 * radiance of 0.01. */
double masu_bake_light_range(masu_bake_vec3 color);
double masu_bake_area_range(const masu_blob_light *light);

#endif
