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

/* As in engine.json: the far end of the world is painted with the light of the sky. */
const vec3 horizon = vec3(0.80, 0.58, 0.44);
const vec3 sun_direction = vec3(-0.7660, 0.3420, 0.5443);
const vec3 sun_color = vec3(2.30, 1.58, 0.94);
const vec3 ambient = vec3(0.17, 0.21, 0.30);

const float furrow_depth = 0.011;
const float furrow_number = 34.0; /* radians per metre */
const float clearing = 10.5;      /* no pillar stands on this circle: none is cut by it */
const float pillar_spacing = 6.0;
const vec3 ring_center = vec3(0.9, 2.05, -5.6);
const vec3 cube_center = vec3(8.2, 1.3, -9.5);

float smooth_min(float a, float b, float k)
{
    float h = max(k - abs(a - b), 0.0) / k;
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
    float d = column(p, vec2(0.0, 0.0), 0.52, 0.56);
    d = smooth_min(d, column(p, vec2(-0.93, 0.50), 0.48, 0.30), 0.05);
    d = smooth_min(d, column(p, vec2(0.90, -0.52), 0.46, 0.42), 0.05);
    d = smooth_min(d, column(p, vec2(0.06, 0.98), 0.40, 0.16), 0.05);
    d = smooth_min(d, length(p - vec3(-2.9, -0.15, -1.1)) - 0.62, 0.25);
    d = smooth_min(d, length(p - vec3(-3.5, -0.12, -0.7)) - 0.40, 0.25);
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
    return (p.y - wave) / sqrt(1.0 + slope * slope);
}

/* ---- ring, cube, pillars ---- */

float ring(vec3 p)
{
    vec3 q = p - ring_center;
    q.xz = turned(q.xz, 0.9553, 0.2955);
    float d = length(vec2(length(q.xy) - 2.3, q.z)) - 0.16;
    /* 24 beads: the plane folded by reflections into one sector of 15 degrees. */
    vec2 b = abs(q.xy);
    b = b.y > b.x ? b.yx : b;                                               /* 8 sectors of 45 */
    b -= 2.0 * min(dot(b, vec2(0.2588190, -0.9659258)), 0.0) * vec2(0.2588190, -0.9659258);
    float bead = length(vec3(b - vec2(2.3 * 0.9914449, 2.3 * 0.1305262), q.z)) - 0.27;
    return smooth_min(d, bead, 0.22);
}

float box(vec3 p, float h)
{
    vec3 q = abs(p) - h;
    return length(max(q, vec3(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0);
}

/* Three levels. Each cuts square tunnels, repeated in cells that are mirror images of each other. */
float menger(vec3 p)
{
    const float h = 1.8;
    float d = box(p, h);
    float cell = 2.0 * h;
    for (int i = 0; i < 3; i++) {
        vec3 q = abs(p - cell * round(p / cell));
        q = i == 0 ? abs(p) : q;
        vec3 m = max(q.xyz, q.yzx);
        d = max(d, cell / 6.0 - min(m.x, min(m.y, m.z)));
        cell /= 3.0;
    }
    return d;
}

vec3 to_cube(vec3 p)
{
    vec3 q = p - cube_center;
    q.xz = turned(q.xz, 0.8253, 0.5646);
    q.xy = turned(q.xy, 0.9211, -0.3894);
    q.yz = turned(q.yz, 0.9553, 0.2955);
    return q;
}

float pillars(vec3 p)
{
    vec2 q = p.xz - pillar_spacing * round(p.xz / pillar_spacing);
    float r = length(q);
    vec2 shaft = vec2(r - 0.30, p.y - 2.3);
    float d = min(max(shaft.x, shaft.y), 0.0) + length(max(shaft, vec2(0.0))) - 0.06;
    d = smooth_min(d, length(vec2(r, p.y - 2.95)) - 0.52, 0.10);
    return max(d, clearing - length(p.xz));
}

float masu_sdf(vec3 p)
{
    float d = sand(p);
    d = smooth_min(d, stones(p), 0.06);
    d = min(d, pillars(p));
    d = min(d, ring(p));
    vec3 q = to_cube(p);
    /* The cube's tunnels only count where its box is nearer than all the rest. */
    if (box(q, 1.8) < d) {
        d = min(d, menger(q));
    }
    return d;
}

/* ---- surfaces ---- */

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.roughness = 1.0;
    s.metallic = 0.0;
    s.emissive = vec3(0.0);
    s.albedo = vec3(0.5);
}
