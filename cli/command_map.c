/* SPDX-License-Identifier: Apache-2.0 */
/* starguard map: maps each vertex of one surface to another surface. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "starguard/picture.h"
#include "starguard/solidmap.h"

CLI_DROP(starg_landmarks, uint32_t)
CLI_DROP(starg_map, starg_map)
CLI_DROP(starg_samples, starg_samples)
CLI_DROP(starg_solid_map, starg_solid_map)

/* The options that concern solids. */
typedef struct cli_solid_map {
    bool solid, overlay;
    const char *output, *map, *landmarks, *points, *field, *carried;
    bool back;
    int connectivity; /* 0: of both, B itself; 1: of A */
    int shape;        /* 0: B, else a starg_solid_shape plus 1 */
    const starg_solid_map_options *wanted;
} cli_solid_map;

/* Words of --to. */
extern const char *const cli_solid_shapes[];

/* map --solid: maps between solids. */

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
    if (v->connectivity > 0 && (v->overlay || v->shape > 0 || given))
        return refuse(session, "--connectivity is for a new map from A to B; leave out --overlay, "
                               "--to and a map of solids");
    if (v->shape > 0 && (v->landmarks != NULL || (v->map != NULL && !given)))
        return refuse(session, "--to ball and cube take no map of the surfaces and no landmarks");
    if (session->operand_count != (v->shape > 0 ? 1u : 2u))
        return refuse(session, v->shape > 0 ? "--to ball and cube need A only"
                                            : "two models are needed, A and B");
    if (given && !carries)
        return refuse(session, "--map names a map of solids already; add --points or --apply");
    return STARG_OK;
}

/* Checks options, and announces outputs. */
static starg_status cli_solid_map_prepare(cli_session *session, const cli_solid_map *v) {
    if (!v->solid) {
        if (v->map != NULL || v->points != NULL || v->field != NULL || v->carried != NULL ||
            v->back || v->shape > 0 || v->connectivity > 0)
            return refuse(session, "--map, --to, --connectivity, --apply, --points, --carried and "
                                   "--back are for maps of solids; add --solid");
        if (session->operand_count != 2)
            return refuse(session, "two models are needed, A and B");
        if (v->output != NULL && cli_has_extension(v->output, ".vtu"))
            return refuse(session, "a map of surfaces is MAP.json; for MAP.vtu add --solid");
        return cli_announce_needed(session, v->output, "MAP.json");
    }
    TRY(check_options(session, v));
    if (v->output != NULL && cli_has_extension(v->output, ".json"))
        return refuse(session, "a map of solids is MAP.vtu; for MAP.json leave out --solid");
    if (!is_solid_map(v->map) || v->output != NULL)
        TRY(cli_announce_needed(session, v->output, "MAP.vtu"));
    return cli_announce(session, v->carried);
}

/* ---- the surfaces ---- */

static starg_status map_solids(cli_session *session, const cli_solid_map *v,
                               const starg_mesh *target, starg_map **out) {
    starg_map_options wanted;
    SCOPED_BY(starg_landmarks_drop) uint32_t *pairs = NULL;
    starg_map_options_default(&wanted);
    wanted.solid = v->connectivity == 0;
    if (v->map != NULL)
        return starg_map_read(session->context, v->map, session->mesh, target, out);
    if (v->landmarks != NULL)
        TRY(starg_landmarks_read(session->context, v->landmarks, session->mesh, target, &pairs,
                                 &wanted.landmark_count));
    wanted.landmarks = pairs;
    return starg_map_create(session->context, session->mesh, target, &wanted, out);
}

/* B, where a map ends only near it. */
typedef struct ending {
    double diagonal, volume;
} ending;

/* To B in A's faces. */
static starg_status map_to_images(cli_session *session, const cli_solid_map *v,
                                  const starg_mesh *target, const starg_map *map, ending *end,
                                  starg_solid_map **out) {
    SCOPED double *images =
        malloc((3 * starg_mesh_vertex_count(session->mesh) + 1) * sizeof *images);
    double lower[3], upper[3];
    if (images == NULL)
        return cli_fail_memory(session);
    starg_map_positions(map, target, images);
    TRY(starg_solid_map_create(session->context, session->mesh, images, v->wanted, out));
    TRY(starg_solid_map_compare(session->context, target, *out));
    starg_mesh_bounds(target, lower, upper);
    end->diagonal = hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
    end->volume = fabs(starg_mesh_volume(target));
    return STARG_OK;
}

