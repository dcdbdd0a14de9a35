/*
 * pack.glsl: packing and unpacking of the G-buffer texels.
 *
 *   albedo, rgba8:  rgb  sqrt of linear albedo
 *                   a    perceptual roughness
 *   normal, r32ui:  bits 0-12, 13-25  octahedral normal (Cigolle et al., JCGT 3-2, 2014, section
 *   3.2); 4095 is 0
 *                   bits 26-29        metallic, 0..15
 *                   bits 30-31        MASU_SURFACE_* flags
 *   With MASU_SURFACE_EMISSIVE the pixel of hdr holds the emitted radiance until light.comp has
 *   run, and bits 26-29:
 *                   0     unlit (masu_is_unlit)
 *                   1-15  metallic, 0..14
 *   surface, rgba8, if MASU_SURFACE_MORE is set (else: specular 0.5, no coat, no relief):
 *                   r    specular
 *                   g    clear coat, 4 bits, and its roughness, 4 bits; for a small relief, without
 *                        coat: factor of the specular terms at grazing angles
 *                   b    occlusion
 *                   a    0: no small relief; else its self-shadowing factor f, as (1 + 254 f) / 255
 *   If a scene has coats with a separate normal (masu_own_coats), the normal texel of such a
 *   surface holds the coat's normal, and a has its upper bit set. 14 bits hold the direction of
 *   the base normal (masu_lean_axes), square roots of x and y, 64 + 63 steps each:
 *                   r    bits 3-7 specular, 0..30; 0-2 of y the lowest
 *                   b    bits 4-7 occlusion; 0-3 of y the highest
 *                   a    bits 0-6 x; without bit 7 the (1 + 126 f) / 255 of a relief
 *   depth, float:   near / view z; 0: no surface
 *
 * 13 bits per axis leave a normal within 0.03 degrees. masu_unpack_normal in src/api_stats.c is the
 * C copy; for surfaces with emission, measure/texel.c.
 *
 *   If a scene has other lobes (masu_extra_lobes), such a surface has no coat: g is below 16, a has
 *   its upper bit set, and 23 bits are the lobe: 0-7 r, 8-14 a, 15-18 g, 19-22 the lower half of b,
 *   whose upper half is occlusion:
 *                   21-22  MASU_LOBE_*; colours have an 11-bit hue: which channel is the brightest,
 *                          and the square roots of the other two relative to it, 25 steps each
 *                   COLORED  0-7 root of the brightest f0, 8-18 hue
 *                   SHEEN    0-4 roughness, 5-9 root of the brightest channel, 10-20 hue
 *                   GRAIN    0-6 anisotropy, 7-13 angle of the grain (masu_lean_axes), 180 degrees,
 *                            14-20 specular
 *
 * A coat has sharp reflections and gets all 26 bits; the base normal has an error within 0.3
 * degrees if it is tilted by 6, 0.8 at 30, 1.9 at 60; half as much in the mean. With the precision
 * the other way round, or with both in 13 bits, a polished coat would show steps.
 *
 * The two texels have no room for emission. Ray hits (specular_hit, silhouettes.comp) have only
 * these; there, and in the G-buffer of devices with too few colour attachments
 * (masu_emission_packed), emission and base share 36 bits (masu_pack_met). With
 * MASU_SURFACE_EMISSIVE bits 26-29 specify the content of albedo:
 *                   0     rgb sqrt of radiance / 16: unlit
 *                   15    the same and a roughness: black, no metal, and lit
 *                   1-14  roughness, and a 32-bit value:
 *                         bits 0-4, 5-9, 10-14 sqrt of albedo; 15 metal;
 *                         16-22 fourth root of the brightest channel's radiance / 16; 23-31 the
 *                         other two relative to it, sqrt, 13 steps each: (13 channel + next) 13 +
 *                         last
 * Black surfaces (lamps, screens) lose nothing. For others the radiance is within 3 % at 1 and 6 %
 * at 1/16, its hue within 1/24 and the albedo within 1/62 of the square root's range, roughness
 * within 1/26.
 */
