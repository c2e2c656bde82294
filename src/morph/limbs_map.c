/* SPDX-License-Identifier: Apache-2.0 */
/* Maps the surfaces of two pieces onto each other so that their loops correspond.
 *
 * Problem: two triangulated spheres with the same number of holes, whose loops correspond vertex by
 * vertex. Find a common refinement of both.
 *
 * Stages: paths join the loops to a tree, the shortest first in A, and between the same vertices of
 * loops in B; both get the same number of vertices. Cut along them, each surface is a disk, and
 * their boundaries correspond. Both are put on the same disk, the boundary on its circle, all else
 * in the middle of its neighbours (Tutte 1963), weighted by the lengths of edges. With the outside
 * as one more vertex that is a sphere, on which the two triangulations are overlaid (overlay.c).
 *
 * Invariant: an edge between vertices of paths or loops is on one of them, since others are
 * divided, so that what is left of the surface hangs together and there is a way for each path.
 * Cost: linear systems, and O(n log n). */
#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/limbs.h"
#include "morph/morph.h"
#include "morph/surface_map.h"

static const char STAGE[] = "limbs";
enum { STARTS = 12 }; /* of paths, on a loop, from which the shortest is chosen */
static const double PI = 3.14159265358979323846;
static const double EVEN = 0.5; /* of the circle is shared alike by all edges of the boundary */

/* A surface that becomes a disk. */
typedef struct disk {
    cone_builder *b;
    uint32_t which;
    STARG_ARRAY(uint64_t) rims; /* edges of loops and paths, ascending */
    STARG_ARRAY(uint8_t) on;    /* per vertex: is it on any? */
    edge_list edges;
    uint32_t *corners; /* per triangle of the piece, x 3: its vertices in the disk */
    size_t count;      /* of vertices in the disk */
    uint32_t *from;    /* per vertex of the disk: the one of the surface */
    number_list rim;   /* vertices of the disk, around it */
    double *flat;      /* x 3: places in the disk, and 1 */
} disk;

static void free_disk(disk *d) {
    RELEASE(d->rims.data, d->on.data, d->edges.data, d->corners, d->from, d->rim.data, d->flat);
}

static bool is_rim(const disk *d, uint32_t u, uint32_t v) {
    const uint64_t name = cones_edge_name(u, v);
    return bsearch(&name, d->rims.data, d->rims.count, sizeof name, cones_by_edge_name) != NULL;
}

static starg_status add_rim(disk *d, const number_list *path, bool closed) {
    starg_context *context = d->b->context;
    for (size_t i = 0; i + !closed < path->count; i++)
        PUSH(context, STAGE, &d->rims,
             cones_edge_name(path->data[i], path->data[(i + 1) % path->count]));
    qsort(d->rims.data, d->rims.count, sizeof *d->rims.data, cones_by_edge_name);
    while (d->on.count < d->b->about.count)
        PUSH(context, STAGE, &d->on, 0);
    for (size_t i = 0; i < path->count; i++)
        d->on.data[path->data[i]] = 1;
    return STARG_OK;
}

/* Divides edges between vertices of paths and loops that are on none. */
static starg_status split_chords(disk *d) {
    starg_context *context = d->b->context;
    SCOPED STARG_ARRAY(uint64_t) chords = {0};
    TRY(cones_list_edges(d->b, d->which, &d->edges));
    for (size_t i = 0; i < d->edges.count; i++) {
        uint32_t u = (uint32_t)(d->edges.data[i].edge >> 32), v = (uint32_t)d->edges.data[i].edge;
        if (u < v && d->on.data[u] && d->on.data[v] && !is_rim(d, u, v))
            PUSH(context, STAGE, &chords, d->edges.data[i].edge);
    }
    for (size_t i = 0; i < chords.count; i++)
        TRY(cones_split_edge(d->b, (uint32_t)(chords.data[i] >> 32), (uint32_t)chords.data[i],
                             0.5));
    while (d->on.count < d->b->about.count)
        PUSH(context, STAGE, &d->on, 0);
    return STARG_OK;
}

/* ---- paths ---- */

/* Shortest paths from a vertex on a rim, over vertices on none, to all others. By relaxation in the
 * order of a queue. */
typedef struct path_field {
    double *far;
    uint32_t *before, *queue;
    uint8_t *waits;
} path_field;

static void free_field(path_field *f) {
    RELEASE(f->far, f->before, f->queue, f->waits);
}

