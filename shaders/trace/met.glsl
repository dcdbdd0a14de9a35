/*
 * met.glsl: the surface at a ray's hit, decoded from images and buffers (specular/ray.glsl). After
 * shared/pack.glsl, specular/ray.glsl and, with polygons, trace/scene.glsl and trace/texels.glsl.
 */
#ifndef MASU_TRACE_MET_GLSL
#define MASU_TRACE_MET_GLSL

/* Surface and normal at a hit. */
struct met {
    masu_surface surface;
    vec3 normal; /* unit, on the side of the ray's origin */
};

met met_sdf(uvec4 hit)
{
    met m;
    m.surface = masu_unpack_met(unpackUnorm4x8(hit.w), hit.z);
    m.normal = masu_unpack_normal(hit.z);
    return m;
}

#ifdef MASU_TRACE_POLYGONS
met met_polygon(uvec4 hit, vec3 direction, float width)
{
    met m;
    vec2 b = unpackUnorm2x16(hit.w);
    vec3 weights = vec3(1.0 - b.x - b.y, b);
    uvec4 triangle = masu_trace_triangle(hit.z);
    hit.y = masu_trace_instance(hit.y);
    vec3 p0 = uintBitsToFloat(masu_trace_vertices[triangle.x].xyz);
    vec3 p1 = uintBitsToFloat(masu_trace_vertices[triangle.y].xyz);
    vec3 p2 = uintBitsToFloat(masu_trace_vertices[triangle.z].xyz);
    vec3 normal = masu_trace_vertex_normal(triangle.x) * weights.x +
                  masu_trace_vertex_normal(triangle.y) * weights.y +
                  masu_trace_vertex_normal(triangle.z) * weights.z;
    vec3 flat_normal = masu_normalize(masu_trace_upright(hit.y, cross(p1 - p0, p2 - p0)),
                                      -direction);
    m.normal = masu_normalize(masu_trace_upright(hit.y, normal), flat_normal);
    m.normal = dot(flat_normal, direction) > 0.0 ? -m.normal : m.normal;
    /* As in the raster: a normal that points away is rotated until it does not. */
    float away = dot(m.normal, direction);
    if (away > 0.0) {
        m.normal = masu_normalize(m.normal - away * direction, -direction);
    }

    masu_trace_material look = masu_trace_material_at(triangle.w & MASU_TRACE_MATERIAL);
    m.surface = masu_plain_surface(look.base_color.rgb, look.base_color.w);
    m.surface.emissive = look.emissive.rgb;
    m.surface.metallic = look.emissive.w;
    masu_take_specular(m.surface, look.more.x);
    m.surface.coat = look.more.y;
    m.surface.coat_roughness = look.more.z;
#ifdef MASU_TRACE_TEXTURES
    if (look.maps.x != MASU_TRACE_NONE || look.maps.y != MASU_TRACE_NONE) {
        vec2 uv = masu_trace_uv(triangle.xyz, b);
        vec2 u0 = masu_trace_texcoord(triangle.x, 0u);
        vec4 moved = vec4(0.0, 0.0, 1.0, 1.0);
        if (masu_looks) {
            moved = masu_trace_look(hit.y, 1u);
            uv = uv * moved.zw + moved.xy;
        }
        vec2 u1 = masu_trace_texcoord(triangle.y, 0u) - u0,
             u2 = masu_trace_texcoord(triangle.z, 0u) - u0;
        vec3 w1 = masu_trace_now(hit.y, vec4(p1 - p0, 0.0));
        vec3 w2 = masu_trace_now(hit.y, vec4(p2 - p0, 0.0));
        float across = length(cross(w1, w2)),
              wide = abs((u1.x * u2.y - u1.y * u2.x) * moved.z * moved.w);
        float density = masu_sqrt(wide * masu_rcp(across)); /* texture coordinates per metre */
        float lod = masu_log2(max(width, 1e-9) * density /
                              max(masu_sqrt(abs(dot(flat_normal, direction))), 0.1));
        /* In a loop, so that the lookup is compiled only once. */
        [[dont_unroll]] for (int i = 0; i < 2; i++) {
            uint map = i == 0 ? look.maps.x : look.maps.y;
            if (map != MASU_TRACE_NONE) {
                vec2 at = uv;
                if (masu_attributes >= 2u && i == 1 && (look.maps.w & MASU_TRACE_SECOND) != 0u) {
                    at = masu_trace_second_uv(triangle.xyz, b) * moved.zw + moved.xy;
                }
                vec3 texel = masu_trace_sized(map, at, lod, look.maps.w).rgb;
                m.surface.albedo *= i == 0 ? texel : vec3(1.0);
                m.surface.emissive *= i == 0 ? vec3(1.0) : texel;
            }
        }
    }
    if ((masu_attributes & 1u) != 0u) {
        vec3 color = masu_trace_color(triangle.xyz, weights);
        m.surface.emissive *= masu_is_unlit(m.surface) ? color : vec3(1.0);
        m.surface.albedo *= color;
    }
#endif
    if (masu_looks) {
        vec4 tint = masu_trace_look(hit.y, 0u);
        m.surface.emissive *= masu_is_unlit(m.surface) ? tint.rgb : vec3(1.0);
        m.surface.albedo *= tint.rgb;
        m.surface.emissive *= tint.w;
    }
    return m;
}
#endif

#endif
