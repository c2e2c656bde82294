/* SPDX-License-Identifier: Apache-2.0 */
#include "starguard/visibility.h"

#include <math.h>

#include "core/bits.h"
#include "core/fields.h"
#include "core/memory.h"
#include "geometry/vec3.h"
#include "visibility/scene.h"

static const char STAGE[] = "visibility";

typedef visibility_job job;

/* Per-thread data. */
typedef struct worker {
    void *engine_scratch;
    const job *job;
    int8_t *side;              /* by rank */
    uint8_t *visible;          /* by slot */
    uint8_t *within;           /* by slot: visible, and in the view; only where it is directed */
    uint32_t *slots, *patches; /* where views are directed: what the place sees all around */
    size_t slot_count, patch_count;
    sensor sensor;
    const double *last; /* point that side and visible are for, or NULL */
} worker;

static void free_worker(starg_context *context, void *scratch) {
    (void)context;
    worker *w = scratch;
    if (w == NULL)
        return;
    w->job->engine->free_scratch(w->job->scene, w->engine_scratch);
    RELEASE(w->side, w->visible, w->within, w->slots, w->patches, w);
}

static starg_status make_worker(starg_context *context, void *shared, void **scratch) {
    const job *all = shared;
    worker *w = starg_allocate_zero(context, 1, sizeof *w);
    *scratch = NULL;
    if (w == NULL)
        return STARG_ERROR_MEMORY;
    w->job = all;
    w->sensor = scene_sensor(all->scene, all->options);
    w->side = starg_allocate(context, all->scene->face_count, sizeof *w->side);
    w->visible = starg_allocate(context, all->scene->slot_count, sizeof *w->visible);
    w->within = starg_allocate_zero(context, all->scene->slot_count, sizeof *w->within);
    w->slots = starg_allocate(context, all->scene->slot_count, sizeof *w->slots);
    w->patches = starg_allocate(context, solid_patch_count(all->scene->solid), sizeof *w->patches);
    starg_status status = STARG_ERROR_MEMORY;
    if (w->side != NULL && w->visible != NULL && w->within != NULL && w->slots != NULL &&
        w->patches != NULL)
        status = all->engine->make_scratch(all->scene, &w->engine_scratch);
    if (status != STARG_OK) {
        free_worker(context, w);
        return status;
    }
    *scratch = w;
    return STARG_OK;
}

static void drop_out_of_reach(const worker *w, const double p[3]) {
    const visibility_scene *scene = w->job->scene;
    for (size_t slot = 0; w->sensor.reaches && slot < scene->slot_count; slot++) {
        const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
        w->visible[slot] = w->visible[slot] && sensor_reaches(&w->sensor, p, q);
    }
}

static bool all_visible(const visibility_scene *scene, const uint8_t *visible, size_t patch) {
    const uint32_t *corner = scene_patch_corners(scene, patch);
    uint8_t all = 1;
    for (size_t k = 0; k < scene_patch_size(scene); k++)
        all &= visible[corner[k]];
    return all;
}

/* Does the place, which is on the inner side, see the patch, wherever it looks? */
static bool sees_around(const worker *w, const double p[3], size_t rank, size_t patch) {
    const visibility_scene *scene = w->job->scene;
    return all_visible(scene, w->visible, patch) &&
           scene_faces_patch(scene, &w->sensor, p, rank, patch);
}

static void list_patches(worker *w, const double p[3], size_t rank) {
    const visibility_scene *scene = w->job->scene;
    size_t face = scene->face_of[rank], end = solid_first_patch(scene->solid, face + 1);
    for (size_t i = solid_first_patch(scene->solid, face); w->side[rank] > 0 && i < end; i++)
        if (sees_around(w, p, rank, i))
            w->patches[w->patch_count++] = (uint32_t)i;
}

/* Directions of one place look among what it sees all around. */
static void list_visible(worker *w, const double p[3], const scene_view *view) {
    const visibility_scene *scene = w->job->scene;
    for (size_t i = 0; i < w->slot_count; i++)
        w->within[w->slots[i]] = 0;
    w->slot_count = w->patch_count = 0;
    for (uint32_t slot = 0; slot < scene->slot_count; slot++)
        if (w->visible[slot])
            w->slots[w->slot_count++] = slot;
    if (w->job->options->target != STARG_TARGET_FACES)
        return;
    for (size_t first = 0; first < scene->face_count; first += SCENE_CHUNK) {
        size_t end =
            first + SCENE_CHUNK < scene->face_count ? first + SCENE_CHUNK : scene->face_count;
        if (scene_is_beyond(scene, first / SCENE_CHUNK, p, view))
            continue;
        for (size_t rank = first; rank < end; rank++)
            list_patches(w, p, rank);
    }
}

