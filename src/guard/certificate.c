/* SPDX-License-Identifier: Apache-2.0 */
/* The certificate of a bound for guards anywhere: docs/formats.md specifies the text,
 * docs/verification.md explains why it suffices.
 *
 * A search remembers only what proved its bound: prices, or rows of witnesses and the branching.
 * Everything else is recomputed from the final tree of cells:
 *   1. the coarsest sufficient tree: from the root down, a cell becomes a leaf as soon as the total
 *      price of the witnesses that it may see is small enough, or these lie in one of the rows;
 *   2. for each of its cells, the reasons why it does not see witnesses that its parent may see
 *      (visibility/box.h), in parallel; reasons do not depend on earlier tests;
 *   3. the text, in the order of the tree.
 *
 * Invariant: a leaf may see exactly the witnesses that no reason of it or of an ancestor removes.
 * Cost: about that of the search's box tests that ended in "hidden". */
#include "guard/prices.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/checksum.h"
#include "core/file.h"
#include "core/parallel.h"
#include "guard/cells.h"

static const char STAGE[] = "certificate";

void certificate_free(guard_certificate *why) {
    RELEASE(why->proof.rows.data);
    branch_record_free(&why->proof.branches);
    RELEASE(why->text);
    *why = (guard_certificate){0};
}

/* ---- the proof of the bound ---- */

void certificate_note_prices(guard_certificate *why, size_t bound, const whole_prices *prices) {
    if (why == NULL || bound <= why->proof.bound)
        return;
    why->proof.bound = bound;
    why->proof.rows.count = 0;
    why->proof.prices = *prices;
}

starg_status certificate_note_rows(starg_context *context, guard_certificate *why, size_t bound,
                                   const witness_row *const *rows, size_t count,
                                   branch_record *branches) {
    if (why == NULL || bound <= why->proof.bound)
        return STARG_OK;
    bound_proof *proof = &why->proof;
    proof->bound = bound;
    proof->rows.count = 0;
    for (size_t i = 0; i < count; i++)
        PUSH(context, STAGE, &proof->rows, *rows[i]);
    branch_record_free(&proof->branches);
    proof->branches = *branches;
    *branches = (branch_record){0};
    return STARG_OK;
}

/* ---- the tree ---- */

/* A cell of the certificate, numbered as among the cells of the search. */
typedef struct kept_cell {
    uint32_t number;
    uint32_t around; /* the number of its parent; UINT32_MAX: the root */
    uint32_t row;    /* of a leaf: the row that contains it, if there are rows */
    bool leaf;
    bool outside;        /* no point of it is in the free space */
    bool barred;         /* all points of it are too close to the boundary */
    size_t first, count; /* of the reasons */
} kept_cell;

/* The kind of a reason beside those of a box: the witness is of another part of the solid. */
enum { APART = BOX_KINDS };

typedef struct stored_reason {
    uint32_t vertex, seed;
    uint16_t witness;
    uint8_t kind;
    bool clipped;
} stored_reason;

typedef struct making {
    const search_scene *scene; /* first member, as cells_worker_make requires */
    const search_cells *cells;
    const bound_proof *proof;
    const starg_guard_options *options;
    witness_row wanted;              /* witnesses that the proof uses */
    uint32_t number[MOST_WITNESSES]; /* the number of each in the text */
    uint64_t most;                   /* largest total price of a leaf */
    size_t hint;                     /* a row */
    STARG_ARRAY(kept_cell) kept;     /* parents before children */
    stored_reason *reasons;
} making;

static void want_priced(making *m) {
    const whole_prices *prices = &m->proof->prices;
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        if (prices->price[j] > 0)
            starg_bit_set(m->wanted.bits, j);
    for (size_t k = 0; k < prices->sets.count; k++)
        for (size_t i = 0; i < prices->sets.set[k].count && prices->odd[k] > 0; i++)
            starg_bit_set(m->wanted.bits, prices->sets.set[k].witness[i]);
}

