/* The sphere of test_sphere_mesh.json as a distance field. */

float masu_sdf(vec3 p)
{
    return length(p) - masu_param(MASU_PARAM_RADIUS);
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.7, 0.3, 0.2);
    s.roughness = 0.5;
    s.metallic = 0.0;
    s.emissive = vec3(0.0);
}
