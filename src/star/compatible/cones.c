/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids with the same faces, cut alike into pieces that are star-shaped in both, and filled by
 * cones.
 *
 * Problem: a triangulated sphere lies in two places, and bounds a solid in each. Fill both with the
 * same tetrahedra, positive in both. No tetrahedra are given: nothing inside has to be unfolded.
 *
 * Method: the boundary of a piece is a triangulated sphere in both places. One with a kernel in
 * both is done: it is filled by cones from a point of each. Any other is cut, by a plane in a place
 * where it has no kernel, so that the other place keeps its kernel (peel.c). Edges that cross the
 * plane are divided, in the other place in the same ratio, so that the plane meets the piece in
 * loops of edges; one of them is spanned in both places by a wall of the two pieces that it parts.
 * Where a piece resists, it is begun anew with other planes, and if that fails, the piece that it
 * is a part of.
 *
 * Invariants: triangles fit together, edge to edge, in all pieces: an edge is divided in all of its
 * triangles. Whether walls stay inside the solid is never asked: pieces with kernels on all sides
 * are proof enough, since tetrahedra that are positive in a place, with the surface there as their
 * boundary, fill the solid once. All signs of results are exact.
 *
 * Cost: that of the cuts. */
#include "star/compatible/compatible.h"

#include "geometry/vec3.h"
#include "star/compatible/cone_builder.h"

static const char STAGE[] = "cones";

enum { ROUNDS = 8, ATTEMPTS_MOST = 3 }; /* of a piece; of a cut */
/* Of triangles and of faces of cut pieces in a round, and of the latter in all, in times of the
 * faces and EASY more. */
enum { GROWTH_MOST = 8, WORK_MOST = 20, WORK_ALL = 100, EASY = 100 };

static starg_status begin(cone_builder *b, const compatible_surface *s) {
    const uint32_t whole[2] = {0, NOWHERE};
    uint32_t number;
    for (size_t p = 0; p < s->piece_count; p++)
        TRY(cones_open_piece(b, 0, &number));
    for (size_t v = 0; v < s->vertex_count; v++) {
        double from[2][3];
        for (int end = 0; end < 2; end++)
            vec3_copy(s->places[end] + 3 * v, from[end]);
        TRY(cones_add_vertex(b, (const double(*)[3])from, &number));
    }
    for (size_t f = 0; f < s->count; f++)
        TRY(cones_add_triangle(b, s->faces + 3 * f, s->sides != NULL ? s->sides + 2 * f : whole));
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

/* How many triangles there may be, and how many faces of pieces may have been looked at. */
typedef struct limits {
    size_t triangles, work;
} limits;

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Within those of a larger piece. */
static limits limits_of(const cone_builder *b, size_t faces, const limits *outer) {
    return (limits){least(outer->triangles, b->corners.count / 3 + GROWTH_MOST * (faces + EASY)),
                    least(outer->work, b->work + WORK_MOST * (faces + EASY))};
}

/* Cuts off leaves until the piece has a kernel in both places, or resists. */
static starg_status cut_piece(cone_builder *b, uint32_t which, const limits *most, bool *done) {
    SCOPED number_list faces = {0};
    int attempts = 0;
    for (;;) {
        int blind;
        TRY(starg_check_cancel(b->context, STAGE));
        TRY(cones_list_faces(b, which, &faces));
        TRY(find_centers(b, which, &faces, &blind));
        *done = b->pieces.data[which].done;
        if (*done || attempts == ATTEMPTS_MOST || b->corners.count / 3 > most->triangles ||
            b->work > most->work)
            return STARG_OK;
        peel_verdict peeled;
        TRY(cones_peel(b, which, blind, &peeled));
        if (peeled == PEEL_BROKEN)
            return STARG_OK;
        attempts += peeled == PEEL_NOTHING;
        b->pieces.data[which].attempts = attempts;
    }
}

/* Divides a piece into pieces that have kernels in both places. Where a part of it resists, that is
 * begun anew with other planes, and if it still resists, the whole. */
static starg_status divide(cone_builder *b, uint32_t which, const limits *outer, bool *done) {
    SCOPED_BY(cones_free_state) cone_state before = {0};
    const size_t faces = b->pieces.data[which].triangles.count;
    *done = false;
    TRY(cones_save(b, &before));
    for (int i = 0; i < ROUNDS && !*done; i++) {
        if (i > 0)
            TRY(cones_restore(b, &before));
        const limits own = limits_of(b, faces, outer);
        const uint32_t first = (uint32_t)b->pieces.count;
        b->balance = i % 2;
        TRY(cut_piece(b, which, &own, done));
        const uint32_t end = (uint32_t)b->pieces.count;
        for (uint32_t leaf = first; leaf < end && *done; leaf++)
            TRY(divide(b, leaf, &own, done));
        if (b->work > outer->work)
            break;
    }
    return STARG_OK;
}

/* Until all are done, or one resists: *left is 1. */
static starg_status divide_all(cone_builder *b, size_t work, size_t *left) {
    SCOPED number_list faces = {0};
    const size_t count = b->corners.count / 3;
    const limits most = {SIZE_MAX, work > 0 ? work : WORK_ALL * (count + EASY)};
    bool done = false;
    *left = 1;
    for (uint32_t p = 0; p < b->pieces.count; p++) {
        TRY(prove(b, p, &faces));
        if (b->pieces.data[p].done)
            continue;
        TRY(divide(b, p, &most, &done));
        if (!done)
            return STARG_OK;
        p = UINT32_MAX; /* from the first one on: later cuts divide faces of others */
    }
    *left = 0;
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

starg_status compatible_fill(starg_context *context, const compatible_surface *surface,
                             compatible_cones *out, size_t *left) {
    starg_status status = STARG_OK;
    cone_builder b = {.context = context,
                      .scratch = {.context = context},
                      .rng = starg_rng_make(context->seed, 3, 0)};
    *out = (compatible_cones){0};
    STARG_TRY(begin(&b, surface));
    STARG_TRY(divide_all(&b, surface->work, left));
    if (*left == 0)
        STARG_TRY(finish(&b, out));
done:
    cones_free(&b);
    if (status != STARG_OK)
        compatible_cones_free(context, out);
    return status;
}
