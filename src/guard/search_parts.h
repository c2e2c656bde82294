/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a search over every point (guard/search.c). Each is written by one file, through the
 * functions here that take it without const; work is counted where it is done. Steps change several
 * parts, and take the whole search. What returns a status fails with MEMORY or CANCELLED. */
#ifndef STARG_GUARD_SEARCH_PARTS_H
#define STARG_GUARD_SEARCH_PARTS_H

#include "core/rng.h"
#include "guard/cells.h"
#include "guard/prices.h"
#include "guard/stages.h"

/* By how much points may exceed 1 all the same. */
#define SEARCH_GAP 2e-3

typedef struct search search;

/* ---- effort: what is done and what is allowed (guard/search.c) ---- */
typedef struct search_effort {
    uint64_t work;   /* tests of a vertex against a box or a point, and what takes as long */
    uint64_t budget; /* of the rounds that run */
    size_t nodes;    /* that an integer program may take */
} search_effort;

/* ---- witness set: what must be seen, and how often (guard/search_witnesses.c) ---- */
typedef struct witness_set {
    search_scene scene; /* with the witnesses */
    size_t redundancy;  /* how many guards must see a witness */
    uint16_t *need;     /* by column: how often it must be seen */
    uint32_t *views;    /* by column: how many of the first candidates see it */
    uint64_t *viewers;  /* by column: an identifier of the set of them */
} witness_set;

/* Opens the scene, without witnesses; columns need what `chosen` see. */
starg_status witness_set_begin(const guard_problem *problem, const guard_pool *pool,
                               const guard_selection *selection, witness_set *out);
void witness_set_end(witness_set *set);

/* The faces that the fewest candidates see become witnesses. */
starg_status search_first_witnesses(search *s);

/* ---- point set: where guards may stand (guard/search_points.c, with guard/search_scene.c) ---- */

/* Candidates, and the medial axis unless they stand there, views are cones, or time is short. */
starg_status points_begin(const guard_problem *problem, const guard_detail *detail,
                          const guard_pool *pool, search_points *points);

/* Turns points into candidates, with full visibility rows. */
starg_status points_hold(const search_scene *scene, const uint32_t *chosen, size_t count,
                         search_points *points, guard_pool *pool, uint64_t *work);

/* Tests all against the witnesses from `first` on. */
starg_status points_look(const search_scene *scene, const guard_pool *pool, size_t first,
                         search_points *points, uint64_t *work);

starg_status points_add(starg_context *context, const search_point *point, search_points *points);

/* ---- duals: prices of witnesses and odd sets (guard/search_prices.c) ---- */

/* Of 64 rows of a list, by witness: those that hold it. */
typedef struct row_block {
    uint64_t holders[MOST_WITNESSES];
} row_block;

/* Rows of points and of leaves that no other row contains. */
typedef struct row_list {
    starg_context *context;
    const witness_row **rows;
    uint32_t *names; /* by row: the point, or ROW_LEAF plus the leaf */
    size_t count;
    STARG_ARRAY(row_block) blocks; /* of the rows, and former ones */
} row_list;

#define ROW_LEAF UINT32_C(0x80000000)

typedef struct search_duals {
    const witness_set *witnesses; /* what has prices, */
    const search_points *points;  /* and what they are found from */
    const search_cells *cells;
    witness_prices prices;
    odd_sets odd;         /* that have prices beside the witnesses */
    double odd_value;     /* of the prices when such sets were looked for last */
    int odd_rounds;       /* that looked for such sets, one after the other */
    witness_row unpriced; /* witnesses without a price, left out of the program */
    double finest;        /* leaves no longer than this count as points */
    unsigned refinements; /* rounds in which such leaves held the prices down */
} search_duals;

/* A list has room for two rows of each point and one of each cell. Does a row of it hold what this
 * one holds of these witnesses? */
starg_status row_list_make(const search_duals *d, row_list *out);
starg_status row_list_add(row_list *list, const witness_row *row, size_t name);
bool row_list_holds(const row_list *list, const witness_row *row, const witness_row *among);
void row_list_free(row_list *list);

/* Lower bound on the points that see all witnesses often enough. */
static inline double duals_value(const search_duals *d) {
    return (double)d->witnesses->redundancy * d->prices.sum;
}

/* Sum of the prices of what the row holds. */
static inline double duals_of_row(const search_duals *d, const witness_row *row) {
    return prices_of_row(&d->prices, &d->odd, row);
}

/* May there be fewer guards than so many? */
static inline bool duals_leave_room(const search_duals *d, size_t guards) {
    return duals_value(d) <= (double)guards - 1 + SEARCH_GAP;
}

/* The value of the most valuable point, or 1. */
double duals_of_best_point(const search_duals *d);

/* Prices of maximal sum by which no point and no fine leaf exceeds 1; the list receives the rows of
 * their program, a subset of all. `prices.work` is that of all programs it took. */
