/* SPDX-License-Identifier: Apache-2.0 */
/* Reads a certificate: the lines of docs/formats.md, in this order, and nothing else. Words of a
 * line stand one blank apart. Declared counts are compared with the bytes that are left before any
 * memory is asked for. */
#include <math.h>
#include <stdio.h>

#include "verify/everywhere.h"

STARG_DROP(starg_certificate, starg_certificate)

typedef struct certificate_reader {
    starg_context *context;
    const char *name;
    const char *at, *end;
    uint64_t line;
    starg_certificate *own;
} certificate_reader;

static const char STAGE[] = "certificate";

/* The words of a certificate. */

enum { CANCEL_STEP = 1 << 16 };

static starg_status certificate_reject(const certificate_reader *r, const char *what) {
    uint64_t line = r->line;
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_LINE, &line, 1,
                         "'%.200s', line %llu: %s", r->name, (unsigned long long)line, what);
}

/* Goes past a character if it is the next one. */
static bool certificate_take(certificate_reader *r, char c) {
    bool taken = r->at < r->end && *r->at == c;
    r->at += taken;
    return taken;
}

static starg_status certificate_take_text(certificate_reader *r, const char *text) {
    char message[64];
    const char *at = r->at;
    for (const char *c = text; *c != '\0'; c++, at++)
        if (at == r->end || *at != *c) {
            snprintf(message, sizeof message, "\"%s\" is expected here", text);
            return certificate_reject(r, message);
        }
    r->at = at;
    return STARG_OK;
}

static starg_status certificate_end_line(certificate_reader *r) {
    if (!certificate_take(r, '\n'))
        return certificate_reject(r, r->at == r->end
                                         ? "the file ends within the line"
                                         : "the line goes on where its end is expected");
    r->line++;
    if (r->line % CANCEL_STEP == 0)
        return starg_check_cancel(r->context, STAGE);
    return STARG_OK;
}

/* A whole number of at most `most`, without a sign and without needless zeros. */
static starg_status certificate_take_number(certificate_reader *r, uint64_t most, uint64_t *value) {
    const char *begin = r->at;
    char message[128];
    *value = 0;
    while (r->at < r->end && *r->at >= '0' && *r->at <= '9' && r->at - begin < 19)
        *value = 10 * *value + (uint64_t)(*r->at++ - '0');
    if (r->at == begin || (*begin == '0' && r->at - begin > 1))
        return certificate_reject(r, "a whole number is expected here");
    if (*value > most) {
        snprintf(message, sizeof message,
                 "%llu is out of range: %llu is the most that may stand here",
                 (unsigned long long)*value, (unsigned long long)most);
        return certificate_reject(r, message);
    }
    return STARG_OK;
}

/* A number of things of at least `size` bytes each, which are still to come. */
static starg_status certificate_take_count(certificate_reader *r, const char *word, size_t size,
                                           size_t *count) {
    uint64_t value;
    TRY(certificate_take_text(r, word));
    TRY(certificate_take_number(r, (uint64_t)(r->end - r->at) / size, &value));
    *count = (size_t)value;
    return certificate_end_line(r);
}

/* M:K is M times 2 to the power of K. */
static starg_status certificate_take_double(certificate_reader *r, double *value) {
    uint64_t whole, power;
    bool negative = certificate_take(r, '-');
    TRY(certificate_take_number(r, UINT64_C(1) << 53, &whole));
    TRY(certificate_take_text(r, ":"));
    bool small = certificate_take(r, '-');
    TRY(certificate_take_number(r, 1074, &power));
    double size = ldexp((double)whole, small ? -(int)power : (int)power);
    if (!(size < 1e100))
        return certificate_reject(r, "numbers are below 1e100 in magnitude");
    *value = negative ? -size : size;
    return STARG_OK;
}

/* Three of them, with a blank before each. */
static starg_status certificate_take_point(certificate_reader *r, double out[3]) {
    for (int k = 0; k < 3; k++) {
        TRY(certificate_take_text(r, " "));
        TRY(certificate_take_double(r, &out[k]));
    }
    return STARG_OK;
}

