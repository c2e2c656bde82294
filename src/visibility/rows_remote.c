/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility rows computed by other processes.
 *
 * A job contains the examined solid, all points and the options; so helpers read no file, do not
 * examine again, and handle levels of detail, which are in no file, like any other model. A reply
 * contains the rows of a block, and which of them are finished. The bits of a row depend on nothing
 * else, so it does not matter who computes it.
 *
 * Cost: per helper about 36 bytes a face, and its search structures; a bit per column of each
 * row. */
#include "core/bits.h"
#include "visibility/scene.h"

static const char STAGE[] = "visibility";

/* Faces times points below which a helper's search structures cost more than they save. */
enum { LEAST_WORK = 1 << 22 };

/* The fixed part of a job. */
typedef struct job_head {
    uint64_t points, vertices, faces;
    double range, near, incidence, cone, fov[2], up[3], resolution[2], density, diagonal;
    uint32_t engine, target, face_rule, embedded, ambient, has_ups, unit, unused;
} job_head;

typedef struct remote_job {
    starg_solid *solid;
    visibility_scene *scene;
    starg_visibility_options options;
    double *points, *directions, *ups;
    size_t count;
} remote_job;

/* ---- rank 0 ---- */

bool visibility_is_shared(starg_context *context, const visibility_job *job) {
    return context->ranks != NULL && job->count > 1 &&
           job->scene->face_count >= LEAST_WORK / job->count;
}

starg_status visibility_pack_scene(starg_context *context, const starg_solid *solid,
                                   const starg_visibility_options *o, size_t points,
                                   starg_bytes *out) {
    const starg_mesh *mesh = solid->mesh;
    const job_head head = {.points = points,
                           .vertices = mesh->vertex_count,
                           .faces = mesh->face_count,
                           .range = o->range,
                           .near = o->near,
                           .incidence = o->incidence,
                           .cone = o->cone,
                           .fov = {o->fov[0], o->fov[1]},
                           .up = {o->up[0], o->up[1], o->up[2]},
                           .resolution = {o->resolution[0], o->resolution[1]},
                           .density = o->density,
                           .unit = o->unit,
                           .diagonal = solid->check->diagonal,
                           .engine = o->engine,
                           .target = o->target,
                           .face_rule = o->face_rule,
                           .embedded = solid->check->embedded,
                           .ambient = (uint32_t)solid->ambient,
                           .has_ups = sensor_is_directed(o) && o->ups != NULL};
    TRY(starg_bytes_put(context, out, &head, 1, sizeof head));
    TRY(starg_bytes_put(context, out, mesh->vertices, 3 * mesh->vertex_count, 8));
    return starg_bytes_put(context, out, mesh->faces, 3 * mesh->face_count, 4);
}

starg_status visibility_pack(starg_context *context, const visibility_job *job, starg_bytes *out) {
    const starg_visibility_options *o = job->options;
    TRY(visibility_pack_scene(context, job->scene->solid, o, job->count, out));
    TRY(starg_bytes_put(context, out, job->points, 3 * job->count, 8));
    if (sensor_is_directed(o))
        TRY(starg_bytes_put(context, out, o->directions, 3 * job->count, 8));
    if (sensor_is_directed(o) && o->ups != NULL)
        TRY(starg_bytes_put(context, out, o->ups, 3 * job->count, 8));
    return STARG_OK;
}

starg_status visibility_take(starg_context *context, void *shared, size_t first, size_t count,
                             starg_bytes_reader *reply) {
    const visibility_job *job = shared;
    SCOPED uint8_t *finished = NULL;
    if (count * job->rows->words * sizeof(uint64_t) + count != reply->left)
        return STARG_ERROR_RANK;
    NEW(context, STAGE, finished, count);
    starg_bytes_take(reply, finished, count, 1);
    if (job->finished != NULL)
        memcpy(job->finished + first, finished, count);
    starg_bytes_take(reply, starg_bits_row_mutable(job->rows, first), count * job->rows->words,
                     sizeof(uint64_t));
    return STARG_OK;
}

/* ---- helpers ---- */

static void end(starg_context *context, void *state) {
    (void)context;
    remote_job *job = state;
    if (job == NULL)
        return;
    scene_free(job->scene);
    starg_solid_free(job->solid);
    RELEASE(job->points, job->directions, job->ups, job);
}