/* Engines sort points that are no vertices by directions of their rounded places; of those right at
 * p that is not good enough. */
static void look_closely(const visibility_scene *scene, const double p[3], const int8_t *side,
                         uint8_t *visible) {
    double near = 0x1p24 * scene->blur;
    for (size_t slot = scene->vertex_count; slot < scene->slot_count; slot++)
        if (fabs(scene->x[slot] - p[0]) < near && fabs(scene->y[slot] - p[1]) < near &&
            fabs(scene->z[slot] - p[2]) < near)
            visible[slot] = scene_sees_slot(scene, p, side, (uint32_t)slot);
}

static void find_visible(const job *all, worker *w, const double p[3], const scene_view *view) {
    /* contours need the sides of all faces */
    scene_sides(all->scene, p, all->scene->adjacency == NULL ? view : NULL, w->side);
    all->engine->find(all->scene, w->engine_scratch, p, w->side, view, w->visible);
    look_closely(all->scene, p, w->side, w->visible);
    drop_out_of_reach(w, p);
    if (sensor_is_directed(all->options))
        list_visible(w, p, view);
}

/* Aims the sensor of an item. What has to be looked at: all around, if the next stands there too.
 */
static scene_view aim(const job *all, worker *w, size_t item) {
    const starg_visibility_options *o = all->options;
    const double *p = all->points + 3 * item;
    if (!sensor_is_directed(o))
        return (scene_view){.count = 0};
    sensor_aim(&w->sensor, o->directions + 3 * item, o->ups != NULL ? o->ups + 3 * item : NULL);
    return item + 1 < all->count && vec3_equal(p, p + 3) ? (scene_view){.count = 0}
                                                         : scene_view_of(&w->sensor);
}

/* Leaves out what is not in the view of the sensor, which is aimed. */
static void narrow(const job *all, worker *w, const double p[3]) {
    const visibility_scene *scene = all->scene;
    for (size_t i = 0; i < w->slot_count; i++) {
        uint32_t slot = w->slots[i];
        const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
        w->within[slot] = sensor_frames(&w->sensor, p, q);
    }
}

static void write_vertices(const job *all, const uint8_t *visible, uint64_t *row) {
    for (size_t slot = 0; slot < all->scene->vertex_count; slot++)
        if (visible[slot])
            starg_bit_set(row, all->scene->vertex_of[slot]);
}

/* The scene keeps the corners of a face in the order of the mesh. */
static void write_corners(const job *all, const worker *w, const uint8_t *visible, uint64_t *row) {
    const visibility_scene *scene = all->scene;
    for (size_t rank = 0; rank < scene->face_count; rank++)
        for (size_t k = 0; k < 3 && w->side[rank] > 0; k++)
            if (visible[scene->corners[3 * rank + k]])
                starg_bit_set(row, 3 * (size_t)scene->face_of[rank] + k);
}

static bool sees_whole(const job *all, const worker *w, const double p[3], size_t rank,
                       size_t patch) {
    const visibility_engine *engine = all->engine;
    if (engine->sees_plainly != NULL && engine->sees_plainly(all->scene, w->engine_scratch, rank))
        return true;
    return patch_is_wholly_visible(all->scene, p, w->side, rank, patch);
}

static void write_patch(const job *all, const worker *w, const double p[3], size_t rank,
                        size_t patch, uint64_t *row) {
    if (all->options->face_rule != STARG_FACES_WHOLE || sees_whole(all, w, p, rank, patch))
        starg_bit_set(row, patch);
}

static void write_patches(const job *all, const worker *w, const double p[3], uint64_t *row) {
    const starg_solid *solid = all->scene->solid;
    for (size_t rank = 0; rank < all->scene->face_count; rank++) {
        if (w->side[rank] <= 0)
            continue;
        size_t face = all->scene->face_of[rank], end = solid_first_patch(solid, face + 1);
        for (size_t i = solid_first_patch(solid, face); i < end; i++)
            if (sees_around(w, p, rank, i))
                write_patch(all, w, p, rank, i, row);
    }
}

