/* SPDX-License-Identifier: Apache-2.0 */
/* Does the bound of a certificate follow from what its leaves may see? Sums of whole numbers, and
 * sets of witnesses; docs/verification.md has the proof.
 *
 * A leaf may see all witnesses but those for which it, or a cell around it, gives a reason. Without
 * rows, prices prove the bound: those of a leaf's witnesses sum to less than a share of all, each
 * as often as it is to be seen. With rows, each leaf is within one, and the nodes prove that so
 * many rows do not hold all witnesses.
 *
 * A price of several witnesses, an odd set, is paid for each half of the number that somebody sees
 * of them, rounded up: all together see at least half of all, rounded up.
 *
 * Cost: the witnesses of all leaves, and their odd sets; for each node those of all rows. */
#include <stdio.h>

#include "verify/everywhere.h"

static const char STAGE[] = "verify";

typedef struct proving {
    const starg_certificate *own;
    uint8_t *gone;               /* by row: covers that have it were dealt with */
    uint64_t *price;             /* by witness, of it alone */
    const everywhere_node *sets; /* the node with the prices of odd sets */
    size_t next, depth;          /* the node that comes now */
    everywhere_words *why;
} proving;

static void say(proving *p, const char *what, size_t number) {
    snprintf(p->why->text, sizeof p->why->text, "%s %zu", what, number);
}

static bool is_within(const uint64_t *a, const uint64_t *b, size_t words) {
    for (size_t w = 0; w < words; w++)
        if ((a[w] & ~b[w]) != 0)
            return false;
    return true;
}

/* ---- leaves ---- */

starg_status verify_visit_leaves(const starg_certificate *own, everywhere_visit *visit, void *user,
                                 bool *all) {
    starg_context *context = own->context;
    /* rows of cells that are still to come, the next one on top */
    SCOPED uint64_t *open = NULL;
    size_t words = own->words, top = 0;
    NEW_ZERO(context, STAGE, open, (EVERYWHERE_DEPTH + 2) * words);
    for (size_t j = 0; j < own->witness_count; j++)
        starg_bit_set(open, j);
    *all = true;
    for (size_t i = 0; i < own->cell_count && *all; i++) {
        const everywhere_cell *cell = &own->cells[i];
        uint64_t *row = open + top * words;
        for (size_t k = 0; k < cell->count; k++)
            starg_bit_clear(row, own->reasons.data[cell->first + k].witness);
        if (cell->kind < EVERYWHERE_LEAF || cell->kind == EVERYWHERE_PARTED) {
            memcpy(row + words, row, words * sizeof *row);
            top++;
            continue;
        }
        if (cell->kind > EVERYWHERE_LEAF)
            memset(row, 0, words * sizeof *row);
        *all = visit(user, i, row);
        top -= top > 0;
        if (i % 4096 == 0)
            TRY(starg_check_cancel(context, STAGE));
    }
    return STARG_OK;
}

static bool is_in_row(void *user, size_t cell, const uint64_t *open) {
    proving *p = user;
    const starg_certificate *own = p->own;
    uint32_t row = own->cells[cell].row;
    if (own->cells[cell].kind > EVERYWHERE_LEAF)
        return true;
    bool within =
        row != UINT32_MAX && is_within(open, own->rows + (size_t)row * own->words, own->words);
    if (!within)
        say(p, "a leaf may see more than its row: the one on line", own->cell_line + cell);
    return within;
}

/* ---- prices ---- */

starg_uint128 verify_least_paid(const starg_certificate *own, const everywhere_node *node,
                                size_t times) {
    const uint64_t *at = own->numbers.data + node->first, *end = at + node->count;
    starg_uint128 sum = 0;
    for (; at < end; at += at[0] + 2) {
        starg_uint128 seen = (starg_uint128)at[0] * times;
        sum += at[at[0] + 1] * (at[0] == 1 ? seen : (seen + 1) / 2);
    }
    return sum;
}

