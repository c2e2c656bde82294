/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of a map between two surfaces: each claim of MAP.json is held against the models.
 * What makes it a bijection is in claim_sphere.c and claim_overlay.c. Cost: O(n log n). */
#include "verify/map.h"

#include <math.h>
#include <stdlib.h>

static const char STAGE[] = "verify";
static const double TOLERANCE = 1e-6, WORST = 1000;

/* ---- counts and points ---- */

static bool agrees(double told, size_t found) {
    return isnan(told) || told == (double)found;
}

/* Returns whether the file is of these models at all. */
static bool claim_counts(const verify_map *own) {
    const starg_map_file *file = own->file;
    size_t vertices = starg_mesh_vertex_count(own->mesh[0]);
    size_t target = starg_mesh_vertex_count(own->mesh[1]);
    size_t faces = starg_mesh_face_count(own->mesh[1]), bad = 0, first = 0;
    bool counts = file->point_count == vertices && agrees(file->vertices, vertices) &&
                  agrees(file->target_vertices, target) && agrees(file->target_faces, faces);
    verify_claim(own->verdict, counts,
                 "the map is of a surface with %zu vertices to one with %zu vertices and %zu faces",
                 vertices, target, faces);
    for (size_t v = file->point_count; v-- > 0;) {
        const double *w = file->points.weights + 3 * v;
        if (file->points.faces[v] < faces && w[0] >= 0 && w[1] >= 0 && w[2] >= 0 &&
            fabs(w[0] + w[1] + w[2] - 1) <= TOLERANCE)
            continue;
        bad++;
        first = v;
    }
    verify_claim_all(own->verdict, bad, first, "each vertex of A goes to a point of a face of B");
    return counts && bad == 0;
}

/* The vertex that a point of B is at, or UINT32_MAX. */
static uint32_t vertex_at(const verify_map *own, size_t v) {
    const double *w = own->file->points.weights + 3 * v;
    const uint32_t *corner = starg_mesh_faces(own->mesh[1]) + 3 * own->file->points.faces[v];
    for (size_t k = 0; k < 3; k++)
        if (w[k] != 0 && w[(k + 1) % 3] == 0 && w[(k + 2) % 3] == 0)
            return corner[k];
    return UINT32_MAX;
}

static void claim_landmarks(const verify_map *own) {
    const starg_map_file *file = own->file;
    size_t missed = 0, first = 0;
    for (size_t i = file->pair_count; i-- > 0;) {
        const uint32_t *pair = file->pairs + 2 * i;
        if (pair[0] < file->point_count && vertex_at(own, pair[0]) == pair[1])
            continue;
        missed++;
        first = i;
    }
    if (file->pair_count > 0 && !agrees(file->landmarks, file->pair_count))
        verify_claim(own->verdict, false, "there are %.0f landmarks (found: %zu pairs)",
                     file->landmarks, file->pair_count);
    if (file->pair_count > 0)
        verify_claim_all(own->verdict, missed, first, "%zu landmarks are met, exactly",
                         file->pair_count);
    else if (file->landmarks > 0)
        verify_leave(own->verdict, "that %.0f landmarks are met: the file does not name them",
                     file->landmarks);
}

/* ---- maps that keep vertices ---- */

static bool has_same_faces(const verify_map *own) {
    size_t count = starg_mesh_face_count(own->mesh[0]);
    return starg_mesh_face_count(own->mesh[1]) == count &&
           memcmp(starg_mesh_faces(own->mesh[0]), starg_mesh_faces(own->mesh[1]),
                  3 * count * sizeof(uint32_t)) == 0;
}

static void claim_same(const verify_map *own) {
    size_t moved = 0, first = 0;
    for (size_t v = own->file->point_count; v-- > 0;)
        if (vertex_at(own, v) != v) {
            moved++;
            first = v;
        }
    verify_claim_all(own->verdict, moved, first, "vertex i goes to vertex i");
    if (has_same_faces(own))
        verify_claim(own->verdict, moved == 0, "both have the same faces: a bijection");
}

/* ---- maps that say nothing of what lies between ---- */

