/* SPDX-License-Identifier: Apache-2.0 */
/* Which faces bound the free space cleanly, in a surface that intersects itself elsewhere?
 *
 * A face is *sound* if it meets no other face but in corners and edges that they share, has area,
 * and has no free space right outside of it. Three of the proofs that a box does not see a vertex
 * (box_start.c, box_fold.c, box_flood.c) look at the surface about one point only, so that they
 * need sound faces there and no more.
 *   1. Pairs of faces that meet otherwise are found, and faces without area.
 *   2. Over edges between the others the winding number beside them does not change: nothing else
 *      meets such an edge. So one face decides for all that are connected: a short segment through
 *      it that meets nothing else ends outside of the free space, or not.
 *
 * Every face of an embedded boundary is sound (mesh/solid.h promises it); scenes that are not
 * embedded count as having none. Cost: O(n log n), in surfaces that intersect themselves only. */
#include <math.h>

#include "core/memory.h"
#include "geometry/intersect.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "visibility/box_parts.h"

static const char STAGE[] = "visibility";

/* What is known of a face. */
enum { DOUBTFUL, CLEAR, SOUND };

/* Of the longest edge, how far from a face the ends of the segment through it are. */
static const double STEP = 0x1p-10;

static bool mark_contact(void *user, uint32_t a, uint32_t b) {
    box_scene *scene = user;
    const starg_mesh *mesh = scene->solid->mesh;
    triangle_contact contact =
        faces_contact(mesh->vertices, mesh->faces + 3 * (size_t)a, mesh->faces + 3 * (size_t)b);
    if (contact == TRIANGLES_TOUCH || contact == TRIANGLES_CROSS)
        scene->sound[scene->rank_of[a]] = scene->sound[scene->rank_of[b]] = DOUBTFUL;
    return true;
}

typedef struct crossing {
    const box_scene *scene;
    double inner[3], outer[3]; /* on either side of the face, close to its centre */
    size_t rank;               /* of the face */
} crossing;

/* Goes on unless the segment meets another triangle. */
static bool is_only_one(void *user, size_t rank) {
    const crossing *c = user;
    const box_triangle *t = &c->scene->triangles[rank];
    return rank == c->rank ||
           !segment_meets_triangle(c->inner, c->outer, box_corner(c->scene, t, 0),
                                   box_corner(c->scene, t, 1), box_corner(c->scene, t, 2));
}

/* Finds a segment through the face that meets nothing else. */
static bool find_crossing(const box_scene *scene, size_t rank, crossing *out) {
    const box_triangle *t = &scene->triangles[rank];
    const double *a = box_corner(scene, t, 0), *b = box_corner(scene, t, 1),
                 *c = box_corner(scene, t, 2);
    double longest = fmax(vec3_distance(a, b), fmax(vec3_distance(b, c), vec3_distance(c, a)));
    double step = STEP * longest / vec3_length(t->normal);
    *out = (crossing){.scene = scene, .rank = rank};
    for (int k = 0; k < 3; k++) {
        double centre = a[k] / 3 + b[k] / 3 + c[k] / 3;
        out->inner[k] = centre - step * t->normal[k];
        out->outer[k] = centre + step * t->normal[k];
        if (!(fabs(out->inner[k]) < 1e100 && fabs(out->outer[k]) < 1e100))
            return false;
    }
    return orient3d(a, b, c, out->inner) > 0 && orient3d(a, b, c, out->outer) < 0 &&
           segment_meets_triangle(out->inner, out->outer, a, b, c) &&
           bvh_query_segment(scene->tree, out->inner, out->outer, is_only_one, out);
}

/* Judges the clear faces that are connected with one of them; `list` has room for all faces. */
static void judge_component(box_scene *scene, uint32_t first, uint32_t *list) {
    size_t count = 0;
    crossing found;
    bool sound = false;
    list[count++] = first;
    scene->sound[first] = DOUBTFUL;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t next = scene->triangles[list[i]].twin[k] / 3;
            if (scene->sound[next] != CLEAR)
                continue;
            scene->sound[next] = DOUBTFUL;
            list[count++] = next;
        }
    for (size_t i = 0; i < count; i++)
        if (find_crossing(scene, list[i], &found)) {
            sound = !starg_solid_contains(scene->solid, found.outer);
            break;
        }
    for (size_t i = 0; i < count && sound; i++)
        scene->sound[list[i]] = SOUND;
}

starg_status box_find_sound(box_scene *scene) {
    const starg_solid *solid = scene->solid;
    SCOPED uint32_t *list = NULL;
    bool embedded = solid->check->embedded;
    NEW(scene->context, STAGE, scene->sound, scene->face_count);
    NEW(scene->context, STAGE, scene->sound_about, scene->vertex_count);
    memset(scene->sound, embedded ? SOUND : solid->scene ? DOUBTFUL : CLEAR, scene->face_count);
    memset(scene->sound_about, embedded, scene->vertex_count);
    if (embedded || solid->scene)
        return STARG_OK;
    bvh_query_pairs(scene->tree, mark_contact, scene);
    for (size_t rank = 0; rank < scene->face_count; rank++) {
        const box_triangle *t = &scene->triangles[rank];
        if (collinear(box_corner(scene, t, 0), box_corner(scene, t, 1), box_corner(scene, t, 2)))
            scene->sound[rank] = DOUBTFUL;
    }
    NEW(scene->context, STAGE, list, scene->face_count);
    for (size_t rank = 0; rank < scene->face_count; rank++)
        if (scene->sound[rank] == CLEAR)
            judge_component(scene, (uint32_t)rank, list);
    memset(scene->sound_about, true, scene->vertex_count);
    for (size_t rank = 0; rank < scene->face_count; rank++)
        for (int k = 0; k < 3 && scene->sound[rank] != SOUND; k++)
            scene->sound_about[scene->triangles[rank].corner[k]] = false;
    return STARG_OK;
}
