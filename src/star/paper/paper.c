/* SPDX-License-Identifier: Apache-2.0 */
/* Star decomposition by growth from guards [YL11, section 4].
 *
 * Problem: give each tetrahedron to one of few guards, so that nearly all vertices of a piece are
 * seen from its guard.
 *
 * Stages: guards (given, or those of section 3); what they see of the vertices of tetrahedra, and
 * how tetrahedra depend on each other (view.c, dependency.c, cost.c); growth, strict and then
 * relaxed (growth.c); guards for what is left (uncoloured.c); smoothing of the borders between
 * pieces (smooth.c). Then the star-shaped pieces are counted, which the paper does
 * not say.
 *
 * Invariants: every tetrahedron has a colour in the end, every colour a tetrahedron; guards are
 * strictly inside the solid. The same for any number of threads. Cost: O(K n log n) for K guards.
 */
#include "star/decomposition.h"

#include "geometry/vec3.h"
#include "star/paper/state.h"
#include "starguard/guard.h"

STARG_DROP_RESULT(starg_guards)

/* The tetrahedra around each vertex: a counting sort by vertex. Cost: O(n). */

starg_status tet_rings_create(starg_context *context, const starg_tetmesh *mesh, tet_rings *out) {
    *out = (tet_rings){0};
    NEW_ZERO(context, PAPER_STAGE, out->first, mesh->vertex_count + 1);
    NEW(context, PAPER_STAGE, out->at, 4 * mesh->count);
    for (size_t i = 0; i < 4 * mesh->count; i++)
        out->first[mesh->tetrahedra[i]]++;
    for (size_t v = 0, sum = 0; v <= mesh->vertex_count; v++) {
        sum += out->first[v]; /* ends now; beginnings when all are filed */
        out->first[v] = sum;
    }
    for (size_t i = 4 * mesh->count; i-- > 0;)
        out->at[--out->first[mesh->tetrahedra[i]]] = (uint32_t)(i / 4);
    return STARG_OK;
}

void tet_rings_free(tet_rings *rings) {
    RELEASE(rings->first, rings->at);
    *rings = (tet_rings){0};
}

/* ---- state ---- */

static double find_diagonal(const starg_tetmesh *mesh) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        lower[i % 3] = fmin(lower[i % 3], mesh->vertices[i]);
        upper[i % 3] = fmax(upper[i % 3], mesh->vertices[i]);
    }
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

static starg_status state_create(starg_context *context, const starg_tetmesh *mesh,
                                 paper_state *s) {
    *s = (paper_state){.context = context, .diagonal = find_diagonal(mesh)};
    TRY(tetmesh_copy(context, mesh, &s->mesh));
    TRY(tet_sight_create(context, s->mesh, &s->sight));
    TRY(tet_rings_create(context, s->mesh, &s->rings));
    TRY(heap_create(context, mesh->count, &s->heap));
    NEW(context, PAPER_STAGE, s->offer, mesh->count);
    NEW(context, PAPER_STAGE, s->labels, mesh->count);
    memset(s->labels, 0xff, mesh->count * sizeof *s->labels);
    return STARG_OK;
}

static void state_free(paper_state *s) {
    tet_sight_free(&s->sight);
    tet_rings_free(&s->rings);
    heap_free(s->heap);
    RELEASE(s->offer, s->labels, s->guards.data);
    starg_tetmesh_free(s->mesh);
}

/* ---- guards ---- */

/* Takes those that are strictly inside, no more than `most` of them. */
static starg_status take_guards(paper_state *s, const double *points, size_t count, size_t most) {
    size_t outside = 0;
    for (size_t i = 0; i < count && (most == 0 || paper_pieces(s) < most); i++) {
        bool inside = tet_sight_contains(&s->sight, points + 3 * i);
        outside += !inside;
        for (size_t k = 0; inside && k < 3; k++)
            PUSH(s->context, PAPER_STAGE, &s->guards, points[3 * i + k]);
    }
    if (outside > 0)
        starg_log(s->context, STARG_LOG_NOTICE,
                  "ignoring %zu of %zu guards that are not strictly inside the tetrahedra", outside,
                  count);
    return STARG_OK;
}

/* Guards of section 3 for the boundary. Where that is no surface that they can be placed for
 * (it touches itself in an edge, for example), all is left to be guarded as it is cut. */
static starg_status place_guards(paper_state *s, size_t most, bool *time_limited) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *surface = NULL;
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED_BY(starg_guards_drop) starg_guards *guards = NULL;
    starg_guard_options wanted;
    starg_guard_options_default(&wanted);
    wanted.max_guards = most;
    TRY(starg_tetmesh_surface(s->context, s->mesh, &surface, NULL));
    starg_status status = solid_make(s->context, surface, &solid);
    if (status == STARG_OK)
        status = starg_guard(s->context, solid, &wanted, &guards);
    if (status == STARG_ERROR_MESH || status == STARG_ERROR_TIME) {
        *time_limited = status == STARG_ERROR_TIME;
        return STARG_OK;
    }
    TRY(status);
    *time_limited = guards->time_limited;
    return take_guards(s, guards->positions, guards->count, most);
}

