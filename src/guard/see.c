/* SPDX-License-Identifier: Apache-2.0 */
/* Restores a result: its scene, and what each guard sees there. */
#include "guard/stages.h"

static const char STAGE[] = "guards";

/* The weights from a result; NULL: all faces count alike. */
static starg_status spread_weights(starg_context *context, const starg_guards *guards,
                                   double **out) {
    *out = NULL;
    if (guards->targets == NULL)
        return STARG_OK;
    NEW_ZERO(context, STAGE, *out, guards->face_count);
    for (size_t i = 0; i < guards->target_count; i++)
        (*out)[guards->targets[i]] = guards->importance[i];
    return STARG_OK;
}

static bool is_plain(const starg_guards *g) {
    const starg_space_options *o = &g->space;
    bool bounded = o->standoff_least > 0 || o->standoff_most > 0 || o->cell > 0 ||
                   o->over_count > 0 || o->mount_count > 0 || o->clear_count > 0;
    for (int k = 0; k < 6; k++)
        bounded = bounded || o->within[k] != 0;
    return !bounded && g->obstacle_count == 0 && g->need_count == 0 && g->targets == NULL &&
           !o->outside && !o->soup && o->orientation == STARG_ORIENTATION_NESTED;
}

starg_status starg_guards_scene(starg_context *context, const starg_mesh *model,
                                const starg_mesh *const *obstacles, const starg_guards *guards,
                                starg_solid **out) {
    SCOPED double *weights = NULL;
    SCOPED_BY(starg_solid_drop) starg_solid *scene = NULL;
    *out = NULL;
    if (model->vertex_count != guards->vertex_count || model->face_count != guards->face_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the guards belong to a model with %zu vertices and %zu faces, but this "
                          "one has %zu and %zu",
                          guards->vertex_count, guards->face_count, model->vertex_count,
                          model->face_count);
    if (is_plain(guards))
        return starg_solid_create(context, model, out);
    TRY(spread_weights(context, guards, &weights));
    TRY(starg_space_create(context, model, obstacles, guards->obstacle_count, &guards->space,
                           &scene));
    if (weights != NULL)
        TRY(starg_space_weigh(scene, weights));
    if (guards->need_count > 0)
        TRY(starg_space_require(scene, guards->needs, guards->need_count));
    *out = scene;
    scene = NULL;
    return STARG_OK;
}

/* What guards see of a scene or of its patches, as their options say. */
static starg_status look_from(starg_context *context, const starg_solid *scene,
                              const starg_guards *guards, starg_bits **out) {
    starg_visibility_options view = guards->options.visibility;
    view.engine = STARG_VISIBILITY_FASTEST;
    view.target = STARG_TARGET_FACES;
    view.directions = guards->directions;
    view.ups = guards->ups;
    return starg_visibility(context, scene, guards->positions, guards->count, &view, out);
}

/* Files without patches have the word for auto; `usual` is what is done then. */
static starg_status cut_patches(starg_context *context, const starg_solid *scene,
                                const starg_guards *guards, double usual, patched_solid *out) {
    starg_visibility_options view = guards->options.visibility;
    view.target = STARG_TARGET_FACES;
    view.patch = view.patch > 0 ? view.patch : usual;
    return patched_solid_make(context, scene, &view, out);
}

starg_status guards_look(starg_context *context, const starg_solid *scene,
                         const starg_guards *guards, patched_solid *patched, starg_bits **rows) {
    bool points = guards->options.visibility.target == STARG_TARGET_POINTS;
    starg_status status =
        cut_patches(context, scene, guards, points ? STARG_PATCH_AUTO : STARG_PATCH_OFF, patched);
    return status == STARG_OK ? look_from(context, &patched->solid, guards, rows) : status;
}

/* Patches of the model; obstacles follow and are not targets. */
static size_t drawn_patches(const patched_solid *patched) {
    return solid_first_patch(&patched->solid, starg_space_model_faces(&patched->solid));
}

