/* SPDX-License-Identifier: Apache-2.0 */
/* The boundary of the union: cut, choose, round, check, and again where rounding has made faces
 * meet that did not.
 *
 * 1. Pairs of faces that meet away from common corners (contacts.c); without any, done.
 * 2. The surface is cut along what they share (arrangement.c).
 * 3. Triangles with a winding number below 1 in front and at least 1 behind stay (windings.c): the
 *    boundary of the region enclosed.
 * 4. New points are rounded to the nearest doubles; those that come to lie on one another are one,
 *    and triangles that lose their area go. What is left bounds a region again, up to the rounding.
 *
 * Later rounds look only at faces that are new, and there are few of those whose rounding matters.
 * Invariants: vertices of the mesh never move, faces that meet no others stay as they are, and the
 * result has no pair of step 1. */
#include "mesh/union/union.h"

#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/union/arrangement.h"

enum { MOST_ROUNDS = 20 };

void union_surface_free(union_surface *surface) {
    STARG_ARRAY_FREE(surface->context, &surface->vertices);
    STARG_ARRAY_FREE(surface->context, &surface->faces);
    STARG_ARRAY_FREE(surface->context, &surface->origin);
    STARG_ARRAY_FREE(surface->context, &surface->flags);
}

/* Adds a face unless it has no area. */
static starg_status add_face(union_surface *surface, const uint32_t corner[3], uint32_t origin,
                             uint8_t flags) {
    starg_status status = STARG_OK;
    const double *p[3];
    for (int k = 0; k < 3; k++)
        p[k] = surface->vertices.data + 3 * (size_t)corner[k];
    if (collinear(p[0], p[1], p[2]))
        return STARG_OK;
    for (int k = 0; k < 3; k++)
        STARG_PUSH(surface->context, UNION_STAGE, &surface->faces, corner[k]);
    STARG_PUSH(surface->context, UNION_STAGE, &surface->origin, origin);
    STARG_PUSH(surface->context, UNION_STAGE, &surface->flags, flags);
done:
    return status;
}

static starg_status copy_mesh(const starg_mesh *mesh, union_surface *out) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        STARG_PUSH(out->context, UNION_STAGE, &out->vertices, mesh->vertices[i]);
    for (size_t f = 0; f < mesh->face_count; f++)
        STARG_TRY(add_face(out, mesh->faces + 3 * f, (uint32_t)f, 0));
done:
    return status;
}

/* ---- rounding ---- */

/* A point of the complex, as it is rounded. */
typedef struct rounded_point {
    double p[3];
    uint32_t name; /* as corners of the complex call it: those of vertices are lower */
} rounded_point;

static int compare_rounded(const void *left, const void *right) {
    const rounded_point *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->p[k] != b->p[k])
            return a->p[k] < b->p[k] ? -1 : 1;
    return (a->name > b->name) - (a->name < b->name);
}

/* At most how far from a rounded point the exact one lies. */
static double rounding_of(const double p[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double half = 0.5 * (nextafter(fabs(p[k]), INFINITY) - fabs(p[k]));
        sum += half * half;
    }
    return sqrt(sum);
}

/* Points of the complex in the order of their rounded places; those of vertices come first. */
static starg_status sort_points(const union_complex *complex, rounded_point **out) {
    starg_status status = STARG_OK;
    size_t count = complex->name.count;
    STARG_NEW(complex->context, UNION_STAGE, *out, count);
    for (size_t i = 0; i < count; i++) {
        memcpy((*out)[i].p, exact_points_rounded(&complex->points, (uint32_t)i), sizeof(*out)[i].p);
        (*out)[i].name = complex->name.data[i];
    }
    qsort(*out, count, sizeof **out, compare_rounded);
done:
    return status;
}

/* Appends each new place to the vertices. vertex[i], not NONE for points that are used, becomes the
 * vertex of the i-th added point. */
static starg_status round_points(const union_complex *complex, union_surface *out, uint32_t *vertex,
                                 double *moved) {
    starg_status status = STARG_OK;
    size_t vertices = complex->surface->vertices.count / 3;
    rounded_point *points = NULL;
    const double *place = NULL; /* of the vertex `own` */
    uint32_t own = 0;
    STARG_TRY(sort_points(complex, &points));
    for (size_t i = 0; i < complex->name.count; i++) {
        const double *p = points[i].p;
        uint32_t name = points[i].name;
        if (name < vertices) {
            own = name;
            place = p;
            continue;
        }
        if (vertex[name - vertices] == UINT32_MAX)
            continue;
        if (place == NULL || !vec3_equal(place, p)) {
            own = (uint32_t)(out->vertices.count / 3);
            place = p;
            for (int k = 0; k < 3; k++)
                STARG_PUSH(out->context, UNION_STAGE, &out->vertices, p[k]);
            *moved = fmax(*moved, rounding_of(p));
        }
        vertex[name - vertices] = own;
    }
done:
    starg_release(complex->context, points);
    return status;
}

