/* SPDX-License-Identifier: Apache-2.0 */
/* Stage 3 of the contour engine (visibility/contours.c): the extents of contours on the faces of
 * the cube, in rows of cells. Included by the stages. */

/* The extent of a boundary segment on one cube face. */
typedef struct cube_piece {
    uint32_t cube_face;
    float from[3], to[3]; /* u, v, nearness; NaN if unknown */
    bool plain;           /* all of the segment */
} cube_piece;

/* The part of a segment not near p in the frustum of a cube face; false if there is none. */
static bool clip_piece(const cube_directions *d, uint32_t a, uint32_t b, uint32_t cube_face,
                       cube_piece *out) {
    double from[3], to[3], begin = 0, end = 1, corner[2][3];
    cube_turn(d, a, cube_face, from);
    cube_turn(d, b, cube_face, to);
    for (int plane = 0; plane < 4; plane++) {
        double at_from = beyond_side(from, plane), at_to = beyond_side(to, plane);
        if (at_from < 0 && at_to < 0)
            return false;
        double t = at_from / (at_from - at_to);
        if (at_from < 0 && t > begin)
            begin = t;
        if (at_to < 0 && t < end)
            end = t;
    }
    if (begin > end)
        return false;
    for (int j = 0; j < 3; j++) {
        corner[0][j] = from[j] + begin * (to[j] - from[j]);
        corner[1][j] = from[j] + end * (to[j] - from[j]);
    }
    *out = (cube_piece){.cube_face = cube_face, .from = {0, 0, NAN}, .to = {0, 0, NAN}};
    for (int j = 0; j < 2; j++) {
        out->from[j] = (float)(corner[0][1 + j] / corner[0][0]);
        out->to[j] = (float)(corner[1][1 + j] / corner[1][0]);
    }
    return true;
}

/* The segment between two vertices, mostly on one cube face; one near p may be anywhere. */
static inline size_t cut_segment(const cube_directions *d, uint32_t a, uint32_t b,
                                 cube_piece out[CUBE_FACES]) {
    if (d->face[a] == d->face[b] && d->face[a] < RIM) {
        out[0] = (cube_piece){.cube_face = d->face[a],
                              .from = {d->u[a], d->v[a], d->nearness[a]},
                              .to = {d->u[b], d->v[b], d->nearness[b]},
                              .plain = true};
        return 1;
    }
    bool near = segment_is_near(d, a, b);
    size_t count = 0;
    for (uint32_t cube_face = 0; cube_face < CUBE_FACES; cube_face++) {
        out[count] = (cube_piece){cube_face, {NAN, NAN, NAN}, {NAN, NAN, NAN}, false};
        count += near || clip_piece(d, a, b, cube_face, &out[count]);
    }
    return count;
}

/* Divides each cube face into rows of about equally many contours. */
static void cut_rows(contours_scratch *s) {
    const cube_directions *d = &s->directions;
    memset(s->row_of_bin, 0, sizeof s->row_of_bin);
    for (size_t i = 0; i < s->contour_count; i++) {
        uint32_t slot = s->contours[i].a;
        s->row_of_bin[d->face[slot] % RIM * BINS + bin_of(d->v[slot])]++;
    }
    s->row_count = 0;
    for (int face = 0; face < CUBE_FACES; face++) {
        uint32_t *bins = s->row_of_bin + face * BINS, sum = 0;
        float low = -2;
        for (int bin = 0; bin < BINS; bin++) {
            sum += bins[bin];
            bins[bin] = (uint32_t)s->row_count;
            if (sum < ROW_LOAD && bin + 1 < BINS)
                continue;
            float high = bin + 1 < BINS ? (float)(bin + 1) * (2.0f / BINS) - 1 : 2;
            s->rows[s->row_count++] =
                (contour_row){.v_low = low, .v_high = high, .u_low = 4, .u_high = -4};
            low = high;
            sum = 0;
        }
    }
}

/* The rows that a piece touches, and its extent there. */
typedef struct row_walk {
    uint32_t row, last;
    float low, high; /* of u in the current row */
    bool tall;
} row_walk;

static inline row_walk walk_begin(const contours_scratch *s, const cube_piece *piece) {
    const uint32_t *rows = s->row_of_bin + piece->cube_face * BINS;
    if (isnan(piece->from[0]))
        return (row_walk){rows[0], rows[BINS - 1], -2, 2, false};
    float low[2], high[2];
    for (int j = 0; j < 2; j++) {
        low[j] = lesser(piece->from[j], piece->to[j]) - CELL_MARGIN;
        high[j] = greater(piece->from[j], piece->to[j]) + CELL_MARGIN;
    }
    row_walk w = {rows[bin_of(low[1])], rows[bin_of(high[1])], low[0], high[0], false};
    w.tall = w.last - w.row >= CONTOUR_TALL;
    return w;
}