static starg_status take_solid(starg_context *context, starg_bytes_reader *bytes,
                               const job_head *head, starg_solid **out) {
    SCOPED void *vertices = NULL, *faces = NULL;
    TRY(starg_bytes_take_block(context, bytes, 3 * head->vertices, 8, &vertices));
    TRY(starg_bytes_take_block(context, bytes, 3 * head->faces, 4, &faces));
    const starg_check check = {.usable = true,
                               .embedded = head->embedded,
                               .diagonal = head->diagonal,
                               .vertices = head->vertices,
                               .faces = head->faces};
    TRY(solid_of_parts(context, vertices, head->vertices, faces, head->faces, &check, out));
    (*out)->ambient = (int)head->ambient;
    return STARG_OK;
}

/* Is this a valid job? Excessive counts are caught later. */
static bool is_sound(const job_head *head, size_t left) {
    return head->points <= left / 24 && head->vertices <= left / 24 && head->faces <= left / 12 &&
           head->engine <= STARG_VISIBILITY_FASTEST && head->target <= STARG_TARGET_CORNERS &&
           head->face_rule <= STARG_FACES_WHOLE && head->ambient <= 1 && head->cone > 0 &&
           head->range >= 0 && head->unit <= STARG_UNIT_INCH;
}

static starg_status unpack(starg_context *context, starg_bytes_reader *bytes, job_head *head,
                           starg_solid **solid, starg_visibility_options *options) {
    if (!starg_bytes_take(bytes, head, 1, sizeof *head) || !is_sound(head, bytes->left))
        return STARG_ERROR_RANK;
    starg_status status = take_solid(context, bytes, head, solid);
    *options = (starg_visibility_options){.engine = (starg_visibility_engine)head->engine,
                                          .target = (starg_target)head->target,
                                          .face_rule = (starg_face_rule)head->face_rule,
                                          .range = head->range,
                                          .near = head->near,
                                          .incidence = head->incidence,
                                          .cone = head->cone,
                                          .fov = {head->fov[0], head->fov[1]},
                                          .up = {head->up[0], head->up[1], head->up[2]},
                                          .tilt = {STARG_TILT_ANY, STARG_TILT_ANY},
                                          .resolution = {head->resolution[0], head->resolution[1]},
                                          .density = head->density,
                                          .unit = (starg_unit)head->unit};
    return status;
}

starg_status visibility_unpack_scene(starg_context *context, starg_bytes_reader *bytes,
                                     starg_solid **solid, starg_visibility_options *options) {
    job_head head;
    return unpack(context, bytes, &head, solid, options);
}

static starg_status begin(starg_context *context, starg_bytes_reader *bytes, void **state) {
    remote_job *job = NULL;
    job_head head;
    void *points, *directions, *ups;
    end(context, *state);
    *state = NULL;
    NEW_ZERO(context, STAGE, job, 1);
    *state = job;
    TRY(unpack(context, bytes, &head, &job->solid, &job->options));
    TRY(starg_bytes_take_block(context, bytes, 3 * head.points, 8, &points));
    job->points = points;
    if (sensor_is_directed(&job->options)) {
        TRY(starg_bytes_take_block(context, bytes, 3 * head.points, 8, &directions));
        job->directions = directions;
    }
    if (head.has_ups) {
        TRY(starg_bytes_take_block(context, bytes, 3 * head.points, 8, &ups));
        job->ups = ups;
    }
    job->count = head.points;
    return visibility_scene_for(context, job->solid, &job->options, job->count, &job->scene);
}

static starg_status run(starg_context *context, void *state, size_t first, size_t count,
                        starg_bytes *reply) {
    const remote_job *all = state;
    starg_visibility_options options = all->options;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    SCOPED uint8_t *finished = NULL;
    size_t columns = target_columns(all->solid, options.target);
    if (count > all->count || first > all->count - count)
        return STARG_ERROR_RANK;
    if (all->directions != NULL)
        options.directions = all->directions + 3 * first;
    if (all->ups != NULL)
        options.ups = all->ups + 3 * first;
    TRY(starg_bits_create(context, count, columns, &rows));
    NEW_ZERO(context, STAGE, finished, count);
    const visibility_job job = {.scene = all->scene,
                                .options = &options,
                                .points = all->points + 3 * first,
                                .count = count,
                                .rows = rows,
                                .finished = finished};
    starg_status filled = visibility_fill(context, &job, NULL);
    if (filled != STARG_ERROR_TIME)
        TRY(filled);
    TRY(starg_bytes_put(context, reply, finished, count, 1));
    TRY(starg_bytes_put(context, reply, rows->data, count * rows->words, sizeof *rows->data));
    return filled;
}

const ranks_work visibility_ranks_work = {begin, run, end};
