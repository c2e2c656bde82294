/* SPDX-License-Identifier: Apache-2.0 */
/* What of a surface lies on other parts of it, within a distance: vertices on edges and in faces,
 * edges that meet where two faces lie in one plane, and faces with a common area. (Edges that meet
 * elsewhere make no gaps; joining them would not end where two surfaces cross at a small angle.)
 *
 * Each face asks trees for the faces near it: one tree of each fan (near_fans.c), and one of all
 * other faces. Most are neighbours that turn away from its plane and are passed over at once. An
 * edge is looked at from one of its faces only. Faces of one fan are not asked for each other, but
 * for the vertices on them.
 *
 * Distances are rounded, which is harmless: they select what is joined, and what is left apart
 * stays as it was. Cost: that of the pairs of faces whose boxes meet. */
#include <float.h>
#include <stdlib.h>

#include "geometry/bvh.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "mesh/union/union.h"

enum { CROSSINGS_PER_FACE = 32, SPARE_CROSSINGS = 20000, PAIRS_PER_CLOCK = 4096 };

typedef struct seeker {
    near_facts *out;
    const double *place;
    const uint32_t *faces;
    double distance;
    /* the face whose neighbours are sought */
    uint32_t face;
    const double *corner[3];
    double normal[3], length; /* of the normal */
    near_fans fans;
    uint32_t *corners; /* of the faces in the order of the fans */
    bvh **trees;       /* of each fan; 0: of the faces of none */
    uint32_t fan;      /* of the tree that is asked */
    bvh_box box;       /* that it is asked about */
    uint32_t vertex;   /* whose place is sought in its own fan */
    size_t pairs;
    starg_status status;
} seeker;

static const double *place_of(const seeker *s, uint32_t vertex) {
    return s->place + 3 * (size_t)vertex;
}

/* ---- edges ---- */

typedef struct edge_key {
    uint32_t low, high, halfedge;
} edge_key;

static int compare_keys(const void *left, const void *right) {
    const edge_key *a = left, *b = right;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    return (a->halfedge > b->halfedge) - (a->halfedge < b->halfedge);
}

static starg_status number_edges(near_facts *out, const uint32_t *faces) {
    size_t count = 3 * out->face_count;
    SCOPED edge_key *keys = NULL;
    NEW(out->context, UNION_STAGE, keys, count);
    NEW(out->context, UNION_STAGE, out->edge, count);
    for (uint32_t h = 0; h < count; h++) {
        uint32_t a = faces[h], b = faces[corner_next(h)];
        keys[h] = (edge_key){a < b ? a : b, a < b ? b : a, h};
    }
    if (count > 0)
        qsort(keys, count, sizeof *keys, compare_keys);
    for (size_t i = 0; i < count; i++)
        out->edge_count +=
            i == 0 || keys[i].low != keys[i - 1].low || keys[i].high != keys[i - 1].high;
    NEW(out->context, UNION_STAGE, out->ends, 2 * out->edge_count);
    NEW(out->context, UNION_STAGE, out->owner, out->edge_count);
    size_t edge = 0;
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || keys[i].low != keys[i - 1].low || keys[i].high != keys[i - 1].high) {
            out->owner[edge] = keys[i].halfedge;
            out->ends[2 * edge] = keys[i].low;
            out->ends[2 * edge + 1] = keys[i].high;
            edge++;
        }
        out->edge[keys[i].halfedge] = (uint32_t)(edge - 1);
    }
    return STARG_OK;
}

static bool ends_at(const near_facts *facts, uint32_t edge, uint32_t vertex) {
    return facts->ends[2 * (size_t)edge] == vertex || facts->ends[2 * (size_t)edge + 1] == vertex;
}

/* ---- distances ---- */

/* Does p lie on the segment, but not at its ends? */
static bool is_on(const seeker *s, const double p[3], const double a[3], const double b[3],
                  double *at) {
    double u[3], w[3], c[3];
    vec3_subtract(b, a, u);
    vec3_subtract(p, a, w);
    double length = vec3_dot(u, u), along = vec3_dot(u, w);
    if (!(along > 0 && along < length))
        return false;
    vec3_cross(u, w, c);
    *at = along / length;
    return vec3_dot(c, c) <= s->distance * s->distance * length;
}

/* Notes how far what is joined lies apart. */
static void note_distance(seeker *s, double distance) {
    s->out->farthest = fmax(s->out->farthest, distance);
}