static void begin(making *m) {
    uint32_t count = 0;
    if (m->proof->rows.count > 0)
        m->wanted = search_scene_witnesses(m->scene, 0);
    else {
        want_priced(m);
        m->most = (bound_worth_of_all(&m->proof->prices, m->options->redundancy) - 1) /
                  (m->proof->bound - 1);
    }
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, m->wanted.bits[w])
            m->number[64 * w + bit] = count++;
}

static bool is_cheap(const making *m, const witness_row *open) {
    return bound_worth(&m->proof->prices, open) <= m->most;
}

/* The row that contains the witnesses, starting with that of the last call; or UINT32_MAX. */
static uint32_t row_around(making *m, const witness_row *open) {
    const witness_row *rows = m->proof->rows.data;
    if (row_is_within(open, &rows[m->hint]))
        return (uint32_t)m->hint;
    for (size_t i = 0; i < m->proof->rows.count; i++)
        if (row_is_within(open, &rows[i])) {
            m->hint = i;
            return (uint32_t)i;
        }
    return UINT32_MAX;
}

static kept_cell judge(making *m, uint32_t number, uint32_t around) {
    const search_cell *cell = &m->cells->data[number];
    kept_cell kept = {.number = number, .around = around, .row = UINT32_MAX};
    if (m->proof->rows.count > 0) {
        kept.row = row_around(m, &cell->open);
        kept.leaf = kept.row != UINT32_MAX;
    } else
        kept.leaf = is_cheap(m, &cell->open);
    kept.leaf = kept.leaf || cell->children == 0;
    return kept;
}

typedef struct pair {
    uint32_t number, around;
} pair;

static starg_status choose_cells(making *m) {
    starg_context *context = m->scene->context;
    SCOPED STARG_ARRAY(pair) stack = {0};
    PUSH(context, STAGE, &stack, ((pair){0, UINT32_MAX}));
    while (stack.count > 0) {
        pair next = stack.data[--stack.count];
        kept_cell kept = judge(m, next.number, next.around);
        uint32_t children = m->cells->data[next.number].children;
        PUSH(context, STAGE, &m->kept, kept);
        if (kept.leaf)
            continue;
        PUSH(context, STAGE, &stack, ((pair){children + 1, next.number}));
        PUSH(context, STAGE, &stack, ((pair){children, next.number}));
    }
    return STARG_OK;
}

/* ---- reasons ---- */

/* What the parent may see and the cell does not. */
static witness_row hidden_here(const making *m, const kept_cell *kept) {
    witness_row row = m->wanted;
    for (int w = 0; w < WITNESS_WORDS; w++) {
        if (kept->around != UINT32_MAX)
            row.bits[w] &= m->cells->data[kept->around].open.bits[w];
        row.bits[w] &= ~m->cells->data[kept->number].open.bits[w];
    }
    return row;
}

/* Does a cell see nothing of a witness, which is of a part that it is not for? */
static bool is_apart(const making *m, const search_cell *cell, size_t j) {
    if (cell->end_part - cell->first_part == m->scene->parts.count)
        return false;
    uint32_t part = search_scene_part(m->scene, m->scene->witnesses.data[j]);
    return part < cell->first_part || part >= cell->end_part;
}

static starg_status find_reasons(starg_context *context, void *shared, void *scratch, size_t item) {
    making *m = shared;
    kept_cell *kept = &m->kept.data[item];
    const search_scene *scene = m->scene;
    const search_cell *cell = &m->cells->data[kept->number];
    const witness_row hidden = hidden_here(m, kept);
    witness_row among = hidden;
    box_reason found[MOST_WITNESSES];
    witness_row open;
    size_t next = kept->first;
    const box_question question = {.box = cell->box,
                                   .target = scene->view->target,
                                   .targets = scene->witnesses.data,
                                   .count = scene->witnesses.count,
                                   .range = scene->view->range,
                                   .among = among.bits};
    (void)context;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, hidden.bits[w])
            if (is_apart(m, cell, 64 * w + bit))
                starg_bit_clear(among.bits, 64 * w + bit);
    kept->barred = search_scene_bars(scene, &question.box);
    if (kept->barred)
        return STARG_OK;
    box_look(scratch, &question, open.bits, found);
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, hidden.bits[w]) {
            const box_reason *r = &found[64 * w + bit];
            stored_reason *reason = &m->reasons[next++];
            *reason = (stored_reason){BOX_NONE, BOX_NONE, (uint16_t)(64 * w + bit), APART, false};
            if (!starg_bit_test(among.bits, 64 * w + bit))
                continue;
            kept->outside = kept->outside || r->kind == BOX_OUTSIDE;
            *reason = (stored_reason){r->vertex, r->seed, (uint16_t)(64 * w + bit),
                                      (uint8_t)r->kind, r->clipped};
        }
    return STARG_OK;
}