static starg_status make_field(const disk *d, path_field *out) {
    size_t count = d->b->about.count;
    NEW(d->b->context, STAGE, out->far, count);
    NEW(d->b->context, STAGE, out->before, count);
    NEW(d->b->context, STAGE, out->queue, count + 1);
    NEW_ZERO(d->b->context, STAGE, out->waits, count);
    return STARG_OK;
}

static void find_paths(const disk *d, uint32_t source, path_field *f) {
    const cone_builder *b = d->b;
    size_t count = b->about.count, first = 0, last = 1;
    for (size_t v = 0; v < count; v++)
        f->far[v] = INFINITY;
    f->far[source] = 0;
    f->before[source] = NOWHERE;
    f->queue[0] = source;
    while (first != last) {
        uint32_t v = f->queue[first];
        first = (first + 1) % (count + 1);
        f->waits[v] = 0;
        for (size_t i = 0; i < b->about.data[v].count; i++) {
            uint32_t t = b->about.data[v].data[i];
            const uint32_t *corner = b->corners.data + 3 * (size_t)t;
            bool there = corner[0] == v || corner[1] == v || corner[2] == v;
            if (!there || b->sides.data[2 * (size_t)t] != d->which)
                continue;
            for (int k = 0; k < 3; k++) {
                uint32_t w = corner[k];
                double far =
                    f->far[v] + vec3_distance(cones_place_of(b, 0, v), cones_place_of(b, 0, w));
                if (w == v || (d->on.data[v] && d->on.data[w]) || !(far < f->far[w]))
                    continue;
                f->far[w] = far;
                f->before[w] = v;
                if (d->on.data[w] || f->waits[w])
                    continue;
                f->waits[w] = 1;
                f->queue[last] = w;
                last = (last + 1) % (count + 1);
            }
        }
    }
}

/* The path to a vertex, from the source on. */
static starg_status list_path(const disk *d, const path_field *f, uint32_t to, number_list *out) {
    out->count = 0;
    for (uint32_t v = to; v != NOWHERE; v = f->before[v])
        PUSH(d->b->context, STAGE, out, v);
    for (size_t i = 0; i < out->count / 2; i++) {
        uint32_t kept = out->data[i];
        out->data[i] = out->data[out->count - 1 - i];
        out->data[out->count - 1 - i] = kept;
    }
    return STARG_OK;
}

/* The walls of a piece. */
typedef struct rims {
    number_list walls; /* 2 wall + side */
    STARG_ARRAY(uint8_t) joined;
    double lengths[2]; /* of all, in both places */
} rims;

static void free_rims(rims *r) {
    RELEASE(r->walls.data, r->joined.data);
}

static const number_list *loop_of(const limb_cuts *cuts, const rims *r, size_t rim) {
    return &cuts->walls.data[r->walls.data[rim] / 2].loops[0];
}

/* A path between two loops: vertices of A, whose mates are those of B. */
typedef struct rim_path {
    uint32_t from, to;
    size_t rim; /* at its end */
    double length;
} rim_path;

/* The shortest of those from a vertex to loops that are not joined yet, in the sum of the lengths
 * in A and in B, each over the length of all rims. */
static void weigh_paths(const limb_cuts *cuts, const disk disks[2], const rims *r,
                        const uint8_t *used, uint32_t from, path_field fields[2], rim_path *best) {
    find_paths(&disks[0], from, &fields[0]);
    find_paths(&disks[1], cuts->mates.data[from], &fields[1]);
    for (size_t i = 0; i < r->walls.count; i++) {
        const number_list *loop = loop_of(cuts, r, i);
        for (size_t j = 0; j < loop->count && !r->joined.data[i]; j++) {
            uint32_t to = loop->data[j];
            double length = fields[0].far[to] / r->lengths[0] +
                            fields[1].far[cuts->mates.data[to]] / r->lengths[1];
            if (!used[to] && length < best->length)
                *best = (rim_path){from, to, i, length};
        }
    }
}

