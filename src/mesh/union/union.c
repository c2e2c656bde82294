/* SPDX-License-Identifier: Apache-2.0 */
/* The boundary of the union: cut, choose, round, check, and again where rounding has made faces
 * meet that did not.
 *
 * 0. Flush polygons of one outline get the same triangles (flush.c). What touches within rounding
 * becomes shared (conform.c), if that is done with few new vertices.
 * 1. Pairs of faces that meet away from common corners (contacts.c); without any, done.
 * 2. The surface is cut along what they share (arrangement.c).
 * 3. Triangles with a winding number below 1 in front and at least 1 behind stay (windings.c): the
 *    boundary of the region enclosed.
 * 4. New points are rounded to the nearest doubles; those that come to lie on one another are one,
 *    and triangles that lose their area go. What is left bounds a region again, up to the rounding.
 *
 * Later rounds look only at faces that are new, and there are few of those whose rounding matters.
 * Where it still makes contacts after EXACT_ROUNDS, or more than in the round before, each round
 * begins with step 0, whatever that adds: contacts within rounding are shared then, and none of
 * them is made anew. A
 * surface that grows to more than MOST_GROWTH times the largest of the first rounds is given up.
 * Invariants: vertices of the mesh never move but by step 0, faces that meet no others stay as they
 * are, and the result has no pair of step 1. */
#include "mesh/union/arrangement.h"

#include <math.h>
#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"

enum { EXACT_ROUNDS = 4, MOST_ROUNDS = 20, MOST_GROWTH = 8, SPARE_FACES = 4096 };

/* Each time that there are more contacts the distance of step 0 becomes 2^WIDER times as much, but
 * no more than MOST_WIDER times. */
enum { WIDER = 2, MOST_WIDER = 6 };

void union_surface_free(union_surface *surface) {
    RELEASE(surface->vertices.data, surface->faces.data, surface->origin.data, surface->flags.data);
}

/* Adds a face unless it has no area. */
static starg_status add_face(union_surface *surface, const uint32_t corner[3], uint32_t origin,
                             uint8_t flags) {
    const double *p[3];
    for (int k = 0; k < 3; k++)
        p[k] = surface->vertices.data + 3 * (size_t)corner[k];
    if (collinear(p[0], p[1], p[2]))
        return STARG_OK;
    for (int k = 0; k < 3; k++)
        PUSH(surface->context, UNION_STAGE, &surface->faces, corner[k]);
    PUSH(surface->context, UNION_STAGE, &surface->origin, origin);
    PUSH(surface->context, UNION_STAGE, &surface->flags, flags);
    return STARG_OK;
}

starg_status union_surface_make(starg_context *context, const starg_mesh *mesh,
                                union_surface *out) {
    *out = (union_surface){.context = context};
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        PUSH(context, UNION_STAGE, &out->vertices, mesh->vertices[i]);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        PUSH(context, UNION_STAGE, &out->faces, mesh->faces[i]);
    for (size_t f = 0; f < mesh->face_count; f++) {
        PUSH(context, UNION_STAGE, &out->origin, (uint32_t)f);
        PUSH(context, UNION_STAGE, &out->flags, 0);
    }
    return STARG_OK;
}

/* They bound nothing. */
static void drop_flat_faces(union_surface *surface) {
    size_t kept = 0;
    for (uint32_t f = 0; f < union_face_count(surface); f++) {
        if (collinear(union_corner(surface, f, 0), union_corner(surface, f, 1),
                      union_corner(surface, f, 2)))
            continue;
        memmove(surface->faces.data + 3 * kept, surface->faces.data + 3 * (size_t)f,
                3 * sizeof(uint32_t));
        surface->origin.data[kept] = surface->origin.data[f];
        surface->flags.data[kept++] = surface->flags.data[f];
    }
    surface->faces.count = 3 * kept;
    surface->origin.count = surface->flags.count = kept;
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
    size_t count = complex->name.count;
    NEW(complex->context, UNION_STAGE, *out, count);
    for (size_t i = 0; i < count; i++) {
        memcpy((*out)[i].p, exact_points_rounded(&complex->points, (uint32_t)i), sizeof(*out)[i].p);
        (*out)[i].name = complex->name.data[i];
    }
    qsort(*out, count, sizeof **out, compare_rounded);
    return STARG_OK;
}

/* Appends each new place to the vertices. vertex[i], not NONE for points that are used, becomes the
 * vertex of the i-th added point. */
static starg_status round_points(const union_complex *complex, union_surface *out, uint32_t *vertex,
                                 double *moved) {
    size_t vertices = complex->surface->vertices.count / 3;
    SCOPED rounded_point *points = NULL;
    const double *place = NULL; /* of the vertex `own` */
    uint32_t own = 0;
    TRY(sort_points(complex, &points));
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
                PUSH(out->context, UNION_STAGE, &out->vertices, p[k]);
            *moved = fmax(*moved, rounding_of(p));
        }
        vertex[name - vertices] = own;
    }
    return STARG_OK;
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
    const union_surface *from = complex->surface;
    size_t vertices = from->vertices.count / 3;
    SCOPED uint32_t *vertex = NULL;
    double largest = 0;
    NEW(out->context, UNION_STAGE, vertex, complex->added.count);
    for (size_t i = 0; i < from->vertices.count; i++)
        PUSH(out->context, UNION_STAGE, &out->vertices, from->vertices.data[i]);
    mark_used(complex, keep, vertex);
    TRY(round_points(complex, out, vertex, &largest));
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
        TRY(add_face(out, corner, from->origin.data[own->face], flags));
    }
    return STARG_OK;
}