static starg_status map_to_target(cli_session *session, const cli_solid_map *v, ending *end,
                                  starg_solid_map **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *target = NULL;
    SCOPED_BY(starg_map_drop) starg_map *map = NULL;
    TRY(starg_mesh_read(session->context, session->operands[1], &target));
    TRY(map_solids(session, v, target, &map));
    if (v->connectivity == 0) {
        if (map->overlay.face_count == 0)
            TRY(starg_map_overlay(session->context, session->mesh, target, map));
        TRY(starg_solid_map_overlay(session->context, session->mesh, target, map, v->wanted, out));
    } else {
        TRY(map_to_images(session, v, target, map, end, out));
    }
    return STARG_OK;
}

/* ---- the map ---- */

/* A map that has been made earlier is taken as it is; 'verify' checks it. */
static starg_status read_map(cli_session *session, const char *file, starg_solid_map **out) {
    starg_result *result = NULL;
    TRY(starg_result_read(session->context, file, &result));
    *out = result->solid_map;
    result->solid_map = NULL;
    starg_result_free(session->context, result);
    if (*out == NULL)
        return cli_fail(session, STARG_ERROR_FORMAT, "'%.200s' is not a map between solids", file);
    return STARG_OK;
}

static starg_status make_map(cli_session *session, const cli_solid_map *v, ending *end,
                             starg_solid_map **out) {
    if (is_solid_map(v->map))
        return read_map(session, v->map, out);
    if (v->shape > 0)
        return starg_solid_map_to(session->context, session->mesh,
                                  (starg_solid_shape)(v->shape - 1), v->wanted, out);
    return map_to_target(session, v, end, out);
}

/* ---- fields ---- */

static starg_status carry(cli_session *session, const cli_solid_map *v, const starg_solid_map *map,
                          size_t *count) {
    SCOPED_BY(starg_samples_drop) starg_samples *samples = NULL;
    SCOPED_BY(starg_samples_drop) starg_samples *carried = NULL;
    const char *file = v->points != NULL ? v->points : v->field;
    TRY(starg_samples_read(session->context, file, &samples));
    if ((samples->width > 0) != (v->field != NULL))
        return cli_fail(session, STARG_ERROR_FORMAT,
                        v->field != NULL ? "'%.200s' has points without values; that is --points"
                                         : "'%.200s' has values as well; that is --apply",
                        file);
    TRY(starg_solid_map_carry(session->context, map, samples, v->back, &carried));
    TRY(starg_samples_write(session->context, carried,
                            cli_outputs_place(&session->outputs, v->carried)));
    *count = carried->count;
    return STARG_OK;
}

/* ---- reports ---- */

static void say(cli_session *session, const starg_solid_map *map, const cli_solid_map *v,
                const ending *end, size_t carried) {
    if (map->compared && end->diagonal > 0)
        cli_say(session,
                "ends at       B in A's faces, up to %.3g from B (%.3g %% of its diagonal), of "
                "volume %.4g where B has %.4g\n",
                fmax(map->distance, map->distance_back),
                100 * fmax(map->distance, map->distance_back) / end->diagonal,
                end->volume - map->missing, end->volume);
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
    if (map->compared)
        cli_put(session, object, "missed",
                json_pack("{s:f, s:f, s:f}", "distance", map->distance, "distance_back",
                          map->distance_back, "volume", map->missing));
    if (v->carried != NULL)
        cli_put(session, object, "carried", json_integer((json_int_t)carried));
}

/* ---- the command ---- */

