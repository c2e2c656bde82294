/* SPDX-License-Identifier: Apache-2.0 */
/* Shells are components of faces that share edges. They are oriented by the rule of the library's
 * solids, reimplemented: a shell inside an even number of others bounds the solid from outside and
 * must have positive volume; inside an odd number it bounds a cavity and must have negative volume;
 * "inside" means that the other shell has a nonzero winding number about points that are not on it.
 * A shell that crosses another gets positive volume. Signs of volumes are exact.
 *
 * Cost: a hash table of directed edges, O(n); with several shells one winding number for each pair
 * whose bounds allow nesting, and all pairs of faces for each cavity and a shell around it. */
#include "verify/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/rng.h"
#include "verify/exact_sum.h"
#include "verify/sets.h"
#include "verify/signs.h"

static const char STAGE[] = "verify";

/* ---- edges ---- */

/* Directed edge e runs from corner e % 3 of face e / 3 to the next corner. The table holds e + 1 at
 * the first free slot after the hash of its ends. */
typedef struct edge_table {
    const uint32_t *faces;
    uint64_t *slots;
    size_t mask;
} edge_table;

static uint32_t edge_from(const uint32_t *faces, uint64_t e) {
    return faces[e];
}

static uint32_t edge_to(const uint32_t *faces, uint64_t e) {
    return faces[e % 3 == 2 ? e - 2 : e + 1];
}

/* The slot of the edge from a to b, or the free slot for it. */
static uint64_t *find_edge(const edge_table *table, uint32_t a, uint32_t b) {
    size_t i = (size_t)starg_hash64((uint64_t)a << 32 | b) & table->mask;
    for (;; i = (i + 1) & table->mask) {
        uint64_t *slot = &table->slots[i];
        if (*slot == 0 ||
            (edge_from(table->faces, *slot - 1) == a && edge_to(table->faces, *slot - 1) == b))
            return slot;
    }
}

static starg_status insert_edges(starg_context *context, edge_table *table, size_t edge_count) {
    for (uint64_t e = 0; e < edge_count; e++) {
        uint32_t a = edge_from(table->faces, e), b = edge_to(table->faces, e);
        uint64_t *slot = find_edge(table, a, b);
        if (a == b || *slot != 0) {
            const uint64_t ends[2] = {a, b};
            return starg_fail_at(context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_EDGE, ends, 2,
                                 "the surface is not oriented: face %zu runs along edge %u-%u %s",
                                 (size_t)(e / 3), a, b,
                                 a == b ? "that has no length" : "like another face");
        }
        *slot = e + 1;
    }
    return STARG_OK;
}

/* ---- shells ---- */

/* Joins faces that share an edge; the root of a shell is its lowest face. */
static starg_status join_faces(starg_context *context, const edge_table *table, size_t edge_count,
                               uint32_t *parent) {
    for (uint32_t f = 0; f < edge_count / 3; f++)
        parent[f] = f;
    for (uint64_t e = 0; e < edge_count; e++) {
        uint32_t a = edge_from(table->faces, e), b = edge_to(table->faces, e);
        uint64_t twin = *find_edge(table, b, a);
        if (twin == 0) {
            const uint64_t ends[2] = {a, b};
            return starg_fail_at(context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_EDGE, ends, 2,
                                 "the surface is not closed: edge %u-%u of face %zu has no face "
                                 "on its other side",
                                 a, b, (size_t)(e / 3));
        }
        verify_join(parent, (uint32_t)(e / 3), (uint32_t)((twin - 1) / 3));
    }
    return STARG_OK;
}

typedef struct shell {
    const uint32_t *faces;
    size_t count;
    double lower[3], upper[3];
} shell;

typedef struct shell_list {
    STARG_ARRAY(shell) list;
    uint32_t *faces; /* by shell */
} shell_list;

static void widen(shell *own, const double p[3]) {
    for (int k = 0; k < 3; k++) {
        own->lower[k] = fmin(own->lower[k], p[k]);
        own->upper[k] = fmax(own->upper[k], p[k]);
    }
}

