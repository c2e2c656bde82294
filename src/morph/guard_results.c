/* SPDX-License-Identifier: Apache-2.0 */
/* The guards at both ends of a morph as separate results, and the number that each end alone would
 * need.
 *
 * Both use the candidates of the common problem, so the only difference is that a pair must see at
 * both ends. Cost: that of guarding with given candidates. */
#include "mesh/solid.h"
#include "morph/morph.h"

static const char STAGE[] = "consistent guards";

static starg_status check_method(const starg_morph *m) {
    if (morph_has_guards(m))
        return STARG_OK;
    return starg_fail(m->context, STARG_ERROR_ARGUMENT, STAGE,
                      "the methods arap and linear have no guards; use star or spherical");
}

starg_status starg_morph_guards_result(const starg_morph *m, int end, starg_guards **out) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    *out = NULL;
    TRY(check_method(m));
    TRY(morph_solid(m, end, &solid));
    TRY(starg_guards_given(m->context, solid, m->guards[end != 0], m->guard_count, out));
    (*out)->candidate_count = m->candidate_count;
    (*out)->lower_bound = m->lower_bound;
    (*out)->optimal = m->lower_bound == m->guard_count;
    return STARG_OK;
}

starg_status starg_morph_guards_separate(const starg_morph *m, int end, starg_guards **out) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    starg_guard_options options;
    *out = NULL;
    TRY(check_method(m));
    starg_guard_options_default(&options);
    options.method = STARG_GUARD_ILP;
    options.candidates = STARG_CANDIDATES_GIVEN;
    options.points = m->candidates[end != 0];
    options.point_count = options.candidate_count = m->candidate_count;
    options.max_nodes = MORPH_COVER_NODES;
    TRY(morph_solid(m, end, &solid));
    return starg_guard(m->context, solid, &options, out);
}
