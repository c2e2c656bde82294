/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates for faces that no candidate sees yet.
 *
 * The paper adds the invisible vertices themselves as candidates [YL11, section 3.2]. Here a guard
 * must lie inside, and a point deep inside sees more. If the boundary is embedded, every face with
 * area is visible from all points close enough above its centroid: the cone over the face flattens
 * until no other face enters it. So, for each face, the depths of a decreasing geometric series are
 * tried along the inward normal at its centroid and along directions tilted from it, until a point
 * sees the face. The deepest point on the normal and the deepest point over all directions become
 * candidates. In thin crevices the depths approach the rounding error of the coordinates; faces
 * that are invisible even from there stay unseen. With a cone of view, which is aimed at the
 * centroid, faces too large for the cone from every point that sees them also stay unseen.
 *
 * Cost: O(log n) for each of at most DIRECTIONS x DEPTHS points per face; parallel over the
 * faces. */
#include <math.h>

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "visibility/scene.h"

enum { BATCH = 512, DIRECTIONS = 13, DEPTHS = 72 };

static const char STAGE[] = "augmentation";
static const double SHRINK = 0.7; /* 0.7^72 = 7e-12 of the diagonal */

typedef struct found_point {
    double p[2][3], direction[2][3];
    int count;
} found_point;

typedef struct augmentation_job {
    const augmentation *all;
    visibility_scene *scene;
    uint32_t *rank_of; /* face -> rank */
    uint32_t *faces;   /* of this batch */
    found_point *found;
} augmentation_job;

static void look_at(const double from[3], const double at[3], double direction[3]) {
    vec3_subtract(at, from, direction);
    double length = vec3_length(direction);
    for (int k = 0; k < 3 && length > 0; k++)
        direction[k] /= length;
}

/* May a guard stand at p, and does it see the face when it looks at the face's centroid? */
static bool is_good(const augmentation_job *job, const double p[3], const double centroid[3],
                    size_t rank) {
    starg_visibility_options options = *job->all->visibility;
    double direction[3];
    look_at(p, centroid, direction);
    options.directions = direction;
    options.ups = NULL;
    return candidates_allowed(job->all->solid, p, job->all->clearance) &&
           scene_sees_face(job->scene, p, rank, &options);
}

/* The largest depth below `limit` at which a point along the direction sees the face. */
static double deepest(const augmentation_job *job, size_t rank, const double from[3],
                      const double direction[3], double limit, double p[3]) {
    double depth = 0.5 * job->all->solid->check->diagonal;
    for (int i = 0; i < DEPTHS && depth > limit; i++, depth *= SHRINK) {
        vec3_along(from, depth, direction, p);
        if (is_good(job, p, from, rank))
            return depth;
    }
    return 0;
}

/* Direction 0 is the inward normal; the others tilt by 35 and 65 degrees towards six sides. */
static void lean(const double normal[3], const double side[2][3], int index, double out[3]) {
    if (index == 0) {
        vec3_copy(normal, out);
        return;
    }
    int sector = (index - 1) / 2;
    double tilt = index % 2 ? 0.61 : 1.13, turn = sector * 1.0471975511965976;
    vec3_along((const double[3]){0, 0, 0}, cos(tilt), normal, out);
    vec3_along(out, sin(tilt) * cos(turn), side[0], out);
    vec3_along(out, sin(tilt) * sin(turn), side[1], out);
}

/* The centroid, and an orthonormal frame: the inward normal and two directions in the plane. */
static bool make_frame(const visibility_scene *scene, size_t rank, double centroid[3],
                       double normal[3], double side[2][3]) {
    const double *a = scene_corner(scene, rank, 0), *b = scene_corner(scene, rank, 1);
    const double *c = scene_corner(scene, rank, 2);
    for (int k = 0; k < 3; k++)
        centroid[k] = a[k] / 3 + b[k] / 3 + c[k] / 3;
    vec3_triangle_normal(a, c, b, normal);
    vec3_subtract(b, a, side[0]);
    double length = vec3_length(normal), edge = vec3_length(side[0]);
    if (!(length > 0 && edge > 0))
        return false;
    for (int k = 0; k < 3; k++) {
        normal[k] /= length;
        side[0][k] /= edge;
    }
    vec3_cross(normal, side[0], side[1]);
    return true;
}

