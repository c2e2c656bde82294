/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of a map between solids. Nothing is shared with what makes maps.
 *
 * The map is taken apart into two sets of labelled tetrahedra, in A and in B, and both are checked
 * as a decomposition is (verify/pieces.c): tetrahedra are positive and conforming, and their
 * boundary is the model's surface, covered once. In addition that boundary does not cross itself
 * and winds once around its inside. A map that tells how far its end is from B is checked for that.
 * Without B, A's vertices must go to the unit sphere or to the cube's surface, and the polyhedron
 * with A's faces and these corners takes B's place.
 * So the tetrahedra fill either solid without overlap; the map is linear on each and the same on
 * common faces: a piecewise linear homeomorphism. Labels are shared, so that a piece corresponds to
 * itself, and its two guards prove it star-shaped in both.
 *
 * Cost: twice that of a decomposition. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";
static const double VOLUME = 1e-9;      /* relative: what volumes may differ by */
static const double ROUNDING = 0x1p-48; /* of a squared radius */

/* A map seen from one of its ends. */
typedef struct end {
    const char *name;
    const starg_mesh *model; /* or NULL */
    starg_pieces_mesh mesh;
    starg_pieces_report report; /* only guards */
    verify_context own;
} end;

/* ---- parts ---- */

/* Coordinates of keys are checked as those of the ends. */
static starg_status check_keys(starg_context *context, const starg_solid_map *map) {
    starg_status status = STARG_OK;
    starg_pieces_mesh mesh = {
        .vertex_count = map->vertex_count, .count = map->count, .tetrahedra = map->tetrahedra};
    for (size_t key = 0; key < map->key_count && status == STARG_OK; key++) {
        mesh.vertices = map->keys + 3 * key * map->vertex_count;
        status = verify_check_arrays(context, &mesh, NULL);
    }
    return status;
}

static starg_status take_end(starg_context *context, const starg_solid_map *map, end *e, int side) {
    const double *guards = side == 0 ? map->guards : map->guard_images;
    e->name = side == 0 ? "in A" : "in B";
    e->mesh = (starg_pieces_mesh){.vertex_count = map->vertex_count,
                                  .count = map->count,
                                  .vertices = side == 0 ? map->vertices : map->images,
                                  .tetrahedra = map->tetrahedra,
                                  .labels = map->labels};
    e->report.tetrahedra = map->count;
    e->report.piece_count = map->piece_count;
    NEW_ZERO(context, STAGE, e->report.pieces, map->piece_count);
    for (size_t p = 0; p < map->piece_count; p++)
        for (int k = 0; k < 3; k++)
            e->report.pieces[p].guard[k] = guards[3 * p + (size_t)k];
    TRY(verify_check_arrays(context, &e->mesh, &e->report));
    e->own = (verify_context){.context = context, .mesh = &e->mesh, .report = NULL};
    e->report.approximated = side == 1 && map->compared;
    e->report.distance = map->distance;
    e->report.distance_back = map->distance_back;
    return verify_pieces_create(context, &e->mesh, &e->report, &e->own.pieces);
}

static void free_end(end *e) {
    verify_pieces_free(e->own.pieces);
    starg_verdict_free(NULL, e->own.verdict);
    RELEASE(e->report.pieces);
}

/* ---- claims ---- */

static starg_status claim_pieces(const end *e) {
    SCOPED verify_certificate *certificates = NULL;
    size_t count = e->report.piece_count, proven = 0, first = 0;
    NEW(e->own.context, STAGE, certificates, count);
    TRY(verify_certify(e->own.pieces, &e->report, certificates));
    for (size_t p = count; p-- > 0;)
        if (certificates[p].proof == VERIFY_PROVEN)
            proven++;
        else
            first = p;
    if (proven == count)
        verify_claim(e->own.verdict, true, "all %zu pieces are star-shaped about their guards",
                     count);
    else
        verify_claim(e->own.verdict, false,
                     "all %zu pieces are star-shaped about their guards: %zu are not, first piece "
                     "%zu",
                     count, count - proven, first);
    return STARG_OK;
}

/* ---- balls and cubes ---- */

/* A's vertices and those of the map, by place. */
typedef struct placed {
    double at[3];
    uint32_t vertex;
} placed;

static int by_place(const void *left, const void *right) {
    const placed *p = left, *q = right;
    for (int k = 0; k < 3; k++)
        if (p->at[k] != q->at[k])
            return p->at[k] < q->at[k] ? -1 : 1;
    return 0;
}

