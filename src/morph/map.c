/* SPDX-License-Identifier: Apache-2.0 */
/* Maps between surfaces, the first step of section 5.2 of [YL11].
 *
 * Stages for surfaces of genus 0 with different faces: check both; embed both in the sphere
 * (sphere.c); rotate one to match the other (align.c); warp it until the landmarks are met and
 * optimize the composed map (compose.c); locate the vertices of one in the faces of the other
 * (locate.c). Composing the embedding of A with the inverse of that of B gives a bijection of the
 * surfaces. */
#include "morph/surface_map.h"

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "mesh/solid.h"
#include "morph/solid_map.h"

static const char STAGE[] = "map";
enum { ATTEMPTS = 4 };    /* of centers of star-shaped solids */
enum { SAME_SHARE = 20 }; /* fraction of faces that may differ between poses: one in so many */

void starg_map_options_default(starg_map_options *options) {
    *options = (starg_map_options){0};
}

/* ---- tables ---- */

/* Allocates a map and its tables. */
static starg_status make_map(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                             starg_map_kind kind, starg_map **out) {
    SCOPED_BY(starg_map_drop) starg_map *map = NULL;
    *out = NULL;
    NEW_ZERO(context, STAGE, map, 1);
    map->kind = kind;
    map->vertex_count = a->vertex_count;
    map->target_vertices = b->vertex_count;
    map->target_faces = b->face_count;
    NEW(context, STAGE, map->faces, a->vertex_count);
    NEW(context, STAGE, map->coordinates, 3 * a->vertex_count);
    *out = map;
    map = NULL;
    return STARG_OK;
}

void starg_map_free(starg_context *context, starg_map *map) {
    (void)context;
    if (map == NULL)
        return;
    map_free_overlay(&map->overlay);
    RELEASE(map->faces, map->coordinates, map->directions, map->target_directions, map->pairs,
            map->centers, map);
}

/* Number of faces that differ at equal positions in the lists; SIZE_MAX if counts differ. */
static size_t different_faces(const starg_mesh *a, const starg_mesh *b) {
    size_t count = 0;
    if (a->vertex_count != b->vertex_count || a->face_count != b->face_count)
        return SIZE_MAX;
    for (size_t f = 0; f < a->face_count; f++)
        count += memcmp(a->faces + 3 * f, b->faces + 3 * f, 3 * sizeof *a->faces) != 0;
    return count;
}

/* Maps every vertex to the vertex with its number. */
static starg_status fill_identity(starg_context *context, const starg_mesh *b, starg_map *map) {
    memset(map->faces, 0xff, map->vertex_count * sizeof *map->faces);
    memset(map->coordinates, 0, 3 * map->vertex_count * sizeof *map->coordinates);
    for (size_t i = 0; i < 3 * b->face_count; i++) {
        uint32_t v = b->faces[i];
        if (map->faces[v] != UINT32_MAX)
            continue;
        map->faces[v] = (uint32_t)(i / 3);
        map->coordinates[3 * (size_t)v + i % 3] = 1;
    }
    for (size_t v = 0; v < map->vertex_count; v++) {
        uint64_t vertex = v;
        if (map->faces[v] == UINT32_MAX)
            return starg_fail_at(context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_VERTEX, &vertex, 1,
                                 "vertex %zu belongs to no face; remove it with 'starguard repair'",
                                 v);
    }
    return STARG_OK;
}

starg_status map_unit_copy(starg_context *context, const starg_mesh *mesh, starg_mesh **out) {
    SCOPED double *vertices = NULL;
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    double extent = 0;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, upper[k] - lower[k]);
    *out = NULL;
    if (!(extent > 0))
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "all vertices of a mesh coincide");
    NEW(context, STAGE, vertices, 3 * mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        vertices[i] = (mesh->vertices[i] - lower[i % 3]) / extent -
                      0.5 * (upper[i % 3] - lower[i % 3]) / extent;
    return starg_mesh_create(context, vertices, mesh->vertex_count, mesh->faces, mesh->face_count,
                             out);
}

void map_place(const starg_mesh *mesh, size_t count, const uint32_t *faces,
               const double *coordinates, double *positions) {
    for (size_t v = 0; v < count; v++) {
        const uint32_t *corner = mesh->faces + 3 * (size_t)faces[v];
        const double *w = coordinates + 3 * v;
        for (size_t k = 0; k < 3; k++)
            positions[3 * v + k] = w[0] * mesh->vertices[3 * (size_t)corner[0] + k] +
                                   w[1] * mesh->vertices[3 * (size_t)corner[1] + k] +
                                   w[2] * mesh->vertices[3 * (size_t)corner[2] + k];
    }
}

void starg_map_positions(const starg_map *map, const starg_mesh *b, double *positions) {
    map_place(b, map->vertex_count, map->faces, map->coordinates, positions);
}