static bool is_on_edge(const seeker *s, uint32_t edge, uint32_t vertex, double *at) {
    return is_on(s, place_of(s, vertex), place_of(s, s->out->ends[2 * (size_t)edge]),
                 place_of(s, s->out->ends[2 * (size_t)edge + 1]), at);
}

static double distance_from_edge(const seeker *s, uint32_t edge, uint32_t vertex) {
    const double *a = place_of(s, s->out->ends[2 * (size_t)edge]);
    double u[3], w[3], c[3];
    vec3_subtract(place_of(s, s->out->ends[2 * (size_t)edge + 1]), a, u);
    vec3_subtract(place_of(s, vertex), a, w);
    vec3_cross(u, w, c);
    return vec3_length(c) / vec3_length(u);
}

/* The side of the plane of the current face on which p lies; 0 within the distance. Its normal is
 * rounded: a narrow face has no certain plane. */
static int side_of(const seeker *s, const double p[3]) {
    double w[3];
    vec3_subtract(p, s->corner[0], w);
    double height = vec3_dot(s->normal, w);
    double doubt = 8 * DBL_EPSILON * vec3_distance(s->corner[1], s->corner[0]) *
                   vec3_distance(s->corner[2], s->corner[0]) * vec3_length(w);
    double limit = s->distance * s->length + doubt;
    return height > limit ? 1 : height < -limit ? -1 : 0;
}

/* Does p, in the plane, lie on the inner side of all edges, and on none? */
static bool is_inside(const seeker *s, const double p[3]) {
    for (int k = 0; k < 3; k++) {
        const double *a = s->corner[k], *b = s->corner[(k + 1) % 3];
        double u[3], w[3], c[3], at;
        vec3_subtract(b, a, u);
        vec3_subtract(p, a, w);
        vec3_cross(u, w, c);
        if (!(vec3_dot(c, s->normal) > 0) || is_on(s, p, a, b, &at))
            return false;
    }
    return true;
}

/* Where two segments meet within them, away from their ends. */
static bool do_cross(seeker *s, const double *const p[2], const double *const q[2],
                     near_crossing *out) {
    double u[3], v[3], w[3], n[3], c[3], x[3], y[3], at;
    vec3_subtract(p[1], p[0], u);
    vec3_subtract(q[1], q[0], v);
    vec3_subtract(q[0], p[0], w);
    vec3_cross(u, v, n);
    double square = vec3_dot(n, n);
    if (!(square > 0) || fabs(vec3_dot(w, n)) > 2 * s->distance * sqrt(square))
        return false;
    vec3_cross(w, v, c);
    out->at[0] = vec3_dot(c, n) / square;
    vec3_cross(w, u, c);
    out->at[1] = vec3_dot(c, n) / square;
    for (int i = 0; i < 2; i++)
        if (!(out->at[i] > 0 && out->at[i] < 1))
            return false;
    vec3_along(p[0], out->at[0], u, x);
    vec3_along(q[0], out->at[1], v, y);
    if (!(vec3_distance(x, y) <= s->distance))
        return false;
    for (int i = 0; i < 2; i++)
        if (is_on(s, p[i], q[0], q[1], &at) || is_on(s, q[i], p[0], p[1], &at))
            return false;
    for (int k = 0; k < 3; k++)
        out->point[k] = 0.5 * x[k] + 0.5 * y[k];
    note_distance(s, vec3_distance(x, y) + DBL_EPSILON);
    return true;
}

/* Do two triangles in one plane have a common area? Not if the line of an edge of either keeps them
 * apart. */
static bool keeps_apart(const seeker *s, const double *const of[3], const double *const other[3]) {
    double normal[3];
    vec3_triangle_normal(of[0], of[1], of[2], normal);
    for (int k = 0; k < 3; k++) {
        double u[3], out[3], most = -INFINITY;
        vec3_subtract(of[(k + 1) % 3], of[k], u);
        vec3_cross(normal, u, out); /* inwards */
        for (int i = 0; i < 3; i++) {
            double w[3];
            vec3_subtract(other[i], of[k], w);
            most = fmax(most, vec3_dot(out, w));
        }
        if (most <= s->distance * vec3_length(out))
            return true;
    }
    return false;
}

static bool same_corners(const uint32_t *a, const uint32_t *b) {
    int common = 0;
    for (int i = 0; i < 3; i++)
        common += a[i] == b[0] || a[i] == b[1] || a[i] == b[2];
    return common == 3;
}

/* ---- pairs ---- */

