/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility/scene.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/intersect.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

/* Numbers the vertices in the order in which the faces use them, leaf by leaf. */
static void order_vertices(visibility_scene *scene) {
    const starg_mesh *mesh = scene->mesh;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        scene->slot_of[v] = SCENE_NONE;
    for (size_t rank = 0; rank < scene->face_count; rank++)
        for (size_t k = 0; k < 3; k++) {
            uint32_t vertex = mesh->faces[3 * (size_t)scene->face_of[rank] + k];
            uint32_t slot = scene->slot_of[vertex];
            if (slot == SCENE_NONE) {
                slot = scene->slot_of[vertex] = (uint32_t)scene->vertex_count++;
                const double *p = mesh->vertices + 3 * (size_t)vertex;
                scene->vertex_of[slot] = vertex;
                scene->x[slot] = p[0];
                scene->y[slot] = p[1];
                scene->z[slot] = p[2];
            }
            scene->corners[3 * rank + k] = slot;
        }
}

static scene_point point_of(const visibility_scene *scene, const patch_point *of) {
    scene_point point = {patch_point_dyadic(of, scene->mesh->vertices), {0}};
    for (int k = 0; k < 3; k++)
        point.support[k] = of->weight[k] > 0 ? scene->slot_of[of->vertex[k]] : SCENE_NONE;
    return point;
}

static void set_point(visibility_scene *scene, const patch_point *of, uint32_t slot) {
    scene_point *point = &scene->points[slot - scene->vertex_count];
    *point = point_of(scene, of);
    scene->x[slot] = point->place.at[0];
    scene->y[slot] = point->place.at[1];
    scene->z[slot] = point->place.at[2];
}

scene_point scene_point_at(const visibility_scene *scene, uint32_t slot) {
    if (slot >= scene->vertex_count)
        return scene->points[slot - scene->vertex_count];
    return (scene_point){dyadic_of(scene->mesh->vertices + 3 * (size_t)scene->vertex_of[slot]),
                         {slot, SCENE_NONE, SCENE_NONE}};
}

scene_point scene_point_of(const visibility_scene *scene, size_t rank, const patch_corner *corner) {
    patch_point point;
    uint32_t vertex;
    const uint32_t *face = scene->mesh->faces + 3 * (size_t)scene->face_of[rank];
    return patch_point_of(face, corner, &point, &vertex)
               ? point_of(scene, &point)
               : scene_point_at(scene, scene->slot_of[vertex]);
}

/* Points of patches follow the vertices, in the order of the faces. */
static starg_status add_points(visibility_scene *scene) {
    const mesh_patches *patches = scene->solid->patches;
    SCOPED uint32_t *slot_of = NULL;
    scene->slot_count = scene->vertex_count;
    if (patches == NULL)
        return STARG_OK;
    NEW(scene->context, "visibility", scene->points, patches->points.count);
    NEW(scene->context, "visibility", scene->patch_corners, patches->corner.count);
    NEW(scene->context, "visibility", slot_of, patches->points.count);
    memset(slot_of, 0xff, patches->points.count * sizeof *slot_of);
    for (size_t rank = 0; rank < scene->face_count; rank++) {
        size_t face = scene->face_of[rank];
        for (size_t i = patches->corners * patches->first[face];
             i < patches->corners * patches->first[face + 1]; i++) {
            uint32_t corner = patches->corner.data[i],
                     point = corner - (uint32_t)patches->vertex_count;
            if (corner < patches->vertex_count) {
                scene->patch_corners[i] = scene->slot_of[corner];
                continue;
            }
            if (slot_of[point] == SCENE_NONE) {
                slot_of[point] = (uint32_t)scene->slot_count++;
                set_point(scene, &patches->points.data[point], slot_of[point]);
            }
            scene->patch_corners[i] = slot_of[point];
        }
    }
    return STARG_OK;
}

static starg_status find_least(visibility_scene *scene) {
    const uint32_t *other_side = scene->solid->other_side;
    if (other_side == NULL && scene->solid->clear == NULL)
        return STARG_OK;
    NEW(scene->context, "visibility", scene->least, scene->face_count);
    for (size_t rank = 0; rank < scene->face_count; rank++) {
        uint32_t face = scene->face_of[rank];
        bool twice = other_side != NULL && other_side[face] != SCENE_NONE;
        scene->least[rank] = solid_is_clear(scene->solid, face) ? SCENE_NEVER : twice ? 0 : -1;
    }
    return STARG_OK;
}