/* ---- checks ---- */

static starg_status check_surface(starg_context *context, const starg_check *check,
                                  const char *name) {
    const starg_finding *isolated = &check->findings[STARG_FINDING_ISOLATED_VERTEX];
    if (isolated->count > 0)
        return starg_fail_at(
            context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_VERTEX, isolated->first,
            isolated->shown,
            "surface %s has %zu vertices without faces; remove them with 'starguard repair'", name,
            isolated->count);
    if (check->components != 1)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "surface %s has %zu components; surfaces with different faces must be "
                          "connected. Give a map with --map, or map the components separately",
                          name, check->components);
    if (check->genus != 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "surface %s has genus %lld; surfaces with different faces are mapped via "
                          "the sphere, which requires genus 0. Give a map with --map",
                          name, (long long)check->genus);
    return STARG_OK;
}

/* A surface with a boundary gets a message of its own. */
static starg_status make_closed(starg_context *context, const starg_mesh *mesh, const char *name,
                                starg_solid **out) {
    starg_check *check = NULL;
    starg_status status = solid_make_in_time(context, mesh, out);
    if (status != STARG_ERROR_MESH)
        return status;
    TRY(starg_mesh_check(context, mesh, &check));
    size_t open = check->findings[STARG_FINDING_OPEN_EDGE].count;
    starg_check_free(context, check);
    if (open == 0)
        return solid_make_in_time(context, mesh, out); /* with its message */
    return starg_fail(
        context, STARG_ERROR_MESH, STAGE,
        "surface %s has a boundary (open edges: %zu); surfaces with different faces "
        "are mapped via the sphere, so they must be closed: disks, such as faces and "
        "terrains, cannot be mapped. If these are holes, 'starguard repair' fills them",
        name, open);
}

static starg_status check_landmarks(starg_context *context, const starg_mesh *a,
                                    const starg_mesh *b, const starg_map_options *options) {
    const uint32_t *pairs = options->landmarks;
    if (options->landmark_count > STARG_LANDMARKS_MOST)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "%zu landmarks are too many; the limit is %d", options->landmark_count,
                          STARG_LANDMARKS_MOST);
    for (size_t i = 0; i < options->landmark_count; i++) {
        const uint32_t *own = pairs + 2 * i;
        if (own[0] >= a->vertex_count || own[1] >= b->vertex_count)
            return starg_fail(
                context, STARG_ERROR_MESH, STAGE,
                "landmark %zu pairs vertices %u and %u, but the surfaces have %zu and "
                "%zu vertices (numbered from 0)",
                i, own[0], own[1], a->vertex_count, b->vertex_count);
        for (size_t j = 0; j < i; j++)
            if (pairs[2 * j] == own[0] || pairs[2 * j + 1] == own[1])
                return starg_fail(context, STARG_ERROR_MESH, STAGE,
                                  "landmarks %zu and %zu use the same vertex; each vertex may be "
                                  "in one pair only",
                                  j, i);
    }
    return STARG_OK;
}

/* ---- identity maps ---- */

static starg_status map_same(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                             size_t different, const starg_map_options *options, starg_map **out) {
    if (different > 0)
        starg_log(context, STARG_LOG_NOTICE,
                  "%zu of %zu faces differ; treating the surfaces as poses of one model, vertex by "
                  "vertex",
                  different, a->face_count);
    for (size_t i = 0; i < options->landmark_count; i++)
        if (options->landmarks[2 * i] != options->landmarks[2 * i + 1])
            return starg_fail(context, STARG_ERROR_MESH, STAGE,
                              "the surfaces have the same faces, which maps vertex i to vertex i, "
                              "but landmark %zu pairs %u with %u",
                              i, options->landmarks[2 * i], options->landmarks[2 * i + 1]);
    TRY(make_map(context, a, b, STARG_MAP_SAME, out));
    return fill_identity(context, b, *out);
}

/* ---- maps by spherical embeddings ---- */

typedef struct spread {
    starg_mesh *unit;
    sphere *sphere;
} spread;

static starg_status spread_surface(starg_context *context, const starg_mesh *mesh, const char *name,
                                   spread *out) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    /* it may touch itself: only shared topology counts */
    TRY(make_closed(context, mesh, name, &solid));
    TRY(solid_must_not_share(context, solid, STAGE));
    TRY(check_surface(context, starg_solid_check(solid), name));
    TRY(map_unit_copy(context, starg_solid_mesh(solid), &out->unit));
    return sphere_create(context, out->unit, &out->sphere);
}

static void spread_free(spread *s) {
    sphere_free(s->sphere);
    starg_mesh_free(s->unit);
    *s = (spread){0};
}

typedef struct spread_pair {
    const starg_mesh *surfaces[2];
    spread *out[2];
} spread_pair;

