/* SPDX-License-Identifier: Apache-2.0 */
/* The fraction of the vertices of pieces that the pieces' guards see [YL11, section 4]: a vertex
 * counts once for each piece that it belongs to.
 *
 * A star-shaped piece is seen as a whole, by its proof. For the others each vertex is a segment
 * against the boundary of the whole mesh; a guard that is not strictly inside of it sees nothing.
 * Cost: O(n) and one look-up for each vertex of a piece that is not star-shaped. */
#include "core/parallel.h"
#include "star/decomposition.h"
#include "star/piece_faces.h"

static const char STAGE[] = "sight";

enum { CHUNK = 256 }; /* segments an item */

typedef struct pair {
    uint32_t piece, vertex;
} pair;

typedef struct counting {
    const starg_decomposition *d;
    const tet_sight *sight;
    STARG_ARRAY(pair) pairs; /* still to be tested */
    size_t total, seen;      /* without them      */
    size_t *seen_of_chunk;
} counting;

/* Tetrahedra filed by their labels: those of piece p are order[first[p]] and on. */
static void file_tetrahedra(const starg_decomposition *d, size_t *first, uint32_t *order) {
    for (size_t t = 0; t < d->mesh->count; t++)
        first[(size_t)d->labels[t] + 1]++;
    for (size_t p = 0; p < d->piece_count; p++)
        first[p + 1] += first[p];
    for (size_t t = d->mesh->count; t-- > 0;)
        order[--first[(size_t)d->labels[t] + 1]] = (uint32_t)t;
    for (size_t p = 0; p < d->piece_count; p++)
        first[p] = first[p + 1];
    first[d->piece_count] = d->mesh->count;
}

/* Takes each vertex of one piece once; `taken` says by which piece it was last. */
static starg_status take_piece(starg_context *context, counting *c, size_t piece,
                               const uint32_t *tetrahedra, size_t count, uint32_t *taken) {
    const starg_piece *p = &c->d->pieces[piece];
    bool test = !p->star && tet_sight_contains(c->sight, p->guard);
    for (size_t i = 0; i < 4 * count; i++) {
        uint32_t vertex = c->d->mesh->tetrahedra[4 * (size_t)tetrahedra[i / 4] + i % 4];
        if (taken[vertex] == piece)
            continue;
        taken[vertex] = (uint32_t)piece;
        c->total++;
        c->seen += p->star;
        if (test)
            PUSH(context, STAGE, &c->pairs, ((pair){(uint32_t)piece, vertex}));
    }
    return STARG_OK;
}

static starg_status take_all(starg_context *context, counting *c) {
    const starg_decomposition *d = c->d;
    SCOPED size_t *first = NULL;
    SCOPED uint32_t *order = NULL, *taken = NULL;
    NEW_ZERO(context, STAGE, first, d->piece_count + 1);
    NEW(context, STAGE, order, d->mesh->count);
    NEW(context, STAGE, taken, d->mesh->vertex_count);
    memset(taken, 0xff, d->mesh->vertex_count * sizeof *taken);
    file_tetrahedra(d, first, order);
    for (size_t p = 0; p < d->piece_count; p++)
        TRY(take_piece(context, c, p, order + first[p], first[p + 1] - first[p], taken));
    return STARG_OK;
}

static starg_status test_chunk(starg_context *context, void *shared, void *scratch, size_t item) {
    counting *c = shared;
    size_t end = (item + 1) * CHUNK < c->pairs.count ? (item + 1) * CHUNK : c->pairs.count;
    (void)context;
    (void)scratch;
    for (size_t i = item * CHUNK; i < end; i++) {
        const pair *p = &c->pairs.data[i];
        c->seen_of_chunk[item] += tet_sight_is_free(c->sight, c->d->pieces[p->piece].guard,
                                                    c->d->mesh->vertices + 3 * (size_t)p->vertex);
    }
    return STARG_OK;
}

static starg_status test_pairs(starg_context *context, counting *c) {
    starg_status status = STARG_OK;
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = (c->pairs.count + CHUNK - 1) / CHUNK,
                                      .shared = c,
                                      .item = test_chunk};
    STARG_NEW_ZERO(context, STAGE, c->seen_of_chunk, loop.count);
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t i = 0; i < loop.count; i++)
        c->seen += c->seen_of_chunk[i];
done:
    starg_release(context, c->seen_of_chunk);
    return status;
}

starg_status decomposition_find_sight(starg_context *context, starg_decomposition *d) {
    starg_status status = STARG_OK;
    tet_sight sight = {0};
    counting c = {.d = d, .sight = &sight};
    d->visible_vertices = 1;
    if (d->strictly_star == d->piece_count)
        return STARG_OK;
    STARG_TRY(tet_sight_create(context, d->mesh, &sight));
    STARG_TRY(take_all(context, &c));
    STARG_TRY(test_pairs(context, &c));
    d->visible_vertices = (double)c.seen / (double)c.total;
done:
    STARG_ARRAY_FREE(context, &c.pairs);
    tet_sight_free(&sight);
    return status;
}
