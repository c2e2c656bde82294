/* SPDX-License-Identifier: Apache-2.0 */
/* Morphs of solids, in which no tetrahedron is ever inverted.
 *
 * Tetrahedra that fill A follow an as-rigid-as-possible morph of its surface (deform.c), in steps.
 * Between the places after two steps all vertices move on straight lines, and every step is taken
 * only when every tetrahedron is proven to be positive at every moment of it: its determinant is a
 * cubic polynomial in time, whose sign is decided exactly (stays_positive, geometry/moving.c).
 * Otherwise there are more steps. Two star-shaped ends are cones, and move straight if that is
 * proven (solid_stars.c). So the inside is locally injective at every time, and at both
 * ends injective.
 *
 * The frame at a time between two keys is the straight one. Cost: that of deform.c, and a test of
 * each tetrahedron in each step. */
#include "morph/solid_map.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "morph/morph.h"

static const char STAGE[] = "morph of solids";

void solid_path_free(solid_path *path) {
    if (path == NULL)
        return;
    deform_free(&path->mesh);
    RELEASE(path->keys.times.data, path->keys.places.data, path->surface, path->labels, path);
}

static starg_status make_path(starg_morph *m) {
    NEW_ZERO(m->context, STAGE, m->solid, 1);
    m->solid->mesh.context = m->context;
    return STARG_OK;
}

/* ---- star-shaped ends ---- */

/* Is every tetrahedron positive all the way from A to the middle, and from there to the end? */
static bool is_straight(const deform_mesh *c, const double *middle) {
    const double *places[3] = {c->rest.data, middle, c->now.data};
    for (size_t i = 0; i < 2 * (c->tetrahedra.count / 4); i++) {
        const double *from[4], *to[4];
        for (size_t k = 0; k < 4; k++) {
            size_t v = 3 * (size_t)c->tetrahedra.data[i / 2 * 4 + k];
            from[k] = places[i % 2] + v;
            to[k] = places[i % 2 + 1] + v;
        }
        if (!stays_positive(from, to))
            return false;
    }
    return true;
}

/* One key, half-way: vertices move straight. */
static starg_status go_straight(solid_path *own, bool *found) {
    const deform_mesh *c = &own->mesh;
    for (size_t i = 0; i < c->rest.count; i++)
        PUSH(c->context, STAGE, &own->keys.places, 0.5 * (c->rest.data[i] + c->now.data[i]));
    for (size_t i = 0; i < c->rest.count; i++)
        PUSH(c->context, STAGE, &own->keys.places, c->now.data[i]);
    PUSH(c->context, STAGE, &own->keys.times, 0.5);
    PUSH(c->context, STAGE, &own->keys.times, 1);
    *found = is_straight(c, own->keys.places.data);
    return STARG_OK;
}

starg_status morph_prepare_stars(starg_morph *m, bool *found) {
    starg_status status = STARG_OK;
    starg_mesh ends = *m->mesh;
    ends.vertices = m->source;
    STARG_TRY(make_path(m));
    solid_path *own = m->solid;
    STARG_TRY(stars_fill(&ends, m->target, m->seen_from, &own->mesh, &own->surface, found));
    if (*found) {
        STARG_NEW_ZERO(m->context, STAGE, own->labels, own->mesh.tetrahedra.count / 4);
        STARG_TRY(go_straight(own, found));
    }
done:
    if (status != STARG_OK || !*found) {
        solid_path_free(m->solid);
        m->solid = NULL;
    }
    return status;
}

/* ---- other ends ---- */

starg_status morph_prepare_solid(starg_morph *m) {
    starg_status status = STARG_OK;
    starg_solid *solid = NULL;
    size_t inverted;
    double reached;
    STARG_TRY(make_path(m));
    solid_path *own = m->solid;
    m->method = STARG_MORPH_ARAP; /* of whose frames the path is made */
    STARG_TRY(solids_fill(m, SOLIDS_DENSITY, &own->mesh, &solid, &own->surface));
    STARG_TRY(deform(m, &own->mesh, &own->keys, &inverted, &reached));
    if (reached < 1)
        status = starg_fail(m->context, STARG_ERROR_MESH, STAGE,
                            "%zu of %zu tetrahedra cannot be kept positive near t = %.3g: the "
                            "solids are too different, or the surface folds on the way; poses that "
                            "are nearer to one another, or another --method, may do",
                            inverted, own->mesh.tetrahedra.count / 4, reached);
done:
    m->method = STARG_MORPH_SOLID;
    starg_solid_free(solid);
    return status;
}

/* The places of all vertices at a key; those of A at key 0. */
static const double *key_of(const solid_path *own, size_t key) {
    return key == 0 ? own->mesh.rest.data
                    : own->keys.places.data + (key - 1) * own->mesh.rest.count;
}

/* Vertices without faces are not part of the solid: they move on a line. */
static void place_loose(const starg_morph *m, double t, double *positions) {
    for (size_t i = 0; i < 3 * m->mesh->vertex_count; i++)
        positions[i] = (1 - t) * m->source[i] + t * m->target[i];
}

void morph_frame_solid(const starg_morph *m, double t, double *positions) {
    const solid_path *own = m->solid;
    const double *times = own->keys.times.data;
    size_t key = 0;
    while (times[key] < t)
        key++;
    double from = key > 0 ? times[key - 1] : 0, part = (t - from) / (times[key] - from);
    const double *before = key_of(own, key), *after = key_of(own, key + 1);
    place_loose(m, t, positions);
    for (size_t v = 0; v < own->mesh.fixed; v++)
        for (size_t k = 0; k < 3; k++)
            positions[3 * (size_t)own->surface[v] + k] =
                (1 - part) * before[3 * v + k] + part * after[3 * v + k];
}

starg_status starg_morph_solid_map(const starg_morph *m, starg_solid_map **out) {
    const solid_path *own = m->solid;
    SCOPED_BY(starg_solid_map_drop) starg_solid_map *map = NULL;
    *out = NULL;
    if (own == NULL)
        return starg_fail(m->context, STARG_ERROR_ARGUMENT, STAGE,
                          "only morphs of method solid have a map of their solids");
    TIME_RULE(m->context, STARG_TIME_FAILS);
    if (own->labels != NULL)
        TRY(solid_map_finish_cones(m->context, &own->mesh, own->labels, 1, &map));
    else
        TRY(solid_map_finish(m->context, &own->mesh, false, &map));
    map->key_count = own->keys.times.count - 1; /* the last one is B */
    NEW(m->context, STAGE, map->times, map->key_count);
    NEW(m->context, STAGE, map->keys, map->key_count * own->mesh.rest.count);
    if (map->key_count > 0) {
        memcpy(map->times, own->keys.times.data, map->key_count * sizeof *map->times);
        memcpy(map->keys, own->keys.places.data,
               map->key_count * own->mesh.rest.count * sizeof *map->keys);
    }
    *out = map;
    map = NULL;
    return STARG_OK;
}

size_t starg_morph_tetrahedron_count(const starg_morph *m) {
    return m->solid != NULL ? m->solid->mesh.tetrahedra.count / 4 : 0;
}

size_t starg_morph_key_count(const starg_morph *m) {
    return m->solid != NULL ? m->solid->keys.times.count + 1 : 0;
}
