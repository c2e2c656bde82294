/* SPDX-License-Identifier: Apache-2.0 */
/* A solid divided into pieces: construction, copies, the facets of a piece, extracts, tetrahedra.
 *
 * Why surfaces and not sets of tetrahedra: whether a piece is star-shaped depends on its boundary
 * alone, and a star-shaped piece with its guard already defines a set of tetrahedra (each facet
 * with the guard). So neither the search nor the output needs inner tetrahedra, and a planar cut is
 * a polygon instead of a layer of split tetrahedra.
 *
 * Why the pieces form a partition: every facet has one piece on its inner side and another one, or
 * the outside, on its outer side. So the winding numbers of all pieces' surfaces add up to that of
 * the outer facets, which is 1 inside the solid and 0 outside. A piece whose guard is strictly
 * inside all its facets, and whose surface winds around the guard once, has winding number 1 inside
 * itself and 0 elsewhere (visibility/kernel.c). Hence every point of the solid off the facets lies
 * in exactly one piece, and no other point in any. The tetrahedra of a piece do not overlap,
 * because each ray from the guard leaves it once, and share faces with others, because pieces share
 * facets.
 *
 * Extracts: most changes of a few pieces fail, in the cut or in the proof; trying one should
 * neither copy nor visit the rest of the partition. An extract holds the facets of some pieces, and
 * those of other pieces at two of their vertices, because a cut that splits an edge splits these
 * too. Facets, and what they refer to, keep their order; on return they replace those that were
 * extracted.
 *
 * Cost: linear; an extract is linear in its facets and those at its vertices, except for sorting.
 * */
#include "star/certified/partition.h"

#include <float.h>
#include <stdlib.h>

#include "geometry/vec3.h"
#include "mesh/topology.h"

static const uint32_t NONE = UINT32_MAX;

enum {
    THIN = 6,          /* so many bits less than the longest side is the shortest at least */
    INSERTED_MOST = 24 /* edges of a vertex, in sorting */
};

void partition_to_unit(const partition *p, const double point[3], double out[3]) {
    vec3_subtract(point, p->origin, out);
    for (int k = 0; k < 3; k++)
        out[k] = ldexp(out[k], -p->exponents[k]);
}

int partition_exponent(const partition *p) {
    int largest = p->exponents[0];
    for (int k = 1; k < 3; k++)
        largest = p->exponents[k] > largest ? p->exponents[k] : largest;
    return largest;
}

void partition_swap(partition *a, partition *b) {
    partition before = *a;
    *a = *b;
    *b = before;
}

void partition_from_unit(const partition *p, const double unit[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = p->origin[k] + ldexp(unit[k], p->exponents[k]);
}

starg_status partition_add_point(partition *p, const double point[3], uint32_t *vertex) {
    double unit[3];
    partition_to_unit(p, point, unit);
    *vertex = (uint32_t)(p->points.count / 3);
    for (int k = 0; k < 3; k++) {
        PUSH(p->context, PARTITION_STAGE, &p->points, point[k]);
        PUSH(p->context, PARTITION_STAGE, &p->unit, unit[k]);
    }
    return STARG_OK;
}

/* The frame of the points that `count` corners name. */
static void find_frame(const double *vertices, const uint32_t *corners, size_t count,
                       partition *p) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    double extent = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double at = vertices[3 * (size_t)corners[i] + (size_t)k];
            lower[k] = fmin(lower[k], at);
            upper[k] = fmax(upper[k], at);
        }
    for (int k = 0; k < 3; k++) {
        p->origin[k] = 0.5 * lower[k] + 0.5 * upper[k];
        extent = fmax(extent, upper[k] - lower[k]);
    }
    for (int k = 0; k < 3; k++)
        frexp(fmin(extent, ldexp(fmax(upper[k] - lower[k], DBL_MIN), THIN)), &p->exponents[k]);
}

