/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids with the same faces, cut alike into pieces that are star-shaped in both, and filled by
 * cones.
 *
 * Problem: a triangulated sphere lies in two places, and bounds a solid in each. Fill both with the
 * same tetrahedra, positive in both. No tetrahedra are given: nothing inside has to be unfolded.
 *
 * Method: the boundary of a piece is a triangulated sphere in both places. One with a kernel in
 * both is done: it is filled by cones from a point of each. Any other is cut, by a plane in a place
 * where it has no kernel, so that the other place keeps its kernel (peel.c). Where no such cut is
 * found, a plane is sought after which two guards miss the least of it
 * (star/strict/search/split_plane.c), or one that leaves hubs the most room. Edges that cross the
 * plane are divided, in the other place in the same ratio, so that the plane meets the piece in
 * loops of edges; each is spanned in both places by a fan about a new vertex, a wall of the two
 * pieces that the loop parts. The fan is flat in the one place and nearly flat in the other.
 *
 * Invariants: triangles fit together, edge to edge, in all pieces: an edge is divided in all of its
 * triangles. Whether walls stay inside the solid is never asked: pieces with kernels on all sides
 * are proof enough, since tetrahedra that are positive in a place, with the surface there as their
 * boundary, fill the solid once. All signs of results are exact.
 *
 * Cost: for each cut a plane search and a few passes over the piece. */
#include "star/compatible/compatible.h"

#include <stdlib.h>

#include "geometry/intersect.h"
#include "geometry/linear_program.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "star/compatible/cone_builder.h"
#include "star/compatible/peel.h"

static const char STAGE[] = "cones";

enum { ROUNDS = 6, WORK_MOST = 200000 };
enum { SEARCHED = 4 }; /* one cut of so many is by a search, the others are random */
enum {
    PLANES = 8,
    PLANES_MOST = 24,
    WORK = 20000,
    BENDS = 2
}; /* cuts that are looked at, and between both ends */
enum { TIGHT_FROM = 8, ATTEMPTS_MOST = 16, GROWTH_MOST = 24 };
static const double ROOMY = 0.02, TIGHT = 1e-6; /* of hubs, over the extents of loops */
static starg_status begin(cone_builder *b, const double *const places[2], size_t vertices,
                          const uint32_t *faces, size_t count) {
    uint32_t whole, number;
    TRY(cones_open_piece(b, 0, &whole));
    for (size_t v = 0; v < vertices; v++) {
        double from[2][3];
        for (int end = 0; end < 2; end++)
            vec3_copy(places[end] + 3 * v, from[end]);
        TRY(cones_add_vertex(b, (const double(*)[3])from, &number));
    }
    for (size_t f = 0; f < count; f++) {
        const uint32_t sides[2] = {whole, NOWHERE};
        TRY(cones_add_triangle(b, faces + 3 * f, sides));
    }
    return STARG_OK;
}

/* ---- kernels ---- */
static starg_status find_centers(cone_builder *b, uint32_t which, const number_list *faces,
                                 int *blind) {
    const size_t count = faces->count / 3;
    const kernel_faces surfaces[2] = {{b->places[0].data, faces->data, count},
                                      {b->places[1].data, faces->data, count}};
    cone_piece *own = &b->pieces.data[which];
    TRY(twin_kernels(b->context, surfaces, &b->rng, own->centers, blind));
    own->done = *blind < 0;
    return STARG_OK;
}

/* ---- heights ---- */
/* ---- the choice of a cut ---- */

typedef struct cut_choice {
    number_list faces;
    edge_list edges;
    cut_loops loops;
    loop_places places[2];
    bvh *trees[2];   /* of the faces */
    double *heights; /* per vertex: of the cut that is looked at */
    double room;     /* of the best so far, whose heights are the builder's */
} cut_choice;

static void choice_free(cut_choice *c) {
    bvh_free(c->trees[0]);
    bvh_free(c->trees[1]);
    RELEASE(c->faces.data, c->edges.data);
    cones_free_loops(&c->loops);
    RELEASE(c->places[0].points.data, c->places[1].points.data, c->heights);
}

static starg_status make_trees(cone_builder *b, cut_choice *c) {
    for (int end = 0; end < 2; end++) {
        bvh_free(c->trees[end]);
        c->trees[end] = NULL;
        TRY(bvh_create(b->context, b->places[end].data, c->faces.data, c->faces.count / 3,
                       &c->trees[end]));
    }
    return STARG_OK;
}

/* How much room hubs have, in both places. Those of loops that have no more than `least` are not
 * looked at closely. */
