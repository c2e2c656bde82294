/* SPDX-License-Identifier: Apache-2.0 */
/* Cells: the space in which guards may stand, cut into boxes, each with the witnesses that it may
 * see, by visibility/box.h.
 *
 * The root is the box of the solid, rounded outwards to multiples of a power of two. It is cut by
 * parts of the solid first: no point sees witnesses of two parts, so bounds for parts add up. Then
 * a cell is cut in the middle of its longest side, and what is outside is trimmed off at multiples
 * of a fraction of the side, so that corners of cells are short binary fractions. Cells are
 * numbered in the order of creation, and tested by guard/cell_tests.c.
 *
 * Invariant: no point of a cell in the free space sees a witness that is not open in the cell. */
#include "guard/cells.h"

#include <math.h>
#include <stdlib.h>

#include "geometry/vec3.h"

static const char STAGE[] = "search";

enum { ROOT_BITS = 20, LEAST_BATCH = 32, MOST_BATCH = 2048 };

static double middle(const bvh_box *box, int k) {
    return 0.5 * box->lower[k] + 0.5 * box->upper[k];
}

/* Halves the parts of cells until each leaf is for one. */
static starg_status cut_by_parts(starg_context *context, search_cells *cells) {
    for (size_t i = 0; i < cells->count; i++) {
        search_cell halves[2] = {cells->data[i], cells->data[i]};
        uint32_t parts = halves[0].end_part - halves[0].first_part;
        if (parts < 2)
            continue;
        halves[0].end_part = halves[1].first_part = halves[0].first_part + parts / 2;
        cells->data[i].parted = true;
        cells->data[i].children = (uint32_t)cells->count;
        PUSH(context, STAGE, cells, halves[0]);
        PUSH(context, STAGE, cells, halves[1]);
    }
    return STARG_OK;
}

starg_status cells_begin(const search_scene *scene, search_cells *cells) {
    bvh_box reach;
    solid_reach(scene->solid, &reach);
    const bvh_box *all = &reach;
    search_cell root = {.box = reach, .end_part = (uint32_t)scene->parts.count};
    double extent = 0;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, all->upper[k] - all->lower[k]);
    int exponent;
    frexp(extent, &exponent);
    double unit = ldexp(1, exponent - ROOT_BITS);
    for (int k = 0; k < 3; k++) {
        double lower = floor(all->lower[k] / unit) * unit,
               upper = ceil(all->upper[k] / unit) * unit;
        if (lower <= all->lower[k])
            root.box.lower[k] = lower;
        if (upper >= all->upper[k])
            root.box.upper[k] = upper;
    }
    PUSH(scene->context, STAGE, cells, root);
    return cut_by_parts(scene->context, cells);
}

int cell_cut_axis(const bvh_box *box) {
    int longest = 0;
    for (int k = 1; k < 3; k++)
        if (box->upper[k] - box->lower[k] > box->upper[longest] - box->lower[longest])
            longest = k;
    return longest;
}

double cell_length(const bvh_box *box) {
    int k = cell_cut_axis(box);
    return box->upper[k] - box->lower[k];
}

bool cell_splits(const bvh_box *box) {
    int k = cell_cut_axis(box);
    double at = middle(box, k);
    return at > box->lower[k] && at < box->upper[k];
}

bvh_box cell_half(const bvh_box *box, bool upper) {
    bvh_box part = *box;
    int k = cell_cut_axis(box);
    if (upper)
        part.lower[k] = middle(box, k);
    else
        part.upper[k] = middle(box, k);
    return part;
}

/* ---- testing more witnesses ---- */

typedef STARG_ARRAY(uint32_t) numbers;

static bool sees_any(const search_cell *cell, const witness_row *among) {
    uint64_t any = 0;
    for (int w = 0; w < WITNESS_WORDS; w++)
        any |= cell->open.bits[w] & among->bits[w];
    return any != 0;
}

/* Leaves of what a cell may see what is of its parts. */
static void keep_parts(const search_scene *scene, const search_cell *cell, witness_row *row) {
    if (cell->end_part - cell->first_part == scene->parts.count)
        return;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w]) {
            uint32_t part = search_scene_part(scene, scene->witnesses.data[64 * w + bit]);
            if (part < cell->first_part || part >= cell->end_part)
                starg_bit_clear(row->bits, 64 * w + bit);
        }
}

/* What holds all of the solid may see all of it, so that it need not be tested. */
static bool holds_all(const search_scene *scene, const bvh_box *box) {
    const bvh_box *all = &scene->solid->tree->nodes[0].box;
    bool holds = true;
    for (int k = 0; k < 3; k++)
        holds = holds && box->lower[k] <= all->lower[k] && box->upper[k] >= all->upper[k];
    return holds;
}

/* Tests cells of a generation against what their parents may see. */
static starg_status look_from_cells(const search_scene *scene, search_cells *cells,
                                    const numbers *list, const numbers *parents,
                                    const witness_row *among, uint64_t *work) {
    starg_context *context = scene->context;
    SCOPED cell_test *tests = NULL;
    SCOPED cell_answer *answers = NULL;
    NEW(context, STAGE, tests, list->count);
    NEW(context, STAGE, answers, list->count);
    for (size_t i = 0; i < list->count; i++) {
        search_cell *cell = &cells->data[list->data[i]];
        witness_row asked = *among;
        if (parents->data[i] != UINT32_MAX)
            for (int w = 0; w < WITNESS_WORDS; w++)
                asked.bits[w] &= cells->data[parents->data[i]].open.bits[w];
        keep_parts(scene, cell, &asked);
        const bool inherits = cell->trimmed || cell->parted || holds_all(scene, &cell->box);
        for (int w = 0; w < WITNESS_WORDS && inherits; w++)
            cell->open.bits[w] |= asked.bits[w];
        tests[i] = (cell_test){cell->box, inherits ? (witness_row){{0}} : asked};
    }
    cell_tests all = {.scene = scene, .tests = tests, .count = list->count, .answers = answers};
    TRY(cell_tests_share(context, &all));
    for (size_t i = 0; i < list->count; i++) {
        for (int w = 0; w < WITNESS_WORDS; w++)
            cells->data[list->data[i]].open.bits[w] |= answers[i].open.bits[w];
        *work += answers[i].work + 1;
    }
    return STARG_OK;
}

