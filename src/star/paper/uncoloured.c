/* SPDX-License-Identifier: Apache-2.0 */
/* Uncoloured components, guarded again [YL11, section 4: "we collect each uncolored connected
 * components, and respectively compute their guarding and re-apply the region growing until all
 * tetrahedra are colored"].
 *
 * A component is what hangs together by faces. Its next guard is the middle of one of its
 * tetrahedra, of some dozens that are tried the one that sees most of the component's tetrahedra:
 * the greedy choice of a cover, with growth in between, so that what counts is what can still be
 * claimed. What the growth leaves is collected anew.
 *
 * Once time is over, what is left of a component goes to the pieces beside it.
 *
 * Invariant: each guard colours at least the tetrahedron that it stands in, so that it ends. Cost:
 * for each guard a look-up for each candidate and vertex of its component. */
#include "core/parallel.h"
#include "core/rng.h"
#include "core/streams.h"
#include "star/paper/state.h"

/* Breadth-first search through uncoloured tetrahedra. Marks are numbers of searches, so that
 * nothing has to be cleared in between: the cost of a search is the size of what it finds. */

starg_status component_create(const paper_state *s, component_search *out) {
    *out = (component_search){0};
    NEW(s->context, PAPER_STAGE, out->found.tetrahedra, s->mesh->count);
    NEW(s->context, PAPER_STAGE, out->found.vertices, s->mesh->vertex_count);
    NEW(s->context, PAPER_STAGE, out->number, s->mesh->vertex_count);
    NEW_ZERO(s->context, PAPER_STAGE, out->tet_mark, s->mesh->count);
    NEW_ZERO(s->context, PAPER_STAGE, out->vertex_mark, s->mesh->vertex_count);
    return STARG_OK;
}

void component_free(component_search *c) {
    RELEASE(c->found.tetrahedra, c->found.vertices, c->number, c->tet_mark, c->vertex_mark);
    *c = (component_search){0};
}

static void add_vertices(const paper_state *s, component_search *c, uint32_t tetrahedron) {
    for (size_t k = 0; k < 4; k++) {
        uint32_t v = s->mesh->tetrahedra[4 * (size_t)tetrahedron + k];
        if (c->vertex_mark[v] == c->search)
            continue;
        c->vertex_mark[v] = c->search;
        c->number[v] = (uint32_t)c->found.vertex_count;
        c->found.vertices[c->found.vertex_count++] = v;
    }
}

static void add_tetrahedron(const paper_state *s, component_search *c, uint32_t tetrahedron) {
    if (tetrahedron == PAPER_NONE || s->labels[tetrahedron] >= 0 ||
        c->tet_mark[tetrahedron] == c->search)
        return;
    c->tet_mark[tetrahedron] = c->search;
    c->found.tetrahedra[c->found.count++] = tetrahedron;
    add_vertices(s, c, tetrahedron);
}

void component_find(const paper_state *s, component_search *c, uint32_t tetrahedron) {
    c->search++;
    c->found.count = 0;
    c->found.vertex_count = 0;
    add_tetrahedron(s, c, tetrahedron);
    for (size_t i = 0; i < c->found.count; i++)
        for (size_t k = 0; k < 4; k++)
            add_tetrahedron(s, c, s->mesh->neighbours[4 * (size_t)c->found.tetrahedra[i] + k]);
}

enum { CANDIDATES = 32 };
static const double GRACE = 1; /* seconds */

typedef struct rest {
    paper_state *state;
    component_search component;
    paper_guard guard;
    view_scratch scratch;
} rest;

/* ---- the next guard ---- */

typedef struct trial {
    const rest *rest;
    uint32_t candidates[CANDIDATES]; /* tetrahedra */
    size_t scores[CANDIDATES];       /* tetrahedra seen from there */
} trial;

static size_t pick_candidates(const rest *r, trial *t) {
    const paper_domain *c = &r->component.found;
    starg_rng rng = starg_rng_make(r->state->context->seed, STREAM_UNCOLOURED, c->tetrahedra[0]);
    size_t count = c->count < CANDIDATES ? c->count : CANDIDATES;
    for (size_t i = 0; i < count; i++) {
        size_t at = c->count <= CANDIDATES ? i : starg_rng_below(&rng, c->count);
        t->candidates[i] = c->tetrahedra[at];
    }
    return count;
}