/* Joins one more loop to those that are joined. `used`: vertices of A where paths end. */
static starg_status join_rim(limb_cuts *cuts, disk disks[2], rims *r, number_list *used,
                             bool *found) {
    SCOPED_BY(free_field) path_field first = {.far = NULL};
    SCOPED_BY(free_field) path_field second = {.far = NULL};
    SCOPED uint8_t *marks = NULL;
    rim_path best = {NOWHERE, NOWHERE, 0, INFINITY};
    for (int end = 0; end < 2; end++)
        TRY(split_chords(&disks[end]));
    TRY(make_field(&disks[0], &first));
    TRY(make_field(&disks[1], &second));
    path_field fields[2] = {first, second};
    NEW_ZERO(cuts->context, STAGE, marks, cuts->sides[0].about.count);
    for (size_t i = 0; i < used->count; i++)
        marks[used->data[i]] = 1;
    for (size_t i = 0; i < r->walls.count; i++) {
        const number_list *loop = loop_of(cuts, r, i);
        for (size_t j = 0; j < loop->count && r->joined.data[i]; j += 1 + loop->count / STARTS)
            if (!marks[loop->data[j]])
                weigh_paths(cuts, disks, r, marks, loop->data[j], fields, &best);
    }
    *found = best.length < INFINITY;
    if (!*found)
        return STARG_OK;
    number_list paths[2] = {{0}, {0}};
    starg_status status = STARG_OK;
    for (int end = 0; end < 2 && status == STARG_OK; end++) {
        uint32_t from = end == 0 ? best.from : cuts->mates.data[best.from];
        uint32_t to = end == 0 ? best.to : cuts->mates.data[best.to];
        find_paths(&disks[end], from, &fields[end]);
        status = list_path(&disks[end], &fields[end], to, &paths[end]);
    }
    if (status == STARG_OK)
        status = limbs_match_paths(cuts, paths, false);
    for (int end = 0; end < 2; end++) {
        if (status == STARG_OK)
            status = add_rim(&disks[end], &paths[end], false);
        RELEASE(paths[end].data);
    }
    TRY(status);
    r->joined.data[best.rim] = 1;
    PUSH(cuts->context, STAGE, used, best.from);
    PUSH(cuts->context, STAGE, used, best.to);
    return STARG_OK;
}

/* ---- disks ---- */

/* The vertices of the disk, where the surface is cut along its rims. */
static starg_status open_disk(disk *d) {
    const cone_builder *b = d->b;
    const number_list *own = &b->pieces.data[d->which].triangles;
    SCOPED uint32_t *places = NULL; /* of triangles in the piece's list */
    TRY(cones_list_edges(b, d->which, &d->edges));
    NEW(b->context, STAGE, places, b->corners.count / 3);
    NEW(b->context, STAGE, d->corners, 3 * own->count);
    NEW(b->context, STAGE, d->from, 3 * own->count);
    for (uint32_t i = 0; i < own->count; i++)
        places[own->data[i]] = i;
    sets_make(d->corners, 3 * own->count);
    for (uint32_t i = 0; i < 3 * own->count; i++) {
        const uint32_t *corner = b->corners.data + 3 * (size_t)own->data[i / 3];
        uint32_t u = corner[i % 3], v = corner[(i + 1) % 3], t = cones_across(&d->edges, u, v);
        if (t == NOWHERE || is_rim(d, u, v))
            continue;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t w = b->corners.data[3 * (size_t)t + k];
            if (w == u)
                sets_join(d->corners, i, 3 * places[t] + k);
            else if (w == v)
                sets_join(d->corners, i / 3 * 3 + (i + 1) % 3, 3 * places[t] + k);
        }
    }
    for (uint32_t i = 0; i < 3 * own->count; i++) /* roots are the lowest, and come first */
        d->corners[i] = sets_find(d->corners, i);
    for (uint32_t i = 0; i < 3 * own->count; i++) {
        bool fresh = d->corners[i] == i;
        if (fresh)
            d->from[d->count] = b->corners.data[3 * (size_t)own->data[i / 3] + i % 3];
        d->corners[i] = fresh ? (uint32_t)d->count++ : d->corners[d->corners[i]];
    }
    return STARG_OK;
}

/* Around the disk, from the edge between two vertices of the surface on. *good: it is a disk. */
static starg_status walk_rim(disk *d, uint32_t u, uint32_t v, bool *good) {
    const cone_builder *b = d->b;
    const number_list *own = &b->pieces.data[d->which].triangles;
    SCOPED uint32_t *next = NULL;
    size_t count = 0;
    uint32_t start = NOWHERE;
    NEW(b->context, STAGE, next, d->count);
    memset(next, 0xff, d->count * sizeof *next);
    for (size_t i = 0; i < 3 * own->count; i++) {
        uint32_t p = d->corners[i], q = d->corners[i / 3 * 3 + (i + 1) % 3];
        if (!is_rim(d, d->from[p], d->from[q]))
            continue;
        next[p] = q;
        count++;
        if (d->from[p] == u && d->from[q] == v)
            start = p;
    }
    *good = start != NOWHERE;
    for (uint32_t p = start; *good && d->rim.count < count; p = next[p]) {
        PUSH(b->context, STAGE, &d->rim, p);
        *good = next[p] != NOWHERE && (next[p] == start) == (d->rim.count == count);
    }
    size_t edges = (3 * own->count + count) / 2;
    *good = *good && d->count + own->count == edges + 1;
    return STARG_OK;
}

