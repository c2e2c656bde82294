/* Uncoloured components, guarded again [YL11, section 4: "we collect each uncolored connected
 * components, and respectively compute their guarding and re-apply the region growing until all
 * tetrahedra are colored"].
 *
 * A component is what hangs together by faces. Its next guard is the middle of one of its
 * tetrahedra, of some dozens that are tried the one that sees most of the component's tetrahedra:
 * the greedy choice of a cover, with growth in between, so that what counts is what can still be
 * claimed. What the growth leaves is collected anew.
 *
 * Invariant: each guard colours at least the tetrahedron that it stands in, so that it ends. Cost:
 * for each guard a look-up for each candidate and vertex of its component. */
#include "star/paper/rest.h"

#include "core/parallel.h"
#include "core/rng.h"
#include "star/paper/growth.h"
#include "star/paper/view.h"

enum { CANDIDATES = 32, RNG_STAGE = 0x7265 };

typedef struct rest {
    paper_state *state;
    paper_domain component;
    uint32_t *tet_mark; /* by which search a tetrahedron was found last */
    uint32_t *number;   /* of vertices within the component; the mark says whether it counts */
    uint32_t *vertex_mark;
    uint32_t search;
    paper_guard guard;
    view_scratch scratch;
} rest;

/* ---- components ---- */

static void add_vertices(rest *r, uint32_t tetrahedron) {
    for (size_t k = 0; k < 4; k++) {
        uint32_t v = r->state->mesh->tetrahedra[4 * (size_t)tetrahedron + k];
        if (r->vertex_mark[v] == r->search)
            continue;
        r->vertex_mark[v] = r->search;
        r->number[v] = (uint32_t)r->component.vertex_count;
        r->component.vertices[r->component.vertex_count++] = v;
    }
}

static void add_tetrahedron(rest *r, uint32_t tetrahedron) {
    if (tetrahedron == PAPER_NONE || r->state->labels[tetrahedron] >= 0 ||
        r->tet_mark[tetrahedron] == r->search)
        return;
    r->tet_mark[tetrahedron] = r->search;
    r->component.tetrahedra[r->component.count++] = tetrahedron;
    add_vertices(r, tetrahedron);
}

/* The uncoloured component of a tetrahedron, breadth first. */
static void collect(rest *r, uint32_t tetrahedron) {
    r->search++;
    r->component.count = 0;
    r->component.vertex_count = 0;
    add_tetrahedron(r, tetrahedron);
    for (size_t i = 0; i < r->component.count; i++)
        for (size_t k = 0; k < 4; k++)
            add_tetrahedron(r,
                            r->state->mesh->neighbours[4 * (size_t)r->component.tetrahedra[i] + k]);
}

/* ---- the next guard ---- */

typedef struct trial {
    const rest *rest;
    uint32_t candidates[CANDIDATES]; /* tetrahedra */
    size_t scores[CANDIDATES];       /* tetrahedra seen from there */
} trial;

static size_t pick_candidates(const rest *r, trial *t) {
    const paper_domain *c = &r->component;
    starg_rng rng = starg_rng_make(r->state->context->seed, RNG_STAGE, c->tetrahedra[0]);
    size_t count = c->count < CANDIDATES ? c->count : CANDIDATES;
    for (size_t i = 0; i < count; i++) {
        size_t at = c->count <= CANDIDATES ? i : starg_rng_below(&rng, c->count);
        t->candidates[i] = c->tetrahedra[at];
    }
    return count;
}

static starg_status make_seen(starg_context *context, void *shared, void **scratch) {
    starg_status status = STARG_OK;
    const trial *t = shared;
    bool *seen = NULL;
    STARG_NEW(context, PAPER_STAGE, seen, t->rest->component.vertex_count);
    *scratch = seen;
done:
    return status;
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
    for (size_t i = 0; i < r->component.vertex_count; i++)
        seen[i] = tet_sight_is_free(&s->sight, p,
                                    s->mesh->vertices + 3 * (size_t)r->component.vertices[i]);
    t->scores[item] = 0;
    for (size_t i = 0; i < r->component.count; i++) {
        const uint32_t *v = s->mesh->tetrahedra + 4 * (size_t)r->component.tetrahedra[i];
        t->scores[item] += seen[r->number[v[0]]] && seen[r->number[v[1]]] &&
                           seen[r->number[v[2]]] && seen[r->number[v[3]]];
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
    starg_status status = STARG_OK;
    paper_state *s = r->state;
    const paper_front front = {&r->guard, 1, (int32_t)paper_pieces(s)};
    STARG_TRY(choose_guard(r));
    for (int k = 0; k < 3; k++)
        STARG_PUSH(s->context, PAPER_STAGE, &s->guards, r->guard.position[k]);
    view_fill(s, &r->guard, &r->component, &r->scratch);
    growth_strict(s, &front);
    growth_relaxed(s, &front, r->component.tetrahedra, r->component.count, PAPER_LEAST_SEEN);
    view_clear(&r->guard, &r->component);
done:
    return status;
}

static starg_status colour_component(rest *r, uint32_t tetrahedron, size_t max_pieces) {
    collect(r, tetrahedron);
    if (max_pieces > 0 && paper_pieces(r->state) >= max_pieces)
        growth_absorb(r->state, r->component.tetrahedra, r->component.count);
    if (r->state->labels[tetrahedron] >= 0)
        return STARG_OK;
    return grow_new_piece(r);
}

static starg_status rest_create(rest *r) {
    starg_status status = STARG_OK;
    starg_context *context = r->state->context;
    size_t count = r->state->mesh->count, vertex_count = r->state->mesh->vertex_count;
    STARG_NEW(context, PAPER_STAGE, r->component.tetrahedra, count);
    STARG_NEW(context, PAPER_STAGE, r->component.vertices, vertex_count);
    STARG_NEW_ZERO(context, PAPER_STAGE, r->tet_mark, count);
    STARG_NEW_ZERO(context, PAPER_STAGE, r->vertex_mark, vertex_count);
    STARG_NEW(context, PAPER_STAGE, r->number, vertex_count);
    STARG_TRY(view_scratch_create(r->state, &r->scratch));
    STARG_TRY(view_create(r->state, &r->guard));
done:
    return status;
}

static void rest_free(rest *r) {
    starg_context *context = r->state->context;
    starg_release(context, r->component.tetrahedra);
    starg_release(context, r->component.vertices);
    starg_release(context, r->tet_mark);
    starg_release(context, r->vertex_mark);
    starg_release(context, r->number);
    view_scratch_free(r->state, &r->scratch);
    view_free(r->state, &r->guard);
}

starg_status rest_colour(paper_state *s, size_t max_pieces) {
    starg_status status = STARG_OK;
    rest r = {.state = s};
    STARG_TRY(rest_create(&r));
    for (size_t t = 0; t < s->mesh->count; t++) {
        starg_progress_step(s->context, t, s->mesh->count);
        while (s->labels[t] < 0) {
            STARG_TRY(starg_check_cancel(s->context, PAPER_STAGE));
            STARG_TRY(colour_component(&r, (uint32_t)t, max_pieces));
        }
    }
done:
    rest_free(&r);
    return status;
}