/* One generation after the other. */
starg_status cells_look(const search_scene *scene, search_cells *cells, size_t first,
                        uint64_t *work) {
    starg_context *context = scene->context;
    SCOPED numbers list = {0}, parents = {0}, next = {0}, next_parents = {0};
    const witness_row among = search_scene_witnesses(scene, first);
    PUSH(context, STAGE, &list, 0);
    PUSH(context, STAGE, &parents, UINT32_MAX);
    while (list.count > 0) {
        TRY(look_from_cells(scene, cells, &list, &parents, &among, work));
        next.count = next_parents.count = 0;
        for (size_t i = 0; i < list.count; i++) {
            const search_cell *cell = &cells->data[list.data[i]];
            for (uint32_t k = 0; k < 2 && cell->children != 0 && sees_any(cell, &among); k++) {
                PUSH(context, STAGE, &next, cell->children + k);
                PUSH(context, STAGE, &next_parents, list.data[i]);
            }
        }
        numbers done_list = list, done_parents = parents;
        list = next;
        parents = next_parents;
        next = done_list;
        next_parents = done_parents;
    }
    return STARG_OK;
}

/* ---- splitting ---- */

/* The cuts become cells within the cell; the last one is what was tested. */
static starg_status trim(starg_context *context, search_cells *cells, size_t number,
                         const cell_answer *answer) {
    for (int64_t i = 0; i < answer->cut_count; i++) {
        const box_cut *cut = &answer->cuts[i];
        search_cell parts[2] = {cells->data[number], cells->data[number]};
        parts[0].box.upper[cut->axis] = parts[1].box.lower[cut->axis] = cut->at;
        parts[cut->above].open = (witness_row){{0}};
        if (i + 1 == answer->cut_count)
            parts[!cut->above].open = answer->open;
        PUSH(context, STAGE, cells, parts[0]);
        PUSH(context, STAGE, cells, parts[1]);
        cells->data[number].children = (uint32_t)(cells->count - 2);
        cells->data[number].trimmed = true;
        number = cells->count - 1 - cut->above;
    }
    return STARG_OK;
}

starg_status cells_split(const search_scene *scene, search_cells *cells, const uint32_t *leaves,
                         size_t count, int tries, search_points *points, uint64_t *work) {
    starg_context *context = scene->context;
    SCOPED cell_test *tests = NULL;
    SCOPED cell_answer *answers = NULL;
    SCOPED search_point *found = NULL;
    NEW(context, STAGE, tests, 2 * count);
    NEW(context, STAGE, answers, 2 * count);
    NEW(context, STAGE, found, 2 * count * (size_t)tries);
    for (size_t i = 0; i < 2 * count; i++) {
        const search_cell *whole = &cells->data[leaves[i / 2]];
        tests[i] = (cell_test){cell_half(&whole->box, i % 2 != 0), whole->open};
    }
    cell_tests all = {.scene = scene,
                      .tests = tests,
                      .count = 2 * count,
                      .first = cells->count,
                      .tries = tries,
                      .answers = answers,
                      .points = found};
    TRY(cell_tests_share(context, &all));
    for (size_t i = 0; i < all.count; i++) {
        const bool trimmed = answers[i].cut_count > 0;
        const search_cell *whole = &cells->data[leaves[i / 2]];
        const search_cell half = {.box = tests[i].box,
                                  .first_part = whole->first_part,
                                  .end_part = whole->end_part,
                                  .open = trimmed ? tests[i].among : answers[i].open};
        PUSH(context, STAGE, cells, half);
        if (i % 2 != 0) /* only after the second child: a cell has both children or none */
            cells->data[leaves[i / 2]].children = (uint32_t)(cells->count - 2);
        for (size_t k = 0; k < answers[i].point_count; k++)
            PUSH(context, STAGE, points, found[i * (size_t)tries + k]);
        *work += answers[i].work + 2;
    }
    for (size_t i = 0; i < all.count; i++)
        TRY(trim(scene->context, cells, all.first + i, &answers[i]));
    return STARG_OK;
}

int cells_by_score(const void *a, const void *b) {
    const scored_leaf *x = a, *y = b;
    if (x->score != y->score)
        return x->score > y->score ? -1 : 1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

starg_status cells_split_best(const search_scene *scene, search_cells *cells, leaf_list *list,
                              int tries, search_points *points, bool *any, uint64_t *work) {
    SCOPED uint32_t *leaves = NULL;
    size_t first = points->count, chosen = 0, batch = list->count / 4;
    batch = batch < LEAST_BATCH ? LEAST_BATCH : batch > MOST_BATCH ? MOST_BATCH : batch;
    NEW(scene->context, STAGE, leaves, batch);
    qsort(list->data, list->count, sizeof *list->data, cells_by_score);
    for (size_t i = 0; i < list->count && chosen < batch; i++)
        if (cell_splits(&cells->data[list->data[i].cell].box))
            leaves[chosen++] = list->data[i].cell;
    *any = chosen > 0;
    TRY(cells_split(scene, cells, leaves, chosen, tries, points, work));
    points_prune(points, first, work);
    return STARG_OK;
}