/* Is the vertex on edges that the face owns? */
static starg_status seek_on_edges(seeker *s, uint32_t vertex) {
    for (uint32_t h = 3 * s->face; h < 3 * s->face + 3; h++) {
        near_on_edge fact = {s->out->edge[h], vertex, 0};
        if (s->out->owner[fact.edge] != h || ends_at(s->out, fact.edge, vertex) ||
            !is_on_edge(s, fact.edge, vertex, &fact.at))
            continue;
        PUSH(s->out->context, UNION_STAGE, &s->out->on, fact);
        note_distance(s, distance_from_edge(s, fact.edge, vertex));
    }
    return STARG_OK;
}

/* Is the vertex, which lies in the plane of the face, in the face? */
static starg_status seek_in_face(seeker *s, uint32_t vertex) {
    const uint32_t *own = s->faces + 3 * (size_t)s->face;
    const near_in_face fact = {s->face, vertex};
    double w[3];
    if (vertex == own[0] || vertex == own[1] || vertex == own[2] ||
        !is_inside(s, place_of(s, vertex)))
        return STARG_OK;
    vec3_subtract(place_of(s, vertex), s->corner[0], w);
    PUSH(s->out->context, UNION_STAGE, &s->out->in, fact);
    note_distance(s, fabs(vec3_dot(s->normal, w)) / s->length);
    return STARG_OK;
}

/* Slivers upon slivers within the distance cross each other by the million; cutting them makes
 * more. */
static bool has_enough(seeker *s) {
    s->out->full = s->out->full || s->out->crossing.count >
                                       CROSSINGS_PER_FACE * s->out->face_count + SPARE_CROSSINGS;
    return s->out->full;
}

static starg_status seek_crossings(seeker *s, uint32_t other) {
    const near_facts *facts = s->out;
    for (uint32_t h = 3 * s->face; h < 3 * s->face + 3; h++)
        for (uint32_t g = 3 * other; g < 3 * other + 3; g++) {
            near_crossing fact = {.edge = {facts->edge[h], facts->edge[g]}};
            const double *end[2][2];
            if (fact.edge[0] > fact.edge[1]) { /* as found from the other face, too */
                fact.edge[0] = facts->edge[g];
                fact.edge[1] = facts->edge[h];
            }
            const uint32_t *a = facts->ends + 2 * (size_t)fact.edge[0];
            const uint32_t *b = facts->ends + 2 * (size_t)fact.edge[1];
            if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1])
                continue;
            for (int i = 0; i < 2; i++) {
                end[0][i] = place_of(s, a[i]);
                end[1][i] = place_of(s, b[i]);
            }
            if (do_cross(s, end[0], end[1], &fact) && !has_enough(s))
                PUSH(s->out->context, UNION_STAGE, &s->out->crossing, fact);
        }
    return STARG_OK;
}

static void join_if_overlapping(seeker *s, uint32_t other) {
    const uint32_t *own = s->faces + 3 * (size_t)s->face, *theirs = s->faces + 3 * (size_t)other;
    const double *corner[3] = {place_of(s, theirs[0]), place_of(s, theirs[1]),
                               place_of(s, theirs[2])};
    if (same_corners(own, theirs) || keeps_apart(s, s->corner, corner) ||
        keeps_apart(s, corner, s->corner))
        return;
    sets_join(s->out->sheet, s->face, other);
    s->out->sheets = true;
}

/* Can nothing but common corners be near? */
static bool turns_away(const seeker *s, uint32_t other, const int side[3]) {
    const uint32_t *own = s->faces + 3 * (size_t)s->face, *theirs = s->faces + 3 * (size_t)other;
    int all = 0;
    for (int k = 0; k < 3; k++) {
        if (theirs[k] == own[0] || theirs[k] == own[1] || theirs[k] == own[2])
            continue;
        if (side[k] == 0 || side[k] == -all)
            return false;
        all = side[k];
    }
    return all != 0;
}

static starg_status look_at_pair(seeker *s, uint32_t other) {
    const uint32_t *theirs = s->faces + 3 * (size_t)other;
    int side[3] = {1, 1, 1};
    for (int k = 0; k < 3 && other != s->face; k++)
        side[k] = side_of(s, place_of(s, theirs[k]));
    if (other != s->face && turns_away(s, other, side))
        return STARG_OK;
    for (int k = 0; k < 3; k++) {
        TRY(seek_on_edges(s, theirs[k]));
        if (side[k] == 0)
            TRY(seek_in_face(s, theirs[k]));
    }
    if (side[0] == 0 && side[1] == 0 && side[2] == 0) {
        join_if_overlapping(s, other);
        TRY(seek_crossings(s, other));
    }
    return STARG_OK;
}