/* The images of A's vertices; those that have none are counted. */
static starg_status find_images(starg_context *context, const starg_mesh *a,
                                const starg_solid_map *map, double *images, size_t *missing,
                                size_t *first) {
    SCOPED placed *all = NULL;
    NEW(context, STAGE, all, map->vertex_count);
    for (uint32_t v = 0; v < map->vertex_count; v++) {
        memcpy(all[v].at, map->vertices + 3 * (size_t)v, sizeof all[v].at);
        all[v].vertex = v;
    }
    qsort(all, map->vertex_count, sizeof *all, by_place);
    for (size_t v = starg_mesh_vertex_count(a); v-- > 0;) {
        placed key = {.vertex = 0};
        memcpy(key.at, starg_mesh_vertices(a) + 3 * v, sizeof key.at);
        const placed *found = bsearch(&key, all, map->vertex_count, sizeof key, by_place);
        if (found == NULL) {
            ++*missing;
            *first = v;
        } else {
            memcpy(images + 3 * v, map->images + 3 * (size_t)found->vertex, sizeof key.at);
        }
    }
    return STARG_OK;
}

/* Are the images on the sphere of radius 1, up to rounding, or on the cube of edge 2? */
static void claim_inscribed(starg_verdict *verdict, const double *images, size_t count) {
    size_t off[2] = {0, 0}, first[2] = {0, 0};
    for (size_t v = count; v-- > 0;) {
        const double *p = images + 3 * v;
        bool on[2] = {fabs(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - 1) <= ROUNDING,
                      fmax(fmax(fabs(p[0]), fabs(p[1])), fabs(p[2])) == 1};
        for (int shape = 0; shape < 2; shape++)
            if (!on[shape]) {
                off[shape]++;
                first[shape] = v;
            }
    }
    int shape = off[1] < off[0];
    verify_claim_all(verdict, off[shape], first[shape],
                     shape == 0 ? "in B A's vertices are on the sphere of radius 1 about the origin"
                                : "in B A's vertices are on the cube of edge 2 about the origin");
}

/* The polyhedron that takes the place of B; NULL if it cannot be told. */
static starg_status inscribe(starg_context *context, const starg_mesh *a,
                             const starg_solid_map *map, starg_verdict *verdict, starg_mesh **out) {
    SCOPED double *corners = NULL;
    size_t missing = 0, first = 0, count = starg_mesh_vertex_count(a);
    NEW(context, STAGE, corners, 3 * count);
    TRY(find_images(context, a, map, corners, &missing, &first));
    verify_claim_all(verdict, missing, first, "A's vertices are vertices of the map");
    if (missing > 0)
        return STARG_OK;
    claim_inscribed(verdict, corners, count);
    return starg_mesh_create(context, corners, count, starg_mesh_faces(a), starg_mesh_face_count(a),
                             out);
}

/* By how much the solid B is larger than the tetrahedra. */
static void claim_missing(end *e, const starg_solid_map *map) {
    verify_volume filled = {0}, solid = {0};
    int scale = e->own.pieces->scale;
    const double *lower = e->own.model->lower;
    for (size_t t = 0; t < e->mesh.count; t++)
        verify_add_tetrahedron(&filled, &e->mesh, t, scale);
    for (size_t f = 0; f < e->own.model->face_count; f++) {
        const double *t[4] = {lower};
        verify_corners(e->own.model, f, t + 1);
        verify_add_volume(&solid, t, scale);
    }
    double all = verify_volume_value(&solid);
    double found = ldexp(all - verify_volume_value(&filled), -3 * scale);
    double room = ldexp(filled.slack + solid.slack + VOLUME * fabs(all), -3 * scale);
    verify_claim(e->own.verdict, fabs(found - map->missing) <= room,
                 "the model has %.9g more volume than the image (found: %.9g)", map->missing,
                 found);
}

/* Without a model the boundary is compared with nothing. */
static starg_status claim_surface(end *e, const starg_solid_map *map) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    bool near = e->report.approximated && e->model != NULL;
    if (!near)
        TRY(verify_claim_once(&e->own));
    if (e->model == NULL) {
        verify_leave(e->own.verdict, "the surface: A's vertices are not all there");
        return STARG_OK;
    }
    TRY(verify_surface_create(e->own.context, e->model, &surface));
    e->own.model = e->own.solid = surface;
    e->own.report = &e->report;
    TRY(verify_claim_boundary(&e->own));
    if (near)
        claim_missing(e, map);
    e->own.model = e->own.solid = NULL;
    e->own.report = NULL;
    return STARG_OK;
}

