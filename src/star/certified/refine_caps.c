/* SPDX-License-Identifier: Apache-2.0 */
/* Better triangles in the borders between pieces.
 *
 * Problem: a cut meets edges of the model close to their ends, so that its border has edges a
 * thousandth as long as others. Without vertices inside, the triangles at these are thin, and so
 * are the tetrahedra on them, the more so the closer the guard is to the plane of the cut.
 *
 * Method: Delaunay refinement [Ruppert 1995] with off-centres [Ungor 2004], without new vertices on
 * the border, where others would have them, too. The facets in one plane between the same two
 * pieces are a cap. Over the shortest edge of a thin triangle a vertex is added: the centre of its
 * circle, or what makes an isosceles triangle with a fair angle, if that is closer. It is left out
 * if it is outside the cap, or sees an edge of the border at an angle near 180 degrees. After each
 * round the cap is triangulated anew (cut.c). Triangles grow in proportion from short edges to long
 * ones, so that few vertices are enough.
 *
 * Only caps whose tetrahedra have small dihedral angles are refined, and of all rounds the one
 * whose angles lack least is taken.
 *
 * Invariants: those of the partition, by a certificate for every piece; edges and vertices that
 * other facets have stay. Cost: some triangulations for each cap that is refined, and for each
 * vertex that is thought of a pass over the cap. */
#include "star/certified/search.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum { ROUNDS_MOST = 16, FRESH_MOST = 1000 /* new vertices of a cap */ };

/* Of triangles that are thin, and of isosceles ones, in radians. */
static const double THIN = 0.2, FAIR = 0.3;

/* The cosine of what an edge of the border is seen at, and of the distance between new vertices the
 * share of that to old ones. */
static const double FLAT = -0.87, APART = 0.8;

/* A new vertex, in coordinates of the plane. */
typedef struct proposal {
    double at[2];
    double angle; /* of the triangle that it is for */
    double room;  /* to the nearest vertex */
} proposal;

typedef struct refiner {
    partition *p;
    uint32_t *order;           /* facets, cap after cap */
    uint32_t *cap_of;          /* by facet: the place in the order where its cap begins */
    STARG_ARRAY(facet) facets; /* the result */
    bool any;                  /* cap is refined */

    /* the current cap */
    int exponent; /* of the solid's size */
    double origin[3], axes[2][3];
    size_t first_points, best_points; /* before it, and with the best triangles */
    cap_edges edges;                  /* the border comes first */
    size_t border_count;
    cap_indices loose, triangles, best;
    STARG_ARRAY(proposal) proposals;
} refiner;

static void refiner_free(refiner *r) {
    RELEASE(r->order, r->cap_of, r->facets.data, r->edges.data, r->loose.data, r->triangles.data,
            r->best.data, r->proposals.data);
}

/* ---- caps ---- */

typedef struct ranked_facet {
    uint32_t plane, side[2], number;
} ranked_facet;

static int by_cap(const void *x, const void *y) {
    const ranked_facet *a = x, *b = y;
    if (a->plane != b->plane)
        return a->plane < b->plane ? -1 : 1;
    for (int s = 0; s < 2; s++)
        if (a->side[s] != b->side[s])
            return a->side[s] < b->side[s] ? -1 : 1;
    return (a->number > b->number) - (a->number < b->number);
}

static starg_status find_caps(refiner *r) {
    size_t count = r->p->facets.count;
    SCOPED ranked_facet *ranked = NULL;
    NEW(r->p->context, PARTITION_STAGE, ranked, count);
    NEW(r->p->context, PARTITION_STAGE, r->order, count);
    NEW(r->p->context, PARTITION_STAGE, r->cap_of, count);
    for (uint32_t i = 0; i < count; i++) {
        const facet *f = &r->p->facets.data[i];
        ranked[i] = (ranked_facet){f->plane, {f->side[0], f->side[1]}, i};
    }
    qsort(ranked, count, sizeof *ranked, by_cap);
    uint32_t first = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (ranked[i].plane != ranked[first].plane ||
            memcmp(ranked[i].side, ranked[first].side, sizeof ranked[i].side) != 0)
            first = i;
        r->order[i] = ranked[i].number;
        r->cap_of[ranked[i].number] = first;
    }
    return STARG_OK;
}

