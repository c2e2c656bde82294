/* SPDX-License-Identifier: Apache-2.0 */
/* Maps between solids: the same tetrahedra in two places.
 *
 * Problem: the surfaces of A and B are given with the same faces, or with a map and its overlay.
 * Find tetrahedra with that boundary that are positive in A and in B; so that the map that is
 * linear on each is a homeomorphism of the solids.
 *
 * Stages with an overlay: cones about a point of each kernel (solid_stars.c), or in pieces that are
 * star-shaped in both (star/compatible/cones.c), or, with another map of the surfaces unless one is
 * given, in pieces between limbs (limbs.c). If there are none, to B in A's connectivity as
 * below, which may meet itself; then divide the tetrahedra along the overlay (solid_overlay.c), and
 * put its corners into place on B.
 *
 * With equal faces, of any genus: fill A (solids.c); let the tetrahedra follow an
 * as-rigid-as-possible morph to B (deform.c), and where that ends too soon, put the surface into
 * place and unfold (unfold.c). If B in A's faces need not be met: where it meets itself or
 * tetrahedra stay inverted, come as near to it as they allow (approach.c).
 *
 * Then lower the distortion by moving inner vertices in B, then in A; find pieces that are
 * star-shaped in both (star/compatible/compatible.c), or join those of cones; measure.
 *
 * Invariant: at the end all tetrahedra are positive in both, by exact signs. Their boundary in A,
 * and in B where the surface has its final place, is checked to be embedded; so the tetrahedra fill
 * both. Cost: that of its stages. */

#include "morph/solid_map.h"
#include "core/fields.h"
#include "geometry/singular_values.h"
#include "geometry/vec3.h"
#include "mesh/solid.h"
#include "morph/limbs.h"
#include "morph/morph.h"
#include "star/compatible/compatible.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "solid map";
enum { UNFOLD_STEPS = 2000, ROUNDS = 8, FEW = 40 };
enum { FULL_STEPS = 10000 }; /* tetrahedra, above which there are fewer steps */
/* Faces that are looked at for cuts before another map of the surfaces is tried. */
enum { LITTLE = 10000 };
/* Ratios of singular values: from where they count as high, and what stands for more. */
static const double HIGH = 10, HIGHEST = 1e300;
/* In diagonals of B: how far the image of A's surface may be from it. */
static const double MOST_OFF = 0.02;
static const double STRENGTHS[] = {1000, 100, 10, 1}; /* of springs on the surface, in turn */

/* ---- tetrahedra in both places ---- */

/* Inner vertices of one place (0: A, 1: B) are free, those of the other are the rest. */
static unfold_problem problem_of(deform_mesh *c, int free_end) {
    return (unfold_problem){.context = c->context,
                            .vertex_count = c->rest.count / 3,
                            .fixed = c->fixed,
                            .count = c->tetrahedra.count / 4,
                            .tetrahedra = c->tetrahedra.data,
                            .rest = free_end == 1 ? c->rest.data : c->now.data,
                            .now = free_end == 1 ? c->now.data : c->rest.data};
}

/* The edges of inverted tetrahedra that are not on the surface. */
static starg_status split_inverted(deform_mesh *c) {
    const unfold_problem p = problem_of(c, 1);
    SCOPED STARG_ARRAY(deform_edge) edges = {0};
    for (size_t i = 0; i < 6 * p.count; i++) {
        uint32_t a = p.tetrahedra[i / 6 * 4 + (size_t)DEFORM_EDGES[i % 6][0]];
        uint32_t b = p.tetrahedra[i / 6 * 4 + (size_t)DEFORM_EDGES[i % 6][1]];
        if ((a >= c->fixed || b >= c->fixed) && !unfold_is_positive(&p, i / 6))
            PUSH(c->context, STAGE, &edges, deform_edge_of(a, b));
    }
    deform_edges_sort(edges.data, &edges.count);
    return deform_split(c, edges.data, edges.count);
}

/* Puts the surface into place at once, and all vertices inside along with it; then moves these
 * until nothing is inverted. Where that does not do, there are more of them. */