#ifndef MASU_PACK_GLSL
#define MASU_PACK_GLSL

#include "shared/materials.h"
#include "shared/guard.glsl"

const float masu_emissive_range = 16.0;         /* largest radiance of the 36 bits */
const float masu_emissive_most = 65504.0;       /* largest radiance of hdr */
const float masu_emissive_least = 1.0 / 1024.0; /* lower radiance means no emission */

layout(constant_id = 15) const bool masu_emission_packed = false;

struct masu_surface {
    vec3 albedo;   /* linear, 0..1 */
    float roughness; /* perceptual, 0..1 */
    vec3 emissive; /* linear radiance, 0..65504, added to the reflected light */
    float metallic;
    float specular;       /* reflectance of a dielectric at normal incidence / 0.08, 0..1 */
    float coat;           /* clear coat, 0..1 */
    float coat_roughness; /* perceptual, 0..1 */
    float occlusion;      /* share of the ambient light that its relief lets through, 0..1 */
    float shadow;         /* self-shadowing factor of its relief, 0..1; below 0: no relief */
    float edge;           /* factor of the specular terms at grazing angles, 0..1 */
    vec2 lean;            /* of a base with a separate normal: its x and y in masu_lean_axes of the
                           * coat */
    uint lobe;            /* 23 bits, see above; 0: no additional lobe */
};

#ifdef MASU_SURFACE
/* The scene has coats with separate maps or normals. */
#ifdef MASU_OWN_COATS
const bool masu_own_coats = true;
#else
layout(constant_id = 11) const bool masu_own_coats = false;
#endif
/* Bit 1 << MASU_LOBE_*: the scene has such lobes. */
#ifdef MASU_ALL_LOBES
const uint masu_extra_lobes = 14u;
#else
layout(constant_id = 21) const uint masu_extra_lobes = 0u;
#endif
#endif

masu_surface masu_plain_surface(vec3 albedo, float roughness)
{
    return masu_surface(albedo, roughness, vec3(0.0), 0.0, 0.5, 0.0, 0.0, 1.0, -1.0, 1.0, vec2(0.0),
                        0u);
}

float masu_brightest(vec3 color)
{
    return max(color.r, max(color.g, color.b));
}

#ifdef MASU_SURFACE
bool masu_has_lobe(masu_surface s, uint kind)
{
    return (masu_extra_lobes >> kind & 1u) != 0u && s.lobe >> 21 == kind;
}

/* A colour relative to its brightest channel. */
vec3 masu_lobe_hue(uint code)
{
    vec2 others = vec2(code / 26u % 26u, code % 26u) * (1.0 / 25.0);
    others *= others;
    uint channel = code / 676u;
    return channel == 0u   ? vec3(1.0, others)
           : channel == 1u ? vec3(others.y, 1.0, others.x)
                           : vec3(others, 1.0);
}

uint masu_hue_code(vec3 color, float brightest)
{
    bool red = color.r >= brightest, green = !red && color.g >= brightest;
    vec2 others = red ? color.gb : green ? color.br : color.rg;
    uvec2 steps =
        uvec2(sqrt(clamp(others / max(brightest, masu_tiny), vec2(0.0), vec2(1.0))) * 25.0 + 0.5);
    return ((red ? 0u : green ? 1u : 2u) * 26u + steps.x) * 26u + steps.y;
}

float masu_lobe_root(uint code, uint steps)
{
    float root = float(code & steps) / float(steps);
    return root * root;
}

void masu_set_lobe(inout masu_surface s, uint lobe)
{
    uint kind = lobe >> 21;
    s.lobe = lobe;
    s.specular = kind == MASU_LOBE_COLORED ? 12.5 * masu_lobe_root(lobe, 255u)
               : kind == MASU_LOBE_GRAIN ? float(lobe >> 14 & 127u) / 127.0 : 0.5;
}

/* Multiplies a lobe by a texel of its map: rgb scales its colour, alpha its strength, or the
 * roughness of a sheen. */
