/* SPDX-License-Identifier: Apache-2.0 */
/* Stage 3 of the direction grid (visibility/grid.c): what each front-facing face hides. Included by
 * the stages. Faces go through the steps in blocks, step by step, so that the compiler can
 * vectorize and the processor does not wait for one face before starting the next. */

/* Positions tested at once: what can be extracted from the bits of `hidden` in one read. */
enum { BLOCK = 64, RUN = 56 };

/* Faces of this many rows or more are followed row by row. */
enum { TALL = 6 };

/* A run of vertices that a face may hide. */
typedef struct face_visit {
    uint32_t face, begin, end; /* position in the block; vertex positions */
} face_visit;

/* Faces by position in the block. */
typedef struct face_block {
    uint32_t count;
    uint32_t rank[BLOCK], corner[3][BLOCK], position[3][BLOCK];
    int32_t side[BLOCK];
    float u_low[BLOCK], u_high[BLOCK]; /* with a margin */
    uint32_t row[BLOCK], last_row[BLOCK];
    uint32_t
        plain[BLOCK]; /* off the plane of p and on one cube face; otherwise rows are undefined */
    double plane[9][BLOCK]; /* three planes through p and an edge, positive inside the cone */
    double volume[BLOCK];   /* D */
    uint32_t visit_count;
    face_visit visits[TALL * BLOCK + 1];
} face_block;

/* Does a single face certainly hide all three corners, hence the whole face? */
static inline bool is_behind_one(const grid_scratch *g, const uint32_t corner[3]) {
    uint32_t hider = g->hider[corner[0]];
    return (hider != SCENE_NONE) & (hider == g->hider[corner[1]]) & (hider == g->hider[corner[2]]);
}

/* Takes the next faces not hidden by a single one. Returns the number of faces consumed. */
static size_t fill_block(const visibility_scene *scene, const int8_t *side, const grid_scratch *g,
                         size_t first, face_block *block) {
    uint32_t count = 0;
    size_t i = first;
    for (; i < g->front_facing_count && count < BLOCK; i++) {
        uint32_t rank = g->front_facing[i];
        const uint32_t *corner = scene->corners + 3 * (size_t)rank;
        block->rank[count] = rank;
        block->side[count] = side[rank];
        for (int k = 0; k < 3; k++)
            block->corner[k][count] = corner[k];
        count += !is_behind_one(g, corner);
    }
    block->count = count;
    return i - first;
}

static inline float min3(float a, float b, float c) {
    return lesser(lesser(a, b), c);
}

static inline float max3(float a, float b, float c) {
    return greater(greater(a, b), c);
}

/* Extents of the faces on the cube; branch-free. */
static void measure_faces(const grid_scratch *g, face_block *block) {
    const cube_directions *d = &g->at;
    const uint32_t *rows = g->row_of_bin[0];
    for (uint32_t k = 0; k < block->count; k++) {
        uint32_t a = block->corner[0][k], b = block->corner[1][k], c = block->corner[2][k];
        uint32_t face = d->face[a];
        float low = min3(d->v[a], d->v[b], d->v[c]), high = max3(d->v[a], d->v[b], d->v[c]);
        block->u_low[k] = min3(d->u[a], d->u[b], d->u[c]) - CELL_MARGIN;
        block->u_high[k] = max3(d->u[a], d->u[b], d->u[c]) + CELL_MARGIN;
        block->row[k] = rows[face % RIM * BINS + bin_of(low - CELL_MARGIN)];
        block->last_row[k] = rows[face % RIM * BINS + bin_of(high + CELL_MARGIN)];
        block->plain[k] =
            (face < RIM) & (face == d->face[b]) & (face == d->face[c]) & (block->side[k] != 0);
        block->position[0][k] = g->place[a];
        block->position[1][k] = g->place[b];
        block->position[2][k] = g->place[c];
    }
}

/* The planes through p and the edges, and D: all made positive by the sign of the side. */
static void prepare_faces(const grid_scratch *g, face_block *block) {
    const double *x = g->at.x, *y = g->at.y, *z = g->at.z;
    for (uint32_t k = 0; k < block->count; k++) {
        uint32_t a = block->corner[0][k], b = block->corner[1][k], c = block->corner[2][k];
        double sign = block->side[k] > 0 ? 1 : -1;
        double ax = x[a], ay = y[a], az = z[a], bx = x[b], by = y[b], bz = z[b];
        double cx = x[c], cy = y[c], cz = z[c];
        double nx = sign * (by * cz - bz * cy), ny = sign * (bz * cx - bx * cz);
        double nz = sign * (bx * cy - by * cx);
        block->plane[0][k] = nx;
        block->plane[1][k] = ny;
        block->plane[2][k] = nz;
        block->plane[3][k] = sign * (cy * az - cz * ay);
        block->plane[4][k] = sign * (cz * ax - cx * az);
        block->plane[5][k] = sign * (cx * ay - cy * ax);
        block->plane[6][k] = sign * (ay * bz - az * by);
        block->plane[7][k] = sign * (az * bx - ax * bz);
        block->plane[8][k] = sign * (ax * by - ay * bx);
        block->volume[k] = nx * ax + ny * ay + nz * az;
    }
}

