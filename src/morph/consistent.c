/* SPDX-License-Identifier: Apache-2.0 */
/* Consistent guarding [YL11, section 5.2]: guards of A and counterparts in B, and the pieces of the
 * surface that each pair sees.
 *
 * Stages: candidates are the nodes of A's curve skeleton; the counterpart of a node is its image
 * under the best similarity transform of the surface vertices represented by it and its neighbours,
 * or their images' mean if that is not inside B; candidates without a counterpart strictly inside B
 * are dropped. A face is simultaneously visible to a candidate if A shows it to the candidate and B
 * shows its image to the counterpart: a bit matrix, from which set cover chooses the fewest rows.
 * Each face goes to the nearest guard that sees it (by the sum of both distances). Faces that no
 * candidate sees simultaneously take the guard of a neighbour, and are counted.
 *
 * All visibility is exact; if B intersects itself, a guard still sees only what no face hides.
 * Cost: one skeleton, two visibility matrices and a set cover. */

#include "geometry/vec3.h"
#include "mesh/solid.h"
#include "mesh/topology.h"
#include "morph/morph.h"
#include "starguard/cover.h"
#include "starguard/skeleton.h"

static const char STAGE[] = "consistent guards";
static const double WHOLE = 1e-3; /* share of the global motion in a counterpart's */

typedef struct guarding {
    starg_morph *morph;
    starg_solid *solids[2];
    starg_skeleton *skeleton;
    starg_bits *seen; /* count x faces, by both */
    starg_cover *cover;
} guarding;

/* ---- ends ---- */

starg_status morph_solid(const starg_morph *m, int end, starg_solid **out) {
    starg_mesh *mesh = NULL;
    *out = NULL;
    starg_status status =
        starg_mesh_create(m->context, end ? m->target : m->source, m->mesh->vertex_count,
                          m->mesh->faces, m->mesh->face_count, &mesh);
    if (status == STARG_OK)
        status = solid_make(m->context, mesh, out);
    if (status == STARG_OK)
        status = solid_must_not_share(m->context, *out, STAGE);
    if (status != STARG_OK) {
        starg_solid_free(*out);
        *out = NULL;
    }
    starg_mesh_free(mesh);
    return status;
}

/* ---- counterparts ---- */

/* Sums over surface vertices p and their images q, to fit a similarity transform. */
typedef struct moments {
    double p[3], q[3], cross[9], pp, qq, count;
} moments;

static void add_vertex(moments *sum, const double p[3], const double q[3]) {
    vec3_along(sum->p, 1, p, sum->p);
    vec3_along(sum->q, 1, q, sum->q);
    for (int k = 0; k < 9; k++)
        sum->cross[k] += q[k / 3] * p[k % 3];
    sum->pp += vec3_dot(p, p);
    sum->qq += vec3_dot(q, q);
    sum->count++;
}

static void add_moments(moments *sum, const moments *other) {
    vec3_along(sum->p, 1, other->p, sum->p);
    vec3_along(sum->q, 1, other->q, sum->q);
    for (int k = 0; k < 9; k++)
        sum->cross[k] += other->cross[k];
    sum->pp += other->pp;
    sum->qq += other->qq;
    sum->count += other->count;
}

/* Turns the sums into means and centred moments. */
static void center_moments(moments *m) {
    for (int k = 0; k < 3; k++) {
        m->p[k] /= m->count;
        m->q[k] /= m->count;
    }
    for (int k = 0; k < 9; k++)
        m->cross[k] -= m->count * m->q[k / 3] * m->p[k % 3];
    m->pp -= m->count * vec3_dot(m->p, m->p);
    m->qq -= m->count * vec3_dot(m->q, m->q);
}

/* Over the vertices of each node and its neighbours; `own` is working memory. The last entry is
 * global. */
static void gather_moments(const guarding *g, moments *own, moments *all) {
    const starg_morph *m = g->morph;
    const starg_skeleton *s = g->skeleton;
    for (size_t v = 0; v < m->mesh->vertex_count; v++)
        add_vertex(&own[s->vertex_nodes[v]], m->mesh->vertices + 3 * v, m->images + 3 * v);
    for (size_t i = 0; i < s->node_count; i++) {
        add_moments(&all[i], &own[i]);
        add_moments(&all[s->node_count], &own[i]);
    }
    for (size_t e = 0; e < s->edge_count; e++) {
        add_moments(&all[s->edges[2 * e]], &own[s->edges[2 * e + 1]]);
        add_moments(&all[s->edges[2 * e + 1]], &own[s->edges[2 * e]]);
    }
    for (size_t i = 0; i <= s->node_count; i++)
        if (all[i].count > 0)
            center_moments(&all[i]);
}