/* Groups the faces by root. `place` first counts, then holds the next free place of each root. */
static starg_status gather_shells(const verify_surface *surface, uint32_t *parent,
                                  shell_list *shells) {
    starg_context *context = surface->context;
    starg_status status = STARG_OK;
    size_t n = surface->face_count, *place = NULL, next = 0;
    STARG_NEW_ZERO(context, STAGE, place, n);
    STARG_NEW(context, STAGE, shells->faces, n);
    for (uint32_t f = 0; f < n; f++)
        place[verify_root(parent, f)]++;
    for (uint32_t f = 0; f < n; f++)
        if (parent[f] == f) {
            shell own = {.faces = shells->faces + next,
                         .count = place[f],
                         .lower = {INFINITY, INFINITY, INFINITY},
                         .upper = {-INFINITY, -INFINITY, -INFINITY}};
            place[f] = next;
            next += own.count;
            STARG_PUSH(context, STAGE, &shells->list, own);
        }
    for (uint32_t f = 0; f < n; f++)
        shells->faces[place[verify_root(parent, f)]++] = f;
    for (size_t s = 0; s < shells->list.count; s++) {
        shell *own = &shells->list.data[s];
        for (size_t i = 0; i < 3 * own->count; i++) {
            size_t corner = 3 * (size_t)own->faces[i / 3] + i % 3;
            widen(own, surface->vertices + 3 * (size_t)surface->faces[corner]);
        }
    }
done:
    starg_release(context, place);
    return status;
}

static int volume_sign(const verify_surface *surface, const shell *own) {
    exact_sum sum;
    exact_sum_clear(&sum);
    for (size_t i = 0; i < own->count; i++) {
        const double *t[3];
        verify_corners(surface, own->faces[i], t);
        exact_sum_add_determinant(&sum, t[0], t[1], t[2]);
    }
    return exact_sum_sign(&sum);
}

static bool bounds_meet(const shell *a, const shell *b) {
    for (int k = 0; k < 3; k++)
        if (a->upper[k] < b->lower[k] || b->upper[k] < a->lower[k])
            return false;
    return true;
}

/* Place number `which` of a face: its corners, then points within, which are rounded. */
static void place_on(const double *const t[3], int which, double out[3]) {
    const double *a = t[which % 3], *b = t[(which + 1) % 3], *c = t[(which + 2) % 3];
    for (int k = 0; k < 3; k++)
        out[k] = which < 3 ? a[k] : 0.5 * a[k] + (0.25 * b[k] + 0.25 * c[k]);
}

/* Does `other` have a nonzero winding number about the first place of `own` that is not on it?
 * Corners come first, which are exact. */
static bool lies_in(const verify_surface *surface, const shell *own, const shell *other) {
    if (!bounds_meet(own, other))
        return false;
    for (int first = 0; first < 6; first += 3)
        for (size_t i = 0; i < 3 * own->count; i++) {
            const double *t[3];
            double p[3];
            bool on_surface;
            verify_corners(surface, own->faces[i / 3], t);
            place_on(t, first + (int)(i % 3), p);
            int winding = verify_winding(surface, other->faces, other->count, p, &on_surface);
            if (!on_surface)
                return winding != 0;
        }
    return false;
}

static void face_bounds(const verify_surface *surface, uint32_t face, shell *bounds) {
    const double *t[3];
    verify_corners(surface, face, t);
    for (int k = 0; k < 3; k++)
        bounds->lower[k] = bounds->upper[k] = t[0][k];
    widen(bounds, t[1]);
    widen(bounds, t[2]);
}

/* Does an edge of s pass through the inside of t? */
static bool passes_through(const double *const s[3], const double *const t[3]) {
    for (int i = 0; i < 3; i++) {
        const double *p = s[i], *q = s[(i + 1) % 3];
        int turn = verify_side(p, q, t[0], t[1]);
        if (turn != 0 && verify_side(p, q, t[1], t[2]) == turn &&
            verify_side(p, q, t[2], t[0]) == turn &&
            verify_side(t[0], t[1], t[2], p) * verify_side(t[0], t[1], t[2], q) < 0)
            return true;
    }
    return false;
}

/* Is a corner of a face elsewhere than the shell, beside or in the other? */
static bool strays(const verify_surface *surface, const double *const t[3], const shell *other,
                   bool in) {
    for (int k = 0; k < 3; k++) {
        bool on_surface;
        int winding = verify_winding(surface, other->faces, other->count, t[k], &on_surface);
        if (!on_surface && (winding != 0) != in)
            return true;
    }
    return false;
}

/* Faces that overlap in a plane touch. */
static bool shells_cross(const verify_surface *surface, const shell *own, const shell *other,
                         bool in) {
    if (!bounds_meet(own, other))
        return false;
    for (size_t i = 0; i < own->count; i++) {
        shell far_face, near_face;
        const double *s[3], *t[3];
        bool near = false;
        face_bounds(surface, own->faces[i], &near_face);
        verify_corners(surface, own->faces[i], s);
        for (size_t j = 0; j < other->count && bounds_meet(&near_face, other); j++) {
            face_bounds(surface, other->faces[j], &far_face);
            if (!bounds_meet(&near_face, &far_face))
                continue;
            near = true;
            verify_corners(surface, other->faces[j], t);
            if (passes_through(s, t) || passes_through(t, s))
                return true;
        }
        if (near && strays(surface, s, other, in))
            return true;
    }
    return false;
}