static starg_status spread_one(starg_context *context, void *shared, size_t task) {
    static const char *const NAMES[2] = {"A", "B"};
    const spread_pair *pair = shared;
    return spread_surface(context, pair->surfaces[task], NAMES[task], pair->out[task]);
}

static void forget_one(void *shared, size_t task) {
    const spread_pair *pair = shared;
    spread_free(pair->out[task]);
}

static starg_status spread_both(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                spread *from, spread *to) {
    spread_pair pair = {.surfaces = {a, b}, .out = {from, to}};
    const starg_tasks tasks = {
        .stage = STAGE, .count = 2, .shared = &pair, .run = spread_one, .undo = forget_one};
    return starg_run_tasks(context, &tasks);
}

/* A face with the vertex as a corner. */
static void at_vertex(const starg_mesh *b, uint32_t vertex, uint32_t *face, double coordinates[3]) {
    uint32_t corner = 0;
    while (b->faces[corner] != vertex)
        corner++;
    *face = corner / 3;
    for (uint32_t k = 0; k < 3; k++)
        coordinates[k] = k == corner % 3;
}

/* Converts coordinates for a face of the solid to the corner order of the same face of B. */
static void reorder(const starg_mesh *solid, const starg_mesh *b, uint32_t face,
                    double coordinates[3]) {
    double found[3];
    vec3_copy(coordinates, found);
    for (size_t k = 0; k < 3; k++)
        for (size_t j = 0; j < 3; j++)
            if (solid->faces[3 * (size_t)face + k] == b->faces[3 * (size_t)face + j])
                coordinates[j] = found[k];
}

static starg_status place_vertices(const sphere *from, const locator *to, const starg_mesh *b,
                                   const landmark_list *marks, starg_map *map) {
    uint32_t face = 0;
    for (size_t v = 0; v < map->vertex_count; v++) {
        double *coordinates = map->coordinates + 3 * v;
        TRY(starg_check_cancel(from->context, STAGE));
        face = locate(to, from->directions + 3 * v, face, coordinates);
        map->faces[v] = face;
        reorder(to->sphere->mesh, b, face, coordinates);
    }
    for (size_t i = 0; i < marks->count; i++) {
        size_t v = marks->from[i];
        at_vertex(b, marks->to[i], &map->faces[v], map->coordinates + 3 * v);
    }
    map->landmark_count = marks->count;
    return STARG_OK;
}

static starg_status copy_doubles(starg_context *context, const double *from, size_t count,
                                 double **out) {
    NEW(context, STAGE, *out, count);
    memcpy(*out, from, count * sizeof **out);
    return STARG_OK;
}

/* Keeps what makes the map a bijection. */
static starg_status keep_directions(starg_context *context, const sphere *from, const sphere *to,
                                    starg_map *map) {
    size_t count = from->mesh->vertex_count, target_count = to->mesh->vertex_count;
    TRY(copy_doubles(context, from->directions, 3 * count, &map->directions));
    map->direction_count = count;
    TRY(copy_doubles(context, to->directions, 3 * target_count, &map->target_directions));
    map->target_direction_count = target_count;
    return STARG_OK;
}

static starg_status keep_pairs(starg_context *context, const landmark_list *marks, starg_map *map) {
    if (marks->count == 0)
        return STARG_OK;
    NEW(context, STAGE, map->pairs, 2 * marks->count);
    map->pair_count = marks->count;
    for (size_t i = 0; i < marks->count; i++) {
        map->pairs[2 * i] = marks->from[i];
        map->pairs[2 * i + 1] = marks->to[i];
    }
    return STARG_OK;
}

/* Splits the pairs into two lists. */
static starg_status split_landmarks(starg_context *context, const starg_map_options *options,
                                    uint32_t **lists, landmark_list *out) {
    size_t count = options->landmark_count;
    NEW(context, STAGE, *lists, 2 * count);
    for (size_t i = 0; i < 2 * count; i++)
        (*lists)[i % 2 * count + i / 2] = options->landmarks[i];
    *out = (landmark_list){*lists, *lists + count, count};
    return STARG_OK;
}

/* Composes both embeddings. Without landmarks, extremities are matched if possible; they are
 * guesses, so contradictions between them are not an error. */
static starg_status compose(sphere *from, const locator *to, const landmark_list *marks,
                            const feature_pairs *features) {
    SCOPED double *before = NULL;
    size_t size = 3 * from->mesh->vertex_count;
    const landmark_list extremities = {features->from, features->to, features->count};
    bool met = false;
    NEW(from->context, STAGE, before, size);
    memcpy(before, from->directions, size * sizeof *before);
    if (extremities.count > 0)
        TRY(compose_spheres(from, to, &extremities, &met));
    if (met)
        return STARG_OK;
    memcpy(from->directions, before, size * sizeof *before);
    TRY(compose_spheres(from, to, marks, &met));
    if (!met)
        return landmarks_contradict(from, to->sphere, marks);
    return STARG_OK;
}

