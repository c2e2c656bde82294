/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about the way through guards: it passes all of those that do not stay, in their order, is
 * as long as told, and no segment of it meets a face but for straight legs that are said to be
 * blocked. That a shorter way could be found is open. Cost: a query of the tree for each segment.
 */
#include <math.h>

#include "verify/facts.h"

static bool is_blocked(const starg_tour *t, size_t leg) {
    for (size_t i = 0; i < t->blocked_count; i++)
        if (t->blocked[i] == leg)
            return true;
    return false;
}

static bool stops_at_guards(const starg_guards *guards) {
    const starg_tour *t = &guards->tour;
    size_t first = guards->options.keep_count;
    bool same = t->stop_count == guards->count - first;
    for (size_t i = 0; same && i < t->stop_count; i++)
        for (int x = 0; x < 3; x++)
            same = same &&
                   t->points[3 * (size_t)t->stops[i] + x] == guards->positions[3 * (first + i) + x];
    for (size_t i = 0; i < t->blocked_count; i++)
        same = same && t->blocked[i] + 1 < t->stop_count &&
               t->stops[t->blocked[i] + 1] == t->stops[t->blocked[i]] + 1;
    return same;
}

static double find_length(const starg_tour *t) {
    double length = 0;
    for (size_t i = 3; i < 3 * t->point_count; i += 3)
        length += hypot(hypot(t->points[i] - t->points[i - 3], t->points[i + 1] - t->points[i - 2]),
                        t->points[i + 2] - t->points[i - 1]);
    return length;
}

/* Segments of legs that are not said to be blocked, but meet a face. */
static size_t count_crossing(const verify_facts *known, size_t *first) {
    const starg_tour *t = &known->guards->tour;
    size_t bad = 0;
    for (size_t i = 0, leg = 0; i + 1 < t->point_count; i++) {
        const double *p = t->points + 3 * i, *q = p + 3;
        bool on[2];
        leg += i == t->stops[leg + 1];
        if (is_blocked(t, leg))
            continue;
        verify_tree_winding(known->tree, p, &on[0]);
        verify_tree_winding(known->tree, q, &on[1]);
        if ((on[0] || on[1] || verify_tree_blocks(known->tree, p, q)) && bad++ == 0)
            *first = i;
    }
    return bad;
}

void verify_claim_tour(starg_verdict *verdict, const verify_facts *known) {
    const starg_guards *guards = known->guards;
    const starg_tour *t = &guards->tour;
    size_t first = 0;
    if (t->point_count == 0 || guards->count < guards->options.keep_count)
        return;
    bool stops = stops_at_guards(guards);
    double length = find_length(t);
    verify_claim(verdict, stops, "the tour stops at each guard, in their order");
    verify_claim(verdict, fabs(length - t->length) <= VERIFY_TOLERANCE * length,
                 "the tour is %.9g long (found: %.9g)", t->length, length);
    if (stops)
        verify_claim_all(verdict, count_crossing(known, &first), first,
                         "segments of the tour meet no face");
}