/* Places of both boundaries, the same. */
static starg_status place_rims(disk disks[2]) {
    size_t count = disks[0].rim.count;
    SCOPED double *lengths = NULL;
    double sums[2] = {0, 0}, angle = 0;
    NEW(disks[0].b->context, STAGE, lengths, 2 * count);
    for (size_t i = 0; i < 2 * count; i++) {
        const disk *d = &disks[i % 2];
        uint32_t p = d->from[d->rim.data[i / 2]], q = d->from[d->rim.data[(i / 2 + 1) % count]];
        lengths[i] = vec3_distance(cones_place_of(d->b, 0, p), cones_place_of(d->b, 0, q));
        sums[i % 2] += lengths[i];
    }
    for (int end = 0; end < 2; end++)
        NEW_ZERO(disks[end].b->context, STAGE, disks[end].flat, 3 * disks[end].count);
    for (size_t i = 0; i < count; i++) {
        const double place[3] = {cos(angle), sin(angle), 1};
        for (int end = 0; end < 2; end++)
            vec3_copy(place, disks[end].flat + 3 * (size_t)disks[end].rim.data[i]);
        double share = 0.5 * (lengths[2 * i] / sums[0] + lengths[2 * i + 1] / sums[1]);
        angle += 2 * PI * ((1 - EVEN) * share + EVEN / (double)count);
    }
    return STARG_OK;
}

/* All else in the middle of its neighbours. */
static starg_status place_inside(disk *d) {
    const cone_builder *b = d->b;
    size_t triangles = b->pieces.data[d->which].triangles.count, inner = 0, count = 0;
    SCOPED uint32_t *numbers = NULL;
    SCOPED triplet *entries = NULL;
    SCOPED double *sides = NULL;
    SCOPED_BY(sparse_drop) sparse_factors *system = NULL;
    NEW_ZERO(b->context, STAGE, numbers, d->count);
    for (size_t i = 0; i < d->rim.count; i++)
        numbers[d->rim.data[i]] = NOWHERE;
    for (size_t v = 0; v < d->count; v++)
        if (numbers[v] != NOWHERE)
            numbers[v] = (uint32_t)inner++;
    if (inner == 0)
        return STARG_OK;
    NEW(b->context, STAGE, entries, 12 * triangles);
    NEW_ZERO(b->context, STAGE, sides, 3 * inner);
    for (size_t i = 0; i < 6 * triangles; i++) { /* each inner edge from either end, twice */
        uint32_t p = d->corners[i / 2], q = d->corners[i / 6 * 3 + (i / 2 + 1) % 3];
        uint32_t u = i % 2 == 0 ? p : q, v = i % 2 == 0 ? q : p;
        double length =
            vec3_distance(cones_place_of(b, 0, d->from[u]), cones_place_of(b, 0, d->from[v]));
        double w = length > 0 ? 1 / (length * length) : 1;
        if (numbers[u] == NOWHERE)
            continue;
        entries[count++] = (triplet){numbers[u], numbers[u], w};
        if (numbers[v] != NOWHERE)
            entries[count++] = (triplet){numbers[u], numbers[v], -w};
        for (size_t k = 0; k < 2 && numbers[v] == NOWHERE; k++)
            sides[k * inner + numbers[u]] += w * d->flat[3 * (size_t)v + k];
    }
    TRY(triplets_factorise(b->context, inner, entries, count, &system));
    for (size_t k = 0; k < 2; k++) {
        sparse_solve(system, sides + k * inner, sides + 2 * inner);
        for (size_t v = 0; v < d->count; v++)
            if (numbers[v] != NOWHERE)
                d->flat[3 * v + k] = sides[k * inner + numbers[v]];
    }
    for (size_t v = 0; v < d->count; v++)
        d->flat[3 * v + 2] = 1;
    return STARG_OK;
}

/* ---- the overlay ---- */

/* The disk's triangles, and those between its boundary and the outside. */
typedef struct globe {
    starg_mesh mesh; /* in space */
    double *directions;
} globe;

