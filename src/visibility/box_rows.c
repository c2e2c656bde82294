/* SPDX-License-Identifier: Apache-2.0 */
/* The public call: a row of bits for each box, in parallel over the boxes. */
#include <math.h>

#include "core/bits.h"
#include "core/fields.h"
#include "core/parallel.h"
#include "visibility/box.h"
#include "visibility/sensor.h"

static const char STAGE[] = "visibility";

typedef struct job {
    const starg_solid *solid;
    const box_scene *scene;
    const starg_visibility_options *options;
    const double *boxes;
    starg_bits *rows;
} job;

static starg_status make_worker(starg_context *context, void *shared, void **scratch) {
    const job *all = shared;
    box_worker *worker = NULL;
    (void)context;
    starg_status status = box_worker_create(all->scene, &worker);
    *scratch = worker;
    return status;
}

static void free_worker(starg_context *context, void *scratch) {
    (void)context;
    box_worker_free(scratch);
}

static starg_status find_row(starg_context *context, void *shared, void *scratch, size_t item) {
    const job *all = shared;
    box_question question = {
        .target = all->options->target, .count = all->rows->columns, .range = all->options->range};
    (void)context;
    for (size_t k = 0; k < 3; k++) {
        question.box.lower[k] = all->boxes[6 * item + k];
        question.box.upper[k] = all->boxes[6 * item + 3 + k];
    }
    uint64_t *row = starg_bits_row_mutable(all->rows, item);
    box_look(scratch, &question, row, NULL);
    solid_finish_row(all->solid, question.target == STARG_TARGET_VERTICES, row);
    return STARG_OK;
}

static starg_status check_arguments(starg_context *context, const double *boxes, size_t count,
                                    const starg_visibility_options *options) {
    if (sensor_is_directed(options))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "boxes look in all directions; leave out the %s",
                          options->cone < 360 ? "cone" : "field of view");
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++) {
            double lower = boxes[6 * i + k], upper = boxes[6 * i + 3 + k];
            uint64_t box = i;
            if (!(fabs(lower) < 1e100 && fabs(upper) < 1e100 && lower <= upper))
                return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_CANDIDATE,
                                     &box, 1,
                                     "box %zu reaches from %g to %g along %c; both must be finite "
                                     "and in this order",
                                     i, lower, upper, "xyz"[k]);
        }
    return fields_check(context, STAGE, starg_visibility_options_fields(), options);
}

starg_status starg_visibility_region(starg_context *context, const starg_solid *solid,
                                     const double *boxes, size_t count,
                                     const starg_visibility_options *options, starg_bits **out) {
    starg_visibility_options defaults;
    SCOPED_BY(box_scene_drop) box_scene *scene = NULL;
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    *out = NULL;
    starg_visibility_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    TRY(check_arguments(context, boxes, count, options));
    TRY(box_scene_create(context, solid, &scene));
    TRY(starg_bits_create(context, count,
                          options->target == STARG_TARGET_VERTICES ? solid->mesh->vertex_count
                                                                   : solid->mesh->face_count,
                          &rows));
    job all = {.solid = solid, .scene = scene, .options = options, .boxes = boxes, .rows = rows};
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = count,
                                      .shared = &all,
                                      .item = find_row,
                                      .make_scratch = make_worker,
                                      .free_scratch = free_worker};
    TRY(starg_parallel_in_time(context, &loop));
    *out = rows;
    rows = NULL;
    return STARG_OK;
}