/* Adds points for the vertices whose number is not NONE, and sets that number. */
static starg_status add_points(partition *p, const double *vertices, size_t count,
                               uint32_t *numbers) {
    for (size_t v = 0; v < count; v++)
        if (numbers[v] != NONE)
            TRY(partition_add_point(p, vertices + 3 * v, &numbers[v]));
    p->first_points = p->points.count / 3;
    return STARG_OK;
}

void partition_plane_of(const partition *p, const uint32_t corners[3], partition_plane *plane) {
    const double *a = partition_unit(p, corners[0]);
    double n[3];
    vec3_triangle_normal(a, partition_unit(p, corners[1]), partition_unit(p, corners[2]), n);
    double length = vec3_length(n);
    for (int k = 0; k < 3; k++)
        plane->normal[k] = length > 0 ? n[k] / length : 0;
    plane->offset = vec3_dot(plane->normal, a);
}

starg_status partition_add_facet(partition *p, const uint32_t corners[3], uint32_t inner,
                                 uint32_t outer) {
    facet f = {.corners = {corners[0], corners[1], corners[2]},
               .side = {inner, outer},
               .plane = (uint32_t)p->planes.count};
    partition_plane plane;
    partition_plane_of(p, f.corners, &plane);
    PUSH(p->context, PARTITION_STAGE, &p->planes, plane);
    PUSH(p->context, PARTITION_STAGE, &p->facets, f);
    return STARG_OK;
}

/* ---- order ---- */

int partition_ascending(const void *x, const void *y) {
    uint32_t a = *(const uint32_t *)x, b = *(const uint32_t *)y;
    return (a > b) - (a < b);
}

int partition_ascending_real(const void *x, const void *y) {
    double a = *(const double *)x, b = *(const double *)y;
    return (a > b) - (a < b);
}

static int by_ends(const void *left, const void *right) {
    const partition_edge *x = left, *y = right;
    int order = partition_compare_edges(x->a, x->b, y->a, y->b);
    return order != 0 ? order : (x->facet > y->facet) - (x->facet < y->facet);
}

static uint32_t lower_end(const partition_edge *e) {
    return e->a < e->b ? e->a : e->b;
}

/* Those of a vertex: a few as a rule. */
static void sort_few(partition_edge *edges, size_t count) {
    if (count > INSERTED_MOST)
        qsort(edges, count, sizeof *edges, by_ends);
    for (size_t i = 1; i < count; i++) {
        const partition_edge moved = edges[i];
        size_t at = i;
        for (; at > 0 && by_ends(&edges[at - 1], &moved) > 0; at--)
            edges[at] = edges[at - 1];
        edges[at] = moved;
    }
}

/* Filed by the lower end, then sorted there. */
starg_status partition_sort_edges(starg_context *context, partition_edge *edges, size_t count,
                                  size_t vertices) {
    SCOPED uint32_t *next = NULL;
    SCOPED partition_edge *filed = NULL;
    NEW_ZERO(context, PARTITION_STAGE, next, vertices + 1);
    NEW(context, PARTITION_STAGE, filed, count);
    for (size_t i = 0; i < count; i++)
        next[lower_end(&edges[i]) + 1]++;
    for (size_t v = 0; v < vertices; v++)
        next[v + 1] += next[v];
    for (size_t i = 0; i < count; i++)
        filed[next[lower_end(&edges[i])]++] = edges[i];
    for (size_t v = 0, first = 0; v < vertices; first = next[v++])
        sort_few(filed + first, next[v] - first);
    if (count > 0)
        memcpy(edges, filed, count * sizeof *filed);
    return STARG_OK;
}

/* ---- from a surface ---- */

