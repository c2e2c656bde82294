/* SPDX-License-Identifier: Apache-2.0 */
/* Stage 4 of the contour engine (visibility/contours.c): the change of the number of front-facing
 * layers along each tree edge. Included by the stages. */

/* An edge of the boundary between two vertices, and its plane through p. */
typedef struct tree_edge {
    const visibility_scene *scene;
    contours_scratch *s;
    const double *p;
    const int8_t *side;
    uint32_t from, to;
    double normal[3]; /* from x to */
    bool known;       /* is the normal computed? */
    bool special;     /* a sign that must not be 0 is */
    int32_t step;     /* front-facing layers before `to` minus those before `from` */
} tree_edge;

static const double *position(const tree_edge *l, uint32_t slot) {
    return l->scene->mesh->vertices + 3 * (size_t)l->scene->vertex_of[slot];
}

/* Sign of det(a, b, c) about p, given its rounded value. */
static inline int sign_of(const tree_edge *l, double value, uint32_t a, uint32_t b, uint32_t c) {
    if (value > l->s->directions.bound)
        return 1;
    if (value < -l->s->directions.bound)
        return -1;
    return orient3d(position(l, a), position(l, b), position(l, c), l->p);
}

/* A contour that shares an end with the tree edge must leave the plane. */
static void check_shared_end(tree_edge *l, uint32_t other, double value) {
    if (other != l->from && other != l->to && sign_of(l, value, l->from, l->to, other) == 0)
        l->special = true;
}

/* Counts the crossing of the tree edge with a contour, if there is one and the contour is in
 * front. */
static void compare(tree_edge *l, contour *c) {
    const cube_directions *d = &l->s->directions;
    uint32_t from = l->from, to = l->to;
    if (c->tested_by == to)
        return;
    c->tested_by = to;
    if (!l->known) {
        cross(d, from, to, l->normal);
        l->known = true;
    }
    double at_a = dot(d, l->normal, c->a), at_b = dot(d, l->normal, c->b);
    bool shared_a = c->a == from || c->a == to, shared_b = c->b == from || c->b == to;
    if (shared_a || shared_b) {
        check_shared_end(l, c->a, at_a);
        check_shared_end(l, c->b, at_b);
        return;
    }
    int a = sign_of(l, at_a, from, to, c->a), b = sign_of(l, at_b, from, to, c->b);
    if (a == b && a != 0)
        return;
    double at_from = dot(d, c->normal, from), at_to = dot(d, c->normal, to);
    int f = sign_of(l, at_from, c->a, c->b, from), t = sign_of(l, at_to, c->a, c->b, to);
    if (f == t && f != 0)
        return;
    if (a * b * f * t == 0) {
        l->special = true;
        return;
    }
    if (a == f)
        return; /* they meet on opposite sides of p */
    double nearer = at_to - at_from + at_b - at_a;
    int order = nearer > d->bound    ? 1
                : nearer < -d->bound ? -1
                                     : orient3d(position(l, to), position(l, c->a),
                                                position(l, c->b), position(l, from));
    if (order == b)
        l->step += t;
}

/* Is v beyond the plane of the front-facing face (w, a, b)? `sum` is det(w, v, b) - det(w, v,
 * a). */
static bool is_beyond(tree_edge *l, uint32_t w, uint32_t a, uint32_t b, uint32_t v, double sum) {
    const cube_directions *d = &l->s->directions;
    double normal[3];
    cross(d, a, b, normal);
    double excess = dot(d, normal, v) - dot(d, normal, w) + sum;
    if (fabs(excess) > d->bound)
        return excess > 0;
    int side = orient3d(position(l, w), position(l, a), position(l, b), position(l, v));
    l->special = l->special || side == 0;
    return side < 0;
}

/* The front-facing layers at `w` in front of nearby points of the edge to `v`: front-facing faces
 * (w, a, b), not on the edge, whose wedge contains the start of the edge and whose plane is in
 * front. `normal` is w x v. Handles neighbours in any number and position. */
