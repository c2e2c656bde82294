/* SPDX-License-Identifier: Apache-2.0 */
/* Where the space that is reached from a point leaks.
 *
 * Problem: whoever stands in a room of a soup means that room. Through a hole that nobody saw, the
 * flood (mesh/solid.h) reaches the outside of the model, or other rooms, and guards stand there.
 * Compilers of game levels show the way to such a hole; so does this.
 *
 * Stages: a flood by breadth from the point, which notes how each cube was reached; another from
 * its first roomy cube through roomy ones, which have no taken cube about them. A leak to the
 * outside: the first cube at the boundary of the model's own box, a roomy one of the second flood
 * if there is one, which the first flood, done again, finds. A leak through a gap: the second flood
 * does not come to the outside that the first one reaches, or misses roomy cubes, more than a small
 * part of all; so what leads there is one or two cubes wide. The way leads back from there. A wider
 * opening to the outside is where the way is narrowest before, seen from its end, it gets twice as
 * wide again: the box may end far from it.
 *
 * Invariant: the way goes through centres of cubes that are reached, so it meets no face. The same
 * scene gives the same way. Cost: linear in the cubes, a byte and a bit each. */
#include "mesh/solid.h"

static const char STAGE[] = "scene";

enum { START = 7, SMALL_PART = 64 };

typedef STARG_ARRAY(size_t) cell_list;

typedef struct search {
    const flood_cells *cells;
    const bvh_box *model;
    size_t step[3];
    uint8_t *way;            /* by cube: 0 not reached, 1 + 2 axis + (upwards), or START */
    uint64_t *roomy;         /* reached by the second flood */
    size_t exit, first, far; /* cubes, or NONE: at the outside; roomy; roomy and missed */
    int side;                /* of the exit, like a way */
    bool inner;              /* exits have to be roomy ones */
} search;

static const size_t NONE = SIZE_MAX;

static size_t coordinate(const search *s, size_t cell, int k) {
    return cell / s->step[k] % s->cells->count[k];
}

/* The cube beside it, NONE beyond the grid; `way` as above. */
static size_t beside(const search *s, size_t cell, int way) {
    int k = (way - 1) / 2;
    size_t x = coordinate(s, cell, k);
    if ((way - 1) % 2 != 0)
        return x + 1 < s->cells->count[k] ? cell + s->step[k] : NONE;
    return x > 0 ? cell - s->step[k] : NONE;
}

/* Does a cube that has the property touch this one, or is it this one? */
static bool touches(const search *s, size_t cell, bool (*has)(const search *, size_t)) {
    size_t low[3], high[3];
    for (int k = 0; k < 3; k++) {
        size_t x = coordinate(s, cell, k);
        low[k] = x > 0 ? x - 1 : 0;
        high[k] = x + 1 < s->cells->count[k] ? x + 1 : x;
    }
    for (size_t z = low[2]; z <= high[2]; z++)
        for (size_t y = low[1]; y <= high[1]; y++)
            for (size_t x = low[0]; x <= high[0]; x++)
                if (has(s, x + s->step[1] * y + s->step[2] * z))
                    return true;
    return false;
}

static bool is_taken(const search *s, size_t cell) {
    return starg_bit_test(s->cells->taken, cell);
}

static bool is_roomy(const search *s, size_t cell) {
    return !touches(s, cell, is_taken);
}

/* Does the grid end where the model does? */
static bool is_outside(const search *s, int way) {
    const flood_cells *f = s->cells;
    int k = (way - 1) / 2;
    if ((way - 1) % 2 == 0)
        return f->origin[k] <= s->model->lower[k];
    return f->origin[k] + (double)f->count[k] * f->size >= s->model->upper[k];
}

/* Notes a cube when it is reached: those that matter, and that it is reached. */
static void note(search *s, size_t cell, int way) {
    s->way[cell] = (uint8_t)way;
    if (s->first == NONE && is_roomy(s, cell))
        s->first = cell;
    if (s->inner && !starg_bit_test(s->roomy, cell))
        return;
    for (int side = 1; side < START && s->exit == NONE; side++)
        if (beside(s, cell, side) == NONE && is_outside(s, side)) {
            s->exit = cell;
            s->side = side;
        }
}

static starg_status spread_by_breadth(search *s, size_t from) {
    SCOPED cell_list now = {0}, next = {0};
    note(s, from, START);
    PUSH(s->cells->context, STAGE, &now, from);
    while (now.count > 0) {
        next.count = 0;
        for (size_t i = 0; i < now.count; i++)
            for (int way = 1; way < START; way++) {
                size_t cell = beside(s, now.data[i], way);
                if (cell == NONE || s->way[cell] != 0 || !starg_bit_test(s->cells->bits, cell))
                    continue;
                note(s, cell, way);
                PUSH(s->cells->context, STAGE, &next, cell);
            }
        cell_list swap = now;
        now = next;
        next = swap;
        TRY(starg_check_cancel(s->cells->context, STAGE));
    }
    return STARG_OK;
}

static starg_status spread_roomy(search *s) {
    SCOPED cell_list stack = {0};
    starg_bit_set(s->roomy, s->first);
    PUSH(s->cells->context, STAGE, &stack, s->first);
    while (stack.count > 0) {
        size_t at = stack.data[--stack.count];
        for (int way = 1; way < START; way++) {
            size_t cell = beside(s, at, way);
            if (cell == NONE || starg_bit_test(s->roomy, cell) || s->way[cell] == 0 ||
                !is_roomy(s, cell))
                continue;
            starg_bit_set(s->roomy, cell);
            PUSH(s->cells->context, STAGE, &stack, cell);
        }
    }
    return STARG_OK;
}

