/* SPDX-License-Identifier: Apache-2.0 */
/* Labels for nodes such that those across an edge go together.
 *
 * Problem: every node is to get one of the labels given for it, so that across each edge the labels
 * are the same or each fits at its end: a constraint satisfaction problem with binary constraints.
 * Few edges between different labels are better than many.
 *
 * Stages: labels that no label across an edge goes with are struck out, until nothing changes (arc
 * consistency, AC-3 [Mackworth 1977]); then nodes next to a settled one get its label, and where
 * there is none, one with the fewest labels left gets one of them; what follows is struck out after
 * each. A choice that leaves some node without a label is taken back once and struck out itself.
 *
 * Invariants: what is struck out is in no solution with the choices made so far. There is no
 * further search, so solutions can be missed; with two labels none is: then every choice that
 * leaves no node empty can be completed.
 *
 * Cost: linear in the nodes for each choice that is no consequence of others. */
#include "star/certified/search.h"

enum { DEGREE = 3 };

static const uint32_t NO_EDGE = UINT32_MAX;

#define LABELLING_STAGE "decompose"

void labelling_free(labelling *l) {
    RELEASE(l->given.data, l->edges.data, l->left.data, l->edges_of.data, l->queue.data,
            l->changed.data);
    *l = (labelling){.context = l->context};
}

starg_status labelling_prepare(labelling *l) {
    l->left.count = l->edges_of.count = 0;
    for (size_t i = 0; i < l->given.count; i++)
        PUSH(l->context, LABELLING_STAGE, &l->left, l->given.data[i]);
    for (size_t i = 0; i < DEGREE * l->given.count; i++)
        PUSH(l->context, LABELLING_STAGE, &l->edges_of, NO_EDGE);
    for (uint32_t i = 0; i < l->edges.count; i++)
        for (int end = 0; end < 2; end++) {
            uint32_t *slot = &l->edges_of.data[DEGREE * (size_t)l->edges.data[i].nodes[end]];
            while (*slot != NO_EDGE)
                slot++;
            *slot = i;
        }
    return STARG_OK;
}

static bool is_single(label_set set) {
    return (set & (set - 1)) == 0;
}

static int size_of(label_set set) {
    int size = 0;
    for (; set != 0; set &= set - 1)
        size++;
    return size;
}

/* ---- striking out ---- */

static starg_status set_labels(labelling *l, uint32_t node, label_set set) {
    PUSH(l->context, LABELLING_STAGE, &l->changed, node);
    PUSH(l->context, LABELLING_STAGE, &l->changed, l->left.data[node]);
    PUSH(l->context, LABELLING_STAGE, &l->queue, node);
    l->left.data[node] = set;
    return STARG_OK;
}

/* Those of the node at an end of an edge that go with something at the other end. */
static label_set supported(const labelling *l, const labelling_edge *edge, int end) {
    label_set here = l->left.data[edge->nodes[end]], there = l->left.data[edge->nodes[1 - end]];
    return here & (there | ((there & edge->fits[1 - end]) != 0 ? edge->fits[end] : 0));
}

/* Until nothing changes; *fine is false when a node is left without a label. */
static starg_status strike_out(labelling *l, bool *fine) {
    *fine = true;
    while (l->queue.count > 0 && *fine) {
        uint32_t from = l->queue.data[--l->queue.count];
        for (int k = 0; k < DEGREE && *fine; k++) {
            const labelling_edge *edge =
                &l->edges.data[l->edges_of.data[DEGREE * from + (uint32_t)k]];
            int end = edge->nodes[0] == from ? 1 : 0;
            label_set set = supported(l, edge, end);
            if (set == l->left.data[edge->nodes[end]])
                continue;
            *fine = set != 0;
            TRY(set_labels(l, edge->nodes[end], set));
        }
    }
    l->queue.count = 0;
    return STARG_OK;
}