static void free_globe(globe *g) {
    RELEASE(g->mesh.vertices, g->mesh.faces, g->directions);
}

static starg_status make_globe(const disk *d, globe *out) {
    starg_context *context = d->b->context;
    size_t triangles = d->b->pieces.data[d->which].triangles.count, count = d->rim.count;
    NEW_ZERO(context, STAGE, out->mesh.vertices, 3 * (d->count + 1));
    NEW_ZERO(context, STAGE, out->directions, 3 * (d->count + 1));
    NEW(context, STAGE, out->mesh.faces, 3 * (triangles + count));
    out->mesh.context = context;
    out->mesh.vertex_count = d->count + 1;
    out->mesh.face_count = triangles + count;
    for (size_t v = 0; v < d->count; v++)
        vec3_copy(cones_place_of(d->b, 0, d->from[v]), out->mesh.vertices + 3 * v);
    memcpy(out->directions, d->flat, 3 * d->count * sizeof *d->flat);
    out->directions[3 * d->count + 2] = -1;
    memcpy(out->mesh.faces, d->corners, 3 * triangles * sizeof *d->corners);
    for (size_t i = 0; i < count; i++) {
        uint32_t *face = out->mesh.faces + 3 * (triangles + i);
        face[0] = d->rim.data[(i + 1) % count];
        face[1] = d->rim.data[i];
        face[2] = (uint32_t)d->count;
    }
    return STARG_OK;
}

/* Are all faces positive? */
static bool is_unfolded(const globe *g) {
    const double origin[3] = {0, 0, 0};
    for (size_t f = 0; f < 3 * g->mesh.face_count; f += 3)
        if (orient3d(g->directions + 3 * (size_t)g->mesh.faces[f],
                     g->directions + 3 * (size_t)g->mesh.faces[f + 1],
                     g->directions + 3 * (size_t)g->mesh.faces[f + 2], origin) <= 0)
            return false;
    return true;
}

static void place_node(const globe *g, const overlay_place *place, double out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (size_t k = 0; k < 3; k++)
        vec3_along(out, place->weight[k],
                   g->mesh.vertices + 3 * (size_t)g->mesh.faces[3 * (size_t)place->face + k], out);
}

/* Vertices of both are those of the first surface's rims, and shared by pieces. */
static starg_status number_node(const limb_cuts *cuts, const disk *d, const globe globes[2],
                                const overlay_node *node, limb_surface *out, uint32_t *number) {
    uint32_t *known = NULL;
    if (node->key[0] != OVERLAY_NONE && node->key[0] >= OVERLAY_VERTEX) {
        uint64_t v = node->key[0] - OVERLAY_VERTEX;
        if (v == d->count)
            return STARG_OK;
        if (d->on.data[d->from[v]]) {
            while (out->at.count <= d->from[v])
                PUSH(cuts->context, STAGE, &out->at, NOWHERE);
            known = &out->at.data[d->from[v]];
        }
    }
    if (known == NULL || *known == NOWHERE) {
        *number = (uint32_t)(out->places[0].count / 3);
        for (int end = 0; end < 2; end++) {
            double place[3];
            place_node(&globes[end], &node->place[end], place);
            for (int k = 0; k < 3; k++)
                PUSH(cuts->context, STAGE, &out->places[end], place[k]);
        }
        if (known != NULL)
            *known = *number;
    } else {
        *number = *known;
    }
    return STARG_OK;
}

static starg_status take_overlay(const limb_cuts *cuts, uint32_t which, const disk *d,
                                 const globe globes[2], const sphere_overlay *overlay,
                                 limb_surface *out) {
    SCOPED uint32_t *numbers = NULL;
    NEW(cuts->context, STAGE, numbers, overlay->nodes.count);
    memset(numbers, 0xff, overlay->nodes.count * sizeof *numbers);
    for (size_t i = 0; i < overlay->nodes.count; i++)
        TRY(number_node(cuts, d, globes, &overlay->nodes.data[i], out, &numbers[i]));
    size_t triangles = d->b->pieces.data[which].triangles.count;
    for (size_t i = 0; i < overlay->cells.count; i++) {
        const overlay_cell *cell = &overlay->cells.data[i];
        for (uint32_t j = 1; j + 1 < cell->count && cell->face[0] < triangles; j++) {
            const uint32_t corners[3] = {cell->corner[0], cell->corner[j], cell->corner[j + 1]};
            for (int k = 0; k < 3; k++)
                PUSH(cuts->context, STAGE, &out->faces, numbers[corners[k]]);
            PUSH(cuts->context, STAGE, &out->sides, which);
            PUSH(cuts->context, STAGE, &out->sides, NOWHERE);
        }
    }
    return STARG_OK;
}

