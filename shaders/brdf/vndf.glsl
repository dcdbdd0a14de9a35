/*
 * vndf.glsl: importance sampling of the specular lobe of bsdf.glsl by visible normals
 * (masu_vndf_reflect): light directions, their weights and densities. The space is local: the
 * normal is +z (masu_axes).
 *
 * A stretch by alpha maps the visible normals of GGX to those of a sphere, and the sum of the view
 * and a uniform point of a spherical cap is such a normal (Dupuy and Benyoub, "Sampling Visible GGX
 * Normals with Spherical Caps", HPG 2023). On rough surfaces much of the cap reflects below the
 * surface, half of it at alpha 1; the part of the cap that cannot reflect above the surface is cut
 * off (Eto and Tokuyoshi, "Bounded VNDF Sampling for Smith-GGX Reflections", SIGGRAPH Asia 2023).
 * The cut only lowers the weight, so it remains below 1.
 *
 *   weight = lobe * N.l / pdf, without Fresnel; its mean is the table's 1 - loss (tables.glsl)
 *
 * Defined for every input: a view below the surface is treated as 1e-4 above it, as in bsdf.glsl,
 * NaN as the normal; weights are within 0..1, directions and densities finite. No vector
 * arithmetic, so that tests can compile the code as C and draw millions of directions.
 */
#ifndef MASU_VNDF_GLSL
#define MASU_VNDF_GLSL

#include "brdf/ggx.glsl"
#include "shared/guard.glsl"

/* Up to here a lobe is treated as a mirror: roughness 0.045 and less, which the tables and the
 * lights also treat as one roughness. Half of that lobe is within 0.23 degrees of the mirror
 * direction. A mirror needs one ray without noise. */
const float masu_mirror_alpha = 0.00203;

struct masu_axes {
    vec3 t, b, n;
};

/* A light direction, the weight of its radiance (before Fresnel), its density per steradian. A
 * weight of 0: l is below the surface, no ray is needed. */
struct masu_vndf_ray {
    vec3 l;
    float weight;
    float pdf;
};

/* Right-handed basis for every unit normal (Duff et al., "Building an Orthonormal Basis,
 * Revisited", JCGT 6-1, 2017). Frisvad's, which has no sign, loses all digits near n.z = -1. An
 * invalid direction becomes +z. */
masu_axes masu_axes_of(vec3 normal)
{
    masu_axes f;
    vec3 n = masu_normalize(normal, vec3(0.0, 0.0, 1.0));
    float sign_z = n.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (sign_z + n.z);
    float c = n.x * n.y * a;
    f.t = vec3(1.0 + sign_z * n.x * n.x * a, sign_z * c, -sign_z * n.x);
    f.b = vec3(c, sign_z + n.y * n.y * a, -n.y);
    f.n = n;
    return f;
}

vec3 masu_axes_in(masu_axes f, vec3 world)
{
    return vec3(dot(f.t, world), dot(f.b, world), dot(f.n, world));
}

vec3 masu_axes_out(masu_axes f, vec3 local)
{
    return vec3(f.t.x * local.x + f.b.x * local.y + f.n.x * local.z,
                f.t.y * local.x + f.b.y * local.y + f.n.y * local.z,
                f.t.z * local.x + f.b.z * local.y + f.n.z * local.z);
}

/* Makes any vector a unit vector above the surface. */
vec3 masu_vndf_view(vec3 v)
{
    float x = masu_sane(v.x, -1.0, 1.0), y = masu_sane(v.y, -1.0, 1.0);
    float z = masu_sane(v.z, 1e-4, 1.0);
    float r = masu_rsqrt(x * x + y * y + z * z);
    return vec3(x * r, y * r, z * r);
}

/* Exactly the alpha of the lobe: with a slightly larger one the peak is lower, and the ratio of a
 * mirror's light and its density would be half a percent too high. */
float masu_vndf_alpha(float alpha)
{
    return masu_sane(alpha, masu_alpha(0.0), 1.0);
}

/* Extent of the cap below the equator as a share of the view's height: 1 is the whole cap. v from
 * masu_vndf_view. */
float masu_vndf_bound(vec3 v, float alpha)
{
    float a2 = alpha * alpha;
    float s = 1.0 + sqrt(v.x * v.x + v.y * v.y), s2 = s * s;
    return (1.0 - a2) * s2 / (s2 + a2 * v.z * v.z);
}