starg_status partition_create_from_surface(starg_context *context, const kernel_faces *surface,
                                           const solid_parts *parts, partition *out) {
    const uint32_t *faces = surface->faces;
    size_t vertex_count = 0, face_count = surface->count;
    const piece whole = {.stamp = 1};
    SCOPED uint32_t *numbers = NULL;
    *out = (partition){.context = context, .stamps = 1};
    for (size_t i = 0; i < 3 * face_count; i++)
        vertex_count = faces[i] >= vertex_count ? faces[i] + (size_t)1 : vertex_count;
    find_frame(surface->vertices, faces, 3 * face_count, out);
    NEW(context, PARTITION_STAGE, numbers, vertex_count);
    memset(numbers, 0xff, vertex_count * sizeof *numbers);
    for (size_t i = 0; i < 3 * face_count; i++)
        numbers[faces[i]] = 0;
    TRY(add_points(out, surface->vertices, vertex_count, numbers));
    for (size_t i = 0; i < (parts != NULL ? parts->count : 1); i++)
        PUSH(context, PARTITION_STAGE, &out->pieces, whole);
    for (size_t f = 0; f < face_count; f++) {
        const uint32_t *own = faces + 3 * f;
        const uint32_t corners[3] = {numbers[own[0]], numbers[own[1]], numbers[own[2]]};
        const uint32_t part = parts != NULL ? parts->of[f] : 0;
        TRY(partition_add_facet(out, corners, part, PARTITION_OUTSIDE));
    }
    out->first_planes = out->planes.count;
    return partition_build_index(out);
}

/* ---- from tetrahedra ---- */

static bool is_border(const starg_tetmesh *mesh, const uint32_t *labels, size_t slot) {
    uint32_t beyond = mesh->neighbours[slot];
    if (beyond == STARG_TETMESH_NONE)
        return true;
    return labels[slot / 4] < labels[beyond];
}

static void mark_vertices(const starg_tetmesh *mesh, const uint32_t *labels, uint32_t *numbers) {
    memset(numbers, 0xff, mesh->vertex_count * sizeof *numbers);
    for (size_t slot = 0; slot < 4 * mesh->count; slot++)
        for (int k = 0; is_border(mesh, labels, slot) && k < 3; k++)
            numbers[mesh->tetrahedra[4 * (slot / 4) + (size_t)TETMESH_FACE[slot % 4][k]]] = 0;
}

static starg_status add_border(partition *p, const starg_tetmesh *mesh, const uint32_t *labels,
                               const uint32_t *numbers, size_t slot) {
    uint32_t beyond = mesh->neighbours[slot], corners[3];
    for (int k = 0; k < 3; k++) {
        int corner = TETMESH_FACE[slot % 4][k];
        corners[k] = numbers[mesh->tetrahedra[4 * (slot / 4) + (size_t)corner]];
    }
    return partition_add_facet(p, corners, labels[slot / 4],
                               beyond == STARG_TETMESH_NONE ? PARTITION_OUTSIDE : labels[beyond]);
}

static void add_volume(partition *p, const starg_tetmesh *mesh, size_t tetrahedron,
                       uint32_t label) {
    double a[3], edge[3][3];
    partition_to_unit(p, tetmesh_corner(mesh, tetrahedron, 0), a);
    for (int k = 0; k < 3; k++) {
        double b[3];
        partition_to_unit(p, tetmesh_corner(mesh, tetrahedron, k + 1), b);
        vec3_subtract(b, a, edge[k]);
    }
    p->pieces.data[label].volume += vec3_triple(edge[0], edge[1], edge[2]) / 6;
}

starg_status partition_create(starg_context *context, const starg_tetmesh *mesh,
                              const uint32_t *labels, const double *guards, size_t count,
                              partition *out) {
    SCOPED uint32_t *numbers = NULL;
    *out = (partition){.context = context};
    find_frame(mesh->vertices, mesh->tetrahedra, 4 * mesh->count, out);
    NEW(context, PARTITION_STAGE, numbers, mesh->vertex_count);
    mark_vertices(mesh, labels, numbers);
    TRY(add_points(out, mesh->vertices, mesh->vertex_count, numbers));
    for (size_t i = 0; i < count; i++) {
        piece fresh = {.stamp = ++out->stamps};
        vec3_copy(guards + 3 * i, fresh.guard);
        PUSH(context, PARTITION_STAGE, &out->pieces, fresh);
    }
    for (size_t slot = 0; slot < 4 * mesh->count; slot++)
        if (is_border(mesh, labels, slot))
            TRY(add_border(out, mesh, labels, numbers, slot));
    out->first_planes = out->planes.count;
    for (size_t t = 0; t < mesh->count; t++)
        add_volume(out, mesh, t, labels[t]);
    return partition_build_index(out);
}

