/* SPDX-License-Identifier: Apache-2.0 */
/* map --solid: maps between solids. */
#include "map_solid.h"

#include <stdlib.h>
#include <string.h>

#include "extensions.h"
#include "report.h"
#include "starguard/morph.h"

const char *const cli_solid_shapes[] = {"b", "ball", "cube", NULL};

/* ---- options ---- */

static bool is_solid_map(const char *file) {
    const char *dot = file != NULL ? strrchr(file, '.') : NULL;
    return dot != NULL && strcmp(dot, ".vtu") == 0;
}

static starg_status refuse(cli_session *session, const char *what) {
    return cli_fail(session, STARG_ERROR_ARGUMENT, "%s", what);
}

static starg_status check_options(cli_session *session, const cli_solid_map *v) {
    bool carries = v->points != NULL || v->field != NULL, given = is_solid_map(v->map);
    if (v->points != NULL && v->field != NULL)
        return refuse(session, "--points and --apply exclude each other; give one of them");
    if (carries != (v->carried != NULL))
        return refuse(session, carries ? "add --carried FILE, for what is carried over"
                                       : "--carried needs --points or --apply");
    if (v->back && !carries)
        return refuse(session, "--back needs --points or --apply");
    if (v->map != NULL && v->landmarks != NULL)
        return refuse(session, "--map and --landmarks exclude each other; give one of them");
    if (v->overlay && (v->shape > 0 || given))
        return refuse(session, "--overlay divides the surfaces of A and B; leave out --to, and a "
                               "map of solids");
    if (v->shape > 0 && (v->landmarks != NULL || (v->map != NULL && !given)))
        return refuse(session, "--to ball and cube take no map of the surfaces and no landmarks");
    if (session->operand_count != (v->shape > 0 ? 1u : 2u))
        return refuse(session, v->shape > 0 ? "--to ball and cube need A only"
                                            : "two models are needed, A and B");
    if (given && !carries)
        return refuse(session, "--map names a map of solids already; add --points or --apply");
    return STARG_OK;
}

starg_status cli_solid_map_prepare(cli_session *session, const cli_solid_map *v) {
    starg_status status = STARG_OK;
    if (!v->solid) {
        if (v->map != NULL || v->points != NULL || v->field != NULL || v->carried != NULL ||
            v->back || v->shape > 0)
            return refuse(session, "--map, --to, --apply, --points, --carried and --back are for "
                                   "maps of solids; add --solid");
        if (session->operand_count != 2)
            return refuse(session, "two models are needed, A and B");
        if (v->output != NULL && cli_has_extension(v->output, ".vtu"))
            return refuse(session, "a map of surfaces is MAP.json; for MAP.vtu add --solid");
        return cli_announce_needed(session, v->output, "MAP.json");
    }
    CLI_TRY(check_options(session, v));
    if (v->output != NULL && cli_has_extension(v->output, ".json"))
        return refuse(session, "a map of solids is MAP.vtu; for MAP.json leave out --solid");
    if (!is_solid_map(v->map) || v->output != NULL)
        CLI_TRY(cli_announce_needed(session, v->output, "MAP.vtu"));
    CLI_TRY(cli_announce(session, v->carried));
done:
    return status;
}

/* ---- the surfaces ---- */

static starg_status map_surfaces(cli_session *session, const cli_solid_map *v,
                                 const starg_mesh *target, starg_map **out) {
    starg_status status = STARG_OK;
    starg_map_options wanted;
    uint32_t *pairs = NULL;
    starg_map_options_default(&wanted);
    if (v->map != NULL)
        return starg_map_read(session->context, v->map, session->mesh, target, out);
    if (v->landmarks != NULL)
        CLI_TRY(starg_landmarks_read(session->context, v->landmarks, session->mesh, target, &pairs,
                                     &wanted.landmark_count));
    wanted.landmarks = pairs;
    CLI_TRY(starg_map_create(session->context, session->mesh, target, &wanted, out));
done:
    starg_landmarks_free(session->context, pairs);
    return status;
}

/* To B in A's faces. */
static starg_status map_to_images(cli_session *session, const cli_solid_map *v,
                                  const starg_mesh *target, const starg_map *map,
                                  starg_solid_map **out) {
    starg_status status = STARG_OK;
    double *images = malloc((3 * starg_mesh_vertex_count(session->mesh) + 1) * sizeof *images);
    if (images == NULL)
        return cli_fail_memory(session);
    starg_map_positions(map, target, images);
    CLI_TRY(starg_solid_map_create(session->context, session->mesh, images, v->wanted, out));
done:
    free(images);
    return status;
}

static starg_status map_to_target(cli_session *session, const cli_solid_map *v,
                                  starg_solid_map **out) {
    starg_status status = STARG_OK;
    starg_mesh *target = NULL;
    starg_map *map = NULL;
    CLI_TRY(starg_mesh_read(session->context, session->operands[1], &target));
    CLI_TRY(map_surfaces(session, v, target, &map));
    if (v->overlay) {
        CLI_TRY(starg_map_overlay(session->context, session->mesh, target, map));
        CLI_TRY(
            starg_solid_map_overlay(session->context, session->mesh, target, map, v->wanted, out));
    } else {
        CLI_TRY(map_to_images(session, v, target, map, out));
    }
done:
    starg_map_free(session->context, map);
    starg_mesh_free(target);
    return status;
}

