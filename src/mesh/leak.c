/* SPDX-License-Identifier: Apache-2.0 */
/* Leaks of the space that is reached from a point.
 *
 * Problem: who floods a soup of triangles from within a room expects to stay there. Where a wall
 * has a gap that cubes pass, the flood gets out, and guards with it; where a gap is about as wide
 * as a cube, what is behind it is reached or not by chance. Both are shown by a path, as compilers
 * of game levels do.
 *
 * Stages: the clearance of each cube, in cubes, from those that faces meet (two passes over the
 * grid); whether a cube that is reached touches the model's bounding box, from within or without:
 * it has left; else, whether more than a hundredth of the roomy cubes (clearance 2 or more) are
 * reached through cubes of clearance 1 only. A shortest path there, among those with the largest
 * least clearance, as far as the start has that.
 *
 * Invariant: a path goes through reached cubes only. Cost: linear in the cubes, two bytes each,
 * times the logarithm of the clearance of the start. */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/vec3.h"
#include "mesh/flood.h"

static const char STAGE[] = "scene";

static const double SMALL_SHARE = 0.01; /* of roomy cubes behind narrow gaps: no word about it */

enum { ROOMY = 2, MOST_CLEAR = 255, START = 7 };

typedef struct leak_search {
    const flood_cells *flood;
    size_t cells, start, step[3];
    bvh_box model;
    uint8_t *clear; /* by cube: its distance in cubes from the next one that a face meets */
    uint8_t *came;  /* by cube: 1 + 2 axis + (1: from above), START; 0: not visited */
    bool *roomy;    /* by cube: reached through roomy cubes; NULL: the goal is to get out */
    STARG_ARRAY(size_t) queue;
} leak_search;

static void cell_place(const leak_search *s, size_t cell, size_t at[3]) {
    for (int k = 0; k < 3; k++)
        at[k] = cell / s->step[k] % s->flood->count[k];
}

static void cell_centre(const leak_search *s, size_t cell, double centre[3]) {
    size_t at[3];
    cell_place(s, cell, at);
    for (int k = 0; k < 3; k++)
        centre[k] = s->flood->origin[k] + ((double)at[k] + 0.5) * s->flood->size;
}

/* ---- clearance ---- */

/* One pass: `turn` -1 looks at the thirteen neighbours before each cube, 1 at those behind. */
static void spread_clearance(leak_search *s, int turn) {
    const size_t *count = s->flood->count;
    for (size_t i = 0; i < s->cells; i++) {
        size_t cell = turn < 0 ? i : s->cells - 1 - i, at[3];
        int least = s->clear[cell];
        cell_place(s, cell, at);
        for (int n = 0; n < 13 && least > 0; n++) {
            const int d[3] = {turn * (1 - n % 3), turn * (1 - n / 3 % 3), turn * (1 - n / 9)};
            bool inside = true;
            size_t other = 0;
            for (int k = 0; k < 3; k++) {
                /* the numbers -n run over (1, 1, 1) to (1, 0, 0), all on one side of (0, 0, 0) */
                inside = inside && (d[k] < 0 ? at[k] > 0 : d[k] == 0 || at[k] + 1 < count[k]);
                other += (at[k] + (size_t)d[k]) * s->step[k];
            }
            if (inside && s->clear[other] + 1 < least)
                least = s->clear[other] + 1;
        }
        s->clear[cell] = (uint8_t)least;
    }
}

static void find_clearance(leak_search *s) {
    for (size_t i = 0; i < s->cells; i++)
        s->clear[i] = starg_bit_test(s->flood->taken, i) ? 0 : MOST_CLEAR;
    spread_clearance(s, -1);
    spread_clearance(s, 1);
}

/* ---- paths ---- */

/* Does the cube touch the box, from within, or lie beyond? */
static bool is_out(const leak_search *s, size_t cell) {
    size_t at[3];
    bool out = false;
    cell_place(s, cell, at);
    for (int k = 0; k < 3; k++) {
        double low = s->flood->origin[k] + (double)at[k] * s->flood->size;
        out = out || low <= s->model.lower[k] || low + s->flood->size >= s->model.upper[k];
    }
    return out;
}

static bool is_goal(const leak_search *s, size_t cell) {
    return s->roomy == NULL ? is_out(s, cell) : s->clear[cell] >= ROOMY && !s->roomy[cell];
}

static starg_status visit(leak_search *s, size_t cell, int came, int least) {
    starg_status status = STARG_OK;
    if (s->came[cell] != 0 || s->clear[cell] < least || !starg_bit_test(s->flood->bits, cell))
        return STARG_OK;
    s->came[cell] = (uint8_t)came;
    STARG_PUSH(s->flood->context, STAGE, &s->queue, cell);
done:
    return status;
}

/* Breadth first from a cube through those with a clearance of at least `least`, up to the first
 * goal; SIZE_MAX: there is none. */
static starg_status walk(leak_search *s, size_t from, int least, bool stops, size_t *goal) {
    starg_status status = STARG_OK;
    *goal = SIZE_MAX;
    s->queue.count = 0;
    memset(s->came, 0, s->cells);
    STARG_TRY(visit(s, from, START, 0));
    for (size_t head = 0; head < s->queue.count; head++) {
        size_t cell = s->queue.data[head], at[3];
        if (stops && is_goal(s, cell)) {
            *goal = cell;
            break;
        }
        cell_place(s, cell, at);
        for (int k = 0; k < 3; k++) {
            if (at[k] > 0)
                STARG_TRY(visit(s, cell - s->step[k], 2 + 2 * k, least));
            if (at[k] + 1 < s->flood->count[k])
                STARG_TRY(visit(s, cell + s->step[k], 1 + 2 * k, least));
        }
    }
    status = starg_check_cancel(s->flood->context, STAGE);
done:
    return status;
}