void partition_free(partition *p) {
    RELEASE(p->points.data, p->unit.data, p->planes.data, p->facets.data, p->pieces.data,
            p->start.data, p->index.data, p->first_at.data, p->next_at.data);
    *p = (partition){.context = p->context};
}

/* ---- copies ---- */

/* TO = a copy of the array FROM with some room. */
#define COPY_ARRAY(CONTEXT, TO, FROM)                                                              \
    do {                                                                                           \
        (TO)->capacity = (FROM)->count + (FROM)->count / 8 + 64;                                   \
        NEW((CONTEXT), PARTITION_STAGE, (TO)->data, (TO)->capacity);                               \
        (TO)->count = (FROM)->count;                                                               \
        if ((FROM)->count > 0)                                                                     \
            memcpy((TO)->data, (FROM)->data, (FROM)->count * sizeof *(TO)->data);                  \
    } while (0)

starg_status partition_copy(const partition *from, partition *to) {
    *to = (partition){.context = from->context,
                      .first_points = from->first_points,
                      .first_planes = from->first_planes,
                      .stamps = from->stamps};
    vec3_copy(from->origin, to->origin);
    memcpy(to->exponents, from->exponents, sizeof to->exponents);
    COPY_ARRAY(from->context, &to->points, &from->points);
    COPY_ARRAY(from->context, &to->unit, &from->unit);
    COPY_ARRAY(from->context, &to->planes, &from->planes);
    COPY_ARRAY(from->context, &to->facets, &from->facets);
    COPY_ARRAY(from->context, &to->pieces, &from->pieces);
    return STARG_OK;
}

/* ---- facets of a piece, corners at a point ---- */

/* TO has room for COUNT elements, whose values are not defined. */
#define FIT_ARRAY(CONTEXT, TO, COUNT)                                                              \
    do {                                                                                           \
        if ((TO)->capacity < (COUNT)) {                                                            \
            starg_release((CONTEXT), (TO)->data);                                                  \
            (TO)->data = NULL;                                                                     \
            (TO)->count = (TO)->capacity = 0;                                                      \
            NEW((CONTEXT), PARTITION_STAGE, (TO)->data, (COUNT) + (COUNT) / 4);                    \
            (TO)->capacity = (COUNT) + (COUNT) / 4;                                                \
        }                                                                                          \
        (TO)->count = (COUNT);                                                                     \
    } while (0)

static starg_status list_corners(partition *p) {
    size_t points = p->points.count / 3, corners = 3 * p->facets.count;
    FIT_ARRAY(p->context, &p->first_at, points);
    FIT_ARRAY(p->context, &p->next_at, corners);
    memset(p->first_at.data, 0xff, points * sizeof *p->first_at.data);
    for (size_t c = corners; c-- > 0;) {
        uint32_t *first = &p->first_at.data[p->facets.data[c / 3].corners[c % 3]];
        p->next_at.data[c] = *first;
        *first = (uint32_t)c;
    }
    return STARG_OK;
}

