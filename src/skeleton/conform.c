/* SPDX-License-Identifier: Apache-2.0 */
/* Conforming samples: modifies a closed triangle mesh, preserving manifoldness and topology, until
 * all of its faces are faces of the Delaunay tetrahedra of its points. The mesh then bounds a set
 * of whole tetrahedra, which provably has the topology of the solid, without a tolerance.
 *
 * Rounds of moves, each at an edge or a face that is missing in the tetrahedra (is lost):
 *
 *   - flip: a lost edge between faces u v w and v u x becomes w x if it is not Delaunay in its
 *     plane, or if u w x and v w x are faces of tetrahedra and the fold is not sharp. Most lost
 *     edges of scanned models are of this kind and need no points.
 *   - unfold, once no other flip applies: flips an edge at which the angle between a lost face and
 *     its neighbour is small, which closes a crack or removes a fin.
 *   - points: the midpoint of a lost edge, and where an edge of tetrahedra pierces a lost face; or
 *     the midpoint of the terminal longest edge, which keeps angles from getting small [Rivara
 *     1997].
 *
 * Strategies differ in how they insert points and in what they consider a fold. All start from the
 * state after flips alone, and are tried one after another until no face is lost.
 *
 * It is not necessary to prove that a flip does not sweep over other parts of the surface: once all
 * faces are faces of tetrahedra, the surface is embedded. Only points whose tetrahedra changed are
 * re-examined. Edges that meet at tiny angles, and surfaces that intersect themselves, may never
 * conform: points, their depth and work are bounded, and the faces still lost are counted. Which
 * strategy gets further there is largely chance, so several short attempts beat a long one.
 *
 * Cost: the Delaunay tetrahedra, and per round linear in what has changed. */
#include "skeleton/skeleton.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const char STAGE[] = "surface samples";

/* Bounds on flips of the two kinds undoing each other, and on points. WORK is per point: some
 * thirty times the cost of examining all of them once. */
enum { MAX_PASSES = 20, WORK = 1000 };

/* Rounds end when the number of lost faces exceeds SETBACK times its minimum, or after PATIENCE
 * rounds without a new minimum: points then only cause more points. */
enum { SETBACK = 4, PATIENCE = 20 };

/* With more lost faces than one per HOPELESS points, faces are lost all over the surface and not in
 * single spots that another strategy might handle. */
enum { HOPELESS = 20 };

/* Identified by its ends, since nearby moves renumber halfedges. */
typedef struct mesh_edge {
    uint32_t u, v;
    uint32_t halfedge; /* its last known number */
} mesh_edge;

typedef STARG_ARRAY(mesh_edge) lost_list;

/* A halfedge from the examined point: have it and the face on its left been found? */
typedef struct spoke {
    uint32_t halfedge, head;
    bool edge, face;
} spoke;

/* Cosine of a bend that still counts as flat: eight degrees. */
static const double FLAT = 0.99;
/* Cosine of the angle below which two faces overlap: eleven degrees. */
#define NARROW (-0.98)

/* A strategy for what flips cannot resolve. */
typedef struct strategy {
    bool pierces; /* inserts points where faces are pierced, otherwise by bisection */
    double fold;  /* cosine of the angle below which an edge is a fold; -1: none */
} strategy;

enum { STRATEGY_COUNT = CONFORM_RESULTS - 1 };

/* No strategy is best for all meshes. The first changes the surface least and adds the fewest
 * points; the last two treat every edge sharper than a right angle as a fold. */
static const strategy STRATEGIES[STRATEGY_COUNT] = {
    {false, -1}, {true, NARROW}, {false, 0}, {true, 0}};

typedef struct conformer {
    starg_context *context;
    delaunay_builder *builder;
    sample_mesh mesh;
    STARG_ARRAY(spoke) ring;          /* of the examined point, in cyclic order */
    lost_list lost_edges, last_edges; /* now, and in the previous search */
    lost_list lost_faces, last_faces; /* each by its halfedge from its lowest corner */
    uint32_t *place;                  /* per point: its number in the current ring, from 1, or 0 */
    size_t place_capacity;
    size_t least;                  /* least number of lost faces since the rounds began */
    size_t work;                   /* corners of tetrahedra examined by all strategies so far */
    size_t most_points, most_work; /* limits of the rounds */
} conformer;

static size_t point_count(const conformer *c) {
    return sample_mesh_points(&c->mesh);
}

