/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a search over every point (guard/search.c). */
#ifndef STARG_GUARD_SEARCH_PARTS_H
#define STARG_GUARD_SEARCH_PARTS_H

#include "core/rng.h"
#include "guard/cells.h"
#include "guard/prices.h"
#include "guard/stages.h"

/* By how much points may exceed 1 all the same. */
#define SEARCH_GAP 2e-3

typedef STARG_ARRAY(search_step) search_steps;

typedef struct search {
    const guard_problem *problem;
    guard_pool *pool; /* receives the points that were tested against all columns */
    search_scene scene;
    search_cells cells;
    search_points points;
    witness_prices prices;
    odd_sets odd;                 /* that have prices beside the witnesses */
    double odd_value;             /* of the prices when such sets were looked for last */
    int odd_rounds;               /* that looked for such sets, one after the other */
    witness_row unpriced;         /* witnesses without a price, left out of the program */
    size_t redundancy;            /* how many guards must see a witness */
    uint16_t *need;               /* by column: how often it must be seen */
    uint32_t *views;              /* by column: how many of the first candidates see it */
    uint64_t *viewers;            /* by column: an identifier of the set of them */
    size_t count, bound;          /* number of guards, and its lower bound */
    size_t asked_at, asked_of;    /* numbers of cells and witnesses at the last integer program */
    size_t asked_pool;            /* number of candidates at the last one over all faces, */
    size_t asked_bound;           /* and the bound that it gave for them */
    uint64_t ask_after;           /* work at which the next one is due */
    uint64_t budget;              /* of the work that the scene counts */
    double finest;                /* leaves no longer than this count as points in the prices */
    unsigned refinements;         /* rounds in which such leaves held the prices down */
    size_t nodes;                 /* that an integer program may take */
    uint64_t improve_work;        /* work spent on looking for better guards */
    uint64_t moves;               /* calls of search_move */
    STARG_ARRAY(uint32_t) guards; /* the best ones: candidates of the pool */
    size_t first_count;           /* number of candidates in the pool at the start */
    size_t known;                 /* lower bound for the known points */
    int idle;                     /* rounds that looked for guards and found none */
    bool better;                  /* the guards differ from those at the start */
    bool ended;
    search_steps steps; /* all numbers of guards, in units of the scene's work */
} search;

/* Notes that there are `count` guards now. Errors: MEMORY. */
starg_status search_note_guards(search *s);

/* Lower bound on the points that see all witnesses often enough, by the prices. */
static inline double search_value(const search *s) {
    return (double)s->redundancy * s->prices.sum;
}

/* What the row holds is worth at these prices. */
static inline double search_worth(const search *s, const witness_row *row) {
    return prices_of_row(&s->prices, &s->odd, row);
}

static inline starg_context *context_of(const search *s) {
    return s->problem->context;
}

/* Rows of points and fine leaves that no other row contains. */
typedef struct row_list {
    const witness_row **rows;
    uint32_t *points; /* by row: the point, or UINT32_MAX for a leaf */
    size_t count;
} row_list;

static inline void row_list_free(starg_context *context, row_list *list) {
    starg_release(context, list->rows);
    starg_release(context, list->points);
}