static starg_status find_all_reasons(making *m) {
    starg_context *context = m->scene->context;
    size_t count = 0;
    for (size_t i = 0; i < m->kept.count; i++) {
        const witness_row hidden = hidden_here(m, &m->kept.data[i]);
        m->kept.data[i].first = count;
        m->kept.data[i].count = starg_bit_count(hidden.bits, WITNESS_WORDS);
        count += m->kept.data[i].count;
    }
    NEW(context, STAGE, m->reasons, count);
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = m->kept.count,
                                      .shared = m,
                                      .item = find_reasons,
                                      .make_scratch = cells_worker_make,
                                      .free_scratch = cells_worker_free,
                                      .silent = true};
    return starg_parallel_for(context, &loop);
}

/* ---- the text ---- */

/* A double as an integer and a power of two, after a character. */
static void put_double(FILE *stream, char before, double x) {
    int exponent;
    long long whole = (long long)ldexp(frexp(x, &exponent), 53);
    for (exponent -= 53; whole != 0 && whole % 2 == 0; exponent++)
        whole /= 2;
    fprintf(stream, "%c%lld:%d", before, whole, whole == 0 ? 0 : exponent);
}

/* The first lines: the version, and what identifies the model. */
static void put_model(FILE *stream, int version, const starg_solid *solid) {
    const starg_mesh *mesh = solid->mesh;
    uint64_t sum = STARG_CHECKSUM_BEGIN;
    for (size_t f = 0; f < mesh->face_count; f++)
        sum = starg_checksum_face(sum, mesh->vertices, mesh->faces + 3 * f);
    fprintf(stream, "starguard-certificate %d\nvertices %zu\nfaces %zu\nchecksum %016llx\n",
            version, mesh->vertex_count, mesh->face_count, (unsigned long long)sum);
}

static void put_box(FILE *stream, const bvh_box *root) {
    fprintf(stream, "root");
    for (int k = 0; k < 3; k++)
        put_double(stream, ' ', root->lower[k]);
    for (int k = 0; k < 3; k++)
        put_double(stream, ' ', root->upper[k]);
    fprintf(stream, "\n");
}

typedef void put_all(FILE *stream, const void *what);

/* *text (`size` bytes and a zero) becomes what `put` writes. */
static starg_status write_text(starg_context *context, put_all *put, const void *what, char **text,
                               size_t *size) {
    starg_status status = STARG_OK;
    char *bytes = NULL;
    FILE *stream = open_memstream(&bytes, size);
    if (stream != NULL)
        put(stream, what);
    bool whole = stream != NULL && !ferror(stream);
    if (stream == NULL || fclose(stream) != 0 || !whole) {
        status = starg_fail_memory(context, STAGE);
        goto done;
    }
    STARG_NEW(context, STAGE, *text, *size + 1);
    memcpy(*text, bytes, *size + 1);
done:
    free(bytes);
    return status;
}

static void put_head(FILE *stream, const starg_solid *solid, const starg_guard_options *options,
                     const bvh_box *root, bool parted, size_t bound) {
    const starg_visibility_options *view = &options->visibility;
    put_model(stream, solid->patches != NULL ? 5 : parted ? 4 : 2, solid);
    fprintf(stream, "target %s\nrange",
            solid->patches != NULL                  ? "points"
            : view->target == STARG_TARGET_VERTICES ? "vertices"
            : view->target == STARG_TARGET_CORNERS  ? "corners"
                                                    : "faces");
    if (isinf(view->range))
        fprintf(stream, " none");
    else
        put_double(stream, ' ', view->range);
    fprintf(stream, "\nclearance");
    put_double(stream, ' ', options->clearance);
    fprintf(stream, "\nredundancy %u\nbound %zu\n", options->redundancy, bound);
    put_box(stream, root);
}