/* ---- the map ---- */

/* A map that has been made earlier is taken as it is; 'verify' checks it. */
static starg_status read_map(cli_session *session, const char *file, starg_solid_map **out) {
    starg_result *result = NULL;
    starg_status status = starg_result_read(session->context, file, &result);
    if (status != STARG_OK)
        return status;
    *out = result->solid_map;
    result->solid_map = NULL;
    starg_result_free(session->context, result);
    if (*out == NULL)
        return cli_fail(session, STARG_ERROR_FORMAT, "'%.200s' is not a map between solids", file);
    return STARG_OK;
}

static starg_status make_map(cli_session *session, const cli_solid_map *v, starg_solid_map **out) {
    if (is_solid_map(v->map))
        return read_map(session, v->map, out);
    if (v->shape > 0)
        return starg_solid_map_to(session->context, session->mesh,
                                  (starg_solid_shape)(v->shape - 1), v->wanted, out);
    return map_to_target(session, v, out);
}

/* ---- fields ---- */

static starg_status carry(cli_session *session, const cli_solid_map *v, const starg_solid_map *map,
                          size_t *count) {
    starg_status status = STARG_OK;
    starg_samples *samples = NULL, *carried = NULL;
    const char *file = v->points != NULL ? v->points : v->field;
    CLI_TRY(starg_samples_read(session->context, file, &samples));
    if ((samples->width > 0) != (v->field != NULL)) {
        status = cli_fail(session, STARG_ERROR_FORMAT,
                          v->field != NULL ? "'%.200s' has points without values; that is --points"
                                           : "'%.200s' has values as well; that is --apply",
                          file);
        goto done;
    }
    CLI_TRY(starg_solid_map_carry(session->context, map, samples, v->back, &carried));
    CLI_TRY(starg_samples_write(session->context, carried,
                                cli_outputs_place(&session->outputs, v->carried)));
    *count = carried->count;
done:
    starg_samples_free(session->context, samples);
    starg_samples_free(session->context, carried);
    return status;
}

/* ---- reports ---- */

static void say(cli_session *session, const starg_solid_map *map, const cli_solid_map *v,
                size_t carried) {
    cli_say(session, "tetrahedra    %zu, positive in both solids\n", map->count);
    cli_say(session, "vertices      %zu\n", map->vertex_count);
    cli_say(session, "pieces        %zu, star-shaped in both\n", map->piece_count);
    cli_say(session, "distortion    %.4g on average, %.4g at worst, above 10 in %.3g %% of A\n",
            map->mean, map->worst, 100 * map->above_10);
    if (map->strayed > 0)
        cli_say(session,
                "surface       %zu vertices off B in A's faces, by up to %.2g %% of its diagonal: "
                "A's surface folds there\n",
                map->strayed, 100 * map->farthest);
    if (v->carried != NULL)
        cli_say(session, "carried       %zu points\n", carried);
}

static void report(cli_session *session, const starg_solid_map *map, const cli_solid_map *v,
                   size_t carried) {
    json_t *object = session->report;
    if (v->shape > 0)
        cli_put(session, object, "to", cli_json_text(cli_solid_shapes[v->shape]));
    else
        cli_put(session, object, "target", cli_json_text(session->operands[1]));
    if (v->output != NULL)
        cli_put(session, object, "output", cli_json_text(v->output));
    cli_put(session, object, "tetrahedra", json_integer((json_int_t)map->count));
    cli_put(session, object, "vertices", json_integer((json_int_t)map->vertex_count));
    cli_put(session, object, "pieces", json_integer((json_int_t)map->piece_count));
    cli_put(session, object, "distortion",
            json_pack("{s:f, s:f, s:f}", "mean", map->mean, "worst", map->worst, "above_10",
                      map->above_10));
    cli_put(
        session, object, "surface",
        json_pack("{s:I, s:f}", "strayed", (json_int_t)map->strayed, "farthest", map->farthest));
    if (v->carried != NULL)
        cli_put(session, object, "carried", json_integer((json_int_t)carried));
}

/* ---- the command ---- */

starg_status cli_solid_map_run(cli_session *session, const cli_solid_map *v) {
    starg_status status = STARG_OK;
    starg_solid_map *map = NULL;
    size_t carried = 0;
    CLI_TRY(make_map(session, v, &map));
    if (v->output != NULL)
        CLI_TRY(starg_solid_map_write(session->context, map,
                                      cli_outputs_place(&session->outputs, v->output)));
    if (v->carried != NULL)
        CLI_TRY(carry(session, v, map, &carried));
    say(session, map, v, carried);
    if (session->report != NULL)
        report(session, map, v, carried);
done:
    starg_solid_map_free(session->context, map);
    return status;
}
