/* SPDX-License-Identifier: Apache-2.0 */
/* Restores a result: its scene, and what each guard sees there. */
#include "guard/stages.h"

static const char STAGE[] = "guards";

/* The weights from a result; NULL: all faces count alike. */
static starg_status spread_weights(starg_context *context, const starg_guards *guards,
                                   double **out) {
    starg_status status = STARG_OK;
    *out = NULL;
    if (guards->targets == NULL)
        return STARG_OK;
    STARG_NEW_ZERO(context, STAGE, *out, guards->face_count);
    for (size_t i = 0; i < guards->target_count; i++)
        (*out)[guards->targets[i]] = guards->importance[i];
done:
    return status;
}

static bool is_plain(const starg_guards *g) {
    const starg_space_options *o = &g->space;
    bool bounded = o->standoff_least > 0 || o->standoff_most > 0 || o->cell > 0 ||
                   o->over_count > 0 || o->mount_count > 0;
    for (int k = 0; k < 6; k++)
        bounded = bounded || o->within[k] != 0;
    return !bounded && g->obstacle_count == 0 && g->targets == NULL && !o->outside && !o->soup &&
           o->orientation == STARG_ORIENTATION_NESTED;
}

starg_status starg_guards_scene(starg_context *context, const starg_mesh *model,
                                const starg_mesh *const *obstacles, const starg_guards *guards,
                                starg_solid **out) {
    starg_status status = STARG_OK;
    double *weights = NULL;
    starg_solid *scene = NULL;
    *out = NULL;
    if (model->vertex_count != guards->vertex_count || model->face_count != guards->face_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the guards belong to a model with %zu vertices and %zu faces, but this "
                          "one has %zu and %zu",
                          guards->vertex_count, guards->face_count, model->vertex_count,
                          model->face_count);
    if (is_plain(guards))
        return starg_solid_create(context, model, out);
    STARG_TRY(spread_weights(context, guards, &weights));
    STARG_TRY(starg_space_create(context, model, obstacles, guards->obstacle_count, &guards->space,
                                 &scene));
    if (weights != NULL)
        STARG_TRY(starg_space_weigh(scene, weights));
    *out = scene;
    scene = NULL;
done:
    starg_solid_free(scene);
    starg_release(context, weights);
    return status;
}

starg_status starg_guards_see(starg_context *context, const starg_solid *scene,
                              const starg_guards *guards, starg_bits **out) {
    starg_status status = STARG_OK;
    starg_visibility_options view = guards->options.visibility;
    starg_bits *rows = NULL, *model = NULL;
    size_t faces = starg_space_model_faces(scene);
    *out = NULL;
    view.engine = STARG_VISIBILITY_FASTEST;
    view.target = STARG_TARGET_FACES;
    view.directions = guards->directions;
    view.ups = guards->ups;
    STARG_TRY(starg_visibility(context, scene, guards->positions, guards->count, &view, &rows));
    STARG_TRY(starg_bits_create(context, guards->count, faces, &model));
    for (size_t i = 0; i < guards->count; i++) /* obstacles follow and are not targets */
        memcpy(starg_bits_row_mutable(model, i), starg_bits_row(rows, i),
               model->words * sizeof *model->data);
    *out = model;
    model = NULL;
done:
    starg_bits_free(rows);
    starg_bits_free(model);
    return status;
}