starg_status partition_build_index(partition *p) {
    size_t pieces = p->pieces.count;
    FIT_ARRAY(p->context, &p->start, pieces + 2);
    memset(p->start.data, 0, (pieces + 2) * sizeof *p->start.data);
    /* counted one place ahead, so that filling restores each start */
    uint32_t total = 0, *start = p->start.data;
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        uint32_t owner = p->facets.data[i / 2].side[i % 2];
        if (owner != PARTITION_OUTSIDE)
            start[owner + 2]++, total++;
    }
    for (size_t i = 2; i < pieces + 2; i++)
        start[i] += start[i - 1];
    FIT_ARRAY(p->context, &p->index, (size_t)total);
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        uint32_t owner = p->facets.data[i / 2].side[i % 2];
        if (owner != PARTITION_OUTSIDE)
            p->index.data[start[owner + 1]++] = (uint32_t)i;
    }
    p->start.count = pieces + 1;
    return list_corners(p);
}

starg_status partition_gather(const partition *p, uint32_t number, partition_triangles *triangles) {
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        uint32_t corners[3];
        facet_outward(&p->facets.data[p->index.data[k] / 2], (int)(p->index.data[k] % 2), corners);
        for (int i = 0; i < 3; i++)
            PUSH(p->context, PARTITION_STAGE, triangles, corners[i]);
    }
    return STARG_OK;
}

double partition_volume(const partition *p, const uint32_t *triangles, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += vec3_triple(partition_unit(p, triangles[3 * i]),
                           partition_unit(p, triangles[3 * i + 1]),
                           partition_unit(p, triangles[3 * i + 2]));
    return sum / 6;
}

starg_status partition_find_open(const partition *p, partition_numbers *open) {
    SCOPED uint32_t *root = NULL, *size = NULL;
    NEW(p->context, PARTITION_STAGE, root, p->pieces.count);
    NEW_ZERO(p->context, PARTITION_STAGE, size, p->pieces.count);
    sets_make(root, p->pieces.count);
    for (size_t i = 0; i < p->facets.count; i++) {
        const uint32_t *side = p->facets.data[i].side;
        if (side[FACET_INNER] != PARTITION_OUTSIDE && side[FACET_OUTER] != PARTITION_OUTSIDE)
            sets_join(root, side[FACET_INNER], side[FACET_OUTER]);
    }
    for (uint32_t i = 0; i < p->pieces.count; i++)
        size[sets_find(root, i)]++;
    for (uint32_t i = 0; i < p->pieces.count; i++)
        if (size[sets_find(root, i)] > 2)
            PUSH(p->context, PARTITION_STAGE, open, i);
    return STARG_OK;
}

void partition_renumber(partition *p, uint32_t from, uint32_t to) {
    p->pieces.count--;
    if (from == to)
        return;
    for (size_t i = 0; i < p->facets.count; i++)
        for (int side = 0; side < 2; side++)
            if (p->facets.data[i].side[side] == from)
                p->facets.data[i].side[side] = to;
    p->pieces.data[to] = p->pieces.data[from];
}

bool partition_certify(const partition *p, const uint32_t *triangles, size_t count,
                       const double guard[3]) {
    const kernel_faces surface = {p->points.data, triangles, count};
    return kernel_sees_all(&surface, guard) && kernel_winding(&surface, guard) == 1;
}

starg_status partition_certify_all(const partition *p, bool *done) {
    SCOPED partition_triangles triangles = {0};
    *done = true;
    for (uint32_t i = 0; i < p->pieces.count && *done; i++) {
        triangles.count = 0;
        TRY(partition_gather(p, i, &triangles));
        *done = partition_certify(p, triangles.data, triangles.count / 3, p->pieces.data[i].guard);
    }
    return STARG_OK;
}

/* ---- extracts: facets ---- */

void extract_free(partition_extract *e) {
    RELEASE(e->facets.data, e->points.data, e->planes.data, e->pieces.data);
    partition_free(&e->part);
}

typedef struct extractor {
    const partition *p;
    region_scratch *scratch; /* its tables: 1 + number in the part, 0: absent */
    partition_extract *e;
} extractor;

static bool is_named(const extractor *x, uint32_t owner) {
    return owner != PARTITION_OUTSIDE && x->scratch->piece_of.data[owner] != 0;
}

