/* check_looks.c: validates materials (without textures), the camera path, the sun and its shadow,
 * local lights, probes, sky and fog. */
#include "scene/check.h"

#include "scene/material.h"
#include "scene/punctual_light.h"

#include <string.h>

static masu_result check_colors(reader *r) {
    const masu_scene_view *v = &r->view;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MATERIALS]; i++) {
        const masu_blob_material *m = &v->materials[i];
        if (!within(m->base_color, 3, 0.0f, 1.0f) || !within(&m->roughness, 1, 0.0f, 1.0f) ||
            !within(&m->metallic, 1, 0.0f, 1.0f) || !within(m->emissive, 3, 0.0f, 1e9f)) {
            return bad(r, "materials", i, "a value is out of range");
        }
        if (!name_ok(r, m->name)) return bad(r, "materials", i, "name lies outside the names");
    }
    return MASU_OK;
}

static masu_result check_path(reader *r) {
    const masu_scene_view *v = &r->view;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_CAMERA_KEYS]; i++) {
        const masu_blob_camera_key *k = &v->camera_keys[i];
        /* The same ranges as in masu_frame, so that the whole path can be rendered. */
        if (!within(&k->time, 1, -1e15f, 1e15f) || !within(k->position, 3, -1e15f, 1e15f) ||
            !within(k->target, 3, -1e15f, 1e15f)) {
            return bad(r, "camera keys", i, "is not finite or beyond 1e15");
        }
        if (!(k->fov_y >= 0.0005f && k->fov_y <= 3.1f)) {
            return bad(r, "camera keys", i, "field of view is not 0.0005 to 3.1 radians");
        }
        /* Compared as numbers, because -0 equals 0. */
        if (k->position[0] == k->target[0] && k->position[1] == k->target[1] &&
            k->position[2] == k->target[2]) {
            return bad(r, "camera keys", i, "position and target are the same");
        }
        if (i && !(k->time > v->camera_keys[i - 1].time)) {
            return bad(r, "camera keys", i, "time does not rise");
        }
    }
    return MASU_OK;
}

static masu_result check_sun(reader *r) {
    const masu_blob_environment *e = r->view.environment;
    if (!e) return bad(r, "environment", 0, "is missing");
    float sun = e->sun_direction[0] * e->sun_direction[0] +
                e->sun_direction[1] * e->sun_direction[1] +
                e->sun_direction[2] * e->sun_direction[2];
    if (!(sun > 0.98f && sun < 1.02f))
        return bad(r, "environment", 0, "sun direction is no unit vector");
    if (!within(e->sun_color, 3, 0.0f, 1e9f) || !within(e->ambient, 3, 0.0f, 1e9f) ||
        !within(e->sky_zenith, 3, 0.0f, 1e9f) || !within(e->sky_horizon, 3, 0.0f, 1e9f) ||
        !within(&e->exposure, 1, 1e-9f, 1e9f) || !within(&e->near_distance, 1, 1e-9f, 1e9f)) {
        return bad(r, "environment", 0, "a value is out of range");
    }
    return MASU_OK;
}

static masu_result check_shadow(reader *r) {
    const masu_blob_shadow *s = r->view.shadow;
    if (!s) return MASU_OK;
    if (s->cascades < 1 || s->cascades > MASU_SHADOW_CASCADES_MAX)
        return bad(r, "shadow", 0, "cascades are not 1 to 4");
    if (s->resolution < MASU_SHADOW_SIZE_MIN || s->resolution > MASU_SHADOW_SIZE_MAX)
        return bad(r, "shadow", 0, "resolution is not 16 to 8192");
    if (!within(&s->distance, 1, 1e-3f, 1e9f))
        return bad(r, "shadow", 0, "distance is not 0.001 to 1e9 m");
    if (!within(&s->lambda, 1, 0.0f, 1.0f)) return bad(r, "shadow", 0, "lambda is not 0 to 1");
    return MASU_OK;
}

