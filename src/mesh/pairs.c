/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of faces that may meet, also where thousands of them share a corner.
 *
 * Problem: the boxes of all faces at a vertex meet, so a tree of boxes gives all pairs of them.
 *
 * Method: vertices with many faces are hubs. Two faces of a hub that meet elsewhere are seen from
 * it in a common direction, so they are found by a tree over boxes of directions: an edge opposite
 * of the hub, seen as a chord of the unit sphere of length c, is an arc within c^2 / 4 of the
 * chord. The faces without a hub, and those of each hub, have a tree each, and each tree is asked
 * for the boxes of all that come after it. Without hubs the tree of all faces is asked.
 *
 * Cost: O(n log n) and the pairs, where faces are not long compared with their distances. */

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "mesh/examine.h"

static const char STAGE[] = "check";

/* Swaps corner i of the triple with corner k. */
static void bring_to(uint32_t triple[3], int i, int k) {
    uint32_t swap = triple[i];
    triple[i] = triple[k];
    triple[k] = swap;
}

/* Moves the common corners to the front of both, in the same order; returns their number. */
static int align_shared(uint32_t u[3], uint32_t v[3]) {
    int shared = 0;
    for (int i = 0; i < 3; i++)
        for (int j = shared; j < 3; j++)
            if (u[i] == v[j]) {
                bring_to(u, i, shared);
                bring_to(v, j, shared);
                shared++;
                break;
            }
    return shared;
}

triangle_contact faces_contact(const double *vertices, const uint32_t a[3], const uint32_t b[3]) {
    uint32_t u[3], v[3];
    const double *s[3], *t[3];
    memcpy(u, a, sizeof u);
    memcpy(v, b, sizeof v);
    int shared = align_shared(u, v);
    for (int k = 0; k < 3; k++) {
        s[k] = vertices + 3 * (size_t)u[k];
        t[k] = vertices + 3 * (size_t)v[k];
    }
    return triangles_contact(s, t, shared);
}

enum { HUB = 64 }; /* more faces at a vertex make it a hub */

#define NO_HUB UINT32_MAX

static const double ROUNDING = 1e-12; /* of a direction */

/* Some of the faces, and trees over them. */
typedef struct group {
    const uint32_t *faces; /* numbers in the mesh */
    uint32_t *corners;     /* count x 3 */
    size_t count;
    bvh *tree;
} group;

typedef struct pairing {
    starg_context *context;
    const starg_mesh *mesh;
    bvh_visit_pair *visit;
    void *user;
    uint32_t *hub;   /* by face: its hub, or NO_HUB */
    uint32_t *list;  /* faces, those without a hub first, then hub by hub */
    uint32_t *order; /* by vertex: 1 + the number of its group, if it is a hub */
    group *groups;
    size_t count;
    bool ended;
} pairing;

/* ---- groups ---- */

/* A face belongs to the first of its corners that is a hub. */
static starg_status find_hubs(pairing *p) {
    const starg_mesh *mesh = p->mesh;
    SCOPED uint32_t *valence = NULL;
    NEW_ZERO(p->context, STAGE, valence, mesh->vertex_count);
    NEW_ZERO(p->context, STAGE, p->order, mesh->vertex_count);
    NEW(p->context, STAGE, p->hub, mesh->face_count);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        valence[mesh->faces[i]]++;
    p->count = 1;
    for (size_t f = 0; f < mesh->face_count; f++) {
        p->hub[f] = NO_HUB;
        for (size_t k = 3 * f; k < 3 * f + 3 && p->hub[f] == NO_HUB; k++)
            if (valence[mesh->faces[k]] > HUB)
                p->hub[f] = mesh->faces[k];
        if (p->hub[f] != NO_HUB && p->order[p->hub[f]] == 0)
            p->order[p->hub[f]] = (uint32_t)++p->count;
    }
    return STARG_OK;
}

static size_t group_of(const pairing *p, size_t face) {
    return p->hub[face] == NO_HUB ? 0 : p->order[p->hub[face]] - 1;
}