static starg_status find_rooms(cone_builder *b, cut_choice *c, double least) {
    const cut_node *nodes = c->loops.nodes.data;
    c->loops.rooms.count = 0;
    for (size_t i = 0; i < c->loops.lengths.count; nodes += c->loops.lengths.data[i++]) {
        double hubs[2][3], most = INFINITY;
        for (int end = 0; end < 2; end++) {
            double room;
            TRY(cones_place_loop(b, end, nodes, c->loops.lengths.data[i], &c->places[end]));
            TRY(cones_find_hub(b, &c->places[end], hubs[end], &room));
            most = fmin(most, room);
        }
        for (int end = 0; end < 2; end++)
            if (most <= least || !cones_is_inside(c->trees[end], &c->places[end], hubs[end]))
                most = 0;
        PUSH(b->context, STAGE, &c->loops.rooms, most);
    }
    return STARG_OK;
}

/* The cut is kept if one of its loops has more room than those before. */
static starg_status weigh(cone_builder *b, uint32_t which, cut_choice *c, bool *simple) {
    double best = 0;
    cones_snap(&c->faces, c->heights);
    TRY(cones_find_loops(b, which, &c->edges, c->heights, &c->loops, simple));
    if (!*simple)
        return STARG_OK;
    TRY(find_rooms(b, c, c->room));
    for (size_t i = 0; i < c->loops.rooms.count; i++)
        best = fmax(best, c->loops.rooms.data[i]);
    if (best > c->room) {
        c->room = best;
        for (size_t i = 0; i < c->faces.count; i++)
            b->heights.data[c->faces.data[i]] = c->heights[c->faces.data[i]];
    }
    return STARG_OK;
}

/* A cut that is nearly flat in both places: between the plane of one, in whose heights it was made,
 * and that of the loop's image in the other. */
static starg_status bend(cone_builder *b, int end, cut_choice *c, double share) {
    const loop_places *own = &c->places[end], *other = &c->places[1 - end];
    SCOPED double *image = NULL;
    NEW(b->context, STAGE, image, b->about.count);
    cones_find_heights(b, end, &c->faces, own->normal, own->mean, c->heights);
    cones_find_heights(b, 1 - end, &c->faces, other->normal, other->mean, image);
    for (size_t i = 0; i < c->faces.count; i++)
        image[c->faces.data[i]] = (1 - share) * c->heights[c->faces.data[i]] / own->extent +
                                  share * image[c->faces.data[i]] / other->extent;
    for (size_t i = 0; i < c->faces.count; i++)
        c->heights[c->faces.data[i]] = image[c->faces.data[i]];
    return STARG_OK;
}

static starg_status choose_cut(cone_builder *b, uint32_t which, int blind, cut_choice *c) {
    TRY(cones_list_edges(b, which, &c->edges));
    NEW(b->context, STAGE, c->heights, b->about.count);
    TRY(make_trees(b, c));
    size_t planes = PLANES + WORK / c->faces.count;
    for (size_t i = 0; i < (planes < PLANES_MOST ? planes : PLANES_MOST); i++) {
        bool found = true;
        int end = blind;
        if (i % SEARCHED == 0)
            TRY(cones_search_plane(b, which, end, &c->faces, c->heights, &found));
        else
            cones_draw_plane(b, end = (int)starg_rng_below(&b->rng, 2), &c->faces, c->heights);
        if (!found)
            continue;
        TRY(weigh(b, which, c, &found));
        for (int k = 1; k <= BENDS && found && c->loops.lengths.count == 1; k++) {
            TRY(bend(b, end, c, k / (double)BENDS));
            TRY(weigh(b, which, c, &found));
        }
    }
    return STARG_OK;
}

/* ---- the cut ---- */

static starg_status split_crossed(cone_builder *b, const number_list *faces) {
    for (size_t i = 0; i < faces->count; i++) {
        uint32_t u = faces->data[i], v = faces->data[i % 3 == 2 ? i - 2 : i + 1];
        double p = b->heights.data[u], q = b->heights.data[v];
        if (u < v && p * q < 0)
            TRY(cones_split_edge(b, u, v, p / (p - q)));
    }
    return STARG_OK;
}