/* Numbers of lobes; the G-buffer has room for one kind, in the place of coats and reliefs. */
static int lobes_fit(const masu_blob_material *m) {
    const float *hue = m->specular_color, *sheen = m->sheen_color;
    if (!within(hue, 3, 0.0f, 1.0f) || !within(sheen, 3, 0.0f, 1.0f) ||
        !within(&m->sheen_roughness, 1, 0.0f, 1.0f) || !within(&m->anisotropy, 1, 0.0f, 1.0f) ||
        !within(&m->anisotropy_rotation, 1, 0.0f, 6.2832f))
        return 0;
    if (masu_is_colored(hue) && !(hue[0] == 1.0f || hue[1] == 1.0f || hue[2] == 1.0f)) return 0;
    int colored = m->specular > 1.0f || masu_is_colored(hue);
    int shines = sheen[0] > 0.0f || sheen[1] > 0.0f || sheen[2] > 0.0f,
        grained = m->anisotropy > 0.0f;
    if (shines && m->specular != 0.5f) return 0;
    if (masu_lobe_code(m) && (m->coat > 0.0f || m->meso != MASU_BLOB_NONE)) return 0;
    return colored + shines + grained <= 1;
}

static masu_result check_material(reader *r, uint64_t i) {
    const masu_blob_material *m = &r->view.materials[i];
    if (!within(&m->specular, 1, 0.0f, 12.5f) || !within(&m->coat, 1, 0.0f, 1.0f) ||
        !within(&m->coat_roughness, 1, 0.0f, 1.0f) || !within(&m->opacity, 1, 0.0f, 1.0f)) {
        return bad(r, "materials", i, "a value is out of range");
    }
    if (!within(m->detail, 2, 1e-3f, 1e4f))
        return bad(r, "materials", i, "detail is not 0.001 to 10000");
    if (m->meso != MASU_BLOB_NONE && m->meso >= r->counts[MASU_BLOB_MESO])
        return bad(r, "materials", i, "no such meso");
    if (!within(&m->depth_bias, 1, -0.01f, 0.01f))
        return bad(r, "materials", i, "depth bias is not -0.01 to 0.01");
    if (!lobes_fit(m)) return bad(r, "materials", i, "a lobe is out of range, or not the only one");
    uint32_t blends = m->flags & MASU_MATERIAL_IS_BLEND;
    if (blends && m->flags & MASU_MATERIAL_IS_TINTED && m->flags & MASU_MATERIAL_IS_ADDITIVE)
        return bad(r, "materials", i, "is tinted, but hides nothing");
    if (m->flags & MASU_MATERIAL_TRANSMISSION_MAP &&
        (!blends || !(m->flags & MASU_MATERIAL_IS_TINTED)))
        return bad(r, "materials", i, "has a map of transmission, but transmits nothing");
    if (!within(&m->thickness, 1, 0.0f, 65504.0f) ||
        !(m->thickness > 0.0f ? m->ior >= 1.0f && m->ior <= 1000.0f : m->ior == 0.0f))
        return bad(r, "materials", i, "thickness is not 0 to 65504, or ior not 1 to 1000");
    if (m->thickness > 0.0f && (!blends || !(m->flags & MASU_MATERIAL_IS_TINTED) ||
                                m->flags & MASU_MATERIAL_HAS_METAL || m->metallic > 0.0f))
        return bad(r, "materials", i, "has a thickness, but is not tinted, or is a metal");
    if (!blends && m->flags & MASU_MATERIAL_LOBE_MAP &&
        (!(m->flags & 1u << MASU_SLOT_COAT) || masu_lobe_code(m) >> 21 == MASU_LOBE_GRAIN))
        return bad(r, "materials", i, "has no lobe, or no map of it");
    if (!blends && m->flags & MASU_MATERIAL_COAT_RELIEF &&
        (!(m->flags & MASU_MATERIAL_COAT_SMOOTH) || m->flags & 1u << MASU_SLOT_EMISSIVE))
        return bad(r, "materials", i,
                   "has no coat whose relief it could be, or emission in its place");
    if (m->flags & MASU_MATERIAL_COAT_SMOOTH && m->flags & MASU_MATERIAL_BASE_SMOOTH)
        return bad(r, "materials", i, "has a relief, but neither coat nor base has it");
    if (!(m->flags & MASU_MATERIAL_IS_BLEND) && m->opacity != 1.0f)
        return bad(r, "materials", i, "is not blended, but not opaque");
    return MASU_OK;
}

/* Checks the ranges of a light state, which a host may also set at run time, and the fields that
 * only the blob has. */