static starg_status make_groups(pairing *p) {
    size_t faces = p->mesh->face_count, used = 0;
    NEW_ZERO(p->context, STAGE, p->groups, p->count);
    NEW(p->context, STAGE, p->list, faces);
    for (size_t f = 0; f < faces; f++)
        p->groups[group_of(p, f)].count++;
    for (size_t g = 0; g < p->count; g++) {
        group *own = &p->groups[g];
        own->faces = p->list + used;
        used += own->count;
        NEW(p->context, STAGE, own->corners, 3 * own->count);
        own->count = 0;
    }
    for (size_t f = 0; f < faces; f++) {
        group *own = &p->groups[group_of(p, f)];
        memcpy(own->corners + 3 * own->count, p->mesh->faces + 3 * f, 3 * sizeof *own->corners);
        p->list[(size_t)(own->faces - p->list) + own->count++] = (uint32_t)f;
    }
    for (size_t g = 0; g < p->count; g++)
        TRY(bvh_create(p->context, p->mesh->vertices, p->groups[g].corners, p->groups[g].count,
                       &p->groups[g].tree));
    return STARG_OK;
}

static void free_groups(pairing *p) {
    for (size_t g = 0; p->groups != NULL && g < p->count; g++) {
        bvh_free(p->groups[g].tree);
        starg_release(p->context, p->groups[g].corners);
    }
    RELEASE(p->groups, p->list, p->hub, p->order);
}

/* ---- visits ---- */

typedef struct among {
    pairing *p;
    const group *own;
    uint32_t face; /* with which those of the group are paired */
} among;

static bool visit_within(void *user, uint32_t a, uint32_t b) {
    among *m = user;
    m->p->ended = !m->p->visit(m->p->user, m->own->faces[a], m->own->faces[b]);
    return !m->p->ended;
}

static bool visit_across(void *user, uint32_t b) {
    among *m = user;
    m->p->ended = !m->p->visit(m->p->user, m->face, m->own->faces[b]);
    return !m->p->ended;
}

static void box_of(const starg_mesh *mesh, uint32_t face, bvh_box *box) {
    for (int k = 0; k < 3; k++) {
        box->lower[k] = INFINITY;
        box->upper[k] = -INFINITY;
        for (size_t i = 0; i < 3; i++) {
            double x = mesh->vertices[3 * (size_t)mesh->faces[3 * (size_t)face + i] + (size_t)k];
            box->lower[k] = fmin(box->lower[k], x);
            box->upper[k] = fmax(box->upper[k], x);
        }
    }
}

/* A box of the directions from the hub to the face, as two corners; all of them where they are not
 * known well. */
static void directions_of(const starg_mesh *mesh, uint32_t hub, uint32_t face, double corners[6]) {
    const uint32_t *c = mesh->faces + 3 * (size_t)face;
    double direction[2][3], chord;
    int count = 0;
    bool known = true;
    for (int i = 0; i < 3; i++) {
        if (c[i] == hub || count == 2)
            continue;
        vec3_subtract(mesh->vertices + 3 * (size_t)c[i], mesh->vertices + 3 * (size_t)hub,
                      direction[count]);
        double length = vec3_length(direction[count]);
        known = known && length > 1e-100 && length < 1e100;
        for (int k = 0; k < 3; k++)
            direction[count][k] /= length;
        count++;
    }
    known = known && count == 2;
    chord = known ? vec3_distance(direction[0], direction[1]) : 2;
    double margin = chord * chord / 4 + ROUNDING;
    for (int k = 0; k < 3; k++) {
        corners[k] = known ? fmin(direction[0][k], direction[1][k]) - margin : -1;
        corners[k + 3] = known ? fmax(direction[0][k], direction[1][k]) + margin : 1;
    }
}

/* Each direction box stands as a triangle without area. */
static starg_status visit_hub(pairing *p, const group *own) {
    SCOPED double *corners = NULL;
    SCOPED uint32_t *faces = NULL;
    SCOPED_BY(bvh_drop) bvh *tree = NULL;
    among m = {p, own, 0};
    NEW(p->context, STAGE, corners, 6 * own->count);
    NEW(p->context, STAGE, faces, 3 * own->count);
    for (uint32_t i = 0; i < own->count; i++) {
        directions_of(p->mesh, p->hub[own->faces[i]], own->faces[i], corners + 6 * (size_t)i);
        faces[3 * (size_t)i] = faces[3 * (size_t)i + 1] = 2 * i;
        faces[3 * (size_t)i + 2] = 2 * i + 1;
    }
    TRY(bvh_create(p->context, corners, faces, own->count, &tree));
    bvh_query_pairs(tree, visit_within, &m);
    return STARG_OK;
}