starg_uint128 verify_paid(const starg_certificate *own, const everywhere_node *node,
                          const uint64_t *row) {
    const uint64_t *at = own->numbers.data + node->first, *end = at + node->count;
    starg_uint128 sum = 0;
    for (; at < end; at += at[0] + 2) {
        uint64_t seen = 0;
        for (uint64_t k = 1; k <= at[0]; k++)
            seen += starg_bit_test(row, at[k]);
        sum += (starg_uint128)at[at[0] + 1] * ((seen + 1) / 2);
    }
    return sum;
}

/* Are the prices of the node of witnesses in `wanted` only? */
static bool are_wanted(proving *p, const everywhere_node *node, const uint64_t *wanted) {
    const uint64_t *at = p->own->numbers.data + node->first, *end = at + node->count;
    for (; at < end; at += at[0] + 2)
        for (uint64_t k = 1; k <= at[0]; k++)
            if (!starg_bit_test(wanted, at[k])) {
                say(p, "the prices name a witness that is held already: node", p->next);
                return false;
            }
    return true;
}

typedef struct leaf_prices {
    proving *proving;
    starg_uint128 least;
    size_t most;
} leaf_prices;

static bool is_cheap(void *user, size_t cell, const uint64_t *open) {
    const leaf_prices *own = user;
    proving *p = own->proving;
    bool cheap = own->least > own->most * verify_paid(p->own, &p->own->nodes[0], open);
    if (!cheap)
        say(p, "a leaf may see witnesses that are worth too much: the one on line",
            p->own->cell_line + cell);
    return cheap;
}

/* Without rows: prices for the leaves themselves. */
static starg_status prove_by_leaves(proving *p, size_t most, bool *follows) {
    leaf_prices own = {.proving = p, .most = most};
    const starg_certificate *c = p->own;
    *follows = c->node_count == 1 && c->nodes[0].witness == UINT32_MAX;
    if (!*follows) {
        say(p, "without rows, one node with prices is expected; number of nodes", c->node_count);
        return STARG_OK;
    }
    own.least = verify_least_paid(c, &c->nodes[0], c->redundancy);
    return verify_visit_leaves(c, is_cheap, &own, follows);
}

/* ---- branches ---- */

static bool holds_within(const starg_certificate *own, const uint64_t *a, const uint64_t *b,
                         const uint64_t *wanted) {
    for (size_t w = 0; w < own->words; w++)
        if ((a[w] & wanted[w] & ~b[w]) != 0)
            return false;
    return true;
}

/* Are prices worth more than `most` times any row that is left? */
static bool prices_prove(proving *p, const everywhere_node *node, const uint64_t *wanted,
                         size_t most) {
    const starg_certificate *own = p->own;
    const starg_uint128 least = verify_least_paid(own, node, 1);
    if (!are_wanted(p, node, wanted))
        return false;
    for (size_t i = 0; i < own->row_count; i++)
        if (!p->gone[i] && least <= most * verify_paid(own, node, own->rows + i * own->words)) {
            say(p, "the prices do not prove what they should: node", p->next);
            return false;
        }
    return least > 0;
}

/* Has each row that is left and holds the witness its branch, or one at least as good? */
static bool names_all(proving *p, const everywhere_node *node, const uint64_t *wanted) {
    const starg_certificate *own = p->own;
    const uint64_t *named = own->numbers.data + node->first;
    bool good = starg_bit_test(wanted, node->witness);
    for (size_t i = 0; i < own->row_count && good; i++) {
        const uint64_t *row = own->rows + i * own->words;
        if (p->gone[i] || !starg_bit_test(row, node->witness))
            continue;
        bool found = false;
        for (size_t k = 0; k < node->count && !found; k++)
            found = !p->gone[named[k]] &&
                    (named[k] == i ||
                     holds_within(own, row, own->rows + named[k] * own->words, wanted));
        good = found;
    }
    if (!good)
        say(p, "a branch is missing, or the witness is held already: node", p->next);
    return good;
}

