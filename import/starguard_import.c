/* SPDX-License-Identifier: Apache-2.0 */
/* starguard-import FILE: reads a scene by assimp and writes it as one binary PLY to standard
 * output.
 *
 * starguard runs it as a child with limits of memory and time, so that a file that crashes an
 * importer hurts nobody. Transforms of nodes are applied in double precision; corners of a mesh at
 * equal positions become one vertex; polygons stay as they are. Names of nodes and materials stand
 * in comments of the header, `group` and `material` of each face give their numbers. */
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 256, CORNERS_LIMIT = 4096 };

typedef struct instance {
    const struct aiMesh *mesh;
    double transform[3][4];
    uint32_t group;
} instance;

typedef struct scene {
    const struct aiScene *file;
    instance *instances;
    size_t count, capacity;
    const struct aiNode **groups; /* by number */
    size_t group_count, group_capacity;
    int up; /* axis that becomes z, or -1 */
} scene;

typedef struct point {
    double p[3];
    uint32_t corner;
} point;

static int fail(const char *message) {
    fprintf(stderr, "%s\n", message);
    return 2;
}

static void *grow(void *block, size_t count, size_t *capacity, size_t size) {
    if (count < *capacity)
        return block;
    size_t more = *capacity == 0 ? 16 : 2 * *capacity;
    void *larger = realloc(block, more * size);
    if (larger == NULL) {
        fprintf(stderr, "out of memory\n");
        exit(3);
    }
    *capacity = more;
    return larger;
}

static void multiply(double a[3][4], const struct aiMatrix4x4 *m, double out[3][4]) {
    const double b[4][4] = {{m->a1, m->a2, m->a3, m->a4},
                            {m->b1, m->b2, m->b3, m->b4},
                            {m->c1, m->c2, m->c3, m->c4},
                            {0, 0, 0, 1}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) {
            out[i][k] = k == 3 ? a[i][3] : 0;
            for (int j = 0; j < 3; j++)
                out[i][k] += a[i][j] * b[j][k];
        }
}

/* Meshes of lines and points bound nothing. */
static int collect(scene *s, const struct aiNode *node, double above[3][4], int depth) {
    double own[3][4];
    multiply(above, &node->mTransformation, own);
    if (depth > DEEPEST)
        return fail("nodes are nested too deep");
    if (node->mNumMeshes > 0) {
        s->groups = grow(s->groups, s->group_count, &s->group_capacity, sizeof *s->groups);
        s->groups[s->group_count++] = node;
    }
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        if (node->mMeshes[i] >= s->file->mNumMeshes)
            return fail("a node names a mesh that is not there");
        s->instances = grow(s->instances, s->count, &s->capacity, sizeof *s->instances);
        instance *item = &s->instances[s->count++];
        item->mesh = s->file->mMeshes[node->mMeshes[i]];
        item->group = (uint32_t)(s->group_count - 1);
        memcpy(item->transform, own, sizeof own);
    }
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        int status = collect(s, node->mChildren[i], own, depth + 1);
        if (status != 0)
            return status;
    }
    return 0;
}

static int compare_points(const void *left, const void *right) {
    const point *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->p[k] != b->p[k])
            return a->p[k] < b->p[k] ? -1 : 1;
    return (a->corner > b->corner) - (a->corner < b->corner);
}

/* vertex[i] becomes the lowest corner at the place of i. */
static point *place_points(const instance *item, uint32_t *vertex, int up) {
    const struct aiMesh *mesh = item->mesh;
    point *points = malloc((mesh->mNumVertices + 1) * sizeof *points);
    for (uint32_t i = 0; points != NULL && i < mesh->mNumVertices; i++) {
        const struct aiVector3D *v = &mesh->mVertices[i];
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = item->transform[k][0] * (double)v->x + item->transform[k][1] * (double)v->y +
                   item->transform[k][2] * (double)v->z + item->transform[k][3] + 0.0;
        for (int k = 0; k < 3; k++) /* turns the axis `up` to z, and keeps the hand */
            points[i].p[k] = p[up < 0 ? k : (up + 1 + k) % 3];
        points[i].corner = i;
    }
    if (points == NULL)
        return NULL;
    qsort(points, mesh->mNumVertices, sizeof *points, compare_points);
    for (uint32_t i = 0, first = 0; i < mesh->mNumVertices; i++) {
        if (memcmp(points[i].p, points[first].p, sizeof points[i].p) != 0)
            first = i;
        vertex[points[i].corner] = points[first].corner;
    }
    return points;
}