static starg_status build_wall(cone_builder *b, uint32_t which, const edge_list *edges,
                               const cut_node *loop, size_t count, loop_places places[2]) {
    uint32_t fresh, hub;
    double hubs[2][3], room;
    for (int end = 0; end < 2; end++) {
        TRY(cones_place_loop(b, end, loop, count, &places[end]));
        TRY(cones_find_hub(b, &places[end], hubs[end], &room));
    }
    TRY(cones_open_piece(b, b->pieces.data[which].attempts / 2, &fresh));
    TRY(cones_part(b, which, edges, loop, count, fresh));
    TRY(cones_add_vertex(b, (const double(*)[3])hubs, &hub));
    for (size_t i = 0; i < count; i++) {
        const uint32_t corners[3] = {loop[(i + 1) % count].from, loop[i].from, hub};
        const uint32_t sides[2] = {fresh, which};
        TRY(cones_add_triangle(b, corners, sides));
    }
    return STARG_OK;
}

/* The piece that holds the left side of an edge of `which` by now: itself or a later one. */
static uint32_t holder_of(const cone_builder *b, uint32_t which, const edge_list *edges, uint32_t u,
                          uint32_t v, uint32_t first_fresh) {
    uint32_t t = cones_across(edges, v, u);
    for (size_t s = 0; s < 2; s++)
        if (cones_side(b, t, s) == which ||
            (cones_side(b, t, s) >= first_fresh && cones_side(b, t, s) != NOWHERE))
            return cones_side(b, t, s);
    return which;
}

/* Cuts a piece along the heights of its vertices, where hubs have more room than `least`. */
static starg_status apply_cut(cone_builder *b, uint32_t which, double least, cut_choice *c,
                              bool *done) {
    SCOPED edge_list edges = {0};
    uint32_t first_fresh = (uint32_t)b->pieces.count;
    TRY(split_crossed(b, &c->faces));
    TRY(cones_list_edges(b, which, &c->edges));
    TRY(cones_list_faces(b, which, &c->faces));
    TRY(make_trees(b, c));
    TRY(cones_find_loops(b, which, &c->edges, b->heights.data, &c->loops, done));
    if (!*done)
        return STARG_OK;
    TRY(find_rooms(b, c, least));
    *done = false;
    const cut_node *loop = c->loops.nodes.data;
    for (size_t i = 0; i < c->loops.lengths.count; loop += c->loops.lengths.data[i++]) {
        if (!(c->loops.rooms.data[i] > 0))
            continue;
        *done = true;
        uint32_t holder = holder_of(b, which, &c->edges, loop[0].from, loop[1].from, first_fresh);
        TRY(cones_list_edges(b, holder, &edges));
        TRY(build_wall(b, holder, &edges, loop, c->loops.lengths.data[i], c->places));
    }
    return STARG_OK;
}

static starg_status cut_piece(cone_builder *b, uint32_t which, int blind, number_list *faces) {
    SCOPED_BY(choice_free) cut_choice c = {.faces = *faces};
    b->work += faces->count / 3;
    bool done = false;
    *faces = (number_list){0};
    TRY(choose_cut(b, which, blind, &c));
    double least = b->pieces.data[which].attempts < TIGHT_FROM ? ROOMY : TIGHT;
    if (c.room > least)
        TRY(apply_cut(b, which, least, &c, &done));
    if (done)
        b->pieces.data[which].attempts /= 2;
    else
        b->pieces.data[which].attempts++;
    return STARG_OK;
}

/* ---- all pieces ---- */

/* Later cuts may have divided faces of pieces that were done, with rounded points. */
static starg_status prove(cone_builder *b, uint32_t which, number_list *faces) {
    cone_piece *own = &b->pieces.data[which];
    TRY(cones_list_faces(b, which, faces));
    for (int end = 0; end < 2 && own->done; end++) {
        const kernel_faces surface = {b->places[end].data, faces->data, faces->count / 3};
        own->done = kernel_sees_all(&surface, own->centers[end]);
    }
    return STARG_OK;
}

/* Cuts until all are done (*left is 0) or one resists. */
static starg_status cut_all(cone_builder *b, size_t *left) {
    SCOPED number_list faces = {0};
    size_t most = GROWTH_MOST * (b->corners.count / 3);
    bool again = true;
    while (again) {
        again = false;
        for (uint32_t p = 0; p < b->pieces.count; p++)
            while (!b->pieces.data[p].done) {
                int blind;
                *left = 1;
                if (b->pieces.data[p].attempts == ATTEMPTS_MOST || b->corners.count / 3 > most)
                    return STARG_OK;
                TRY(starg_check_cancel(b->context, STAGE));
                TRY(cones_list_faces(b, p, &faces));
                TRY(find_centers(b, p, &faces, &blind));
                peel_verdict peeled = PEEL_NOTHING;
                if (blind >= 0)
                    TRY(cones_peel(b, p, blind, &peeled));
                if (peeled == PEEL_BROKEN)
                    return STARG_OK;
                if (blind >= 0 && peeled == PEEL_NOTHING)
                    TRY(cut_piece(b, p, blind, &faces));
            }
        *left = 0;
        for (uint32_t p = 0; p < b->pieces.count; p++) {
            bool before = b->pieces.data[p].done;
            TRY(prove(b, p, &faces));
            again = again || (before && !b->pieces.data[p].done);
            *left += !b->pieces.data[p].done;
        }
    }
    return STARG_OK;
}