/* A point by the vertices that it lies between, ascending, and their weights. */
typedef struct image {
    uint32_t vertex[3], of;
    double weight[3];
} image;

static int compare_places(const image *a, const image *b) {
    for (int k = 0; k < 3; k++) {
        if (a->vertex[k] != b->vertex[k])
            return a->vertex[k] < b->vertex[k] ? -1 : 1;
        if (a->weight[k] != b->weight[k])
            return a->weight[k] < b->weight[k] ? -1 : 1;
    }
    return 0;
}

static int compare_images(const void *a, const void *b) {
    const image *s = a, *t = b;
    int order = compare_places(s, t);
    return order != 0 ? order : (s->of > t->of) - (s->of < t->of);
}

static image image_of(const verify_map *own, uint32_t v) {
    image out = {.vertex = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, .of = v};
    const double *w = own->file->points.weights + 3 * (size_t)v;
    const uint32_t *corner =
        starg_mesh_faces(own->mesh[1]) + 3 * (size_t)own->file->points.faces[v];
    for (int k = 0, count = 0; k < 3; k++) {
        int at = count;
        if (w[k] == 0)
            continue;
        for (; at > 0 && out.vertex[at - 1] > corner[k]; at--) {
            out.vertex[at] = out.vertex[at - 1];
            out.weight[at] = out.weight[at - 1];
        }
        out.vertex[at] = corner[k];
        out.weight[at] = w[k];
        count++;
    }
    return out;
}

static starg_status claim_distinct(const verify_map *own) {
    size_t count = own->file->point_count, shared = 0, first = 0, second = 0;
    SCOPED image *images = NULL;
    NEW(own->context, STAGE, images, count);
    for (uint32_t v = 0; v < count; v++)
        images[v] = image_of(own, v);
    qsort(images, count, sizeof *images, compare_images);
    for (size_t i = 1; i < count; i++)
        if (compare_places(&images[i - 1], &images[i]) == 0 && shared++ == 0) {
            first = images[i - 1].of;
            second = images[i].of;
        }
    if (shared == 0)
        verify_claim(own->verdict, true, "no two vertices go to the same point");
    else
        verify_claim(own->verdict, false,
                     "no two vertices go to the same point: %zu do, for instance %zu and %zu",
                     shared, first, second);
    verify_leave_asked(own->verdict,
                       "where the map takes what lies between vertices, and so that it is "
                       "a bijection: the file has no directions and no overlay");
    return STARG_OK;
}

/* ---- distortion ---- */

static double squared_length(const double *p, const double *q, int scale) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += pow(ldexp(p[k] - q[k], scale), 2);
    return sum;
}

/* Energy s^2 + r^2 of the linear map between two triangles: cotangents of the first and edges of
 * the second [Pinkall, Polthier 1993]. */
static double energy_of(const double *const t[3], const double *const u[3], double area, int scale,
                        int target_scale) {
    double sum = 0, own[3];
    for (int k = 0; k < 3; k++)
        own[k] = squared_length(t[(k + 1) % 3], t[(k + 2) % 3], scale);
    for (int k = 0; k < 3; k++)
        sum += (own[(k + 1) % 3] + own[(k + 2) % 3] - own[k]) / (8 * area * area) *
               squared_length(u[(k + 1) % 3], u[(k + 2) % 3], target_scale);
    return sum;
}

static double at_most(double x) {
    return x < WORST ? x : WORST;
}

static double area_of(const verify_surface *surface, int scale) {
    double sum = 0;
    for (size_t f = 0; f < surface->face_count; f++)
        sum += verify_area(surface, f, scale);
    return sum;
}

static bool is_near(double told, double found) {
    return isnan(told) || fabs(told - found) <= TOLERANCE * (1 + fabs(found));
}