static bool has_edge(const facet *f, uint32_t from, uint32_t to) {
    for (int k = 0; k < 3; k++)
        if (f->corners[k] == from && f->corners[(k + 1) % 3] == to)
            return true;
    return false;
}

/* Is there a facet of this cap with the edge; of another, in either direction? */
static void look_around(const refiner *r, uint32_t cap, uint32_t from, uint32_t to, bool *own,
                        bool *other) {
    *own = *other = false;
    for (uint32_t c = r->p->first_at.data[from]; c != PARTITION_NO_CORNER;
         c = r->p->next_at.data[c]) {
        const facet *f = &r->p->facets.data[c / 3];
        if (r->cap_of[c / 3] == cap)
            *own = *own || has_edge(f, from, to);
        else
            *other = *other || has_edge(f, from, to) || has_edge(f, to, from);
    }
}

/* The edges of the cap's border, and those within that others have. */
static starg_status find_edges(refiner *r, uint32_t first, uint32_t end) {
    r->edges.count = r->loose.count = 0;
    for (int inner = 0; inner < 2; inner++) {
        for (uint32_t i = 3 * first; i < 3 * end; i++) {
            const uint32_t *c = r->p->facets.data[r->order[i / 3]].corners;
            const constrained_edge edge = {c[i % 3], c[(i % 3 + 1) % 3], inner ? 0 : 1};
            bool own, other;
            look_around(r, first, edge.to, edge.from, &own, &other);
            if (inner ? own && other && edge.from < edge.to : !own)
                PUSH(r->p->context, PARTITION_STAGE, &r->edges, edge);
            if (!inner)
                PUSH(r->p->context, PARTITION_STAGE, &r->loose, edge.from);
        }
        r->border_count = inner ? r->border_count : r->edges.count;
    }
    return STARG_OK;
}

/* ---- angles ---- */

/* What the angles lack, in all. */
static double lack_of_all(const refiner *r, const facet *like) {
    facet f = *like;
    double sum = 0;
    for (size_t i = 0; i < r->triangles.count; i += 3) {
        memcpy(f.corners, r->triangles.data + i, sizeof f.corners);
        sum += flatness_of_facet(r->p, &f);
    }
    return sum;
}

/* ---- the plane ---- */

static void find_axes(refiner *r, const facet *f) {
    double normal[3];
    int small = 0;
    for (int k = 0; k < 3; k++)
        normal[k] = ldexp(r->p->planes.data[f->plane].normal[k], r->exponent - r->p->exponents[k]);
    vec3_normalize(normal);
    for (int k = 1; k < 3; k++)
        small = fabs(normal[k]) < fabs(normal[small]) ? k : small;
    const double unit[3] = {small == 0, small == 1, small == 2};
    vec3_cross(normal, unit, r->axes[0]);
    vec3_normalize(r->axes[0]);
    vec3_cross(normal, r->axes[0], r->axes[1]);
    vec3_copy(partition_point(r->p, f->corners[0]), r->origin);
}

static void place(const refiner *r, uint32_t vertex, double out[2]) {
    double from[3];
    vec3_subtract(partition_point(r->p, vertex), r->origin, from);
    for (int k = 0; k < 3; k++)
        from[k] = ldexp(from[k], -r->exponent);
    for (int i = 0; i < 2; i++)
        out[i] = vec3_dot(from, r->axes[i]);
}

static starg_status add_vertex(refiner *r, const double at[2]) {
    double point[3];
    uint32_t vertex;
    for (int k = 0; k < 3; k++)
        point[k] = r->origin[k] + ldexp(at[0] * r->axes[0][k] + at[1] * r->axes[1][k], r->exponent);
    TRY(partition_add_point(r->p, point, &vertex));
    PUSH(r->p->context, PARTITION_STAGE, &r->loose, vertex);
    return STARG_OK;
}