/* ---- the head ---- */

static starg_status read_checksum(certificate_reader *r) {
    static const char digits[] = "0123456789abcdef";
    TRY(certificate_take_text(r, "checksum "));
    for (int i = 0; i < 16; i++) {
        const char *digit = r->at < r->end && *r->at != '\0' ? strchr(digits, *r->at) : NULL;
        if (digit == NULL)
            return certificate_reject(r, "16 digits of base 16 are expected here");
        r->own->checksum = r->own->checksum << 4 | (uint64_t)(digit - digits);
        r->at++;
    }
    return certificate_end_line(r);
}

static starg_status read_size(certificate_reader *r, const char *word, size_t *size) {
    uint64_t value;
    TRY(certificate_take_text(r, word));
    TRY(certificate_take_number(r, UINT32_MAX / 4, &value));
    *size = (size_t)value;
    return certificate_end_line(r);
}

static starg_status read_question(certificate_reader *r) {
    starg_certificate *own = r->own;
    TRY(certificate_take_text(r, "target "));
    char first = r->at < r->end ? *r->at : 'f';
    if (own->target == STARG_TARGET_POINTS)
        TRY(certificate_take_text(r, "points"));
    else {
        own->target = first == 'v'   ? STARG_TARGET_VERTICES
                      : first == 'c' ? STARG_TARGET_CORNERS
                                     : STARG_TARGET_FACES;
        TRY(certificate_take_text(r, first == 'v'   ? "vertices"
                                     : first == 'c' ? "corners"
                                                    : "faces"));
    }
    TRY(certificate_end_line(r));
    TRY(certificate_take_text(r, "range "));
    own->range = INFINITY;
    if (r->at < r->end && *r->at == 'n')
        TRY(certificate_take_text(r, "none"));
    else
        TRY(certificate_take_double(r, &own->range));
    TRY(certificate_end_line(r));
    TRY(certificate_take_text(r, "clearance "));
    TRY(certificate_take_double(r, &own->clearance));
    TRY(certificate_end_line(r));
    TRY(read_size(r, "redundancy ", &own->redundancy));
    return read_size(r, "bound ", &own->bound);
}

static starg_status read_head(certificate_reader *r) {
    starg_certificate *own = r->own;
    TRY(certificate_take_text(r, "starguard-certificate "));
    /* the first version has no cuts at given places and no odd sets, the second no parts; the third
       was of another kind of proof; the fifth is of points, and of nothing else */
    if (certificate_take(r, '5'))
        own->target = STARG_TARGET_POINTS;
    else if (!certificate_take(r, '1') && !certificate_take(r, '2'))
        TRY(certificate_take_text(r, "4"));
    TRY(certificate_end_line(r));
    TRY(read_size(r, "vertices ", &own->vertex_count));
    TRY(read_size(r, "faces ", &own->face_count));
    TRY(read_checksum(r));
    return read_question(r);
}

static starg_status read_root(certificate_reader *r, verify_box *root) {
    TRY(certificate_take_text(r, "root"));
    TRY(certificate_take_point(r, root->lower));
    TRY(certificate_take_point(r, root->upper));
    for (int k = 0; k < 3; k++)
        if (!(root->lower[k] <= root->upper[k]))
            return certificate_reject(r, "the lower corner of the box is not below its upper one");
    return certificate_end_line(r);
}

/* The weights of a point behind the number of its face, and their binary logarithm. */
static starg_status read_weights(certificate_reader *r, uint32_t weight[3]) {
    uint64_t value[3], depth;
    for (int k = 0; k < 3; k++) {
        TRY(certificate_take_text(r, " "));
        TRY(certificate_take_number(r, (uint64_t)VERIFY_UNIT, &value[k]));
    }
    TRY(certificate_take_text(r, " "));
    TRY(certificate_take_number(r, VERIFY_UNIT_BITS, &depth));
    if (value[0] + value[1] + value[2] != UINT64_C(1) << depth)
        return certificate_reject(r, "the weights of a point do not sum to 2 to the last number");
    for (int k = 0; k < 3; k++)
        weight[k] = (uint32_t)(value[k] << (VERIFY_UNIT_BITS - (int)depth));
    return STARG_OK;
}

