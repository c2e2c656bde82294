/* SPDX-License-Identifier: Apache-2.0 */
/* starguard-import FILE: reads a scene by assimp and writes it as one binary PLY to standard
 * output.
 *
 * starguard runs it as a child with limits of memory and time, so that a file that crashes an
 * importer hurts nobody. Transforms of nodes are applied in double precision; corners at equal
 * positions become one vertex, as told below; polygons stay as they are, and have their corners'
 * texture coordinates if any mesh has some. Names of nodes and materials stand in comments of the
 * header, `group` and `material` of each face give their numbers. */
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
    uint32_t group, base; /* base: its first corner */
} instance;

typedef struct scene {
    const struct aiScene *file;
    instance *instances;
    size_t count, capacity;
    const struct aiNode **groups; /* by number */
    size_t group_count, group_capacity;
    int textured;
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

static int out_of_memory(void) {
    fprintf(stderr, "out of memory\n");
    return 3;
}

static void *grow(void *block, size_t count, size_t *capacity, size_t size) {
    if (count < *capacity)
        return block;
    size_t more = *capacity == 0 ? 16 : 2 * *capacity;
    void *larger = realloc(block, more * size);
    if (larger == NULL)
        exit(out_of_memory());
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
        s->textured |= item->mesh->mTextureCoords[0] != NULL;
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

/* ---- vertices ----
 *
 * All corners of all instances have numbers, those of an instance from its `base` on. Corners of a
 * node at equal positions become one vertex, since files have one for each material, normal and
 * texture coordinate; so do vertices of different nodes if both are on open edges, as where floor
 * and walls are objects of their own. Closed objects that touch stay apart. */

typedef struct corner_map {
    uint32_t count;
    double (*place)[3];
    uint32_t *vertex; /* lowest corner that it is one with; NONE: no face uses it */
    uint8_t *rim;     /* is a lowest corner on an open edge? */
} corner_map;

static const uint32_t NONE = UINT32_MAX;

static int compare_points(const void *left, const void *right) {
    const point *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->p[k] != b->p[k])
            return a->p[k] < b->p[k] ? -1 : 1;
    return (a->corner > b->corner) - (a->corner < b->corner);
}

static int compare_numbers(const void *left, const void *right) {
    const uint64_t *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

static void place_corners(const instance *item, int up, corner_map *map) {
    for (uint32_t i = 0; i < item->mesh->mNumVertices; i++) {
        const struct aiVector3D *v = &item->mesh->mVertices[i];
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = item->transform[k][0] * (double)v->x + item->transform[k][1] * (double)v->y +
                   item->transform[k][2] * (double)v->z + item->transform[k][3] + 0.0;
        for (int k = 0; k < 3; k++) /* turns the axis `up` to z, and keeps the hand */
            map->place[item->base + i][k] = p[up < 0 ? k : (up + 1 + k) % 3];
    }
}

static int is_kept(const struct aiFace *face) {
    return face->mNumIndices >= 3 && face->mNumIndices <= CORNERS_LIMIT;
}

static int mark_used(const instance *item, corner_map *map, size_t *faces) {
    for (unsigned f = 0; f < item->mesh->mNumFaces; f++) {
        const struct aiFace *face = &item->mesh->mFaces[f];
        for (unsigned k = 0; k < face->mNumIndices; k++) {
            if (face->mIndices[k] >= item->mesh->mNumVertices)
                return fail("a face names a vertex that is not there");
            if (is_kept(face))
                map->vertex[item->base + face->mIndices[k]] = item->base + face->mIndices[k];
        }
        *faces += (size_t)is_kept(face);
    }
    return 0;
}

/* Joins the vertices at one place among the corners from `begin` to `end`; only on the rim? */
static int join(corner_map *map, uint32_t begin, uint32_t end, int rim) {
    size_t count = 0;
    point *points = malloc((end - begin + (size_t)1) * sizeof *points);
    if (points == NULL)
        return out_of_memory();
    for (uint32_t i = begin; i < end; i++) {
        if (map->vertex[i] != i || (rim && !map->rim[i]))
            continue;
        memcpy(points[count].p, map->place[i], sizeof points[count].p);
        points[count++].corner = i;
    }
    qsort(points, count, sizeof *points, compare_points);
    for (size_t i = 0, first = 0; i < count; i++) {
        if (memcmp(points[i].p, points[first].p, sizeof points[i].p) != 0)
            first = i;
        map->vertex[points[i].corner] = points[first].corner;
    }
    free(points);
    for (uint32_t i = begin; i < end; i++) /* to a lower one, which is done */
        if (map->vertex[i] != NONE)
            map->vertex[i] = map->vertex[map->vertex[i]];
    return 0;
}

/* Vertices of edges that one face has. */
static int find_rim(const scene *s, corner_map *map) {
    size_t count = 0, room = 0;
    for (size_t i = 0; i < s->count; i++)
        for (unsigned f = 0; f < s->instances[i].mesh->mNumFaces; f++)
            room += s->instances[i].mesh->mFaces[f].mNumIndices;
    uint64_t *edges = malloc((room + 1) * sizeof *edges);
    if (edges == NULL)
        return out_of_memory();
    for (size_t i = 0; i < s->count; i++) {
        const uint32_t *vertex = map->vertex + s->instances[i].base;
        for (unsigned f = 0; f < s->instances[i].mesh->mNumFaces; f++) {
            const struct aiFace *face = &s->instances[i].mesh->mFaces[f];
            for (unsigned k = 0; is_kept(face) && k < face->mNumIndices; k++) {
                uint32_t a = vertex[face->mIndices[k]],
                         b = vertex[face->mIndices[(k + 1) % face->mNumIndices]];
                edges[count++] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
            }
        }
    }
    qsort(edges, count, sizeof *edges, compare_numbers);
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && edges[end] == edges[i];)
            end++;
        if (end - i == 1)
            map->rim[edges[i] >> 32] = map->rim[(uint32_t)edges[i]] = 1;
    }
    free(edges);
    return 0;
}