/* The nearest exit that the second flood comes to; without one, the exit stays. */
static starg_status find_wide_exit(search *s, size_t start, size_t cells) {
    size_t exit = s->exit;
    if (exit == NONE)
        return STARG_OK;
    memset(s->way, 0, cells);
    s->exit = NONE;
    s->inner = true;
    starg_status status = spread_by_breadth(s, start);
    s->inner = s->exit != NONE;
    s->exit = s->inner ? s->exit : exit;
    return status;
}

/* The first roomy cube that the second flood missed, if they are no small part. */
static void find_far(search *s, size_t cells) {
    size_t missed = 0, found = NONE;
    for (size_t cell = 0; cell < cells; cell++) {
        if (s->way[cell] == 0 || starg_bit_test(s->roomy, cell) || !is_roomy(s, cell))
            continue;
        found = found == NONE ? cell : found;
        missed++;
    }
    s->far = missed > s->cells->reached / SMALL_PART ? found : NONE;
}

/* ---- the way ---- */

static void centre_of(const search *s, size_t cell, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = s->cells->origin[k] + ((double)coordinate(s, cell, k) + 0.5) * s->cells->size;
}

static starg_status push_point(const search *s, const double p[3], flood_leak *out) {
    for (int k = 0; k < 3; k++)
        PUSH(s->cells->context, STAGE, &out->way, p[k]);
    return STARG_OK;
}

/* The cubes from `end` back to the first one. */
static starg_status trace(const search *s, size_t end, cell_list *out) {
    for (size_t cell = end; cell != NONE;) {
        PUSH(s->cells->context, STAGE, out, cell);
        int way = s->way[cell];
        cell = way == START ? NONE : beside(s, cell, way % 2 != 0 ? way + 1 : way - 1);
    }
    return STARG_OK;
}

/* The middle of the cubes that touch no roomy one, between those of the second flood and others; of
 * a short gap, the last cube before those. */
static void place_gap(const search *s, const cell_list *back, double place[3]) {
    size_t inner = 0, first = NONE, last = NONE;
    while (inner + 1 < back->count && !starg_bit_test(s->roomy, back->data[inner]))
        inner++;
    for (size_t i = inner; i-- > 0 && !is_roomy(s, back->data[i]);)
        if (!touches(s, back->data[i], is_roomy)) {
            last = last != NONE ? last : i;
            first = i;
        }
    if (first == NONE)
        first = last = inner;
    centre_of(s, back->data[(first + last) / 2], place);
}

/* How many free cubes in a row this one is among, along the axis where they are fewest. */
static size_t width_at(const search *s, size_t cell) {
    size_t least = NONE;
    for (int k = 0; k < 3; k++) {
        size_t width = 1;
        for (int way = 1 + 2 * k; way <= 2 + 2 * k; way++)
            for (size_t c = beside(s, cell, way); c != NONE && !is_taken(s, c);
                 c = beside(s, c, way))
                width++;
        least = width < least ? width : least;
    }
    return least;
}

static void place_opening(const search *s, const cell_list *back, double place[3]) {
    size_t narrow = 0, least = NONE;
    for (size_t i = 0; i < back->count; i++) {
        size_t width = width_at(s, back->data[i]);
        if (width / 2 >= least)
            break;
        if (width < least) {
            least = width;
            narrow = i;
        }
    }
    centre_of(s, back->data[narrow], place);
}

/* From the point, with a point wherever the way turns, to the last cube, and out of the box. */
static starg_status draw(const search *s, const cell_list *back, const double from[3],
                         flood_leak *out) {
    double p[3] = {0};
    TRY(push_point(s, from, out));
    for (size_t i = back->count; i-- > 0;) {
        centre_of(s, back->data[i], p);
        if (i == 0 || s->way[back->data[i]] != s->way[back->data[i - 1]])
            TRY(push_point(s, p, out));
    }
    if (!out->outside)
        return STARG_OK;
    p[(s->side - 1) / 2] += s->side % 2 != 0 ? -s->cells->size : s->cells->size;
    return push_point(s, p, out);
}

starg_status flood_find_leak(const flood_cells *f, const bvh_box *model, const double from[3],
                             flood_leak *out) {
    starg_status status = STARG_OK;
    search s = {.cells = f, .model = model, .exit = NONE, .first = NONE, .far = NONE};
    size_t cells = f->count[0] * f->count[1] * f->count[2], at[3];
    cell_list back = {0};
    *out = (flood_leak){0};
    s.step[0] = 1;
    s.step[1] = f->count[0];
    s.step[2] = f->count[0] * f->count[1];
    STARG_NEW_ZERO(f->context, STAGE, s.way, cells);
    STARG_NEW_ZERO(f->context, STAGE, s.roomy, starg_bit_words(cells));
    flood_locate(f, from, at);
    const size_t start = at[0] + s.step[1] * at[1] + s.step[2] * at[2];
    STARG_TRY(spread_by_breadth(&s, start));
    out->outside = s.exit != NONE;
    if (s.first != NONE) {
        STARG_TRY(spread_roomy(&s));
        STARG_TRY(find_wide_exit(&s, start, cells));
        find_far(&s, cells);
    }
    out->gap = s.first != NONE && (out->outside ? !s.inner : s.far != NONE);
    if (out->outside || out->gap) {
        STARG_TRY(trace(&s, out->outside ? s.exit : s.far, &back));
        if (out->gap)
            place_gap(&s, &back, out->place);
        else
            place_opening(&s, &back, out->place);
        status = draw(&s, &back, from, out);
    }
done:
    if (status != STARG_OK)
        STARG_ARRAY_FREE(f->context, &out->way);
    RELEASE(back.data, s.way, s.roomy);
    return status;
}
