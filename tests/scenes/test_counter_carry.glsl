/* A field that counts by itself: 2^17 for each evaluation, so that a small picture brings a counter's
 * low word past 2^32, and no workgroup its shared sum: 64 pixels of 300 evaluations are 2.5e9. */

float masu_sdf(vec3 p)
{
    masu_count(MASU_COUNTER_REPLACED, 131072u);
    return length(p) - 1.0;
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.5);
}