void masu_scale_lobe(inout masu_surface s, vec4 texel)
{
    if (masu_has_lobe(s, MASU_LOBE_COLORED)) {
        vec3 f0 = masu_lobe_hue(s.lobe >> 8 & 2047u) * (masu_lobe_root(s.lobe, 255u) * texel.a) *
                  texel.rgb;
        float most = masu_brightest(f0);
        uint root = uint(sqrt(clamp(most, 0.0, 1.0)) * 255.0 + 0.5);
        masu_set_lobe(s, MASU_LOBE_COLORED << 21 | masu_hue_code(f0, most) << 8 | root);
    } else if (masu_has_lobe(s, MASU_LOBE_SHEEN)) {
        vec3 color = masu_lobe_hue(s.lobe >> 10 & 2047u) * masu_lobe_root(s.lobe >> 5, 31u) *
                     texel.rgb;
        float most = masu_brightest(color);
        uint root = uint(sqrt(clamp(most, 0.0, 1.0)) * 31.0 + 0.5);
        uint rough = uint(clamp(float(s.lobe & 31u) * texel.a, 0.0, 31.0) + 0.5);
        masu_set_lobe(s,
                      MASU_LOBE_SHEEN << 21 | masu_hue_code(color, most) << 10 | root << 5 | rough);
    }
}
#endif

/* Applies the specular factor of a material (masu_specular_of). */
void masu_take_specular(inout masu_surface s, float given)
{
    s.specular = given;
#ifdef MASU_SURFACE
    if (masu_extra_lobes != 0u && given < 0.0) {
        masu_set_lobe(s, uint(clamp(-given, 1.0, 8388608.0)) - 1u);
    }
#endif
}

/* Octahedral encoding of any n: within -1..1 apart from rounding. */
vec2 masu_oct_encode(vec3 n)
{
    float sum = abs(n.x) + abs(n.y) + abs(n.z);
    bool usable = masu_finite(sum) && sum > masu_tiny;
    vec2 p = usable ? n.xy * (1.0 / sum) : vec2(0.0);
    if (n.z < 0.0) {
        vec2 s = vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
        p = (1.0 - abs(p.yx)) * s;
    }
    return p;
}

/* Any pair in -1..1 gives a unit vector: the octahedron is at least 1/sqrt(3) away from the
 * origin. */
vec3 masu_oct_decode(vec2 p)
{
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0) {
        vec2 s = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
        n.xy = (1.0 - abs(n.yx)) * s;
    }
    return n * masu_rsqrt(dot(n, n));
}

bool masu_is_emissive(masu_surface s)
{
    return masu_brightest(masu_sane(s.emissive, 0.0, masu_emissive_most)) >= masu_emissive_least;
}

vec3 masu_emitted(masu_surface s)
{
    return masu_sane(s.emissive, 0.0, masu_emissive_most);
}

/* It emits, and has neither albedo nor gloss: incident light has no visible effect, and no light,
 * shadow or reflection is computed for it. */
bool masu_is_unlit(masu_surface s)
{
    return masu_is_emissive(s) && !(masu_brightest(masu_sane(s.albedo, 0.0, 1.0)) > 0.0) &&
           !(s.roughness < 1.0) && !(s.coat > 0.0);
}

/* masu_is_unlit() of a packed normal. */
bool masu_is_unlit_texel(uint normal)
{
    return (normal >> 26 & 31u) == MASU_SURFACE_EMISSIVE << 4;
}

/* The texel of albedo, and bits 26-31 of the normal, of an emitter; `glow`, `albedo` and
 * `roughness` are sane. */
