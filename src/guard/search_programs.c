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
#include "guard/certificate.h"
#include "guard/search_parts.h"
#include "starguard/cover.h"

static const char STAGE[] = "search";

enum { BRANCHES = 300, FOLLOWED = 16, ASKING_SHARE = 4 };

/* Measured costs of an integer program, in tests of a witness: a row in ROWS_SHARE, the root of
 * branch and bound, another node. */
enum { ROWS_SHARE = 8, ROOT_ROWS = 2000, NODE_ROWS = 32 };

static const double ROUNDING = 1e-6;

static starg_status make_program(const search *s, const row_list *list, starg_bits **out) {
    starg_status status =
        starg_bits_create(context_of(s), list->count, s->scene.witnesses.count, out);
    for (size_t i = 0; status == STARG_OK && i < list->count; i++)
        memcpy(starg_bits_row_mutable(*out, i), list->rows[i]->bits,
               (*out)->words * sizeof(uint64_t));
    return status;
}

/* Points worth at least `least` that see what no other of them does. */
static void list_needed(const search *s, double least, row_list *list) {
    const witness_row all = all_witnesses(s);
    list->count = 0;
    for (size_t i = 0; i < s->points.count; i++) {
        const witness_row *seen = &s->points.data[i].seen;
        if (search_worth(s, seen) >= least && !is_needless(list, seen, &all))
            row_list_add(s, list, i);
    }
}

/* Points that may be among fewer guards: together they are worth as much as all witnesses, and none
 * of the others exceeds the most valuable point. */
static void list_useful(const search *s, row_list *list) {
    double most = search_largest_value(s);
    list_needed(s, search_value(s) - ((double)s->count - 2) * most - ROUNDING, list);
}

/* What an integer program costs, as far as rows, witnesses and nodes tell. */
static uint64_t cost_of(const starg_bits *rows, const starg_cover *cover) {
    size_t branching = cover->nodes > 0 ? ROOT_ROWS + NODE_ROWS * cover->nodes : 0;
    return (rows->rows / ROWS_SHARE + branching) * rows->columns;
}

/* Solves the cover problem of the rows: how few see all witnesses often enough? */
static starg_status solve(search *s, const starg_bits *rows, starg_cover **out) {
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = rows;
    problem.redundancy = (uint32_t)s->redundancy;
    options.max_nodes = s->nodes;
    if (guard_is_brief(s->problem->options))
        options.method = STARG_COVER_LOCAL;
    starg_status status = starg_cover_solve(context_of(s), &problem, &options, out);
    if (status == STARG_OK)
        s->scene.work += cost_of(rows, *out);
    return status;
}

/* The integer program over the points: do fewer guards see all witnesses? *changed: there are
 * better guards, or more witnesses. */
starg_status search_ask_points(search *s, bool *changed) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    starg_bits *rows = NULL;
    starg_cover *cover = NULL;
    row_list list = {0};
    uint64_t before = s->scene.work;
    *changed = false;
    STARG_TRY(row_list_make(context, s->points.count, &list));
    list_useful(s, &list);
    STARG_TRY(make_program(s, &list, &rows));
    STARG_TRY(solve(s, rows, &cover));
    s->asked_at = s->cells.count;
    s->ask_after = s->scene.work + ASKING_SHARE * (s->scene.work - before);
    s->asked_of = s->scene.witnesses.count;
    size_t bound = cover->lower_bound < s->count ? cover->lower_bound : s->count;
    s->known = bound > s->known ? bound : s->known;
    if (cover->count < s->count) {
        for (size_t k = 0; k < cover->count; k++)
            cover->rows[k] = list.points[cover->rows[k]];
        STARG_TRY(search_try_guards(s, cover->rows, cover->count, changed));
    }
done:
    row_list_free(context, &list);
    starg_cover_free(cover);
    starg_bits_free(rows);
    return status;
}

/* The candidates that may be among fewer guards, as in `list_useful`, but dominated ones stay: a
 * dominating candidate may see less outside the witnesses. */
static void list_useful_candidates(const search *s, uint32_t *list, size_t *count) {
    double most = search_largest_value(s);
    double least = search_value(s) - ((double)s->count - 2) * most - ROUNDING;
    *count = 0;
    for (size_t i = 0; i < s->points.count; i++)
        if (s->points.data[i].candidate != UINT32_MAX &&
            search_worth(s, &s->points.data[i].seen) >= least)
            list[(*count)++] = (uint32_t)i;
}

