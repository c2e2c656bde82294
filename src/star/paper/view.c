/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility carried over to the vertices of tetrahedra [YL11, section 4]: for each guard, which
 * vertices it sees past the boundary of the whole solid, into which tetrahedron each of them looks
 * for it, and the costs that follow. Cost: a look-up in the tree for each guard and vertex. */
#include "star/paper/state.h"

#include "core/parallel.h"
#include "geometry/vec3.h"

starg_status view_scratch_create(const paper_state *s, view_scratch *out) {
    starg_status status = STARG_OK;
    *out = (view_scratch){0};
    STARG_NEW_ZERO(s->context, PAPER_STAGE, out->waiting, s->mesh->count);
    STARG_NEW(s->context, PAPER_STAGE, out->stack, s->mesh->count);
done:
    if (status != STARG_OK)
        view_scratch_free(out);
    return status;
}

void view_scratch_free(view_scratch *scratch) {
    RELEASE(scratch->waiting, scratch->stack);
    *scratch = (view_scratch){0};
}

starg_status view_create(const paper_state *s, paper_guard *g) {
    g->toward = NULL;
    g->cost = NULL;
    NEW(s->context, PAPER_STAGE, g->toward, s->mesh->vertex_count);
    NEW(s->context, PAPER_STAGE, g->cost, s->mesh->count);
    memset(g->toward, 0xff, s->mesh->vertex_count * sizeof *g->toward);
    return STARG_OK;
}

void view_free(paper_guard *g) {
    RELEASE(g->toward, g->cost);
    g->toward = NULL;
    g->cost = NULL;
}

void view_fill(const paper_state *s, paper_guard *g, const paper_domain *domain,
               view_scratch *scratch) {
    for (size_t i = 0; i < domain->vertex_count; i++) {
        uint32_t v = domain->vertices[i];
        if (tet_sight_is_free(&s->sight, g->position, s->mesh->vertices + 3 * (size_t)v))
            g->toward[v] = dependency_toward(s, v, g->position);
    }
    cost_accumulate(s, g, domain->tetrahedra, domain->count, scratch->waiting, scratch->stack);
}

void view_clear(paper_guard *g, const paper_domain *domain) {
    for (size_t i = 0; i < domain->vertex_count; i++)
        g->toward[domain->vertices[i]] = PAPER_NONE;
}

/* ---- all guards ---- */

typedef struct views {
    paper_state *state;
    const paper_domain *all;
    paper_guard *guards;
} views;

static starg_status make_scratch(starg_context *context, void *shared, void **scratch) {
    const views *job = shared;
    SCOPED view_scratch *own = NULL;
    NEW_ZERO(context, PAPER_STAGE, own, 1);
    TRY(view_scratch_create(job->state, own));
    *scratch = own;
    own = NULL;
    return STARG_OK;
}

static void free_scratch(starg_context *context, void *scratch) {
    (void)context;
    view_scratch *own = scratch;
    RELEASE(own->waiting, own->stack, own);
}

static starg_status make_view(starg_context *context, void *shared, void *scratch, size_t item) {
    const views *job = shared;
    paper_guard *g = &job->guards[item];
    (void)context;
    TRY(view_create(job->state, g));
    g->home = dependency_home(job->state->mesh, g->position);
    view_fill(job->state, g, job->all, scratch);
    return STARG_OK;
}

starg_status views_create(paper_state *s, const paper_domain *all, const double *positions,
                          size_t count, paper_guard *guards) {
    views job = {.state = s, .all = all, .guards = guards};
    for (size_t i = 0; i < count; i++)
        vec3_copy(positions + 3 * i, guards[i].position);
    const starg_parallel_loop loop = {.stage = PAPER_STAGE,
                                      .count = count,
                                      .shared = &job,
                                      .item = make_view,
                                      .make_scratch = make_scratch,
                                      .free_scratch = free_scratch,
                                      .share = 0.5};
    return starg_parallel_for(s->context, &loop);
}
