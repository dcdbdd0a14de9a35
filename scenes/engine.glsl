/*
 * engine.glsl: the world around the engine, as a distance field.
 *
 * A raked garden of sand: the furrows are level lines of the distance to the stones, which no
 * polygon knows. In it stand basalt columns that carry the engine (a polygon mesh, sunk 20 cm into
 * them), a ring of beads melted into a torus, a Menger cube half under the sand, and behind, out
 * to the horizon, pillars with lanterns: one pillar, repeated.
 *
 * Every function that returns a distance is 1-Lipschitz and a bound: exact shapes, rotations and
 * reflections, folds into the nearest of symmetric cells, min, max, polynomial smooth minimum; the
 * furrows are divided by their own steepness. y is up, metres.
 */

/* What can be left out where it does not matter (docs/scene.md, "Terms"): unions and blends, from the inside out. */
#define MASU_SDF_SMOOTH
#define MASU_SDF_TERMS 11
#define SAND 1
#define STONES 2
#define PILLARS 3
#define RING 4
#define CUBE 5
#define STONE 6 /* six of them */

/* As in engine.json: the far end of the world is painted with the light of the sky. */
const vec3 horizon = vec3(1.05, 0.62, 0.34);
const vec3 sun_direction = vec3(-0.7660, 0.3420, 0.5443);
const vec3 sun_color = vec3(2.10, 1.38, 0.78);
const vec3 ambient = vec3(0.19, 0.21, 0.32);

const float furrow_depth = 0.011;
const float furrow_number = 34.0; /* radians per metre */
const float clearing = 10.5;      /* no pillar stands on this circle: none is cut by it */
const float pillar_spacing = 6.0;
const vec3 ring_center = vec3(-1.75, 1.48, -5.6);
const float ring_radius = 2.15;
const vec3 cube_center = vec3(-8.5, 1.25, -6.3);
const float cube_half = 1.7;

float smooth_min(float a, float b, float k)
{
    float h = max(k - abs(a - b), 0.0) * (1.0 / k);
    return min(a, b) - h * h * k * 0.25;
}

vec2 turned(vec2 p, float c, float s)
{
    return vec2(c * p.x - s * p.y, s * p.x + c * p.y);
}

/* ---- stones ---- */

/* Regular hexagon: reflections bring p before one side. */
float hexagon(vec2 p, float apothem)
{
    p = abs(p);
    p -= 2.0 * min(dot(vec2(-0.8660254, 0.5), p), 0.0) * vec2(-0.8660254, 0.5);
    return length(p - vec2(clamp(p.x, -0.57735 * apothem, 0.57735 * apothem), apothem)) *
           sign(p.y - apothem);
}

float column(vec3 p, vec2 at, float apothem, float top)
{
    vec2 q = p.xz - at;
    vec2 d = vec2(hexagon(q, apothem - 0.04), p.y - top + 0.04);
    return min(max(d.x, d.y), 0.0) + length(max(d, vec2(0.0))) - 0.04;
}

float stones(vec3 p)
{
    float d = 1e30;
    for (int i = 0; i < 6; i++) {
        if (masu_term(STONE + i)) {
            vec3 middle = i == 4 ? vec3(-2.9, -0.15, -1.1) : vec3(-3.5, -0.12, -0.7);
            /* Not an array: some GPUs would put it into the memory of each invocation. */
            vec4 c = i == 0 ? vec4(0.0, 0.0, 0.52, 0.56) : i == 1 ? vec4(-0.93, 0.50, 0.48, 0.30)
                   : i == 2 ? vec4(0.86, -0.30, 0.46, 0.62) : vec4(0.06, 0.98, 0.40, 0.16);
            float e = i < 4 ? column(p, c.xy, c.z, c.w)
                            : length(p - middle) - (i == 4 ? 0.62 : 0.40);
            float k = i < 4 ? 0.05 : 0.25;
            masu_term_joined(STONE + i, masu_terms_from(STONE, i), d, e, k);
            d = smooth_min(d, e, k);
        }
    }
    return d;
}

/* Distance to the stones' footprint, in the plane: its level lines are the furrows. */
float footprint(vec2 p)
{
    float d = length(p - vec2(0.0, 0.15)) - 1.25;
    d = smooth_min(d, length(p - vec2(-3.1, -0.95)) - 0.70, 1.2);
    d = smooth_min(d, length(p - ring_center.xz) - 0.9, 1.6);
    return d;
}