static void go_back(labelling *l) {
    while (l->changed.count > 0) {
        l->changed.count -= 2;
        l->left.data[l->changed.data[l->changed.count]] = l->changed.data[l->changed.count + 1];
    }
}

/* ---- choices ---- */

/* Settles a node with a label, or, where that cannot be, without it. */
static starg_status settle(labelling *l, uint32_t node, label_set label, bool *fine) {
    l->changed.count = 0;
    TRY(set_labels(l, node, label));
    TRY(strike_out(l, fine));
    if (*fine)
        return STARG_OK;
    go_back(l);
    TRY(set_labels(l, node, l->left.data[node] & ~label));
    return strike_out(l, fine);
}

static void find_ranked(labelling *l) {
    l->ranked = 0;
    for (int k = 0; k < LABELLING_MOST; k++)
        if (l->ranks[k] > 0)
            l->ranked |= (label_set)1 << k;
}

/* The label of a settled node across an edge, if it can be had; otherwise none. */
static label_set label_nearby(const labelling *l, uint32_t node) {
    for (int k = 0; k < DEGREE; k++) {
        const labelling_edge *edge = &l->edges.data[l->edges_of.data[DEGREE * node + (uint32_t)k]];
        label_set there = l->left.data[edge->nodes[edge->nodes[0] == node ? 1 : 0]];
        if (is_single(there) && (there & l->left.data[node] & l->ranked) != 0)
            return there;
    }
    return 0;
}

static label_set highest(const labelling *l, label_set set) {
    label_set best = 0;
    double rank = -1;
    for (int k = 0; k < LABELLING_MOST; k++)
        if ((set >> k & 1) != 0 && l->ranks[k] > rank) {
            rank = l->ranks[k];
            best = (label_set)1 << k;
        }
    return best;
}

/* By rank, or any that has a rank. */
static label_set choose_label(const labelling *l, label_set set, starg_rng *rng) {
    if ((set & l->ranked) != 0)
        set &= l->ranked;
    if (starg_rng_below(rng, 2) == 0)
        return highest(l, set);
    for (uint64_t skip = starg_rng_below(rng, (uint64_t)size_of(set)); skip > 0; skip--)
        set &= set - 1;
    return set & -set;
}

/* Nodes next to settled ones, in their order. */
static starg_status spread(labelling *l, bool *any, bool *fine) {
    *any = false;
    for (uint32_t i = 0; i < l->left.count && *fine; i++) {
        label_set label = is_single(l->left.data[i]) ? 0 : label_nearby(l, i);
        if (label == 0)
            continue;
        *any = true;
        TRY(settle(l, i, label, fine));
    }
    return STARG_OK;
}

/* A node with the fewest labels, but more than one. */
static starg_status settle_one(labelling *l, starg_rng *rng, bool *any, bool *fine) {
    uint32_t best = UINT32_MAX;
    int least = LABELLING_MOST + 1;
    for (uint32_t i = 0; i < l->left.count; i++) {
        int size = size_of(l->left.data[i]);
        if (size > 1 && size < least) {
            best = i;
            least = size;
        }
    }
    *any = best != UINT32_MAX;
    if (!*any)
        return STARG_OK;
    return settle(l, best, choose_label(l, l->left.data[best], rng), fine);
}

starg_status labelling_solve(labelling *l, starg_rng *rng, bool *found) {
    bool any = true, fine = true;
    *found = false;
    l->queue.count = l->changed.count = 0;
    find_ranked(l);
    for (uint32_t i = 0; i < l->left.count; i++) {
        l->left.data[i] = l->given.data[i];
        fine = fine && l->given.data[i] != 0;
        PUSH(l->context, LABELLING_STAGE, &l->queue, i);
    }
    if (fine)
        TRY(strike_out(l, &fine));
    while (fine && any) {
        TRY(spread(l, &any, &fine));
        if (fine && !any)
            TRY(settle_one(l, rng, &any, &fine));
    }
    *found = fine;
    return STARG_OK;
}