static int32_t count_one_by_one(tree_edge *l, uint32_t w, uint32_t v, const double normal[3]) {
    const visibility_adjacency *adjacency = l->scene->adjacency;
    const cube_directions *d = &l->s->directions;
    uint32_t begin = adjacency->fan_start[w], end = adjacency->fan_start[w + 1];
    int32_t layers = 0;
    for (uint32_t i = begin; i < end; i++) {
        uint32_t a = adjacency->neighbour[i], b = adjacency->neighbour[i + 1 < end ? i + 1 : begin];
        if (l->side[adjacency->fan_face[i]] <= 0 || a == v || b == v)
            continue;
        double at_a = dot(d, normal, a), at_b = dot(d, normal, b);
        int past_a = -sign_of(l, at_a, w, v, a), past_b = sign_of(l, at_b, w, v, b);
        if (past_a < 0 || past_b < 0)
            continue;
        l->special = l->special || past_a == 0 || past_b == 0;
        layers += is_beyond(l, w, a, b, v, at_b - at_a);
    }
    return layers;
}

/* Same for up to FAN neighbours off the plane of p, w and v: branch-free until a wedge is found. */
static int32_t count_at_end(tree_edge *l, uint32_t w, uint32_t v, const double normal[3]) {
    const visibility_adjacency *adjacency = l->scene->adjacency;
    const cube_directions *d = &l->s->directions;
    const uint32_t *neighbour = adjacency->neighbour + adjacency->fan_start[w];
    const uint32_t *face = adjacency->fan_face + adjacency->fan_start[w];
    uint32_t count = adjacency->fan_start[w + 1] - adjacency->fan_start[w];
    uint32_t left = 0, right = 0, own = 0, front_facing = 0;
    if (count > FAN)
        return count_one_by_one(l, w, v, normal);
    uint32_t all = (UINT32_C(1) << count) - 1;
    for (uint32_t i = 0; i < FAN; i++) {
        double at = dot(d, normal, neighbour[i]);
        left |= (uint32_t)(at > d->bound) << i;
        right |= (uint32_t)(at < -d->bound) << i;
        own |= (uint32_t)(neighbour[i] == v) << i;
        front_facing |= (uint32_t)(l->side[face[i]] > 0) << i;
    }
    if (((left | right | own) & all) != all)
        return count_one_by_one(l, w, v, normal);
    left &= all & ~own;
    right &= all & ~own;
    uint32_t wedges = front_facing & right & (left >> 1 | left << (count - 1));
    int32_t layers = 0;
    STARG_FOR_BITS (i, wedges) {
        uint32_t a = neighbour[i], b = neighbour[i + 1 < count ? i + 1 : 0];
        layers += is_beyond(l, w, a, b, v, dot(d, normal, b) - dot(d, normal, a));
    }
    return layers;
}

/* Extent of a tree edge's piece in a row, with a margin. */
typedef struct cube_box {
    float u_low, u_high, v_low, v_high;
} cube_box;

/* Which of WIDE pieces from `i` on, before `end`, overlap the box in u and v? */
static inline uint32_t overlapping(const piece_table *t, const cube_box *box, uint32_t i,
                                   uint32_t end) {
    uint32_t among = end - i < WIDE ? (UINT32_C(1) << (end - i)) - 1 : (1 << WIDE) - 1;
    wide av = wide_load(t->av + i), bv = wide_load(t->bv + i);
    wide v_low = wide_set(box->v_low), v_high = wide_set(box->v_high);
    return among & ~(wide_above(wide_load(t->low + i), wide_set(box->u_high)) |
                     wide_above(wide_set(box->u_low), wide_load(t->high + i)) |
                     (wide_above(av, v_high) & wide_above(bv, v_high)) |
                     (wide_above(v_low, av) & wide_above(v_low, bv)));
}

/* Of two numbers with the same sign the one of smaller magnitude; otherwise a nonpositive
 * number. */
static inline wide common(wide a, wide b) {
    return wide_max(wide_min(a, b), wide_subtract(wide_set(0), wide_max(a, b)));
}

/* Relative to the sum of the differences in a determinant of u and v: more than its error. With
 * errors of 2^-24 in u and v, and differences of at most about 2, the error is below 2.5 x 2^-22 of
 * the sum; there is room for three determinants. */
static const float EPSILON = 0x1p-18f;

/* Compares a tree edge's piece with some of WIDE pieces of contours from `i` on. Returns those that
 * may cross it: not those where the ends of one lie on one side of the other, nor those that start
 * at a common vertex and diverge. Crossings of plain pieces that are certain, including their depth
 * order, are counted at once.
 *
 * Nearness is linear along a projected segment; where two of them cross, its difference is that of
 * two interpolations, times at_b - at_a = at_from - at_to. Only differences of nearness are used,
 * so errors common to the determinants cancel up to roundings: with N the sum of the nearness,
 * 2^-19 N size^2. */