/* The first operand has been read into the session. */
static starg_status cli_solid_map_run(cli_session *session, const cli_solid_map *v) {
    SCOPED_BY(starg_solid_map_drop) starg_solid_map *map = NULL;
    ending end = {0};
    size_t carried = 0;
    TRY(make_map(session, v, &end, &map));
    if (v->output != NULL)
        TRY(starg_solid_map_write(session->context, map,
                                  cli_outputs_place(&session->outputs, v->output)));
    if (v->carried != NULL)
        TRY(carry(session, v, map, &carried));
    say(session, map, v, &end, carried);
    if (session->report != NULL)
        report(session, map, v, carried);
    return STARG_OK;
}

typedef struct values {
    const char *output, *landmarks, *picture, *map, *points, *field, *carried;
    int up;
    bool overlay, solid, back;
    int shape, connectivity;
    starg_solid_map_options wanted;
} values;

enum { TILE_WIDTH = 900, TILE_HEIGHT = 700 };
static const double SQUARES = 16; /* of the checker along A's longest side */

/* In the order of starg_picture_options.up. */
static const char *const axes[] = {"x", "y", "z", NULL};

/* Words of --connectivity. */
static const char *const connectivities[] = {"both", "a", NULL};

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("MAP.json|.vtu",
                      "Map (docs/formats.md): MAP.json, or MAP.vtu with --solid; "
                      "'-' writes to standard output.",
                      .group = "output", .brief = "the map"),
    CLI_INPUT_OPTION(
        "landmarks", landmarks, "FILE",
        "Corresponding vertices, one pair per line: two vertex indices (from 0), first of A, then "
        "of B; or six coordinates, which select the nearest vertices.",
        .group = "input", .brief = "pairs of places that belong together"),
    CLI_FLAG_OPTION(
        "overlay", overlay,
        "Also write the common refinement of both triangulations: points with their "
        "places on A and on B, and triangles, each in one face of both. With --solid both "
        "surfaces are divided by it anyway.",
        .group = "output"),
    CLI_TEXT_OPTION("picture", picture, "FILE.png",
                    "Picture of both surfaces: A with a checker, and B with what the map makes of "
                    "it.",
                    .group = "output", .brief = "a picture of the map"),
    CLI_CHOICE_OPTION("up", up, axes, 1, "x|y|z", "Axis that points up in --picture.",
                      .group = "output"),
    CLI_FLAG_OPTION("solid", solid,
                    "Map the solids that the surfaces bound: one set of tetrahedra, positive in "
                    "both. Needs TetGen.",
                    .group = "input", .brief = "between solids, not surfaces"),
    CLI_INPUT_OPTION("map", map, "FILE",
                     "With --solid: map of the surfaces from 'starguard map'; by default it is "
                     "computed. Or a MAP.vtu, to carry points and fields by.",
                     .group = "input", .brief = "a map of the surfaces, for --solid"),
    CLI_CHOICE_OPTION("to", shape, cli_solid_shapes, 0, "b|ball|cube",
                      "With --solid: map A, of genus 0, to a polyhedron inscribed in a ball or a "
                      "cube; B is then left out.",
                      .group = "input"),
    CLI_CHOICE_OPTION("connectivity", connectivity, connectivities, 0, "both|a",
                      "With --solid: both surfaces are divided by their overlay, so that the map "
                      "ends at B itself; or the map ends at B in A's vertices and faces, and says "
                      "how far that is from B.",
                      .group = "output"),
    CLI_INPUT_OPTION("points", points, "FILE",
                     "With --solid: points of A, x y z per line, to be carried to B.",
                     .group = "input", .brief = "points that the map carries"),
    CLI_INPUT_OPTION(
        "apply", field, "FIELD",
        "With --solid: the same with values of a field: x y z and a number or a label, "
        "or x y z and a vector, which is transformed by the map's Jacobian.",
        .group = "input"),
    CLI_TEXT_OPTION("carried", carried, "FILE",
                    "Output of --points and --apply, in the same order.", .group = "output",
                    .brief = "where it carries them"),
    CLI_FLAG_OPTION("back", back, "Carry from B to A instead.", .group = "input"),
};