static const double *at(const conformer *c, uint32_t v) {
    return sample_mesh_at(&c->mesh, v);
}

static uint32_t tail(const conformer *c, uint32_t h) {
    return halfedges_start(&c->mesh.net, h);
}

static uint32_t head(const conformer *c, uint32_t h) {
    return halfedges_end(&c->mesh.net, h);
}

static uint32_t apex(const conformer *c, uint32_t h) {
    return halfedges_apex(&c->mesh.net, h);
}

static uint32_t twin(const conformer *c, uint32_t h) {
    return halfedges_twin(&c->mesh.net, h);
}

static uint32_t find_edge(const conformer *c, const mesh_edge *e) {
    if (tail(c, e->halfedge) == e->u && head(c, e->halfedge) == e->v)
        return e->halfedge;
    return halfedges_find(&c->mesh.net, e->u, e->v);
}

static bool is_mesh_edge(const conformer *c, uint32_t v, uint32_t w) {
    return halfedges_find(&c->mesh.net, v, w) != TOPOLOGY_NONE;
}

/* ---- lost edges and faces ---- */

/* The halfedges from v, counter-clockwise, all marked as not found. */
static starg_status find_ring(conformer *c, uint32_t v) {
    uint32_t first = c->mesh.net.leaving.data[v], h = first;
    c->ring.count = 0;
    do {
        PUSH(c->context, STAGE, &c->ring, ((spoke){.halfedge = h, .head = head(c, h)}));
        h = halfedges_turn(&c->mesh.net, h);
    } while (h != first);
    return STARG_OK;
}

/* Marks the edges and faces of the ring that occur in tetrahedra of the star. */
static void find_in_star(conformer *c, uint32_t (*star)[3], size_t count) {
    spoke *ring = c->ring.data;
    uint32_t n = (uint32_t)c->ring.count;
    for (uint32_t i = 0; i < n; i++)
        c->place[ring[i].head] = i + 1;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t a = c->place[star[i][k]], b = c->place[star[i][(k + 1) % 3]];
            if (a == 0)
                continue;
            ring[a - 1].edge = true;
            if (b != 0 && b == a % n + 1)
                ring[a - 1].face = true;
            if (b != 0 && a == b % n + 1)
                ring[b - 1].face = true;
        }
    for (uint32_t i = 0; i < n; i++)
        c->place[ring[i].head] = 0;
}

/* Searches the edges and faces at v in the tetrahedra at v: each edge at its lower end, each face
 * at its lowest corner. */
static starg_status examine_point(conformer *c, uint32_t v) {
    uint32_t(*star)[3];
    size_t count;
    TRY(find_ring(c, v));
    TRY(delaunay_star(c->builder, v, &star, &count));
    c->work += count + c->ring.count;
    find_in_star(c, star, count);
    for (size_t i = 0; i < c->ring.count; i++) {
        const spoke *s = &c->ring.data[i];
        const mesh_edge e = {v, s->head, s->halfedge};
        if (!s->edge && v < s->head)
            PUSH(c->context, STAGE, &c->lost_edges, e);
        if (!s->face && v < s->head && v < apex(c, s->halfedge))
            PUSH(c->context, STAGE, &c->lost_faces, e);
    }
    return STARG_OK;
}

/* Must v be examined again? Creating or deleting a tetrahedron changes all of its points, so an
 * edge whose other end has not changed is still there. */
static bool needs_examination(conformer *c, uint32_t v) {
    uint32_t first = c->mesh.net.leaving.data[v], h = first;
    bool changed = delaunay_take_change(c->builder, v), dirty = c->mesh.dirty.data[v];
    c->mesh.dirty.data[v] = false;
    if (dirty || !changed)
        return dirty;
    do {
        if (v < head(c, h) && delaunay_has_changed(c->builder, head(c, h)))
            return true;
        h = halfedges_turn(&c->mesh.net, h);
    } while (h != first);
    return false;
}

/* Keeps what was lost at v in the previous search, since nothing changed there. The lists are
 * sorted by point; *next is where those of v start. */
static inline starg_status keep_lost(conformer *c, const lost_list *last, uint32_t v, size_t *next,
                                     lost_list *lost) {
    for (; *next < last->count && last->data[*next].u == v; ++*next)
        PUSH(c->context, STAGE, lost, last->data[*next]);
    return STARG_OK;
}

