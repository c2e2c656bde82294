/* SPDX-License-Identifier: Apache-2.0 */
/* Shells are components of faces that share edges; of more than two faces at an edge, those with
 * solid between them belong together. They are oriented by the rule of the library's solids,
 * reimplemented: a shell inside an even number of others bounds the solid from outside and must
 * have positive volume; inside an odd number it bounds a cavity and must have negative volume;
 * "inside" means that the other shell has a nonzero winding number about points that are not on it.
 * A shell that crosses another gets positive volume: one of which an edge passes through the inside
 * of a face, or with corners on both sides. Signs of volumes are exact.
 *
 * Cost: sorted edges, O(n log n); with several shells one winding number for each pair whose bounds
 * allow nesting, and all pairs of faces for each cavity and a shell around it. */
#include "verify/surface.h"

#include <math.h>
#include <stdlib.h>

#include "verify/sight.h"

static const char STAGE[] = "verify";

/* ---- edges ---- */

/* Edge e of a face runs from corner e % 3 of face e / 3 to the next corner. */
typedef struct side {
    uint32_t low, high, edge; /* the lower and the higher end */
} side;

static uint32_t edge_from(const verify_surface *surface, uint32_t e) {
    return surface->faces[e];
}

static uint32_t edge_to(const verify_surface *surface, uint32_t e) {
    return surface->faces[e % 3 == 2 ? e - 2 : e + 1];
}

static const double *tip_of(const verify_surface *surface, uint32_t e) {
    return surface->vertices + 3 * (size_t)surface->faces[e % 3 == 0 ? e + 2 : e - 1];
}

static int compare_sides(const void *left, const void *right) {
    const side *a = left, *b = right;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    return (a->edge > b->edge) - (a->edge < b->edge);
}

/* In which quarter about the line a b is p, as seen from `first`: 0 the same half plane, 1 before
 * the opposite one, 2 that, 3 beyond it. */
static int quarter(const double a[3], const double b[3], const double first[3], const double p[3]) {
    int sign = verify_side(a, b, first, p);
    for (int axis = 0; sign == 0 && axis < 3; axis++) {
        int turn = verify_turn(a, b, first, axis);
        if (turn != 0)
            return verify_turn(a, b, p, axis) == -turn ? 2 : 0;
    }
    return sign > 0 ? 1 : sign < 0 ? 3 : 0;
}

/* Does the face of edge e come before that of f, turning about the line from that of `first`? */
static bool turns_before(const verify_surface *surface, const side *s, uint32_t first, uint32_t e,
                         uint32_t f) {
    const double *a = surface->vertices + 3 * (size_t)s->low;
    const double *b = surface->vertices + 3 * (size_t)s->high;
    int own = quarter(a, b, tip_of(surface, first), tip_of(surface, e));
    int other = quarter(a, b, tip_of(surface, first), tip_of(surface, f));
    if (own != other)
        return own < other;
    return own % 2 == 1 && verify_side(a, b, tip_of(surface, e), tip_of(surface, f)) > 0;
}

/* The faces at one edge, in order about it: each that runs from the lower end with the next one
 * that runs back, past pairs between them. Solid is between the two. */
static void pair_about(const verify_surface *surface, side *s, size_t count, uint32_t *twin) {
    for (size_t i = 1; i < count; i++)
        for (size_t k = i;
             k > 0 && turns_before(surface, s, s[0].edge, s[k].edge, s[k - 1].edge) && k > 1; k--) {
            side other = s[k];
            s[k] = s[k - 1];
            s[k - 1] = other;
        }
    for (size_t i = 0; i < count; i++) {
        size_t depth = 1, k = i;
        if (edge_from(surface, s[i].edge) != s[i].low)
            continue;
        while (depth > 0) {
            k = (k + 1) % count;
            depth = edge_from(surface, s[k].edge) == s[k].low ? depth + 1 : depth - 1;
        }
        twin[s[i].edge] = s[k].edge;
        twin[s[k].edge] = s[i].edge;
    }
}