static starg_status augment_face(starg_context *context, void *shared, void *scratch, size_t item) {
    augmentation_job *job = shared;
    found_point *found = &job->found[item];
    size_t rank = job->rank_of[job->faces[item]];
    double centroid[3], normal[3], side[2][3], best = 0;
    (void)context;
    (void)scratch;
    found->count = 0;
    if (!make_frame(job->scene, rank, centroid, normal, side))
        return STARG_OK;
    int sides = scene_back(job->scene, rank) == SCENE_NONE ? 1 : 2;
    for (int d = 0; d < sides * DIRECTIONS; d++) {
        double direction[3], p[3];
        lean(normal, (const double(*)[3])side, d % DIRECTIONS, direction);
        for (int k = 0; k < 3 && d >= DIRECTIONS; k++)
            direction[k] = -direction[k]; /* above the back */
        double depth = deepest(job, rank, centroid, direction, best, p);
        if (depth <= best)
            continue;
        best = depth;
        int slot = d > 0 && found->count > 0;
        vec3_copy(p, found->p[slot]);
        look_at(p, centroid, found->direction[slot]);
        found->count = slot + 1;
    }
    return STARG_OK;
}

/* Picks the batch evenly from all unseen faces that have not been tried. */
static size_t pick_faces(const augmentation *all, const uint8_t *unseen, size_t face_count,
                         uint32_t *faces) {
    size_t waiting = 0, picked = 0, index = 0;
    for (size_t f = 0; f < face_count; f++)
        waiting += unseen[f] && !all->tried[f];
    size_t take = waiting < BATCH ? waiting : BATCH;
    for (size_t f = 0; f < face_count && picked < take; f++) {
        if (!unseen[f] || all->tried[f])
            continue;
        if (index++ * take / waiting == picked) {
            faces[picked++] = (uint32_t)f;
            all->tried[f] = 1;
        }
    }
    return picked;
}

static void free_job(starg_context *context, augmentation_job *job) {
    scene_free(job->scene);
    starg_release(context, job->rank_of);
    starg_release(context, job->faces);
    starg_release(context, job->found);
}

/* Prepares for up to `most` faces at a time. */
static starg_status make_job(starg_context *context, const augmentation *all, size_t most,
                             augmentation_job *job) {
    starg_status status = STARG_OK;
    size_t face_count = all->solid->mesh->face_count;
    *job = (augmentation_job){.all = all};
    STARG_TRY(scene_create(context, all->solid, &job->scene));
    STARG_TRY(scene_add_sights(job->scene));
    STARG_NEW(context, STAGE, job->rank_of, face_count);
    STARG_NEW(context, STAGE, job->faces, most);
    STARG_NEW(context, STAGE, job->found, most);
    for (size_t rank = 0; rank < face_count; rank++)
        job->rank_of[job->scene->face_of[rank]] = (uint32_t)rank;
done:
    return status;
}

static starg_status try_faces(starg_context *context, augmentation_job *job, size_t count) {
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = count, .shared = job, .item = augment_face};
    return starg_parallel_in_time(context, &loop);
}

starg_status augment_candidates(starg_context *context, const augmentation *all,
                                const uint8_t *unseen, candidate_points *points, bool *pending) {
    starg_status status = STARG_OK;
    augmentation_job job;
    bool looks = sensor_is_directed(all->visibility);
    STARG_TRY(make_job(context, all, BATCH, &job));
    size_t count = pick_faces(all, unseen, all->solid->mesh->face_count, job.faces);
    STARG_TRY(try_faces(context, &job, count));
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < job.found[i].count; k++)
            STARG_TRY(candidates_push(context, points, job.found[i].p[k],
                                      looks ? job.found[i].direction[k] : NULL));
    *pending = count > 0;
done:
    free_job(context, &job);
    return status;
}

starg_status augment_test(starg_context *context, const augmentation *all, const uint8_t *unseen,
                          augmentation_finds *out) {
    starg_status status = STARG_OK;
    augmentation_job job;
    size_t face_count = all->solid->mesh->face_count, count = 0;
    bool looks = sensor_is_directed(all->visibility);
    *out = (augmentation_finds){0};
    STARG_TRY(make_job(context, all, face_count, &job));
    for (size_t f = 0; f < face_count; f++)
        if (unseen[f])
            job.faces[count++] = (uint32_t)f;
    STARG_TRY(try_faces(context, &job, count));
    for (size_t i = 0; i < count; i++) {
        int last = job.found[i].count - 1; /* the deepest */
        if (last < 0)
            continue;
        STARG_PUSH(context, STAGE, &out->faces, job.faces[i]);
        STARG_TRY(candidates_push(context, &out->poses, job.found[i].p[last],
                                  looks ? job.found[i].direction[last] : NULL));
    }
done:
    free_job(context, &job);
    return status;
}

void augment_finds_free(starg_context *context, augmentation_finds *finds) {
    candidates_free(context, &finds->poses);
    STARG_ARRAY_FREE(context, &finds->faces);
}