static void skip_lost(const lost_list *last, uint32_t v, size_t *next) {
    while (*next < last->count && last->data[*next].u == v)
        ++*next;
}

static void swap_lists(lost_list *a, lost_list *b) {
    lost_list swap = *a;
    *a = *b;
    *b = swap;
    a->count = 0;
}

static starg_status find_lost(conformer *c) {
    size_t next_edge = 0, next_face = 0;
    swap_lists(&c->lost_edges, &c->last_edges);
    swap_lists(&c->lost_faces, &c->last_faces);
    for (uint32_t v = 0; v < point_count(c); v++) {
        if (c->mesh.net.leaving.data[v] == TOPOLOGY_NONE)
            continue;
        if (needs_examination(c, v)) {
            skip_lost(&c->last_edges, v, &next_edge);
            skip_lost(&c->last_faces, v, &next_face);
            TRY(examine_point(c, v));
        } else {
            TRY(keep_lost(c, &c->last_edges, v, &next_edge, &c->lost_edges));
            TRY(keep_lost(c, &c->last_faces, v, &next_face, &c->lost_faces));
        }
    }
    return STARG_OK;
}

/* Is a b d a face of tetrahedra? */
static starg_status is_face(conformer *c, uint32_t a, uint32_t b, uint32_t d, bool *answer) {
    uint32_t(*star)[3];
    size_t count;
    starg_status status = delaunay_star(c->builder, a, &star, &count);
    c->work += count;
    *answer = false;
    for (size_t i = 0; status == STARG_OK && i < count && !*answer; i++) {
        int shared = 0;
        for (int k = 0; k < 3; k++)
            shared += star[i][k] == b || star[i][k] == d;
        *answer = shared == 2;
    }
    return status;
}

/* ---- flips ---- */

/* The dihedral angle of the old faces is flatter than a right angle (or one has nearly no area),
 * and the new faces have consistent normals. */
static bool is_flat_enough(const conformer *c, uint32_t h) {
    uint32_t t = twin(c, h);
    const double *u = at(c, tail(c, h)), *v = at(c, head(c, h)), *w = at(c, apex(c, h)),
                 *x = at(c, apex(c, t));
    double m[2][3], n[2][3], sum[3];
    vec3_triangle_normal(u, v, w, m[0]);
    vec3_triangle_normal(v, u, x, m[1]);
    vec3_triangle_normal(w, u, x, n[0]);
    vec3_triangle_normal(x, v, w, n[1]);
    for (int k = 0; k < 3; k++)
        sum[k] = m[0][k] + m[1][k];
    return vec3_dot(n[0], sum) >= 0 && vec3_dot(n[1], sum) >= 0 && vec3_dot(m[0], sum) >= 0 &&
           vec3_dot(m[1], sum) >= 0;
}

/* Are the two faces coplanar up to rounding or a slight bend, and is their edge not Delaunay in
 * that plane (the opposite angles sum to more than pi)? */
static bool is_flat_and_poor(const conformer *c, uint32_t h) {
    uint32_t t = twin(c, h);
    const double *u = at(c, tail(c, h)), *v = at(c, head(c, h)), *w = at(c, apex(c, h)),
                 *x = at(c, apex(c, t));
    double m[2][3], n[2][3], wu[3], wv[3], xu[3], xv[3];
    vec3_triangle_normal(u, v, w, m[0]);
    vec3_triangle_normal(v, u, x, m[1]);
    vec3_triangle_normal(w, u, x, n[0]);
    vec3_triangle_normal(x, v, w, n[1]);
    vec3_subtract(u, w, wu);
    vec3_subtract(v, w, wv);
    vec3_subtract(u, x, xu);
    vec3_subtract(v, x, xv);
    double s0 = vec3_length(m[0]), s1 = vec3_length(m[1]), t0 = vec3_length(n[0]),
           t1 = vec3_length(n[1]);
    if (vec3_dot(m[0], m[1]) < FLAT * s0 * s1 || vec3_dot(n[0], n[1]) < FLAT * t0 * t1)
        return false;
    return vec3_dot(wu, wv) * s1 + vec3_dot(xu, xv) * s0 < -1e-9 * (s0 * s1);
}

