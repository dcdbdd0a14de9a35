/* The sphere of test_sphere_sdf.json times three: a field of Lipschitz constant 3, declared so. It
 * moves with time: the tests look at time 0 and at time 1. */

float masu_sdf(vec3 p)
{
    return 3.0 * (length(p - vec3(masu_time() * 0.5, 0.0, 0.0)) - 1.0);
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.25, 0.5, 1.0);
    s.roughness = 0.5;
    s.emissive = p.y > 0.5 ? vec3(4.0, 1.0, 0.25) : vec3(0.0);
}