static cli_solid_map solid_options(const values *v) {
    return (cli_solid_map){.solid = v->solid,
                           .overlay = v->overlay,
                           .connectivity = v->connectivity,
                           .output = v->output,
                           .map = v->map,
                           .landmarks = v->landmarks,
                           .points = v->points,
                           .field = v->field,
                           .carried = v->carried,
                           .back = v->back,
                           .shape = v->shape,
                           .wanted = &v->wanted};
}

static starg_status prepare(cli_session *session, void *data) {
    const values *v = data;
    const cli_solid_map solid = solid_options(v);
    if (v->solid && v->picture != NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--picture is for maps of surfaces; leave out --solid");
    TRY(cli_solid_map_prepare(session, &solid));
    return cli_announce_with_extension(session, "--picture", v->picture, ".png");
}

/* ---- picture ---- */

/* Both ends with the faces of the overlay, and a colour for each face. */
typedef struct sheet {
    double *positions[2];
    starg_mesh *meshes[2];
    uint8_t *colors;
} sheet;

static void sheet_free(sheet *s) {
    for (int end = 0; end < 2; end++) {
        free(s->positions[end]);
        starg_mesh_free(s->meshes[end]);
    }
    free(s->colors);
}

/* Colours of A's faces: by place in its box, darker in every other cube. */
static void color_faces(const starg_mesh *mesh, uint8_t *colors) {
    double lower[3], upper[3], size = 0;
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        size = fmax(size, upper[k] - lower[k]);
    for (size_t f = 0; f < starg_mesh_face_count(mesh); f++) {
        double place[3] = {0};
        int sum = 0;
        for (size_t i = 0; i < 9; i++)
            place[i % 3] += (starg_mesh_vertices(
                                 mesh)[3 * (size_t)starg_mesh_faces(mesh)[3 * f + i / 3] + i % 3] -
                             lower[i % 3]) /
                            (3 * size);
        for (int k = 0; k < 3; k++)
            sum += (int)(SQUARES * place[k]);
        for (size_t k = 0; k < 3; k++) {
            double share = place[k] * size / fmax(upper[k] - lower[k], 1e-3 * size);
            colors[3 * f + k] = (uint8_t)((sum % 2 != 0 ? 0.6 : 1) * (95 + 160 * fmin(share, 1)));
        }
    }
}

static starg_status write_picture(cli_session *session, const values *v, const starg_mesh *target,
                                  starg_map *map) {
    SCOPED_BY(sheet_free) sheet s = {0};
    const starg_mesh *const given[2] = {session->mesh, target};
    starg_picture_options wanted;
    const starg_overlay *overlay = &map->overlay;
    if (overlay->face_count == 0)
        TRY(starg_map_overlay(session->context, session->mesh, target, map));
    s.colors = malloc(3 * overlay->face_count + 1);
    for (int end = 0; end < 2; end++)
        s.positions[end] = malloc((3 * overlay->vertex_count + 1) * sizeof(double));
    if (s.colors == NULL || s.positions[0] == NULL || s.positions[1] == NULL)
        return cli_fail_memory(session);
    for (int end = 0; end < 2; end++) {
        starg_overlay_positions(overlay, given[end], end, s.positions[end]);
        TRY(starg_mesh_create(session->context, s.positions[end], overlay->vertex_count,
                              overlay->faces, overlay->face_count, &s.meshes[end]));
    }
    color_faces(s.meshes[0], s.colors);
    starg_picture_options_default(&wanted);
    wanted.width = TILE_WIDTH;
    wanted.height = TILE_HEIGHT;
    wanted.opacity = 1;
    wanted.up = v->up;
    wanted.face_colors = s.colors;
    return starg_picture_sheet_write(session->context, (const starg_mesh *const *)s.meshes, 1, 2,
                                     &wanted, cli_outputs_place(&session->outputs, v->picture));
}

/* ---- report ---- */

static void say_map(cli_session *session, const starg_map *map) {
    static const char *const kinds[] = {"the same faces: vertex to vertex", "via the sphere",
                                        "given"};
    cli_say(session, "map           %s\n", kinds[map->kind]);
    cli_say(session, "vertices      %zu\n", map->vertex_count);
    cli_say(session, "landmarks     %zu (all met)\n", map->landmark_count);
    cli_say(session, "angles        %.4g (1 is best)\n", map->mean_angle_distortion);
    cli_say(session, "areas         %.4g (1 is best)\n", map->mean_area_distortion);
    if (map->overlay.face_count > 0)
        cli_say(session, "overlay       %zu vertices, %zu faces\n", map->overlay.vertex_count,
                map->overlay.face_count);
}

/* Reports the file's contents and data about the run. */
static starg_status report_map(cli_session *session, const starg_map *map, const values *v) {
    json_t *report = session->report;
    char *text;
    size_t size;
    TRY(starg_map_write_memory(session->context, map, &text, &size));
    cli_report_take(session, text, size);
    if (json_object_update_missing(report, json_object_get(report, "map")) != 0)
        session->report_broken = true;
    cli_put(session, report, "target", cli_json_text(session->operands[1]));
    cli_put(session, report, "output", cli_json_text(v->output));
    cli_put(session, report, "collapsed", json_integer((json_int_t)map->collapsed));
    return STARG_OK;
}

static starg_status map_surfaces(cli_session *session, const values *v) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *target = NULL;
    SCOPED_BY(starg_map_drop) starg_map *map = NULL;
    SCOPED_BY(starg_landmarks_drop) uint32_t *pairs = NULL;
    starg_map_options wanted;
    starg_map_options_default(&wanted);
    TRY(starg_mesh_read(session->context, session->operands[1], &target));
    if (v->landmarks != NULL)
        TRY(starg_landmarks_read(session->context, v->landmarks, session->mesh, target, &pairs,
                                 &wanted.landmark_count));
    wanted.landmarks = pairs;
    TRY(starg_map_create(session->context, session->mesh, target, &wanted, &map));
    if (v->overlay)
        TRY(starg_map_overlay(session->context, session->mesh, target, map));
    TRY(starg_map_write(session->context, map, cli_outputs_place(&session->outputs, v->output)));
    say_map(session, map);
    if (session->report != NULL)
        TRY(report_map(session, map, v));
    if (v->picture != NULL)
        TRY(write_picture(session, v, target, map));
    return STARG_OK;
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    const cli_solid_map solid = solid_options(v);
    if (v->solid)
        return cli_solid_map_run(session, &solid);
    return map_surfaces(session, v);
}