static starg_status map_by_sphere(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                  const starg_map_options *options, starg_map **out) {
    SCOPED_BY(spread_free) spread from = {0}, to = {0};
    SCOPED_BY(locator_free) locator where = {0};
    SCOPED uint32_t *lists = NULL;
    landmark_list marks;
    feature_pairs features;
    TRY(split_landmarks(context, options, &lists, &marks));
    TRY(spread_both(context, a, b, &from, &to));
    TRY(locator_create(context, to.sphere, &where));
    TRY(align_spheres(from.sphere, &where, &marks, &features));
    TRY(compose(from.sphere, &where, &marks, &features));
    TRY(make_map(context, a, b, STARG_MAP_SPHERE, out));
    TRY(place_vertices(from.sphere, &where, b, &marks, *out));
    TRY(keep_directions(context, from.sphere, to.sphere, *out));
    return keep_pairs(context, &marks, *out);
}

/* ---- maps of star-shaped solids ---- */

/* Directions of the vertices from a point of the kernel. */
static starg_status look_from(starg_context *context, const starg_mesh *mesh, const char *name,
                              uint64_t attempt, double center[3], double **directions,
                              bool *found) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    TRY(make_closed(context, mesh, name, &solid));
    TRY(solid_must_not_share(context, solid, STAGE));
    TRY(check_surface(context, starg_solid_check(solid), name));
    TRY(stars_center(context, starg_solid_mesh(solid), attempt, center, found));
    if (!*found)
        return STARG_OK;
    NEW(context, STAGE, *directions, 3 * mesh->vertex_count);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        vec3_subtract(mesh->vertices + 3 * v, center, *directions + 3 * v);
    return STARG_OK;
}

/* Points in the same direction correspond. No map: a solid is not star-shaped, or the overlay has
 * no room in doubles. *moved: it had to be made. */
static starg_status map_by_kernels(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                   uint64_t attempt, bool *moved, starg_map **out) {
    SCOPED_BY(starg_map_drop) starg_map *map = NULL;
    double centers[6];
    bool found;
    *moved = false;
    TRY(make_map(context, a, b, STARG_MAP_SPHERE, &map));
    TRY(look_from(context, a, "A", attempt, centers, &map->directions, &found));
    if (found)
        TRY(look_from(context, b, "B", attempt, centers + 3, &map->target_directions, &found));
    if (!found)
        return STARG_OK;
    map->direction_count = a->vertex_count;
    map->target_direction_count = b->vertex_count;
    TRY(copy_doubles(context, centers, 6, &map->centers));
    memset(map->faces, 0, map->vertex_count * sizeof *map->faces); /* until the overlay tells */
    memset(map->coordinates, 0, 3 * map->vertex_count * sizeof *map->coordinates);
    starg_status status = map_overlay(context, a, b, map, moved);
    if (status == STARG_ERROR_SOLVER || status == STARG_ERROR_MESH)
        return STARG_OK;
    TRY(status);
    *out = map;
    map = NULL;
    return STARG_OK;
}

/* From centers that leave room, if there are any: edges that nearly coincide do not, from others.
 */
static starg_status map_stars(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                              starg_map **out) {
    starg_map *next = NULL;
    bool moved = true;
    for (uint64_t attempt = 0; attempt < ATTEMPTS && moved; attempt++) {
        TRY(map_by_kernels(context, a, b, attempt, &moved, &next));
        if (next == NULL || (*out != NULL && moved)) {
            starg_map_free(context, next);
        } else {
            starg_map_free(context, *out);
            *out = next;
        }
        next = NULL;
    }
    return STARG_OK;
}

starg_status map_share_directions(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                  starg_map *map) {
    SCOPED_BY(spread_free) spread own = {0};
    TRY(spread_surface(context, a, "A", &own));
    TRY(overlay_share(context, a, b, own.sphere->directions));
    return keep_directions(context, own.sphere, own.sphere, map);
}

starg_status starg_map_create(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                              const starg_map_options *options, starg_map **out) {
    const starg_map_options none = {0};
    SCOPED_BY(starg_map_drop) starg_map *map = NULL;
    if (options == NULL)
        options = &none;
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(check_landmarks(context, a, b, options));
    size_t different = different_faces(a, b);
    if (different <= a->face_count / SAME_SHARE)
        TRY(map_same(context, a, b, different, options, &map));
    else if (options->solid && options->landmark_count == 0)
        TRY(map_stars(context, a, b, &map));
    if (map == NULL)
        TRY(map_by_sphere(context, a, b, options, &map));
    TRY(map_measure(context, a, b, map));
    *out = map;
    map = NULL;
    return STARG_OK;
}
