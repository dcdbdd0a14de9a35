/* Continues the box of test_truth.json below y = 0: their left edges are one line. */

float masu_sdf(vec3 p)
{
    vec3 d = abs(p - vec3(3.987, -2.0, -5.5)) - vec3(4.0, 2.0, 0.5);
    return length(max(d, vec3(0.0))) + min(max(d.x, max(d.y, d.z)), 0.0);
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.0);
    s.roughness = 1.0;
    s.metallic = 0.0;
    s.emissive = vec3(0.3);
}
