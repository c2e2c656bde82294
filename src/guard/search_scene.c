/* SPDX-License-Identifier: Apache-2.0 */
/* The scene of a search, and what its points see. */
#include "guard/cells.h"

#include <math.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "visibility/scene.h"

static const char STAGE[] = "search";

enum { WHOLE_WORK = 9 }; /* of a face that is seen whole */

static void fill_places(search_scene *scene) {
    const visibility_scene *points = scene->points;
    const starg_mesh *mesh = scene->solid->mesh;
    if (scene->view->target == STARG_TARGET_VERTICES)
        for (size_t v = 0; v < mesh->vertex_count; v++)
            scene->places[v] = points->slot_of[v];
    else if (scene->view->target == STARG_TARGET_CORNERS)
        for (size_t j = 0; j < 3 * mesh->face_count; j++)
            scene->places[j] = points->slot_of[mesh->faces[j]];
    else
        for (size_t j = 0; j < solid_patch_count(scene->solid); j++)
            scene->places[j] = points->rank_of[solid_patch_face(scene->solid, j)];
    for (size_t i = 3 * points->face_count; i-- > 0;)
        scene->ranks[points->corners[i]] = (uint32_t)(i / 3);
}

starg_status search_scene_open(starg_context *context, const starg_solid *solid,
                               const starg_visibility_options *view, double clearance,
                               search_scene *out) {
    *out = (search_scene){.context = context,
                          .solid = solid,
                          .view = view,
                          .clearance = clearance,
                          .number = ++context->search_scenes};
    TRY(scene_create(context, solid, &out->points));
    TRY(scene_add_sights(out->points));
    TRY(box_scene_create(context, solid, &out->boxes));
    NEW(context, STAGE, out->places, target_columns(solid, view->target));
    NEW(context, STAGE, out->ranks, solid->mesh->vertex_count);
    fill_places(out);
    return solid_parts_find(context, solid, &out->parts);
}

/* Sight lines go down a tree; by docs/BENCHMARKS.md, "Units of work". */
double search_scene_unit(const search_scene *scene) {
    double faces = (double)scene->solid->mesh->face_count;
    return fmin(1, fmax(0.25, 0.12 * log2(faces) - 0.45));
}

void search_scene_close(search_scene *scene) {
    if (scene->context == NULL)
        return;
    scene_free(scene->points);
    box_scene_free(scene->boxes);
    RELEASE(scene->places, scene->ranks);
    solid_parts_free(&scene->parts);
    STARG_ARRAY_FREE(scene->context, &scene->witnesses);
    *scene = (search_scene){0};
}

/* Half the diagonal and the distance of the centre from the boundary have rounding errors, below a
 * thousandth of the clearance unless coordinates are huge relative to it. */
bool search_scene_bars(const search_scene *scene, const bvh_box *box) {
    double centre[3], reach = 0.5 * vec3_distance(box->lower, box->upper), largest = 0;
    if (!(scene->clearance > 0) || !(reach < scene->clearance))
        return false;
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * box->lower[k] + 0.5 * box->upper[k];
        largest = fmax(largest, fmax(fabs(box->lower[k]), fabs(box->upper[k])));
    }
    return largest < 1e9 * scene->clearance &&
           starg_solid_distance(scene->solid, centre) + reach < 0.999 * scene->clearance;
}

/* ---- points ---- */

void search_scene_centre(const search_scene *scene, size_t j, double centre[3]) {
    const visibility_scene *points = scene->points;
    uint32_t column = scene->witnesses.data[j], place = scene->places[column];
    if (scene->view->target != STARG_TARGET_FACES) {
        const double at[3] = {points->x[place], points->y[place], points->z[place]};
        vec3_copy(at, centre);
        return;
    }
    scene_patch_centre(points, column, centre);
}

size_t search_scene_rank(const search_scene *scene, size_t j) {
    uint32_t place = scene->places[scene->witnesses.data[j]];
    return scene->view->target == STARG_TARGET_FACES ? place : scene->ranks[place];
}

uint32_t search_scene_part(const search_scene *scene, uint32_t column) {
    uint32_t place = scene->places[column];
    if (place == SCENE_NONE) /* a vertex of no face */
        return 0;
    uint32_t rank = scene->view->target == STARG_TARGET_FACES ? place : scene->ranks[place];
    return scene->parts.of[scene->points->face_of[rank]];
}

/* Is p strictly on the inner side of the face of a corner? */
static bool is_before(const search_scene *scene, uint32_t corner, const double p[3]) {
    const starg_mesh *mesh = scene->solid->mesh;
    const uint32_t *c = mesh->faces + 3 * (size_t)(corner / 3);
    return orient3d(mesh->vertices + 3 * (size_t)c[0], mesh->vertices + 3 * (size_t)c[1],
                    mesh->vertices + 3 * (size_t)c[2], p) > 0;
}

bool search_scene_sees(const search_scene *scene, const search_point *point, size_t j,
                       uint64_t *work) {
    starg_visibility_options view = *scene->view;
    uint32_t column = scene->witnesses.data[j], place = scene->places[column];
    bool whole = view.target == STARG_TARGET_FACES;
    view.directions = point->direction;
    view.ups = point->up;
    bool sees =
        whole ? scene_sees_patch(scene->points, point->place, column, &view)
              : (view.target == STARG_TARGET_VERTICES || is_before(scene, column, point->place)) &&
                    scene_sees_vertex(scene->points, point->place, place, &view);
    *work += !sees || !whole ? 1 : view.face_rule == STARG_FACES_WHOLE ? WHOLE_WORK : 3;
    return sees;
}

bool search_scene_may_see(const search_scene *scene, const double p[3], size_t j) {
    const visibility_scene *points = scene->points;
    uint32_t column = scene->witnesses.data[j], place = scene->places[column];
    if (scene->view->target == STARG_TARGET_CORNERS)
        return is_before(scene, column, p);
    return scene->view->target == STARG_TARGET_VERTICES ||
           scene_back(points, place) != SCENE_NONE || scene_side(points, place, p) > 0;
}

uint64_t search_scene_look(const search_scene *scene, search_point *point,
                           const witness_row *among) {
    uint64_t work = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, among->bits[w])
            if (search_scene_sees(scene, point, 64 * w + bit, &work))
                starg_bit_set(point->seen.bits, 64 * w + bit);
    return work;
}

witness_row search_scene_witnesses(const search_scene *scene, size_t first) {
    witness_row row = {{0}};
    for (size_t j = first; j < scene->witnesses.count; j++)
        starg_bit_set(row.bits, j);
    return row;
}