static starg_status read_corner(certificate_reader *r, uint32_t *corner) {
    uint64_t value;
    TRY(certificate_take_text(r, " "));
    TRY(certificate_take_number(r, r->own->vertex_count > 0 ? r->own->vertex_count - 1 : 0,
                                &value));
    *corner = (uint32_t)value;
    return STARG_OK;
}

static starg_status read_witnesses(certificate_reader *r) {
    starg_certificate *own = r->own;
    size_t most = own->target == STARG_TARGET_VERTICES ? own->vertex_count : own->face_count;
    TRY(certificate_take_count(r, "witnesses ", 2, &own->witness_count));
    if (own->witness_count > EVERYWHERE_WITNESSES || (most == 0 && own->witness_count > 0))
        return certificate_reject(r, "there are too many witnesses");
    own->words = starg_bit_words(own->witness_count);
    NEW(r->context, STAGE, own->witnesses, own->witness_count);
    if (own->target == STARG_TARGET_CORNERS)
        NEW(r->context, STAGE, own->corners, own->witness_count);
    if (own->target == STARG_TARGET_POINTS)
        NEW(r->context, STAGE, own->weights, own->witness_count);
    for (size_t i = 0; i < own->witness_count; i++) {
        uint64_t value;
        TRY(certificate_take_number(r, most - 1, &value));
        own->witnesses[i] = (uint32_t)value;
        if (own->corners != NULL)
            TRY(read_corner(r, &own->corners[i]));
        if (own->weights != NULL)
            TRY(read_weights(r, own->weights[i]));
        TRY(certificate_end_line(r));
    }
    return STARG_OK;
}

static starg_status take_witness(certificate_reader *r, uint64_t *witness) {
    if (r->own->witness_count == 0)
        return certificate_reject(r, "there are no witnesses");
    return certificate_take_number(r, r->own->witness_count - 1, witness);
}

static starg_status read_rows(certificate_reader *r) {
    starg_certificate *own = r->own;
    TRY(certificate_take_count(r, "rows ", 2, &own->row_count));
    NEW_ZERO(r->context, STAGE, own->rows, own->row_count * own->words);
    for (size_t i = 0; i < own->row_count; i++) {
        do {
            uint64_t witness;
            TRY(take_witness(r, &witness));
            starg_bit_set(own->rows + i * own->words, witness);
        } while (certificate_take(r, ' '));
        TRY(certificate_end_line(r));
    }
    return STARG_OK;
}

/* ---- cells ---- */

bool verify_is_between(const starg_certificate *own, size_t witness) {
    bool between = own->weights != NULL;
    for (int k = 0; k < 3 && between; k++)
        between = own->weights[witness][k] != (uint32_t)VERIFY_UNIT;
    return between;
}

static starg_status read_reason(certificate_reader *r) {
    verify_reason reason = {.vertex = UINT32_MAX, .seed = UINT32_MAX};
    uint64_t value;
    TRY(take_witness(r, &value));
    reason.witness = (uint32_t)value;
    char letter = r->at < r->end ? *r->at : '\0';
    reason.clipped = letter >= 'A' && letter <= 'Z';
    reason.kind = reason.clipped ? (char)(letter - 'A' + 'a') : letter;
    if (reason.kind == '\0' || strchr("nrspfed", reason.kind) == NULL || letter == 'N' ||
        letter == 'D')
        return certificate_reject(r,
                                  "the letter of a reason is expected here: n, r, s, p, f, e or d");
    r->at++;
    bool between = verify_is_between(r->own, reason.witness);
    if (between && (reason.kind == 's' || reason.kind == 'f'))
        return certificate_reject(r, "s and f are reasons of vertices: the witness is none");
    if (reason.kind != 'n' && reason.kind != 'd' && !between) {
        if (r->own->vertex_count == 0)
            return certificate_reject(r, "the model has no vertices");
        TRY(certificate_take_number(r, r->own->vertex_count - 1, &value));
        reason.vertex = (uint32_t)value;
    }
    if ((reason.kind == 'p' || reason.kind == 'f') && certificate_take(r, ':')) {
        if (r->own->face_count == 0)
            return certificate_reject(r, "the model has no faces");
        TRY(certificate_take_number(r, r->own->face_count - 1, &value));
        reason.seed = (uint32_t)value;
    }
    PUSH(r->context, STAGE, &r->own->reasons, reason);
    return STARG_OK;
}