float sand(vec3 p)
{
    float away = footprint(p.xz);
    /* Far furrows would be finer than a pixel. */
    float depth = furrow_depth * clamp(1.4 - away * 0.16, 0.0, 1.0);
    float wave = depth * cos(furrow_number * away);
    /* Steepest: d(wave)/d(away) <= depth * number + 0.16 * furrow_depth, and |d(away)| <= 1. */
    const float slope = furrow_depth * (furrow_number + 0.16);
    return (p.y - wave) * (1.0 / sqrt(1.0 + slope * slope));
}

/* ---- ring, cube, pillars ---- */

vec3 to_ring(vec3 p)
{
    vec3 q = p - ring_center;
    q.xz = turned(q.xz, 0.9902160, 0.1395431);
    return q;
}

float hoop(vec3 q)
{
    return length(vec2(length(q.xy) - ring_radius, q.z)) - 0.15;
}

/* 24 beads: reflections fold the plane into one sector of 15 degrees with a bead in its middle. */
float beads(vec3 q)
{
    const vec2 fold = vec2(0.2588190, -0.9659258);
    vec2 b = abs(q.xy);
    b = b.y > b.x ? b.yx : b;
    b -= 2.0 * min(dot(b, fold), 0.0) * fold;
    b.y = abs(b.y);
    return length(vec3(b - ring_radius * vec2(0.9914449, 0.1305262), q.z)) - 0.215;
}

float ring(vec3 q)
{
    return smooth_min(hoop(q), beads(q), 0.15);
}