static masu_result check_light(reader *r, uint64_t i) {
    const masu_blob_light *l = &r->view.lights[i];
    double value;
    uint32_t type = l->type & MASU_LIGHT_TYPE, flags = l->type & ~(uint32_t)MASU_LIGHT_TYPE;
    if (type > MASU_LIGHT_RECTANGLE) return bad(r, "lights", i, "no such type");
    if (flags & ~(uint32_t)(MASU_LIGHT_NO_SHADOW | MASU_LIGHT_TWO_SIDED | MASU_LIGHT_SURFACE))
        return bad(r, "lights", i, "unknown flags");
    if (l->reserved) return bad(r, "lights", i, "reserved is not 0");
    masu_punctual_light_state state = masu_light_state_of(l);
    const char *wrong = masu_light_state_wrong(&state, &value);
    if (wrong) return bad(r, "lights", i, wrong);
    if (type == MASU_LIGHT_SPOT && !unit_vector(l->direction))
        return bad(r, "lights", i, "direction is no unit vector");
    if (type != MASU_LIGHT_SPOT && (l->inner != 0.0f || l->outer != 0.0f))
        return bad(r, "lights", i, "is no spot, but has angles");
    if (l->parent != MASU_BLOB_NONE && l->parent >= r->counts[MASU_BLOB_INSTANCES])
        return bad(r, "lights", i, "no such parent");
    return name_ok(r, l->name) ? MASU_OK : bad(r, "lights", i, "name lies outside the names");
}

/* Whether both halfs of a 32-bit value are finite: the exponent is not 31. */
static int finite_halves(uint32_t word) {
    return (word & 0x7C00u) != 0x7C00u && (word >> 16 & 0x7C00u) != 0x7C00u;
}

static masu_result check_probes(reader *r) {
    const masu_blob_probes *p = r->view.probes;
    if (!p != !r->view.probe_data) return bad(r, "probes", 0, "are there in part");
    if (!p) return MASU_OK;
    if (!within(p->origin, 3, -1e15f, 1e15f) || !within(p->spacing, 3, 1e-3f, 1e9f) ||
        !within(&p->bias, 1, 0.0f, 1e9f)) {
        return bad(r, "probes", 0, "place, spacing or bias is out of range");
    }
    int unlit = p->live == 1 && !p->sky_sets && !p->suns && p->emissive == 1;
    if (!unlit && p->sky_sets != 1 && p->sky_sets != 4 && p->sky_sets != 9)
        return bad(r, "probes", 0, "sets of the sky are not 1, 4 or 9");
    if (p->live > 1) return bad(r, "probes", 0, "live is not 0 or 1");
    if (p->suns > MASU_PROBE_SUNS_MAX) return bad(r, "probes", 0, "has more than 16 suns");
    if (p->emissive > 1 || p->visibility > MASU_PROBE_VISIBILITY_MAX)
        return bad(r, "probes", 0, "emissive is not 0 or 1, or maps have over 16 texels a side");
    uint64_t count = 1;
    for (uint32_t k = 0; k < 3; k++) {
        if (p->counts[k] < 1 || p->counts[k] > MASU_PROBE_COUNT_MAX)
            return bad(r, "probes", 0, "counts are out of range");
        count *= p->counts[k];
        if (count > MASU_PROBE_COUNT_MAX) return bad(r, "probes", 0, "are more than 262144");
    }
    if (count * masu_probe_words(p) != r->counts[MASU_BLOB_PROBE_DATA])
        return bad(r, "probe data", r->counts[MASU_BLOB_PROBE_DATA], "is not of that many probes");
    for (uint32_t s = 0; s < MASU_PROBE_SUNS_MAX; s++) {
        if (s < p->suns && !unit_vector(p->sun_direction[s]))
            return bad(r, "probes", s, "sun is no unit vector");
        if (!within(p->sun_direction[s], 4, -2.0f, 2.0f) ||
            !within(p->sun_inverse[s], MASU_PROBE_SUNS_MAX, -1e6f, 1e6f)) {
            return bad(r, "probes", s, "a number of its suns is out of range");
        }
    }
    uint64_t halves = count * masu_probe_sets(p) * MASU_PROBE_WORDS;
    for (uint64_t i = 0; i < halves; i++) {
        if (!finite_halves(r->view.probe_data[i])) return bad(r, "probe data", i, "is not finite");
    }
    return MASU_OK;
}