/* ---- rounds ---- */

static starg_status cut_and_choose(union_surface *surface, const bvh *tree,
                                   union_contacts *contacts, union_report *report) {
    starg_context *context = surface->context;
    SCOPED_BY(union_complex_free)
    union_complex complex = {.context = context, .points.context = context};
    SCOPED_BY(union_surface_free) union_surface next = {.context = context};
    SCOPED bool *keep = NULL;
    TRY(union_arrange(surface, contacts, &complex));
    NEW(context, UNION_STAGE, keep, complex.triangles.count);
    TRY(union_choose(&complex, tree, keep));
    TRY(assemble(&complex, keep, &next, &report->moved));
    union_surface former = *surface;
    *surface = next;
    next = former;
    return STARG_OK;
}

static starg_status fail_rounding(const union_surface *surface, const union_contacts *contacts,
                                  size_t rounds) {
    uint64_t faces[STARG_ERROR_INDICES];
    size_t shown = 0;
    for (size_t i = 0; i < contacts->count; i++)
        for (int k = 0; k < 2 && shown < STARG_ERROR_INDICES; k++)
            faces[shown++] = surface->origin.data[contacts->data[i].face[k]];
    return starg_fail_at(
        surface->context, STARG_ERROR_MESH, UNION_STAGE, STARG_ELEMENT_FACE, faces, shown,
        "%zu pairs of faces (first: parts of %llu and %llu) still meet after %d rounds, because "
        "rounding new points makes new intersections; merge near vertices first",
        contacts->count, (unsigned long long)faces[0], (unsigned long long)faces[1], (int)rounds);
}

/* Rounds that only make more faces do not end. */
static bool has_run_away(const union_surface *surface, union_report *report) {
    size_t count = union_face_count(surface);
    if (report->rounds <= EXACT_ROUNDS && count > report->most)
        report->most = count;
    return count > MOST_GROWTH * report->most + SPARE_FACES;
}

/* Joins what touches, unless that makes many faces, as where surfaces pass through one another in
 * nearly the same plane: exact cuts make fewer. */
static starg_status snap(union_surface *surface, double distance, bool always, double *moved,
                         bool *changed) {
    SCOPED_BY(union_surface_free) union_surface copy = {.context = surface->context};
    conform_report joined;
    const starg_mesh view = {.context = surface->context,
                             .vertex_count = surface->vertices.count / 3,
                             .face_count = union_face_count(surface),
                             .vertices = surface->vertices.data,
                             .faces = surface->faces.data};
    TRY(union_surface_make(surface->context, &view, &copy));
    memcpy(copy.origin.data, surface->origin.data, view.face_count * sizeof *copy.origin.data);
    memcpy(copy.flags.data, surface->flags.data, view.face_count);
    TRY(surface_conform(&copy, distance, &joined));
    *changed = joined.rounds > 0 && !joined.left && (always || joined.added <= view.face_count);
    if (*changed) {
        union_surface former = *surface;
        *surface = copy;
        copy = former;
        *moved += joined.moved;
    }
    return STARG_OK;
}

/* One round; *done tells that there was nothing to do. The first one always chooses: shells may lie
 * in one another without meeting. */
static starg_status run_round(union_surface *surface, double distance, union_report *report,
                              bool *done) {
    SCOPED_BY(bvh_drop) bvh *tree = NULL;
    SCOPED union_contacts contacts = {0};
    bool first = !report->chosen, joined = false,
         late = report->rounds >= EXACT_ROUNDS || report->grew > 0;
    distance =
        ldexp(distance, WIDER * (int)(report->grew < MOST_WIDER ? report->grew : MOST_WIDER));
    if (first || (late && !has_run_away(surface, report)))
        TRY(snap(surface, distance, late, &report->moved, &joined));
    drop_flat_faces(surface);
    TRY(bvh_create(surface->context, surface->vertices.data, surface->faces.data,
                   union_face_count(surface), &tree));
    TRY(union_find_contacts(surface, tree, first, &contacts));
    if (first)
        report->pairs = contacts.count;
    if (report->rounds > 1)
        report->grew += contacts.count > report->contacts;
    report->contacts = contacts.count;
    *done = contacts.count == 0 && !joined && !first;
    if (*done)
        return STARG_OK;
    if (contacts.count > 0 && (report->rounds == MOST_ROUNDS || has_run_away(surface, report)))
        return fail_rounding(surface, &contacts, report->rounds);
    report->chosen = true;
    report->rounds += contacts.count > 0 || joined;
    *done = report->rounds > MOST_ROUNDS;
    return cut_and_choose(surface, tree, &contacts, report);
}

starg_status union_of_mesh(starg_context *context, const starg_mesh *mesh, double merge,
                           union_surface *out, union_report *report) {
    starg_status status = STARG_OK;
    bool finished = false;
    *out = (union_surface){.context = context};
    *report = (union_report){0};
    starg_progress_begin(context, UNION_STAGE);
    STARG_TRY(union_surface_make(context, mesh, out));
    double distance = conform_distance(out, merge);
    STARG_TRY(surface_match_flush(out, distance, &report->moved));
    while (!finished && union_face_count(out) > 0)
        STARG_TRY(run_round(out, distance, report, &finished));
done:
    starg_progress_end(context);
    if (status != STARG_OK) {
        union_surface_free(out);
        *out = (union_surface){.context = context};
    }
    return status;
}