static starg_status read_kind(certificate_reader *r, everywhere_cell *cell) {
    uint64_t row;
    cell->row = UINT32_MAX;
    cell->kind = EVERYWHERE_LEAF;
    if (certificate_take(r, 'x'))
        cell->kind = 0;
    else if (certificate_take(r, 'y'))
        cell->kind = 1;
    else if (certificate_take(r, 'z'))
        cell->kind = 2;
    else if (certificate_take(r, 'o'))
        cell->kind = EVERYWHERE_OUTSIDE;
    else if (certificate_take(r, 'c'))
        cell->kind = EVERYWHERE_BARRED;
    else if (certificate_take(r, '=')) {
        if (r->own->row_count == 0)
            return certificate_reject(r, "there are no rows");
        TRY(certificate_take_number(r, r->own->row_count - 1, &row));
        cell->row = (uint32_t)row;
    } else if (certificate_take(r, 'm'))
        cell->kind = EVERYWHERE_PARTED;
    else if (!certificate_take(r, '.'))
        return certificate_reject(r, "a cell is expected here: x, y, z, m, a dot, =, c or o");
    return STARG_OK;
}

static bool is_cut(const everywhere_cell *cell) {
    return cell->kind < EVERYWHERE_LEAF || cell->kind == EVERYWHERE_PARTED;
}

/* The first part of the second half. */
static starg_status read_part(certificate_reader *r, const everywhere_cell *cell, uint32_t *part) {
    uint64_t value;
    TRY(certificate_take_number(r, UINT32_MAX - 1, &value));
    *part = (uint32_t)value;
    if (*part <= cell->parts[0] || *part >= cell->parts[1])
        return certificate_reject(r, "the cell is cut at a part that is not within");
    return STARG_OK;
}

/* Where a cell is cut: in the middle of the axis, unless a place is given. */
static starg_status read_cut(certificate_reader *r, const everywhere_cell *cell, double *at) {
    int k = cell->kind;
    double lower = cell->box.lower[k], upper = cell->box.upper[k];
    *at = fmin(fmax(0.5 * lower + 0.5 * upper, lower), upper);
    if (!certificate_take(r, '@'))
        return STARG_OK;
    TRY(certificate_take_double(r, at));
    if (!(*at >= lower && *at <= upper))
        return certificate_reject(r, "the cell is cut outside of itself");
    return STARG_OK;
}

/* With its halves, if it is cut. */
static starg_status read_cell(certificate_reader *r, everywhere_cell *cell,
                              everywhere_cell halves[2]) {
    double at;
    TRY(read_kind(r, cell));
    halves[0] = halves[1] = *cell;
    if (cell->kind == EVERYWHERE_PARTED) {
        TRY(read_part(r, cell, &halves[1].parts[0]));
        halves[0].parts[1] = halves[1].parts[0];
    } else if (is_cut(cell)) {
        TRY(read_cut(r, cell, &at));
        halves[0].box.upper[cell->kind] = halves[1].box.lower[cell->kind] = at;
    }
    cell->first = r->own->reasons.count;
    while ((is_cut(cell) || cell->kind == EVERYWHERE_LEAF) && certificate_take(r, ' '))
        TRY(read_reason(r));
    cell->count = r->own->reasons.count - cell->first;
    return certificate_end_line(r);
}

/* A cell is followed by all of its lower half, then the upper one. Cells that are still to come
 * stand on a stack, the next one on top. */
