/* posed.c: see posed.h. */
#include "support/posed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double length_of(vec v) { return sqrt(vec_dot(v, v)); }

typedef struct matrix {
    double m[3][4];
} matrix;

static matrix of_assimp(const struct aiMatrix4x4 *t) {
    return (matrix){{{(double)t->a1, (double)t->a2, (double)t->a3, (double)t->a4},
                     {(double)t->b1, (double)t->b2, (double)t->b3, (double)t->b4},
                     {(double)t->c1, (double)t->c2, (double)t->c3, (double)t->c4}}};
}

static matrix times(const matrix *a, const matrix *b) {
    matrix out;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            out.m[i][j] = j == 3 ? a->m[i][3] : 0;
            for (int k = 0; k < 3; k++) out.m[i][j] += a->m[i][k] * b->m[k][j];
        }
    }
    return out;
}

/* ---- Keys ------------------------------------------------------------------------------------ */

/* Fraction of a time between one key and the next. */
static double share_of(double from, double to, double t) {
    return to > from && t > from ? (t - from) / (to - from) : 0;
}

static vec vector_at(const struct aiVectorKey *keys, unsigned count, double t) {
    unsigned k = 0;
    while (k + 1 < count && keys[k + 1].mTime <= t) k++;
    unsigned n = k + 1 < count ? k + 1 : k;
    double share = share_of(keys[k].mTime, keys[n].mTime, t);
    const struct aiVector3D *a = &keys[k].mValue, *b = &keys[n].mValue;
    return (vec){(double)a->x + share * ((double)b->x - (double)a->x),
                 (double)a->y + share * ((double)b->y - (double)a->y),
                 (double)a->z + share * ((double)b->z - (double)a->z)};
}

static void turn_at(const struct aiQuatKey *keys, unsigned count, double t, double q[4]) {
    unsigned k = 0;
    while (k + 1 < count && keys[k + 1].mTime <= t) k++;
    unsigned n = k + 1 < count ? k + 1 : k;
    double share = share_of(keys[k].mTime, keys[n].mTime, t), dot = 0, length = 0;
    const struct aiQuaternion *x = &keys[k].mValue, *y = &keys[n].mValue;
    double a[4] = {(double)x->x, (double)x->y, (double)x->z, (double)x->w};
    double b[4] = {(double)y->x, (double)y->y, (double)y->z, (double)y->w}, la = 0, lb = 0;
    for (int i = 0; i < 4; i++) la += a[i] * a[i], lb += b[i] * b[i];
    for (int i = 0; i < 4; i++) a[i] /= sqrt(la), b[i] /= sqrt(lb), dot += a[i] * b[i];
    double side = dot < 0 ? -1 : 1, angle = acos(fmin(fabs(dot), 1));
    double one = angle > 1e-9 ? sin((1 - share) * angle) / sin(angle) : 1 - share;
    double two = angle > 1e-9 ? sin(share * angle) / sin(angle) : share;
    for (int i = 0; i < 4; i++) q[i] = one * a[i] + two * side * b[i], length += q[i] * q[i];
    for (int i = 0; i < 4; i++) q[i] /= sqrt(length);
}

static matrix channel_at(const struct aiNodeAnim *c, double t) {
    vec move = vector_at(c->mPositionKeys, c->mNumPositionKeys, t);
    vec scale = vector_at(c->mScalingKeys, c->mNumScalingKeys, t);
    double q[4];
    turn_at(c->mRotationKeys, c->mNumRotationKeys, t, q);
    double x = q[0], y = q[1], z = q[2], w = q[3];
    return (matrix){{{(1 - 2 * y * y - 2 * z * z) * scale.x, (2 * x * y - 2 * z * w) * scale.y,
                      (2 * x * z + 2 * y * w) * scale.z, move.x},
                     {(2 * x * y + 2 * z * w) * scale.x, (1 - 2 * x * x - 2 * z * z) * scale.y,
                      (2 * y * z - 2 * x * w) * scale.z, move.y},
                     {(2 * x * z - 2 * y * w) * scale.x, (2 * y * z + 2 * x * w) * scale.y,
                      (1 - 2 * x * x - 2 * y * y) * scale.z, move.z}}};
}

/* ---- Nodes and vertices ---------------------------------------------------------------------- */

typedef struct file {
    const struct aiScene *scene;
    const struct aiAnimation *animation; /* NULL: bind pose */
    double ticks;
    posed out;
} file;

static matrix world_of(const file *f, const struct aiNode *node) {
    matrix own = of_assimp(&node->mTransformation);
    for (unsigned i = 0; f->animation && i < f->animation->mNumChannels; i++) {
        if (!strcmp(f->animation->mChannels[i]->mNodeName.data, node->mName.data))
            own = channel_at(f->animation->mChannels[i], f->ticks);
    }
    if (!node->mParent) return own;
    matrix above = world_of(f, node->mParent);
    return times(&above, &own);
}