static void mark_used(const union_complex *complex, const bool *keep, uint32_t *vertex) {
    size_t vertices = complex->surface->vertices.count / 3;
    for (size_t i = 0; i < complex->added.count; i++)
        vertex[i] = UINT32_MAX;
    for (size_t t = 0; t < complex->triangles.count; t++)
        for (int k = 0; k < 3 && keep[t]; k++) {
            uint32_t corner = complex->triangles.data[t].corner[k];
            if (corner >= vertices)
                vertex[corner - vertices] = 0;
        }
}

/* The triangles that are kept, with rounded corners. */
static starg_status assemble(const union_complex *complex, const bool *keep, union_surface *out,
                             double *moved) {
    starg_status status = STARG_OK;
    const union_surface *from = complex->surface;
    size_t vertices = from->vertices.count / 3;
    uint32_t *vertex = NULL;
    double largest = 0;
    STARG_NEW(out->context, UNION_STAGE, vertex, complex->added.count);
    for (size_t i = 0; i < from->vertices.count; i++)
        STARG_PUSH(out->context, UNION_STAGE, &out->vertices, from->vertices.data[i]);
    mark_used(complex, keep, vertex);
    STARG_TRY(round_points(complex, out, vertex, &largest));
    *moved += largest;
    for (size_t t = 0; t < complex->triangles.count; t++) {
        const union_triangle *own = &complex->triangles.data[t];
        uint32_t corner[3];
        if (!keep[t])
            continue;
        for (int k = 0; k < 3; k++)
            corner[k] =
                own->corner[k] < vertices ? own->corner[k] : vertex[own->corner[k] - vertices];
        uint8_t flags =
            own->whole ? from->flags.data[own->face] & UNION_PART : UNION_PART | UNION_FRESH;
        STARG_TRY(add_face(out, corner, from->origin.data[own->face], flags));
    }
done:
    starg_release(out->context, vertex);
    return status;
}

/* ---- rounds ---- */

static starg_status cut_and_choose(union_surface *surface, const bvh *tree,
                                   union_contacts *contacts, union_report *report) {
    starg_status status = STARG_OK;
    starg_context *context = surface->context;
    union_complex complex = {.context = context, .points.context = context};
    union_surface next = {.context = context};
    bool *keep = NULL;
    STARG_TRY(union_arrange(surface, contacts, &complex));
    STARG_NEW(context, UNION_STAGE, keep, complex.triangles.count);
    STARG_TRY(union_choose(&complex, tree, keep));
    STARG_TRY(assemble(&complex, keep, &next, &report->moved));
    union_surface former = *surface;
    *surface = next;
    next = former;
done:
    union_complex_free(&complex);
    union_surface_free(&next);
    starg_release(context, keep);
    return status;
}

static starg_status fail_rounding(const union_surface *surface, const union_contacts *contacts) {
    uint64_t faces[STARG_ERROR_INDICES];
    size_t shown = 0;
    for (size_t i = 0; i < contacts->count; i++)
        for (int k = 0; k < 2 && shown < STARG_ERROR_INDICES; k++)
            faces[shown++] = surface->origin.data[contacts->data[i].face[k]];
    return starg_fail_at(
        surface->context, STARG_ERROR_MESH, UNION_STAGE, STARG_ELEMENT_FACE, faces, shown,
        "%zu pairs of faces (first: parts of %llu and %llu) still meet after %d rounds, because "
        "rounding new points makes new intersections; merge near vertices first",
        contacts->count, (unsigned long long)faces[0], (unsigned long long)faces[1], MOST_ROUNDS);
}

/* One round; *done tells that there was nothing to do. */
static starg_status run_round(union_surface *surface, union_report *report, bool *done) {
    starg_status status = STARG_OK;
    bvh *tree = NULL;
    union_contacts contacts = {0};
    bool first = report->rounds == 0;
    STARG_TRY(bvh_create(surface->context, surface->vertices.data, surface->faces.data,
                         union_face_count(surface), &tree));
    STARG_TRY(union_find_contacts(surface, tree, first, &contacts));
    if (first)
        report->pairs = contacts.count;
    *done = contacts.count == 0;
    if (*done)
        goto done;
    if (report->rounds == MOST_ROUNDS) {
        status = fail_rounding(surface, &contacts);
        goto done;
    }
    report->rounds++;
    STARG_TRY(cut_and_choose(surface, tree, &contacts, report));
done:
    STARG_ARRAY_FREE(surface->context, &contacts);
    bvh_free(tree);
    return status;
}

starg_status union_of_mesh(starg_context *context, const starg_mesh *mesh, union_surface *out,
                           union_report *report) {
    starg_status status = STARG_OK;
    bool finished = false;
    *out = (union_surface){.context = context};
    *report = (union_report){0};
    starg_progress_begin(context, UNION_STAGE);
    STARG_TRY(copy_mesh(mesh, out));
    while (!finished && union_face_count(out) > 0)
        STARG_TRY(run_round(out, report, &finished));
done:
    starg_progress_end(context);
    if (status != STARG_OK) {
        union_surface_free(out);
        *out = (union_surface){.context = context};
    }
    return status;
}
