/* shaders.c: see shaders.h. */
#include "device/shaders.h"

#include "base/error.h"
#include "plan/buffer_plan.h"
#include "scene/scene.h"
#include "scene/trace_scene.h"

#include <string.h>

enum {
#define AXIS(ID, ...) MASU_AXIS_##ID,
#include "plan/axes.inc"
#undef AXIS
    MASU_AXIS_COUNT
};

/* A shader, the axes over which it is compiled, and its number of forms per axis. */
typedef struct masu_shader {
    const char *name;
    uint32_t axis_count;
    struct {
        uint32_t axis, forms;
    } axes[4];
    const masu_packed *codes; /* all combinations, first axis fastest */
} masu_shader;

#include "packed.h"
#include "permutations.h"

/* ---- Form of each axis that a plan needs ----------------------------------------------------- */

/* Whether all images that a pass samples, in any rung, are colour in the range 0..1. */
static int reads_unorm(const masu_frame_plan *plan, uint32_t pass) {
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        const masu_rung_plan *rp = &plan->rungs[r];
        if (!masu_has_pass(&rp->active, pass)) continue;
        for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
            masu_access access = rp->access[pass][a];
            if (access.usage != MASU_READ) continue;
            VkFormat format = access.image == MASU_IMAGE_SOURCE
                                  ? plan->desc.source.format
                                  : masu_plan_format(plan, access.image);
            if (format != VK_FORMAT_R8G8B8A8_UNORM && format != VK_FORMAT_B8G8R8A8_UNORM &&
                format != VK_FORMAT_A8B8G8R8_UNORM_PACK32 &&
                format != VK_FORMAT_A2B10G10R10_UNORM_PACK32)
                return 0;
        }
    }
    return 1;
}

/* Form of the axes COLOR and LAST. */
static int color_form(const masu_frame_plan *plan, uint32_t pass, int last) {
    if (plan->deep) return 3;
    if (plan->needs.scene) return last ? 2 : 4;
    int unorm = reads_unorm(plan, pass);
    return last ? unorm : unorm ? 4 : 5;
}

static uint32_t form_of(uint32_t axis, const masu_frame_plan *plan, uint32_t pass, int textured,
                        int last) {
    const masu_needs *n = &plan->needs;
    switch (axis) {
#define AXIS(ID, value, ...)                                                                       \
    case MASU_AXIS_##ID: return (uint32_t)(value);
#include "plan/axes.inc"
#undef AXIS
    default: return 0;
    }
}

/* The permutation of a shader for the plan. A non-zero flag is form 1; a value beyond the shader's
 * forms selects the last form. */
static masu_code permutation(const masu_frame_plan *plan, uint32_t pass, uint32_t shader,
                             int textured, int last) {
    const masu_shader *s = &shaders[shader];
    uint32_t index = 0, step = 1;
    if (shader == MASU_SHADER_NONE) return (masu_code){0};
    for (uint32_t i = 0; i < s->axis_count; i++) {
        uint32_t form = form_of(s->axes[i].axis, plan, pass, textured, last);
        if (form >= s->axes[i].forms) form = s->axes[i].forms - 1;
        index += form * step;
        step *= s->axes[i].forms;
    }
    masu_packed packed = s->codes[index];
    return (masu_code){NULL, packed, packed.words * sizeof(uint32_t), !packed.words};
}

/* ---- Passes ---------------------------------------------------------------------------------- */

typedef struct pass_shaders {
    uint32_t compute, vertex, fragment;
} pass_shaders;

#define NONE 0, 0, 0
#define COMP(file, axes) MASU_SHADER_##file##_comp, 0, 0
#define DRAW(geometry, vertex, vertex_axes, fragment, fragment_axes)                               \
    0, MASU_SHADER_##vertex##_vert, MASU_SHADER_##fragment##_frag
#define SCENE(file, section) 0, 0, 0

static const pass_shaders of_pass[MASU_PASS_COUNT] = {
#define PASS(ID, name, purpose, kind, extent, when, push, shader, ...) [MASU_PASS_##ID] = {shader},
#include "plan/passes.inc"
#undef PASS
};

static masu_code scene_code(const masu_frame_plan *plan, uint32_t pass) {
    masu_scene_view v = masu_scene_data_view(&plan->scene);
    uint32_t section = masu_passes[pass].code;
    return (masu_code){v.code[section].words, {0}, v.code[section].count * sizeof(uint32_t), 0};
}

masu_code masu_compute_code(const masu_frame_plan *plan, uint32_t pass, int last) {
    if (masu_passes[pass].code) return scene_code(plan, pass);
    return permutation(plan, pass, of_pass[pass].compute, 0, last);
}