static starg_status name_pieces(const extractor *x, const uint32_t *pieces, size_t count) {
    for (size_t i = 0; i < count; i++) {
        PUSH(x->p->context, PARTITION_STAGE, &x->e->pieces, pieces[i]);
        x->scratch->piece_of.data[pieces[i]] = (uint32_t)x->e->pieces.count;
    }
    return STARG_OK;
}

/* A facet between two of the pieces is listed for its inner side. */
static starg_status list_own_facets(const extractor *x) {
    const partition *p = x->p;
    for (size_t i = 0; i < x->e->pieces.count; i++) {
        uint32_t number = x->e->pieces.data[i];
        for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
            uint32_t entry = p->index.data[k];
            const facet *f = &p->facets.data[entry / 2];
            if (entry % 2 == FACET_OUTER && is_named(x, f->side[FACET_INNER]))
                continue;
            PUSH(p->context, PARTITION_STAGE, &x->e->facets, entry / 2);
        }
    }
    return STARG_OK;
}

static starg_status number_point(const extractor *x, uint32_t point) {
    if (x->scratch->vertex_of.data[point] != 0)
        return STARG_OK;
    PUSH(x->p->context, PARTITION_STAGE, &x->e->points, point);
    x->scratch->vertex_of.data[point] = (uint32_t)x->e->points.count;
    return STARG_OK;
}

/* Does a facet belong to none of the pieces but have two of their vertices, `corner` being the
 * first? */
static bool is_beside(const extractor *x, const facet *f, uint32_t corner) {
    int shared = 0;
    if (is_named(x, f->side[0]) || is_named(x, f->side[1]))
        return false;
    for (uint32_t k = 0; k < 3; k++) {
        bool known = x->scratch->vertex_of.data[f->corners[k]] != 0;
        if (known && shared == 0 && k != corner)
            return false;
        shared += known;
    }
    return shared > 1;
}

/* `points` are those of the pieces themselves. */
static starg_status list_facets_beside(const extractor *x) {
    const partition *p = x->p;
    for (size_t i = 0; i < x->e->points.count; i++)
        for (uint32_t c = p->first_at.data[x->e->points.data[i]]; c != PARTITION_NO_CORNER;
             c = p->next_at.data[c])
            if (is_beside(x, &p->facets.data[c / 3], c % 3))
                PUSH(p->context, PARTITION_STAGE, &x->e->facets, c / 3);
    return STARG_OK;
}

/* ---- extracts: the part ---- */

static starg_status number_piece(const extractor *x, uint32_t *side) {
    if (*side == PARTITION_OUTSIDE)
        return STARG_OK;
    if (!is_named(x, *side))
        TRY(name_pieces(x, side, 1));
    *side = x->scratch->piece_of.data[*side] - 1;
    return STARG_OK;
}

static starg_status number_plane(const extractor *x, uint32_t *plane) {
    uint32_t *slot = &x->scratch->row_of.data[2 * (size_t)*plane];
    if (*slot == 0) {
        PUSH(x->p->context, PARTITION_STAGE, &x->e->planes, *plane);
        *slot = (uint32_t)x->e->planes.count;
    }
    *plane = *slot - 1;
    return STARG_OK;
}

static starg_status add_facets(const extractor *x) {
    for (size_t i = 0; i < x->e->facets.count; i++) {
        facet f = x->p->facets.data[x->e->facets.data[i]];
        for (int k = 0; k < 3; k++) {
            TRY(number_point(x, f.corners[k]));
            f.corners[k] = x->scratch->vertex_of.data[f.corners[k]] - 1;
        }
        for (int side = 0; side < 2; side++)
            TRY(number_piece(x, &f.side[side]));
        TRY(number_plane(x, &f.plane));
        PUSH(x->p->context, PARTITION_STAGE, &x->e->part.facets, f);
    }
    return STARG_OK;
}