static size_t cell_before(const leak_search *s, size_t cell) {
    int way = s->came[cell] - 1;
    return way % 2 == 1 ? cell + s->step[way / 2] : cell - s->step[way / 2];
}

/* How many cubes in a row along an axis are free, about one that is. */
static size_t width_along(const leak_search *s, size_t cell, int k) {
    size_t at[3], low, high;
    cell_place(s, cell, at);
    for (low = 0; low < at[k] && s->clear[cell - (low + 1) * s->step[k]] > 0;)
        low++;
    for (high = 0;
         at[k] + high + 1 < s->flood->count[k] && s->clear[cell + (high + 1) * s->step[k]] > 0;)
        high++;
    return low + 1 + high;
}

/* The least such width: that of a gap is small, beside a single wall it is large. */
static size_t width_at(const leak_search *s, size_t cell) {
    size_t least = SIZE_MAX;
    for (int k = 0; k < 3; k++) {
        size_t width = width_along(s, cell, k);
        least = width < least ? width : least;
    }
    return least;
}

/* The path of the last walk, corners only, and its narrowest cube, the first of these. */
static starg_status keep_path(leak_search *s, size_t goal, const double from[3], flood_leak *leak) {
    starg_status status = STARG_OK;
    size_t count = 1, narrow = goal, narrowest = SIZE_MAX;
    for (size_t c = goal; s->came[c] != START; c = cell_before(s, c))
        count++;
    STARG_NEW(s->flood->context, STAGE, leak->points, 3 * (count + 1));
    memcpy(leak->points, from, 3 * sizeof *from);
    leak->count = 1;
    s->queue.count = 0;
    for (size_t c = goal, i = 0; i < count; i++) {
        STARG_PUSH(s->flood->context, STAGE, &s->queue, c);
        size_t width = width_at(s, c);
        if (width <= narrowest) {
            narrow = c;
            narrowest = width;
        }
        c = i + 1 < count ? cell_before(s, c) : c;
    }
    for (size_t i = count; i-- > 0;) {
        size_t c = s->queue.data[i];
        if (i == 0 || i + 1 == count || s->came[c] != s->came[s->queue.data[i - 1]])
            cell_centre(s, c, leak->points + 3 * leak->count++);
    }
    cell_centre(s, narrow, leak->place);
    cell_centre(s, goal, leak->end);
    if (2 * narrowest < width_at(s, s->start)) /* else the space is open */
        leak->width = (double)narrowest * s->flood->size;
done:
    return status;
}

/* A path to the goal that stays as clear of faces as it can, at most as the start is. */
static starg_status find_path(leak_search *s, const double from[3], flood_leak *leak) {
    starg_status status = STARG_OK;
    size_t goal;
    int low = 1, high = s->clear[s->start];
    while (low < high) {
        int middle = (low + high + 1) / 2;
        STARG_TRY(walk(s, s->start, middle, true, &goal));
        if (goal != SIZE_MAX)
            low = middle;
        else
            high = middle - 1;
    }
    STARG_TRY(walk(s, s->start, low, true, &goal));
    if (goal != SIZE_MAX)
        status = keep_path(s, goal, from, leak);
done:
    return status;
}

/* ---- narrow gaps ---- */

/* The share of roomy cubes that are reached through narrow gaps only; sets `roomy`. */
static starg_status find_narrow(leak_search *s, double *share) {
    starg_status status = STARG_OK;
    size_t first, all = 0, behind = 0;
    STARG_NEW_ZERO(s->flood->context, STAGE, s->roomy, s->cells);
    *share = 0;
    STARG_TRY(walk(s, s->start, 1, true, &first));
    if (first == SIZE_MAX)
        goto done;
    STARG_TRY(walk(s, first, ROOMY, false, &first));
    for (size_t i = 0; i < s->queue.count; i++)
        s->roomy[s->queue.data[i]] = true;
    for (size_t i = 0; i < s->cells; i++) {
        bool counts = starg_bit_test(s->flood->bits, i) && s->clear[i] >= ROOMY;
        all += counts;
        behind += counts && !s->roomy[i];
    }
    *share = (double)behind / (double)all;
done:
    return status;
}

/* ---- the call ---- */

static bool gets_out(const leak_search *s) {
    for (size_t i = 0; i < s->cells; i++)
        if (starg_bit_test(s->flood->bits, i) && is_out(s, i))
            return true;
    return false;
}

starg_status flood_find_leak(starg_context *context, const starg_solid *scene, const double from[3],
                             const flood_cells *flood, flood_leak *leak) {
    starg_status status = STARG_OK;
    const size_t *count = flood->count;
    leak_search s = {.flood = flood, .step = {1, count[0], count[0] * count[1]}};
    *leak = (flood_leak){0};
    s.cells = s.step[2] * count[2];
    s.model = (scene->model_tree != NULL ? scene->model_tree : scene->tree)->nodes[0].box;
    for (int k = 0; k < 3; k++)
        s.start += (size_t)((from[k] - flood->origin[k]) / flood->size) * s.step[k];
    STARG_NEW(context, STAGE, s.clear, s.cells);
    STARG_NEW(context, STAGE, s.came, s.cells);
    find_clearance(&s);
    leak->outside = gets_out(&s);
    if (!leak->outside)
        STARG_TRY(find_narrow(&s, &leak->share));
    if (leak->outside || leak->share > SMALL_SHARE)
        status = find_path(&s, from, leak);
done:
    starg_release(context, s.clear);
    starg_release(context, s.came);
    starg_release(context, s.roomy);
    STARG_ARRAY_FREE(context, &s.queue);
    return status;
}
