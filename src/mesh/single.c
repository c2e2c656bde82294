/* SPDX-License-Identifier: Apache-2.0 */
/* Is a surface still the same one when its coordinates are rounded?
 *
 * Problem: single precision holds 24 bits of a coordinate. Far from the origin these are steps as
 * large as walls are thick: faces lose their area, others pass through one another, and what is
 * read is another solid.
 *
 * Stages: how far vertices move (a surface that does not move is the same); a move is compared with
 * the shortest edge and with the diagonal; faces that have an area keep one; faces that are apart
 * stay apart. A move of ALWAYS of the diagonal is what single precision costs any model near the
 * origin, however short the edges of a scan are; then only the other tests decide.
 *
 * Invariant: what passes has the same contacts of faces as before. Decisions on areas and contacts
 * are exact. Cost: linear if nothing moves, otherwise that of finding pairs of faces that meet. */
#include "mesh/mesh.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "geometry/predicates.h"
#include "mesh/examine.h"

static const double SHARE = 1e-4;     /* of the shortest edge, which a vertex may move by */
static const double ALWAYS = 0x1p-20; /* of the diagonal */

typedef struct comparison {
    starg_context *context;
    const starg_mesh *given, *rounded;
    const single_place *place;
    uint32_t pair[2]; /* faces that meet by rounding */
    bool met;
    size_t pairs;
} comparison;

/* The faces or vertices named are what the reason is about. */
__attribute__((format(printf, 5, 6))) static starg_status
refuse(const comparison *c, starg_element element, const uint32_t *items, size_t count,
       const char *format, ...) {
    uint64_t indices[2];
    char reason[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, sizeof reason, format, arguments);
    va_end(arguments);
    for (size_t i = 0; i < count; i++)
        indices[i] = items[i];
    const single_place *p = c->place;
    return starg_fail_at(c->context, STARG_ERROR_RANGE, p->stage, element, indices, count,
                         "cannot write %s%s%s%s%s: %s; %s", p->what,
                         p->file != NULL ? " to '" : " ", p->file != NULL ? p->file : "",
                         p->file != NULL ? "' " : "",
                         p->how != NULL ? p->how : "in single precision", reason, p->remedy);
}

/* ---- moves ---- */

/* The largest along an axis: squares of tiny ones would vanish. */
static double move_of(const comparison *c, size_t vertex) {
    double most = 0;
    for (size_t i = 3 * vertex; i < 3 * vertex + 3; i++)
        most = fmax(most, fabs(c->given->vertices[i] - c->rounded->vertices[i]));
    return most;
}

static uint32_t find_farthest(const comparison *c) {
    size_t farthest = 0;
    for (size_t v = 1; v < c->given->vertex_count; v++)
        if (move_of(c, v) > move_of(c, farthest))
            farthest = v;
    return (uint32_t)farthest;
}

static starg_status compare_moves(const comparison *c, uint32_t farthest) {
    double move = move_of(c, farthest), diagonal = mesh_diagonal(c->given);
    double edge = mesh_shortest_edge(c->given);
    double most = fmax(ALWAYS * diagonal, SHARE * fmin(edge, diagonal));
    if (move <= most)
        return STARG_OK;
    if (!(move < INFINITY))
        return refuse(c, STARG_ELEMENT_VERTEX, &farthest, 1, "vertex %u is beyond its range",
                      farthest);
    return refuse(c, STARG_ELEMENT_VERTEX, &farthest, 1,
                  "vertex %u would move by %.3g; the shortest edge is %.3g, the diagonal %.3g",
                  farthest, move, fmin(edge, diagonal), diagonal);
}

/* ---- areas and contacts ---- */

static bool is_flat(const starg_mesh *mesh, const uint32_t *corners) {
    return collinear(mesh->vertices + 3 * (size_t)corners[0],
                     mesh->vertices + 3 * (size_t)corners[1],
                     mesh->vertices + 3 * (size_t)corners[2]);
}

static starg_status compare_areas(const comparison *c) {
    for (uint32_t f = 0; f < c->given->face_count; f++) {
        const uint32_t *corners = c->given->faces + 3 * (size_t)f;
        if (is_flat(c->rounded, corners) && !is_flat(c->given, corners))
            return refuse(c, STARG_ELEMENT_FACE, &f, 1, "face %u would lose its area", f);
    }
    return STARG_OK;
}

static bool is_meeting(const starg_mesh *mesh, uint32_t a, uint32_t b) {
    const uint32_t *faces = mesh->faces;
    return faces_contact(mesh->vertices, faces + 3 * (size_t)a, faces + 3 * (size_t)b) >=
           TRIANGLES_TOUCH;
}

static bool compare_pair(void *user, uint32_t a, uint32_t b) {
    enum { PAIRS_PER_CLOCK = 4096 };
    comparison *c = user;
    const uint32_t *faces = c->given->faces;
    if (is_meeting(c->rounded, a, b) && !is_meeting(c->given, a, b) &&
        !is_flat(c->given, faces + 3 * (size_t)a) && !is_flat(c->given, faces + 3 * (size_t)b)) {
        c->met = true;
        c->pair[0] = a;
        c->pair[1] = b;
        return false;
    }
    bool look_up = ++c->pairs % PAIRS_PER_CLOCK == 0;
    return !(look_up && starg_check_cancel(c->context, c->place->stage) != STARG_OK);
}

static starg_status compare_contacts(comparison *c) {
    SCOPED_BY(bvh_drop) bvh *tree = NULL;
    TRY(bvh_create(c->context, c->rounded->vertices, c->rounded->faces, c->rounded->face_count,
                   &tree));
    TRY(face_pairs_visit(c->context, c->rounded, tree, NULL, compare_pair, c));
    TRY(starg_check_cancel(c->context, c->place->stage));
    if (c->met)
        return refuse(c, STARG_ELEMENT_FACE, c->pair, 2,
                      "faces %u and %u, which are apart, would meet", c->pair[0], c->pair[1]);
    return STARG_OK;
}

starg_status single_compare(starg_context *context, const starg_mesh *surface, double *rounded,
                            const single_place *place) {
    starg_mesh other = *surface;
    other.vertices = rounded;
    comparison c = {.context = context, .given = surface, .rounded = &other, .place = place};
    if (surface->vertex_count == 0)
        return STARG_OK;
    uint32_t farthest = find_farthest(&c);
    if (move_of(&c, farthest) == 0)
        return STARG_OK;
    TRY(compare_moves(&c, farthest));
    TRY(compare_areas(&c));
    if (surface->face_count > 0)
        TRY(compare_contacts(&c));
    return STARG_OK;
}

/* Narrowing what float cannot hold is undefined in C. */
static double as_single(double x) {
    return fabs(x) <= (double)FLT_MAX ? (double)(float)x : x < 0 ? -INFINITY : INFINITY;
}

starg_status single_check(starg_context *context, const starg_mesh *surface, const double origin[3],
                          const single_place *place) {
    starg_mesh shifted = *surface;
    SCOPED double *vertices = NULL, *rounded = NULL;
    NEW(context, place->stage, vertices, 3 * surface->vertex_count);
    NEW(context, place->stage, rounded, 3 * surface->vertex_count);
    for (size_t i = 0; i < 3 * surface->vertex_count; i++) {
        vertices[i] = surface->vertices[i] - (origin != NULL ? origin[i % 3] : 0);
        rounded[i] = as_single(vertices[i]);
    }
    shifted.vertices = vertices;
    return single_compare(context, &shifted, rounded, place);
}