static masu_result check_environment(reader *r) {
    const masu_blob_environment *e = r->view.environment;
    const masu_blob_environment_map *map = r->view.environment_map;
    if ((e->turbidity != 0.0f && !within(&e->turbidity, 1, 1.5f, 10.0f)) ||
        !within(e->ground, 3, 0.0f, 1.0f)) {
        return bad(r, "environment", 0,
                   "turbidity is not 0 or 1.5 to 10, or the ground not 0 to 1");
    }
    if (e->metered != 0.0f && e->metered != 1.0f)
        return bad(r, "environment", 0, "metered is not 0 or 1");
    if (e->smooth_edges != 0.0f && e->smooth_edges != 1.0f)
        return bad(r, "environment", 0, "smooth edges are not 0 or 1");
    if (!within(&e->brighten, 1, 0.0f, 1e6f) || !within(&e->darken, 1, 0.0f, 1e6f))
        return bad(r, "environment", 0, "a speed of the exposure is out of range");
    if (e->occlusion_radius != 0.0f && !within(&e->occlusion_radius, 1, 1e-3f, 1e6f))
        return bad(r, "environment", 0, "occlusion radius is not 0 or 0.001 to 1e6 m");
    if (!within(e->fog_color, 3, 0.0f, 1e9f) || !within(&e->fog_density, 1, 0.0f, 1e6f) ||
        !within(&e->fog_height, 1, -1e9f, 1e9f) || !within(&e->fog_falloff, 1, 0.0f, 1e6f) ||
        !within(&e->fog_start, 1, 0.0f, 1e9f)) {
        return bad(r, "environment", 0, "a value of the fog is out of range");
    }
    if (!map != !r->view.environment_texels)
        return bad(r, "environment map", 0, "is there in part");
    if (!map) return MASU_OK;
    if (map->size < 8 || map->size > 1024 || (map->size & (map->size - 1)))
        return bad(r, "environment map", 0, "size is no power of two from 8 to 1024");
    if (map->mips < 2 || map->mips > 8 || map->size >> (map->mips - 1) < 4)
        return bad(r, "environment map", 0, "number of mips");
    uint64_t texels = masu_blob_environment_texels(map->size, map->mips);
    if (texels != r->counts[MASU_BLOB_ENVIRONMENT_TEXELS])
        return bad(r, "environment texels", r->counts[MASU_BLOB_ENVIRONMENT_TEXELS],
                   "are not as many as the map has");
    for (uint32_t k = 0; k < 9; k++) {
        if (!within(map->sh[k], 4, -1e9f, 1e9f))
            return bad(r, "environment map", k, "a coefficient is out of range");
    }
    float length2 = 0.0f;
    for (uint32_t k = 0; k < 3; k++) {
        length2 += map->sh[3 + k][3] * map->sh[3 + k][3];
        if (map->sh[k][3] < 0.0f)
            return bad(r, "environment map", k, "the lobe's color is negative");
    }
    if (!(length2 <= 1.01f))
        return bad(r, "environment map", 0, "the lobe's direction is longer than 1");
    return MASU_OK;
}

masu_result masu_check_looks(reader *r) {
    masu_result result = check_colors(r);
    if (!result) result = check_path(r);
    if (!result) result = check_sun(r);
    if (!result) result = check_shadow(r);
    if (result) return result;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MATERIALS]; i++) {
        result = check_material(r, i);
        if (result) return result;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MESO]; i++) {
        const masu_blob_meso *m = &r->view.meso[i];
        const float positive[2] = {m->alpha, m->offset};
        if (!within((const float *)(const void *)m, 24, -1e3f, 1e3f) ||
            !within(&m->facet, 1, 0.0f, 1.0f) || !within(positive, 2, 0.0f, 4.0f)) {
            return bad(r, "meso", i, "a value is out of range");
        }
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_LIGHTS]; i++) {
        result = check_light(r, i);
        if (result) return result;
    }
    result = check_probes(r);
    return result ? result : check_environment(r);
}

/* Whether an opaque material has more than albedo, normal, roughness, metallic and emissive.
 * Transparent materials are not in the G-buffer. */
static int has_surface(const masu_blob_material *m) {
    if (m->flags & MASU_MATERIAL_IS_BLEND) return 0;
    return m->specular != 0.5f || m->coat > 0.0f || m->meso != MASU_BLOB_NONE ||
           masu_lobe_code(m) || (m->flags & 1u << MASU_SLOT_OCCLUSION) != 0;
}

/* Collects the texture sets of transparent items, at most one more than the limit. */
static void note_set(const masu_blob_material *m, uint32_t sets[], uint32_t *count) {
    uint32_t i = 0;
    if (!(m->flags & MASU_MATERIAL_HAS_MAPS)) return;
    while (i < *count && sets[i] != m->texture_set) i++;
    if (i == *count && i <= MASU_TRANSPARENT_SETS_MAX) sets[(*count)++] = m->texture_set;
}