static const struct aiNode *find(const struct aiNode *node, const char *name) {
    if (!strcmp(node->mName.data, name)) return node;
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        const struct aiNode *found = find(node->mChildren[i], name);
        if (found) return found;
    }
    return NULL;
}

static vec apply(const matrix *m, const struct aiVector3D *v, double one) {
    double x = (double)v->x, y = (double)v->y, z = (double)v->z;
    return (vec){m->m[0][0] * x + m->m[0][1] * y + m->m[0][2] * z + m->m[0][3] * one,
                 m->m[1][0] * x + m->m[1][1] * y + m->m[1][2] * z + m->m[1][3] * one,
                 m->m[2][0] * x + m->m[2][1] * y + m->m[2][2] * z + m->m[2][3] * one};
}

/* Uses the cofactors of the matrix. */
static vec turned(const matrix *m, const struct aiVector3D *v) {
    const vec r0 = {m->m[0][0], m->m[0][1], m->m[0][2]}, r1 = {m->m[1][0], m->m[1][1], m->m[1][2]},
              r2 = {m->m[2][0], m->m[2][1], m->m[2][2]},
              n = {(double)v->x, (double)v->y, (double)v->z};
    vec c0 = vec_cross(r1, r2);
    vec out = {vec_dot(c0, n), vec_dot(vec_cross(r2, r0), n), vec_dot(vec_cross(r0, r1), n)};
    return vec_unit(vec_dot(r0, c0) < 0 ? vec_scale(out, -1) : out);
}

static void add_mesh(file *f, const struct aiMesh *mesh) {
    size_t first = f->out.count;
    matrix *sums = calloc(mesh->mNumVertices, sizeof *sums);
    for (unsigned b = 0; b < mesh->mNumBones; b++) {
        const struct aiBone *bone = mesh->mBones[b];
        const struct aiNode *node = find(f->scene->mRootNode, bone->mName.data);
        assert_non_null(node);
        matrix world = world_of(f, node), bind = of_assimp(&bone->mOffsetMatrix);
        matrix whole = times(&world, &bind);
        for (unsigned w = 0; w < bone->mNumWeights; w++) {
            matrix *sum = &sums[bone->mWeights[w].mVertexId];
            for (int i = 0; i < 12; i++)
                (&sum->m[0][0])[i] += (double)bone->mWeights[w].mWeight * (&whole.m[0][0])[i];
        }
    }
    f->out.count += mesh->mNumVertices;
    f->out.vertices = realloc(f->out.vertices, f->out.count * sizeof *f->out.vertices);
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        posed_vertex *to = &f->out.vertices[first + i];
        const struct aiVector3D *v = &mesh->mVertices[i];
        *to = (posed_vertex){.rest = {v->x, v->y, v->z}, .position = apply(&sums[i], v, 1)};
        if (mesh->mNormals) to->normal = turned(&sums[i], &mesh->mNormals[i]);
    }
    free(sums);
}

static void walk(file *f, const struct aiNode *node) {
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        const struct aiMesh *mesh = f->scene->mMeshes[node->mMeshes[i]];
        if (mesh->mNumBones) add_mesh(f, mesh);
    }
    for (unsigned i = 0; i < node->mNumChildren; i++) walk(f, node->mChildren[i]);
}

posed posed_at(const char *path, unsigned animation, double time) {
    file f = {.scene = aiImportFile(path, aiProcess_Triangulate | aiProcess_GenSmoothNormals)};
    if (!f.scene) fail_msg("%s: %s", path, aiGetErrorString());
    if (time >= 0) {
        assert_true(animation < f.scene->mNumAnimations);
        f.animation = f.scene->mAnimations[animation];
        double rate = f.animation->mTicksPerSecond > 0 ? f.animation->mTicksPerSecond : 1;
        f.ticks = time * rate;
        f.out.duration = f.animation->mDuration / rate;
    }
    walk(&f, f.scene->mRootNode);
    aiReleaseImport(f.scene);
    return f.out;
}

const posed_vertex *posed_find(const posed *all, const float rest[3], vec position, vec normal) {
    const posed_vertex *best = NULL;
    double least = (double)INFINITY;
    for (size_t i = 0; i < all->count; i++) {
        const posed_vertex *v = &all->vertices[i];
        if (v->rest[0] != rest[0] || v->rest[1] != rest[1] || v->rest[2] != rest[2]) continue;
        /* Vertices at one position usually have the same joints: the normal distinguishes them. */
        double off =
            length_of(vec_sub(v->position, position)) + 1e-3 * (1 - vec_dot(v->normal, normal));
        if (off < least) least = off, best = v;
    }
    return best;
}