static starg_status try_flip(conformer *c, uint32_t h, bool *flipped) {
    uint32_t u = tail(c, h), v = head(c, h), w = apex(c, h), x = apex(c, twin(c, h));
    bool one = false, other = false;
    *flipped = false;
    if (w == x || is_mesh_edge(c, w, x))
        return STARG_OK;
    if (is_flat_and_poor(c, h)) {
        sample_mesh_flip(&c->mesh, h);
        *flipped = true;
        return STARG_OK;
    }
    if (!is_flat_enough(c, h))
        return STARG_OK;
    TRY(is_face(c, w, u, x, &one));
    if (one)
        TRY(is_face(c, w, v, x, &other));
    if (one && other) {
        sample_mesh_flip(&c->mesh, h);
        *flipped = true;
    }
    return STARG_OK;
}

/* Is the angle between the two faces of an edge below a fold's? */
static bool is_fold(const conformer *c, uint32_t h, double fold) {
    const double *u = at(c, tail(c, h)), *v = at(c, head(c, h));
    double m[2][3];
    vec3_triangle_normal(u, v, at(c, apex(c, h)), m[0]);
    vec3_triangle_normal(v, u, at(c, apex(c, twin(c, h))), m[1]);
    return vec3_dot(m[0], m[1]) < fold * vec3_length(m[0]) * vec3_length(m[1]);
}

/* Closes the crack between the face and one of its neighbours, or removes the fin. A face that has
 * not been cut yet may still be found unchanged. */
static void unfold(conformer *c, uint32_t f, double fold, size_t *flips) {
    if (sample_mesh_depth(&c->mesh, f) == 0)
        return;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t h = 3 * f + k, w = apex(c, h), x = apex(c, twin(c, h));
        if (w != x && is_fold(c, h, fold) && !is_mesh_edge(c, w, x)) {
            sample_mesh_flip(&c->mesh, h);
            ++*flips;
            return;
        }
    }
}

/* Folds wait until no other flip applies: faces lost nearby for another reason could be mistaken
 * for folds. */
static starg_status flip_lost(conformer *c, const strategy *how, size_t *flips) {
    *flips = 0;
    for (size_t i = 0; i < c->lost_edges.count; i++) {
        bool flipped;
        TRY(try_flip(c, find_edge(c, &c->lost_edges.data[i]), &flipped));
        *flips += flipped;
    }
    size_t waiting = *flips == 0 && how->fold > -1 ? c->lost_faces.count : 0;
    for (size_t i = 0; i < waiting; i++)
        unfold(c, c->lost_faces.data[i].halfedge / 3, how->fold, flips);
    return STARG_OK;
}

/* ---- points ---- */

static starg_status cut_lost_edges(conformer *c) {
    for (size_t i = 0; i < c->lost_edges.count; i++) {
        uint32_t u = c->lost_edges.data[i].u, v = c->lost_edges.data[i].v;
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = 0.5 * at(c, u)[k] + 0.5 * at(c, v)[k];
        TRY(sample_mesh_split_edge(&c->mesh, find_edge(c, &c->lost_edges.data[i]), p));
    }
    return STARG_OK;
}

static double determinant(const double *a, const double *b, const double *d, const double *p) {
    double u[3], v[3], w[3];
    vec3_subtract(a, p, u);
    vec3_subtract(b, p, v);
    vec3_subtract(d, p, w);
    return vec3_triple(u, v, w);
}

/* Does the segment p q pass through the inside of the triangle? */
static bool pierces(const double *const t[3], const double *p, const double *q) {
    int side = orient3d(t[0], t[1], t[2], p);
    if (side == 0 || orient3d(t[0], t[1], t[2], q) != -side)
        return false;
    for (int k = 0; k < 3; k++)
        if (orient3d(p, q, t[k], t[(k + 1) % 3]) == 0 ||
            orient3d(p, q, t[k], t[(k + 1) % 3]) != orient3d(p, q, t[0], t[1]))
            return false;
    return true;
}