static bool is_cavity(const verify_surface *surface, const shell_list *shells, const shell *own) {
    size_t depth = 0;
    for (size_t s = 0; s < shells->list.count; s++)
        depth += own != &shells->list.data[s] && lies_in(surface, own, &shells->list.data[s]);
    if (depth % 2 == 0)
        return false;
    for (size_t s = 0; s < shells->list.count; s++) {
        const shell *other = &shells->list.data[s];
        if (own != other && shells_cross(surface, own, other, lies_in(surface, own, other)))
            return false;
    }
    return true;
}

static starg_status turn_shells(verify_surface *surface, const shell_list *shells) {
    starg_context *context = surface->context;
    starg_status status = STARG_OK;
    uint8_t *turn = NULL;
    STARG_NEW_ZERO(context, STAGE, turn, shells->list.count);
    for (size_t s = 0; s < shells->list.count; s++) {
        const shell *own = &shells->list.data[s];
        STARG_TRY(starg_check_cancel(context, STAGE));
        turn[s] = volume_sign(surface, own) == (is_cavity(surface, shells, own) ? 1 : -1);
    }
    for (size_t s = 0; s < shells->list.count; s++)
        for (size_t i = 0; turn[s] && i < shells->list.data[s].count; i++) {
            uint32_t *face = surface->faces + 3 * (size_t)shells->list.data[s].faces[i];
            uint32_t second = face[1];
            face[1] = face[2];
            face[2] = second;
        }
done:
    starg_release(context, turn);
    return status;
}

/* ---- public function ---- */

static starg_status orient(verify_surface *surface, bool turns) {
    starg_context *context = surface->context;
    starg_status status = STARG_OK;
    edge_table table = {.faces = surface->faces, .mask = 1};
    size_t edge_count = 3 * surface->face_count;
    uint32_t *parent = NULL;
    shell_list shells = {0};
    while (table.mask < 2 * edge_count)
        table.mask = 2 * table.mask + 1;
    STARG_NEW_ZERO(context, STAGE, table.slots, table.mask + 1);
    STARG_NEW(context, STAGE, parent, surface->face_count);
    STARG_TRY(insert_edges(context, &table, edge_count));
    STARG_TRY(join_faces(context, &table, edge_count, parent));
    STARG_TRY(gather_shells(surface, parent, &shells));
    if (turns)
        STARG_TRY(turn_shells(surface, &shells));
done:
    starg_release(context, table.slots);
    starg_release(context, parent);
    starg_release(context, shells.faces);
    STARG_ARRAY_FREE(context, &shells.list);
    return status;
}

starg_status verify_find_twins(const verify_surface *surface, uint32_t **twin) {
    starg_status status = STARG_OK;
    starg_context *context = surface->context;
    const uint32_t *faces = surface->faces;
    edge_table table = {.faces = faces, .mask = 1};
    size_t edge_count = 3 * surface->face_count;
    *twin = NULL;
    while (table.mask < 2 * edge_count)
        table.mask = 2 * table.mask + 1;
    STARG_NEW_ZERO(context, STAGE, table.slots, table.mask + 1);
    STARG_NEW(context, STAGE, *twin, edge_count);
    STARG_TRY(insert_edges(context, &table, edge_count));
    for (uint64_t e = 0; e < edge_count; e++)
        (*twin)[e] = (uint32_t)(*find_edge(&table, edge_to(faces, e), edge_from(faces, e)) - 1);
done:
    starg_release(context, table.slots);
    return status;
}

/* Of the vertices in use: others may be anywhere. */
static void find_bounds(verify_surface *surface) {
    for (size_t k = 0; k < 3; k++) {
        surface->lower[k] = INFINITY;
        surface->upper[k] = -INFINITY;
        for (size_t i = 0; i < 3 * surface->face_count; i++) {
            double x = surface->vertices[3 * (size_t)surface->faces[i] + k];
            surface->lower[k] = fmin(surface->lower[k], x);
            surface->upper[k] = fmax(surface->upper[k], x);
        }
    }
}

/* ---- coincident vertices ---- */

typedef struct place {
    double p[3];
    uint32_t vertex;
} place;

