/* Reads far outside a buffer, on purpose: the tests check that the GPU-assisted validation layer is awake. */

float masu_sdf(vec3 p)
{
    return length(p) - 0.5 + 1e-30 * masu_slot(uint(masu_param(MASU_PARAM_OFFSET)));
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.5);
}
