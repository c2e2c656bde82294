/* SPDX-License-Identifier: Apache-2.0 */
/* The integer programs of a search, over its points and over its cells.
 *
 * A program over points with a solution smaller than the number of guards gives better guards or
 * faces that become witnesses. One over cells and points shows where such guards could still stand:
 * in the chosen cells, or in others that may see what only one of them sees. These are split, with
 * more points, until points do as well or no cells would suffice. What the solver finds is checked;
 * that no solution exists is proven by branching (guard/bound.c). */
#include <math.h>
#include <stdlib.h>

#include "geometry/vec3.h"
#include "guard/prices.h"
#include "guard/search_parts.h"
#include "starguard/cover.h"

static const char STAGE[] = "search";

enum { BRANCHES = 300, FOLLOWED = 16, ASKING_SHARE = 4 };

/* Measured costs of an integer program, in tests of a witness: a row in ROWS_SHARE, the root of
 * branch and bound, another node. */
enum { ROWS_SHARE = 8, ROOT_ROWS = 2000, NODE_ROWS = 32 };

static const double ROUNDING = 1e-6;

/* Points worth at least `least` that see what no other of them does. */
static starg_status list_needed(const search_duals *d, double least, row_list *list) {
    const witness_row all = search_scene_witnesses(&d->witnesses->scene, 0);
    list->count = 0;
    for (size_t i = 0; i < d->points->count; i++) {
        const witness_row *seen = &d->points->data[i].seen;
        if (duals_of_row(d, seen) >= least && !row_list_holds(list, seen, &all))
            TRY(row_list_add(list, seen, i));
    }
    return STARG_OK;
}

/* The least value of points that may be among fewer guards: together they are worth as much as all
 * witnesses, and none of the others exceeds the most valuable point. */
static double least_useful(const search *s) {
    double others = (double)s->best.guards.count - 2;
    return duals_value(&s->duals) - others * duals_of_best_point(&s->duals) - ROUNDING;
}

/* Solves the cover problem of the rows: how few see all columns often enough? */
static starg_status solve(const search *s, const starg_bits *rows, size_t nodes,
                          starg_cover **out) {
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = rows;
    problem.redundancy = s->problem->options->redundancy;
    options.max_nodes = nodes;
    if (guard_is_brief(s->problem->options))
        options.method = STARG_COVER_LOCAL;
    return starg_cover_solve(s->problem->context, &problem, &options, out);
}

/* The same for the witnesses. What it costs is counted as far as rows, witnesses and nodes tell. */
static starg_status solve_list(search *s, const row_list *list, starg_cover **out) {
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    TRY(starg_bits_create(s->problem->context, list->count, s->witnesses.scene.witnesses.count,
                          &rows));
    for (size_t i = 0; i < list->count; i++)
        memcpy(starg_bits_row_mutable(rows, i), list->rows[i]->bits,
               rows->words * sizeof *rows->data);
    TRY(solve(s, rows, s->effort.nodes, out));
    size_t branching = (*out)->nodes > 0 ? ROOT_ROWS + NODE_ROWS * (*out)->nodes : 0;
    s->effort.work += (rows->rows / ROWS_SHARE + branching) * rows->columns;
    return STARG_OK;
}

/* Tries the rows of a cover, of which `points` says what they are, if they are fewer than guards.
 */
static starg_status try_cover(search *s, starg_cover *cover, const uint32_t *points,
                              bool *changed) {
    if (cover->count >= s->best.guards.count)
        return STARG_OK;
    for (size_t k = 0; k < cover->count; k++)
        cover->rows[k] = points[cover->rows[k]];
    return search_try_guards(s, cover->rows, cover->count, changed);
}

starg_status search_ask_points(search *s, bool *changed) {
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    SCOPED_BY(row_list_free) row_list list = {0};
    uint64_t before = s->effort.work;
    *changed = false;
    TRY(row_list_make(&s->duals, &list));
    TRY(list_needed(&s->duals, least_useful(s), &list));
    TRY(solve_list(s, &list, &cover));
    s->asked.cells = s->cells.count;
    s->asked.after = s->effort.work + ASKING_SHARE * (s->effort.work - before);
    s->asked.witnesses = s->witnesses.scene.witnesses.count;
    size_t guards = s->best.guards.count;
    points_raise_bound(&s->points, cover->lower_bound < guards ? cover->lower_bound : guards);
    return try_cover(s, cover, list.names, changed);
}

/* Unlike those of `list_needed`, candidates stay that others dominate: a dominating one may see
 * less outside the witnesses. */