void masu_pack_shining(vec3 glow, vec3 albedo, float roughness, masu_surface s, out vec4 texel,
                       out uint look)
{
    float brightest = masu_brightest(glow);
    bool black = !(masu_brightest(albedo) > 0.0), metal = s.metallic >= 0.5;
    bool unlit = black && !(roughness < 1.0) && !(s.coat > 0.0);
    bool red = glow.r >= brightest, green = !red && glow.g >= brightest;
    vec2 others = red ? glow.gb : green ? glow.br : glow.rg;
    uvec2 hue = uvec2(sqrt(min(others / brightest, vec2(1.0))) * 12.0 + 0.5);
    uint channel = red ? 0u : green ? 169u : 338u;
    uint level = uint(sqrt(sqrt(brightest * (1.0 / masu_emissive_range))) * 127.0 + 0.5);
    uvec3 base = uvec3(sqrt(albedo) * 31.0 + 0.5);
    vec4 lit = unpackUnorm4x8(base.r | base.g << 5 | base.b << 10 | (metal ? 1u << 15 : 0u) |
                              level << 16 | (channel + hue.x * 13u + hue.y) << 23);
    bool colored = !unlit && (!black || metal);
    texel = colored ? lit : vec4(sqrt(glow * (1.0 / masu_emissive_range)), roughness);
    look = MASU_SURFACE_EMISSIVE << 30 | (unlit     ? 0u
                                          : colored ? 1u + uint(roughness * 13.0 + 0.5)
                                                    : 15u)
                                             << 26;
}

/* The texel of albedo, and the bits of the normal texel except its direction, without emission. */
void masu_pack_plain(masu_surface s, out vec4 texel, out uint look)
{
    texel = vec4(sqrt(masu_sane_unit(s.albedo)), masu_sane_unit(s.roughness));
    look = uint(masu_sane_unit(s.metallic) * 15.0 + 0.5) << 26;
}

/* The same for a ray hit, with emission. */
void masu_pack_met_look(masu_surface s, out vec4 texel, out uint look)
{
    vec3 glow = masu_emissive_range * masu_sane_unit(s.emissive * (1.0 / masu_emissive_range));
    if (masu_brightest(glow) >= masu_emissive_least) {
        masu_pack_shining(glow, masu_sane_unit(s.albedo), masu_sane_unit(s.roughness), s,
                          texel, look);
    } else {
        masu_pack_plain(s, texel, look);
    }
}

/* The same for the G-buffer. If the flag EMISSIVE is set, hdr receives masu_emitted(s). */
void masu_pack_look(masu_surface s, out vec4 texel, out uint look)
{
    if (masu_emission_packed) {
        masu_pack_met_look(s, texel, look);
        return;
    }
    masu_pack_plain(s, texel, look);
    if (masu_is_emissive(s)) {
        uint metal = masu_is_unlit(s) ? 0u : 1u + uint(masu_sane_unit(s.metallic) * 14.0 + 0.5);
        look = MASU_SURFACE_EMISSIVE << 30 | metal << 26;
    }
}

uint masu_pack_oct(vec3 n)
{
    uvec2 q = uvec2(round(masu_oct_encode(n) * 4095.0) + 4095.0);
    return q.x | q.y << 13;
}

void masu_pack_texels(vec3 n, masu_surface s, out vec4 albedo, out uint normal)
{
    masu_pack_look(s, albedo, normal);
    normal |= masu_pack_oct(n);
}

void masu_pack_met(vec3 n, masu_surface s, out vec4 albedo, out uint normal)
{
    masu_pack_met_look(s, albedo, normal);
    normal |= masu_pack_oct(n);
}

#ifdef MASU_SURFACE
/* Tangent and bitangent for any unit normal (Duff et al., "Building an Orthonormal Basis,
 * Revisited", JCGT 6-1, 2017). They flip at the sign change of z: packing and unpacking must use
 * exactly the same normal. */
void masu_lean_axes(vec3 n, out vec3 t, out vec3 b)
{
    float sign_z = n.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (sign_z + n.z);
    float c = n.x * n.y * a;
    t = vec3(1.0 + sign_z * n.x * n.x * a, sign_z * c, -sign_z * n.x);
    b = vec3(c, sign_z + n.y * n.y * a, -n.y);
}

/* The direction of `below` in the axes of the normal n; both unit. */
vec2 masu_lean_of(vec3 n, vec3 below)
{
    vec3 t, b;
    masu_lean_axes(n, t, b);
    return vec2(dot(t, below), dot(b, below));
}

