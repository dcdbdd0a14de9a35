/* fuzz_gltf.c: any bytes as a glTF file, by our own reader, to the aiScene that it makes. What is refused must have
 * one line of error; of what is accepted all indices are followed. Files beside the model are not read. */
#include "expect.h"

#include "bake/import/gltf.h"

static float sum; /* what is read is used */

static void walk_mesh(const masu_gltf *g, const struct aiMesh *mesh) {
    EXPECT(mesh->mMaterialIndex < g->given.bytes / sizeof(masu_import_given));
    EXPECT(mesh->mVertices && mesh->mNormals);
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        sum += mesh->mVertices[i].x + mesh->mNormals[i].z;
        if (mesh->mTextureCoords[0]) sum += mesh->mTextureCoords[0][i].y;
    }
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        EXPECT(mesh->mFaces[i].mNumIndices == 3);
        sum += (float)(mesh->mFaces[i].mIndices[2] &
                       1); /* its range is judged later, triangle by triangle */
    }
    for (unsigned b = 0; b < mesh->mNumBones; b++) {
        for (unsigned w = 0; w < mesh->mBones[b]->mNumWeights; w++)
            EXPECT(mesh->mBones[b]->mWeights[w].mVertexId < mesh->mNumVertices);
    }
}

static void walk_node(const masu_gltf *g, const struct aiNode *node, int depth) {
    for (unsigned i = 0; i < node->mNumMeshes; i++) EXPECT(node->mMeshes[i] < g->scene.mNumMeshes);
    for (unsigned i = 0; i < node->mNumChildren && depth < 1000; i++)
        walk_node(g, node->mChildren[i], depth + 1);
}

static void walk(const masu_gltf *g) {
    for (unsigned i = 0; i < g->scene.mNumMeshes; i++) walk_mesh(g, g->scene.mMeshes[i]);
    walk_node(g, g->scene.mRootNode, 0);
    for (unsigned i = 0; i < g->scene.mNumAnimations; i++) {
        const struct aiAnimation *a = g->scene.mAnimations[i];
        for (unsigned k = 0; k < a->mNumChannels; k++) {
            const struct aiNodeAnim *c = a->mChannels[k];
            if (c->mNumRotationKeys) sum += c->mRotationKeys[c->mNumRotationKeys - 1].mValue.w;
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    masu_bake_content content = {0};
    masu_bake_buffer warnings = {0}, error = {0};
    masu_gltf g = {.wanted = MASU_BAKE_TEXTURES_FORCED,
                   .piece = &content,
                   .warnings = &warnings,
                   .error = &error};
    bool good = masu_gltf_read_bytes(&g, data, size);
    EXPECT(good ? error.bytes == 0 : error.bytes > 0);
    EXPECT(!error.bytes || !memchr(error.data, '\n', error.bytes));
    if (good) walk(&g);
    masu_gltf_release(&g);
    masu_bake_content_release(&content);
    masu_bake_release(&warnings);
    masu_bake_release(&error);
    return 0;
}