static inline uint32_t compare_pieces(tree_edge *l, const cube_piece *piece, uint32_t i,
                                      uint32_t among) {
    const piece_table *t = &l->s->sorted;
    float u = piece->to[0] - piece->from[0], v = piece->to[1] - piece->from[1];
    wide du = wide_set(u), dv = wide_set(v);
    wide fu = wide_set(piece->from[0]), fv = wide_set(piece->from[1]);
    wide au = wide_subtract(wide_load(t->au + i), fu), av = wide_subtract(wide_load(t->av + i), fv);
    wide bu = wide_subtract(wide_load(t->bu + i), fu), bv = wide_subtract(wide_load(t->bv + i), fv);
    wide at_a = wide_subtract(wide_multiply(du, av), wide_multiply(dv, au));
    wide at_b = wide_subtract(wide_multiply(du, bv), wide_multiply(dv, bu));
    wide at_from = wide_subtract(wide_multiply(au, bv), wide_multiply(av, bu));
    wide at_to = wide_add(wide_subtract(at_from, at_b), at_a);
    wide size =
        wide_add(wide_add(wide_abs(au), wide_abs(av)), wide_add(wide_abs(bu), wide_abs(bv)));
    size = wide_add(size, wide_set(fabsf(u) + fabsf(v)));
    wide error = wide_multiply(wide_set(EPSILON), size);
    among &= ~wide_above(wide_max(common(at_a, at_b), common(at_from, at_to)), error);
    wide far_a = wide_abs(at_a), far_b = wide_abs(at_b);
    uint32_t a_shared = wide_equal(t->a + i, l->from) | wide_equal(t->a + i, l->to);
    uint32_t b_shared = wide_equal(t->b + i, l->from) | wide_equal(t->b + i, l->to);
    among &= ~((a_shared & (b_shared | wide_above(far_b, error))) |
               (b_shared & wide_above(far_a, error)));
    if (!piece->plain)
        return among;
    wide an = wide_load(t->an + i), bn = wide_load(t->bn + i), fn = wide_set(piece->from[2]);
    wide all = wide_add(wide_add(an, bn), wide_set(piece->from[2] + piece->to[2]));
    an = wide_subtract(an, fn);
    bn = wide_subtract(bn, fn);
    wide tn = wide_set(piece->to[2] - piece->from[2]);
    wide nearer = wide_subtract(wide_subtract(wide_multiply(an, at_b), wide_multiply(bn, at_a)),
                                wide_multiply(tn, at_from));
    wide slack = wide_add(wide_add(wide_abs(an), wide_abs(bn)), wide_abs(tn));
    slack = wide_add(slack, wide_multiply(wide_multiply(wide_set(0.5f), size), all));
    slack = wide_multiply(slack, error);
    wide least = wide_min(wide_min(far_a, far_b), wide_min(wide_abs(at_from), wide_abs(at_to)));
    uint32_t sure = among & wide_above(least, error) & wide_above(wide_abs(nearer), slack) &
                    wide_marked(t->label + i, PIECE_PLAIN);
    uint32_t before = sure & ~(wide_above(nearer, wide_set(0)) ^ wide_above(at_b, wide_set(0)));
    uint32_t left = wide_above(at_to, wide_set(0));
    int32_t gained = __builtin_popcount(before & left) - __builtin_popcount(before & ~left);
    l->step += piece->cube_face % 2 ? -gained : gained;
    return among & ~sure;
}

static void compare_all(tree_edge *l, uint32_t i, uint32_t among) {
    STARG_FOR_BITS (bit, among) {
        compare(l, &l->s->contours[l->s->sorted.label[i + bit] & PIECE_NUMBER]);
    }
}

/* The pieces that a tree edge's piece may meet in a row. */
static inline uint32_t first_in_cells(const contours_scratch *s, uint32_t row, float low) {
    const contour_row *r = &s->rows[row];
    return s->cell_start[cell_of(r, low - r->widest - CELL_MARGIN)];
}

static inline uint32_t end_in_cells(const contours_scratch *s, uint32_t row, float high) {
    return s->cell_start[cell_of(&s->rows[row], high) + 1];
}