/* Stops at an error, and where there is too much. */
static bool goes_on(seeker *s) {
    if (s->status == STARG_OK && ++s->pairs % PAIRS_PER_CLOCK == 0)
        s->status = starg_check_cancel(s->out->context, UNION_STAGE);
    return s->status == STARG_OK && !s->out->full;
}

static uint32_t face_at(const seeker *s, uint32_t rank) {
    return s->fans.faces[s->fans.start[s->fan] + rank];
}

static bool visit_pair(void *user, uint32_t rank) {
    seeker *s = user;
    s->status = look_at_pair(s, face_at(s, rank));
    return goes_on(s);
}

static void look_at(seeker *s, uint32_t face) {
    s->face = face;
    for (int k = 0; k < 3; k++)
        s->corner[k] = place_of(s, s->faces[3 * (size_t)face + (size_t)k]);
    vec3_triangle_normal(s->corner[0], s->corner[1], s->corner[2], s->normal);
    s->length = vec3_length(s->normal);
}

static starg_status look_at_vertex(seeker *s) {
    TRY(seek_on_edges(s, s->vertex));
    return side_of(s, place_of(s, s->vertex)) == 0 ? seek_in_face(s, s->vertex) : STARG_OK;
}

static bool visit_vertex(void *user, uint32_t rank) {
    seeker *s = user;
    look_at(s, face_at(s, rank));
    s->status = look_at_vertex(s);
    return goes_on(s);
}

/* The box of some points, with the distance around it. */
static bvh_box box_of(const seeker *s, const double *const *points, int count) {
    bvh_box box;
    for (int k = 0; k < 3; k++) {
        box.lower[k] = INFINITY;
        box.upper[k] = -INFINITY;
        for (int i = 0; i < count; i++) {
            box.lower[k] = fmin(box.lower[k], points[i][k]);
            box.upper[k] = fmax(box.upper[k], points[i][k]);
        }
        box.lower[k] -= s->distance;
        box.upper[k] += s->distance;
    }
    return box;
}

static bool ask_fan(void *user, uint32_t fan) {
    seeker *s = user;
    s->fan = fan;
    return (fan > 0 && fan == s->fans.of[s->face]) ||
           bvh_query_box(s->trees[fan], &s->box, visit_pair, s);
}

static void ask_for(seeker *s, uint32_t face, const bvh *roots) {
    look_at(s, face);
    s->box = box_of(s, s->corner, 3);
    bvh_query_box(roots, &s->box, ask_fan, s);
}