/* A point by its face, its weights by the vertices of this, and their binary logarithm. */
static void put_point(FILE *stream, const starg_solid *solid, uint32_t patch) {
    uint32_t face = solid->patches->face.data[patch], corner = solid->patches->corner.data[patch];
    const uint32_t *vertex = solid->mesh->faces + 3 * (size_t)face;
    const patch_point alone = {{corner, UINT32_MAX, UINT32_MAX}, {1, 0, 0}, 0};
    const patch_point *point =
        corner < solid->patches->vertex_count
            ? &alone
            : solid->patches->points.data + (corner - solid->patches->vertex_count);
    fprintf(stream, "%u", face);
    for (int k = 0; k < 3; k++) {
        uint32_t weight = 0;
        for (int i = 0; i < 3; i++)
            weight = point->vertex[i] == vertex[k] ? point->weight[i] : weight;
        fprintf(stream, " %u", weight);
    }
    fprintf(stream, " %d\n", point->depth);
}

/* A corner by its face and vertex. */
static void put_witness(FILE *stream, const starg_solid *solid, const starg_guard_options *options,
                        uint32_t column) {
    if (solid->patches != NULL)
        put_point(stream, solid, column);
    else if (options->visibility.target == STARG_TARGET_CORNERS)
        fprintf(stream, "%u %u\n", column / 3, solid->mesh->faces[column]);
    else
        fprintf(stream, "%u\n", column);
}

static void put_witnesses(FILE *stream, const making *m) {
    fprintf(stream, "witnesses %zu\n", starg_bit_count(m->wanted.bits, WITNESS_WORDS));
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, m->wanted.bits[w])
            put_witness(stream, m->scene->solid, m->options,
                        m->scene->witnesses.data[64 * w + bit]);
}

static void put_rows(FILE *stream, const making *m) {
    fprintf(stream, "rows %zu\n", m->proof->rows.count);
    for (size_t i = 0; i < m->proof->rows.count; i++) {
        const char *before = "";
        for (size_t w = 0; w < WITNESS_WORDS; w++)
            STARG_FOR_BITS (bit, m->proof->rows.data[i].bits[w]) {
                fprintf(stream, "%s%u", before, m->number[64 * w + bit]);
                before = " ";
            }
        fprintf(stream, "\n");
    }
}

static void put_reason(FILE *stream, const making *m, const stored_reason *r) {
    static const char letters[2][BOX_KINDS + 2] = {"??rnspfed", "??RNSPFE"};
    fprintf(stream, " %u%c", m->number[r->witness], letters[r->clipped][r->kind]);
    if (r->vertex < m->scene->solid->mesh->vertex_count) /* others are the witness itself */
        fprintf(stream, "%u", r->vertex);
    if (r->seed != BOX_NONE)
        fprintf(stream, ":%u", r->seed);
}

/* By parts, in the middle of the longest side, or where the children say. */
static void put_cut(FILE *stream, const search_cells *cells, const search_cell *cell) {
    const bvh_box *lower = &cells->data[cell->children].box;
    if (cell->parted) {
        fprintf(stream, "m%u", cells->data[cell->children].end_part);
        return;
    }
    int axis = cell_cut_axis(&cell->box);
    for (int k = 0; k < 3 && cell->trimmed; k++)
        if (lower->upper[k] != cell->box.upper[k])
            axis = k;
    fprintf(stream, "%c", "xyz"[axis]);
    if (cell->trimmed)
        put_double(stream, '@', lower->upper[axis]);
}

static void put_cells(FILE *stream, const making *m) {
    fprintf(stream, "cells %zu\n", m->kept.count);
    for (size_t i = 0; i < m->kept.count; i++) {
        const kept_cell *kept = &m->kept.data[i];
        if (!kept->leaf)
            put_cut(stream, m->cells, &m->cells->data[kept->number]);
        else if (kept->barred || kept->outside)
            fprintf(stream, kept->barred ? "c" : "o");
        else if (kept->row != UINT32_MAX)
            fprintf(stream, "=%u", kept->row);
        else
            fprintf(stream, ".");
        for (size_t r = 0; r < kept->count && !kept->barred && !kept->outside; r++)
            put_reason(stream, m, &m->reasons[kept->first + r]);
        fprintf(stream, "\n");
    }
}

