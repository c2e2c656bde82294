/* A closed triangle mesh under three moves that keep it a closed manifold of the same topology: the
 * flip of an edge, the split of an edge and the split of a face. No move looks at coordinates.
 *
 * Invariants: twins are mutual and run opposite ways; `leaving` names a halfedge of each point that
 * has faces; depth grows by one with each cut, and never beyond MAX_DEPTH.
 *
 * Cost: a move takes constant time, looking for a halfedge the degree of its point. */
#include "skeleton/sample_mesh.h"

static const char STAGE[] = "surface samples";

enum { MAX_DEPTH = 12 };

starg_status sample_mesh_take(starg_context *context, surface_samples *samples, sample_mesh *m) {
    starg_status status = STARG_OK;
    mesh_topology *topology = NULL;
    const starg_mesh mesh = {context, samples->point_count, samples->face_count, samples->points,
                             samples->faces};
    *m = (sample_mesh){.context = context};
    m->points.data = samples->points;
    m->points.count = m->points.capacity = 3 * samples->point_count;
    m->faces.data = samples->faces;
    m->faces.count = m->faces.capacity = 3 * samples->face_count;
    *samples = (surface_samples){0};
    STARG_TRY(topology_create(context, &mesh, &topology));
    for (size_t h = 0; h < 3 * mesh.face_count; h++)
        STARG_PUSH(context, STAGE, &m->twins, topology->twin[h]);
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        STARG_PUSH(context, STAGE, &m->leaving, TOPOLOGY_NONE);
        STARG_PUSH(context, STAGE, &m->depth, 0);
        STARG_PUSH(context, STAGE, &m->dirty, true);
    }
    for (uint32_t h = 0; h < 3 * mesh.face_count; h++)
        m->leaving.data[mesh.faces[h]] = h;
done:
    topology_free(topology);
    return status;
}

void sample_mesh_give(sample_mesh *m, surface_samples *samples) {
    *samples = (surface_samples){.point_count = m->points.count / 3,
                                 .face_count = m->faces.count / 3,
                                 .points = m->points.data,
                                 .faces = m->faces.data};
    m->points.data = NULL;
    m->faces.data = NULL;
    sample_mesh_free(m);
}

/* TO = a copy of the growable array FROM with room to grow, or leave by `done`. */
#define COPY_ARRAY(CONTEXT, FROM, TO)                                                              \
    do {                                                                                           \
        STARG_NEW((CONTEXT), STAGE, (TO)->data, (FROM)->capacity);                                 \
        (TO)->count = (FROM)->count;                                                               \
        (TO)->capacity = (FROM)->capacity;                                                         \
        if ((FROM)->count > 0)                                                                     \
            memcpy((TO)->data, (FROM)->data, (FROM)->count * sizeof *(FROM)->data);                \
    } while (0)

starg_status sample_mesh_copy(const sample_mesh *m, sample_mesh *copy) {
    starg_status status = STARG_OK;
    *copy = (sample_mesh){.context = m->context};
    COPY_ARRAY(m->context, &m->points, &copy->points);
    COPY_ARRAY(m->context, &m->faces, &copy->faces);
    COPY_ARRAY(m->context, &m->twins, &copy->twins);
    COPY_ARRAY(m->context, &m->leaving, &copy->leaving);
    COPY_ARRAY(m->context, &m->depth, &copy->depth);
    COPY_ARRAY(m->context, &m->dirty, &copy->dirty);
done:
    return status;
}

void sample_mesh_free(sample_mesh *m) {
    STARG_ARRAY_FREE(m->context, &m->points);
    STARG_ARRAY_FREE(m->context, &m->faces);
    STARG_ARRAY_FREE(m->context, &m->twins);
    STARG_ARRAY_FREE(m->context, &m->leaving);
    STARG_ARRAY_FREE(m->context, &m->depth);
    STARG_ARRAY_FREE(m->context, &m->dirty);
    *m = (sample_mesh){0};
}

static void join_halves(sample_mesh *m, uint32_t a, uint32_t b) {
    m->twins.data[a] = b;
    m->twins.data[b] = a;
}

/* Writes face f; its halfedges become the ones that leave its corners. */
static void set_face(sample_mesh *m, uint32_t f, uint32_t a, uint32_t b, uint32_t d) {
    const uint32_t v[3] = {a, b, d};
    for (uint32_t k = 0; k < 3; k++) {
        m->faces.data[3 * f + k] = v[k];
        m->leaving.data[v[k]] = 3 * f + k;
        m->dirty.data[v[k]] = true;
    }
}

static starg_status new_face(sample_mesh *m, uint32_t *f) {
    starg_status status = STARG_OK;
    *f = (uint32_t)(m->faces.count / 3);
    for (int k = 0; k < 3; k++) {
        STARG_PUSH(m->context, STAGE, &m->faces, 0);
        STARG_PUSH(m->context, STAGE, &m->twins, TOPOLOGY_NONE);
    }
done:
    return status;
}

static uint8_t deeper(uint8_t a, uint8_t b) {
    return a > b ? a : b;
}