/* Moves an end's claims to the verdict on the map. */
static void merge(starg_verdict *verdict, const end *e) {
    const starg_verdict *own = e->own.verdict;
    for (size_t i = 0; i < own->count; i++)
        verify_claim(verdict, own->claims[i].holds, "%s %s", e->name, own->claims[i].text);
    for (size_t i = 0; i < own->not_checked_count; i++)
        verify_leave(verdict, "%s %s", e->name, own->not_checked[i].text);
}

static starg_status claim_end(end *e, const starg_solid_map *map, starg_verdict *verdict) {
    TRY(verify_verdict_create(e->own.context, &e->own.verdict));
    TRY(verify_claim_tetrahedra(&e->own));
    TRY(claim_surface(e, map));
    if (e->own.pieces->labels.good)
        TRY(claim_pieces(e));
    merge(verdict, e);
    return STARG_OK;
}

static void add_tetrahedron(verify_distortion *sum, const starg_solid_map *map, const end ends[2],
                            size_t t) {
    const double *from[4], *to[4];
    for (size_t k = 0; k < 4; k++) {
        from[k] = verify_point(&ends[0].mesh, map->tetrahedra[4 * t + k]);
        to[k] = verify_point(&ends[1].mesh, map->tetrahedra[4 * t + k]);
    }
    verify_add_distortion(sum, from, ends[0].own.pieces->scale, to, ends[1].own.pieces->scale);
}

static void claim_distortion(starg_verdict *verdict, const starg_solid_map *map,
                             const end ends[2]) {
    verify_distortion found = {0};
    for (size_t t = 0; t < map->count; t++)
        add_tetrahedron(&found, map, ends, t);
    double mean = found.sum / found.all, above = found.above / found.all;
    verify_claim(verdict, verify_near_distortion(map->worst, found.worst, found.worst_room),
                 "tetrahedra are stretched by a ratio of %.9g at most (found: %.9g)", map->worst,
                 found.worst);
    verify_claim(verdict, verify_near_distortion(map->mean, mean, found.sum_room / found.all),
                 "their mean ratio is %.9g (found: %.9g)", map->mean, mean);
    verify_claim(
        verdict, verify_near_distortion(map->above_10, above, found.above_room / found.all),
        "a share of %.9g of A's volume has a ratio above 10 (found: %.9g)", map->above_10, above);
}

/* What the file says of single tetrahedra, and where their corners end in its list. */
static void claim_cells(starg_verdict *verdict, const starg_solid_map *map, const end ends[2]) {
    size_t wrong = 0, first = 0;
    verify_claim_all(verdict, map->misplaced, map->first_misplaced,
                     "the offsets of cells are 4, 8, 12 and so on");
    for (size_t t = map->count; map->ratios != NULL && t-- > 0;) {
        verify_distortion found = {0};
        add_tetrahedron(&found, map, ends, t);
        if (verify_near_distortion(map->ratios[t], found.worst, found.worst_room))
            continue;
        wrong++;
        first = t;
    }
    if (map->ratios != NULL)
        verify_claim_all(verdict, wrong, first, "tetrahedra are stretched by the ratios told");
}

/* ---- all of it ---- */

starg_status starg_verify_solid_map(starg_context *context, const starg_mesh *a,
                                    const starg_mesh *b, const starg_solid_map *map,
                                    starg_verdict **out) {
    starg_status status = STARG_OK;
    starg_verdict *verdict = NULL;
    starg_mesh *polyhedron = NULL;
    end ends[2] = {{.model = a}, {.model = b}};
    *out = NULL;
    starg_time_rule former = starg_time_begin(context, STARG_TIME_FAILS);
    for (int side = 0; side < 2; side++)
        STARG_TRY(take_end(context, map, &ends[side], side));
    STARG_TRY(check_keys(context, map));
    STARG_TRY(verify_verdict_create(context, &verdict));
    if (b == NULL)
        STARG_TRY(inscribe(context, a, map, verdict, &polyhedron));
    if (polyhedron != NULL)
        ends[1].model = polyhedron;
    for (int side = 0; side < 2; side++)
        STARG_TRY(claim_end(&ends[side], map, verdict));
    claim_distortion(verdict, map, ends);
    claim_cells(verdict, map, ends);
    STARG_TRY(verify_claim_path(context, map, verdict));
    *out = verdict;
    verdict = NULL;
done:
    starg_time_end(context, former);
    starg_mesh_free(polyhedron);
    for (int side = 0; side < 2; side++)
        free_end(&ends[side]);
    starg_verdict_free(context, verdict);
    return status;
}