/* Instances of a node follow one another. */
static int join_all(const scene *s, corner_map *map) {
    int status = 0;
    for (size_t i = 0, end; i < s->count && status == 0; i = end) {
        for (end = i + 1; end < s->count && s->instances[end].group == s->instances[i].group;)
            end++;
        status = join(map, s->instances[i].base,
                      end < s->count ? s->instances[end].base : map->count, 0);
    }
    if (status == 0 && s->group_count > 1) {
        status = find_rim(s, map);
        if (status == 0)
            status = join(map, 0, map->count, 1);
    }
    return status;
}

static void free_map(corner_map *map) {
    free(map->place);
    free(map->vertex);
    free(map->rim);
}

static int map_corners(scene *s, corner_map *map, size_t *faces) {
    uint64_t count = 0;
    int status = 0;
    for (size_t i = 0; i < s->count; i++) {
        s->instances[i].base = (uint32_t)count;
        count += s->instances[i].mesh->mNumVertices;
        if (count > INT32_MAX)
            return fail("the file has too many vertices");
    }
    map->count = (uint32_t)count;
    map->place = malloc((count + 1) * sizeof *map->place);
    map->vertex = malloc((count + 1) * sizeof *map->vertex);
    map->rim = calloc(count + 1, 1);
    if (map->place == NULL || map->vertex == NULL || map->rim == NULL)
        return out_of_memory();
    memset(map->vertex, 0xFF, count * sizeof *map->vertex);
    for (size_t i = 0; i < s->count && status == 0; i++) {
        place_corners(&s->instances[i], s->up, map);
        status = mark_used(&s->instances[i], map, faces);
    }
    return status == 0 ? join_all(s, map) : status;
}

/* ---- the file ---- */

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

/* Numbers of faces in as few bytes as hold the largest, for they are in memory beside the mesh. */
typedef struct number_type {
    const char *name;
    size_t bytes;
} number_type;

static number_type type_for(uint32_t most) {
    return most <= UINT8_MAX    ? (number_type){"uchar", 1}
           : most <= UINT16_MAX ? (number_type){"ushort", 2}
                                : (number_type){"uint", 4};
}

static void write_number(uint32_t number, number_type type) {
    for (size_t i = 0; i < type.bytes; i++)
        putchar((int)(number >> 8 * i & 0xFF));
}

typedef struct face_types {
    number_type corners, group, material;
} face_types;

