/* SPDX-License-Identifier: Apache-2.0 */
/* The fewest guards over every point of the free space, and how few could do.
 *
 * Problem. Guards may stand anywhere; a lower bound that holds for all of them, and guards that
 * come as close to it as can be [after exact solvers for the art gallery problem in the plane:
 * Tozoni, de Rezende, de Souza 2016].
 *
 * Witnesses are some of the faces: guards that see everything see these, so that a bound for them
 * is a bound. Cells (guard/cells.c) hold every point of the space, and each knows the witnesses
 * that it may see. Points are candidates, centres of cells and points at random. One loop improves
 * both ends:
 *   1. prices of the witnesses from the points that are known (guard/prices.c): no point is worth
 *      more than 1;
 *   2. where the prices leave room for fewer guards than there are, an integer program over the
 *      points looks for them. What it finds is held against all faces: better guards, or faces that
 *      they do not see, which become witnesses;
 *   3. cells that may be worth too much for the bound that is aimed at are split, those first that
 *      are worth most and are large; their points join the others, and it goes on with 1;
 *   4. when there are none, the prices prove the bound (guard/bound.c). Is that not the number of
 *      guards, faces that the fractional cover does not see enough become witnesses;
 *   5. where there are no such faces either, an integer program over cells and points: cells that
 *      could do with fewer guards than there are, are split, with more points; where no cells
 *      could, branching proves it, each branch by prices of its own.
 *
 * Invariant: the bound holds for guards anywhere in the free space; the guards see all that was to
 * be seen. Everything is counted in operations, nothing depends on threads. */
#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/vec3.h"
#include "guard/bound.h"
#include "guard/cells.h"
#include "guard/prices.h"
#include "guard/stages.h"

static const char STAGE[] = "search";

enum {
    FIRST_WITNESSES = 150,
    MORE_WITNESSES = 20,
    LEAST_BATCH = 32,
    MOST_BATCH = 2048,
    NODES = 300,
    TRIES = 2,
    FOLLOWED = 16
};

static const double ROUNDING = 1e-6, GAP = 2e-3;

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

static starg_context *context_of(const search *s) {
    return s->problem->context;
}

/* ---- witnesses ---- */

typedef struct scored_column {
    double score;
    uint64_t viewers; /* a number for the set of candidates that see it */
    uint32_t column;
} scored_column;

static int by_score(const void *a, const void *b) {
    const scored_column *x = a, *y = b;
    if (x->score != y->score)
        return x->score < y->score ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

/* The sum of a random number for each candidate that sees the column. */
static void number_viewers(const search *s, uint64_t *viewers) {
    const starg_bits *rows = s->pool->rows;
    for (size_t i = 0; i < rows->rows; i++) {
        uint64_t number = starg_hash64(i + 1);
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, i)[w])
                viewers[64 * w + bit] += number;
    }
}

static bool is_alike(const scored_column *list, size_t count, const scored_column *one) {
    for (size_t i = 0; i < count; i++)
        if (list[i].viewers == one->viewers)
            return true;
    return false;
}

static bool is_witness(const search *s, uint32_t column) {
    for (size_t j = 0; j < s->scene.witnesses.count; j++)
        if (s->scene.witnesses.data[j] == column)
            return true;
    return false;
}

/* Moves at most `most` columns to the front: the least scores first, no two of which the same
 * candidates see. */
static size_t choose_columns(const search *s, scored_column *list, size_t count, size_t most) {
    size_t kept = 0;
    qsort(list, count, sizeof *list, by_score);
    for (size_t i = 0; i < count && kept < most; i++)
        if (!is_alike(list, kept, &list[i]) && !is_witness(s, list[i].column))
            list[kept++] = list[i];
    return kept;
}

static starg_status look_at_new(search *s, size_t first) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < s->points.count; i++) {
        search_point *point = &s->points.data[i];
        for (size_t j = first; point->candidate != UINT32_MAX && j < s->scene.witnesses.count; j++)
            if (starg_bits_test(s->pool->rows, point->candidate, s->scene.witnesses.data[j]))
                starg_bit_set(point->seen.bits, j);
    }
    STARG_TRY(points_look(&s->scene, &s->points, first));
    STARG_TRY(cells_look(&s->scene, &s->cells, first));
done:
    return status;
}