static void describe_transparents(const reader *r, masu_scene_data *out) {
    uint32_t sets[MASU_TRANSPARENT_SETS_MAX + 1], count = 0;
    uint64_t things = 0;
    for (uint32_t m = 0, from = 0; m < out->meshes; m++) {
        const masu_blob_mesh *mesh = &r->view.meshes[m];
        uint32_t first, end = masu_scene_mesh_instances(&r->view, out->instances, m, from, &first);
        from = end;
        for (uint32_t p = 0; p < mesh->primitive_count && end > first; p++) {
            uint32_t number = r->view.primitives[mesh->first_primitive + p].material;
            const masu_blob_material *material = &r->view.materials[number];
            if (!(material->flags & MASU_MATERIAL_IS_BLEND)) continue;
            things += end - first;
            note_set(material, sets, &count);
        }
    }
    out->transparents = things < UINT32_MAX ? (uint32_t)things : UINT32_MAX;
    out->transparent_sets = things && !count ? 1 : count;
}

void masu_describe_looks(const reader *r, masu_scene_data *out) {
    const uint32_t own =
        1u << MASU_SLOT_COAT | MASU_MATERIAL_COAT_SMOOTH | MASU_MATERIAL_BASE_SMOOTH;
    for (uint32_t i = 0; i < out->materials; i++) {
        const masu_blob_material *m = &r->view.materials[i];
        if (has_surface(m)) out->surfaces++;
        if (m->depth_bias != 0.0f) out->depth_biases = 1;
        if (m->coat > 0.0f) out->coats++;
        if (!(m->flags & MASU_MATERIAL_IS_BLEND) && m->flags & 1u << MASU_SLOT_NORMAL)
            out->reliefs = 1;
        if (m->coat > 0.0f && m->flags & own) out->own_coats = 1;
        if (masu_lobe_code(m)) out->lobes |= 1u << (masu_lobe_code(m) >> 21);
        if (m->flags & MASU_MATERIAL_IS_BLEND && m->flags & MASU_MATERIAL_IS_TINTED) {
            out->tints |= (double)m->roughness > MASU_SHARP_GLASS ? 1 | MASU_TINTS_ROUGH : 1;
            if (m->flags & MASU_MATERIAL_TRANSMISSION_MAP) out->tints |= MASU_TINTS_MAPPED;
            if (m->thickness > 0.0f) out->tints |= MASU_TINTS_REFRACTED;
        }
        if (m->flags & MASU_MATERIAL_IS_BLEND) out->blends++;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_CAMERA_KEYS]; i++)
        out->flat_lens |= (double)r->view.camera_keys[i].fov_y < MASU_FLAT_LENS;
    describe_transparents(r, out);
    out->meso = (uint32_t)r->counts[MASU_BLOB_MESO];
    out->lights = (uint32_t)r->counts[MASU_BLOB_LIGHTS];
    for (uint32_t i = 0; i < out->lights; i++) {
        const masu_blob_light *l = &r->view.lights[i];
        uint32_t type = l->type & MASU_LIGHT_TYPE;
        out->area_lights += type >= MASU_LIGHT_CAPSULE;
        out->surface_lights += (l->type & MASU_LIGHT_SURFACE) != 0;
        if (l->type & MASU_LIGHT_NO_SHADOW) continue;
        out->shadow_lights++;
        out->shadow_spots += type == MASU_LIGHT_SPOT && l->outer <= MASU_LOCAL_ANGLE_MOST;
    }
    if (r->view.probes) {
        const masu_blob_probes *p = r->view.probes;
        out->probe_sets = masu_probe_sets(p);
        out->probes = p->counts[0] * p->counts[1] * p->counts[2];
        out->probe_words = r->counts[MASU_BLOB_PROBE_DATA];
        out->probes_unlit = !p->sky_sets;
        out->bounce =
            p->live && (r->view.trace_nodes || r->view.code[MASU_BLOB_BOUNCE_SDF_SPIRV].words);
        out->bounce_sdf = r->view.code[MASU_BLOB_BOUNCE_SDF_SPIRV].words != NULL;
    }
    if (r->view.environment_map) {
        out->environment_size = r->view.environment_map->size;
        out->environment_mips = r->view.environment_map->mips;
    }
    out->analytic_sky = r->view.environment->turbidity > 0.0f;
    out->fog = r->view.environment->fog_density > 0.0f;
    out->occlusion_radius = r->view.environment->occlusion_radius;
    out->metered = r->view.environment->metered != 0.0f;
    out->brighten = r->view.environment->brighten;
    out->darken = r->view.environment->darken;
    out->smooth_edges = r->view.environment->smooth_edges != 0.0f;
}