static starg_status make_seen(starg_context *context, void *shared, void **scratch) {
    const trial *t = shared;
    bool *seen = NULL;
    NEW(context, PAPER_STAGE, seen, t->rest->component.found.vertex_count);
    *scratch = seen;
    return STARG_OK;
}

static void free_seen(starg_context *context, void *scratch) {
    starg_release(context, scratch);
}

static starg_status score(starg_context *context, void *shared, void *scratch, size_t item) {
    trial *t = shared;
    const rest *r = t->rest;
    const paper_state *s = r->state;
    bool *seen = scratch;
    double p[3];
    (void)context;
    paper_centroid(s, t->candidates[item], p);
    for (size_t i = 0; i < r->component.found.vertex_count; i++)
        seen[i] = tet_sight_is_free(&s->sight, p,
                                    s->mesh->vertices + 3 * (size_t)r->component.found.vertices[i]);
    t->scores[item] = 0;
    for (size_t i = 0; i < r->component.found.count; i++) {
        const uint32_t *v = s->mesh->tetrahedra + 4 * (size_t)r->component.found.tetrahedra[i];
        t->scores[item] += seen[r->component.number[v[0]]] && seen[r->component.number[v[1]]] &&
                           seen[r->component.number[v[2]]] && seen[r->component.number[v[3]]];
    }
    return STARG_OK;
}

static starg_status choose_guard(rest *r) {
    trial t = {.rest = r};
    size_t best = 0;
    const starg_parallel_loop loop = {.stage = PAPER_STAGE,
                                      .count = pick_candidates(r, &t),
                                      .shared = &t,
                                      .item = score,
                                      .make_scratch = make_seen,
                                      .free_scratch = free_seen};
    starg_status status = STARG_OK;
    if (loop.count > 1)
        status = starg_parallel_for(r->state->context, &loop);
    if (status != STARG_OK)
        return status;
    for (size_t i = 1; i < loop.count; i++)
        if (t.scores[i] > t.scores[best])
            best = i;
    r->guard.home = t.candidates[best];
    paper_centroid(r->state, r->guard.home, r->guard.position);
    return STARG_OK;
}

/* ---- growth ---- */

static starg_status grow_new_piece(rest *r) {
    paper_state *s = r->state;
    const paper_domain *c = &r->component.found;
    const paper_front front = {&r->guard, 1, (int32_t)paper_pieces(s)};
    int least = c->count > PAPER_SMALL_COMPONENT ? 4 : PAPER_LEAST_SEEN;
    TRY(choose_guard(r));
    for (int k = 0; k < 3; k++)
        PUSH(s->context, PAPER_STAGE, &s->guards, r->guard.position[k]);
    view_fill(s, &r->guard, c, &r->scratch);
    growth_strict(s, &front);
    growth_relaxed(s, &front, c->tetrahedra, c->count, least);
    view_clear(&r->guard, c);
    return STARG_OK;
}

/* The guards before may have used up all the time: a little more is taken for what they leave. */
static bool must_hurry(const starg_context *context) {
    return starg_seconds_left(context) < -GRACE;
}

static starg_status colour_component(rest *r, uint32_t tetrahedron, size_t max_pieces,
                                     bool *time_limited) {
    bool hurry = must_hurry(r->state->context);
    *time_limited = *time_limited || hurry;
    component_find(r->state, &r->component, tetrahedron);
    if (hurry || (max_pieces > 0 && paper_pieces(r->state) >= max_pieces))
        growth_absorb(r->state, r->component.found.tetrahedra, r->component.found.count);
    if (r->state->labels[tetrahedron] >= 0)
        return STARG_OK;
    return grow_new_piece(r);
}

starg_status uncoloured_regrow(paper_state *s, size_t max_pieces, bool *time_limited) {
    starg_status status = STARG_OK;
    rest r = {.state = s};
    starg_progress_begin_part(s->context, PAPER_STAGE, 0.5);
    STARG_TRY(component_create(s, &r.component));
    STARG_TRY(view_scratch_create(s, &r.scratch));
    STARG_TRY(view_create(s, &r.guard));
    for (size_t t = 0; t < s->mesh->count; t++) {
        starg_progress_step(s->context, t, s->mesh->count);
        while (s->labels[t] < 0) {
            STARG_TRY(starg_check_cancel(s->context, PAPER_STAGE));
            STARG_TRY(colour_component(&r, (uint32_t)t, max_pieces, time_limited));
        }
    }
done:
    starg_progress_end(s->context);
    component_free(&r.component);
    view_scratch_free(&r.scratch);
    view_free(&r.guard);
    return status;
}