uint32_t scene_back(const visibility_scene *scene, size_t rank) {
    const starg_solid *solid = scene->solid;
    uint32_t back =
        solid_is_two_sided(solid) ? solid->other_side[scene->face_of[rank]] : SCENE_NONE;
    return back == SCENE_NONE ? SCENE_NONE : scene->rank_of[back];
}

/* The error bound: with e the longest extent of an edge and h that of the box, a normal's
 * components are below 2 e^2 and carry 4 roundings, the products another 4; there are six terms
 * with factors up to h (which itself carries a rounding). 128 covers the sum. Points of patches are
 * off by at most `blur` in each coordinate. */
static void compute_planes(visibility_scene *scene) {
    const bvh_box *all = &scene->all;
    double edge = 0;
    for (int k = 0; k < 3; k++) {
        scene->centre[k] = 0.5 * all->lower[k] + 0.5 * all->upper[k];
        scene->extent = fmax(scene->extent, all->upper[k] - all->lower[k]);
    }
    for (size_t rank = 0; rank < scene->face_count; rank++) {
        const double *a = scene_corner(scene, rank, 0), *b = scene_corner(scene, rank, 1);
        const double *c = scene_corner(scene, rank, 2);
        double normal[3], from_centre[3];
        vec3_triangle_normal(a, b, c, normal);
        vec3_subtract(a, scene->centre, from_centre);
        scene->nx[rank] = normal[0];
        scene->ny[rank] = normal[1];
        scene->nz[rank] = normal[2];
        scene->offset[rank] = vec3_dot(normal, from_centre);
        for (int k = 0; k < 3; k++)
            edge = fmax(edge, fmax(fabs(b[k] - a[k]), fabs(c[k] - a[k])));
    }
    scene->side_bound = 128 * 0x1p-53 * edge * edge * scene->extent;
    if (!(scene->side_bound > 1e-250))
        scene->side_bound = INFINITY; /* too small for the analysis: always decide exactly */
    for (size_t i = 0; i < 3 * scene->mesh->vertex_count; i++)
        scene->blur = fmax(scene->blur, fabs(scene->mesh->vertices[i]));
    scene->blur = dyadic_blur(scene->blur);
    scene->point_bound = scene->side_bound + 8 * edge * edge * scene->blur;
}

bool isa_is_supported(visibility_isa isa) {
#if defined(__x86_64__)
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
    return isa == ISA_PLAIN || (avx2 && (isa == ISA_AVX2 || avx512));
#else
    return isa < ISA_WIDEST; /* NEON is part of every aarch64 */
#endif
}

visibility_isa isa_resolve(visibility_isa wanted) {
    if (wanted != ISA_WIDEST)
        return wanted;
    while (--wanted > ISA_PLAIN)
        if (isa_is_supported(wanted))
            return wanted;
    return ISA_PLAIN;
}

static sides_run *choose_sides(void) {
    static sides_run *const variants[] = {
        sides_run_plain,
#if defined(__aarch64__)
        sides_run_neon,
#elif defined(__x86_64__)
        sides_run_avx2,
        sides_run_avx512,
#endif
    };
    return variants[isa_resolve(ISA_WIDEST)];
}