/* Narrows a tall piece to the current row. */
static inline void walk_narrow(const contours_scratch *s, const cube_piece *piece, row_walk *w) {
    float low = s->rows[w->row].v_low - CELL_MARGIN, high = s->rows[w->row].v_high + CELL_MARGIN;
    float span[2] = {2, -2};
    span_edge(piece->from, piece->to, low, high, span);
    if (piece->to[1] >= low && piece->to[1] <= high)
        widen(piece->to[0], span);
    w->low = span[0] - CELL_MARGIN;
    w->high = span[1] + CELL_MARGIN;
}

static bool add_piece(contours_scratch *s, uint32_t number, const cube_piece *piece) {
    row_walk w = walk_begin(s, piece);
    bool plain = piece->plain && !w.tall;
    for (uint32_t first = w.row; w.row <= w.last; w.row++) {
        if (w.tall)
            walk_narrow(s, piece, &w);
        if (s->piece_count == s->piece_limit)
            return false;
        uint32_t marks = (plain ? PIECE_PLAIN : 0) | (!plain || w.row == first ? PIECE_COUNTS : 0);
        contour_piece *out = &s->pieces[s->piece_count++];
        *out = (contour_piece){.row = w.row, .label = number | marks, .low = w.low, .high = w.high};
        memcpy(out->from, piece->from, sizeof out->from);
        memcpy(out->to, piece->to, sizeof out->to);
        contour_row *row = &s->rows[w.row];
        row->u_low = w.low < row->u_low ? w.low : row->u_low;
        row->u_high = w.low > row->u_high ? w.low : row->u_high;
        row->widest = w.high - w.low > row->widest ? w.high - w.low : row->widest;
        row->pieces++;
    }
    return true;
}

static bool make_pieces(contours_scratch *s) {
    cube_piece pieces[CUBE_FACES];
    s->piece_count = 0;
    for (size_t i = 0; i < s->contour_count; i++) {
        size_t count = cut_segment(&s->directions, s->contours[i].a, s->contours[i].b, pieces);
        for (size_t k = 0; k < count; k++)
            if (!add_piece(s, (uint32_t)i, &pieces[k]))
                return false;
    }
    return true;
}

/* Returns the number of cells. */
static uint32_t cut_cells(contours_scratch *s) {
    uint32_t cells = 0;
    for (size_t r = 0; r < s->row_count; r++) {
        contour_row *row = &s->rows[r];
        uint32_t count = row->pieces + 1;
        float width = row->u_high - row->u_low;
        row->first_cell = cells;
        row->last_cell = (float)(count - 1);
        row->scale = width > 0 ? (float)count / width : 0;
        cells += count;
    }
    return cells;
}

static inline uint32_t cell_of(const contour_row *row, float u) {
    return row->first_cell + part_of(u - row->u_low, row->scale, row->last_cell);
}

static void place_piece(contours_scratch *s, const contour_piece *piece) {
    uint32_t at = --s->cell_start[cell_of(&s->rows[piece->row], piece->low)];
    piece_table *t = &s->sorted;
    t->low[at] = piece->low;
    t->high[at] = piece->high;
    t->au[at] = piece->from[0];
    t->av[at] = piece->from[1];
    t->an[at] = piece->from[2];
    t->bu[at] = piece->to[0];
    t->bv[at] = piece->to[1];
    t->bn[at] = piece->to[2];
    t->a[at] = s->contours[piece->label & PIECE_NUMBER].a;
    t->b[at] = s->contours[piece->label & PIECE_NUMBER].b;
    t->label[at] = piece->label;
}

/* Stage 3: counting sort of contours into cells; cell_start[c] is first the end of cell c, and its
 * start once all are placed. */
static bool sort_contours(contours_scratch *s) {
    cut_rows(s);
    if (!make_pieces(s))
        return false;
    uint32_t cells = cut_cells(s), sum = 0;
    memset(s->cell_start, 0, (cells + 1) * sizeof *s->cell_start);
    for (size_t i = 0; i < s->piece_count; i++)
        s->cell_start[cell_of(&s->rows[s->pieces[i].row], s->pieces[i].low)]++;
    for (uint32_t c = 0; c <= cells; c++)
        sum = s->cell_start[c] += sum;
    for (size_t i = s->piece_count; i-- > 0;)
        place_piece(s, &s->pieces[i]);
    return true;
}
