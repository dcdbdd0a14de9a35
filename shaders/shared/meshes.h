/* meshes.h: uploads of meshes that the host creates at run time (src/frame/meshes.c), as the
 * shaders mesh_*.comp read them. A slot of the buffer, in uvec4:
 *
 *   0                    arguments of the indirect dispatches: workgroups, jobs, 1, 0
 *   1 + 4 j              job j, four elements, of one mesh:
 *     x first vertex           y vertices       z where they are; 0: unchanged
 *                                               w 1: they have moved
 *     x first triangle         y triangles; 0: unchanged     z where they are
 *                                               w where texture coordinates are; 0: none, all 0
 *     x first node             y nodes          z where they are      w material, as of ray hits
 *     x where colours are; 0: none, white       y first triangle of ray hits     z, w unused
 *   behind the jobs      data: vertices, one element each; triangles, three indices each, without
 *                        padding; texture coordinates, two floats; colours; nodes
 */
#ifndef MASU_SHARED_MESHES_H
#define MASU_SHARED_MESHES_H

#define MASU_MESH_JOB_UVEC4 4u

#endif