/* The edge of tetrahedra that pierces the face of h is opposite to one of the face's own edges. */
static starg_status find_piercing(conformer *c, uint32_t h, double place[3], bool *found) {
    const uint32_t v[3] = {tail(c, h), head(c, h), apex(c, h)};
    const double *const t[3] = {at(c, v[0]), at(c, v[1]), at(c, v[2])};
    *found = false;
    for (int k = 0; k < 3 && !*found; k++) {
        uint32_t(*star)[3];
        size_t count;
        TRY(delaunay_star(c->builder, v[k], &star, &count));
        for (size_t i = 0; i < 3 * count && !*found; i++) {
            const double *p = at(c, star[i / 3][i % 3]), *q = at(c, star[i / 3][(i % 3 + 1) % 3]);
            if (!pierces(t, p, q))
                continue;
            double a = fabs(determinant(t[0], t[1], t[2], p)),
                   b = fabs(determinant(t[0], t[1], t[2], q)), s = a + b > 0 ? a / (a + b) : 0.5;
            for (int j = 0; j < 3; j++)
                place[j] = (1 - s) * p[j] + s * q[j];
            *found = true;
        }
    }
    return STARG_OK;
}

/* Skips faces with a lost edge, which were cut with it: their corners changed or wait. */
static starg_status pierce_lost_faces(conformer *c, const bool *cut) {
    for (size_t i = 0; i < c->lost_faces.count; i++) {
        uint32_t h = c->lost_faces.data[i].halfedge;
        double p[3];
        bool found;
        if (cut[h / 3])
            continue;
        TRY(find_piercing(c, h, p, &found));
        if (found)
            TRY(sample_mesh_split_face(&c->mesh, h / 3, p));
    }
    return STARG_OK;
}

static double length_squared(const conformer *c, uint32_t h) {
    return vec3_distance_squared(at(c, tail(c, h)), at(c, head(c, h)));
}

static uint32_t longest_edge(const conformer *c, uint32_t h) {
    uint32_t next = corner_next(h), last = corner_previous(h);
    double a = length_squared(c, h), b = length_squared(c, next), d = length_squared(c, last);
    return a >= b && a >= d ? h : b >= d ? next : last;
}

/* The edge that ends the longest-edge path from the face of h [Rivara 1997]: it is the longest edge
 * of both its faces. */
static uint32_t terminal_edge(const conformer *c, uint32_t h) {
    h = longest_edge(c, h);
    for (;;) {
        uint32_t t = twin(c, h), next = longest_edge(c, t);
        if (!(length_squared(c, next) > length_squared(c, h)))
            return h;
        h = next;
    }
}

static starg_status cut_and_pierce(conformer *c) {
    /* faces with a lost edge */
    SCOPED bool *cut = NULL;
    NEW_ZERO(c->context, STAGE, cut, c->mesh.net.corners.count / 3);
    for (size_t i = 0; i < c->lost_edges.count; i++) {
        uint32_t h = find_edge(c, &c->lost_edges.data[i]);
        cut[h / 3] = cut[twin(c, h) / 3] = true;
    }
    TRY(pierce_lost_faces(c, cut));
    return cut_lost_edges(c);
}

static starg_status bisect_lost_faces(conformer *c) {
    size_t first = point_count(c);
    for (size_t i = 0; i < c->lost_faces.count; i++) {
        uint32_t h = c->lost_faces.data[i].halfedge;
        if (tail(c, h) >= first || head(c, h) >= first || apex(c, h) >= first)
            continue; /* cut in this round */
        h = terminal_edge(c, h);
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = 0.5 * at(c, tail(c, h))[k] + 0.5 * at(c, head(c, h))[k];
        TRY(sample_mesh_split_edge(&c->mesh, h, p));
    }
    return STARG_OK;
}

static starg_status reserve_places(conformer *c) {
    size_t count = point_count(c);
    if (count <= c->place_capacity)
        return STARG_OK;
    starg_release(c->context, c->place);
    c->place = NULL;
    c->place_capacity = 0;
    NEW_ZERO(c->context, STAGE, c->place, 2 * count);
    c->place_capacity = 2 * count;
    return STARG_OK;
}

/* Flips until no flip applies. */
static starg_status settle(conformer *c, const strategy *how) {
    TRY(reserve_places(c));
    for (int pass = 0;; pass++) {
        size_t flips;
        TRY(find_lost(c));
        if (pass == MAX_PASSES || c->work > c->most_work)
            break;
        TRY(flip_lost(c, how, &flips));
        if (flips == 0)
            break;
    }
    return STARG_OK;
}

/* The next round would insert about as many points as there are lost faces. */
static bool is_spent(const conformer *c) {
    return point_count(c) + c->lost_faces.count > c->most_points || c->work > c->most_work;
}