static face_types find_types(const scene *s) {
    uint32_t most = 0;
    for (size_t i = 0; i < s->count; i++)
        for (unsigned f = 0; f < s->instances[i].mesh->mNumFaces; f++) {
            const struct aiFace *face = &s->instances[i].mesh->mFaces[f];
            most = is_kept(face) && face->mNumIndices > most ? face->mNumIndices : most;
        }
    return (face_types){type_for(most), type_for((uint32_t)s->group_count),
                        type_for(s->file->mNumMaterials)};
}

/* None, if the mesh has no texture coordinates. */
static void write_texture(const struct aiMesh *mesh, const struct aiFace *face, int turned) {
    unsigned corners = mesh->mTextureCoords[0] != NULL ? face->mNumIndices : 0;
    write_number(2 * corners, (number_type){"ushort", 2});
    for (unsigned k = 0; k < corners; k++) {
        const struct aiVector3D *uv =
            &mesh->mTextureCoords[0][face->mIndices[turned ? corners - 1 - k : k]];
        const float pair[2] = {(float)uv->x, (float)uv->y};
        fwrite(pair, sizeof pair, 1, stdout);
    }
}

static void write_faces(const instance *item, const uint32_t *number, face_types types,
                        int textured) {
    double(*t)[4] = ((instance *)(uintptr_t)item)->transform;
    double turn = t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) -
                  t[0][1] * (t[1][0] * t[2][2] - t[1][2] * t[2][0]) +
                  t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0]);
    for (unsigned f = 0; f < item->mesh->mNumFaces; f++) {
        const struct aiFace *face = &item->mesh->mFaces[f];
        unsigned corners = face->mNumIndices;
        if (!is_kept(face))
            continue;
        write_number(corners, types.corners);
        for (unsigned k = 0; k < corners; k++) {
            unsigned own = face->mIndices[turn < 0 ? corners - 1 - k : k];
            fwrite(&number[item->base + own], sizeof *number, 1, stdout);
        }
        write_number(item->group, types.group);
        write_number(item->mesh->mMaterialIndex, types.material);
        if (textured)
            write_texture(item->mesh, face, turn < 0);
    }
}

static void write_map(const scene *s, corner_map *map, size_t vertices, size_t faces) {
    const face_types types = find_types(s);
    printf("ply\nformat binary_little_endian 1.0\n");
    print_names(s);
    printf("element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
           "element face %zu\nproperty list %s uint vertex_indices\nproperty %s group\n"
           "property %s material\n%send_header\n",
           vertices, faces, types.corners.name, types.group.name, types.material.name,
           s->textured ? "property list ushort float texcoord\n" : "");
    for (uint32_t i = 0, number = 0; i < map->count; i++) {
        if (map->vertex[i] == i) {
            fwrite(map->place[i], sizeof map->place[i], 1, stdout);
            map->vertex[i] = number++;
        } else if (map->vertex[i] != NONE) {
            map->vertex[i] = map->vertex[map->vertex[i]]; /* lower, so it is numbered */
        }
    }
    for (size_t i = 0; i < s->count; i++)
        write_faces(&s->instances[i], map->vertex, types, s->textured);
}

static int write_scene(scene *s) {
    size_t faces = 0, vertices = 0;
    corner_map map = {0};
    int status = map_corners(s, &map, &faces);
    for (uint32_t i = 0; status == 0 && i < map.count; i++)
        vertices += map.vertex[i] == i;
    if (status == 0 && faces == 0)
        status = fail("the file has no faces");
    if (status == 0) {
        write_map(s, &map, vertices, faces);
        if (fflush(stdout) != 0 || ferror(stdout))
            status = fail("cannot write the result");
    }
    free_map(&map);
    return status;
}

static const struct aiScene *read_file(const char *path) {
    struct aiPropertyStore *store = aiCreatePropertyStore();
    aiSetImportPropertyInteger(store, AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    aiSetImportPropertyInteger(store, AI_CONFIG_PP_RVC_FLAGS,
                               aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                   aiComponent_COLORS | aiComponent_BONEWEIGHTS |
                                   aiComponent_ANIMATIONS | aiComponent_TEXTURES |
                                   aiComponent_LIGHTS | aiComponent_CAMERAS);
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
