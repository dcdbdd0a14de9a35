/*
 * hand_written.glsl: the declarations that masu-sdfc generates next to the field, for a
 * hand-written field: one part, without bounds, and no half-spaces.
 */
#define MASU_SDF_PART_COUNT 1
#define MASU_SDF_LISTED_COUNT 1
#define MASU_SDF_MASKED 1
#define MASU_SDF_SLOT_COUNT 1
#ifdef MASU_SDF_TERMS
#if !MASU_SDF_TERMS_FOUND
#error MASU_SDF_TERMS must be defined in the scene's file by a line "#define MASU_SDF_TERMS ..."
#endif
#define MASU_SDF_BLOCK_WORDS 1
#define MASU_SDF_TERM_BITS_0 0xFFFFFFFEu
#else
#define MASU_SDF_BLOCK_WORDS 0
#define MASU_SDF_TERM_BITS_0 0u
#endif
#define MASU_SDF_TERM_BITS_1 0u
#ifdef MASU_SDF_SMOOTH
#define MASU_SDF_ROUGH 0
#else
#define MASU_SDF_ROUGH 1
#endif
#define MASU_SDF_DYNAMIC 0

vec4 masu_sdf_bounds(uint part)
{
    return vec4(0.0, 0.0, 0.0, -1.0);
}

void masu_sdf_box(out vec3 low, out vec3 high)
{
    low = vec3(-1e30);
    high = vec3(1e30);
}

float masu_sdf_with(vec3 p, out uint part)
{
    part = 0u;
    return masu_sdf(p);
}

uint masu_sdf_nearest(vec3 p)
{
    return 0u;
}

float masu_sdf_flat(vec3 o, vec3 d, float start, out uint part)
{
    part = 1u;
    return 1e30;
}

vec3 masu_sdf_flat_normal(uint part)
{
    return vec3(0.0);
}

void masu_sdf_part_surface(uint part, vec3 p, inout masu_surface s)
{
    masu_sdf_surface(p, s);
}

#ifdef MASU_MOTION
/* The field may depend on time and parameters. */
#define MASU_SDF_MOVING 1
#define MASU_SDF_MOVING_FLAT 0

uint masu_sdf_moving_bits(int word)
{
    return 1u;
}

bool masu_sdf_part_moves(uint part)
{
    return true;
}

float masu_sdf_part(uint part, vec3 p)
{
    return masu_sdf(p);
}

vec3 masu_sdf_root(uint part, vec3 p, bool out_of)
{
    return p;
}
#endif