static void put_prices(FILE *stream, const making *m) {
    const whole_prices *prices = &m->proof->prices;
    fprintf(stream, "nodes 1\nprices");
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        if (prices->price[j] > 0)
            fprintf(stream, " %u:%llu", m->number[j], (unsigned long long)prices->price[j]);
    for (size_t k = 0; k < prices->sets.count; k++) {
        const odd_set *set = &prices->sets.set[k];
        for (size_t i = 0; i < set->count && prices->odd[k] > 0; i++)
            fprintf(stream, "%c%u", i == 0 ? ' ' : '+', m->number[set->witness[i]]);
        if (prices->odd[k] > 0)
            fprintf(stream, ":%llu", (unsigned long long)prices->odd[k]);
    }
    fprintf(stream, "\n");
}

static void put_branches(FILE *stream, const making *m) {
    const branch_record *record = &m->proof->branches;
    fprintf(stream, "nodes %zu\n", record->nodes.count);
    for (size_t i = 0; i < record->nodes.count; i++) {
        const branch_node *node = &record->nodes.data[i];
        const uint64_t *numbers = record->numbers.data + node->first;
        if (node->witness == UINT32_MAX) {
            fprintf(stream, "prices");
            for (size_t k = 0; k < node->count; k += 2)
                fprintf(stream, " %u:%llu", m->number[numbers[k]],
                        (unsigned long long)numbers[k + 1]);
        } else {
            fprintf(stream, "witness %u", m->number[node->witness]);
            for (size_t k = 0; k < node->count; k++)
                fprintf(stream, " %llu", (unsigned long long)numbers[k]);
        }
        fprintf(stream, "\n");
    }
}

static void put_search(FILE *stream, const void *what) {
    const making *m = what;
    const search_cell *root = &m->cells->data[0];
    put_head(stream, m->scene->solid, m->options, &root->box, root->parted, m->proof->bound);
    put_witnesses(stream, m);
    put_rows(stream, m);
    put_cells(stream, m);
    if (m->proof->rows.count > 0)
        put_branches(stream, m);
    else
        put_prices(stream, m);
}

starg_status certificate_of_search(const search_scene *scene, const search_cells *cells,
                                   const starg_guard_options *options, guard_certificate *why) {
    starg_status status = STARG_OK;
    making m = {.scene = scene, .cells = cells, .proof = &why->proof, .options = options};
    begin(&m);
    STARG_TRY(choose_cells(&m));
    STARG_TRY(find_all_reasons(&m));
    STARG_TRY(write_text(scene->context, put_search, &m, &why->text, &why->size));
done:
    RELEASE(m.kept.data, m.reasons);
    return status;
}

/* ---- one guard or none ---- */

typedef struct single {
    const starg_solid *solid;
    const starg_guard_options *options;
    uint32_t witness;
} single;

static void put_single(FILE *stream, const void *what) {
    const single *s = what;
    put_head(stream, s->solid, s->options, &s->solid->tree->nodes[0].box, false,
             s->witness != UINT32_MAX);
    fprintf(stream, "witnesses %d\n", s->witness != UINT32_MAX);
    if (s->witness != UINT32_MAX)
        put_witness(stream, s->solid, s->options, s->witness);
    fprintf(stream, "rows 0\ncells 1\n.\nnodes 0\n");
}

starg_status certificate_of_one(starg_context *context, const starg_solid *solid,
                                const starg_guard_options *options, uint32_t witness,
                                guard_certificate *why) {
    const single s = {solid, options, witness};
    return write_text(context, put_single, &s, &why->text, &why->size);
}

starg_status starg_certificate_write(starg_context *context, const char *text, size_t size,
                                     const char *path) {
    starg_output output = {0};
    TRY(starg_output_open(context, STAGE, path, &output));
    fwrite(text, 1, size, output.stream);
    return starg_output_commit(&output);
}