/* The faces of later groups with those of this one. */
static void visit_later(pairing *p, size_t g) {
    const group *own = &p->groups[g];
    for (size_t h = g + 1; h < p->count && own->count > 0; h++) {
        const group *other = &p->groups[h];
        if (!bvh_boxes_meet(&own->tree->nodes[0].box, &other->tree->nodes[0].box))
            continue;
        for (size_t i = 0; i < other->count && !p->ended; i++) {
            among m = {p, own, other->faces[i]};
            bvh_box box;
            box_of(p->mesh, m.face, &box);
            bvh_query_box(own->tree, &box, visit_across, &m);
        }
    }
}

/* ---- without hubs ---- */

/* Faces of an item; the pairs of an item are kept until those before it are visited. */
enum { PART = 2048 };

typedef STARG_ARRAY(uint32_t) pair_list;

typedef struct sifting {
    starg_context *context;
    const bvh *tree;
    bvh_visit_pair *matters;
    void *user;
    pair_list *parts; /* by item */
} sifting;

typedef struct sieve {
    const sifting *of;
    pair_list *kept;
    starg_status status;
} sieve;

static starg_status keep_pair(const sieve *v, uint32_t a, uint32_t b) {
    PUSH(v->of->context, STAGE, v->kept, a);
    PUSH(v->of->context, STAGE, v->kept, b);
    return STARG_OK;
}

static bool sift_pair(void *user, uint32_t a, uint32_t b) {
    sieve *v = user;
    if (v->of->matters(v->of->user, a, b))
        v->status = keep_pair(v, a, b);
    return v->status == STARG_OK;
}

static starg_status sift_part(starg_context *context, void *shared, void *scratch, size_t item) {
    const sifting *s = shared;
    sieve v = {.of = s, .kept = &s->parts[item], .status = STARG_OK};
    const size_t end = (item + 1) * PART;
    (void)context;
    (void)scratch;
    for (size_t f = item * PART; f < end && f < s->tree->triangle_count; f++)
        if (!bvh_query_pairs_of(s->tree, (uint32_t)f, sift_pair, &v))
            break;
    return v.status;
}

static starg_status visit_sifted(sifting *s, bvh_visit_pair *visit) {
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = (s->tree->triangle_count + PART - 1) / PART,
                                      .shared = s,
                                      .item = sift_part,
                                      .silent = true};
    starg_status status = STARG_OK;
    bool ended = false;
    STARG_NEW_ZERO(s->context, STAGE, s->parts, loop.count);
    STARG_TRY(starg_parallel_for(s->context, &loop));
    for (size_t n = 0; n < loop.count; n++)
        for (size_t i = 0; i < s->parts[n].count && !ended; i += 2)
            ended = !visit(s->user, s->parts[n].data[i], s->parts[n].data[i + 1]);
done:
    for (size_t n = 0; s->parts != NULL && n < loop.count; n++)
        RELEASE(s->parts[n].data);
    RELEASE(s->parts);
    return status;
}

starg_status face_pairs_visit(starg_context *context, const starg_mesh *mesh, const bvh *tree,
                              bvh_visit_pair *matters, bvh_visit_pair *visit, void *user) {
    SCOPED_BY(free_groups)
    pairing p = {.context = context, .mesh = mesh, .visit = visit, .user = user};
    sifting all = {.context = context, .tree = tree, .matters = matters, .user = user};
    TRY(find_hubs(&p));
    if (p.count == 1 && matters != NULL)
        return visit_sifted(&all, visit);
    if (p.count == 1) {
        bvh_query_pairs(tree, visit, user);
        return STARG_OK;
    }
    TRY(make_groups(&p));
    among without = {&p, &p.groups[0], 0};
    bvh_query_pairs(p.groups[0].tree, visit_within, &without);
    for (size_t g = 0; g < p.count && !p.ended; g++) {
        if (g > 0)
            TRY(visit_hub(&p, &p.groups[g]));
        if (!p.ended)
            visit_later(&p, g);
    }
    return STARG_OK;
}
