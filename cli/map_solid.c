/* SPDX-License-Identifier: Apache-2.0 */
/* map --solid: maps between solids. */
#include "map_solid.h"

#include <stdlib.h>

#include "report.h"
#include "starguard/morph.h"

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

/* The images of A's vertices; the caller frees them. */
static starg_status find_images(cli_session *session, const cli_solid_map *v, double **out) {
    starg_status status = STARG_OK;
    starg_mesh *target = NULL;
    starg_map *map = NULL;
    CLI_TRY(starg_mesh_read(session->context, session->operands[1], &target));
    CLI_TRY(map_surfaces(session, v, target, &map));
    *out = malloc((3 * starg_mesh_vertex_count(session->mesh) + 1) * sizeof **out);
    if (*out == NULL) {
        status = cli_fail_memory(session);
        goto done;
    }
    starg_map_positions(map, target, *out);
done:
    starg_map_free(session->context, map);
    starg_mesh_free(target);
    return status;
}

/* ---- reports ---- */

static void say(cli_session *session, const starg_solid_map *map) {
    cli_say(session, "tetrahedra    %zu, positive in both solids\n", map->count);
    cli_say(session, "vertices      %zu\n", map->vertex_count);
    cli_say(session, "pieces        %zu, star-shaped in both\n", map->piece_count);
    cli_say(session, "distortion    %.4g on average, %.4g at worst, above 10 in %.3g %% of A\n",
            map->mean, map->worst, 100 * map->above_10);
}

static void report(cli_session *session, const starg_solid_map *map, const cli_solid_map *v) {
    json_t *object = session->report;
    cli_put(session, object, "target", cli_json_text(session->operands[1]));
    cli_put(session, object, "output", cli_json_text(v->output));
    cli_put(session, object, "tetrahedra", json_integer((json_int_t)map->count));
    cli_put(session, object, "vertices", json_integer((json_int_t)map->vertex_count));
    cli_put(session, object, "pieces", json_integer((json_int_t)map->piece_count));
    cli_put(session, object, "distortion",
            json_pack("{s:f, s:f, s:f}", "mean", map->mean, "worst", map->worst, "above_10",
                      map->above_10));
}

/* ---- the command ---- */

starg_status cli_solid_map_run(cli_session *session, const cli_solid_map *v) {
    starg_status status = STARG_OK;
    starg_solid_map *map = NULL;
    double *images = NULL;
    CLI_TRY(find_images(session, v, &images));
    CLI_TRY(starg_solid_map_create(session->context, session->mesh, images, v->wanted, &map));
    CLI_TRY(starg_solid_map_write(session->context, map,
                                  cli_outputs_place(&session->outputs, v->output)));
    say(session, map);
    if (session->report != NULL)
        report(session, map, v);
done:
    starg_solid_map_free(session->context, map);
    free(images);
    return status;
}
