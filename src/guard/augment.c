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
 * Cost: O(log n) for each of at most DIRECTIONS x DEPTHS points per face, none of a face that the
 * range or the clearance rules out; parallel over the faces. */
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
    uint32_t *patches; /* of this batch */
    found_point *found;
} augmentation_job;

static void look_at(const starg_visibility_options *view, const double from[3], const double at[3],
                    double direction[3]) {
    vec3_subtract(at, from, direction);
    double length = vec3_length(direction);
    for (int k = 0; k < 3 && length > 0; k++)
        direction[k] /= length;
    if (sensor_is_directed(view) && length > 0)
        sensor_tilt(view, direction);
}

/* May a guard stand at p, and does it see the patch when it looks at the patch's centroid? */
static bool is_good(const augmentation_job *job, const double p[3], const double centroid[3],
                    size_t patch) {
    starg_visibility_options options = *job->all->visibility;
    double direction[3];
    look_at(job->all->visibility, p, centroid, direction);
    options.directions = direction;
    options.ups = NULL;
    return candidates_allowed(job->all->solid, p, job->all->clearance) &&
           scene_sees_patch(job->scene, p, patch, &options);
}

/* The depths at which a point may be far enough from the patch's centroid, and near enough to it
 * and to its farthest corner. */
static void depth_limits(const augmentation_job *job, size_t patch, const double centroid[3],
                         double limits[2]) {
    const visibility_scene *scene = job->scene;
    const uint32_t *corner = scene_patch_corners(scene, patch);
    double range = job->all->visibility->range * (1 + 1e-9), radius = 0;
    for (size_t k = 0; k < scene_patch_size(scene); k++) {
        const double at[3] = {scene->x[corner[k]], scene->y[corner[k]], scene->z[corner[k]]};
        radius = fmax(radius, vec3_distance(centroid, at));
    }
    limits[0] = (1 - 1e-9) * fmax(job->all->clearance, radius - range);
    limits[1] = range;
}

/* The largest depth within the limits at which a point along the direction sees the patch. */
static double deepest(const augmentation_job *job, size_t patch, const double from[3],
                      const double direction[3], const double limits[2], double p[3]) {
    double depth = 0.5 * job->all->solid->check->diagonal;
    for (int i = 0; i < DEPTHS && depth > limits[0]; i++, depth *= SHRINK) {
        vec3_along(from, depth, direction, p);
        if (depth <= limits[1] && is_good(job, p, from, patch))
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

/* An orthonormal frame of a face: the inward normal and two directions in the plane. */
static bool make_frame(const visibility_scene *scene, size_t rank, double normal[3],
                       double side[2][3]) {
    const double *a = scene_corner(scene, rank, 0), *b = scene_corner(scene, rank, 1);
    const double *c = scene_corner(scene, rank, 2);
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

static starg_status augment_patch(starg_context *context, void *shared, void *scratch,
                                  size_t item) {
    augmentation_job *job = shared;
    found_point *found = &job->found[item];
    size_t patch = job->patches[item];
    size_t rank = job->scene->rank_of[solid_patch_face(job->all->solid, patch)];
    double centroid[3], normal[3], side[2][3], limits[2];
    (void)context;
    (void)scratch;
    found->count = 0;
    if (!make_frame(job->scene, rank, normal, side))
        return STARG_OK;
    scene_patch_centre(job->scene, patch, centroid);
    depth_limits(job, patch, centroid, limits);
    int sides = scene_back(job->scene, rank) == SCENE_NONE ? 1 : 2;
    for (int d = 0; d < sides * DIRECTIONS; d++) {
        double direction[3], p[3];
        lean(normal, (const double(*)[3])side, d % DIRECTIONS, direction);
        for (int k = 0; k < 3 && d >= DIRECTIONS; k++)
            direction[k] = -direction[k]; /* above the back */
        double depth = deepest(job, patch, centroid, direction, limits, p);
        if (depth <= limits[0])
            continue;
        limits[0] = depth;
        int slot = d > 0 && found->count > 0;
        vec3_copy(p, found->p[slot]);
        look_at(job->all->visibility, p, centroid, found->direction[slot]);
        found->count = slot + 1;
    }
    return STARG_OK;
}

/* Picks the batch evenly from all unseen faces that have not been tried. */
static size_t pick_patches(const augmentation *all, const uint8_t *unseen, size_t count,
                           uint32_t *patches) {
    size_t waiting = 0, picked = 0, index = 0;
    for (size_t f = 0; f < count; f++)
        waiting += unseen[f] && !all->tried[f];
    size_t take = waiting < BATCH ? waiting : BATCH;
    for (size_t f = 0; f < count && picked < take; f++) {
        if (!unseen[f] || all->tried[f])
            continue;
        if (index++ * take / waiting == picked) {
            patches[picked++] = (uint32_t)f;
            all->tried[f] = 1;
        }
    }
    return picked;
}

static void free_job(augmentation_job *job) {
    scene_free(job->scene);
    RELEASE(job->patches);
    RELEASE(job->found);
}

/* Prepares for up to `most` faces at a time. */
static starg_status make_job(starg_context *context, const augmentation *all, size_t most,
                             augmentation_job *job) {
    job->all = all;
    TRY(scene_create(context, all->solid, &job->scene));
    TRY(scene_add_sights(job->scene));
    NEW(context, STAGE, job->patches, most);
    NEW(context, STAGE, job->found, most);
    return STARG_OK;
}

static starg_status try_patches(starg_context *context, augmentation_job *job, size_t count) {
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = count, .shared = job, .item = augment_patch};
    return starg_parallel_in_time(context, &loop);
}

starg_status augment_candidates(starg_context *context, const augmentation *all,
                                const uint8_t *unseen, candidate_points *points, bool *pending) {
    SCOPED_BY(free_job) augmentation_job job = {0};
    bool looks = sensor_is_directed(all->visibility);
    TRY(make_job(context, all, BATCH, &job));
    size_t count = pick_patches(all, unseen, solid_patch_count(all->solid), job.patches);
    TRY(try_patches(context, &job, count));
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < job.found[i].count; k++)
            TRY(candidates_push(context, points, job.found[i].p[k],
                                looks ? job.found[i].direction[k] : NULL));
    *pending = count > 0;
    return STARG_OK;
}

starg_status augment_test(starg_context *context, const augmentation *all, const uint8_t *unseen,
                          augmentation_finds *out) {
    SCOPED_BY(free_job) augmentation_job job = {0};
    size_t patches = solid_patch_count(all->solid), count = 0;
    bool looks = sensor_is_directed(all->visibility);
    *out = (augmentation_finds){0};
    TRY(make_job(context, all, patches, &job));
    for (size_t j = 0; j < patches; j++)
        if (unseen[j])
            job.patches[count++] = (uint32_t)j;
    TRY(try_patches(context, &job, count));
    for (size_t i = 0; i < count; i++) {
        int last = job.found[i].count - 1; /* the deepest */
        if (last < 0)
            continue;
        PUSH(context, STAGE, &out->patches, job.patches[i]);
        TRY(candidates_push(context, &out->poses, job.found[i].p[last],
                            looks ? job.found[i].direction[last] : NULL));
    }
    return STARG_OK;
}

void augment_finds_free(augmentation_finds *finds) {
    candidates_free(&finds->poses);
    RELEASE(finds->patches.data);
}