float box(vec3 p, vec3 h)
{
    vec3 q = abs(p) - h;
    return length(max(q, vec3(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0);
}

/* Three levels. Each cuts square tunnels, repeated in cells that mirror each other; it cannot cut where the distance
 * is that of half a tunnel already. */
float menger(vec3 p)
{
    float d = box(p, vec3(cube_half));
    vec3 q = abs(p);
    float half_tunnel = cube_half / 3.0;
    float inverse = 0.5 / cube_half;
    for (int i = 0; i < 3; i++) {
        vec3 m = max(q.xyz, q.yzx);
        d = max(d, half_tunnel - min(m.x, min(m.y, m.z)));
        inverse *= 3.0;
        q = abs(p - 2.0 * half_tunnel * round(p * inverse));
        half_tunnel *= 1.0 / 3.0;
    }
    return d;
}

vec3 to_cube(vec3 p)
{
    vec3 q = p - cube_center;
    q.xz = turned(q.xz, 0.8253356, 0.5646425);
    q.xy = turned(q.xy, 0.9210610, -0.3894183);
    q.yz = turned(q.yz, 0.9553365, 0.2955202);
    return q;
}

vec2 pillar_cell(vec3 p)
{
    return p.xz - pillar_spacing * round(p.xz * (1.0 / pillar_spacing));
}

/* A stone lantern; the cell's own, since all are alike and symmetric in their cells. */
float pillars(vec3 p)
{
    vec2 q = pillar_cell(p);
    vec3 local = vec3(q.x, p.y, q.y);
    vec2 shaft = vec2(length(q) - 0.17, p.y - 1.9);
    float d = min(max(shaft.x, shaft.y), 0.0) + length(max(shaft, vec2(0.0))) - 0.05;
    d = smooth_min(d, box(local - vec3(0.0, 2.25, 0.0), vec3(0.26)) - 0.08, 0.20);
    d = smooth_min(d, box(local - vec3(0.0, 2.72, 0.0), vec3(0.56, 0.02, 0.56)) - 0.06, 0.12);
    return max(d, clearing - length(p.xz));
}

float masu_sdf(vec3 p)
{
    masu_terms_begin();
    float d = 1e30;
    if (masu_term(SAND)) {
        d = sand(p);
        masu_term_joined(SAND, 0u, 1e30, d, 0.0);
    }
    if (masu_term(STONES)) {
        float e = min(length(p.xz - vec2(0.0, 0.2)) - 1.75, length(p.xz - vec2(-3.2, -0.9)) - 1.2);
        e = masu_may_be_below(e - 0.06, d) ? stones(p) : e;
        masu_term_joined(STONES, masu_terms_from(SAND, 1), d, e, 0.06);
        d = smooth_min(d, e, 0.06);
    }
    if (masu_term(PILLARS)) {
        /* None reaches further than that from its middle. */
        float e = length(pillar_cell(p)) - 0.95;
        e = masu_may_be_below(e, d) ? pillars(p) : e;
        masu_term_joined(PILLARS, masu_terms_from(SAND, 2), d, e, 0.0);
        d = min(d, e);
    }
    if (masu_term(RING)) {
        vec3 q = to_ring(p);
        float e = abs(q.z) - 0.26;
        e = masu_may_be_below(e, d) ? ring(q) : e;
        masu_term_joined(RING, masu_terms_from(SAND, 3), d, e, 0.0);
        d = min(d, e);
    }
    if (masu_term(CUBE)) {
        vec3 q = to_cube(p);
        /* The cube's tunnels only count where its box is nearer than all the rest. */
        float e = box(q, vec3(cube_half));
        e = masu_may_be_below(e, d) ? menger(q) : e;
        masu_term_joined(CUBE, masu_terms_from(SAND, 4), d, e, 0.0);
        d = min(d, e);
    }
    masu_terms_end();
    return d;
}

/* ---- surfaces ---- */

/* A share of the lanterns is lit, evenly spread: a two-dimensional golden-ratio sequence. */
bool lantern_is_lit(vec2 cell)
{
    float order = fract(0.7548777 * cell.x + 0.5698403 * cell.y + 0.17);
    return order < masu_param(MASU_PARAM_LANTERNS);
}

/* What the lighting pass would make of a rough surface; for the mist, which it does not know. */
vec3 rough_light(vec3 albedo, vec3 normal)
{
    return albedo * (sun_color * max(dot(normal, sun_direction), 0.0) + ambient);
}

void pillar_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.42, 0.38, 0.34);
    s.roughness = 0.9;
    float mist = smoothstep(16.0, 100.0, length(p.xz));
    vec2 cell = round(p.xz / pillar_spacing);
    bool lit = abs(p.y - 2.27) < 0.24 && lantern_is_lit(cell);
    if (lit) {
        vec3 flame = mix(vec3(3.2, 1.25, 0.28), vec3(1.5, 0.36, 0.06), 2.0 * abs(p.y - 2.25));
        float flicker = 0.9 + 0.1 * sin(9.0 * masu_time() + 2.4 * cell.x + 5.1 * cell.y);
        s.emissive = mix(flame * flicker, horizon, mist);
    } else if (mist > 0.0) {
        s.emissive = mix(rough_light(s.albedo, masu_normal), horizon, mist);
    }
    if (lit || mist > 0.0) { /* and as rough as can be: it is not lit */
        s.albedo = vec3(0.0);
        s.roughness = 1.0;
    }
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.roughness = 1.0;
    s.metallic = 0.0;
    s.emissive = vec3(0.0);
    /* What does not matter here is far away. */
    float d_sand = masu_term(SAND) ? sand(p) : 1e30;
    float d_stones = masu_term(STONES) ? stones(p) : 1e30;
    vec3 in_ring = to_ring(p);
    float d_ring = masu_term(RING) ? ring(in_ring) : 1e30;
    float d_pillars = masu_term(PILLARS) ? pillars(p) : 1e30;
    vec3 in_cube = to_cube(p);
    float nearest = min(min(d_sand, d_stones), min(d_ring, d_pillars));
    if (masu_term(CUBE) && menger(in_cube) <= nearest) {
        /* Darker with depth: little light finds its way in. */
        float depth = max(-box(in_cube, vec3(cube_half)), 0.0);
        s.albedo = vec3(0.10, 0.27, 0.25) * mix(0.25, 1.0, masu_exp2(-4.0 * depth));
        s.roughness = 0.7;
    } else if (d_pillars <= nearest) {
        pillar_surface(p, s);
    } else if (d_ring <= nearest) {
        float gold = smoothstep(-0.02, 0.06, hoop(in_ring) - beads(in_ring));
        s.albedo = mix(vec3(0.52, 0.07, 0.025), vec3(0.95, 0.62, 0.26), gold);
        s.metallic = gold;
        s.roughness = mix(0.55, 0.32, gold);
    } else {
        /* Sand runs out into the colour of the sky; stone comes up through it. */
        vec3 near_sand = vec3(0.60, 0.52, 0.43);
        vec3 far_sand = 0.95 * horizon / (sun_color * sun_direction.y + ambient);
        vec3 grains = mix(near_sand, far_sand, smoothstep(8.0, 100.0, length(p.xz)));
        vec3 moss = mix(vec3(0.095, 0.10, 0.115), vec3(0.13, 0.17, 0.05),
                        smoothstep(0.05, 0.45, p.y) * step(p.x, -1.9));
        float stone = smoothstep(-0.02, 0.02, d_sand - d_stones);
        s.albedo = mix(grains, moss, stone);
        s.roughness = mix(1.0, 0.72, stone);
        /* Oil and shade under the engine. */
        vec2 under = max(abs(p.xz) - vec2(0.95, 0.2), vec2(0.0));
        s.albedo *= mix(1.0, mix(0.35, 1.0, smoothstep(0.0, 0.4, length(under))), stone);
    }
}