static void sum_distortion(const verify_map *own, const verify_surface *a, const verify_surface *b,
                           const double *images) {
    int scale = verify_scale(a), target_scale = verify_scale(b);
    double all = area_of(a, scale), ratio = all / area_of(b, target_scale), angles = 0, areas = 0;
    for (size_t f = 0; f < a->face_count; f++) {
        const double *t[3], *u[3];
        verify_corners(a, f, t);
        for (size_t k = 0; k < 3; k++)
            u[k] = images + 3 * (size_t)a->faces[3 * f + k];
        double area = verify_area(a, f, scale);
        double grown_area = verify_triangle_area(u[0], u[1], u[2], target_scale);
        if (!(area > 0))
            continue;
        double grown = ratio * grown_area / area;
        angles +=
            area * at_most(energy_of(t, u, area, scale, target_scale) * area / (2 * grown_area));
        areas += area * at_most((grown + 1 / grown) / 2);
    }
    const starg_map_file *file = own->file;
    verify_claim(own->verdict,
                 is_near(file->angles, angles / all) && is_near(file->areas, areas / all),
                 "distortion is %.9g of angles and %.9g of areas (found: %.9g, %.9g)", file->angles,
                 file->areas, angles / all, areas / all);
}

static starg_status claim_distortion(const verify_map *own) {
    starg_status status = STARG_OK;
    verify_surface *surface[2] = {NULL, NULL};
    double *images = NULL;
    if (isnan(own->file->angles) && isnan(own->file->areas))
        return STARG_OK;
    STARG_NEW(own->context, STAGE, images, 3 * own->file->point_count);
    for (size_t i = 0; i < 3 * own->file->point_count; i++) {
        const uint32_t *corner =
            starg_mesh_faces(own->mesh[1]) + 3 * (size_t)own->file->points.faces[i / 3];
        images[i] = 0;
        for (size_t k = 0; k < 3; k++)
            images[i] += own->file->points.weights[i - i % 3 + k] *
                         starg_mesh_vertices(own->mesh[1])[3 * (size_t)corner[k] + i % 3];
    }
    for (int s = 0; s < 2; s++)
        STARG_TRY(verify_surface_welded(own->context, own->mesh[s], &surface[s]));
    sum_distortion(own, surface[0], surface[1], images);
done:
    for (int s = 0; s < 2; s++)
        verify_surface_free(surface[s]);
    starg_release(own->context, images);
    return status;
}

/* ---- all of it ---- */

/* Directions of other numbers than vertices are not those of these models. */
static bool claim_directions(const verify_map *own) {
    bool good = true;
    for (int s = 0; s < 2; s++)
        good = good && own->file->direction_count[s] == starg_mesh_vertex_count(own->mesh[s]);
    if (!good)
        verify_claim(own->verdict, false, "there is a direction for each vertex of A and of B");
    return good;
}

static starg_status verify_bijection(verify_map *own) {
    const starg_map_file *file = own->file;
    bool directed = file->directions[0] != NULL || file->directions[1] != NULL;
    bool overlaid = file->overlay_points > 0 || file->overlay_faces > 0;
    if (file->same)
        claim_same(own);
    if (directed || overlaid)
        for (int s = 0; s < 2; s++)
            TRY(verify_surface_create(own->context, own->mesh[s], &own->surface[s]));
    if (directed && claim_directions(own))
        TRY(verify_claim_sphere(own));
    if (overlaid)
        TRY(verify_claim_overlay(own));
    if (!directed && !overlaid && !(file->same && has_same_faces(own)))
        TRY(claim_distinct(own));
    return STARG_OK;
}

starg_status starg_verify_map(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                              const starg_map_file *file, starg_verdict **out) {
    starg_status status = STARG_OK;
    verify_map own = {.context = context, .file = file, .mesh = {a, b}};
    *out = NULL;
    starg_time_rule former = starg_time_begin(context, STARG_TIME_FAILS);
    STARG_TRY(verify_verdict_create(context, &own.verdict));
    if (claim_counts(&own)) {
        claim_landmarks(&own);
        STARG_TRY(verify_bijection(&own));
        STARG_TRY(claim_distortion(&own));
    }
    *out = own.verdict;
    own.verdict = NULL;
done:
    starg_time_end(context, former);
    for (int s = 0; s < 2; s++)
        verify_surface_free(own.surface[s]);
    starg_verdict_free(context, own.verdict);
    return status;
}