/* ---- growth ---- */

static starg_status domain_of_all(paper_state *s, paper_domain *out) {
    NEW(s->context, PAPER_STAGE, out->tetrahedra, s->mesh->count);
    NEW(s->context, PAPER_STAGE, out->vertices, s->mesh->vertex_count);
    out->count = s->mesh->count;
    for (size_t t = 0; t < s->mesh->count; t++)
        out->tetrahedra[t] = (uint32_t)t;
    for (size_t v = 0; v < s->mesh->vertex_count; v++)
        if (s->rings.first[v] < s->rings.first[v + 1])
            out->vertices[out->vertex_count++] = (uint32_t)v;
    return STARG_OK;
}

/* Small components between the regions. */
static starg_status take_small_components(paper_state *s, const paper_front *front) {
    SCOPED_BY(component_free) component_search c = {0};
    TRY(component_create(s, &c));
    for (size_t t = 0; t < s->mesh->count; t++) {
        if (s->labels[t] >= 0 || c.tet_mark[t] > 0)
            continue;
        component_find(s, &c, (uint32_t)t);
        if (c.found.count <= PAPER_SMALL_COMPONENT)
            growth_relaxed(s, front, c.found.tetrahedra, c.found.count, PAPER_LEAST_SEEN);
    }
    return STARG_OK;
}

static starg_status grow_from_guards(paper_state *s, size_t max_pieces) {
    starg_status status = STARG_OK;
    size_t count = paper_pieces(s);
    paper_guard *guards = NULL;
    paper_domain all = {0};
    STARG_NEW_ZERO(s->context, PAPER_STAGE, guards, count);
    STARG_TRY(domain_of_all(s, &all));
    STARG_TRY(views_create(s, &all, s->guards.data, count, guards));
    const paper_front front = {guards, count, 0};
    growth_strict(s, &front);
    growth_relaxed(s, &front, all.tetrahedra, all.count, 4);
    STARG_TRY(take_small_components(s, &front));
    if (max_pieces > 0 && count >= max_pieces)
        growth_relaxed(s, &front, all.tetrahedra, all.count, 0);
done:
    for (size_t i = 0; guards != NULL && i < count; i++)
        view_free(&guards[i]);
    RELEASE(guards, all.tetrahedra, all.vertices);
    return status;
}

/* Pieces without a tetrahedron, whose guard stands where another one has been first, go. */
static starg_status drop_empty_pieces(paper_state *s) {
    size_t count = paper_pieces(s), kept = 0;
    SCOPED int32_t *number = NULL;
    NEW(s->context, PAPER_STAGE, number, count);
    memset(number, 0xff, count * sizeof *number);
    for (size_t t = 0; t < s->mesh->count; t++)
        number[s->labels[t]] = 0;
    for (size_t p = 0; p < count; p++) {
        if (number[p] < 0)
            continue;
        number[p] = (int32_t)kept;
        vec3_copy(s->guards.data + 3 * p, s->guards.data + 3 * kept++);
    }
    s->guards.count = 3 * kept;
    for (size_t t = 0; t < s->mesh->count; t++)
        s->labels[t] = number[s->labels[t]];
    return STARG_OK;
}

static starg_status finish(paper_state *s, starg_decomposition **out) {
    starg_tetmesh *mesh = s->mesh;
    int32_t *labels = s->labels;
    s->mesh = NULL;
    s->labels = NULL;
    return decomposition_finish(s->context, STARG_DECOMPOSE_PAPER, mesh, labels, s->guards.data,
                                paper_pieces(s), out);
}

starg_status paper_decompose(starg_context *context, const starg_tetmesh *mesh,
                             const starg_decompose_options *options, starg_decomposition **out) {
    SCOPED_BY(state_free) paper_state s = {0};
    bool time_limited = false;
    *out = NULL;
    IN_STAGE(context, PAPER_STAGE);
    TRY(state_create(context, mesh, &s));
    if (options->guards != NULL)
        TRY(take_guards(&s, options->guards, options->guard_count, options->max_pieces));
    else
        TRY(place_guards(&s, options->max_pieces, &time_limited));
    TRY(grow_from_guards(&s, options->max_pieces));
    TRY(uncoloured_regrow(&s, options->max_pieces, &time_limited));
    TRY(drop_empty_pieces(&s));
    TRY(smooth_borders(&s));
    TRY(finish(&s, out));
    (*out)->time_limited = time_limited;
    return STARG_OK;
}