static starg_status pair_sides(const verify_surface *surface, side *s, size_t count,
                               uint32_t *twin) {
    size_t forward = 0;
    const uint64_t ends[2] = {s->low, s->high};
    for (size_t i = 0; i < count; i++)
        forward += edge_from(surface, s[i].edge) == s->low;
    if (s->low == s->high || (2 * forward != count && count % 2 == 0))
        return starg_fail_at(surface->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_EDGE, ends, 2,
                             "the surface is not oriented: face %u runs along edge %u-%u %s",
                             s[count - 1].edge / 3, s->low, s->high,
                             s->low == s->high ? "that has no length" : "like another face");
    if (2 * forward != count)
        return starg_fail_at(surface->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_EDGE, ends, 2,
                             "the surface is not closed: edge %u-%u of face %u has no face on its "
                             "other side",
                             s->low, s->high, s->edge / 3);
    pair_about(surface, s, count, twin);
    return STARG_OK;
}

starg_status verify_find_twins(const verify_surface *surface, uint32_t **twin) {
    starg_context *context = surface->context;
    starg_status status = STARG_OK;
    size_t edges = 3 * surface->face_count, count;
    side *sides = NULL;
    *twin = NULL;
    STARG_NEW(context, STAGE, sides, edges);
    STARG_NEW(context, STAGE, *twin, edges);
    for (uint32_t e = 0; e < edges; e++) {
        uint32_t a = edge_from(surface, e), b = edge_to(surface, e);
        sides[e] = (side){a < b ? a : b, a < b ? b : a, e};
    }
    qsort(sides, edges, sizeof *sides, compare_sides);
    for (size_t i = 0; i < edges; i += count) {
        for (count = 1; i + count < edges && sides[i + count].low == sides[i].low &&
                        sides[i + count].high == sides[i].high;)
            count++;
        STARG_TRY(pair_sides(surface, sides + i, count, *twin));
    }
done:
    starg_release(context, sides);
    if (status != STARG_OK) {
        starg_release(context, *twin);
        *twin = NULL;
    }
    return status;
}

/* ---- shells ---- */

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
    size_t n = surface->face_count, next = 0;
    SCOPED size_t *place = NULL;
    NEW_ZERO(context, STAGE, place, n);
    NEW(context, STAGE, shells->faces, n);
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
            PUSH(context, STAGE, &shells->list, own);
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
    return STARG_OK;
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
            if (verify_pierce(s, t))
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

static starg_status turn_shells(verify_surface *surface, const shell_list *shells,
                                verify_facing facing) {
    starg_context *context = surface->context;
    SCOPED uint8_t *turn = NULL;
    NEW_ZERO(context, STAGE, turn, shells->list.count);
    for (size_t s = 0; s < shells->list.count; s++) {
        const shell *own = &shells->list.data[s];
        TRY(starg_check_cancel(context, STAGE));
        bool cavity = facing == VERIFY_NESTED && is_cavity(surface, shells, own);
        turn[s] = volume_sign(surface, own) == (cavity ? 1 : -1);
    }
    for (size_t s = 0; s < shells->list.count; s++)
        for (size_t i = 0; turn[s] && i < shells->list.data[s].count; i++) {
            uint32_t *face = surface->faces + 3 * (size_t)shells->list.data[s].faces[i];
            uint32_t second = face[1];
            face[1] = face[2];
            face[2] = second;
        }
    return STARG_OK;
}

/* ---- public function ---- */

/* The corners at each vertex that follow each other across edges keep it, or get a copy, in the
 * order of the lowest corners, behind the other vertices. */