static starg_status unfold_at_end(const starg_morph *m, deform_mesh *c, size_t *inverted) {
    TRY(deform_harmonic(m, c));
    for (int round = 0; round < ROUNDS; round++) {
        const unfold_problem p = problem_of(c, 1);
        TRY(unfold(&p, UNFOLD_STEPS, inverted));
        if (*inverted == 0 || *inverted > p.count / FEW) /* not a matter of single vertices */
            break;
        TRY(split_inverted(c));
    }
    return STARG_OK;
}

static starg_status fail_inverted(starg_context *context, size_t all, size_t inverted) {
    return starg_fail(context, STARG_ERROR_MESH, STAGE,
                      "%zu of %zu tetrahedra stay inverted in B: A's surface folds too much in B; "
                      "a finer A (--density, or more vertices), another map of the surfaces or "
                      "landmarks may do",
                      inverted, all);
}

/* Along a morph, or at once, to B itself. */
static starg_status spread(const starg_morph *m, deform_mesh *c, size_t *inverted) {
    double reached = 0;
    *inverted = 0;
    if (m->method == STARG_MORPH_ARAP)
        TRY(deform(m, c, NULL, inverted, &reached));
    else
        memset(c->now.data, 0, c->now.count * sizeof *c->now.data);
    if (reached < 1)
        TRY(unfold_at_end(m, c, inverted));
    return STARG_OK;
}

static starg_status spread_exactly(const starg_morph *m, deform_mesh *c) {
    size_t inverted;
    starg_status status = spread(m, c, &inverted);
    return status == STARG_OK && inverted > 0
               ? fail_inverted(c->context, c->tetrahedra.count / 4, inverted)
               : status;
}

static starg_status make_morph(starg_context *context, const starg_mesh *a, const double *images,
                               starg_morph_method method, starg_morph **out) {
    starg_morph_options options;
    starg_morph_options_default(&options);
    options.method = method;
    return starg_morph_create(context, a, images, &options, out);
}

/* Does the surface of the tetrahedra in B meet itself? */
static starg_status image_meets_itself(const starg_mesh *a, const deform_mesh *c, bool *out) {
    SCOPED_BY(starg_morph_drop) starg_morph *last = NULL;
    SCOPED double *images = NULL;
    NEW(c->context, STAGE, images, 3 * a->vertex_count);
    memcpy(images, a->vertices, 3 * a->vertex_count * sizeof *images);
    for (size_t v = 0; v < c->fixed; v++)
        vec3_copy(c->now.data + 3 * v, images + 3 * (size_t)c->surface[v]);
    TRY(make_morph(c->context, a, images, STARG_MORPH_LINEAR, &last));
    return solids_last_meets_itself(last, out);
}

static starg_status fail_nearly(const deform_mesh *c, const approach_result *off) {
    if (off->inverted > 0)
        return fail_inverted(c->context, c->tetrahedra.count / 4, off->inverted);
    if (off->farthest > MOST_OFF)
        return starg_fail(
            c->context, STARG_ERROR_MESH, STAGE,
            "A's surface folds in B, and unfolded it is up to %.2g %% of the diagonal "
            "off B, more than the %g %% allowed; a finer A, another map of the "
            "surfaces or landmarks may do",
            100 * off->farthest, 100 * MOST_OFF);
    return starg_fail(c->context, STARG_ERROR_MESH, STAGE,
                      "A's surface folds in B, and meets itself when it is unfolded; a finer A, "
                      "another map of the surfaces or landmarks may do");
}

/* As near to B as possible: B meets itself, or tetrahedra stay inverted there. The strongest
 * springs that let the tetrahedra unfold, without the surface meeting itself, keep it nearest. */
static starg_status spread_nearly(const starg_morph *m, deform_mesh *c, approach_result *off) {
    for (size_t i = 0; i < sizeof STRENGTHS / sizeof *STRENGTHS; i++) {
        bool meets_itself = true;
        memset(c->now.data, 0, c->now.count * sizeof *c->now.data);
        TRY(deform_harmonic(m, c));
        TRY(approach(c, m->mesh, STRENGTHS[i], off));
        if (off->inverted > 0 || off->farthest > MOST_OFF)
            continue;
        TRY(image_meets_itself(m->mesh, c, &meets_itself));
        if (!meets_itself)
            return STARG_OK;
    }
    return fail_nearly(c, off); /* with the weakest springs */
}

