/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility/scene.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/intersect.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "visibility/adjacency.h"
#include "visibility/sides.h"

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

static starg_status find_least(visibility_scene *scene) {
    starg_status status = STARG_OK;
    const uint32_t *other_side = scene->solid->other_side;
    if (other_side == NULL)
        return STARG_OK;
    STARG_NEW(scene->context, "visibility", scene->least, scene->face_count);
    for (size_t rank = 0; rank < scene->face_count; rank++)
        scene->least[rank] = other_side[scene->face_of[rank]] != SCENE_NONE ? 0 : -1;
done:
    return status;
}

/* Ranks of the other sides of faces that count from either side. */
static starg_status find_backs(visibility_scene *scene) {
    starg_status status = STARG_OK;
    uint32_t *rank_of = NULL;
    if (!solid_is_two_sided(scene->solid))
        return STARG_OK;
    STARG_NEW(scene->context, "visibility", scene->backs, scene->face_count);
    STARG_NEW(scene->context, "visibility", rank_of, scene->face_count);
    for (size_t rank = 0; rank < scene->face_count; rank++)
        rank_of[scene->face_of[rank]] = (uint32_t)rank;
    for (size_t rank = 0; rank < scene->face_count; rank++) {
        uint32_t back = scene->solid->other_side[scene->face_of[rank]];
        scene->backs[rank] = back == SCENE_NONE ? SCENE_NONE : rank_of[back];
    }
done:
    starg_release(scene->context, rank_of);
    return status;
}

uint32_t scene_back(const visibility_scene *scene, size_t rank) {
    return scene->backs == NULL ? SCENE_NONE : scene->backs[rank];
}

/* The error bound: with e the longest extent of an edge and h that of the box, a normal's
 * components are below 2 e^2 and carry 4 roundings, the products another 4; there are six terms
 * with factors up to h (which itself carries a rounding). 128 covers the sum. */
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
    starg_status status = STARG_OK;
    visibility_scene *scene = NULL;
    *out = NULL;
    STARG_NEW_ZERO(context, "visibility", scene, 1);
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
    STARG_NEW(context, "visibility", scene->vertex_of, n);
    STARG_NEW(context, "visibility", scene->slot_of, n);
    STARG_NEW(context, "visibility", scene->x, n);
    STARG_NEW(context, "visibility", scene->y, n);
    STARG_NEW(context, "visibility", scene->z, n);
    STARG_NEW(context, "visibility", scene->corners, 3 * m);
    STARG_NEW(context, "visibility", scene->nx, m);
    STARG_NEW(context, "visibility", scene->ny, m);
    STARG_NEW(context, "visibility", scene->nz, m);
    STARG_NEW(context, "visibility", scene->offset, m);
    order_vertices(scene);
    compute_planes(scene);
    STARG_TRY(find_least(scene));
    STARG_TRY(find_backs(scene));
    *out = scene;
done:
    if (status != STARG_OK)
        scene_free(scene);
    return status;
}

starg_status scene_limit(visibility_scene *scene, double range) {
    starg_status status = STARG_OK;
    size_t count = (scene->face_count + SCENE_CHUNK - 1) / SCENE_CHUNK;
    if (!(range < 1e100) || !(range > 1e-100)) /* squares neither overflow nor vanish */
        return STARG_OK;
    STARG_NEW(scene->context, "visibility", scene->chunks, count);
    scene->range = range;
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
done:
    return status;
}

void scene_free(visibility_scene *scene) {
    if (scene == NULL)
        return;
    starg_context *context = scene->context;
    adjacency_free(scene->adjacency);
    sight_tree_free(scene->sights);
    starg_release(context, scene->vertex_of);
    starg_release(context, scene->slot_of);
    starg_release(context, scene->x);
    starg_release(context, scene->y);
    starg_release(context, scene->z);
    starg_release(context, scene->corners);
    starg_release(context, scene->backs);
    starg_release(context, scene->least);
    starg_release(context, scene->chunks);
    starg_release(context, scene->nx);
    starg_release(context, scene->ny);
    starg_release(context, scene->nz);
    starg_release(context, scene->offset);
    starg_release(context, scene);
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

void scene_sides(const visibility_scene *scene, const double p[3], int8_t *side) {
    if (scene_holds(scene, p))
        scene->find_sides(scene, p, side);
    else
        memset(side, 0, scene->face_count * sizeof *side);
    for (size_t rank = 0; rank < scene->face_count; rank++)
        if (side[rank] == 0)
            side[rank] =
                (int8_t)orient3d(scene_corner(scene, rank, 0), scene_corner(scene, rank, 1),
                                 scene_corner(scene, rank, 2), p);
}

bool scene_blocks(const visibility_scene *scene, size_t rank, int side, const double p[3],
                  uint32_t slot) {
    if (side != 0 && scene_has_corner(scene, rank, slot))
        return false;
    return segment_meets_triangle(p, scene->mesh->vertices + 3 * (size_t)scene->vertex_of[slot],
                                  scene_corner(scene, rank, 0), scene_corner(scene, rank, 1),
                                  scene_corner(scene, rank, 2));
}