/* `count` <= RUN bits of the hidden ones from position `begin` on. */
static inline uint64_t hidden_bits(const grid_scratch *g, size_t begin) {
    uint64_t word;
    memcpy(&word, (const uint8_t *)g->hidden + begin / 8, sizeof word);
    return word >> (begin % 8);
}

static inline void hide_bits(grid_scratch *g, size_t begin, uint64_t bits) {
    uint64_t word;
    uint8_t *at = (uint8_t *)g->hidden + begin / 8;
    memcpy(&word, at, sizeof word);
    word |= bits << (begin % 8);
    memcpy(at, &word, sizeof word);
}

/* Those of `count` vertices from `begin` on that are not hidden yet and that the face may hide: not
 * its own corners, unless p lies in its plane. */
static inline uint64_t open_bits(const grid_scratch *g, const face_block *block, uint32_t k,
                                 size_t begin, size_t count) {
    uint64_t own = 0;
    for (int i = 0; i < 3; i++) {
        size_t at = block->position[i][k] - begin;
        own |= (uint64_t)(at < RUN) << (at % 64);
    }
    own = block->side[k] != 0 ? own : 0;
    return ~hidden_bits(g, begin) & ~own & ((UINT64_C(1) << count) - 1);
}

/* A face in the form of the inner loop. */
typedef struct blocker {
    double w0[3], w1[3], w2[3], volume;
} blocker;

static inline blocker get_blocker(const face_block *block, uint32_t k) {
    blocker f;
    for (int i = 0; i < 3; i++) {
        f.w0[i] = block->plane[i][k];
        f.w1[i] = block->plane[3 + i][k];
        f.w2[i] = block->plane[6 + i][k];
    }
    f.volume = block->volume[k];
    return f;
}

/* Which of LANES vertices from `i` on are certainly hidden, and which may be? */
static inline void test_lanes(const grid_scratch *g, const blocker *f, size_t i, uint64_t *sure,
                              uint64_t *maybe) {
    lanes x = lanes_load(g->sx + i), y = lanes_load(g->sy + i), z = lanes_load(g->sz + i);
    lanes w0 = lanes_dot(f->w0, x, y, z), w1 = lanes_dot(f->w1, x, y, z);
    lanes w2 = lanes_dot(f->w2, x, y, z);
    lanes beyond = lanes_beyond(w0, w1, w2, f->volume);
    lanes least = lanes_min(lanes_min(w0, w1), lanes_min(w2, beyond));
    *sure = lanes_above(least, g->at.bound);
    *maybe = lanes_above(least, -g->at.bound);
}

/* Same for a face coplanar with p: off that plane it hides nothing. */
static inline uint64_t test_coplanar_lanes(const grid_scratch *g, const blocker *f, size_t i) {
    lanes x = lanes_load(g->sx + i), y = lanes_load(g->sy + i), z = lanes_load(g->sz + i);
    double e = g->at.bound;
    return ~(lanes_beyond_either(lanes_dot(f->w0, x, y, z), e) |
             lanes_beyond_either(lanes_dot(f->w1, x, y, z), e) |
             lanes_beyond_either(lanes_dot(f->w2, x, y, z), e)) &
           ((UINT64_C(1) << LANES) - 1);
}

static void decide_exactly(const visibility_scene *scene, const double p[3], grid_scratch *g,
                           const face_block *block, uint32_t k, size_t begin, uint64_t maybe) {
    STARG_FOR_BITS (bit, maybe) {
        if (scene_blocks(scene, block->rank[k], block->side[k], p, g->slot[begin + bit]))
            starg_bit_set(g->hidden, begin + bit);
    }
}

static inline void test_run(const visibility_scene *scene, const double p[3], grid_scratch *g,
                            const face_block *block, uint32_t k, size_t begin, size_t count) {
    uint64_t live = open_bits(g, block, k, begin, count), sure = 0, maybe = 0;
    if (live == 0)
        return;
    blocker f = get_blocker(block, k);
    for (size_t i = 0; i < count; i += LANES) {
        uint64_t s = 0, m;
        if (block->side[k] != 0)
            test_lanes(g, &f, begin + i, &s, &m);
        else
            m = test_coplanar_lanes(g, &f, begin + i);
        sure |= s << i;
        maybe |= m << i;
    }
    sure &= live;
    maybe &= live & ~sure;
    hide_bits(g, begin, sure);
    STARG_FOR_BITS (bit, sure) {
        g->hider[g->slot[begin + bit]] = block->rank[k];
    }
    if (maybe != 0)
        decide_exactly(scene, p, g, block, k, begin, maybe);
}

static inline void test_visit(const visibility_scene *scene, const double p[3], grid_scratch *g,
                              const face_block *block, const face_visit *v) {
    for (size_t begin = v->begin; begin < v->end; begin += RUN)
        test_run(scene, p, g, block, v->face, begin, v->end - begin < RUN ? v->end - begin : RUN);
}