static double distance(const double a[2], const double b[2]) {
    return hypot(a[0] - b[0], a[1] - b[1]);
}

/* Twice the area, positive if counter-clockwise. */
static double area(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* ---- new vertices ---- */

static bool is_inside(const refiner *r, const double at[2]) {
    for (size_t i = 0; i < r->triangles.count; i += 3) {
        double c[3][2];
        for (int k = 0; k < 3; k++)
            place(r, r->triangles.data[i + (size_t)k], c[k]);
        if (area(c[0], c[1], at) >= 0 && area(c[1], c[2], at) >= 0 && area(c[2], c[0], at) >= 0)
            return true;
    }
    return false;
}

/* Is an edge of the border seen at a flat angle, which would make a thin triangle there? */
static bool is_close_to_border(const refiner *r, const double at[2]) {
    for (size_t i = 0; i < r->border_count; i++) {
        double a[2], b[2];
        place(r, r->edges.data[i].from, a);
        place(r, r->edges.data[i].to, b);
        double along = (a[0] - at[0]) * (b[0] - at[0]) + (a[1] - at[1]) * (b[1] - at[1]);
        if (along < FLAT * distance(a, at) * distance(b, at))
            return true;
    }
    return false;
}

/* If a triangle is thin. */
static starg_status propose(refiner *r, const uint32_t corners[3]) {
    double c[3][2], length[3], shortest = INFINITY;
    int k = 0; /* the shortest edge begins here */
    for (int i = 0; i < 3; i++)
        place(r, corners[i], c[i]);
    for (int i = 0; i < 3; i++) {
        length[i] = distance(c[i], c[(i + 1) % 3]);
        if (length[i] < shortest) {
            shortest = length[i];
            k = i;
        }
    }
    const double *a = c[k], *b = c[(k + 1) % 3];
    double sine = area(c[0], c[1], c[2]) / (length[(k + 1) % 3] * length[(k + 2) % 3]);
    if (!(sine > 0 && sine < THIN && shortest > 0))
        return STARG_OK;
    /* the circle's centre is over the middle of the edge, at half its length by the tangent of the
     * angle beyond */
    double high = 0.5 * shortest * fmin(sqrt(1 - sine * sine) / sine, 1 / tan(0.5 * FAIR));
    const proposal fresh = {.at = {0.5 * (a[0] + b[0]) - high * (b[1] - a[1]) / shortest,
                                   0.5 * (a[1] + b[1]) + high * (b[0] - a[0]) / shortest},
                            .angle = sine,
                            .room = hypot(high, 0.5 * shortest)};
    if (is_inside(r, fresh.at) && !is_close_to_border(r, fresh.at))
        PUSH(r->p->context, PARTITION_STAGE, &r->proposals, fresh);
    return STARG_OK;
}

static int by_angle(const void *x, const void *y) {
    const proposal *a = x, *b = y;
    if (a->angle != b->angle)
        return a->angle < b->angle ? -1 : 1;
    for (int i = 0; i < 2; i++)
        if (a->at[i] != b->at[i])
            return a->at[i] < b->at[i] ? -1 : 1;
    return 0;
}

/* Those that are not close to each other, the thinnest triangles first. */
static starg_status add_vertices(refiner *r, bool *any) {
    size_t taken = 0;
    r->proposals.count = 0;
    for (size_t i = 0; i < r->triangles.count; i += 3)
        TRY(propose(r, r->triangles.data + i));
    if (r->proposals.count > 0)
        qsort(r->proposals.data, r->proposals.count, sizeof *r->proposals.data, by_angle);
    for (size_t i = 0; i < r->proposals.count; i++) {
        const proposal next = r->proposals.data[i];
        bool fine = true;
        for (size_t k = 0; k < taken && fine; k++)
            fine = distance(next.at, r->proposals.data[k].at) >
                   APART * fmax(next.room, r->proposals.data[k].room);
        if (!fine)
            continue;
        TRY(add_vertex(r, next.at));
        r->proposals.data[taken++] = next;
    }
    *any = taken > 0;
    return STARG_OK;
}

/* ---- one cap ---- */

static starg_status keep_triangles(refiner *r) {
    r->best.count = 0;
    for (size_t i = 0; i < r->triangles.count; i++)
        PUSH(r->p->context, PARTITION_STAGE, &r->best, r->triangles.data[i]);
    return STARG_OK;
}

/* The best of all rounds. *better is false if no round improved on the input. */
static starg_status refine(refiner *r, const facet *f, bool *better) {
    double best = lack_of_all(r, f);
    bool go_on = true;
    *better = false;
    for (int round = 0; round < ROUNDS_MOST && go_on; round++) {
        TRY(add_vertices(r, &go_on));
        if (!go_on)
            break;
        r->triangles.count = 0;
        TRY(cap_fill(r->p->context, r->p->points.data, r->p->planes.data[f->plane].normal,
                     &r->edges, &r->loose, &r->triangles, &go_on));
        double lack = go_on ? lack_of_all(r, f) : INFINITY;
        go_on = go_on && lack > 0 && r->p->points.count / 3 - r->first_points < FRESH_MOST;
        if (lack >= best)
            continue;
        best = lack;
        *better = true;
        r->best_points = r->p->points.count / 3;
        TRY(keep_triangles(r));
    }
    return STARG_OK;
}

static starg_status take_best(refiner *r, const facet *like) {
    facet fresh = *like;
    for (size_t i = 0; i < r->best.count; i += 3) {
        memcpy(fresh.corners, r->best.data + i, sizeof fresh.corners);
        PUSH(r->p->context, PARTITION_STAGE, &r->facets, fresh);
    }
    return STARG_OK;
}

static starg_status visit_cap(refiner *r, uint32_t first, uint32_t end) {
    const facet like = r->p->facets.data[r->order[first]];
    bool better = false;
    r->first_points = r->p->points.count / 3;
    r->triangles.count = 0;
    for (uint32_t i = 3 * first; i < 3 * end; i++)
        PUSH(r->p->context, PARTITION_STAGE, &r->triangles,
             r->p->facets.data[r->order[i / 3]].corners[i % 3]);
    if (like.side[FACET_OUTER] != PARTITION_OUTSIDE && lack_of_all(r, &like) > 0) {
        find_axes(r, &like);
        TRY(find_edges(r, first, end));
        TRY(refine(r, &like, &better));
    }
    r->any = r->any || better;
    r->p->points.count = r->p->unit.count = 3 * (better ? r->best_points : r->first_points);
    if (better)
        TRY(take_best(r, &like));
    for (uint32_t i = first; i < end && !better; i++)
        PUSH(r->p->context, PARTITION_STAGE, &r->facets, r->p->facets.data[r->order[i]]);
    return STARG_OK;
}

static starg_status visit_caps(refiner *r) {
    size_t count = r->p->facets.count;
    r->exponent = partition_exponent(r->p);
    for (uint32_t first = 0, end = 0; first < count; first = end) {
        while (end < count && r->cap_of[r->order[end]] == first)
            end++;
        TRY(visit_cap(r, first, end));
    }
    r->p->facets.count = 0;
    for (size_t i = 0; i < r->facets.count; i++)
        PUSH(r->p->context, PARTITION_STAGE, &r->p->facets, r->facets.data[i]);
    return STARG_OK;
}

starg_status refine_caps(partition *p) {
    SCOPED_BY(partition_free) partition copy = {.context = p->context};
    SCOPED_BY(refiner_free) refiner r = {.p = &copy};
    bool done = false;
    TRY(partition_copy(p, &copy));
    TRY(partition_build_index(&copy));
    TRY(find_caps(&r));
    TRY(visit_caps(&r));
    TRY(partition_build_index(&copy));
    if (r.any)
        TRY(partition_certify_all(&copy, &done));
    if (done)
        partition_swap(p, &copy);
    return STARG_OK;
}
