/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a search over every point (guard/search.c). */
#ifndef STARG_GUARD_SEARCH_PARTS_H
#define STARG_GUARD_SEARCH_PARTS_H

#include "guard/cells.h"
#include "guard/prices.h"
#include "guard/stages.h"

typedef struct search {
    const guard_problem *problem;
    const guard_pool *pool;
    search_scene scene;
    search_cells cells;
    search_points points;
    witness_prices prices;
    uint64_t *wanted;           /* bits by column: what is to be seen */
    STARG_ARRAY(double) guards; /* the best ones, three numbers each */
    size_t count, bound;        /* guards, and how few could do */
    size_t asked_at, asked_of;  /* cells and witnesses when the integer program was last asked */
    bool better;                /* there are other guards than at first */
    bool ended;
} search;

static inline starg_context *context_of(const search *s) {
    return s->problem->context;
}

/* Rows of points that no other row holds, from the front of `list`. */
typedef struct row_list {
    const witness_row **rows;
    uint32_t *points;
    size_t count;
} row_list;

static inline void row_list_free(starg_context *context, row_list *list) {
    starg_release(context, list->rows);
    starg_release(context, list->points);
}

static inline bool is_needless(const row_list *list, const witness_row *row) {
    for (size_t k = 0; k < list->count; k++)
        if (row_is_within(row, list->rows[k]))
            return true;
    return false;
}

static inline starg_status row_list_make(starg_context *context, size_t most, row_list *out) {
    starg_status status = STARG_OK;
    STARG_NEW(context, "search", out->rows, most);
    STARG_NEW(context, "search", out->points, most);
done:
    return status;
}

static inline void row_list_add(const search *s, row_list *list, size_t point) {
    list->rows[list->count] = &s->points.data[point].seen;
    list->points[list->count++] = (uint32_t)point;
}

static inline witness_row all_witnesses(const search *s) {
    witness_row row = {{0}};
    for (size_t j = 0; j < s->scene.witnesses.count; j++)
        starg_bit_set(row.bits, j);
    return row;
}

/* The faces that carry most of the price of the candidates' program become witnesses. Errors:
 * MEMORY, CANCELLED. */
starg_status search_first_witnesses(search *s);

/* So do faces that the fractional cover by the points of the list does not see often enough.
 * *changed: there are some. Errors: MEMORY, CANCELLED. */
starg_status search_add_short(search *s, const row_list *list, bool *changed);

/* Points that see all witnesses: better guards, or faces that they miss become witnesses. *changed:
 * either. Errors: MEMORY, CANCELLED. */
starg_status search_try_guards(search *s, const double *places, size_t count, bool *changed);

/* A leaf that is to be split, the highest score first. */
typedef struct scored_leaf {
    double score;
    uint32_t cell;
} scored_leaf;

/* Sorts the leaves and splits those at the front that can be, a quarter of them or so, with so many
 * points a part. Errors: MEMORY, CANCELLED. */
starg_status search_split(search *s, scored_leaf *list, size_t count, int tries);

/* The integer program over the points: do fewer guards see all witnesses? *changed: there are
 * better guards, or more witnesses. Errors: MEMORY, CANCELLED. */
starg_status search_ask_points(search *s, bool *changed);

/* The integer program over cells and points: what holds all witnesses with fewer of them than there
 * are guards is followed, by splitting its cells or trying its points; where nothing does,
 * branching proves it. *changed: there are more cells, more witnesses or better guards. Errors:
 * MEMORY, CANCELLED. */
starg_status search_ask_cells(search *s, bool *changed);

#endif