starg_status scene_create(starg_context *context, const starg_solid *solid,
                          visibility_scene **out) {
    SCOPED_BY(scene_drop) visibility_scene *scene = NULL;
    *out = NULL;
    NEW_ZERO(context, "visibility", scene, 1);
    scene->context = context;
    scene->solid = solid;
    scene->mesh = solid->mesh;
    scene->find_sides = choose_sides();
    scene->range = INFINITY;
    scene->cull = solid->check->embedded;
    scene->face_count = solid->mesh->face_count;
    scene->face_of = solid->tree->order;
    solid_extent(solid, &scene->all);
    size_t n = solid->mesh->vertex_count, m = scene->face_count;
    size_t slots = n + (solid->patches != NULL ? solid->patches->points.count : 0);
    NEW(context, "visibility", scene->vertex_of, n);
    NEW(context, "visibility", scene->slot_of, n);
    NEW(context, "visibility", scene->rank_of, m);
    NEW(context, "visibility", scene->x, slots);
    NEW(context, "visibility", scene->y, slots);
    NEW(context, "visibility", scene->z, slots);
    NEW(context, "visibility", scene->corners, 3 * m);
    NEW(context, "visibility", scene->nx, m);
    NEW(context, "visibility", scene->ny, m);
    NEW(context, "visibility", scene->nz, m);
    NEW(context, "visibility", scene->offset, m);
    for (size_t rank = 0; rank < m; rank++)
        scene->rank_of[scene->face_of[rank]] = (uint32_t)rank;
    order_vertices(scene);
    TRY(add_points(scene));
    compute_planes(scene);
    TRY(find_least(scene));
    *out = scene;
    scene = NULL;
    return STARG_OK;
}

starg_status scene_limit(visibility_scene *scene, double range, bool directed) {
    size_t count = (scene->face_count + SCENE_CHUNK - 1) / SCENE_CHUNK;
    if (range < 1e100 && range > 1e-100) /* squares neither overflow nor vanish */
        scene->range = range;
    else if (!directed)
        return STARG_OK;
    NEW(scene->context, "visibility", scene->chunks, count);
    for (size_t c = 0; c < count; c++)
        for (int k = 0; k < 3; k++) {
            scene->chunks[c].lower[k] = INFINITY;
            scene->chunks[c].upper[k] = -INFINITY;
        }
    for (size_t rank = 0; rank < scene->face_count; rank++) {
        bvh_box *box = &scene->chunks[rank / SCENE_CHUNK];
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 3; k++) {
                double x = scene_corner(scene, rank, corner)[k];
                box->lower[k] = fmin(box->lower[k], x);
                box->upper[k] = fmax(box->upper[k], x);
            }
    }
    return STARG_OK;
}

scene_view scene_view_of(const sensor *aimed) {
    static const double Y[3] = {0, 1, 0};
    const double cone = aimed->options->cone, around[2] = {cone, cone};
    scene_view view = {.count = aimed->rectangular || cone < 180 ? 4 : 0};
    if (aimed->rectangular)
        memcpy(view.normals, aimed->planes, sizeof view.normals);
    else if (view.count > 0)
        starg_frustum(aimed->direction, Y, around, view.normals);
    return view;
}

void scene_free(visibility_scene *scene) {
    if (scene == NULL)
        return;
    adjacency_free(scene->adjacency);
    sight_tree_free(scene->sights);
    RELEASE(scene->vertex_of, scene->slot_of, scene->x, scene->y, scene->z, scene->corners,
            scene->points, scene->patch_corners, scene->rank_of, scene->least, scene->chunks,
            scene->nx, scene->ny, scene->nz, scene->offset, scene);
}

starg_status scene_add_adjacency(visibility_scene *scene) {
    return scene->cull ? adjacency_create(scene->context, scene, &scene->adjacency) : STARG_OK;
}

starg_status scene_add_sights(visibility_scene *scene) {
    return sight_tree_create(scene->context, scene->solid->tree, &scene->all, &scene->sights);
}

bool scene_holds(const visibility_scene *scene, const double p[3]) {
    bool in = true;
    for (int k = 0; k < 3; k++)
        in = in && p[k] >= scene->all.lower[k] && p[k] <= scene->all.upper[k];
    return in;
}

int scene_side(const visibility_scene *scene, size_t rank, const double p[3]) {
    int side = scene_holds(scene, p) ? scene_likely_side(scene, rank, p) : 0;
    return side != 0 ? side
                     : orient3d(scene_corner(scene, rank, 0), scene_corner(scene, rank, 1),
                                scene_corner(scene, rank, 2), p);
}

/* With a larger box that has the same centre and holds p, the analysis is the same. */
static double side_bound_at(const visibility_scene *scene, const double p[3]) {
    double extent = scene->extent;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, 2.001 * fabs(p[k] - scene->centre[k]));
    return extent > scene->extent ? scene->side_bound * (extent / scene->extent)
                                  : scene->side_bound;
}

