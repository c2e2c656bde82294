/* SPDX-License-Identifier: Apache-2.0 */
/* Detects overlaps between tetrahedra that share no face.
 *
 * A point off all faces lies in as many positive tetrahedra as the boundary winds around it: both
 * numbers change by one across a boundary face and not across an inner face, and both vanish far
 * away. So there is an overlap exactly where the boundary winds twice or more. If two boundary
 * faces cross or coincide, there is one: on the inner side of both it winds at least twice (or the
 * faces are two walls between parts that should share them, which is not conforming). If none do,
 * the number is constant in each face-connected part, unless the part contains another; that one
 * then has the higher number. So one point per part decides.
 *
 * Stages: the boundary; pairs of its faces that cross; parts; a point in each. All exact. Cost:
 * O(n) for n tetrahedra, and O(m log m) for m boundary faces with few contacts. */
#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "mesh/topology.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "tetrahedra";

enum { CANCEL_EVERY = 1 << 12 };

typedef struct checker {
    const starg_tetmesh *mesh;
    size_t face_count;
    uint32_t *faces; /* of the boundary, outward, 3 each */
    uint32_t *owner; /* the tetrahedron of each face */
    bvh *tree;
    uint32_t crossing[2]; /* two crossing boundary faces, if found */
    bool found;
    bool cancelled;
    size_t pairs;
} checker;

static starg_status collect_boundary(checker *c) {
    const starg_tetmesh *mesh = c->mesh;
    for (size_t f = 0; f < 4 * mesh->count; f++)
        c->face_count += mesh->neighbours[f] == STARG_TETMESH_NONE;
    NEW(mesh->context, STAGE, c->faces, 3 * c->face_count);
    NEW(mesh->context, STAGE, c->owner, c->face_count);
    size_t count = 0;
    for (size_t f = 0; f < 4 * mesh->count; f++) {
        if (mesh->neighbours[f] != STARG_TETMESH_NONE)
            continue;
        for (int k = 0; k < 3; k++)
            c->faces[3 * count + (size_t)k] =
                mesh->tetrahedra[(f & ~(size_t)3) + (size_t)TETMESH_FACE[f & 3][k]];
        c->owner[count++] = (uint32_t)(f / 4);
    }
    return bvh_create(mesh->context, mesh->vertices, c->faces, c->face_count, &c->tree);
}

/* ---- faces that cross ---- */

static bool look_at_pair(void *user, uint32_t a, uint32_t b) {
    checker *c = user;
    if (++c->pairs % CANCEL_EVERY == 0 && starg_check_cancel(c->mesh->context, STAGE) != STARG_OK) {
        c->cancelled = true;
        return false;
    }
    if (faces_contact(c->mesh->vertices, c->faces + 3 * (size_t)a, c->faces + 3 * (size_t)b) !=
        TRIANGLES_CROSS)
        return true;
    c->crossing[0] = a;
    c->crossing[1] = b;
    c->found = true;
    return false;
}

static starg_status check_crossings(checker *c) {
    bvh_query_pairs(c->tree, look_at_pair, c);
    if (c->cancelled)
        return STARG_ERROR_CANCELLED;
    if (!c->found)
        return STARG_OK;
    uint64_t tetrahedra[2] = {c->owner[c->crossing[0]], c->owner[c->crossing[1]]};
    return starg_fail_at(c->mesh->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_TETRAHEDRON,
                         tetrahedra, 2,
                         "boundary faces of tetrahedra %llu and %llu pass through or lie on one "
                         "another: the mesh overlaps itself there, or two parts of it do not share "
                         "the vertices where they touch",
                         (unsigned long long)tetrahedra[0], (unsigned long long)tetrahedra[1]);
}

/* ---- parts inside others ---- */

/* The rounded centroid, if it is strictly inside. */
static bool inner_point(const starg_tetmesh *mesh, size_t t, double out[3]) {
    const double *p[4];
    for (int k = 0; k < 4; k++)
        p[k] = tetmesh_corner(mesh, t, k);
    for (int i = 0; i < 3; i++)
        out[i] = 0.25 * p[0][i] + 0.25 * p[1][i] + 0.25 * p[2][i] + 0.25 * p[3][i];
    for (int k = 0; k < 4; k++)
        if (orient3d(p[TETMESH_FACE[k][0]], p[TETMESH_FACE[k][1]], p[TETMESH_FACE[k][2]], out) <= 0)
            return false;
    return true;
}

static void join_parts(const starg_tetmesh *mesh, uint32_t *part) {
    sets_make(part, mesh->count);
    for (size_t f = 0; f < 4 * mesh->count; f++)
        if (mesh->neighbours[f] != STARG_TETMESH_NONE)
            sets_join(part, (uint32_t)(f / 4), mesh->neighbours[f]);
}

static starg_status fail_winding(const checker *c, size_t t, int winding) {
    uint64_t tetrahedron = t;
    return starg_fail_at(
        c->mesh->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_TETRAHEDRON, &tetrahedron, 1,
        "the middle of tetrahedron %zu lies in %d tetrahedra: one part of the mesh "
        "lies in another",
        t, winding);
}

/* Tests the first tetrahedron of each part that has an inner point. */
static starg_status check_parts(checker *c) {
    const starg_tetmesh *mesh = c->mesh;
    SCOPED uint32_t *part = NULL;
    SCOPED bool *done_part = NULL;
    NEW(mesh->context, STAGE, part, mesh->count);
    NEW_ZERO(mesh->context, STAGE, done_part, mesh->count);
    join_parts(mesh, part);
    for (size_t t = 0; t < mesh->count; t++) {
        double p[3];
        bool on_surface;
        uint32_t own = sets_find(part, (uint32_t)t);
        if (done_part[own] || !inner_point(mesh, t, p))
            continue;
        done_part[own] = true;
        int winding = bvh_winding(c->tree, p, &on_surface);
        if (winding != 1 && !on_surface)
            return fail_winding(c, t, winding);
        TRY(starg_check_cancel(mesh->context, STAGE));
    }
    return STARG_OK;
}

starg_status tetmesh_check_overlap(const starg_tetmesh *mesh) {
    starg_status status = STARG_OK;
    checker c = {.mesh = mesh};
    STARG_TRY(collect_boundary(&c));
    STARG_TRY(check_crossings(&c));
    STARG_TRY(check_parts(&c));
done:
    bvh_free(c.tree);
    RELEASE(c.faces, c.owner);
    return status;
}
