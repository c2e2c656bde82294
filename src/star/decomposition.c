/* SPDX-License-Identifier: Apache-2.0 */
/* The report about the pieces of a solid.
 *
 * Problem: labels on tetrahedra and a guard for each label are given; count and measure the pieces,
 * prove which of them are star-shaped, list which of them touch, and over what area.
 *
 * A piece is star-shaped, seen from its guard, if the guard is strictly on the inner side of each
 * face of the piece's boundary and the boundary winds around it once. Each closed part of such a
 * boundary winds around the guard at least once, so that there is one part, which is embedded
 * (visibility/kernel.c): a ball, whose tetrahedra hang together by faces.
 *
 * Invariants: star is decided exactly; volumes, radii and areas are rounded sums in the order of
 * the mesh. Cost: O(n) and a sort of the inner faces between pieces; sight: star/piece_faces.c. */
#include "star/decomposition.h"

#include <stdlib.h>

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "star/piece_faces.h"

static const char STAGE[] = "pieces";

/* ---- pieces ---- */

typedef struct measuring {
    starg_decomposition *result;
    piece_faces faces;
    int exponent; /* lengths are measured in units of 2^exponent */
} measuring;

static void scaled_difference(const measuring *m, const double a[3], const double b[3],
                              double out[3]) {
    vec3_subtract(a, b, out);
    for (int k = 0; k < 3; k++)
        out[k] = ldexp(out[k], -m->exponent);
}

/* Twice the area vector of a face, in units squared. */
static void scaled_normal(const measuring *m, const uint32_t corners[3], double out[3]) {
    const double *v = m->result->mesh->vertices, *a = v + 3 * (size_t)corners[0];
    double ab[3], ac[3];
    scaled_difference(m, v + 3 * (size_t)corners[1], a, ab);
    scaled_difference(m, v + 3 * (size_t)corners[2], a, ac);
    vec3_cross(ab, ac, out);
}

static void sum_volumes(const measuring *m) {
    starg_decomposition *d = m->result;
    for (size_t t = 0; t < d->mesh->count; t++) {
        starg_piece *piece = &d->pieces[d->labels[t]];
        piece->tetrahedra++;
        piece->volume += tetmesh_scaled_volume(d->mesh, t, m->exponent);
    }
    for (size_t p = 0; p < d->piece_count; p++)
        d->pieces[p].volume = ldexp(d->pieces[p].volume / 6, 3 * m->exponent);
}

static double find_radius(const measuring *m, const kernel_faces *surface, const double guard[3]) {
    double radius = INFINITY;
    for (size_t f = 0; f < surface->count; f++) {
        double normal[3], out[3];
        const uint32_t *corners = surface->faces + 3 * f;
        scaled_normal(m, corners, normal);
        scaled_difference(m, surface->vertices + 3 * (size_t)corners[0], guard, out);
        double length = vec3_length(normal);
        if (length > 0)
            radius = fmin(radius, vec3_dot(normal, out) / length);
    }
    return isfinite(radius) ? ldexp(radius, m->exponent) : 0;
}

/* Of the bounding box of a surface, in units. */
static double find_diagonal(const measuring *m, const kernel_faces *surface) {
    double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
    double extent[3];
    for (size_t i = 0; i < 3 * surface->count; i++)
        for (int k = 0; k < 3; k++) {
            double x = surface->vertices[3 * (size_t)surface->faces[i] + (size_t)k];
            least[k] = fmin(least[k], x);
            most[k] = fmax(most[k], x);
        }
    scaled_difference(m, most, least, extent);
    return vec3_length(extent);
}

static starg_status measure_piece(starg_context *context, void *shared, void *scratch,
                                  size_t index) {
    const measuring *m = shared;
    starg_piece *piece = &m->result->pieces[index];
    const kernel_faces surface = piece_faces_of(&m->faces, index);
    (void)context;
    (void)scratch;
    piece->radius = find_radius(m, &surface, piece->guard);
    piece->margin = ldexp(piece->radius, -m->exponent) / find_diagonal(m, &surface);
    piece->star =
        kernel_sees_all(&surface, piece->guard) && kernel_winding(&surface, piece->guard) == 1;
    return STARG_OK;
}

static starg_status measure_pieces(starg_context *context, starg_decomposition *d) {
    starg_status status = STARG_OK;
    measuring m = {.result = d, .exponent = tetmesh_exponent(d->mesh)};
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = d->piece_count, .shared = &m, .item = measure_piece};
    STARG_TRY(piece_faces_create(context, d->mesh, d->labels, d->piece_count, &m.faces));
    sum_volumes(&m);
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t p = 0; p < d->piece_count; p++)
        d->strictly_star += d->pieces[p].star;