/* Columns below `limit` of a score become witnesses, as many as `most`. *added: how many. */
static starg_status add_witnesses(search *s, const double *scores, double limit, size_t most,
                                  size_t *added) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    size_t columns = s->pool->columns, count = 0, first = s->scene.witnesses.count;
    scored_column *list = NULL;
    uint64_t *viewers = NULL;
    *added = 0;
    STARG_NEW(context, STAGE, list, columns);
    STARG_NEW_ZERO(context, STAGE, viewers, 64 * starg_bit_words(columns));
    number_viewers(s, viewers);
    for (size_t j = 0; j < columns; j++)
        if (starg_bit_test(s->wanted, j) && scores[j] < limit)
            list[count++] = (scored_column){scores[j], viewers[j], (uint32_t)j};
    if (most > MOST_WITNESSES - first)
        most = MOST_WITNESSES - first;
    count = choose_columns(s, list, count, most);
    for (size_t i = 0; i < count; i++)
        STARG_PUSH(context, STAGE, &s->scene.witnesses, list[i].column);
    *added = count;
    if (count > 0)
        STARG_TRY(look_at_new(s, first));
done:
    starg_release(context, list);
    starg_release(context, viewers);
    return status;
}

/* The faces that carry most of the price of the candidates' program. */
static starg_status find_first_witnesses(search *s) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    starg_cover *cover = NULL;
    double *scores = NULL;
    size_t added;
    const choice how = {.method = STARG_COVER_LP, .prices = true};
    STARG_TRY(choose_candidates(s->pool, &s->problem->weights, &how, &cover));
    STARG_NEW(context, STAGE, scores, s->pool->columns);
    for (size_t j = 0; j < s->pool->columns; j++)
        scores[j] = -cover->prices[j];
    STARG_TRY(add_witnesses(s, scores, -1e-6, FIRST_WITNESSES, &added));
done:
    starg_cover_free(cover);
    starg_release(context, scores);
    return status;
}

/* ---- points ---- */

/* Leaves out points of the search that see no more than another one does, from `first` on. Those of
 * the pool stay: they may be worth more with other witnesses. */
static void prune_points(search *s, size_t first) {
    search_point *points = s->points.data;
    size_t kept = first;
    for (size_t i = first; i < s->points.count; i++) {
        bool needless = false;
        for (size_t j = 0; j < s->points.count && !needless; j++)
            needless = (j < kept || j > i) && row_is_within(&points[i].seen, &points[j].seen) &&
                       (j < kept || !row_is_within(&points[j].seen, &points[i].seen));
        if (!needless || points[i].candidate != UINT32_MAX)
            points[kept++] = points[i];
    }
    s->scene.work += (s->points.count - first) * s->points.count / 100;
    s->points.count = kept;
}

static starg_status begin_points(search *s) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < pool_count(s->pool); i++) {
        search_point point = {.candidate = (uint32_t)i};
        vec3_copy(pool_point(s->pool, i), point.place);
        STARG_PUSH(context_of(s), STAGE, &s->points, point);
    }
done:
    return status;
}

/* Rows of points that no other row holds, from the front of `list`. */
typedef struct row_list {
    const witness_row **rows;
    uint32_t *points;
    size_t count;
} row_list;

static void row_list_free(starg_context *context, row_list *list) {
    starg_release(context, list->rows);
    starg_release(context, list->points);
}

static bool is_needless(const row_list *list, const witness_row *row) {
    for (size_t k = 0; k < list->count; k++)
        if (row_is_within(row, list->rows[k]))
            return true;
    return false;
}

static starg_status row_list_make(starg_context *context, size_t most, row_list *out) {
    starg_status status = STARG_OK;
    STARG_NEW(context, STAGE, out->rows, most);
    STARG_NEW(context, STAGE, out->points, most);
done:
    return status;
}

static void row_list_add(const search *s, row_list *list, size_t point) {
    list->rows[list->count] = &s->points.data[point].seen;
    list->points[list->count++] = (uint32_t)point;
}

static witness_row all_witnesses(const search *s) {
    witness_row row = {{0}};
    for (size_t j = 0; j < s->scene.witnesses.count; j++)
        starg_bit_set(row.bits, j);
    return row;
}

/* ---- prices ---- */