static void write_patches_within(const job *all, const worker *w, const double p[3],
                                 uint64_t *row) {
    const visibility_scene *scene = all->scene;
    for (size_t i = 0; i < w->patch_count; i++) {
        size_t patch = w->patches[i];
        if (all_visible(scene, w->within, patch) &&
            scene_resolves_patch(scene, &w->sensor, p, patch))
            write_patch(all, w, p, scene->rank_of[solid_patch_face(scene->solid, patch)], patch,
                        row);
    }
}

static starg_status find_row(starg_context *context, void *shared, void *scratch, size_t item) {
    const job *all = shared;
    worker *w = scratch;
    const double *p = all->points + 3 * item;
    uint64_t *row = starg_bits_row_mutable(all->rows, item);
    (void)context;
    const uint8_t *visible = w->visible;
    if (starg_solid_contains(all->scene->solid, p)) {
        /* directions at the same point are consecutive */
        const scene_view view = aim(all, w, item);
        if (w->last == NULL || !vec3_equal(w->last, p)) {
            find_visible(all, w, p, &view);
            w->last = view.count == 0 ? p : NULL;
        }
        if (sensor_is_directed(all->options)) {
            narrow(all, w, p);
            visible = w->within;
        }
        if (all->options->target == STARG_TARGET_VERTICES)
            write_vertices(all, visible, row);
        else if (all->options->target == STARG_TARGET_CORNERS)
            write_corners(all, w, visible, row);
        else if (sensor_is_directed(all->options))
            write_patches_within(all, w, p, row);
        else
            write_patches(all, w, p, row);
    }
    if (all->finished != NULL)
        all->finished[item] = 1;
    return STARG_OK;
}

static starg_status check_arguments(starg_context *context, const double *points, size_t count,
                                    const starg_visibility_options *options) {
    starg_visibility_options public = *options;
    if (public.target == STARG_TARGET_CORNERS)
    public.target = STARG_TARGET_VERTICES;
    starg_status status = fields_check(context, STAGE, starg_visibility_options_fields(), &public);
    for (size_t i = 0; i < 3 * count && status == STARG_OK; i++) {
        uint64_t point = i / 3;
        if (!(fabs(points[i]) < 1e100))
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_CANDIDATE,
                                 &point, 1, "coordinate %c of point %zu is %g; it must be finite",
                                 "xyz"[i % 3], i / 3, points[i]);
    }
    return status;
}

/* Of the engines for all points, only contours can tell quickly which faces are entirely
 * visible. Points that are no vertices have no contours, and the sweep leaves them out. */
static const visibility_engine *choose_engine(const visibility_scene *scene,
                                              const starg_visibility_options *options) {
    static const visibility_engine *const engines[] = {&visibility_grid, &visibility_tree,
                                                       &visibility_sweep, &visibility_contours,
                                                       &visibility_fastest};
    if (scene->slot_count > scene->vertex_count && options->engine != STARG_VISIBILITY_BVH)
        return &visibility_grid;
    bool whole = options->target == STARG_TARGET_FACES && options->face_rule == STARG_FACES_WHOLE;
    return options->engine == STARG_VISIBILITY_FASTEST && whole ? &visibility_contours
                                                                : engines[options->engine];
}

starg_status visibility_scene_for(starg_context *context, const starg_solid *solid,
                                  const starg_visibility_options *options, size_t count,
                                  visibility_scene **out) {
    starg_status status = scene_create(context, solid, out);
    if (status == STARG_OK)
        status = scene_limit(*out, options->range, sensor_is_directed(options));
    if (status == STARG_OK && options->engine >= STARG_VISIBILITY_CONTOURS &&
        solid->patches == NULL && count > 1) /* does not pay for a single point */
        status = scene_add_adjacency(*out);
    return status;
}

/* Directions of one place are for one thread, which finds once what the place sees all around. */
static starg_status find_rows_of_place(starg_context *context, void *shared, void *scratch,
                                       size_t place) {
    const job *all = shared;
    for (size_t i = all->starts[place]; i < all->starts[place + 1]; i++)
        TRY(find_row(context, shared, scratch, i));
    return STARG_OK;
}