/* The base normal below a coat with the normal n. */
vec3 masu_below(vec3 n, vec2 lean)
{
    if (lean.x == 0.0 && lean.y == 0.0) { /* most pixels */
        return n;
    }
    vec3 t, b;
    masu_lean_axes(n, t, b);
    vec2 xy = masu_sane(vec3(lean, 0.0), -1.0, 1.0).xy;
    vec3 below = t * xy.x + b * xy.y + n * masu_sqrt(1.0 - dot(xy, xy));
    return masu_normalize(below, n);
}

/* Packs the grain direction of a surface as an angle in the axes of the normal n; grain: any
 * length. */
void masu_turn_grain(inout masu_surface s, vec3 n, vec3 grain)
{
    vec3 t, b;
    masu_lean_axes(n, t, b);
    vec2 at = vec2(dot(t, grain), dot(b, grain));
    float half_turns = dot(at, at) > masu_tiny ? masu_atan2(at.y, at.x) * (128.0 / 3.14159265)
                                               : 0.0;
    masu_set_lobe(s, (s.lobe & ~(127u << 7)) | (uint(int(round(half_turns)) + 256) & 127u) << 7);
}

vec3 masu_grain(masu_surface s, vec3 n)
{
    vec3 t, b;
    masu_lean_axes(n, t, b);
    float angle = float(s.lobe >> 7 & 127u) * (3.14159265 / 128.0);
    return t * cos(angle) + b * sin(angle);
}

uvec2 masu_pack_lean(vec2 lean)
{
    vec2 root = sqrt(min(abs(lean), vec2(1.0))) * 63.0 + 0.5;
    ivec2 steps = ivec2(root);
    return uvec2(64 + (lean.x < 0.0 ? -steps.x : steps.x),
                 64 + (lean.y < 0.0 ? -steps.y : steps.y));
}

vec2 masu_unpack_lean(uvec2 steps)
{
    vec2 root = vec2(ivec2(steps) - 64) / 63.0;
    return root * abs(root);
}
#endif

vec4 masu_pack_surface(masu_surface s)
{
    vec4 v = masu_sane(vec4(s.specular, s.coat, s.coat_roughness, s.occlusion), 0.0, 1.0);
    float coat = floor(v.y * 15.0 + 0.5) * 16.0 + floor(v.z * 15.0 + 0.5);
    float relief_steps = 254.0;
#ifdef MASU_SURFACE
    if (masu_extra_lobes != 0u) {
        relief_steps = 126.0;
        if (s.lobe != 0u) {
            float above = 16.0 * floor(v.w * 15.0 + 0.5);
            return vec4(float(s.lobe & 255u), float(s.lobe >> 15 & 15u),
                        above + float(s.lobe >> 19 & 15u), float(128u + (s.lobe >> 8 & 127u))) /
                   255.0;
        }
    }
    if (masu_own_coats) {
        relief_steps = 126.0;
        vec2 lean = masu_sane(vec3(s.lean, 0.0), -1.0, 1.0).xy;
        uvec2 steps = masu_pack_lean(lean);
        if (!(s.shadow >= 0.0) && coat >= 16.0 && (steps.x != 64u || steps.y != 64u)) {
            return vec4(8.0 * floor(v.x * 30.0 + 0.5) + float(steps.y & 7u), coat,
                        16.0 * floor(v.w * 15.0 + 0.5) + float(steps.y >> 3),
                        128.0 + float(steps.x)) /
                   255.0;
        }
    }
#endif
    if (!(s.shadow >= 0.0)) {
        return vec4(v.x, coat / 255.0, v.w, 0.0);
    }
    vec2 relief = masu_sane(vec3(s.edge, s.shadow, 0.0), 0.0, 1.0).xy;
    return vec4(v.x, relief.x, v.w, (1.0 + relief_steps * relief.y) / 255.0);
}

