/* A solid around the camera: its surface is the near plane, at depth 1, for each ray. */

float masu_sdf(vec3 p)
{
    return length(p) - 3.0;
}

void masu_sdf_surface(vec3 p, inout masu_surface s)
{
    s.albedo = vec3(0.8, 0.1, 0.1);
}