/* The density of l is D divided by twice this value. */
float masu_vndf_norm(vec3 v, float alpha)
{
    return masu_vndf_bound(v, alpha) * v.z + masu_ggx_root(alpha * alpha, v.z);
}

/* For the next three functions v is from masu_vndf_view, a from masu_vndf_alpha. */

vec3 masu_vndf_normal(vec3 v, float a, vec2 u)
{
    float wx = a * v.x, wy = a * v.y;
    float r = masu_rsqrt(wx * wx + wy * wy + v.z * v.z);
    wx *= r;
    wy *= r;
    float wz = v.z * r;
    /* A point of the cap, whose pole is +z: down to -bound * wz. down is 1 - z: sqrt(1 - z^2) would
     * cancel. sin and cos are the most precise within +-pi. */
    float down = masu_sane(u.y, 0.0, 1.0) * (1.0 + masu_vndf_bound(v, a) * wz);
    float radius = sqrt(max(down * (2.0 - down), 0.0));
    float phi = 6.2831853 * masu_sane(u.x, 0.0, 1.0) - 3.1415927;
    float hx = radius * cos(phi) + wx, hy = radius * sin(phi) + wy;
    float hz = max(1.0 - down + wz, 0.0);
    return masu_normalize(vec3(a * hx, a * hy, hz), vec3(0.0, 0.0, 1.0));
}

/* Density of the direction that h reflects v to. */
float masu_vndf_density(vec3 v, vec3 h, float a)
{
    float k = masu_ggx_peak(max(h.z, 0.0), h.x * h.x + h.y * h.y, a);
    return k * k * (0.5 / 3.1415927) / masu_vndf_norm(v, a);
}

/* lobe * N.l / density: D cancels, and the rest is at most 1, since bound is at most 1 and
 * masu_ggx_root(l) at least n_l. */
float masu_vndf_worth(vec3 v, float n_l, float a)
{
    float l = min(n_l, 1.0);
    return masu_sane(l * masu_vndf_norm(v, a) / masu_ggx_masking(a, l, v.z), 0.0, 1.0);
}

/* A visible normal, unit; u: 0..1 each. */
vec3 masu_vndf_sample(vec3 v_local, float alpha, vec2 u)
{
    if (!(alpha > masu_mirror_alpha)) {
        return vec3(0.0, 0.0, 1.0);
    }
    return masu_vndf_normal(masu_vndf_view(v_local), masu_vndf_alpha(alpha), u);
}

/* Density of the reflected direction l, per steradian; 0 below the surface. A mirror has the
 * density of the smoothest lobe. Its integral over the hemisphere is 1 minus the share of
 * directions below the surface. */
float masu_vndf_pdf(vec3 v_local, vec3 l, float alpha)
{
    if (!(l.z > 0.0)) {
        return 0.0;
    }
    vec3 v = masu_vndf_view(v_local);
    vec3 h = masu_normalize(vec3(v.x + l.x, v.y + l.y, v.z + l.z), vec3(0.0, 0.0, 1.0));
    return masu_vndf_density(v, h, masu_vndf_alpha(alpha));
}

/* Weight of the light from l, 0..1. A mirror has the weight of the smoothest lobe, so that there is
 * no step. */
float masu_vndf_weight(vec3 v_local, vec3 l, float alpha)
{
    if (!(l.z > 0.0)) {
        return 0.0;
    }
    return masu_vndf_worth(masu_vndf_view(v_local), l.z, masu_vndf_alpha(alpha));
}

/* Samples one ray of the lobe. The density is the same as from masu_vndf_pdf, and more exact for a
 * narrow lobe: v + l has lost digits that h has. */
masu_vndf_ray masu_vndf_reflect(vec3 v_local, float alpha, vec2 u)
{
    masu_vndf_ray ray;
    vec3 v = masu_vndf_view(v_local);
    float a = masu_vndf_alpha(alpha);
    vec3 h = vec3(0.0, 0.0, 1.0);
    if (alpha > masu_mirror_alpha) {
        h = masu_vndf_normal(v, a, u);
    }
    float twice = 2.0 * dot(v, h);
    ray.l = vec3(twice * h.x - v.x, twice * h.y - v.y, twice * h.z - v.z);
    ray.weight = 0.0;
    ray.pdf = 0.0;
    if (ray.l.z > 0.0) {
        ray.weight = masu_vndf_worth(v, ray.l.z, a);
        ray.pdf = masu_vndf_density(v, h, a);
    }
    return ray;
}

#endif