static int compare_vertices(const void *left, const void *right) {
    const uint32_t *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

/* The vertices of a fan in its own faces. */
static starg_status ask_for_vertices(seeker *s, uint32_t fan) {
    size_t first = s->fans.start[fan], count = 3 * (s->fans.start[fan + 1] - first);
    SCOPED uint32_t *list = NULL;
    NEW(s->out->context, UNION_STAGE, list, count);
    memcpy(list, s->corners + 3 * first, count * sizeof *list);
    qsort(list, count, sizeof *list, compare_vertices);
    s->fan = fan;
    for (size_t i = 0; i < count && s->status == STARG_OK && !s->out->full; i++) {
        if (i > 0 && list[i] == list[i - 1])
            continue;
        s->vertex = list[i];
        const double *p = place_of(s, s->vertex);
        s->box = box_of(s, &p, 1);
        bvh_query_box(s->trees[fan], &s->box, visit_vertex, s);
    }
    return s->status;
}

/* A tree of the faces of each fan, and one of the boxes of all these trees: a box is that of a
 * triangle of two of its corners. Each is empty where there are no faces. */
typedef struct tree_roots {
    STARG_ARRAY(double) corners;
    STARG_ARRAY(uint32_t) triangles;
    bvh *tree;
} tree_roots;

static void free_roots(tree_roots *roots) {
    RELEASE(roots->corners.data, roots->triangles.data);
    bvh_free(roots->tree);
}

static starg_status make_trees(seeker *s, tree_roots *roots) {
    starg_context *context = s->out->context;
    const near_fans *fans = &s->fans;
    NEW(context, UNION_STAGE, s->corners, 3 * s->out->face_count);
    NEW_ZERO(context, UNION_STAGE, s->trees, fans->count + 1);
    for (size_t i = 0; i < 3 * s->out->face_count; i++)
        s->corners[i] = s->faces[3 * (size_t)fans->faces[i / 3] + i % 3];
    for (size_t k = 0; k <= fans->count; k++) {
        size_t first = fans->start[k], count = fans->start[k + 1] - first;
        bvh_box box = {{INFINITY, INFINITY, INFINITY}, {INFINITY, INFINITY, INFINITY}};
        TRY(bvh_create(context, s->place, s->corners + 3 * first, count, &s->trees[k]));
        if (count > 0)
            box = s->trees[k]->nodes[0].box;
        for (int i = 0; i < 3; i++) {
            PUSH(context, UNION_STAGE, &roots->triangles, (uint32_t)(2 * k + (i > 0)));
        }
        for (int i = 0; i < 3; i++)
            PUSH(context, UNION_STAGE, &roots->corners, box.lower[i]);
        for (int i = 0; i < 3; i++)
            PUSH(context, UNION_STAGE, &roots->corners, box.upper[i]);
    }
    return bvh_create(context, roots->corners.data, roots->triangles.data, fans->count + 1,
                      &roots->tree);
}

static void free_seeker(seeker *s) {
    for (size_t k = 0; s->trees != NULL && k <= s->fans.count; k++)
        bvh_free(s->trees[k]);
    RELEASE(s->trees, s->corners);
    near_fans_free(&s->fans);
}

starg_status near_find(starg_context *context, const double *place, const uint32_t *faces,
                       size_t face_count, double distance, near_facts *out) {
    SCOPED_BY(free_roots) tree_roots roots = {0};
    *out = (near_facts){.context = context, .face_count = face_count};
    SCOPED_BY(free_seeker)
    seeker s = {.out = out, .place = place, .faces = faces, .distance = distance};
    TRY(number_edges(out, faces));
    NEW(context, UNION_STAGE, out->sheet, face_count);
    sets_make(out->sheet, face_count);
    TRY(near_fans_find(context, place, faces, face_count, &s.fans));
    TRY(make_trees(&s, &roots));
    for (uint32_t f = 0; f < face_count && s.status == STARG_OK && !out->full; f++)
        ask_for(&s, f, roots.tree);
    TRY(s.status);
    for (uint32_t k = 1; k <= s.fans.count; k++)
        TRY(ask_for_vertices(&s, k));
    TRY(starg_check_cancel(context, UNION_STAGE));
    near_sort(out);
    return STARG_OK;
}

/* ---- order ---- */

static int compare_on(const void *left, const void *right) {
    const near_on_edge *a = left, *b = right;
    if (a->edge != b->edge)
        return a->edge < b->edge ? -1 : 1;
    if (a->at != b->at)
        return a->at < b->at ? -1 : 1;
    return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

static int compare_in(const void *left, const void *right) {
    const near_in_face *a = left, *b = right;
    if (a->face != b->face)
        return a->face < b->face ? -1 : 1;
    return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

static int compare_crossings(const void *left, const void *right) {
    const near_crossing *a = left, *b = right;
    for (int k = 0; k < 2; k++)
        if (a->edge[k] != b->edge[k])
            return a->edge[k] < b->edge[k] ? -1 : 1;
    return 0;
}

void near_sort(near_facts *facts) {
    size_t kept = 0;
    if (facts->on.count > 0)
        qsort(facts->on.data, facts->on.count, sizeof *facts->on.data, compare_on);
    for (size_t i = 0; i < facts->on.count; i++) {
        const near_on_edge *own = &facts->on.data[i];
        bool known = false; /* a vertex that stands twice on an edge has the first place */
        for (size_t k = kept; k-- > 0 && facts->on.data[k].edge == own->edge && !known;)
            known = facts->on.data[k].vertex == own->vertex;
        if (!known)
            facts->on.data[kept++] = *own;
    }
    facts->on.count = kept;
    kept = 0;
    if (facts->in.count > 0)
        qsort(facts->in.data, facts->in.count, sizeof *facts->in.data, compare_in);
    for (size_t i = 0; i < facts->in.count; i++)
        if (i == 0 || compare_in(&facts->in.data[i], &facts->in.data[i - 1]) != 0)
            facts->in.data[kept++] = facts->in.data[i];
    facts->in.count = kept;
    kept = 0;
    if (facts->crossing.count > 0)
        qsort(facts->crossing.data, facts->crossing.count, sizeof *facts->crossing.data,
              compare_crossings);
    for (size_t i = 0; i < facts->crossing.count; i++)
        if (i == 0 ||
            compare_crossings(&facts->crossing.data[i], &facts->crossing.data[i - 1]) != 0)
            facts->crossing.data[kept++] = facts->crossing.data[i];
    facts->crossing.count = kept;
}

void near_free(near_facts *facts) {
    RELEASE(facts->edge, facts->ends, facts->owner, facts->sheet, facts->on.data, facts->in.data,
            facts->crossing.data);
}