starg_status search_ask_candidates(search *s) {
    starg_context *context = context_of(s);
    const starg_bits *all = s->pool->rows;
    starg_cover_problem problem;
    starg_cover_options options;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    SCOPED_BY(starg_cover_drop) starg_cover *cover = NULL;
    SCOPED uint32_t *list = NULL;
    size_t count;
    bool changed;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    NEW(context, STAGE, list, s->points.count);
    list_useful_candidates(s, list, &count);
    TRY(starg_bits_create(context, count, all->columns, &rows));
    for (size_t k = 0; k < count; k++)
        memcpy(starg_bits_row_mutable(rows, k),
               starg_bits_row(all, s->points.data[list[k]].candidate),
               all->words * sizeof *all->data);
    problem.rows = rows;
    problem.redundancy = (uint32_t)s->redundancy;
    options.max_nodes = s->problem->options->max_nodes;
    if (guard_is_brief(s->problem->options))
        options.method = STARG_COVER_LOCAL;
    TRY(starg_cover_solve(context, &problem, &options, &cover));
    size_t bound = cover->lower_bound < s->count ? cover->lower_bound : s->count;
    for (size_t k = 0; k < cover->count; k++)
        cover->rows[k] = list[cover->rows[k]];
    if (cover->count < s->count)
        TRY(search_try_guards(s, cover->rows, cover->count, &changed));
    s->asked_pool = pool_count(s->pool);
    s->asked_bound = bound;
    return STARG_OK;
}

/* ---- cells and points ---- */

/* Columns of the program that no other one contains. Leaves that see no more than a point does are
 * settled, and the point represents them. */
typedef struct column_list {
    row_list rows;
    uint32_t *cells; /* by column: the leaf, or UINT32_MAX for a point */
} column_list;

static starg_status list_columns(const search *s, column_list *out) {
    size_t most = s->points.count + s->cells.count, hint = 0;
    TRY(row_list_make(context_of(s), most, &out->rows));
    NEW(context_of(s), STAGE, out->cells, most);
    list_needed(s, 0, &out->rows);
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
    return STARG_OK;
}

/* Unsettled leaves that could replace a chosen column: they may see everything that only it
 * sees. */
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
done:
    starg_release(context_of(s), listed);
    return status;
}

/* Fewer columns than guards cover all witnesses: splits their leaves, or tries them if all are
 * points. */
static starg_status follow_cover(search *s, const column_list *columns, starg_cover *cover,
                                 bool *changed, bool *again) {
    starg_status status = STARG_OK;
    scored_leaf *leaves = NULL;
    size_t count;
    STARG_TRY(list_stand_ins(s, columns, cover, &leaves, &count));
    *changed = *again = count > 0;
    for (size_t c = 0; c < cover->count && count == 0; c++)
        cover->rows[c] = columns->rows.points[cover->rows[c]];
    if (count > 0)
        STARG_TRY(search_split(s, leaves, count, MOST_TRIES));
    else
        STARG_TRY(search_try_guards(s, cover->rows, cover->count, changed));
done:
    starg_release(context_of(s), leaves);
    return status;
}

/* The integer program over cells and points. If fewer columns than guards cover all witnesses,
 * follows this solution; otherwise branching proves the bound. */
static starg_status ask_cells_once(search *s, bool *changed, bool *again) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    column_list columns = {0};
    starg_bits *rows = NULL;
    starg_cover *cover = NULL;
    bool proven = false;
    branch_record branches = {0};
    const witness_row all = all_witnesses(s);
    *again = false;
    STARG_TRY(list_columns(s, &columns));
    STARG_TRY(make_program(s, &columns.rows, &rows));
    STARG_TRY(solve(s, rows, &cover));
    if (cover->count < s->count)
        STARG_TRY(follow_cover(s, &columns, cover, changed, again));
    else if (s->redundancy == 1)
        STARG_TRY(bound_by_branching(
            context, columns.rows.rows, columns.rows.count, &all, s->count - 1, BRANCHES, &proven,
            s->problem->certificate != NULL ? &branches : NULL, &s->scene.work));
    if (proven) {
        s->bound = s->count;
        STARG_TRY(certificate_note_rows(context, s->problem->certificate, s->bound,
                                        columns.rows.rows, columns.rows.count, &branches));
    }
done:
    branch_record_free(&branches);
    row_list_free(context, &columns.rows);
    starg_release(context, columns.cells);
    starg_cover_free(cover);
    starg_bits_free(rows);
    return status;
}

starg_status search_ask_cells(search *s, bool *changed) {
    bool again = true;
    *changed = false;
    for (int k = 0; k < FOLLOWED && again; k++)
        TRY(ask_cells_once(s, changed, &again));
    return STARG_OK;
}