/* A tree edge of any kind. */
static void cross_contours(tree_edge *l) {
    contours_scratch *s = l->s;
    cube_piece pieces[CUBE_FACES];
    size_t count = cut_segment(&s->directions, l->from, l->to, pieces);
    for (size_t k = 0; k < count; k++) {
        pieces[k].plain = false;
        for (row_walk w = walk_begin(s, &pieces[k]); w.row <= w.last; w.row++) {
            if (w.tall)
                walk_narrow(s, &pieces[k], &w);
            cube_box box = {w.low, w.high, -4, 4};
            uint32_t end = end_in_cells(s, w.row, w.high);
            for (uint32_t i = first_in_cells(s, w.row, w.low); i < end; i += WIDE) {
                uint32_t among = overlapping(&s->sorted, &box, i, end);
                if (among != 0)
                    compare_all(l, i, compare_pieces(l, &pieces[k], i, among));
            }
        }
    }
}

/* Plain tree edges go through the following steps in blocks, step by step, so that the processor
 * does not wait for one tree edge before starting the next. */

static tree_edge make_tree_edge(const visibility_scene *scene, contours_scratch *s,
                                const double p[3], const int8_t *side, uint32_t to) {
    return (tree_edge){
        .scene = scene, .s = s, .p = p, .side = side, .from = s->parent[to], .to = to};
}

/* Branch-free, for vectorization. */
static void measure_tree_edges(const contours_scratch *s, tree_edge_block *block) {
    const cube_directions *d = &s->directions;
    const uint32_t *rows = s->row_of_bin;
    tree_edge_boxes *out = &block->boxes;
    for (uint32_t k = 0; k < block->count; k++) {
        uint32_t to = block->to[k], from = s->parent[to], face = d->face[to] % RIM;
        float u = d->u[from], v = d->v[from];
        out->u_low[k] = lesser(u, d->u[to]) - CELL_MARGIN;
        out->u_high[k] = greater(u, d->u[to]) + CELL_MARGIN;
        float low = lesser(v, d->v[to]) - CELL_MARGIN, high = greater(v, d->v[to]) + CELL_MARGIN;
        out->v_low[k] = low;
        out->v_high[k] = high;
        out->row[k] = rows[face * BINS + bin_of(low)];
        out->last_row[k] = rows[face * BINS + bin_of(high)];
        out->plain[k] = (d->face[to] == d->face[from]) & (d->face[to] < RIM) & (from != to);
    }
}

/* The rows that a plain tree edge touches: usually one or two. */
static inline void visit_rows(tree_edge_block *block, uint32_t edge_place) {
    uint32_t row = block->boxes.row[edge_place], last = block->boxes.last_row[edge_place];
    row_visit *visits = block->visits + block->visit_count;
    visits[0] = (row_visit){.tree_edge = edge_place, .row = row, .others = UINT32_MAX};
    visits[1] = (row_visit){.tree_edge = edge_place, .row = row + 1};
    for (uint32_t k = 2; row + k <= last; k++)
        visits[k] = (row_visit){.tree_edge = edge_place, .row = row + k};
    block->visit_count += last - row + 1;
}

/* Keeps the visits with pieces. */
static void look_up_cells(const contours_scratch *s, tree_edge_block *block) {
    uint32_t count = 0;
    for (uint32_t k = 0; k < block->visit_count; k++) {
        row_visit v = block->visits[k];
        v.begin = first_in_cells(s, v.row, block->boxes.u_low[v.tree_edge]);
        v.end = end_in_cells(s, v.row, block->boxes.u_high[v.tree_edge]);
        block->visits[count] = v;
        count += v.begin < v.end;
    }
    block->visit_count = count;
}

static bool settle_encounters(const visibility_scene *scene, contours_scratch *s, const double p[3],
                              const int8_t *side, tree_edge_block *block) {
    const cube_directions *d = &s->directions;
    for (uint32_t k = 0; k < block->encounter_count; k++) {
        const encounter *e = &block->encounters[k];
        tree_edge l = make_tree_edge(scene, s, p, side, e->to);
        cube_piece piece = {.cube_face = d->face[l.to],
                            .from = {d->u[l.from], d->v[l.from], d->nearness[l.from]},
                            .to = {d->u[l.to], d->v[l.to], d->nearness[l.to]},
                            .plain = true};
        uint32_t open = compare_pieces(&l, &piece, e->piece, e->among);
        if (open != 0)
            compare_all(&l, e->piece, open);
        if (l.special)
            return false;
        s->layers[l.to] += l.step;
    }
    block->encounter_count = 0;
    return true;
}

