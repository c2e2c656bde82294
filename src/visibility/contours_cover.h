/* SPDX-License-Identifier: Apache-2.0 */
/* Is a face entirely visible? Part of the stages of visibility/contours.c; whole.c decides what is
 * left open here.
 *
 * Let f be a front-facing face whose three corners are visible. If no contour has a point before f,
 * or on f except at its corners and edges, then N, the number of front-facing layers before x, is
 * the same for all points x of f except its corners: it changes as along an edge (contours.c). Near
 * a corner without contours it is that of the corner, 0. If all corners have contours, it is
 * counted at one of them, along an edge of f: the layers that converge there. So f is entirely
 * visible if that is 0.
 *
 * Contours before f are searched in the cells that f touches. A contour is not before f if its
 * greatest nearness is below the least of f; or if it is on the outer side of an edge of f, a
 * common end aside; or if f lies on one side of it; or if none of its ends is on p's side of the
 * plane of f. */

/* A query for contours: f, or the part of it on one cube face. */
typedef struct cover_query {
    const visibility_scene *scene;
    const contours_scratch *s;
    const uint32_t *corner;
    size_t rank;
    uint32_t cube_face;
    cube_polygon polygon;
    bool plain; /* all of f */
    cube_box box;
    float nearness; /* least nearness */
} cover_query;

static void measure_query(cover_query *q) {
    q->box = (cube_box){4, -4, 4, -4};
    for (int i = 0; i < q->polygon.count; i++) {
        const float *c = q->polygon.corner[i];
        q->box.u_low = lesser(q->box.u_low, c[0] - CELL_MARGIN);
        q->box.u_high = greater(q->box.u_high, c[0] + CELL_MARGIN);
        q->box.v_low = lesser(q->box.v_low, c[1] - CELL_MARGIN);
        q->box.v_high = greater(q->box.v_high, c[1] + CELL_MARGIN);
    }
    q->nearness = (float)(q->s->directions.extent / q->polygon.depth) * (1 - CELL_MARGIN);
}

/* Which of WIDE pieces from `i` on are certainly disjoint from f, except for common corners? */
static inline uint32_t apart_from_face(const cover_query *q, uint32_t i) {
    const piece_table *t = &q->s->sorted;
    float turn = q->cube_face % 2 ? -1 : 1; /* makes f counter-clockwise */
    uint32_t apart = 0, left = ~UINT32_C(0), right = ~UINT32_C(0), a_any = 0, b_any = 0;
    for (int k = 0; k < 3; k++) {
        const float *from = q->polygon.corner[k], *to = q->polygon.corner[(k + 1) % 3];
        float u = turn * (to[0] - from[0]), v = turn * (to[1] - from[1]);
        wide du = wide_set(u), dv = wide_set(v);
        wide fu = wide_set(from[0]), fv = wide_set(from[1]);
        wide au = wide_subtract(wide_load(t->au + i), fu);
        wide av = wide_subtract(wide_load(t->av + i), fv);
        wide bu = wide_subtract(wide_load(t->bu + i), fu);
        wide bv = wide_subtract(wide_load(t->bv + i), fv);
        wide at_a = wide_subtract(wide_multiply(du, av), wide_multiply(dv, au));
        wide at_b = wide_subtract(wide_multiply(du, bv), wide_multiply(dv, bu));
        wide at_from = wide_subtract(wide_multiply(au, bv), wide_multiply(av, bu));
        wide size =
            wide_add(wide_add(wide_abs(au), wide_abs(av)), wide_add(wide_abs(bu), wide_abs(bv)));
        wide error =
            wide_multiply(wide_set(EPSILON), wide_add(size, wide_set(fabsf(u) + fabsf(v))));
        wide below = wide_subtract(wide_set(0), error);
        uint32_t a_from = wide_equal(t->a + i, q->corner[k]);
        uint32_t b_from = wide_equal(t->b + i, q->corner[k]);
        uint32_t a_on = a_from | wide_equal(t->a + i, q->corner[(k + 1) % 3]);
        uint32_t b_on = b_from | wide_equal(t->b + i, q->corner[(k + 1) % 3]);
        uint32_t a_out = wide_above(below, at_a), b_out = wide_above(below, at_b);
        apart |= (a_out & b_out) | (a_on & b_out) | (b_on & a_out);
        left &= wide_above(at_from, error);
        right &= wide_above(below, at_from);
        a_any |= a_from;
        b_any |= b_from;
    }
    return apart | left | right | (a_any & b_any);
}