/* Points that are worth at least `least` join the list, and those that see what none of it does. */
static void list_worthy(const search *s, const double *price, double least, const uint8_t *listed,
                        row_list *list) {
    witness_row held = {{0}};
    for (size_t i = 0; i < s->points.count; i++)
        if (!listed[i] && row_value(&s->points.data[i].seen, price) >= least &&
            !is_needless(list, &s->points.data[i].seen))
            row_list_add(s, list, i);
    for (size_t k = 0; k < list->count; k++)
        for (int w = 0; w < WITNESS_WORDS; w++)
            held.bits[w] |= list->rows[k]->bits[w];
    for (size_t i = 0; i < s->points.count; i++)
        if (!row_is_within(&s->points.data[i].seen, &held))
            row_list_add(s, list, i);
}

static double largest_value(const search *s) {
    double most = 1;
    for (size_t i = 0; i < s->points.count; i++)
        most = fmax(most, row_value(&s->points.data[i].seen, s->prices.price));
    return most;
}

/* Prices by which no point is worth more than 1, of as large a sum as can be. The program is made
 * of the points that were worth much by the prices before; what it leaves out joins it where it
 * turns out to be worth more than 1. */
static starg_status find_prices(search *s, row_list *list) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    uint8_t *listed = NULL;
    const witness_row all = all_witnesses(s);
    double most = 1;
    STARG_NEW_ZERO(context, STAGE, listed, s->points.count);
    double least = s->prices.sum > 0 ? 0.8 : 0;
    list->count = 0;
    for (int k = 0; k < 6; k++) {
        list_worthy(s, s->prices.price, least, listed, list);
        for (size_t i = 0; i < list->count; i++)
            listed[list->points[i]] = 1;
        prices_free(context, &s->prices);
        STARG_TRY(prices_find(context, list->rows, list->count, &all, &s->prices));
        s->scene.work += s->prices.work;
        most = largest_value(s);
        least = 1 + 1e-9;
        if (most < 1 + GAP)
            break;
    }
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        s->prices.price[j] /= most;
    s->prices.sum /= most;
done:
    starg_release(context, listed);
    return status;
}

/* ---- guards ---- */

static starg_status see_all(const search *s, const double *places, size_t count, starg_bits **out) {
    starg_visibility_options view = s->problem->options->visibility;
    starg_time_rule former = starg_time_begin(context_of(s), STARG_TIME_IGNORED);
    view.engine = STARG_VISIBILITY_FASTEST;
    starg_status status =
        starg_visibility(context_of(s), s->problem->solid, places, count, &view, out);
    starg_time_end(context_of(s), former);
    return status;
}

/* How many candidates see each column that is wanted and that no row holds; INFINITY for others. */
static starg_status score_missing(const search *s, const starg_bits *rows, double *scores,
                                  bool *any) {
    starg_status status = STARG_OK;
    uint64_t *joined = NULL;
    STARG_TRY(pool_join_rows(context_of(s), rows, &joined));
    *any = false;
    for (size_t j = 0; j < s->pool->columns; j++) {
        bool missing = starg_bit_test(s->wanted, j) && !starg_bit_test(joined, j);
        scores[j] = missing ? 0 : INFINITY;
        *any = *any || missing;
    }
    for (size_t i = 0; *any && i < s->pool->rows->rows; i++)
        for (size_t w = 0; w < s->pool->rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(s->pool->rows, i)[w] & ~joined[w])
                scores[64 * w + bit] += 1;
done:
    starg_release(context_of(s), joined);
    return status;
}

static starg_status take_guards(search *s, const double *places, size_t count) {
    starg_status status = STARG_OK;
    s->guards.count = 0;
    for (size_t k = 0; k < 3 * count; k++)
        STARG_PUSH(context_of(s), STAGE, &s->guards, places[k]);
    s->count = count;
    s->better = true;
done:
    return status;
}

/* Points that see all witnesses: better guards, or witnesses to come. */
static starg_status try_guards(search *s, const double *places, size_t count, bool *changed) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    starg_bits *rows = NULL;
    double *scores = NULL;
    bool missing;
    size_t added = 0;
    STARG_TRY(see_all(s, places, count, &rows));
    s->scene.work += count * s->pool->columns / 4;
    STARG_NEW(context, STAGE, scores, 64 * rows->words);
    STARG_TRY(score_missing(s, rows, scores, &missing));
    if (!missing)
        STARG_TRY(take_guards(s, places, count));
    else
        STARG_TRY(add_witnesses(s, scores, INFINITY, MORE_WITNESSES, &added));
    *changed = !missing || added > 0;