/* A name for the header: one line, printable. */
static void print_name(const char *kind, size_t number, const char *name, size_t length) {
    printf("comment %s %zu ", kind, number);
    for (size_t i = 0; i < length && i < 200; i++)
        putchar((unsigned char)name[i] < ' ' ? '_' : name[i]);
    putchar('\n');
}

static void print_names(const scene *s) {
    for (size_t i = 0; i < s->group_count; i++)
        print_name("group", i, s->groups[i]->mName.data, s->groups[i]->mName.length);
    for (unsigned i = 0; i < s->file->mNumMaterials; i++) {
        struct aiString name;
        if (aiGetMaterialString(s->file->mMaterials[i], AI_MATKEY_NAME, &name) == AI_SUCCESS)
            print_name("material", i, name.data, name.length);
    }
}

static size_t faces_of(const struct aiMesh *mesh) {
    size_t count = 0;
    for (unsigned f = 0; f < mesh->mNumFaces; f++)
        count += mesh->mFaces[f].mNumIndices >= 3 && mesh->mFaces[f].mNumIndices <= CORNERS_LIMIT;
    return count;
}

static void write_faces(const instance *item, const uint32_t *vertex, uint32_t base) {
    double(*t)[4] = ((instance *)(uintptr_t)item)->transform;
    double turn = t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) -
                  t[0][1] * (t[1][0] * t[2][2] - t[1][2] * t[2][0]) +
                  t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0]);
    for (unsigned f = 0; f < item->mesh->mNumFaces; f++) {
        const struct aiFace *face = &item->mesh->mFaces[f];
        const int32_t numbers[2] = {(int32_t)item->group, (int32_t)item->mesh->mMaterialIndex};
        uint16_t corners = (uint16_t)face->mNumIndices;
        if (face->mNumIndices < 3 || face->mNumIndices > CORNERS_LIMIT)
            continue;
        fwrite(&corners, sizeof corners, 1, stdout);
        for (unsigned k = 0; k < corners; k++) {
            unsigned own = face->mIndices[turn < 0 ? corners - 1 - k : k];
            uint32_t number = base + vertex[own];
            fwrite(&number, sizeof number, 1, stdout);
        }
        fwrite(numbers, sizeof numbers, 1, stdout);
    }
}

/* Vertices of all instances, then faces: the places are computed twice, to hold one at a time. */
static int write_instances(const scene *s, const uint32_t *counts, int faces) {
    uint32_t base = 0;
    for (size_t i = 0; i < s->count; i++) {
        const struct aiMesh *mesh = s->instances[i].mesh;
        uint32_t *vertex = malloc((mesh->mNumVertices + 1) * sizeof *vertex), number = 0;
        point *points = vertex != NULL ? place_points(&s->instances[i], vertex, s->up) : NULL;
        if (points == NULL) {
            free(vertex);
            fprintf(stderr, "out of memory\n");
            return 3;
        }
        const point **by_corner = malloc((mesh->mNumVertices + 1) * sizeof *by_corner);
        for (uint32_t k = 0; by_corner != NULL && k < mesh->mNumVertices; k++)
            by_corner[points[k].corner] = &points[k];
        for (uint32_t k = 0; by_corner != NULL && k < mesh->mNumVertices; k++) {
            if (vertex[k] != k) {
                vertex[k] = vertex[vertex[k]]; /* lower, so it is numbered */
                continue;
            }
            if (!faces)
                fwrite(by_corner[k]->p, sizeof by_corner[k]->p, 1, stdout);
            vertex[k] = number++;
        }
        if (faces)
            write_faces(&s->instances[i], vertex, base);
        base += counts[i];
        free(by_corner);
        free(points);
        free(vertex);
    }
    return 0;
}