static int compare_positions(const place *a, const place *b) {
    for (int k = 0; k < 3; k++)
        if (a->p[k] != b->p[k])
            return a->p[k] < b->p[k] ? -1 : 1;
    return 0;
}

static int compare_places(const void *left, const void *right) {
    const place *a = left, *b = right;
    int order = compare_positions(a, b);
    return order != 0 ? order : (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

/* Maps corners at one position to the lowest vertex there, as in the library's solids. */
static starg_status weld(verify_surface *surface) {
    starg_status status = STARG_OK;
    place *places = NULL;
    uint32_t *first = NULL;
    STARG_NEW(surface->context, STAGE, places, surface->vertex_count);
    STARG_NEW(surface->context, STAGE, first, surface->vertex_count);
    for (uint32_t v = 0; v < surface->vertex_count; v++) {
        memcpy(places[v].p, surface->vertices + 3 * (size_t)v, sizeof places[v].p);
        places[v].vertex = v;
    }
    qsort(places, surface->vertex_count, sizeof *places, compare_places);
    for (size_t i = 0; i < surface->vertex_count; i++)
        first[places[i].vertex] = i > 0 && compare_positions(&places[i - 1], &places[i]) == 0
                                      ? first[places[i - 1].vertex]
                                      : places[i].vertex;
    for (size_t i = 0; i < 3 * surface->face_count; i++)
        surface->faces[i] = first[surface->faces[i]];
done:
    starg_release(surface->context, places);
    starg_release(surface->context, first);
    return status;
}

static starg_status copy_faces(starg_context *context, const starg_mesh *mesh,
                               verify_surface **out) {
    starg_status status = STARG_OK;
    verify_surface *surface = NULL;
    size_t face_count = starg_mesh_face_count(mesh);
    *out = NULL;
    if (face_count == 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the model has no faces");
    STARG_NEW_ZERO(context, STAGE, surface, 1);
    surface->context = context;
    surface->vertex_count = surface->model_vertices = starg_mesh_vertex_count(mesh);
    surface->face_count = surface->model_faces = face_count;
    surface->vertices = starg_mesh_vertices(mesh);
    STARG_NEW(context, STAGE, surface->faces, 3 * face_count);
    memcpy(surface->faces, starg_mesh_faces(mesh), 3 * face_count * sizeof *surface->faces);
    find_bounds(surface);
    *out = surface;
done:
    if (status != STARG_OK)
        verify_surface_free(surface);
    return status;
}

static starg_status create(starg_context *context, const starg_mesh *mesh, bool turns,
                           verify_surface **out) {
    starg_status status = STARG_OK;
    verify_surface *surface = NULL;
    *out = NULL;
    STARG_TRY(copy_faces(context, mesh, &surface));
    status = orient(surface, turns);
    if (status == STARG_ERROR_MESH) { /* nothing has been reversed yet */
        STARG_TRY(weld(surface));
        STARG_TRY(orient(surface, turns));
    }
    *out = status == STARG_OK ? surface : NULL;
done:
    if (status != STARG_OK)
        verify_surface_free(surface);
    return status;
}

starg_status verify_surface_create(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out) {
    return create(context, mesh, true, out);
}

starg_status verify_surface_as_given(starg_context *context, const starg_mesh *mesh,
                                     verify_surface **out) {
    return create(context, mesh, false, out);
}

starg_status verify_surface_welded(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out) {
    starg_status status = STARG_OK;
    verify_surface *surface = NULL;
    *out = NULL;
    STARG_TRY(copy_faces(context, mesh, &surface));
    STARG_TRY(weld(surface));
    *out = surface;
    surface = NULL;
done:
    verify_surface_free(surface);
    return status;
}

starg_status verify_surface_wrap(starg_context *context, const double *vertices,
                                 size_t vertex_count, uint32_t *faces, size_t face_count,
                                 verify_surface **out) {
    starg_status status = STARG_OK;
    verify_surface *surface = NULL;
    *out = NULL;
    STARG_NEW(context, STAGE, surface, 1);
    *surface = (verify_surface){.context = context,
                                .vertex_count = vertex_count,
                                .face_count = face_count,
                                .model_vertices = vertex_count,
                                .model_faces = face_count,
                                .vertices = vertices,
                                .faces = faces};
    find_bounds(surface);
    *out = surface;
done:
    if (status != STARG_OK)
        starg_release(context, faces);
    return status;
}

void verify_surface_free(verify_surface *surface) {
    if (surface == NULL)
        return;
    starg_release(surface->context, surface->faces);
    starg_release(surface->context, surface->importance);
    starg_release(surface->context, surface->own_vertices);
    starg_release(surface->context, surface);
}