/* To B itself if that is possible, else near it. */
static starg_status spread_or_approach(const starg_morph *m, deform_mesh *c, approach_result *off) {
    size_t inverted = 0;
    bool meets_itself;
    TRY(solids_last_meets_itself(m, &meets_itself));
    if (!meets_itself)
        TRY(spread(m, c, &inverted));
    if (meets_itself || inverted > 0)
        TRY(spread_nearly(m, c, off));
    return STARG_OK;
}

/* Fewer steps where there are many tetrahedra: the first ones bring most. The time limit ends it,
 * as there is a map. */
static starg_status relax(deform_mesh *c, size_t steps, double until) {
    const size_t count = c->tetrahedra.count / 4;
    const size_t most = count > FULL_STEPS ? steps * FULL_STEPS / count : steps;
    for (int end = 1; end >= 0; end--) {
        unfold_problem p = problem_of(c, end);
        p.until = until;
        TRY(unfold_relax(&p, most));
    }
    return STARG_OK;
}

/* ---- results ---- */

static starg_status copy_guards(starg_context *context, const starg_decomposition *d,
                                double **out) {
    NEW(context, STAGE, *out, 3 * d->piece_count);
    for (size_t p = 0; p < d->piece_count; p++)
        vec3_copy(d->pieces[p].guard, *out + 3 * p);
    return STARG_OK;
}

static starg_status take_pieces(starg_context *context, const starg_decomposition *const pieces[2],
                                starg_solid_map *map) {
    const starg_tetmesh *a = pieces[0]->mesh, *b = pieces[1]->mesh;
    map->vertex_count = a->vertex_count;
    map->count = a->count;
    map->piece_count = pieces[0]->piece_count;
    NEW(context, STAGE, map->vertices, 3 * a->vertex_count);
    NEW(context, STAGE, map->images, 3 * a->vertex_count);
    NEW(context, STAGE, map->tetrahedra, 4 * a->count);
    NEW(context, STAGE, map->labels, a->count);
    memcpy(map->vertices, a->vertices, 3 * a->vertex_count * sizeof *map->vertices);
    memcpy(map->images, b->vertices, 3 * a->vertex_count * sizeof *map->images);
    memcpy(map->tetrahedra, a->tetrahedra, 4 * a->count * sizeof *map->tetrahedra);
    memcpy(map->labels, pieces[0]->labels, a->count * sizeof *map->labels);
    TRY(copy_guards(context, pieces[0], &map->guards));
    return copy_guards(context, pieces[1], &map->guard_images);
}