starg_status starg_guards_see(starg_context *context, const starg_solid *scene,
                              const starg_guards *guards, starg_bits **out) {
    SCOPED_BY(starg_bits_drop) starg_bits *rows = NULL;
    starg_bits *model = NULL;
    SCOPED_BY(patched_solid_free) patched_solid patched = {0};
    size_t faces = starg_space_model_faces(scene);
    *out = NULL;
    TRY(cut_patches(context, scene, guards, STARG_PATCH_OFF, &patched));
    TRY(look_from(context, &patched.solid, guards, &rows));
    TRY(starg_bits_create(context, guards->count, faces, &model));
    for (size_t i = 0; i < guards->count; i++)
        for (size_t f = 0; f < faces; f++)
            if (solid_holds_face(&patched.solid, starg_bits_row(rows, i), f))
                starg_bit_set(starg_bits_row_mutable(model, i), f);
    *out = model;
    return STARG_OK;
}

starg_status guards_draw(starg_context *context, const patched_solid *patched, starg_mesh **out) {
    const starg_mesh *mesh = patched->solid.mesh;
    const mesh_patches *patches = patched->patches;
    size_t count = drawn_patches(patched), points = patches != NULL ? patches->points.count : 0;
    SCOPED double *vertices = NULL;
    NEW(context, STAGE, vertices, 3 * (mesh->vertex_count + points));
    memcpy(vertices, mesh->vertices, 3 * mesh->vertex_count * sizeof *vertices);
    if (points > 0)
        memcpy(vertices + 3 * mesh->vertex_count, patches->places.data,
               3 * points * sizeof *vertices);
    return starg_mesh_create(context, vertices, mesh->vertex_count + points,
                             patches != NULL ? patches->corner.data : mesh->faces, count, out);
}

starg_status starg_guards_patch_faces(starg_context *context, const starg_solid *scene,
                                      const starg_guards *guards, uint32_t **faces, size_t *count) {
    SCOPED_BY(patched_solid_free) patched_solid patched = {0};
    *faces = NULL;
    *count = 0;
    TRY(cut_patches(context, scene, guards, STARG_PATCH_OFF, &patched));
    *count = drawn_patches(&patched);
    NEW(context, STAGE, *faces, *count);
    for (size_t j = 0; j < *count; j++)
        (*faces)[j] = (uint32_t)solid_patch_face(&patched.solid, j);
    return STARG_OK;
}

static starg_status list_missing(starg_context *context, const patched_solid *patched,
                                 const starg_bits *seen, uint32_t **out, size_t *count) {
    SCOPED uint64_t *joined = NULL;
    *count = 0;
    TRY(pool_join_rows(context, seen, &joined));
    NEW(context, STAGE, *out, seen->columns);
    for (uint32_t j = 0; j < seen->columns; j++)
        if (!starg_bit_test(joined, j) &&
            solid_is_target(&patched->solid, false, solid_patch_face(&patched->solid, j)))
            (*out)[(*count)++] = j;
    return STARG_OK;
}

void starg_patches_free(starg_context *context, uint32_t *missing) {
    (void)context;
    RELEASE(missing);
}

starg_status starg_guards_patches(starg_context *context, const starg_solid *scene,
                                  const starg_guards *guards, starg_mesh **mesh, starg_bits **seen,
                                  uint32_t **missing, size_t *count) {
    starg_status status = STARG_OK;
    patched_solid patched = {0};
    starg_bits *rows = NULL, *model = NULL;
    *mesh = NULL;
    *seen = NULL;
    if (missing != NULL)
        *missing = NULL;
    STARG_TRY(cut_patches(context, scene, guards, STARG_PATCH_OFF, &patched));
    STARG_TRY(look_from(context, &patched.solid, guards, &rows));
    STARG_TRY(starg_bits_create(context, guards->count, drawn_patches(&patched), &model));
    for (size_t i = 0; i < guards->count; i++)
        memcpy(starg_bits_row_mutable(model, i), starg_bits_row(rows, i),
               model->words * sizeof *model->data);
    if (missing != NULL)
        STARG_TRY(list_missing(context, &patched, model, missing, count));
    STARG_TRY(guards_draw(context, &patched, mesh));
    *seen = model;
    model = NULL;
done:
    if (status != STARG_OK && missing != NULL) {
        starg_release(context, *missing);
        *missing = NULL;
    }
    patched_solid_free(&patched);
    starg_bits_free(rows);
    starg_bits_free(model);
    return status;
}