const cli_command cli_command_map = {
    .name = "map",
    .usage = "[--solid] A B [--landmarks FILE] [--map FILE] [--overlay] -o MAP",
    .summary = "compute a bijection between two surfaces or solids",
    .description =
        "Maps each vertex of A to a point of B: a face and barycentric coordinates. Surfaces with "
        "the same faces, such as poses of one model, are mapped vertex to vertex. Other surfaces "
        "must be closed, connected and of genus 0: both are mapped to the sphere, aligned, and "
        "warped until the landmarks coincide exactly. Without landmarks the alignment uses the "
        "principal axes, which can map a head to a tail; a few landmarks prevent that. "
        "'starguard verify A B MAP.json' proves that the map is a bijection.\n"
        "With --solid the solids inside are mapped: tetrahedra that fill A, and places of their "
        "corners in B, such that each is positive in both, by exact signs. Surfaces may have any "
        "genus if they have the same faces or a map is given, and must not meet themselves.",
    .examples = "# two poses, then two animals with landmarks\n"
                "starguard map horse_0.off horse_1.off -o poses.json\n"
                "starguard map cat.off dog.off --landmarks cat_dog.txt -o cat_dog.json\n"
                "# the solids, with an independent check\n"
                "starguard map --solid horse_0.off horse_1.off -o horse.vtu\n"
                "starguard verify horse_0.off horse_1.off horse.vtu\n"
                "# a field, given at points of the first, for the second\n"
                "starguard map --solid horse_0.off horse_1.off --map horse.vtu \\\n"
                "    --apply field.txt --carried field_1.txt\n"
                "# to a ball\n"
                "starguard map --solid horse_0.off --to ball -o ball.vtu",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 2),
    CLI_LIBRARY(starg_solid_map_options_fields, wanted),
    .input = CLI_INPUT_MESH,
    .prepare = prepare,
    .run = run,
};