/* The number of distinct places of each instance. */
static int count_places(const scene *s, uint32_t *counts, size_t *vertices, size_t *faces) {
    for (size_t i = 0; i < s->count; i++) {
        const struct aiMesh *mesh = s->instances[i].mesh;
        uint32_t *vertex = malloc((mesh->mNumVertices + 1) * sizeof *vertex);
        point *points = vertex != NULL ? place_points(&s->instances[i], vertex, s->up) : NULL;
        for (uint32_t k = 0; points != NULL && k < mesh->mNumVertices; k++)
            counts[i] += vertex[k] == k;
        free(vertex);
        free(points);
        if (points == NULL) {
            fprintf(stderr, "out of memory\n");
            return 3;
        }
        for (unsigned f = 0; f < mesh->mNumFaces; f++)
            for (unsigned k = 0; k < mesh->mFaces[f].mNumIndices; k++)
                if (mesh->mFaces[f].mIndices[k] >= mesh->mNumVertices)
                    return fail("a face names a vertex that is not there");
        *vertices += counts[i];
        *faces += faces_of(mesh);
    }
    return 0;
}

static int write_scene(const scene *s) {
    size_t vertices = 0, faces = 0;
    uint32_t *counts = calloc(s->count + 1, sizeof *counts);
    int status = counts != NULL ? count_places(s, counts, &vertices, &faces) : 3;
    if (status == 0 && (faces == 0 || vertices > INT32_MAX))
        status = fail(faces == 0 ? "the file has no faces" : "the file has too many vertices");
    if (status == 0) {
        printf("ply\nformat binary_little_endian 1.0\n");
        print_names(s);
        printf("element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
               "element face %zu\nproperty list ushort uint vertex_indices\nproperty int group\n"
               "property int material\nend_header\n",
               vertices, faces);
        status = write_instances(s, counts, 0);
        if (status == 0)
            status = write_instances(s, counts, 1);
        if (status == 0 && (fflush(stdout) != 0 || ferror(stdout)))
            status = fail("cannot write the result");
    }
    free(counts);
    return status;
}

static const struct aiScene *read_file(const char *path) {
    struct aiPropertyStore *store = aiCreatePropertyStore();
    aiSetImportPropertyInteger(store, AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    aiSetImportPropertyInteger(store, AI_CONFIG_PP_RVC_FLAGS,
                               aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                   aiComponent_COLORS | aiComponent_TEXCOORDS |
                                   aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                   aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS);
    const struct aiScene *file = aiImportFileExWithProperties(
        path, aiProcess_RemoveComponent | aiProcess_SortByPType, NULL, store);
    aiReleasePropertyStore(store);
    return file;
}

int main(int count, char **words) {
    scene s = {.up = -1};
    const char *path = NULL;
    for (int i = 1; i < count; i++) {
        if (strcmp(words[i], "--up-axis") == 0 && i + 1 < count && strlen(words[i + 1]) == 1 &&
            strchr("xyz", words[i + 1][0]) != NULL)
            s.up = *words[++i] - 'x';
        else if (path == NULL && (words[i][0] != '-' || words[i][1] == '\0'))
            path = words[i];
        else
            path = "";
    }
    if (path == NULL || *path == '\0') {
        fprintf(stderr, "usage: starguard-import [--up-axis x|y|z] FILE > MODEL.ply\n");
        return 1;
    }
    s.file = read_file(path);
    if (s.file == NULL || s.file->mRootNode == NULL)
        return fail(s.file == NULL ? aiGetErrorString() : "the file has no scene");
    double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    int status = collect(&s, s.file->mRootNode, identity, 0);
    if (status == 0)
        status = write_scene(&s);
    free(s.instances);
    free(s.groups);
    aiReleaseImport(s.file);
    return status;
}
