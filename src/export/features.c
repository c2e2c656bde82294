/* SPDX-License-Identifier: Apache-2.0 */
/* Corner normals and feature lines.
 *
 * The normal at a corner is the area-weighted mean over the faces at the vertex that deviate from
 * the corner's own face by less than the crease angle: smooth parts look smooth, sharp edges stay
 * sharp. A crease is an edge with a larger angle between its faces, or with a single face; creases
 * that continue at both ends are the feature lines. Vertices with very many faces (fan centres)
 * keep flat normals and have no lines, which bounds the cost to O(faces). */
#include "export/export.h"

#include "geometry/vec3.h"

static const char STAGE[] = "picture";
static const double CREASE_COSINE = 0.68; /* of about 47 degrees */

static const double TURN_COSINE = 0.75; /* of about 41 degrees */

enum { MAX_VALENCE = 48 };

/* The faces at each vertex: list[start[v] .. start[v + 1] - 1]. */
typedef struct vertex_faces {
    size_t *start;
    uint32_t *list;
} vertex_faces;

typedef struct surface {
    const uint32_t *faces;
    size_t face_count;
    double *area_normals; /* face_count x 3 */
    vertex_faces about;
} surface;

static starg_status collect_vertex_faces(starg_context *context, size_t vertex_count,
                                         const uint32_t *faces, size_t face_count,
                                         vertex_faces *about) {
    NEW_ZERO(context, STAGE, about->start, vertex_count + 2);
    NEW(context, STAGE, about->list, 3 * face_count);
    /* start[v + 2] counts; then start[v + 1] is the next free place of v, finally its end */
    for (size_t i = 0; i < 3 * face_count; i++)
        about->start[faces[i] + 2]++;
    for (size_t v = 2; v < vertex_count + 2; v++)
        about->start[v] += about->start[v - 1];
    for (size_t i = 0; i < 3 * face_count; i++)
        about->list[about->start[faces[i] + 1]++] = (uint32_t)(i / 3);
    return STARG_OK;
}

static bool same_side(const double *a, const double *b) {
    return vec3_dot(a, b) > CREASE_COSINE * vec3_length(a) * vec3_length(b);
}

static void corner_normal(const surface *s, size_t face, uint32_t vertex, float out[3]) {
    const double *own = s->area_normals + 3 * face;
    double sum[3] = {0, 0, 0};
    size_t begin = s->about.start[vertex], end = s->about.start[vertex + 1];
    if (end - begin <= MAX_VALENCE)
        for (size_t i = begin; i < end; i++) {
            const double *other = s->area_normals + 3 * (size_t)s->about.list[i];
            if (same_side(own, other))
                vec3_along(sum, 1, other, sum);
        }
    if (!(vec3_length(sum) > 0))
        vec3_copy(own, sum);
    double length = vec3_length(sum);
    for (int k = 0; k < 3; k++)
        out[k] = length > 0 ? (float)(sum[k] / length) : k == 2;
}

static bool has_corner(const uint32_t *face, uint32_t vertex) {
    return face[0] == vertex || face[1] == vertex || face[2] == vertex;
}

/* Is edge (a, b) of `face` a crease, and is `face` the one that reports it? */
static bool is_crease(const surface *s, size_t face, uint32_t a, uint32_t b) {
    size_t begin = s->about.start[a], end = s->about.start[a + 1];
    if (a == b || end - begin > MAX_VALENCE)
        return false;
    bool alone = true;
    for (size_t i = begin; i < end; i++) {
        size_t other = s->about.list[i];
        if (other == face || !has_corner(s->faces + 3 * other, b))
            continue;
        alone = false;
        if (other > face && !same_side(s->area_normals + 3 * face, s->area_normals + 3 * other))
            return true;
    }
    return alone;
}

static starg_status collect_creases(starg_context *context, const surface *s,
                                    starg_index_array *lines) {
    for (size_t i = 0; i < 3 * s->face_count; i++) {
        uint32_t a = s->faces[i], b = s->faces[i % 3 == 2 ? i - 2 : i + 1];
        if (!is_crease(s, i / 3, a, b))
            continue;
        PUSH(context, STAGE, lines, a);
        PUSH(context, STAGE, lines, b);
    }
    return STARG_OK;
}

/* The creases at a vertex. */
typedef struct crease_end {
    uint32_t count;
    uint32_t far[2]; /* other ends of the first two */
} crease_end;

/* Does the crease from `v` to `far` continue beyond v: at a corner of three or more creases, or
 * with a small turn? */
static bool goes_on(const double *vertices, const crease_end *ends, uint32_t v, uint32_t far) {
    const crease_end *end = &ends[v];
    if (end->count != 2)
        return end->count > 2;
    uint32_t next = end->far[0] == far ? end->far[1] : end->far[0];
    double in[3], out[3];
    vec3_subtract(vertices + 3 * (size_t)v, vertices + 3 * (size_t)far, in);
    vec3_subtract(vertices + 3 * (size_t)next, vertices + 3 * (size_t)v, out);
    return vec3_dot(in, out) > TURN_COSINE * vec3_length(in) * vec3_length(out);
}

/* Drops creases that do not continue: on coarse smooth meshes they are noise. */
static starg_status keep_long_creases(starg_context *context, const double *vertices,
                                      size_t vertex_count, starg_index_array *lines) {
    SCOPED crease_end *ends = NULL;
    NEW_ZERO(context, STAGE, ends, vertex_count);
    for (size_t i = 0; i < lines->count; i++) {
        crease_end *end = &ends[lines->data[i]];
        if (end->count < 2)
            end->far[end->count] = lines->data[i ^ 1];
        end->count++;
    }
    size_t kept = 0;
    for (size_t i = 0; i < lines->count; i += 2) {
        uint32_t a = lines->data[i], b = lines->data[i + 1];
        if (!goes_on(vertices, ends, a, b) || !goes_on(vertices, ends, b, a))
            continue;
        lines->data[kept++] = a;
        lines->data[kept++] = b;
    }
    lines->count = kept;
    return STARG_OK;
}

starg_status starg_features_create(starg_context *context, const double *vertices,
                                   size_t vertex_count, const uint32_t *faces, size_t face_count,
                                   starg_features *out) {
    starg_status status = STARG_OK;
    surface s = {.faces = faces, .face_count = face_count};
    *out = (starg_features){0};
    STARG_NEW(context, STAGE, s.area_normals, 3 * face_count);
    STARG_NEW(context, STAGE, out->normals, 9 * face_count);
    for (size_t f = 0; f < face_count; f++)
        vec3_triangle_normal(vertices + 3 * (size_t)faces[3 * f],
                             vertices + 3 * (size_t)faces[3 * f + 1],
                             vertices + 3 * (size_t)faces[3 * f + 2], s.area_normals + 3 * f);
    STARG_TRY(collect_vertex_faces(context, vertex_count, faces, face_count, &s.about));
    for (size_t i = 0; i < 3 * face_count; i++)
        corner_normal(&s, i / 3, faces[i], out->normals + 3 * i);
    STARG_TRY(collect_creases(context, &s, &out->lines));
    STARG_TRY(keep_long_creases(context, vertices, vertex_count, &out->lines));
done:
    RELEASE(s.area_normals, s.about.start, s.about.list);
    if (status != STARG_OK)
        starg_features_free(out);
    return status;
}

void starg_features_free(starg_features *features) {
    RELEASE(features->normals, features->lines.data);
    *features = (starg_features){0};
}
