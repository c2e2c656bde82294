/* SPDX-License-Identifier: Apache-2.0 */
/* Takes a decomposition apart: facets, the outer boundary, labels, and the walls of each piece by
 * counting. Cost: O(n). */

#include "verify/pieces.h"

static const char STAGE[] = "verify";

/* Labels below the number of pieces; without a report that is one more than the largest. */
static void find_piece_count(verify_pieces *pieces, const starg_pieces_report *report) {
    const starg_pieces_mesh *mesh = pieces->mesh;
    int32_t most = -1;
    for (size_t t = 0; t < mesh->count; t++)
        most = mesh->labels[t] > most ? mesh->labels[t] : most;
    pieces->piece_count = report != NULL ? report->piece_count : (size_t)most + 1;
}

/* Counts the tetrahedra of each label. More pieces than tetrahedra leave some empty: counts stand
 * for the first ones only. */
static starg_status count_labels(verify_pieces *pieces) {
    const starg_pieces_mesh *mesh = pieces->mesh;
    verify_labels *labels = &pieces->labels;
    size_t counted = pieces->piece_count < mesh->count ? pieces->piece_count : mesh->count;
    labels->tetrahedron = VERIFY_NONE;
    labels->empty = pieces->piece_count - counted;
    labels->first = counted;
    NEW_ZERO(pieces->context, STAGE, pieces->sizes, counted);
    for (size_t t = mesh->count; t-- > 0;) {
        int32_t label = mesh->labels[t];
        if (label < 0 || (size_t)label >= pieces->piece_count)
            labels->tetrahedron = t;
        else if ((size_t)label < counted)
            pieces->sizes[label]++;
    }
    for (size_t p = counted; p-- > 0;)
        if (pieces->sizes[p] == 0) {
            labels->empty++;
            labels->first = p;
        }
    labels->good = labels->tetrahedron == VERIFY_NONE && labels->empty == 0;
    return STARG_OK;
}

static bool is_wall(const verify_pieces *pieces, size_t facet) {
    const int32_t *labels = pieces->mesh->labels;
    uint32_t mate = pieces->facets->mate[facet];
    return mate == VERIFY_NONE || labels[mate / 4] != labels[facet / 4];
}

/* Groups the walls by piece; within a piece they ascend. */
static starg_status gather_walls(verify_pieces *pieces) {
    starg_context *context = pieces->context;
    const starg_pieces_mesh *mesh = pieces->mesh;
    size_t *start, count;
    uint32_t *faces = NULL;
    NEW_ZERO(context, STAGE, pieces->wall_start, pieces->piece_count + 1);
    start = pieces->wall_start;
    for (size_t f = 0; f < 4 * mesh->count; f++)
        start[mesh->labels[f / 4]] += is_wall(pieces, f);
    for (size_t p = 1; p <= pieces->piece_count; p++)
        start[p] += start[p - 1];
    count = start[pieces->piece_count];
    NEW(context, STAGE, pieces->wall_facets, count);
    NEW(context, STAGE, faces, 3 * count);
    for (size_t f = 4 * mesh->count; f-- > 0;)
        if (is_wall(pieces, f)) {
            size_t wall = --start[mesh->labels[f / 4]];
            pieces->wall_facets[wall] = (uint32_t)f;
            verify_facet_corners(mesh->tetrahedra, (uint32_t)f, faces + 3 * wall);
        }
    return verify_surface_wrap(context, mesh->vertices, mesh->vertex_count, faces, count,
                               &pieces->walls);
}

starg_status verify_pieces_create(starg_context *context, const starg_pieces_mesh *mesh,
                                  const starg_pieces_report *report, verify_pieces **out) {
    SCOPED_BY(verify_pieces_drop) verify_pieces *pieces = NULL;
    uint32_t *faces = NULL;
    size_t count;
    *out = NULL;
    NEW_ZERO(context, STAGE, pieces, 1);
    *pieces = (verify_pieces){.context = context, .mesh = mesh};
    TRY(verify_facets_create(context, mesh->tetrahedra, mesh->count, &pieces->facets));
    TRY(verify_facets_outer(pieces->facets, &pieces->outer_facets, &faces, &count));
    TRY(verify_surface_wrap(context, mesh->vertices, mesh->vertex_count, faces, count,
                            &pieces->outer));
    pieces->scale = verify_scale(pieces->outer);
    find_piece_count(pieces, report);
    TRY(count_labels(pieces));
    if (pieces->labels.good)
        TRY(gather_walls(pieces));
    *out = pieces;
    pieces = NULL;
    return STARG_OK;
}

void verify_pieces_free(verify_pieces *pieces) {
    if (pieces == NULL)
        return;
    verify_facets_free(pieces->facets);
    verify_surface_free(pieces->outer);
    verify_surface_free(pieces->walls);
    RELEASE(pieces->outer_facets, pieces->sizes, pieces->wall_facets, pieces->wall_start, pieces);
}