static bool is_behind_plane(const cover_query *q, uint32_t slot) {
    const visibility_scene *scene = q->scene;
    const double *v = scene->mesh->vertices + 3 * (size_t)scene->vertex_of[slot];
    return scene_has_corner(scene, q->rank, slot) ||
           orient3d(scene_corner(scene, q->rank, 0), scene_corner(scene, q->rank, 1),
                    scene_corner(scene, q->rank, 2), v) <= 0;
}

static bool is_before_plane(const cover_query *q, uint32_t i) {
    return !is_behind_plane(q, q->s->sorted.a[i]) || !is_behind_plane(q, q->s->sorted.b[i]);
}

/* May a contour on the cube face be before f? */
static bool finds_contour(const cover_query *q) {
    const contours_scratch *s = q->s;
    const uint32_t *rows = s->row_of_bin + q->cube_face * BINS;
    wide nearness = wide_set(q->nearness);
    for (uint32_t row = rows[bin_of(q->box.v_low)]; row <= rows[bin_of(q->box.v_high)]; row++) {
        uint32_t end = end_in_cells(s, row, q->box.u_high);
        for (uint32_t i = first_in_cells(s, row, q->box.u_low); i < end; i += WIDE) {
            uint32_t among = overlapping(&s->sorted, &q->box, i, end);
            wide an = wide_load(s->sorted.an + i), bn = wide_load(s->sorted.bn + i);
            among &= ~(wide_above(nearness, an) & wide_above(nearness, bn));
            if (among != 0 && q->plain)
                among &= ~apart_from_face(q, i);
            STARG_FOR_BITS (bit, among) {
                if (is_before_plane(q, i + (uint32_t)bit))
                    return true;
            }
        }
    }
    return false;
}

static bool finds_contour_before(const visibility_scene *scene, const contours_scratch *s,
                                 size_t rank) {
    const cube_directions *d = &s->directions;
    const uint32_t *corner = scene->corners + 3 * rank;
    cover_query q = {.scene = scene, .s = s, .corner = corner, .rank = rank};
    q.cube_face = d->face[corner[0]];
    if (q.cube_face < RIM && d->face[corner[1]] == q.cube_face &&
        d->face[corner[2]] == q.cube_face) {
        float least = INFINITY;
        q.plain = true;
        q.polygon.count = 3;
        for (int k = 0; k < 3; k++) {
            q.polygon.corner[k][0] = d->u[corner[k]];
            q.polygon.corner[k][1] = d->v[corner[k]];
            least = lesser(least, d->nearness[corner[k]]);
        }
        q.polygon.depth = d->extent / least;
        measure_query(&q);
        return finds_contour(&q);
    }
    if (triangle_is_near(d, corner))
        return true;
    uint32_t met = cube_faces_met(d, corner);
    STARG_FOR_BITS (cube_face, met) {
        q.cube_face = (uint32_t)cube_face;
        cube_clip_triangle(d, corner, q.cube_face, &q.polygon);
        if (q.polygon.count == 0)
            continue;
        measure_query(&q);
        if (finds_contour(&q))
            return true;
    }
    return false;
}

static bool may_cover(const visibility_scene *scene, contours_scratch *s, size_t rank) {
    const uint32_t *corner = scene->corners + 3 * rank;
    if (finds_contour_before(scene, s, rank))
        return true;
    if (!(s->grade[corner[0]] == SLOT_MIXED && s->grade[corner[1]] == SLOT_MIXED &&
          s->grade[corner[2]] == SLOT_MIXED))
        return false;
    tree_edge l = {.scene = scene, .s = s, .p = s->p, .side = s->side};
    cross(&s->directions, corner[0], corner[1], l.normal);
    return count_at_end(&l, corner[0], corner[1], l.normal) != 0 || l.special;
}