/* The vertices between two values of u in a row. */
static inline face_visit find_cells(const grid_scratch *g, uint32_t face, uint32_t row, float u_low,
                                    float u_high) {
    const grid_row *r = &g->rows[row];
    return (face_visit){face, g->cell_start[cell_of(r, u_low)],
                        g->cell_start[cell_of(r, u_high) + 1]};
}

/* In each row, only the cells between the polygon's edges. */
static void test_polygon(const visibility_scene *scene, const double p[3], grid_scratch *g,
                         const face_block *block, uint32_t k, const cube_polygon *polygon,
                         uint32_t row, uint32_t last_row) {
    for (; row <= last_row; row++) {
        const grid_row *r = &g->rows[row];
        float span[2] = {2, -2};
        for (int i = 0; i < polygon->count; i++)
            span_edge(polygon->corner[i], polygon->corner[(i + 1) % polygon->count],
                      r->v_low - CELL_MARGIN, r->v_high + CELL_MARGIN, span);
        if (span[0] > span[1])
            continue;
        face_visit v = find_cells(g, k, row, span[0] - CELL_MARGIN, span[1] + CELL_MARGIN);
        test_visit(scene, p, g, block, &v);
    }
}

/* A tall face that projects into one cube face. */
static void test_tall(const visibility_scene *scene, const double p[3], grid_scratch *g,
                      const face_block *block, uint32_t k) {
    cube_polygon polygon = {.count = 3};
    for (int i = 0; i < 3; i++) {
        polygon.corner[i][0] = g->at.u[block->corner[i][k]];
        polygon.corner[i][1] = g->at.v[block->corner[i][k]];
    }
    test_polygon(scene, p, g, block, k, &polygon, block->row[k], block->last_row[k]);
}

static void test_all_rows(const visibility_scene *scene, const double p[3], grid_scratch *g,
                          const face_block *block, uint32_t k) {
    face_visit all = {k, 0, (uint32_t)g->used_count};
    test_visit(scene, p, g, block, &all);
}

/* A face that does not project into one cube face. */
static void test_clipped(const visibility_scene *scene, const double p[3], grid_scratch *g,
                         const face_block *block, uint32_t k) {
    const uint32_t *corner = scene->corners + 3 * (size_t)block->rank[k];
    if (triangle_is_near(&g->at, corner)) {
        test_all_rows(scene, p, g, block, k);
        return;
    }
    uint32_t met = cube_faces_met(&g->at, corner);
    STARG_FOR_BITS (cube_face, met) {
        const uint32_t *rows = g->row_of_bin[cube_face];
        cube_polygon polygon;
        cube_clip_triangle(&g->at, corner, (uint32_t)cube_face, &polygon);
        if (polygon.count == 0)
            continue;
        float low = 2, high = -2;
        for (int i = 0; i < polygon.count; i++) {
            low = lesser(polygon.corner[i][1], low);
            high = greater(polygon.corner[i][1], high);
        }
        test_polygon(scene, p, g, block, k, &polygon, rows[bin_of(low - CELL_MARGIN)],
                     rows[bin_of(high + CELL_MARGIN)]);
    }
}

/* The rows that a plain face touches: usually one or two. */
static inline void visit_rows(face_block *block, uint32_t k) {
    uint32_t row = block->row[k], last = block->last_row[k];
    face_visit *visits = block->visits + block->visit_count;
    visits[0] = (face_visit){.face = k, .begin = row};
    visits[1] = (face_visit){.face = k, .begin = row + 1};
    for (uint32_t i = 2; row + i <= last; i++)
        visits[i] = (face_visit){.face = k, .begin = row + i};
    block->visit_count += last - row + 1;
}

/* From rows to vertices; keeps the visits that may find one to hide. */
static void look_up_cells(const grid_scratch *g, face_block *block) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < block->visit_count; i++) {
        uint32_t k = block->visits[i].face;
        face_visit v = find_cells(g, k, block->visits[i].begin, block->u_low[k], block->u_high[k]);
        uint32_t length = v.end - v.begin;
        block->visits[count] = v;
        count +=
            (length > RUN) | (open_bits(g, block, k, v.begin, length < RUN ? length : RUN) != 0);
    }
    block->visit_count = count;
}

static void test_block(const visibility_scene *scene, const double p[3], grid_scratch *g,
                       face_block *block) {
    measure_faces(g, block);
    prepare_faces(g, block);
    block->visit_count = 0;
    for (uint32_t k = 0; k < block->count; k++)
        if (!block->plain[k])
            test_clipped(scene, p, g, block, k);
        else if (block->last_row[k] - block->row[k] < TALL)
            visit_rows(block, k);
        else
            test_tall(scene, p, g, block, k);
    look_up_cells(g, block);
    for (uint32_t i = 0; i < block->visit_count; i++)
        test_visit(scene, p, g, block, &block->visits[i]);
}

static void test_faces(const visibility_scene *scene, const double p[3], const int8_t *side,
                       grid_scratch *g) {
    face_block block;
    for (size_t i = 0; i < g->used_count; i++)
        g->hider[g->used[i]] = SCENE_NONE;
    for (size_t done = 0; done < g->front_facing_count;) {
        done += fill_block(scene, side, g, done, &block);
        test_block(scene, p, g, &block);
    }
}