/* From scaled coordinates to those of an input, and back. */
static void unscale(const starg_morph *m, int end, const double p[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = m->centers[end][k] + m->sizes[end] * p[k];
}

static void scale(const starg_morph *m, int end, const double p[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (p[k] - m->centers[end][k]) / m->sizes[end];
}

/* The similarity transform of the node's neighbourhood, mixed with a little of the global one,
 * which decides where the neighbourhood is too small or flat. */
static void follow_map(const moments *own, const moments *whole, const double p[3], double out[3]) {
    double share = WHOLE * (own->pp > 0 ? own->pp / whole->pp : 1), cross[9], rotation[9];
    double offset[3];
    for (int k = 0; k < 9; k++)
        cross[k] = own->cross[k] + share * whole->cross[k];
    polar_rotation(cross, rotation);
    double scale_by =
        sqrt((fmax(0, own->qq) + share * whole->qq) / (fmax(0, own->pp) + share * whole->pp));
    vec3_subtract(p, own->p, offset);
    matrix_apply(rotation, offset, offset);
    vec3_along(own->q, scale_by, offset, out);
}

/* False if no counterpart is inside B. */
static bool counterpart(const guarding *g, const moments *own, const moments *whole,
                        const double node[3], double out[3]) {
    double place[3];
    if (!(own->count > 0))
        return false;
    scale(g->morph, 0, node, place);
    follow_map(own, whole, place, place);
    unscale(g->morph, 1, place, out);
    if (starg_solid_contains(g->solids[1], out))
        return true;
    unscale(g->morph, 1, own->q, out);
    return starg_solid_contains(g->solids[1], out);
}

static starg_status find_candidates(guarding *g, size_t wanted) {
    starg_context *context = g->morph->context;
    starg_skeleton_options options;
    SCOPED moments *own = NULL, *all = NULL;
    starg_skeleton_options_default(&options);
    options.node_count = wanted;
    TRY(starg_skeleton_create(context, g->solids[0], &options, &g->skeleton));
    size_t nodes = g->skeleton->node_count;
    NEW_ZERO(context, STAGE, own, nodes);
    NEW_ZERO(context, STAGE, all, nodes + 1);
    NEW(context, STAGE, g->morph->candidates[0], 3 * nodes);
    NEW(context, STAGE, g->morph->candidates[1], 3 * nodes);
    gather_moments(g, own, all);
    for (size_t i = 0; i < nodes; i++) {
        const double *node = g->skeleton->positions + 3 * i;
        if (!counterpart(g, &all[i], &all[nodes], node,
                         g->morph->candidates[1] + 3 * g->morph->candidate_count))
            continue;
        vec3_copy(node, g->morph->candidates[0] + 3 * g->morph->candidate_count++);
    }
    if (g->morph->candidate_count == 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "no node of A's skeleton has a counterpart inside B; the map may be "
                          "too distorted. --method arap needs no guards");
    return STARG_OK;
}

/* ---- cover ---- */

static starg_status see(guarding *g) {
    starg_context *context = g->morph->context;
    SCOPED_BY(starg_bits_drop) starg_bits *first = NULL, *second = NULL;
    TRY(starg_visibility(context, g->solids[0], g->morph->candidates[0], g->morph->candidate_count,
                         NULL, &first));
    TRY(starg_visibility(context, g->solids[1], g->morph->candidates[1], g->morph->candidate_count,
                         NULL, &second));
    TRY(starg_bits_create(context, g->morph->candidate_count, g->morph->mesh->face_count,
                          &g->seen));
    for (size_t i = 0; i < g->morph->candidate_count; i++)
        for (size_t f = 0; f < g->morph->mesh->face_count; f++)
            if (starg_bits_test(first, i, f) && starg_bits_test(second, i, f))
                starg_bits_set(g->seen, i, f);
    return STARG_OK;
}

static starg_status choose(guarding *g) {
    starg_morph *m = g->morph;
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = g->seen;
    options.max_nodes = MORPH_COVER_NODES;
    TRY(starg_cover_solve(m->context, &problem, &options, &g->cover));
    m->guard_count = g->cover->count;
    m->lower_bound = g->cover->lower_bound;
    if (m->guard_count == 0)
        return starg_fail(m->context, STARG_ERROR_MESH, STAGE,
                          "no candidate sees a face of A and its image in B; the map may be too "
                          "distorted. --method arap needs no guards");
    for (int end = 0; end < 2; end++) {
        NEW(m->context, STAGE, m->guards[end], 3 * m->guard_count);
        NEW(m->context, STAGE, m->places[end], 3 * m->guard_count);
        for (size_t i = 0; i < m->guard_count; i++) {
            const double *from = g->morph->candidates[end] + 3 * (size_t)g->cover->rows[i];
            vec3_copy(from, m->guards[end] + 3 * i);
            scale(m, end, from, m->places[end] + 3 * i);
        }
    }
    return STARG_OK;
}

/* ---- pieces ---- */

/* The nearest guard that sees the face at both ends; UINT32_MAX if none does. */
static uint32_t nearest_viewer(const guarding *g, size_t face) {
    const starg_morph *m = g->morph;
    const uint32_t *corner = m->mesh->faces + 3 * face;
    double a[3], b[3], least = INFINITY;
    uint32_t best = UINT32_MAX;
    morph_centroid(m->mesh->vertices, corner, a);
    morph_centroid(m->images, corner, b);
    for (uint32_t i = 0; i < m->guard_count; i++) {
        if (!starg_bits_test(g->seen, g->cover->rows[i], face))
            continue;
        double d = vec3_distance(a, m->places[0] + 3 * (size_t)i) +
                   vec3_distance(b, m->places[1] + 3 * (size_t)i);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    return best;
}

/* Faces without a guard take a neighbour's, ring by ring. */
static starg_status spread_pieces(starg_morph *m) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED uint32_t *queue = NULL;
    size_t count = 0;
    TRY(topology_create(m->context, m->mesh, &topology));
    NEW(m->context, STAGE, queue, m->mesh->face_count);
    for (uint32_t f = 0; f < m->mesh->face_count; f++)
        if (m->pieces[f] != UINT32_MAX)
            queue[count++] = f;
    for (size_t i = 0; i < count; i++)
        for (uint32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; h++) {
            uint32_t other = topology->twin[h] / 3;
            if (m->pieces[other] != UINT32_MAX)
                continue;
            m->pieces[other] = m->pieces[queue[i]];
            queue[count++] = other;
        }
    for (size_t f = 0; f < m->mesh->face_count; f++) /* a shell that no guard sees */
        if (m->pieces[f] == UINT32_MAX)
            m->pieces[f] = 0;
    return STARG_OK;
}

static starg_status cut(guarding *g) {
    starg_morph *m = g->morph;
    NEW(m->context, STAGE, m->pieces, m->mesh->face_count);
    NEW(m->context, STAGE, m->guarded, m->mesh->face_count);
    for (size_t f = 0; f < m->mesh->face_count; f++) {
        m->pieces[f] = nearest_viewer(g, f);
        m->guarded[f] = m->pieces[f] != UINT32_MAX;
        m->unguarded += !m->guarded[f];
    }
    return spread_pieces(m);
}

starg_status morph_guard(starg_morph *m, size_t candidates) {
    starg_status status = STARG_OK;
    guarding g = {.morph = m};
    for (int end = 0; end < 2; end++) {
        STARG_TRY(morph_solid(m, end, &g.solids[end]));
        solid_tell(m->context, end == 0 ? "A: " : "B in A's connectivity: ", g.solids[end]->check);
    }
    STARG_TRY(find_candidates(&g, candidates));
    STARG_TRY(see(&g));
    STARG_TRY(choose(&g));
    STARG_TRY(cut(&g));
done:
    starg_solid_free(g.solids[0]);
    starg_solid_free(g.solids[1]);
    starg_skeleton_free(m->context, g.skeleton);
    starg_bits_free(g.seen);
    starg_cover_free(g.cover);
    return status;
}