/* Does a row of the list hold what this one holds of these witnesses? */
static inline bool is_needless(const row_list *list, const witness_row *row,
                               const witness_row *among) {
    for (size_t k = 0; k < list->count; k++)
        if (row_is_within_among(row, list->rows[k], among))
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

/* A round of a proof (guard/search_proof.c). Errors: MEMORY, CANCELLED. */
starg_status search_prove_round(search *s, row_list *list);

/* Raises the bound to what the prices prove for the current cells. Errors: MEMORY. */
starg_status search_prove(search *s);

/* Raises it to the best that the current cells have: all of them count as points in the prices.
 * Errors: MEMORY. */
starg_status search_prove_by_leaves(search *s);

/* Do the prices leave room for fewer guards than there are? */
bool search_has_room(const search *s);

/* Sets `known`, the lower bound for the known points, by the prices: what it was before, with fewer
 * points, is forgotten. Errors: MEMORY. */
starg_status search_bound_points(search *s);

/* A round of looking for better guards, the budget of these rounds, and their end
 * (guard/search_improve.c). Errors: MEMORY, CANCELLED. */
starg_status search_improve(search *s, row_list *list);
uint64_t search_improve_work(const search *s);
starg_status search_close(search *s);

/* Removes points of the search, from `first` on, that see no more than another does. */
void search_prune_points(search *s, size_t first);

/* The value of the most valuable point, or 1. */
double search_largest_value(const search *s);

/* Prices of maximal sum by which no point and no small leaf exceeds 1; the list receives the rows
 * of their program, a subset of all. `prices.work` is that of all programs it took. Errors:
 * MEMORY. */
starg_status search_find_prices(search *s, row_list *list);

/* Odd sets of which the fractional cover by the list holds too little get prices (at first 0), if
 * the prices have changed since. A few times in a row, then other means have their turn. *changed:
 * there are some. Errors: MEMORY. */
starg_status search_find_odd(search *s, const row_list *list, bool *changed);

/* Is a leaf small enough to count as a point? Do such leaves hold the prices down? */
bool search_is_fine(const search *s, const search_cell *leaf);
bool search_fine_bind(const search *s, const row_list *list);

/* The faces that the fewest candidates see become witnesses. Errors: MEMORY, CANCELLED. */
starg_status search_first_witnesses(search *s);

/* How many of the first candidates see each column, and which: `views` and `viewers`. Errors:
 * MEMORY. */
starg_status search_count_views(search *s);

/* Turns faces into witnesses that the fractional cover by the points of the list does not see often
 * enough. *changed: there are some. Errors: MEMORY, CANCELLED. */
starg_status search_add_short(search *s, const row_list *list, bool *changed);

/* Tests points of the search that see all witnesses often enough against all faces: they are better
 * guards, or the faces that they miss become witnesses. *changed: either. Errors: MEMORY,
 * CANCELLED. */
starg_status search_try_guards(search *s, const uint32_t *points, size_t count, bool *changed);

/* Turns points of the search into candidates, with full visibility rows. Errors: MEMORY,
 * CANCELLED. */
starg_status search_hold(search *s, const uint32_t *points, size_t count);

/* Adds points that are more valuable than known ones (guard/search_moves.c). *most: the value of
 * the best, 0 if there is none. Errors: MEMORY, CANCELLED. */
starg_status search_move(search *s, double *most);

/* Where a proposed point stands: around the point that it is to replace, between that and another
 * one, in front of the witness, or just inside the wall that the point looks at. */
typedef enum search_stand {
    STAND_AROUND = 0,
    STAND_BETWEEN = 1,
    STAND_BEFORE = 2,
    STAND_AT_WALL = 3,
    STANDS = 4
} search_stand;

/* Proposes a point in place of `best`, which sees witness j. `other` is the place of another point
 * (NULL: none). If views are cones, the direction is turned as well. */
void search_propose(const search_scene *scene, const search_point *best, size_t j,
                    const double *other, search_stand stand, double step, starg_rng *rng,
                    search_point *out);

/* Local search for one guard fewer (guard/search_fewer.c). *changed: there are better guards, or
 * more witnesses. Errors: MEMORY, CANCELLED. */
starg_status search_fewer(search *s, bool *changed);

/* A leaf to split, the highest score first. */
typedef struct scored_leaf {
    double score;
    uint32_t cell;
} scored_leaf;

typedef STARG_ARRAY(scored_leaf) leaf_list;

/* Sorts the leaves and splits those at the front that can be split, about a quarter of them, with
 * `tries` points in each part. Errors: MEMORY, CANCELLED. */
starg_status search_split(search *s, scored_leaf *list, size_t count, int tries);

/* By decreasing score, then by number. */
int search_by_score(const void *a, const void *b);

/* Appends leaves from number `first` on that are worth more than `most`. Errors: MEMORY. */
starg_status search_list_leaves(search *s, double most, size_t first, leaf_list *list);

/* The integer program over the points: do fewer guards see all witnesses? *changed: there are
 * better guards, or more witnesses. Errors: MEMORY, CANCELLED. */
starg_status search_ask_points(search *s, bool *changed);

/* The integer program over all columns and the candidates that may be among fewer guards, by the
 * prices: raises `known` to its bound. Errors: MEMORY, CANCELLED. */
starg_status search_ask_candidates(search *s);

/* The integer program over cells and points. If fewer of them than guards cover all witnesses,
 * splits these cells or tries these points; otherwise branching proves the bound. *changed: there
 * are more cells, more witnesses or better guards. Errors: MEMORY, CANCELLED. */
starg_status search_ask_cells(search *s, bool *changed);

#endif