masu_draw_code masu_draw_code_of(const masu_frame_plan *plan, uint32_t pass, int textured) {
    masu_draw_code code = {permutation(plan, pass, of_pass[pass].vertex, textured, 0),
                           masu_passes[pass].code
                               ? scene_code(plan, pass)
                               : permutation(plan, pass, of_pass[pass].fragment, textured, 0)};
    /* Casters need a fragment shader only for the alpha test; otherwise only depth is written. */
    masu_geometry geometry = masu_passes[pass].geometry;
    if ((geometry == MASU_GEOMETRY_CASCADE || geometry == MASU_GEOMETRY_CASTERS) && !textured)
        code.fragment = (masu_code){0};
    return code;
}

masu_interface masu_code_interface(const masu_code *code) {
    return code->words ? masu_interface_of(code->words, code->bytes / sizeof *code->words)
                       : code->packed.interface;
}

/* Bit mask of the set 0 bindings that any form of a pass declares. */
static uint64_t declared_bindings(const masu_frame_plan *plan, uint32_t pass) {
    uint64_t bindings = 0;
    if (masu_passes[pass].code) { /* scene code has one form: read it once */
        masu_code vertex = permutation(plan, pass, of_pass[pass].vertex, 0, 0);
        masu_code own = scene_code(plan, pass);
        return masu_code_interface(&vertex).bindings | masu_code_interface(&own).bindings;
    }
    for (int form = 0; form < 2; form++) { /* last or not, textured or not */
        masu_draw_code draw = masu_draw_code_of(plan, pass, form);
        masu_code compute = masu_compute_code(plan, pass, form);
        bindings |= masu_code_interface(&draw.vertex).bindings |
                    masu_code_interface(&draw.fragment).bindings |
                    masu_code_interface(&compute).bindings;
    }
    return bindings;
}

/* Most compute shaders declare the counters, but use them only with desc.debug.counters, by a
 * specialisation constant. Otherwise the declaration gets the binding of another storage buffer of
 * the pass, and costs no descriptor: devices may have as few as 4 per stage. Returns that binding,
 * or MASU_BIND_COUNTERS. */
static uint32_t counters_binding(const masu_frame_plan *plan, const masu_binding *rows,
                                 uint64_t declared) {
    if (plan->desc.debug.counters) return MASU_BIND_COUNTERS;
    for (uint32_t i = 0; i < MASU_BIND_COUNT; i++) {
        if (rows[i].bound && (declared >> rows[i].binding & 1) &&
            rows[i].type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER &&
            (rows[i].stages & VK_SHADER_STAGE_COMPUTE_BIT) && rows[i].binding != MASU_BIND_COUNTERS)
            return rows[i].binding;
    }
    return MASU_BIND_COUNTERS;
}

uint32_t masu_global_bindings(const masu_frame_plan *plan, uint32_t pass,
                              VkDescriptorSetLayoutBinding out[MASU_BIND_COUNT]) {
    masu_binding rows[MASU_BIND_COUNT];
    uint64_t declared = declared_bindings(plan, pass);
    VkShaderStageFlags stages = masu_passes[pass].kind == MASU_PASS_COMPUTE
                                    ? VK_SHADER_STAGE_COMPUTE_BIT
                                    : VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    uint32_t count = 0;
    masu_bindings(plan, rows);
    if (counters_binding(plan, rows, declared) != MASU_BIND_COUNTERS)
        declared &= ~((uint64_t)1 << MASU_BIND_COUNTERS);
    for (uint32_t i = 0; i < MASU_BIND_COUNT; i++) {
        if (!rows[i].bound || !(declared >> rows[i].binding & 1) || !(rows[i].stages & stages))
            continue;
        out[count++] = (VkDescriptorSetLayoutBinding){rows[i].binding, rows[i].type, 1,
                                                      rows[i].stages & stages, NULL};
    }
    return count;
}

static uint32_t most_in_a_stage(const VkDescriptorSetLayoutBinding *bound, uint32_t count,
                                VkDescriptorType type) {
    static const VkShaderStageFlags stages[] = {VK_SHADER_STAGE_VERTEX_BIT,
                                                VK_SHADER_STAGE_FRAGMENT_BIT,
                                                VK_SHADER_STAGE_COMPUTE_BIT};
    uint32_t most = 0;
    for (uint32_t k = 0; k < sizeof stages / sizeof *stages; k++) {
        uint32_t here = 0;
        for (uint32_t i = 0; i < count; i++)
            here += bound[i].descriptorType == type && (bound[i].stageFlags & stages[k]);
        if (here > most) most = here;
    }
    return most;
}

