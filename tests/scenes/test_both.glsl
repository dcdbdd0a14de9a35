/* A sphere that comes out of each face of the box of test_both.json. */

float masu_sdf(vec3 p)
{
    return length(p) - 0.8;
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.7, 0.6, 0.2);
    s.roughness = 0.4;
    s.metallic = 0.0;
    s.emissive = vec3(0.0);
}