starg_status duals_find(search_duals *d, row_list *list, uint64_t *work);

/* Odd sets of which the fractional cover by the list holds too little get prices (at first 0), if
 * prices have changed since the last time, and a few times in a row. *changed: there are some. */
starg_status duals_find_odd(search_duals *d, const row_list *list, bool *changed, uint64_t *work);

/* From now on, leaves no longer than this count as points. Do such leaves hold the prices down?
 * *others: is it the turn of other means than smaller ones? */
void duals_set_finest(search_duals *d, double finest);
bool duals_are_held(search_duals *d, const row_list *list, bool *others);

/* Adds leaves from number `first` on that are not fine and worth more than `most`. */
starg_status duals_list_leaves(const search_duals *d, double most, size_t first, leaf_list *list,
                               uint64_t *work);

/* Sets the bound on how many of the points are needed to what the prices prove; raises it. */
starg_status points_prove(const search_duals *d, search_points *points);
void points_raise_bound(search_points *points, size_t bound);

/* ---- incumbent: the best guards, and the bound for all places (guard/search_incumbent.c) ---- */
typedef struct search_incumbent {
    STARG_ARRAY(uint32_t) guards; /* candidates of the pool */
    size_t bound;
    STARG_ARRAY(search_step) steps; /* all numbers of guards, after so much work */
} search_incumbent;

/* Takes guards that are fewer than those before, or the first ones; raises the bound, true: it is
 * higher than before. */
starg_status incumbent_take(starg_context *context, const uint32_t *guards, size_t count,
                            uint64_t work, search_incumbent *best);
bool incumbent_raise(search_incumbent *best, size_t bound);

/* Replaces the choice, from the `first_count` candidates, and its bound by the result. */
starg_status incumbent_choose(const search *s, size_t first_count, guard_selection *selection);

/* ---- integer programs, and when they were asked last (guard/search_programs.c) ---- */
typedef struct search_asked {
    size_t cells, witnesses; /* their numbers at the last program over points */
    uint64_t after;          /* work at which the next one is due */
    size_t candidates;       /* their number at the last program over all faces, */
    size_t bound;            /* and the bound that it gave for them */
} search_asked;

/* Over the points: do fewer guards see all witnesses? *changed: better guards or more witnesses. */
starg_status search_ask_points(search *s, bool *changed);

/* Over all columns and the candidates that may be among fewer guards, unless that was asked for
 * these candidates already: raises the points' bound. */
starg_status search_ask_candidates(search *s);

/* Over cells and points: if fewer of them than guards cover all witnesses, splits these cells or
 * tries these points; otherwise branching proves the bound. *changed: more of any. */
starg_status search_ask_cells(search *s, bool *changed);

/* ---- improvement (guard/search_improve.c) ---- */
typedef struct improvement {
    bool moved;     /* the last round moved points: the next one looks for guards */
    uint64_t draws; /* steps that drew random numbers: each has streams of its own */
    int idle;       /* rounds that looked for guards and found none */
} improvement;

struct search {
    const guard_problem *problem;
    guard_pool *pool; /* receives the points that were tested against all columns */
    witness_set witnesses;
    search_cells cells; /* the box tree (guard/cells.c) */
    search_points points;
    search_duals duals;
    search_incumbent best;
    search_asked asked;
    improvement improving;
    search_effort effort;
};

/* A round of looking for better guards, *ended: another would find nothing; the work for all; and
 * integer programs at their end. */
starg_status search_improve(search *s, row_list *list, bool *ended);
uint64_t search_improve_work(const search *s);
starg_status search_close(search *s, bool *better);

/* A round of a proof (guard/search_proof.c), *ended as before; and what raises the bound at its
 * end: prices for which all cells count as points, and those that there are. */
starg_status search_prove(search *s, row_list *list, bool *ended);
starg_status search_prove_by_leaves(search *s);
starg_status search_prove_by_prices(search *s);

/* ---- steps ---- */

/* Faces that the fractional cover by the listed points lacks become witnesses. *changed: any. */
starg_status search_add_short(search *s, const row_list *list, bool *changed);

/* Tests points of the search that see all witnesses often enough against all faces: they are better
 * guards, or the faces that they miss become witnesses. *changed: either. */
starg_status search_try_guards(search *s, const uint32_t *points, size_t count, bool *changed);

/* Adds more valuable points than are known (guard/search_moves.c). *most: the best value, or 0. */
starg_status search_move(const search_scene *scene, const witness_prices *prices, uint64_t draw,
                         search_points *points, search_effort *effort, double *most);

/* Local search for one guard fewer (guard/search_fewer.c). *changed: it, or more witnesses. */
starg_status search_fewer(search *s, uint64_t draw, bool *changed);

/* A random witness of the row; `none` if it holds none. */
size_t search_draw(const witness_row *row, size_t none, starg_rng *rng);

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

#endif