void scene_sides(const visibility_scene *scene, const double p[3], const scene_view *view,
                 int8_t *side) {
    double bound = side_bound_at(scene, p);
    for (size_t first = 0; first < scene->face_count; first += SCENE_CHUNK) {
        size_t left = scene->face_count - first;
        size_t end = first + (left < SCENE_CHUNK ? left : SCENE_CHUNK);
        if (view != NULL && scene_is_beyond(scene, first / SCENE_CHUNK, p, view)) {
            memset(side + first, 0, end - first);
            continue;
        }
        scene->find_sides(scene, p, bound, first, end, side);
        for (size_t rank = first; rank < end; rank++)
            if (side[rank] == 0)
                side[rank] =
                    (int8_t)orient3d(scene_corner(scene, rank, 0), scene_corner(scene, rank, 1),
                                     scene_corner(scene, rank, 2), p);
    }
}

bool scene_blocks_point(const visibility_scene *scene, size_t rank, int side, const double p[3],
                        const scene_point *point) {
    if (scene_is_clear(scene, rank) || (side != 0 && scene_has_point(scene, rank, point)))
        return false;
    return dyadic_segment_meets_triangle(p, &point->place, scene_corner(scene, rank, 0),
                                         scene_corner(scene, rank, 1),
                                         scene_corner(scene, rank, 2));
}

bool scene_blocks(const visibility_scene *scene, size_t rank, int side, const double p[3],
                  uint32_t slot) {
    if (slot >= scene->vertex_count)
        return scene_blocks_point(scene, rank, side, p, &scene->points[slot - scene->vertex_count]);
    if (scene_is_clear(scene, rank) || (side != 0 && scene_has_corner(scene, rank, slot)))
        return false;
    return segment_meets_triangle(p, scene->mesh->vertices + 3 * (size_t)scene->vertex_of[slot],
                                  scene_corner(scene, rank, 0), scene_corner(scene, rank, 1),
                                  scene_corner(scene, rank, 2));
}

void scene_patch_centre(const visibility_scene *scene, size_t patch, double centre[3]) {
    const uint32_t *corner = scene_patch_corners(scene, patch);
    size_t size = scene_patch_size(scene);
    double sum[3] = {0};
    for (size_t k = 0; k < size; k++) {
        sum[0] += scene->x[corner[k]] / (double)size;
        sum[1] += scene->y[corner[k]] / (double)size;
        sum[2] += scene->z[corner[k]] / (double)size;
    }
    vec3_copy(sum, centre);
}

sensor scene_sensor(const visibility_scene *scene, const starg_visibility_options *options) {
    sensor own = sensor_of(options);
    if (scene->solid->density != NULL && options->target == STARG_TARGET_FACES)
        own.depth = INFINITY;
    return own;
}

bool scene_resolves_patch(const visibility_scene *scene, const sensor *looks, const double p[3],
                          size_t patch) {
    const double *density = scene->solid->density;
    size_t face = solid_patch_face(scene->solid, patch);
    if (density == NULL || !looks->rectangular)
        return true;
    const uint32_t *corner = scene_patch_corners(scene, patch);
    double depth = starg_density_depth(looks->options, density[face]);
    for (size_t k = 0; k < scene_patch_size(scene); k++) {
        const double q[3] = {scene->x[corner[k]], scene->y[corner[k]], scene->z[corner[k]]};
        if (!sensor_is_near(looks, p, depth, q))
            return false;
    }
    return true;
}

bool scene_faces_patch(const visibility_scene *scene, const sensor *looks, const double p[3],
                       size_t rank, size_t patch) {
    const uint32_t *corner = scene_patch_corners(scene, patch);
    const double *const face[3] = {scene_corner(scene, rank, 0), scene_corner(scene, rank, 1),
                                   scene_corner(scene, rank, 2)};
    for (size_t k = 0; looks->steepest > 0 && k < scene_patch_size(scene); k++) {
        const double q[3] = {scene->x[corner[k]], scene->y[corner[k]], scene->z[corner[k]]};
        if (!sensor_faces(looks, p, face, q))
            return false;
    }
    return true;
}