done:
    piece_faces_free(&m.faces);
    return status;
}

/* ---- contacts ---- */

/* A face between two pieces, counted at the tetrahedron of the lower label. */
typedef struct inner_face {
    uint32_t first, second, face;
} inner_face;

static int compare_inner(const void *left, const void *right) {
    const inner_face *a = left, *b = right;
    if (a->first != b->first)
        return a->first < b->first ? -1 : 1;
    if (a->second != b->second)
        return a->second < b->second ? -1 : 1;
    return (a->face > b->face) - (a->face < b->face);
}

static bool is_inner(const starg_decomposition *d, size_t face) {
    uint32_t neighbour = d->mesh->neighbours[face];
    return neighbour != STARG_TETMESH_NONE && d->labels[face / 4] < d->labels[neighbour];
}

static size_t count_inner(const starg_decomposition *d) {
    size_t count = 0;
    for (size_t f = 0; f < 4 * d->mesh->count; f++)
        count += is_inner(d, f);
    return count;
}

static void collect_inner(const starg_decomposition *d, inner_face *faces) {
    size_t count = 0;
    for (size_t f = 0; f < 4 * d->mesh->count; f++)
        if (is_inner(d, f))
            faces[count++] = (inner_face){(uint32_t)d->labels[f / 4],
                                          (uint32_t)d->labels[d->mesh->neighbours[f]], (uint32_t)f};
}

/* Faces of the same pair, which are neighbours in their order, become one contact. */
static size_t join_inner(starg_decomposition *d, const inner_face *faces, size_t count) {
    const measuring m = {.result = d, .exponent = tetmesh_exponent(d->mesh)};
    size_t contacts = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t corners[3];
        double normal[3];
        if (i == 0 || faces[i].first != faces[i - 1].first ||
            faces[i].second != faces[i - 1].second)
            d->contacts[contacts++] =
                (starg_piece_contact){.first = faces[i].first, .second = faces[i].second};
        piece_face_corners(d->mesh, faces[i].face, corners);
        scaled_normal(&m, corners, normal);
        d->contacts[contacts - 1].area += ldexp(0.5 * vec3_length(normal), 2 * m.exponent);
    }
    return contacts;
}

static starg_status find_contacts(starg_context *context, starg_decomposition *d) {
    SCOPED inner_face *faces = NULL;
    size_t count = count_inner(d);
    NEW(context, STAGE, faces, count);
    NEW(context, STAGE, d->contacts, count);
    collect_inner(d, faces);
    qsort(faces, count, sizeof *faces, compare_inner);
    d->contact_count = join_inner(d, faces, count);
    return STARG_OK;
}

/* ---- the result ---- */

static starg_status add_pieces(starg_context *context, starg_decomposition *d, const double *guards,
                               size_t count) {
    NEW_ZERO(context, STAGE, d->pieces, count);
    d->piece_count = count;
    for (size_t p = 0; p < count; p++)
        vec3_copy(guards + 3 * p, d->pieces[p].guard);
    return STARG_OK;
}

starg_status decomposition_finish(starg_context *context, starg_decompose_mode mode,
                                  starg_tetmesh *mesh, int32_t *labels, const double *guards,
                                  size_t count, starg_decomposition **out) {
    starg_status status = STARG_OK;
    starg_decomposition *d = NULL;
    *out = NULL;
    starg_progress_begin(context, STAGE);
    STARG_NEW_ZERO(context, STAGE, d, 1);
    *d = (starg_decomposition){.mode = mode,
                               .model_vertices = mesh->vertex_count,
                               .model_tetrahedra = mesh->count,
                               .tetra = {.surface_kept = true},
                               .mesh = mesh,
                               .tetrahedra = mesh->count,
                               .labels = labels};
    mesh = NULL;
    labels = NULL;
    STARG_TRY(add_pieces(context, d, guards, count));
    STARG_TRY(measure_pieces(context, d));
    STARG_TRY(find_contacts(context, d));
    STARG_TRY(angles_measure(context, d));
    STARG_TRY(decomposition_find_sight(context, d));
    *out = d;
done:
    if (status != STARG_OK)
        starg_decomposition_free(context, d);
    starg_tetmesh_free(mesh);
    starg_release(context, labels);
    starg_progress_end(context);
    return status;
}

void starg_decomposition_free(starg_context *context, starg_decomposition *decomposition) {
    (void)context;
    if (decomposition == NULL)
        return;
    starg_tetmesh_free(decomposition->mesh);
    RELEASE(decomposition->file, decomposition->labels, decomposition->pieces,
            decomposition->contacts, decomposition->ball_corners, decomposition);
}