static starg_status read_cells(certificate_reader *r, const verify_box *root) {
    starg_certificate *own = r->own;
    SCOPED struct {
        everywhere_cell cell;
        int depth;
    } *stack = NULL;
    size_t left = 1;
    TRY(certificate_take_count(r, "cells ", 2, &own->cell_count));
    own->cell_line = (size_t)r->line;
    NEW(r->context, STAGE, own->cells, own->cell_count);
    NEW(r->context, STAGE, stack, EVERYWHERE_DEPTH + 2);
    stack[0].cell = (everywhere_cell){.box = *root, .parts = {0, UINT32_MAX}};
    stack[0].depth = 0;
    for (size_t i = 0; i < own->cell_count; i++) {
        everywhere_cell *cell = &own->cells[i];
        everywhere_cell halves[2];
        if (left == 0)
            return certificate_reject(r,
                                      "the cells before this one fill the root: none may follow");
        *cell = stack[--left].cell;
        int depth = stack[left].depth + 1;
        TRY(read_cell(r, cell, halves));
        if (!is_cut(cell))
            continue;
        if (depth > EVERYWHERE_DEPTH)
            return certificate_reject(r, "cells are cut too often");
        for (int k = 1; k >= 0; k--) {
            stack[left].cell = halves[k];
            stack[left++].depth = depth;
        }
    }
    return left > 0 ? certificate_reject(r, "halves of cells are missing") : STARG_OK;
}

/* ---- branches ---- */

/* One witness, or an odd number of them in ascending order. */
static starg_status read_priced(certificate_reader *r) {
    starg_certificate *own = r->own;
    uint64_t witness, before = 0;
    size_t first = own->numbers.count, count = 0;
    PUSH(r->context, STAGE, &own->numbers, 0);
    do {
        TRY(take_witness(r, &witness));
        if (count++ > 0 && witness <= before)
            return certificate_reject(r, "the witnesses of a set are not in ascending order");
        before = witness;
        PUSH(r->context, STAGE, &own->numbers, witness);
    } while (certificate_take(r, '+'));
    own->numbers.data[first] = count;
    if (count % 2 == 0)
        return certificate_reject(r, "a set has an odd number of witnesses");
    return STARG_OK;
}

static starg_status read_prices(certificate_reader *r) {
    uint64_t price;
    while (certificate_take(r, ' ')) {
        TRY(read_priced(r));
        TRY(certificate_take_text(r, ":"));
        TRY(certificate_take_number(r, EVERYWHERE_PRICE, &price));
        PUSH(r->context, STAGE, &r->own->numbers, price);
    }
    return STARG_OK;
}

static starg_status read_branch_rows(certificate_reader *r) {
    uint64_t row;
    while (certificate_take(r, ' ')) {
        if (r->own->row_count == 0)
            return certificate_reject(r, "there are no rows");
        TRY(certificate_take_number(r, r->own->row_count - 1, &row));
        PUSH(r->context, STAGE, &r->own->numbers, row);
    }
    return STARG_OK;
}

static starg_status read_nodes(certificate_reader *r) {
    starg_certificate *own = r->own;
    TRY(certificate_take_count(r, "nodes ", 7, &own->node_count));
    NEW(r->context, STAGE, own->nodes, own->node_count);
    for (size_t i = 0; i < own->node_count; i++) {
        everywhere_node *node = &own->nodes[i];
        uint64_t witness = UINT32_MAX;
        node->first = own->numbers.count;
        if (r->at < r->end && *r->at == 'w') {
            TRY(certificate_take_text(r, "witness "));
            TRY(take_witness(r, &witness));
            TRY(read_branch_rows(r));
        } else {
            TRY(certificate_take_text(r, "prices"));
            TRY(read_prices(r));
        }
        node->witness = (uint32_t)witness;
        node->count = own->numbers.count - node->first;
        TRY(certificate_end_line(r));
    }
    return STARG_OK;
}