/* The first item of each place, and the number of all at the end. */
static starg_status find_starts(starg_context *context, const job *all, size_t **out,
                                size_t *places) {
    *places = 0;
    NEW(context, STAGE, *out, all->count + 1);
    for (size_t i = 0; i < all->count; i++)
        if (i == 0 || !vec3_equal(all->points + 3 * i, all->points + 3 * (i - 1)))
            (*out)[(*places)++] = i;
    (*out)[*places] = all->count;
    return STARG_OK;
}

starg_status visibility_fill(starg_context *context, const visibility_job *of,
                             const starg_parallel_remote *remote) {
    job all = *of;
    SCOPED size_t *starts = NULL;
    all.engine = choose_engine(of->scene, of->options);
    starg_parallel_loop loop = {.stage = STAGE,
                                .count = of->count,
                                .shared = &all,
                                .item = find_row,
                                .make_scratch = make_worker,
                                .free_scratch = free_worker,
                                .remote = remote};
    if (remote == NULL && sensor_is_directed(of->options)) {
        TRY(find_starts(context, &all, &starts, &loop.count));
        all.starts = starts;
        loop.item = find_rows_of_place;
    }
    return starg_parallel_in_time(context, &loop);
}

/* With other processes, if there are any and enough work. */
static starg_status fill_shared(starg_context *context, const job *all) {
    SCOPED starg_bytes packed = {0};
    const starg_parallel_remote remote = {
        .work = RANKS_VISIBILITY, .job = &packed, .take = visibility_take};
    if (all->scene->solid->patches != NULL || !visibility_is_shared(context, all))
        return visibility_fill(context, all, NULL);
    TRY(visibility_pack(context, all, &packed));
    return visibility_fill(context, all, &remote);
}

starg_status visibility_rows(starg_context *context, const starg_solid *solid, const double *points,
                             size_t count, const starg_visibility_options *options,
                             uint8_t *finished, starg_bits **out) {
    starg_visibility_options defaults;
    SCOPED_BY(scene_drop) visibility_scene *scene = NULL;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    *out = NULL;
    starg_visibility_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    TRY(check_arguments(context, points, count, options));
    TRY(sensor_check(context, STAGE, count, options));
    TRY(visibility_scene_for(context, solid, options, count, &scene));
    TRY(starg_bits_create(context, count, target_columns(solid, options->target), &rows));
    const job all = {.scene = scene,
                     .options = options,
                     .points = points,
                     .count = count,
                     .rows = rows,
                     .finished = finished};
    starg_status status = fill_shared(context, &all);
    if (status != STARG_ERROR_TIME || finished == NULL)
        TRY(status);
    for (size_t i = 0; i < count && options->target != STARG_TARGET_CORNERS; i++)
        solid_finish_row(solid, options->target == STARG_TARGET_VERTICES,
                         starg_bits_row_mutable(rows, i));
    *out = rows;
    rows = NULL;
    return STARG_OK;
}

/* A vertex that parts share is seen if one of its copies is; these have no columns. */
static starg_status join_copies(starg_context *context, const starg_solid *solid,
                                starg_bits **rows) {
    const starg_mesh *own = solid->mesh, *given = solid->shared;
    starg_bits *joined = NULL;
    TRY(starg_bits_create(context, (*rows)->rows, given->vertex_count, &joined));
    for (size_t i = 0; i < joined->rows; i++)
        for (size_t k = 0; k < 3 * own->face_count; k++)
            if (starg_bits_test(*rows, i, own->faces[k]))
                starg_bit_set(starg_bits_row_mutable(joined, i), given->faces[k]);
    starg_bits_free(*rows);
    *rows = joined;
    return STARG_OK;
}

starg_status starg_visibility(starg_context *context, const starg_solid *solid,
                              const double *points, size_t count,
                              const starg_visibility_options *options, starg_bits **out) {
    starg_status status = visibility_rows(context, solid, points, count, options, NULL, out);
    if (status != STARG_OK || solid->shared == NULL || options == NULL ||
        options->target != STARG_TARGET_VERTICES)
        return status;
    status = join_copies(context, solid, out);
    if (status != STARG_OK) {
        starg_bits_free(*out);
        *out = NULL;
    }
    return status;
}
