/* A field that breaks in every way, for the tests: NaN left of x = 0, infinity above y = 0.5, and a sphere whose surface has
 * no finite attribute. The bit patterns come through a parameter so that no compiler can fold them away. */

float broken(uint bits)
{
    return uintBitsToFloat(bits | uint(masu_param(MASU_PARAM_ZERO)));
}

float masu_sdf(vec3 p)
{
    if (p.x < 0.0) {
        return broken(0x7FC00000u);
    }
    if (p.y > 0.5) {
        return broken(0x7F800000u);
    }
    return length(p - vec3(0.6, -0.1, 0.0)) - 0.5;
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(broken(0x7FC00001u), broken(0xFF800000u), 1e30);
    s.roughness = broken(0x7F800000u);
    s.metallic = broken(0xFFC00000u);
    s.emissive = vec3(broken(0xFF800000u), -1.0, broken(0x7FFFFFFFu));
}
