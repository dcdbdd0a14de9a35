/* The sphere of test_sphere_sdf.json without its parameter. */

float masu_sdf(vec3 p)
{
    return length(p) - 1.0;
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.7, 0.3, 0.2);
    s.roughness = 0.5;
    s.metallic = 0.0;
    s.emissive = vec3(0.0);
}