/* Alternates points and flips, from a settled state. */
static starg_status run_rounds(conformer *c, const strategy *how) {
    size_t least_round = 0;
    c->least = c->lost_faces.count;
    for (size_t round = 0; c->lost_faces.count > 0; round++) {
        TRY(starg_check_cancel(c->context, STAGE));
        size_t before = point_count(c), lost = c->lost_faces.count;
        if (lost < c->least) {
            c->least = lost;
            least_round = round;
        }
        if (lost > SETBACK * c->least || round - least_round > PATIENCE || is_spent(c))
            return STARG_OK;
        TRY(how->pierces ? cut_and_pierce(c) : bisect_lost_faces(c));
        if (point_count(c) == before)
            return STARG_OK;
        TRY(delaunay_extend(c->builder, c->mesh.points.data, point_count(c)));
        TRY(settle(c, how));
    }
    c->least = 0;
    return STARG_OK;
}

/* ---- manners ---- */

static void conformer_free(conformer *c) {
    delaunay_builder_free(c->builder);
    sample_mesh_free(&c->mesh);
    RELEASE(c->ring.data, c->lost_edges.data, c->lost_faces.data, c->last_edges.data,
            c->last_faces.data, c->place);
    *c = (conformer){.context = c->context};
}

/* The common start of all strategies: flips alone. */
static starg_status start(conformer *c, surface_samples *samples) {
    TRY(sample_mesh_take(c->context, samples, &c->mesh));
    TRY(delaunay_begin(c->context, c->mesh.points.data, point_count(c), &c->builder));
    c->most_points = 3 * point_count(c) / 2 + 2000;
    c->most_work = WORK * point_count(c);
    return settle(c, &STRATEGIES[0]);
}

static starg_status copy_list(starg_context *context, const lost_list *list, lost_list *copy) {
    for (size_t i = 0; i < list->count; i++)
        PUSH(context, STAGE, copy, list->data[i]);
    return STARG_OK;
}

static starg_status conformer_copy(const conformer *c, conformer *copy) {
    copy->most_points = c->most_points;
    copy->most_work = c->most_work;
    copy->work = c->work;
    TRY(sample_mesh_copy(&c->mesh, &copy->mesh));
    TRY(delaunay_copy(c->builder, &copy->builder));
    TRY(copy_list(c->context, &c->lost_edges, &copy->lost_edges));
    return copy_list(c->context, &c->lost_faces, &copy->lost_faces);
}

static starg_status hand_out(conformer *c, conformed *result) {
    result->lost = c->lost_faces.count;
    TRY(delaunay_finish(c->builder, &result->tetrahedra));
    sample_mesh_give(&c->mesh, &result->samples);
    return STARG_OK;
}

/* Inserts the last result into the sorted ones before it; stable. */
static void sort_in(conformed *results, size_t count) {
    conformed last = results[count - 1];
    size_t i = count - 1;
    for (; i > 0 && results[i - 1].lost > last.lost; i--)
        results[i] = results[i - 1];
    results[i] = last;
}

/* Continues from a state that stays unchanged except for its work counter. */
static starg_status try_strategy(conformer *from, const strategy *how, conformed *result,
                                 bool *hopeless) {
    SCOPED_BY(conformer_free) conformer c = {.context = from->context};
    TRY(conformer_copy(from, &c));
    TRY(run_rounds(&c, how));
    *hopeless = c.least > point_count(from) / HOPELESS || c.work > c.most_work;
    from->work = c.work;
    return hand_out(&c, result);
}

starg_status conform_samples(starg_context *context, surface_samples *samples,
                             conformed results[CONFORM_RESULTS], size_t *count) {
    SCOPED_BY(conformer_free) conformer first = {.context = context};
    bool over = false;
    *count = 0;
    memset(results, 0, CONFORM_RESULTS * sizeof *results);
    TRY(start(&first, samples));
    for (const strategy *how = STRATEGIES; how < STRATEGIES + STRATEGY_COUNT && !over; how++) {
        TRY(try_strategy(&first, how, &results[(*count)++], &over));
        sort_in(results, *count);
        over = over || results[0].lost == 0;
    }
    /* points may have made more faces lost */
    if (results[0].lost > 0) {
        TRY(hand_out(&first, &results[(*count)++]));
        sort_in(results, *count);
    }
    return STARG_OK;
}

void conformed_free(conformed *result) {
    samples_free(&result->samples);
    delaunay_free(result->tetrahedra);
    *result = (conformed){0};
}