void masu_unpack_surface(vec4 texel, inout masu_surface s)
{
    s.specular = texel.r;
    s.occlusion = texel.b;
    s.shadow = (texel.a * 255.0 - 1.0) / 254.0;
    bool relief = texel.a > 0.0;
#ifdef MASU_SURFACE
    if (masu_extra_lobes != 0u) {
        uvec4 bytes = uvec4(texel * 255.0 + 0.5);
        s.shadow = (texel.a * 255.0 - 1.0) / 126.0;
        if (bytes.a >= 128u && bytes.g < 16u) {
            s.shadow = -1.0;
            s.occlusion = float(bytes.b >> 4) / 15.0;
            masu_set_lobe(s,
                          bytes.r | (bytes.a & 127u) << 8 | bytes.g << 15 | (bytes.b & 15u) << 19);
            return;
        }
    }
    if (masu_own_coats) {
        uvec4 bytes = uvec4(texel * 255.0 + 0.5);
        s.shadow = (texel.a * 255.0 - 1.0) / 126.0;
        if (bytes.a >= 128u) {
            relief = false;
            s.shadow = -1.0;
            s.specular = float(bytes.r >> 3) / 30.0;
            s.occlusion = float(bytes.b >> 4) / 15.0;
            s.lean = masu_unpack_lean(uvec2(bytes.a & 127u, (bytes.b & 15u) << 3 | (bytes.r & 7u)));
        }
    }
#endif
    if (relief) {
        s.edge = texel.g;
    } else {
        float coat = floor(texel.g * 255.0 + 0.5);
        s.coat = floor(coat / 16.0) / 15.0;
        s.coat_roughness = (coat - 16.0 * floor(coat / 16.0)) / 15.0;
    }
}

vec3 masu_unpack_normal(uint texel)
{
    vec2 q = vec2(texel & 0x1FFFu, texel >> 13 & 0x1FFFu) / 4095.0 - 1.0;
    return masu_oct_decode(min(q, vec2(1.0)));
}

uint masu_unpack_flags(uint texel)
{
    return texel >> 30;
}

void masu_unpack_shining(vec4 texel, uint form, inout masu_surface s)
{
    s.metallic = 0.0;
    s.albedo = vec3(0.0);
    s.emissive = texel.rgb * texel.rgb * masu_emissive_range;
    if (form == 0u || form == 15u) {
        s.roughness = form == 0u ? 1.0 : texel.a;
        return;
    }
    uint word = packUnorm4x8(texel);
    vec3 albedo = vec3(word & 31u, word >> 5 & 31u, word >> 10 & 31u) / 31.0;
    float level = float(word >> 16 & 127u) / 127.0;
    uint hue = word >> 23;
    vec2 others = vec2(hue / 13u % 13u, hue % 13u) / 12.0;
    others *= others;
    level *= level;
    uint channel = hue / 169u;
    vec3 glow = channel == 0u   ? vec3(1.0, others)
                : channel == 1u ? vec3(others.y, 1.0, others.x)
                                : vec3(others, 1.0);
    s.albedo = albedo * albedo;
    s.metallic = float(word >> 15 & 1u);
    s.roughness = float(form - 1u) / 13.0;
    s.emissive = glow * (level * level * masu_emissive_range);
}

bool masu_has_emission(uint normal)
{
    return (masu_unpack_flags(normal) & MASU_SURFACE_EMISSIVE) != 0u;
}

/* Unpacks the two texels of a ray hit, without the normal. */
masu_surface masu_unpack_met(vec4 texel, uint normal)
{
    masu_surface s = masu_plain_surface(texel.rgb * texel.rgb, texel.a);
    uint form = normal >> 26 & 15u;
    s.metallic = float(form) / 15.0;
    if (masu_has_emission(normal)) {
        masu_unpack_shining(texel, form, s);
    }
    return s;
}

/* The same for the G-buffer, without emission unless that is packed: it is in hdr. */
masu_surface masu_unpack_look(vec4 texel, uint normal)
{
    if (masu_emission_packed) {
        return masu_unpack_met(texel, normal);
    }
    masu_surface s = masu_plain_surface(texel.rgb * texel.rgb, texel.a);
    uint form = normal >> 26 & 15u;
    s.metallic = masu_has_emission(normal) ? max(float(form) - 1.0, 0.0) / 14.0
                                           : float(form) / 15.0;
    return s;
}

#endif