static starg_status ask_candidates(search *s) {
    const search_points *points = &s->points;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    SCOPED uint32_t *list = NULL, *of_pool = NULL;
    size_t count = 0;
    bool changed;
    double least = least_useful(s);
    NEW(s->problem->context, STAGE, list, points->count);
    NEW(s->problem->context, STAGE, of_pool, points->count);
    for (size_t i = 0; i < points->count; i++)
        if (points->data[i].candidate != UINT32_MAX &&
            duals_of_row(&s->duals, &points->data[i].seen) >= least) {
            of_pool[count] = points->data[i].candidate;
            list[count++] = (uint32_t)i;
        }
    TRY(pool_copy_rows(s->pool, of_pool, count, &rows));
    TRY(solve(s, rows, s->problem->options->max_nodes, &cover));
    size_t guards = s->best.guards.count;
    s->asked.bound = cover->lower_bound < guards ? cover->lower_bound : guards;
    TRY(try_cover(s, cover, list, &changed));
    s->asked.candidates = pool_count(s->pool);
    return STARG_OK;
}

starg_status search_ask_candidates(search *s) {
    if (pool_count(s->pool) > s->asked.candidates)
        TRY(ask_candidates(s));
    points_raise_bound(&s->points, s->asked.bound);
    return STARG_OK;
}

/* ---- cells and points ---- */

/* Rows that no other one contains. Leaves that see no more than a point does are settled, and the
 * point represents them. */
static starg_status list_all(const search *s, row_list *list) {
    const witness_row all = search_scene_witnesses(&s->witnesses.scene, 0);
    TRY(list_needed(&s->duals, 0, list));
    for (size_t i = 0; i < s->cells.count; i++) {
        const search_cell *cell = &s->cells.data[i];
        if (cell->children == 0 && !row_list_holds(list, &cell->open, &all))
            TRY(row_list_add(list, &cell->open, ROW_LEAF + i));
    }
    return STARG_OK;
}

/* Unsettled leaves that could replace a chosen row: they may see everything that only it sees. */
static starg_status list_stand_ins(const search *s, const row_list *list, const starg_cover *cover,
                                   leaf_list *out) {
    SCOPED uint8_t *listed = NULL;
    NEW_ZERO(s->problem->context, STAGE, listed, list->count);
    for (size_t c = 0; c < cover->count; c++) {
        witness_row alone = *list->rows[cover->rows[c]];
        for (size_t o = 0; o < cover->count; o++)
            for (int w = 0; o != c && w < WITNESS_WORDS; w++)
                alone.bits[w] &= ~list->rows[cover->rows[o]]->bits[w];
        for (size_t k = 0; k < list->count; k++) {
            if (list->names[k] < ROW_LEAF || listed[k] || !row_is_within(&alone, list->rows[k]))
                continue;
            uint32_t cell = list->names[k] - ROW_LEAF;
            const bvh_box *box = &s->cells.data[cell].box;
            double size = vec3_distance(box->lower, box->upper);
            const scored_leaf leaf = {k == cover->rows[c] ? INFINITY : size, cell};
            PUSH(s->problem->context, STAGE, out, leaf);
            listed[k] = 1;
        }
    }
    return STARG_OK;
}

/* Fewer rows than guards cover all witnesses: splits their leaves, or tries them if all are
 * points. */
static starg_status follow_cover(search *s, const row_list *list, starg_cover *cover, bool *changed,
                                 bool *again) {
    SCOPED leaf_list leaves = {0};
    bool any;
    TRY(list_stand_ins(s, list, cover, &leaves));
    *changed = *again = leaves.count > 0;
    return leaves.count > 0 ? cells_split_best(&s->witnesses.scene, &s->cells, &leaves, MOST_TRIES,
                                               &s->points, &any, &s->effort.work)
                            : try_cover(s, cover, list->names, changed);
}

/* If fewer rows than guards cover all witnesses, follows this solution; otherwise branching proves
 * the bound. */
static starg_status ask_cells_once(search *s, bool *changed, bool *again) {
    starg_context *context = s->problem->context;
    guard_certificate *why = s->problem->certificate;
    SCOPED_BY(row_list_free) row_list list = {0};
    SCOPED_BY(branch_record_free) branch_record branches = {0};
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    const size_t guards = s->best.guards.count;
    const witness_row all = search_scene_witnesses(&s->witnesses.scene, 0);
    bool proven = false;
    *again = false;
    TRY(row_list_make(&s->duals, &list));
    TRY(list_all(s, &list));
    TRY(solve_list(s, &list, &cover));
    if (cover->count < guards)
        return follow_cover(s, &list, cover, changed, again);
    const branch_question question = {list.rows, list.count, &all, guards - 1, BRANCHES};
    if (s->witnesses.redundancy == 1)
        TRY(bound_by_branching(context, &question, &proven, why != NULL ? &branches : NULL,
                               &s->effort.work));
    if (proven && incumbent_raise(&s->best, guards))
        TRY(certificate_note_rows(context, why, guards, list.rows, list.count, &branches));
    return STARG_OK;
}

starg_status search_ask_cells(search *s, bool *changed) {
    bool again = true;
    *changed = false;
    for (int k = 0; k < FOLLOWED && again; k++)
        TRY(ask_cells_once(s, changed, &again));
    return STARG_OK;
}