static starg_status overlay_disks(limb_cuts *cuts, uint32_t which, const disk disks[2],
                                  limb_surface *out, bool *found) {
    SCOPED_BY(free_globe) globe first = {.directions = NULL};
    SCOPED_BY(free_globe) globe second = {.directions = NULL};
    SCOPED_BY(overlay_drop) sphere_overlay *overlay = NULL;
    bool moved;
    TRY(make_globe(&disks[0], &first));
    TRY(make_globe(&disks[1], &second));
    *found = is_unfolded(&first) && is_unfolded(&second);
    if (!*found)
        return STARG_OK;
    const starg_mesh *const meshes[2] = {&first.mesh, &second.mesh};
    const double *const directions[2] = {first.directions, second.directions};
    const globe globes[2] = {first, second};
    TRY(overlay_create(cuts->context, meshes, directions, &overlay));
    starg_status status = overlay_make_room(overlay, &moved);
    *found = status == STARG_OK;
    if (status != STARG_OK)
        return status == STARG_ERROR_SOLVER ? STARG_OK : status;
    return take_overlay(cuts, which, &disks[0], globes, overlay, out);
}

/* ---- all stages ---- */

static starg_status list_rims(limb_cuts *cuts, uint32_t which, disk disks[2], rims *out) {
    for (uint32_t i = 0; i < cuts->walls.count; i++) {
        const limb_wall *wall = &cuts->walls.data[i];
        if (wall->pieces[0] != which && wall->pieces[1] != which)
            continue;
        PUSH(cuts->context, STAGE, &out->walls, 2 * i + (wall->pieces[1] == which));
        const uint8_t first = out->joined.count == 0;
        PUSH(cuts->context, STAGE, &out->joined, first);
        for (int end = 0; end < 2; end++) {
            const number_list *loop = &wall->loops[end];
            TRY(add_rim(&disks[end], loop, true));
            for (size_t j = 0; j < loop->count; j++)
                out->lengths[end] += vec3_distance(
                    cones_place_of(&cuts->sides[end], 0, loop->data[j]),
                    cones_place_of(&cuts->sides[end], 0, loop->data[(j + 1) % loop->count]));
        }
    }
    return STARG_OK;
}

static starg_status map_disks(limb_cuts *cuts, uint32_t which, disk disks[2], limb_surface *out,
                              bool *found) {
    SCOPED_BY(free_rims) rims r = {.walls = {0}};
    SCOPED number_list used = {0};
    TRY(list_rims(cuts, which, disks, &r));
    *found = r.walls.count > 0;
    for (size_t i = 1; i < r.walls.count && *found; i++)
        TRY(join_rim(cuts, disks, &r, &used, found));
    if (!*found)
        return STARG_OK;
    const limb_wall *wall = &cuts->walls.data[r.walls.data[0] / 2];
    bool right = r.walls.data[0] % 2;
    for (int end = 0; end < 2 && *found; end++) {
        const number_list *loop = &wall->loops[end];
        TRY(split_chords(&disks[end]));
        TRY(open_disk(&disks[end]));
        TRY(walk_rim(&disks[end], loop->data[right ? 1 : 0], loop->data[right ? 0 : 1], found));
    }
    *found = *found && disks[0].rim.count == disks[1].rim.count;
    for (size_t i = 0; i < disks[0].rim.count && *found; i++)
        *found = cuts->mates.data[disks[0].from[disks[0].rim.data[i]]] ==
                 disks[1].from[disks[1].rim.data[i]];
    if (!*found)
        return STARG_OK;
    TRY(place_rims(disks));
    for (int end = 0; end < 2; end++)
        TRY(place_inside(&disks[end]));
    return overlay_disks(cuts, which, disks, out, found);
}

starg_status limbs_map_piece(limb_cuts *cuts, uint32_t which, limb_surface *out, bool *found) {
    disk disks[2] = {{.b = &cuts->sides[0], .which = which},
                     {.b = &cuts->sides[1], .which = which}};
    starg_status status = map_disks(cuts, which, disks, out, found);
    for (int end = 0; end < 2; end++)
        free_disk(&disks[end]);
    return status;
}