static int is_color(uint32_t usage) {
    return usage == MASU_WRITE_COLOR || usage == MASU_BLEND_COLOR || usage == MASU_UPDATE_COLOR;
}

int masu_draws_polygons(uint32_t pass) {
    masu_geometry g = masu_passes[pass].geometry;
    return g == MASU_GEOMETRY_POLYGONS || g == MASU_GEOMETRY_CASCADE ||
           g == MASU_GEOMETRY_BLENDED || g == MASU_GEOMETRY_PICK || g == MASU_GEOMETRY_CASTERS;
}

masu_stage_needs masu_stage_needs_of(const masu_frame_plan *plan, uint32_t pass) {
    VkDescriptorSetLayoutBinding bound[MASU_BIND_COUNT];
    masu_binding rows[MASU_BIND_COUNT];
    uint32_t count = masu_global_bindings(plan, pass, bound);
    masu_stage_needs n = {
        .uniform_buffers = most_in_a_stage(bound, count, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER),
        .storage_buffers = most_in_a_stage(bound, count, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)};
    masu_bindings(plan, rows);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t r = 0; r < MASU_BIND_COUNT; r++) {
            if (rows[r].bound && rows[r].binding == bound[i].binding)
                n.groups |= 1u << rows[r].group;
        }
    }
    const masu_rung_plan *rp = masu_first_rung(plan, pass);
    for (uint32_t a = 0; rp && a < rp->access_count[pass]; a++) {
        masu_access access = rp->access[pass][a];
        n.sampled_images += masu_has_set(pass) && masu_access_binds(access, 0);
        n.storage_images += masu_has_set(pass) && masu_access_binds(access, 1);
        n.attachments += is_color(access.usage);
    }
    if (plan->scene.texture_arrays && masu_draws_polygons(pass))
        n.sampled_images += MASU_MAP_COUNT;
    return n;
}

const uint32_t *masu_code_read(const masu_frame_plan *plan, uint32_t pass, const masu_code *code,
                               uint32_t *room) {
    masu_binding rows[MASU_BIND_COUNT];
    masu_bindings(plan, rows);
    uint32_t counters = counters_binding(plan, rows, declared_bindings(plan, pass));
    int rebinds = counters != MASU_BIND_COUNTERS &&
                  (masu_code_interface(code).bindings >> MASU_BIND_COUNTERS & 1);
    if (code->words && !rebinds) return code->words;
    if (code->words) memcpy(room, code->words, (size_t)code->bytes);
    else if (!masu_unpack(&masu_pack_of_all, &code->packed, room)) return NULL;
    if (rebinds) masu_rebind(room, code->bytes / sizeof *room, MASU_BIND_COUNTERS, counters);
    return room;
}

/* ---- Shaders missing from the library -------------------------------------------------------- */

masu_result masu_code_check(const masu_frame_plan *plan, masu_detail *detail) {
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        const masu_rung_plan *rp = &plan->rungs[r];
        for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
            if (!masu_has_pass(&rp->active, p)) continue;
            masu_draw_code draw = masu_draw_code_of(plan, p, plan->scene.texture_arrays > 0);
            if (!masu_compute_code(plan, p, masu_comes_last(rp, p)).left_out &&
                !draw.vertex.left_out && !draw.fragment.left_out)
                continue;
            const char *name = masu_scene_class_name(masu_scene_class_of(plan->desc.scene));
            return masu_fail(detail, MASU_ERROR_LIMIT, "CLASSES", 1, 0,
                             "this library was built without the shader of the pass %s: the "
                             "scene's class is %s, "
                             "to be built with make CLASSES=%s or all",
                             masu_passes[p].name, name, name);
        }
    }
    return MASU_OK;
}

/* ---- Memory for unpacking -------------------------------------------------------------------- */

/* Code of the scene needs room only to be adapted to the layout (counters_binding). */
static uint64_t larger(uint64_t bytes, const masu_frame_plan *plan, masu_code code) {
    if (code.words && plan->desc.debug.counters) return bytes;
    return code.bytes > bytes ? code.bytes : bytes;
}

uint64_t masu_code_room(const masu_frame_plan *plan) {
    uint64_t bytes = 0;
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        const masu_rung_plan *rp = &plan->rungs[r];
        for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
            if (!masu_has_pass(&rp->active, p)) continue;
            bytes = larger(bytes, plan, masu_compute_code(plan, p, masu_comes_last(rp, p)));
            for (int textured = 0; textured <= (plan->scene.texture_arrays > 0); textured++) {
                masu_draw_code code = masu_draw_code_of(plan, p, textured);
                bytes = larger(larger(bytes, plan, code.vertex), plan, code.fragment);
            }
        }
    }
    return bytes;
}
