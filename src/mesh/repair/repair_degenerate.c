/* SPDX-License-Identifier: Apache-2.0 */
/* Removes zero-area faces of a manifold mesh.
 *
 * Such a face (a, b, m) has its middle corner m on the edge a b. If that edge is open, the face is
 * dropped: a m b is the same border. Otherwise the edge is flipped to m d, where d is the opposite
 * corner of the neighbour, which leaves the surface as a point set unchanged. If m and d are
 * already joined, or the neighbour has no area either, the shorter of the edges a m and m b is
 * collapsed if the link condition allows it; this moves m.
 *
 * Changes of one round touch disjoint vertices, so that the tables of the round stay valid; rounds
 * end when nothing changes. */
#include "geometry/vec3.h"
#include "mesh/repair/repair.h"

enum { MAX_ROUNDS = 32 };

typedef struct flattener {
    repair_state *state;
    mesh_topology *topology;
    repair_stars stars;
    uint8_t *touched; /* per vertex */
    bool changed;
} flattener;

static bool has_no_area(const repair_state *state, size_t face) {
    return repair_has_no_area(state, repair_face(state, face));
}

/* Does x lie on the closed segment p q? */
static bool lies_between(const double x[3], const double p[3], const double q[3]) {
    for (int k = 0; k < 3; k++)
        if ((x[k] < p[k] && x[k] < q[k]) || (x[k] > p[k] && x[k] > q[k]))
            return false;
    return true;
}

/* The halfedge of a zero-area face opposite to its middle corner. */
static uint32_t longest_edge(const repair_state *state, uint32_t face) {
    const uint32_t *corner = repair_face(state, face);
    for (uint32_t k = 0; k < 2; k++)
        if (lies_between(repair_position(state, corner[(k + 2) % 3]),
                         repair_position(state, corner[k]),
                         repair_position(state, corner[(k + 1) % 3])))
            return 3 * face + k;
    return 3 * face + 2;
}

/* Number of faces with both vertices. */
static size_t common_faces(const flattener *f, uint32_t a, uint32_t b) {
    size_t count = 0;
    for (size_t i = f->stars.start[a]; i < f->stars.start[a + 1]; i++) {
        const uint32_t *corner = repair_face(f->state, f->stars.list[i]);
        count += corner[0] == b || corner[1] == b || corner[2] == b;
    }
    return count;
}

/* Vertices joined to both a and b by faces of a. */
static size_t common_neighbours(const flattener *f, uint32_t a, uint32_t b) {
    size_t count = 0;
    for (size_t i = f->stars.start[a]; i < f->stars.start[a + 1]; i++) {
        const uint32_t *corner = repair_face(f->state, f->stars.list[i]);
        for (int k = 0; k < 3; k++) /* counts each neighbour once: as the corner after a */
            if (corner[k] == a && common_faces(f, corner[(k + 1) % 3], b) > 0)
                count += corner[(k + 1) % 3] != b;
    }
    return count;
}

static bool star_is_free(const flattener *f, uint32_t vertex) {
    for (size_t i = f->stars.start[vertex]; i < f->stars.start[vertex + 1]; i++)
        for (int k = 0; k < 3; k++)
            if (f->touched[repair_face(f->state, f->stars.list[i])[k]])
                return false;
    return true;
}

static void touch_star(flattener *f, uint32_t vertex) {
    for (size_t i = f->stars.start[vertex]; i < f->stars.start[vertex + 1]; i++)
        for (int k = 0; k < 3; k++)
            f->touched[repair_face(f->state, f->stars.list[i])[k]] = 1;
    f->changed = true;
}

static bool try_flip(flattener *f, uint32_t h, uint32_t twin) {
    uint32_t *faces = f->state->faces.data;
    uint32_t a = faces[h], b = faces[corner_next(h)];
    uint32_t m = faces[corner_previous(h)], d = faces[corner_previous(twin)];
    if (m == d || common_faces(f, m, d) > 0 || has_no_area(f->state, twin / 3))
        return false;
    touch_star(f, m);
    touch_star(f, d);
    uint32_t *first = repair_face(f->state, h / 3), *second = repair_face(f->state, twin / 3);
    first[0] = a;
    first[1] = d;
    first[2] = m;
    second[0] = d;
    second[1] = b;
    second[2] = m;
    f->state->flags.data[h / 3] |= REPAIR_ADDED;
    f->state->flags.data[twin / 3] |= REPAIR_ADDED;
    return true;
}

/* Merges `from` into `to` if the edge has both faces and no other vertex is joined to both. */
static bool try_collapse(flattener *f, uint32_t from, uint32_t to) {
    if (common_faces(f, from, to) != 2 || common_neighbours(f, from, to) != 2 ||
        !star_is_free(f, from) || !star_is_free(f, to))
        return false;
    touch_star(f, from);
    touch_star(f, to);
    for (size_t i = f->stars.start[from]; i < f->stars.start[from + 1]; i++) {
        uint32_t *corner = repair_face(f->state, f->stars.list[i]);
        uint8_t *flags = &f->state->flags.data[f->stars.list[i]];
        if (corner[0] == to || corner[1] == to || corner[2] == to)
            *flags |= REPAIR_GONE;
        for (int k = 0; k < 3; k++)
            if (corner[k] == from)
                corner[k] = to;
    }
    return true;
}

static void mend_face(flattener *f, uint32_t face) {
    uint32_t h = longest_edge(f->state, face), twin = f->topology->twin[h];
    const uint32_t *corner = repair_face(f->state, face);
    for (int k = 0; k < 3; k++)
        if (f->touched[corner[k]])
            return;
    if (twin == TOPOLOGY_NONE) {
        f->state->flags.data[face] |= REPAIR_GONE;
        touch_star(f, f->state->faces.data[corner_previous(h)]);
        return;
    }
    if (f->touched[f->state->faces.data[corner_previous(twin)]] || try_flip(f, h, twin))
        return;
    uint32_t a = f->state->faces.data[h], b = f->state->faces.data[corner_next(h)];
    uint32_t m = f->state->faces.data[corner_previous(h)];
    const double *middle = repair_position(f->state, m);
    bool to_a = vec3_distance(middle, repair_position(f->state, a)) <=
                vec3_distance(middle, repair_position(f->state, b));
    if (!try_collapse(f, m, to_a ? a : b))
        try_collapse(f, m, to_a ? b : a);
}

static starg_status mend_once(repair_state *state, bool *changed) {
    starg_status status = STARG_OK;
    flattener f = {.state = state};
    starg_mesh view = repair_view(state);
    STARG_TRY(topology_create(state->context, &view, &f.topology));
    STARG_TRY(repair_stars_create(state, &f.stars));
    STARG_NEW_ZERO(state->context, REPAIR_STAGE, f.touched, repair_vertex_count(state));
    for (uint32_t face = 0; face < view.face_count; face++)
        if (!(state->flags.data[face] & REPAIR_GONE) && has_no_area(state, face))
            mend_face(&f, face);
    *changed = f.changed;
    repair_compact(state);
done:
    topology_free(f.topology);
    repair_stars_free(&f.stars);
    starg_release(state->context, f.touched);
    return status;
}

starg_status repair_degenerate(repair_state *state) {
    bool changed = true;
    for (int round = 0; round < MAX_ROUNDS && changed; round++) {
        TRY(mend_once(state, &changed));
        TRY(starg_check_cancel(state->context, REPAIR_STAGE));
    }
    return STARG_OK;
}
