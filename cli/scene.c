/* SPDX-License-Identifier: Apache-2.0 */
#include "scene.h"

#include <math.h>
#include <stdlib.h>

#include "commands.h"

const char *const cli_orientation_words[] = {"nested", "keep", NULL};

starg_status cli_scene_prepare(cli_session *session, const cli_scene *scene) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < scene->obstacles.count; i++)
        CLI_TRY(cli_name_input(session, scene->obstacles.values[i]));
    if ((scene->see != NULL) + (scene->ignore != NULL) + (scene->weights != NULL) > 1)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--see, --ignore and --weights exclude each other; weights say it all");
    if (scene->cell > 0 && scene->from.count == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--cell is the size of cubes for --from X,Y,Z; add that point");
    if (scene->outside && scene->standoff.count == 0 && scene->within.count == 0 &&
        session->command == &cli_command_guard)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--outside needs to know how far guards may stand away: add --standoff "
                        "MIN,MAX or --within X0,Y0,Z0,X1,Y1,Z1");
done:
    return status;
}

static bool is_plain(const cli_scene *s) {
    return s->obstacles.count == 0 && s->orientation == STARG_ORIENTATION_NESTED && !s->outside &&
           s->standoff.count == 0 && s->within.count == 0 && s->see == NULL && s->ignore == NULL &&
           s->weights == NULL && !s->soup && !s->two_sided && s->from.count == 0;
}

static double diagonal(const starg_mesh *mesh) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

static void take_options(const cli_scene *s, const starg_mesh *model, starg_space_options *out) {
    starg_space_options_default(out);
    out->orientation = s->orientation;
    out->outside = s->outside;
    out->soup = s->soup;
    out->two_sided = s->two_sided;
    if (s->from.count > 0) {
        const double *last = s->from.values + 3 * (s->from.count - 1);
        out->cell = s->cell > 0 ? s->cell : 0.01 * diagonal(model);
        for (int k = 0; k < 3; k++)
            out->from[k] = last[k];
    }
    if (s->standoff.count > 0) {
        const double *last = s->standoff.values + 2 * (s->standoff.count - 1);
        out->standoff_least = last[0];
        out->standoff_most = last[1];
    }
    const double *box = s->within.count > 0 ? s->within.values + 6 * (s->within.count - 1) : NULL;
    for (int k = 0; box != NULL && k < 3; k++) {
        out->within[k] = fmin(box[k], box[k + 3]);
        out->within[k + 3] = fmax(box[k], box[k + 3]);
    }
}

static starg_status read_obstacles(cli_session *session, const char *const *files, size_t count,
                                   starg_mesh ***out) {
    starg_status status = STARG_OK;
    starg_mesh **list = calloc(count + 1, sizeof *list);
    *out = list;
    if (list == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < count && status == STARG_OK; i++)
        status = starg_mesh_read(session->context, files[i], &list[i]);
    return status;
}

void cli_scene_free_obstacles(starg_mesh **obstacles, size_t count) {
    for (size_t i = 0; obstacles != NULL && i < count; i++)
        starg_mesh_free(obstacles[i]);
    free(obstacles);
}

/* The weights that were asked for; NULL: none. */
static starg_status read_weights(cli_session *session, const cli_scene *s, size_t faces,
                                 double **out) {
    starg_status status = STARG_OK;
    *out = NULL;
    if (s->weights != NULL)
        return starg_weights_read(session->context, s->weights, faces, out);
    if (s->see == NULL && s->ignore == NULL)
        return STARG_OK;
    status = starg_faces_read(session->context, s->see != NULL ? s->see : s->ignore, faces, out);
    for (size_t f = 0; status == STARG_OK && s->ignore != NULL && f < faces; f++)
        (*out)[f] = 1 - (*out)[f];
    return status;
}

starg_status cli_scene_make(cli_session *session, const cli_scene *s) {
    starg_status status = STARG_OK;
    starg_space_options options;
    starg_mesh **obstacles = NULL;
    double *weights = NULL;
    take_options(s, session->mesh, &options);
    if (is_plain(s)) {
        status = starg_solid_create(session->context, session->mesh, &session->solid);
        goto done;
    }
    CLI_TRY(read_obstacles(session, s->obstacles.values, s->obstacles.count, &obstacles));
    CLI_TRY(read_weights(session, s, starg_mesh_face_count(session->mesh), &weights));
    CLI_TRY(starg_space_create(session->context, session->mesh,
                               (const starg_mesh *const *)obstacles, s->obstacles.count, &options,
                               &session->solid));
    if (weights != NULL)
        CLI_TRY(starg_space_weigh(session->solid, weights));
done:
    starg_weights_free(session->context, weights);
    cli_scene_free_obstacles(obstacles, s->obstacles.count);
    starg_mesh_free(session->mesh);
    session->mesh = NULL;
    return status;
}

starg_status cli_scene_read_obstacles(cli_session *session, const starg_guards *guards,
                                      starg_mesh ***out) {
    starg_status status = STARG_OK;
    starg_mesh **list = calloc(guards->obstacle_count + 1, sizeof *list);
    *out = list;
    if (list == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < guards->obstacle_count; i++) {
        const char *file = guards->obstacles[i].file;
        if (file == NULL)
            return cli_fail(session, STARG_ERROR_FORMAT,
                            "the result does not name the file of obstacle %zu", i);
        CLI_TRY(starg_mesh_read(session->context, file, &list[i]));
    }
done:
    return status;
}