static starg_status read_all(certificate_reader *r) {
    verify_box root;
    TRY(read_head(r));
    TRY(read_root(r, &root));
    TRY(read_witnesses(r));
    TRY(read_rows(r));
    TRY(read_cells(r, &root));
    TRY(read_nodes(r));
    if (r->at < r->end)
        return certificate_reject(r, "the file goes on where its end is expected");
    return STARG_OK;
}

starg_status starg_certificate_read_memory(starg_context *context, const void *bytes, size_t size,
                                           const char *name, starg_certificate **out) {
    SCOPED_BY(starg_certificate_drop) starg_certificate *own = NULL;
    *out = NULL;
    NEW_ZERO(context, STAGE, own, 1);
    own->context = context;
    const char *text = size > 0 ? bytes : "";
    certificate_reader r = {context, name, text, text + size, 1, own};
    TRY(read_all(&r));
    *out = own;
    own = NULL;
    return STARG_OK;
}

void starg_certificate_free(starg_certificate *own) {
    if (own == NULL)
        return;
    RELEASE(own->witnesses, own->corners, own->weights, own->rows, own->cells, own->reasons.data,
            own->nodes, own->numbers.data, own);
}

/* The outline of a certificate: its witnesses, and the cells from which a guard may see its share
 * of them. The prices are those of the first node; a proof that begins with a branch has none
 * there, and all witnesses weigh the same. Of an odd set each witness weighs half. Nothing is
 * checked. Cost: the witnesses of all leaves.
 */

typedef struct sharing {
    const starg_certificate *own;
    const everywhere_node *priced; /* NULL: all witnesses weigh the same */
    starg_uint128 all;
    starg_certificate_outline *out;
} sharing;

static void set_prices(sharing *s) {
    const starg_certificate *own = s->own;
    if (own->node_count > 0 && own->nodes[0].witness == UINT32_MAX)
        s->priced = &own->nodes[0];
    s->all = s->priced != NULL ? verify_least_paid(own, s->priced, own->redundancy)
                               : (starg_uint128)own->witness_count * own->redundancy;
}

static bool keep_leaf(void *user, size_t cell, const uint64_t *open) {
    sharing *s = user;
    const verify_box *box = &s->own->cells[cell].box;
    starg_uint128 sum = s->priced != NULL ? verify_paid(s->own, s->priced, open)
                                          : starg_bit_count(open, s->own->words);
    if (sum > 0 && sum * s->own->bound >= s->all) {
        double *kept = s->out->cells + 6 * s->out->cell_count++;
        memcpy(kept, box->lower, sizeof box->lower);
        memcpy(kept + 3, box->upper, sizeof box->upper);
    }
    return true;
}

starg_status starg_certificate_outline_create(starg_context *context,
                                              const starg_certificate *certificate,
                                              starg_certificate_outline **out) {
    starg_status status = STARG_OK;
    const starg_certificate *own = certificate;
    sharing s = {.own = own};
    bool all;
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, s.out, 1);
    s.out->vertex_count = own->vertex_count;
    s.out->face_count = own->face_count;
    s.out->target =
        own->target == STARG_TARGET_VERTICES ? STARG_TARGET_VERTICES : STARG_TARGET_FACES;
    s.out->bound = own->bound;
    s.out->witness_count = own->witness_count;
    STARG_NEW(context, STAGE, s.out->witnesses, own->witness_count);
    if (own->witness_count > 0)
        memcpy(s.out->witnesses, own->witnesses, own->witness_count * sizeof *own->witnesses);
    STARG_NEW(context, STAGE, s.out->cells, 6 * own->cell_count);
    set_prices(&s);
    STARG_TRY(verify_visit_leaves(own, keep_leaf, &s, &all));
    *out = s.out;
    s.out = NULL;
done:
    starg_certificate_outline_free(context, s.out);
    return status;
}

void starg_certificate_outline_free(starg_context *context, starg_certificate_outline *outline) {
    (void)context;
    if (outline == NULL)
        return;
    RELEASE(outline->witnesses, outline->cells, outline);
}