/* ---- the result ---- */

/* Vertices of the surface first: those given, and those that divide it. */
static starg_status number_vertices(const cone_builder *b, uint32_t *numbers, size_t *surface) {
    size_t count = b->about.count, next = 0;
    memset(numbers, 0xff, count * sizeof *numbers);
    for (size_t t = 0; t < b->corners.count / 3; t++)
        if (b->sides.data[2 * t + 1] == NOWHERE)
            for (size_t k = 0; k < 3; k++)
                numbers[b->corners.data[3 * t + k]] = 0;
    for (size_t v = 0; v < count; v++)
        if (numbers[v] == 0)
            numbers[v] = (uint32_t)next++;
    *surface = next;
    for (size_t v = 0; v < count; v++)
        if (numbers[v] == NOWHERE)
            numbers[v] = (uint32_t)next++;
    return STARG_OK;
}

static starg_status make_places(const cone_builder *b, const uint32_t *numbers, int end,
                                double **out) {
    size_t count = b->about.count;
    NEW(b->context, STAGE, *out, 3 * (count + b->pieces.count));
    for (size_t v = 0; v < count; v++)
        vec3_copy(b->places[end].data + 3 * v, *out + 3 * (size_t)numbers[v]);
    for (size_t p = 0; p < b->pieces.count; p++)
        vec3_copy(b->pieces.data[p].centers[end], *out + 3 * (count + p));
    return STARG_OK;
}

static starg_status finish(const cone_builder *b, compatible_cones *out) {
    SCOPED uint32_t *numbers = NULL;
    SCOPED number_list faces = {0};
    size_t next = 0;
    out->vertex_count = b->about.count + b->pieces.count;
    out->piece_count = b->pieces.count;
    for (uint32_t p = 0; p < b->pieces.count; p++)
        out->count += b->pieces.data[p].triangles.count;
    NEW(b->context, STAGE, numbers, b->about.count);
    NEW(b->context, STAGE, out->tetrahedra, 4 * out->count);
    NEW(b->context, STAGE, out->labels, out->count);
    TRY(number_vertices(b, numbers, &out->surface_count));
    for (int end = 0; end < 2; end++)
        TRY(make_places(b, numbers, end, &out->places[end]));
    for (uint32_t p = 0; p < b->pieces.count; p++) {
        TRY(cones_list_faces(b, p, &faces));
        for (size_t f = 0; f < faces.count; f += 3) {
            uint32_t *cone = out->tetrahedra + 4 * next;
            cone[0] = numbers[faces.data[f]];
            cone[1] = numbers[faces.data[f + 2]];
            cone[2] = numbers[faces.data[f + 1]];
            cone[3] = (uint32_t)(b->about.count + p);
            out->labels[next++] = p;
        }
    }
    return STARG_OK;
}

void compatible_cones_free(starg_context *context, compatible_cones *cones) {
    for (int end = 0; end < 2; end++)
        starg_release(context, cones->places[end]);
    RELEASE(cones->tetrahedra, cones->labels);
    *cones = (compatible_cones){0};
}

starg_status compatible_fill(starg_context *context, const double *const places[2], size_t vertices,
                             const uint32_t *faces, size_t count, compatible_cones *out,
                             size_t *left) {
    starg_status status = STARG_OK;
    cone_builder b = {.context = context};
    *out = (compatible_cones){0};
    *left = 1;
    for (uint64_t round = 0; round<ROUNDS && * left> 0 && b.work < WORK_MOST; round++) {
        size_t work = b.work;
        cones_free(&b);
        b = (cone_builder){.context = context,
                           .work = work,
                           .first_end = (int)(round & 1),
                           .scratch = {.context = context},
                           .rng = starg_rng_make(context->seed, 3, round)};
        STARG_TRY(begin(&b, places, vertices, faces, count));
        STARG_TRY(cut_all(&b, left));
    }
    if (*left == 0)
        STARG_TRY(finish(&b, out));
done:
    cones_free(&b);
    if (status != STARG_OK)
        compatible_cones_free(context, out);
    return status;
}