/* Edges from the last corner, in units of 2^exponent. */
static void edges_of(const double *vertices, const uint32_t *corners, int exponent,
                     double out[3][3]) {
    const double *last = vertices + 3 * (size_t)corners[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[i][k] = ldexp(vertices[3 * (size_t)corners[i] + (size_t)k] - last[k], -exponent);
}

static int exponent_of(const double *vertices, size_t count) {
    double most = 0;
    int exponent;
    for (size_t i = 0; i < 3 * count; i++)
        most = fmax(most, fabs(vertices[i] - vertices[i % 3]));
    frexp(most, &exponent);
    return exponent;
}

double solid_map_ratio(const starg_solid_map *map, size_t t, const int exponents[2],
                       double *volume) {
    double from[3][3], to[3][3], values[3];
    edges_of(map->vertices, map->tetrahedra + 4 * t, exponents[0], from);
    edges_of(map->images, map->tetrahedra + 4 * t, exponents[1], to);
    singular_values(from, to, values);
    *volume = fabs(vec3_triple(from[0], from[1], from[2]));
    return values[2] > 0 ? fmin(values[0] / values[2], HIGHEST) : HIGHEST;
}

void solid_map_exponents(const starg_solid_map *map, int out[2]) {
    out[0] = exponent_of(map->vertices, map->vertex_count);
    out[1] = exponent_of(map->images, map->vertex_count);
}

static void measure(starg_solid_map *map) {
    double all = 0, sum = 0, high = 0;
    int exponents[2];
    solid_map_exponents(map, exponents);
    for (size_t t = 0; t < map->count; t++) {
        double volume, ratio = solid_map_ratio(map, t, exponents, &volume);
        map->worst = fmax(map->worst, ratio);
        all += volume;
        sum += volume * ratio;
        high += ratio > HIGH ? volume : 0;
    }
    map->mean = sum / all;
    map->above_10 = fmin(high / all, 1);
}

/* Both ends in pieces, measured. */
static starg_status take_result(starg_context *context, starg_decomposition *const pieces[2],
                                starg_solid_map **out) {
    SCOPED_BY(starg_solid_map_drop) starg_solid_map *map = NULL;
    NEW_ZERO(context, STAGE, map, 1);
    TRY(take_pieces(context, (const starg_decomposition *const *)pieces, map));
    measure(map);
    *out = map;
    map = NULL;
    return STARG_OK;
}

typedef struct both_ends {
    starg_context *context;
    starg_tetmesh *places[2];
    starg_decomposition *pieces[2];
} both_ends;

static void free_both(both_ends *b) {
    for (int end = 0; end < 2; end++) {
        starg_tetmesh_free(b->places[end]);
        starg_decomposition_free(b->context, b->pieces[end]);
    }
}

static starg_status place_both(const deform_mesh *c, both_ends *b) {
    TRY(solids_place(c, c->rest.data, &b->places[0]));
    return solids_place(c, c->now.data, &b->places[1]);
}

starg_status solid_map_finish(starg_context *context, const deform_mesh *c, bool cut,
                              starg_solid_map **out) {
    SCOPED_BY(free_both) both_ends b = {.context = context};
    TRY(place_both(c, &b));
    TRY(compatible_decompose(context, b.places[0], b.places[1], cut, b.pieces));
    return take_result(context, b.pieces, out);
}

starg_status solid_map_finish_cones(starg_context *context, const deform_mesh *c,
                                    const uint32_t *labels, size_t count, starg_solid_map **out) {
    SCOPED_BY(free_both) both_ends b = {.context = context};
    const double *const guards[2] = {c->rest.data + c->rest.count - 3 * count,
                                     c->now.data + c->now.count - 3 * count};
    TRY(place_both(c, &b));
    TRY(compatible_join(context, b.places[0], b.places[1], labels, guards, count, b.pieces));
    return take_result(context, b.pieces, out);
}

/* ---- public functions ---- */

static starg_status check_options(starg_context *context, const starg_solid_map_options **options,
                                  starg_solid_map_options *defaults) {
    starg_solid_map_options_default(defaults);
    if (*options == NULL)
        *options = defaults;
    return fields_check(context, STAGE, starg_solid_map_options_fields(), *options);
}

/* Pieces of cones. The last vertices see one piece each. */
typedef struct cone_labels {
    uint32_t *labels; /* per tetrahedron; NULL: there are none */
    size_t count;
} cone_labels;

/* Takes cones in pieces as the tetrahedra. */
static starg_status take_cones(compatible_cones *cones, deform_mesh *c, cone_labels *out) {
    c->fixed = cones->surface_count;
    for (size_t i = 0; i < 3 * cones->vertex_count; i++) {
        PUSH(c->context, STAGE, &c->rest, cones->places[0][i]);
        PUSH(c->context, STAGE, &c->now, cones->places[1][i]);
    }
    for (size_t i = 0; i < 4 * cones->count; i++)
        PUSH(c->context, STAGE, &c->tetrahedra, cones->tetrahedra[i]);
    *out = (cone_labels){cones->labels, cones->piece_count};
    cones->labels = NULL;
    return STARG_OK;
}

/* Pieces that are star-shaped in both ends, if they are found. */
static starg_status spread_pieces(const starg_mesh *divided, const double *images, size_t work,
                                  deform_mesh *c, cone_labels *out) {
    starg_status status = STARG_OK;
    const compatible_surface surface = {.places = {divided->vertices, images},
                                        .vertex_count = divided->vertex_count,
                                        .count = divided->face_count,
                                        .faces = divided->faces,
                                        .piece_count = 1,
                                        .work = work};
    compatible_cones cones = {0};
    size_t left;
    STARG_TRY(compatible_fill(c->context, &surface, &cones, &left));
    if (left == 0)
        STARG_TRY(take_cones(&cones, c, out));
done:
    compatible_cones_free(c->context, &cones);
    return status;
}

/* The same by way of limbs, with another map of the surfaces. */
static starg_status spread_limbs(const starg_mesh *a, const starg_mesh *b, deform_mesh *c,
                                 cone_labels *out) {
    starg_status status = STARG_OK;
    const starg_mesh *const meshes[2] = {a, b};
    compatible_cones cones = {0};
    bool found;
    STARG_TRY(limbs_fill(c->context, meshes, &cones, &found));
    if (found)
        STARG_TRY(take_cones(&cones, c, out));
done:
    compatible_cones_free(c->context, &cones);
    return status;
}

/* Less distortion, as long as there is time, and pieces; releases the labels. */
static starg_status finish_spread(deform_mesh *c, cone_labels *cones, size_t steps,
                                  starg_solid_map **out) {
    SCOPED uint32_t *labels = cones->labels;
    cones->labels = NULL;
    const double until = starg_clock() + starg_seconds_left(c->context);
    TIME_RULE(c->context, STARG_TIME_IGNORED);
    TRY(relax(c, steps, until));
    return labels != NULL ? solid_map_finish_cones(c->context, c, labels, cones->count, out)
                          : solid_map_finish(c->context, c, true, out);
}

/* How near the images must be met: there, or near them if the surface folds. A shape is seen from
 * the origin, so that cones in pieces do where descent fails. */
typedef enum ending { ENDS_THERE, ENDS_NEAR, ENDS_IN_SHAPE } ending;

/* To the images, by descent or by cones. */
static starg_status spread_or_cut(const starg_morph *m, const starg_mesh *a, const double *images,
                                  ending wanted, deform_mesh *c, cone_labels *cones) {
    size_t inverted, count;
    TRY(solids_check_last(m));
    TRY(spread(m, c, &inverted));
    count = c->tetrahedra.count / 4;
    if (inverted > 0 && wanted == ENDS_IN_SHAPE) {
        SCOPED_BY(deform_free) deform_mesh other = {.context = c->context};
        TRY(spread_pieces(a, images, 0, &other, cones));
        const deform_mesh former = *c;
        *c = other;
        other = former;
    }
    return inverted == 0 || cones->labels != NULL ? STARG_OK
                                                  : fail_inverted(c->context, count, inverted);
}

/* Both ends have A's faces. */
static starg_status make_map(starg_context *context, const starg_mesh *a, const double *images,
                             ending wanted, const starg_solid_map_options *options,
                             starg_solid_map **out) {
    starg_solid_map_options defaults;
    SCOPED_BY(starg_morph_drop) starg_morph *m = NULL;
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED uint32_t *surface = NULL;
    approach_result off = {0};
    cone_labels cones = {0};
    SCOPED_BY(deform_free) deform_mesh c = {.context = context};
    TRY(check_options(context, &options, &defaults));
    TRY(make_morph(context, a, images,
                   wanted == ENDS_IN_SHAPE ? STARG_MORPH_LINEAR : STARG_MORPH_ARAP, &m));
    TRY(solids_fill_first(m, options->density, &c, &solid, &surface));
    if (wanted == ENDS_NEAR)
        TRY(spread_or_approach(m, &c, &off));
    else
        TRY(spread_or_cut(m, a, images, wanted, &c, &cones));
    TRY(finish_spread(&c, &cones, options->steps, out));
    (*out)->strayed = off.strayed;
    (*out)->farthest = off.farthest;
    return STARG_OK;
}

starg_status starg_solid_map_create(starg_context *context, const starg_mesh *a,
                                    const double *images, const starg_solid_map_options *options,
                                    starg_solid_map **out) {
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    return make_map(context, a, images, ENDS_NEAR, options, out);
}

/* A's tetrahedra where B's surface is that of the overlay: first to B in A's connectivity, then,
 * divided, to B. */
static starg_status spread_overlay(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                   const starg_map *map, double density, deform_mesh *c) {
    const starg_overlay *overlay = &map->overlay;
    SCOPED_BY(starg_morph_drop) starg_morph *first = NULL, *last = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *divided = NULL;
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED double *images = NULL;
    SCOPED uint32_t *surface = NULL;
    size_t inverted;
    NEW(context, STAGE, images, 3 * a->vertex_count + 3 * overlay->vertex_count);
    starg_map_positions(map, b, images);
    TRY(make_morph(context, a, images, STARG_MORPH_ARAP, &first));
    TRY(solids_fill_first(first, density, c, &solid, &surface));
    TRY(spread_exactly(first, c));
    TRY(solids_divide(c, a, overlay));
    TRY(starg_mesh_create(context, c->now.data, overlay->vertex_count, overlay->faces,
                          overlay->face_count, &divided));
    starg_overlay_positions(overlay, b, 1, images);
    RELEASE(surface);
    NEW(context, STAGE, surface, overlay->vertex_count);
    for (uint32_t v = 0; v < overlay->vertex_count; v++)
        surface[v] = v;
    c->surface = surface;
    TRY(make_morph(context, divided, images, STARG_MORPH_LINEAR, &last));
    TRY(solids_check_last(last));
    TRY(unfold_at_end(last, c, &inverted));
    c->surface = NULL;
    return inverted > 0 ? fail_inverted(c->context, c->tetrahedra.count / 4, inverted) : STARG_OK;
}

/* Cones about a point of each kernel, or else in pieces. */
static starg_status spread_cones(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                 const starg_map *map, deform_mesh *c, cone_labels *out) {
    const starg_overlay *overlay = &map->overlay;
    SCOPED_BY(starg_mesh_drop) starg_mesh *divided = NULL;
    SCOPED double *first = NULL, *second = NULL;
    SCOPED uint32_t *surface = NULL;
    bool found;
    NEW(context, STAGE, first, 3 * overlay->vertex_count);
    NEW(context, STAGE, second, 3 * overlay->vertex_count);
    starg_overlay_positions(overlay, a, 0, first);
    starg_overlay_positions(overlay, b, 1, second);
    TRY(starg_mesh_create(context, first, overlay->vertex_count, overlay->faces,
                          overlay->face_count, &divided));
    TRY(stars_fill(divided, second, map->centers, c, &surface, &found));
    c->surface = NULL;
    if (found) {
        NEW_ZERO(context, STAGE, out->labels, c->tetrahedra.count / 4);
        out->count = 1;
    } else if (map->kind != STARG_MAP_SAME) {
        TRY(solids_check_crossings(context, a, "A"));
        TRY(solids_check_crossings(context, b, "B"));
        TRY(spread_pieces(divided, second, LITTLE, c, out));
        if (out->labels == NULL && map->kind == STARG_MAP_SPHERE && map->pair_count == 0)
            TRY(spread_limbs(a, b, c, out));
        if (out->labels == NULL)
            TRY(spread_pieces(divided, second, 0, c, out));
    }
    return STARG_OK;
}

/* Is the overlay that of equal faces, at whose vertices nothing is divided? */
static bool divides_nothing(const starg_overlay *overlay, const starg_mesh *a,
                            const starg_mesh *b) {
    return overlay->vertex_count == a->vertex_count && overlay->vertex_count == b->vertex_count &&
           overlay->face_count == a->face_count &&
           memcmp(overlay->faces, a->faces, 3 * a->face_count * sizeof *a->faces) == 0 &&
           memcmp(overlay->faces, b->faces, 3 * a->face_count * sizeof *a->faces) == 0;
}

static starg_status make_overlay(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                 const starg_map *map, const starg_solid_map_options *options,
                                 starg_solid_map **out) {
    starg_solid_map_options defaults;
    cone_labels cones = {0};
    SCOPED_BY(deform_free) deform_mesh c = {.context = context};
    TRY(check_options(context, &options, &defaults));
    if (map->overlay.face_count == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the map has no overlay; starg_map_overlay makes one");
    if (divides_nothing(&map->overlay, a, b))
        return make_map(context, a, b->vertices, ENDS_THERE, options, out);
    TRY(spread_cones(context, a, b, map, &c, &cones));
    if (cones.labels == NULL)
        TRY(spread_overlay(context, a, b, map, options->density, &c));
    return finish_spread(&c, &cones, options->steps, out);
}

starg_status starg_solid_map_overlay(starg_context *context, const starg_mesh *a,
                                     const starg_mesh *b, const starg_map *map,
                                     const starg_solid_map_options *options,
                                     starg_solid_map **out) {
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    return make_overlay(context, a, b, map, options, out);
}

starg_status starg_solid_map_to(starg_context *context, const starg_mesh *a,
                                starg_solid_shape shape, const starg_solid_map_options *options,
                                starg_solid_map **out) {
    SCOPED double *images = NULL;
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(solid_map_shape(context, a, shape, &images));
    return make_map(context, a, images, ENDS_IN_SHAPE, options, out);
}