done:
    starg_bits_free(rows);
    starg_release(context, scores);
    return status;
}

static starg_status make_program(const search *s, const row_list *list, starg_bits **out) {
    starg_status status =
        starg_bits_create(context_of(s), list->count, s->scene.witnesses.count, out);
    for (size_t i = 0; status == STARG_OK && i < list->count; i++)
        memcpy(starg_bits_row_mutable(*out, i), list->rows[i]->bits,
               (*out)->words * sizeof(uint64_t));
    return status;
}

static void list_needed(const search *s, row_list *list) {
    list->count = 0;
    for (size_t i = 0; i < s->points.count; i++)
        if (!is_needless(list, &s->points.data[i].seen))
            row_list_add(s, list, i);
}

/* The integer program over the points: do fewer guards see all witnesses? *changed: there are
 * better guards, or more witnesses. */
static starg_status ask_points(search *s, bool *changed) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    starg_bits *rows = NULL;
    starg_cover *cover = NULL;
    starg_cover_problem problem;
    starg_cover_options options;
    STARG_ARRAY(double) places = {0};
    row_list list = {0};
    *changed = false;
    STARG_TRY(row_list_make(context, s->points.count, &list));
    list_needed(s, &list);
    STARG_TRY(make_program(s, &list, &rows));
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = rows;
    options.max_nodes = NODES;
    STARG_TRY(starg_cover_solve(context, &problem, &options, &cover));
    s->scene.work += list.count * s->scene.witnesses.count / 4 * (1 + cover->nodes / 10);
    s->asked_at = s->cells.count;
    s->asked_of = s->scene.witnesses.count;
    if (cover->count < s->count) {
        for (size_t k = 0; k < cover->count; k++)
            for (int c = 0; c < 3; c++)
                STARG_PUSH(context, STAGE, &places,
                           s->points.data[list.points[cover->rows[k]]].place[c]);
        STARG_TRY(try_guards(s, places.data, cover->count, changed));
    }
done:
    row_list_free(context, &list);
    STARG_ARRAY_FREE(context, &places);
    starg_cover_free(cover);
    starg_bits_free(rows);
    return status;
}

/* ---- cells ---- */

typedef struct scored_leaf {
    double score;
    uint32_t cell;
} scored_leaf;

static int by_leaf_score(const void *a, const void *b) {
    const scored_leaf *x = a, *y = b;
    if (x->score != y->score)
        return x->score > y->score ? -1 : 1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

/* Leaves that may be worth more than `most`, those first that are to be split first. */
static starg_status list_leaves(const search *s, double most, scored_leaf **out, size_t *count) {
    starg_status status = STARG_OK;
    *count = 0;
    STARG_NEW(context_of(s), STAGE, *out, s->cells.count);
    for (size_t i = 0; i < s->cells.count; i++) {
        const search_cell *cell = &s->cells.data[i];
        if (cell->children != 0)
            continue;
        double value = row_value(&cell->open, s->prices.price);
        if (value <= most)
            continue;
        double size = vec3_distance(cell->box.lower, cell->box.upper);
        (*out)[(*count)++] = (scored_leaf){(value - most) * sqrt(size), (uint32_t)i};
    }
    qsort(*out, *count, sizeof **out, by_leaf_score);
done:
    return status;
}

static starg_status split_leaves(search *s, const scored_leaf *list, size_t count, int tries) {
    starg_status status = STARG_OK;
    uint32_t *leaves = NULL;
    size_t first = s->points.count, chosen = 0, batch = count / 4;
    batch = batch < LEAST_BATCH ? LEAST_BATCH : batch > MOST_BATCH ? MOST_BATCH : batch;
    STARG_NEW(context_of(s), STAGE, leaves, batch);
    for (size_t i = 0; i < count && chosen < batch; i++)
        if (cell_splits(&s->cells.data[list[i].cell].box))
            leaves[chosen++] = list[i].cell;
    s->ended = chosen == 0;
    STARG_TRY(cells_split(&s->scene, &s->cells, leaves, chosen, tries, &s->points));
    prune_points(s, first);
done:
    starg_release(context_of(s), leaves);
    return status;
}

/* The bound that the prices prove. */
static starg_status prove(search *s) {
    starg_status status = STARG_OK;
    const witness_row **rows = NULL;
    uint64_t whole[MOST_WITNESSES];
    size_t count = 0;
    STARG_NEW(context_of(s), STAGE, rows, s->cells.count);
    for (size_t i = 0; i < s->cells.count; i++)
        if (s->cells.data[i].children == 0)
            rows[count++] = &s->cells.data[i].open;
    bound_round(s->prices.price, whole);
    size_t bound = bound_of_prices(rows, count, whole);
    s->bound = bound > s->bound ? bound : s->bound;
done:
    starg_release(context_of(s), rows);
    return status;
}

/* ---- the loop ---- */

/* Columns that the fractional cover does not see often enough become witnesses. */
static starg_status add_short(search *s, const row_list *list, bool *changed) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    STARG_ARRAY(double) places = {0}, shares = {0};
    starg_bits *rows = NULL;
    double *scores = NULL;
    size_t added;
    for (size_t i = 0; i < list->count; i++) {
        if (s->prices.share[i] < 0.003)
            continue;
        for (int k = 0; k < 3; k++)
            STARG_PUSH(context, STAGE, &places, s->points.data[list->points[i]].place[k]);
        STARG_PUSH(context, STAGE, &shares, s->prices.share[i]);
    }
    STARG_TRY(see_all(s, places.data, shares.count, &rows));
    s->scene.work += shares.count * s->pool->columns / 4;
    STARG_NEW_ZERO(context, STAGE, scores, 64 * rows->words);
    for (size_t i = 0; i < shares.count; i++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, i)[w])
                scores[64 * w + bit] += shares.data[i];
    STARG_TRY(add_witnesses(s, scores, 0.95, MORE_WITNESSES, &added));
    *changed = added > 0;