static starg_status part_vertices(verify_surface *surface, const uint32_t *twin) {
    starg_context *context = surface->context;
    SCOPED STARG_ARRAY(double) vertices = {0};
    SCOPED uint8_t *met = NULL, *used = NULL;
    size_t given = surface->vertex_count;
    NEW_ZERO(context, STAGE, met, 3 * surface->face_count);
    NEW_ZERO(context, STAGE, used, given);
    for (size_t i = 0; i < 3 * given; i++)
        PUSH(context, STAGE, &vertices, surface->vertices[i]);
    for (uint32_t e = 0; e < 3 * surface->face_count; e++) {
        uint32_t vertex = surface->faces[e], own = vertex;
        if (met[e])
            continue;
        if (used[vertex]) {
            own = (uint32_t)(vertices.count / 3);
            for (size_t k = 0; k < 3; k++)
                PUSH(context, STAGE, &vertices, surface->vertices[3 * (size_t)vertex + k]);
        }
        used[vertex] = 1;
        for (uint32_t c = e; !met[c]; c = twin[c % 3 == 0 ? c + 2 : c - 1]) {
            met[c] = 1;
            surface->faces[c] = own;
        }
    }
    surface->vertex_count = vertices.count / 3;
    if (surface->vertex_count > given) {
        starg_release(context, surface->own_vertices);
        surface->vertices = surface->own_vertices = vertices.data;
        vertices.data = NULL;
    }
    return STARG_OK;
}

static starg_status orient(verify_surface *surface, verify_facing facing) {
    starg_context *context = surface->context;
    starg_status status = STARG_OK;
    uint32_t *parent = NULL, *twin = NULL;
    shell_list shells = {0};
    STARG_NEW(context, STAGE, parent, surface->face_count);
    STARG_TRY(verify_find_twins(surface, &twin));
    for (uint32_t f = 0; f < surface->face_count; f++) /* the root of a shell is its lowest face */
        parent[f] = f;
    for (size_t e = 0; e < 3 * surface->face_count; e++)
        verify_join(parent, (uint32_t)(e / 3), twin[e] / 3);
    STARG_TRY(part_vertices(surface, twin));
    STARG_TRY(gather_shells(surface, parent, &shells));
    if (facing != VERIFY_AS_GIVEN)
        STARG_TRY(turn_shells(surface, &shells, facing));
done:
    RELEASE(twin, parent, shells.faces, shells.list.data);
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
    SCOPED place *places = NULL;
    SCOPED uint32_t *first = NULL;
    NEW(surface->context, STAGE, places, surface->vertex_count);
    NEW(surface->context, STAGE, first, surface->vertex_count);
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
    return STARG_OK;
}

static starg_status copy_faces(starg_context *context, const starg_mesh *mesh,
                               verify_surface **out) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    size_t face_count = starg_mesh_face_count(mesh);
    *out = NULL;
    if (face_count == 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the model has no faces");
    NEW_ZERO(context, STAGE, surface, 1);
    surface->context = context;
    surface->vertex_count = surface->model_vertices = starg_mesh_vertex_count(mesh);
    surface->face_count = surface->model_faces = face_count;
    surface->vertices = starg_mesh_vertices(mesh);
    NEW(context, STAGE, surface->faces, 3 * face_count);
    memcpy(surface->faces, starg_mesh_faces(mesh), 3 * face_count * sizeof *surface->faces);
    find_bounds(surface);
    *out = surface;
    surface = NULL;
    return STARG_OK;
}

starg_status verify_surface_facing(starg_context *context, const starg_mesh *mesh,
                                   verify_facing facing, verify_surface **out) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    *out = NULL;
    TRY(copy_faces(context, mesh, &surface));
    starg_status status = orient(surface, facing);
    if (status == STARG_ERROR_MESH) { /* nothing has been reversed yet */
        TRY(weld(surface));
        status = orient(surface, facing);
    }
    TRY(status);
    *out = surface;
    surface = NULL;
    return STARG_OK;
}

starg_status verify_surface_create(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out) {
    return verify_surface_facing(context, mesh, VERIFY_NESTED, out);
}

starg_status verify_surface_welded(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    *out = NULL;
    TRY(copy_faces(context, mesh, &surface));
    TRY(weld(surface));
    *out = surface;
    surface = NULL;
    return STARG_OK;
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
    RELEASE(surface->faces, surface->importance, surface->clear, surface->own_vertices);
    verify_patches_free(surface->patches);
    starg_release(surface->context, surface);
}