/* Finds overlapping pieces. */
static bool meet_pieces(const visibility_scene *scene, contours_scratch *s, const double p[3],
                        const int8_t *side, tree_edge_block *block) {
    for (uint32_t k = 0; k < block->visit_count; k++) {
        const row_visit *v = &block->visits[k];
        const tree_edge_boxes *boxes = &block->boxes;
        cube_box box = {boxes->u_low[v->tree_edge], boxes->u_high[v->tree_edge],
                        boxes->v_low[v->tree_edge], boxes->v_high[v->tree_edge]};
        for (uint32_t i = v->begin; i < v->end; i += WIDE) {
            uint32_t among = overlapping(&s->sorted, &box, i, v->end);
            among &= v->others | wide_marked(s->sorted.label + i, PIECE_COUNTS);
            block->encounters[block->encounter_count] =
                (encounter){block->to[v->tree_edge], i, among};
            block->encounter_count += among != 0;
            if (block->encounter_count == LINK_BLOCK &&
                !settle_encounters(scene, s, p, side, block))
                return false;
        }
    }
    return settle_encounters(scene, s, p, side, block);
}

static bool settle_ends(const visibility_scene *scene, contours_scratch *s, const double p[3],
                        const int8_t *side, tree_edge_block *block) {
    for (uint32_t k = 0; k < block->end_count; k++) {
        uint32_t w = block->ends[k][0], v = block->ends[k][1];
        bool back = s->parent[w] == v;
        tree_edge l = make_tree_edge(scene, s, p, side, back ? w : v);
        cross(&s->directions, w, v, l.normal);
        int32_t layers = count_at_end(&l, w, v, l.normal);
        if (l.special)
            return false;
        s->layers[l.to] += back ? -layers : layers;
    }
    return true;
}

/* A tree edge that is not plain. */
static bool follow_other(const visibility_scene *scene, const double p[3], const int8_t *side,
                         contours_scratch *s, uint32_t to) {
    tree_edge l = make_tree_edge(scene, s, p, side, to);
    if (l.from != to)
        cross_contours(&l);
    s->layers[to] = l.step;
    return !l.special;
}

static void list_ends(const contours_scratch *s, uint32_t from, uint32_t to,
                      tree_edge_block *block) {
    block->ends[block->end_count][0] = from;
    block->ends[block->end_count][1] = to;
    block->end_count += (s->grade[from] == SLOT_MIXED) & (from != to);
    block->ends[block->end_count][0] = to;
    block->ends[block->end_count][1] = from;
    block->end_count += (s->grade[to] == SLOT_MIXED) & (from != to);
}

static bool follow_block(const visibility_scene *scene, const double p[3], const int8_t *side,
                         contours_scratch *s, const uint32_t *to, size_t count) {
    tree_edge_block *block = &s->block;
    block->to = to;
    block->count = (uint32_t)count;
    block->visit_count = block->encounter_count = block->end_count = 0;
    measure_tree_edges(s, block);
    for (uint32_t k = 0; k < block->count; k++) {
        if (block->boxes.plain[k] && block->boxes.last_row[k] - block->boxes.row[k] < CONTOUR_TALL)
            visit_rows(block, k);
        else if (!follow_other(scene, p, side, s, to[k]))
            return false;
        list_ends(s, s->parent[to[k]], to[k], block);
    }
    look_up_cells(s, block);
    return meet_pieces(scene, s, p, side, block) && settle_ends(scene, s, p, side, block);
}

/* Stage 4: the change of the number of layers along each tree edge. */
static bool follow_tree_edges(const visibility_scene *scene, const double p[3], const int8_t *side,
                              contours_scratch *s) {
    memset(s->layers, 0, scene->vertex_count * sizeof *s->layers);
    for (size_t begin = 0; begin < s->tree_edge_count; begin += LINK_BLOCK) {
        size_t left = s->tree_edge_count - begin;
        if (!follow_block(scene, p, side, s, s->tree_edges + begin,
                          left < LINK_BLOCK ? left : LINK_BLOCK))
            return false;
    }
    return true;
}