done:
    STARG_ARRAY_FREE(context, &places);
    STARG_ARRAY_FREE(context, &shares);
    starg_bits_free(rows);
    starg_release(context, scores);
    return status;
}

/* Better guards or more witnesses, where the prices leave room. */
static starg_status look_for_guards(search *s, bool last, bool *changed) {
    *changed = false;
    bool grown = s->cells.count > s->asked_at + s->asked_at / (last ? 10 : 3) ||
                 (last && s->scene.witnesses.count > s->asked_of);
    if (s->prices.sum > (double)s->count - 1 + GAP || !grown)
        return STARG_OK;
    return ask_points(s, changed);
}

/* ---- the integer program over cells ---- */

/* Columns of the program: what no other one holds. Leaves that see no more than a point does are
 * left to the point: that is settled. */
typedef struct column_list {
    row_list rows;
    uint32_t *cells; /* by column: the leaf, or UINT32_MAX for a point */
} column_list;

static starg_status list_columns(const search *s, column_list *out) {
    starg_status status = STARG_OK;
    size_t most = s->points.count + s->cells.count, hint = 0;
    STARG_TRY(row_list_make(context_of(s), most, &out->rows));
    STARG_NEW(context_of(s), STAGE, out->cells, most);
    list_needed(s, &out->rows);
    for (size_t k = 0; k < out->rows.count; k++)
        out->cells[k] = UINT32_MAX;
    for (size_t i = 0; i < s->cells.count; i++) {
        const witness_row *open = &s->cells.data[i].open;
        bool needless = s->cells.data[i].children != 0 ||
                        (hint < out->rows.count && row_is_within(open, out->rows.rows[hint]));
        for (size_t k = 0; k < out->rows.count && !needless; k++)
            if (row_is_within(open, out->rows.rows[k])) {
                needless = true;
                hint = k;
            }
        if (needless)
            continue;
        out->cells[out->rows.count] = (uint32_t)i;
        out->rows.points[out->rows.count] = UINT32_MAX;
        out->rows.rows[out->rows.count++] = open;
    }
done:
    return status;
}