static starg_status add_what_is_listed(const extractor *x) {
    const partition *p = x->p;
    partition *part = &x->e->part;
    for (size_t i = 0; i < 3 * x->e->points.count; i++) {
        size_t from = 3 * (size_t)x->e->points.data[i / 3] + i % 3;
        PUSH(p->context, PARTITION_STAGE, &part->points, p->points.data[from]);
        PUSH(p->context, PARTITION_STAGE, &part->unit, p->unit.data[from]);
    }
    for (size_t i = 0; i < x->e->planes.count; i++)
        PUSH(p->context, PARTITION_STAGE, &part->planes, p->planes.data[x->e->planes.data[i]]);
    for (size_t i = 0; i < x->e->pieces.count; i++)
        PUSH(p->context, PARTITION_STAGE, &part->pieces, p->pieces.data[x->e->pieces.data[i]]);
    return STARG_OK;
}

/* The tables are all zero between calls. */
static void forget(const extractor *x) {
    for (size_t i = 0; i < x->e->points.count; i++)
        x->scratch->vertex_of.data[x->e->points.data[i]] = 0;
    for (size_t i = 0; i < x->e->planes.count; i++)
        x->scratch->row_of.data[2 * (size_t)x->e->planes.data[i]] = 0;
    for (size_t i = 0; i < x->e->pieces.count; i++)
        x->scratch->piece_of.data[x->e->pieces.data[i]] = 0;
}

starg_status extract_make(const partition *p, const uint32_t *pieces, size_t count,
                          region_scratch *scratch, partition_extract *out) {
    const extractor x = {p, scratch, out};
    *out = (partition_extract){.part = {.context = p->context, .stamps = p->stamps}};
    vec3_copy(p->origin, out->part.origin);
    memcpy(out->part.exponents, p->exponents, sizeof p->exponents);
    TRY(region_scratch_fit(scratch, p));
    TRY(name_pieces(&x, pieces, count));
    TRY(list_own_facets(&x));
    for (size_t i = 0; i < 3 * out->facets.count; i++)
        TRY(number_point(&x, p->facets.data[out->facets.data[i / 3]].corners[i % 3]));
    TRY(list_facets_beside(&x));
    if (out->facets.count > 1)
        qsort(out->facets.data, out->facets.count, sizeof *out->facets.data, partition_ascending);
    TRY(add_facets(&x));
    TRY(add_what_is_listed(&x));
    forget(&x);
    return STARG_OK;
}

/* ---- extracts: return ---- */

static starg_status number_new(partition_extract *e, partition *p) {
    const partition *part = &e->part;
    for (uint32_t i = (uint32_t)e->points.count; i < part->points.count / 3; i++) {
        uint32_t number;
        TRY(partition_add_point(p, partition_point(part, i), &number));
        PUSH(p->context, PARTITION_STAGE, &e->points, number);
    }
    for (size_t i = e->planes.count; i < part->planes.count; i++) {
        PUSH(p->context, PARTITION_STAGE, &e->planes, (uint32_t)p->planes.count);
        PUSH(p->context, PARTITION_STAGE, &p->planes, part->planes.data[i]);
    }
    for (size_t i = 0; i < e->pieces.count; i++)
        p->pieces.data[e->pieces.data[i]] = part->pieces.data[i];
    for (size_t i = e->pieces.count; i < part->pieces.count; i++) {
        PUSH(p->context, PARTITION_STAGE, &e->pieces, (uint32_t)p->pieces.count);
        PUSH(p->context, PARTITION_STAGE, &p->pieces, part->pieces.data[i]);
    }
    p->stamps = part->stamps;
    return STARG_OK;
}

static facet in_the_whole(const partition_extract *e, size_t number) {
    facet f = e->part.facets.data[number];
    for (int k = 0; k < 3; k++)
        f.corners[k] = e->points.data[f.corners[k]];
    for (int side = 0; side < 2; side++)
        if (f.side[side] != PARTITION_OUTSIDE)
            f.side[side] = e->pieces.data[f.side[side]];
    f.plane = e->planes.data[f.plane];
    return f;
}