static starg_status new_point(sample_mesh *m, const double p[3], uint8_t depth, uint32_t *v) {
    starg_status status = STARG_OK;
    *v = (uint32_t)sample_mesh_points(m);
    for (int k = 0; k < 3; k++)
        STARG_PUSH(m->context, STAGE, &m->points, p[k]);
    STARG_PUSH(m->context, STAGE, &m->leaving, TOPOLOGY_NONE);
    STARG_PUSH(m->context, STAGE, &m->depth, depth);
    STARG_PUSH(m->context, STAGE, &m->dirty, true);
done:
    return status;
}

/* An edge u v between faces u v w and v u x, and the halfedges beyond the other sides of those. */
typedef struct edge_pair {
    uint32_t f, g;           /* the faces                       */
    uint32_t u, v, w, x;     /* the corners                     */
    uint32_t vw, wu, ux, xv; /* twins of the halfedges so named */
} edge_pair;

static edge_pair pair_at(const sample_mesh *m, uint32_t h) {
    uint32_t t = m->twins.data[h];
    return (edge_pair){.f = h / 3,
                       .g = t / 3,
                       .u = sample_mesh_tail(m, h),
                       .v = sample_mesh_head(m, h),
                       .w = sample_mesh_apex(m, h),
                       .x = sample_mesh_apex(m, t),
                       .vw = m->twins.data[corner_next(h)],
                       .wu = m->twins.data[corner_previous(h)],
                       .ux = m->twins.data[corner_next(t)],
                       .xv = m->twins.data[corner_previous(t)]};
}

void sample_mesh_flip(sample_mesh *m, uint32_t h) {
    edge_pair e = pair_at(m, h);
    uint32_t f = 3 * e.f, g = 3 * e.g;
    set_face(m, e.f, e.w, e.u, e.x);
    set_face(m, e.g, e.x, e.v, e.w);
    join_halves(m, f, e.wu);
    join_halves(m, f + 1, e.ux);
    join_halves(m, f + 2, g + 2);
    join_halves(m, g, e.xv);
    join_halves(m, g + 1, e.vw);
}

/* The faces become u p w, p v w, v p x and p u x. */
starg_status sample_mesh_split_edge(sample_mesh *m, uint32_t h, const double place[3]) {
    starg_status status = STARG_OK;
    edge_pair e = pair_at(m, h);
    uint32_t f = 3 * e.f, g = 3 * e.g, f2, g2, p;
    uint8_t depth = deeper(m->depth.data[e.u], m->depth.data[e.v]);
    if (depth == MAX_DEPTH)
        return STARG_OK;
    STARG_TRY(new_point(m, place, depth + 1, &p));
    STARG_TRY(new_face(m, &f2));
    STARG_TRY(new_face(m, &g2));
    set_face(m, e.f, e.u, p, e.w);
    set_face(m, f2, p, e.v, e.w);
    set_face(m, e.g, e.v, p, e.x);
    set_face(m, g2, p, e.u, e.x);
    join_halves(m, f, 3 * g2);
    join_halves(m, f + 1, 3 * f2 + 2);
    join_halves(m, f + 2, e.wu);
    join_halves(m, 3 * f2, g);
    join_halves(m, 3 * f2 + 1, e.vw);
    join_halves(m, g + 1, 3 * g2 + 2);
    join_halves(m, g + 2, e.xv);
    join_halves(m, 3 * g2 + 1, e.ux);
done:
    return status;
}

uint8_t sample_mesh_depth(const sample_mesh *m, uint32_t f) {
    const uint32_t *v = m->faces.data + 3 * (size_t)f;
    return deeper(deeper(m->depth.data[v[0]], m->depth.data[v[1]]), m->depth.data[v[2]]);
}

/* Face a b d becomes a b p, b d p and d a p. */
starg_status sample_mesh_split_face(sample_mesh *m, uint32_t f, const double place[3]) {
    starg_status status = STARG_OK;
    uint32_t v[3], beyond[3], part[3] = {f}, p;
    uint8_t depth = sample_mesh_depth(m, f);
    if (depth == MAX_DEPTH)
        return STARG_OK;
    for (uint32_t k = 0; k < 3; k++) {
        v[k] = m->faces.data[3 * f + k];
        beyond[k] = m->twins.data[3 * f + k];
    }
    STARG_TRY(new_point(m, place, depth + 1, &p));
    STARG_TRY(new_face(m, &part[1]));
    STARG_TRY(new_face(m, &part[2]));
    for (int k = 0; k < 3; k++)
        set_face(m, part[k], v[k], v[(k + 1) % 3], p);
    for (int k = 0; k < 3; k++) {
        join_halves(m, 3 * part[k], beyond[k]);
        join_halves(m, 3 * part[k] + 1, 3 * part[(k + 1) % 3] + 2);
    }
done:
    return status;
}

uint32_t sample_mesh_halfedge(const sample_mesh *m, uint32_t v, uint32_t w) {
    uint32_t first = m->leaving.data[v], h = first;
    do {
        if (sample_mesh_head(m, h) == w)
            return h;
        h = m->twins.data[corner_previous(h)];
    } while (h != first);
    return TOPOLOGY_NONE;
}