static starg_status prove(proving *p, const uint64_t *wanted, size_t most, bool *follows);

static starg_status prove_branches(proving *p, const everywhere_node *node, const uint64_t *wanted,
                                   size_t most, bool *follows) {
    starg_status status = STARG_OK;
    const starg_certificate *own = p->own;
    const uint64_t *named = own->numbers.data + node->first;
    uint64_t left[EVERYWHERE_WORDS];
    size_t taken = 0;
    for (; taken < node->count && *follows; taken++) {
        const uint64_t *row = own->rows + named[taken] * own->words;
        if (p->gone[named[taken]]) {
            say(p, "a row has two branches: node", p->next);
            *follows = false;
            break;
        }
        for (size_t w = 0; w < own->words; w++)
            left[w] = wanted[w] & ~row[w];
        STARG_TRY(prove(p, left, most - 1, follows));
        p->gone[named[taken]] = 1;
    }
done:
    for (size_t k = 0; k < taken && status == STARG_OK; k++)
        p->gone[named[k]] = 0;
    return status;
}

/* Do `most` rows that are left not hold all that is wanted? The node that comes now says why, if
 * any row may be taken at all. */
static starg_status prove(proving *p, const uint64_t *wanted, size_t most, bool *follows) {
    const starg_certificate *own = p->own;
    *follows = starg_bit_count(wanted, own->words) > 0;
    if (!*follows)
        say(p, "a branch holds all witnesses: before node", p->next);
    if (!*follows || most == 0)
        return STARG_OK;
    *follows = p->next < own->node_count && p->depth < EVERYWHERE_DEPTH;
    if (!*follows) {
        say(p, "nodes are missing, or go too deep: behind node", p->next);
        return STARG_OK;
    }
    TRY(starg_check_cancel(own->context, STAGE));
    const everywhere_node *node = &own->nodes[p->next];
    if (node->witness == UINT32_MAX)
        *follows = prices_prove(p, node, wanted, most);
    else
        *follows = names_all(p, node, wanted);
    p->next += *follows;
    if (*follows && node->witness != UINT32_MAX) {
        p->depth++;
        TRY(prove_branches(p, node, wanted, most, follows));
        p->depth--;
    }
    return STARG_OK;
}

static starg_status prove_by_rows(proving *p, size_t most, bool *follows) {
    const starg_certificate *own = p->own;
    uint64_t all[EVERYWHERE_WORDS] = {0};
    *follows = own->redundancy == 1;
    if (!*follows) {
        say(p, "rows prove nothing with a redundancy of", own->redundancy);
        return STARG_OK;
    }
    for (size_t j = 0; j < own->witness_count; j++)
        starg_bit_set(all, j);
    TRY(verify_visit_leaves(own, is_in_row, p, follows));
    if (*follows)
        TRY(prove(p, all, most, follows));
    if (*follows && p->next != own->node_count) {
        *follows = false;
        say(p, "nodes that nothing asks for begin with node", p->next);
    }
    return STARG_OK;
}

/* A bound of 1 is for whoever has something to see. */
starg_status verify_check_bound(const starg_certificate *own, bool *follows,
                                everywhere_words *why) {
    starg_status status = STARG_OK;
    proving p = {.own = own, .why = why};
    *follows = own->bound <= 1;
    if (own->bound == 0)
        return STARG_OK;
    if (own->witness_count == 0) {
        *follows = false;
        say(&p, "there is nothing to see; bound", own->bound);
        return STARG_OK;
    }
    STARG_NEW_ZERO(own->context, STAGE, p.gone, own->row_count);
    if (own->bound > 1)
        STARG_TRY(own->row_count > 0 ? prove_by_rows(&p, own->bound - 1, follows)
                                     : prove_by_leaves(&p, own->bound - 1, follows));
done:
    starg_release(own->context, p.gone);
    return status;
}