/* Unsettled leaves that could stand in for a chosen column: they may see all that it alone sees. */
static starg_status list_stand_ins(const search *s, const column_list *columns,
                                   const starg_cover *cover, scored_leaf **out, size_t *count) {
    starg_status status = STARG_OK;
    uint8_t *listed = NULL;
    *count = 0;
    STARG_NEW_ZERO(context_of(s), STAGE, listed, columns->rows.count);
    STARG_NEW(context_of(s), STAGE, *out, columns->rows.count);
    for (size_t c = 0; c < cover->count; c++) {
        witness_row alone = *columns->rows.rows[cover->rows[c]];
        for (size_t o = 0; o < cover->count; o++)
            for (int w = 0; o != c && w < WITNESS_WORDS; w++)
                alone.bits[w] &= ~columns->rows.rows[cover->rows[o]]->bits[w];
        for (size_t k = 0; k < columns->rows.count; k++) {
            uint32_t cell = columns->cells[k];
            if (cell == UINT32_MAX || listed[k] || !row_is_within(&alone, columns->rows.rows[k]))
                continue;
            const bvh_box *box = &s->cells.data[cell].box;
            double size = vec3_distance(box->lower, box->upper);
            (*out)[(*count)++] = (scored_leaf){k == cover->rows[c] ? INFINITY : size, cell};
            listed[k] = 1;
        }
    }
    qsort(*out, *count, sizeof **out, by_leaf_score);
done:
    starg_release(context_of(s), listed);
    return status;
}

/* Fewer columns than there are guards hold all witnesses: their leaves are split, or all of them
 * are points, which are tried. */
static starg_status follow_cover(search *s, const column_list *columns, const starg_cover *cover,
                                 bool *changed, bool *again) {
    starg_status status = STARG_OK;
    scored_leaf *leaves = NULL;
    size_t count;
    STARG_ARRAY(double) places = {0};
    STARG_TRY(list_stand_ins(s, columns, cover, &leaves, &count));
    *changed = *again = count > 0;
    for (size_t c = 0; c < cover->count && count == 0; c++)
        for (int k = 0; k < 3; k++)
            STARG_PUSH(context_of(s), STAGE, &places,
                       s->points.data[columns->rows.points[cover->rows[c]]].place[k]);
    if (count > 0)
        STARG_TRY(split_leaves(s, leaves, count, MOST_TRIES));
    else
        STARG_TRY(try_guards(s, places.data, cover->count, changed));
done:
    STARG_ARRAY_FREE(context_of(s), &places);
    starg_release(context_of(s), leaves);
    return status;
}

/* The integer program over cells and points: what holds all witnesses with fewer columns than there
 * are guards is followed; where nothing does, branching proves it. */
static starg_status ask_cells_once(search *s, bool *changed, bool *again) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    column_list columns = {0};
    starg_bits *rows = NULL;
    starg_cover *cover = NULL;
    starg_cover_problem problem;
    starg_cover_options options;
    bool proven = false;
    const witness_row all = all_witnesses(s);
    *again = false;
    STARG_TRY(list_columns(s, &columns));
    STARG_TRY(make_program(s, &columns.rows, &rows));
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = rows;
    options.max_nodes = NODES;
    STARG_TRY(starg_cover_solve(context, &problem, &options, &cover));
    s->scene.work += columns.rows.count * s->scene.witnesses.count / 4 * (1 + cover->nodes / 10);
    if (cover->count < s->count)
        STARG_TRY(follow_cover(s, &columns, cover, changed, again));
    else
        STARG_TRY(bound_by_branching(context, columns.rows.rows, columns.rows.count, &all,
                                     s->count - 1, NODES, &proven, &s->scene.work));
    if (proven)
        s->bound = s->count;
done:
    row_list_free(context, &columns.rows);
    starg_release(context, columns.cells);
    starg_cover_free(cover);
    starg_bits_free(rows);
    return status;
}

static starg_status ask_cells(search *s, bool *changed) {
    starg_status status = STARG_OK;
    bool again = true;
    *changed = false;
    for (int k = 0; k < FOLLOWED && again; k++)
        STARG_TRY(ask_cells_once(s, changed, &again));
done:
    return status;
}

/* The next bound to be proven: a third of the way to what the prices allow. Cells that stand in the
 * way of a lower bound stand in that of a higher one too, so that no work is lost, and where the
 * work ends before the highest bound is proven, another one is. */
static size_t next_aim(const search *s) {
    double allowed = fmin((double)s->count, ceil(s->prices.sum - ROUNDING));
    size_t most = allowed > 1 ? (size_t)allowed : 1;
    return s->bound < most ? s->bound + (most - s->bound + 2) / 3 : most;
}