/* Removes the facets whose numbers are listed from `first` on, and compacts the rest. */
static void drop_facets(const partition_extract *e, size_t first, partition *p) {
    size_t kept = first < e->facets.count ? e->facets.data[first] : p->facets.count;
    for (size_t i = kept; i < p->facets.count; i++)
        if (first < e->facets.count && e->facets.data[first] == i)
            first++;
        else
            p->facets.data[kept++] = p->facets.data[i];
    p->facets.count = kept;
}

starg_status extract_return(partition_extract *e, partition *p) {
    size_t count = e->part.facets.count, places = e->facets.count;
    TRY(number_new(e, p));
    for (size_t i = 0; i < count; i++)
        if (i < places)
            p->facets.data[e->facets.data[i]] = in_the_whole(e, i);
        else
            PUSH(p->context, PARTITION_STAGE, &p->facets, in_the_whole(e, i));
    if (count < places)
        drop_facets(e, count, p);
    return STARG_OK;
}

/* ---- tetrahedra ---- */

typedef struct coner {
    const partition *p;
    double *vertices;
    uint32_t *tetrahedra;
    uint32_t *number; /* per point: its vertex, or NONE when no facet uses it */
    size_t vertex_count, used;
} coner;

static void number_vertices(coner *c) {
    size_t points = c->p->points.count / 3;
    memset(c->number, 0xff, points * sizeof *c->number);
    for (size_t i = 0; i < 3 * c->p->facets.count; i++)
        c->number[c->p->facets.data[i / 3].corners[i % 3]] = 0;
    for (size_t v = 0; v < points; v++)
        if (c->number[v] != NONE) {
            vec3_copy(partition_point(c->p, (uint32_t)v), c->vertices + 3 * c->vertex_count);
            c->number[v] = (uint32_t)c->vertex_count++;
        }
    c->used = c->vertex_count;
    for (size_t i = 0; i < c->p->pieces.count; i++)
        vec3_copy(c->p->pieces.data[i].guard, c->vertices + 3 * c->vertex_count++);
}

/* The guard sees the facet clockwise: swaps two corners. */
static void put_tetrahedron(const coner *c, size_t at, uint32_t entry, size_t owner) {
    uint32_t corners[3], *to = c->tetrahedra + 4 * at;
    facet_outward(&c->p->facets.data[entry / 2], (int)(entry % 2), corners);
    to[0] = c->number[corners[0]];
    to[1] = c->number[corners[2]];
    to[2] = c->number[corners[1]];
    to[3] = (uint32_t)(c->used + owner);
}

starg_status cone_all(const partition *p, starg_tetmesh **mesh, int32_t **labels) {
    starg_status status = STARG_OK;
    coner c = {.p = p};
    size_t count = p->index.count;
    *mesh = NULL;
    *labels = NULL;
    STARG_NEW(p->context, PARTITION_STAGE, c.vertices, p->points.count + 3 * p->pieces.count);
    STARG_NEW(p->context, PARTITION_STAGE, c.tetrahedra, 4 * count);
    STARG_NEW(p->context, PARTITION_STAGE, c.number, p->points.count / 3);
    STARG_NEW(p->context, PARTITION_STAGE, *labels, count);
    number_vertices(&c);
    for (size_t owner = 0, at = 0; owner < p->pieces.count; owner++)
        for (; at < p->start.data[owner + 1]; at++) {
            put_tetrahedron(&c, at, p->index.data[at], owner);
            (*labels)[at] = (int32_t)owner;
        }
    STARG_TRY(tetmesh_adopt(p->context, c.vertices, c.vertex_count, c.tetrahedra, count, NULL, true,
                            mesh));
    c.vertices = NULL;
    c.tetrahedra = NULL;
done:
    RELEASE(c.vertices, c.tetrahedra, c.number);
    if (status != STARG_OK) {
        starg_release(p->context, *labels);
        *labels = NULL;
    }
    return status;
}