static starg_status run_round(search *s, row_list *list) {
    starg_status status = STARG_OK;
    scored_leaf *leaves = NULL;
    size_t count;
    bool changed;
    STARG_TRY(find_prices(s, list));
    STARG_TRY(look_for_guards(s, false, &changed));
    if (changed)
        goto done;
    size_t aim = next_aim(s), before = s->bound;
    double most = aim > 1 ? s->prices.sum / (double)(aim - 1) * (1 - ROUNDING) : INFINITY;
    STARG_TRY(list_leaves(s, most, &leaves, &count));
    if (count > 0) {
        STARG_TRY(split_leaves(s, leaves, count, TRIES));
        goto done;
    }
    STARG_TRY(prove(s));
    if (s->bound >= s->count || s->bound > before)
        goto done;
    STARG_TRY(look_for_guards(s, true, &changed));
    if (!changed)
        STARG_TRY(add_short(s, list, &changed));
    if (!changed)
        STARG_TRY(ask_cells(s, &changed));
    s->ended = !changed;
done:
    starg_release(context_of(s), leaves);
    return status;
}

static starg_status run(search *s) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    uint64_t most = s->problem->options->prove_work;
    while (s->bound < s->count && !s->ended && s->scene.work < most &&
           !starg_time_is_over(context)) {
        row_list list = {0};
        starg_progress_step(context, s->scene.work, most);
        STARG_TRY(starg_check_cancel(context, STAGE));
        status = row_list_make(context, 2 * s->points.count, &list);
        if (status == STARG_OK)
            status = run_round(s, &list);
        row_list_free(context, &list);
        STARG_TRY(status);
    }
    if (s->bound < s->count)
        STARG_TRY(prove(s));
done:
    return status;
}

static starg_status begin(search *s, const guard_selection *selection) {
    starg_status status = STARG_OK;
    const guard_problem *p = s->problem;
    s->count = selection->chosen.count;
    s->bound = s->count > 0;
    STARG_TRY(search_scene_open(p->context, p->solid, &p->options->visibility,
                                p->options->clearance, &s->scene));
    STARG_NEW_ZERO(p->context, STAGE, s->wanted, starg_bit_words(s->pool->columns));
    for (size_t i = 0; i < s->count; i++)
        for (size_t w = 0; w < s->pool->rows->words; w++)
            s->wanted[w] |= starg_bits_row(s->pool->rows, selection->chosen.data[i])[w];
    STARG_TRY(begin_points(s));
    STARG_TRY(cells_begin(&s->scene, &s->cells));
    STARG_TRY(find_first_witnesses(s));
done:
    return status;
}

static void end(search *s) {
    starg_context *context = context_of(s);
    prices_free(context, &s->prices);
    STARG_ARRAY_FREE(context, &s->cells);
    STARG_ARRAY_FREE(context, &s->points);
    STARG_ARRAY_FREE(context, &s->guards);
    starg_release(context, s->wanted);
    search_scene_close(&s->scene);
}

/* The pool with the new guards in it, and the choice among all of it. */
static starg_status join_guards(search *s, guard_pool *pool, guard_selection *selection) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    candidate_points found = {0};
    starg_cover *cover = NULL;
    guard_selection next = {0};
    const choice how = {.method = STARG_COVER_ILP, .max_nodes = s->problem->options->max_nodes};
    for (size_t i = 0; i < s->count; i++)
        STARG_TRY(candidates_push(context, &found, s->guards.data + 3 * i, NULL));
    STARG_TRY(pool_add(pool, &found));
    STARG_TRY(choose_candidates(pool, &s->problem->weights, &how, &cover));
    STARG_TRY(selection_of_cover(context, cover, selection, selection->level, &next));
    selection_free(context, selection);
    *selection = next;
    next = (guard_selection){0};
done:
    selection_free(context, &next);
    candidates_free(context, &found);
    starg_cover_free(cover);
    return status;
}

starg_status search_guards(const guard_problem *problem, guard_pool *pool,
                           guard_selection *selection, search_record *out) {
    starg_status status = STARG_OK;
    search s = {.problem = problem, .pool = pool};
    starg_progress_begin(problem->context, STAGE);
    STARG_TRY(begin(&s, selection));
    STARG_TRY(run(&s));
    selection->time_limited = selection->time_limited || starg_time_is_over(problem->context);
    if (s.better)
        STARG_TRY(join_guards(&s, pool, selection));
    *out = (search_record){s.bound, s.cells.count, s.scene.witnesses.count, s.scene.work};
    if (selection->lower_bound < s.bound)
        selection->lower_bound = s.bound;
done:
    end(&s);
    starg_progress_end(problem->context);
    return status;
}
