/* SPDX-License-Identifier: Apache-2.0 */
/* starguard morph: interpolates between two surfaces. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"
#include "starguard/animation.h"
#include "starguard/picture.h"
#include "starguard/solidmap.h"

CLI_DROP(starg_guards, starg_guards)
CLI_DROP(starg_landmarks, uint32_t)
CLI_DROP(starg_solid_map, starg_solid_map)

static void starg_morph_drop(starg_morph **morph) {
    starg_morph_free(*morph);
}

typedef struct values {
    const char *output, *map, *landmarks, *glb, *picture, *certificate;
    starg_morph_options wanted;
    uint64_t frames;
    int up, connectivity, format;
    bool guards, pieces, overlay, report;
} values;

static const double POOR = 0.02; /* of B's diagonal: the last frame is no picture of B */

enum { SHEET_COLUMNS = 5, TILE_WIDTH = 480, TILE_HEIGHT = 360 };
static const double SECONDS = 2; /* of an animation */

/* In the order of starg_picture_options.up. */
static const char *const axes[] = {"x", "y", "z", NULL};

/* Words of --frames-format. */
static const char *const formats[] = {"off", "ply", NULL};

/* Words of --connectivity. */
static const char *const connectivities[] = {"both", "a", NULL};

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("DIR", "Folder for frame_0000.off, frame_0001.off, ...; created if missing.",
                      .group = "output", .brief = "a folder for the frames"),
    CLI_COUNT_OPTION("frames", frames, "N", 2, 10000, 21, NULL,
                     "Number of frames, evenly spaced in time, including both ends.",
                     .group = "output", .brief = "how many"),
    CLI_CHOICE_OPTION("frames-format", format, formats, 0, "off|ply",
                      "Frames as OFF, which has places and faces only, or as PLY, with the colours "
                      "and texture coordinates of A.",
                      .group = "output"),
    CLI_INPUT_OPTION("map", map, "FILE",
                     "Map from 'starguard map'. Default: computed as by that command.",
                     .group = "input", .brief = "a map that was made before"),
    CLI_INPUT_OPTION("landmarks", landmarks, "FILE", "Landmarks for the computed map.",
                     .group = "input", .brief = "pairs of places that belong together"),
    CLI_FLAG_OPTION(
        "overlay", overlay,
        "Refine A by the faces of B, so that the last frame is B itself: see 'starguard "
        "map --overlay'.",
        .group = "output"),
    CLI_CHOICE_OPTION("connectivity", connectivity, connectivities, 0, "both|a",
                      "With --method solid: all frames have the faces of the overlay, so that the "
                      "last one is B itself (--overlay); or those of A, and how far the last one "
                      "is from B is told.",
                      .group = "output"),
    CLI_FLAG_OPTION(
        "report", report,
        "Also write morph.json into DIR: what --json reports, for 'starguard verify A B "
        "DIR'.",
        .group = "output"),
    CLI_TEXT_OPTION(
        "glb", glb, "FILE.glb",
        "Frames as one animation of two seconds (glTF, morph targets), with the colours of A's "
        "vertices and its texture coordinates.",
        .group = "output", .brief = "an animation for Blender"),
    CLI_TEXT_OPTION("picture", picture, "FILE.png",
                    "Picture of five time steps, one row each for star, arap and linear.",
                    .group = "output", .brief = "a picture of some frames"),
    CLI_TEXT_OPTION("certificate", certificate, "FILE.vtu",
                    "With --method solid: the tetrahedra and where they pass, as a map between the "
                    "solids that 'starguard verify A B FILE.vtu' checks.",
                    .group = "output"),
    CLI_CHOICE_OPTION("up", up, axes, 1, "x|y|z", "Axis that points up in --picture.",
                      .group = "output"),
    CLI_FLAG_OPTION(
        "guards", guards,
        "Also write guards_a.json and guards_b.json into DIR: corresponding guards of A and of the "
        "last frame. Reports how many each shape needs alone (star and spherical).",
        .group = "output"),
    CLI_FLAG_OPTION("pieces", pieces,
                    "Also cut both solids into compatible star-shaped pieces: pieces_a.vtk and "
                    "pieces_a.json for A, pieces_b.vtk and pieces_b.json for the last frame, in "
                    "DIR. Neither may intersect itself; needs TetGen.",
                    .group = "output"),
};

static const char *method_word(const values *v) {
    return starg_fields_word(starg_morph_options_fields(), "method", v->wanted.method);
}

/* ---- files in the folder ---- */

/* Path of a file in the frames' folder; NULL when out of memory. */
static char *in_folder(const values *v, const char *name) {
    size_t size = strlen(v->output) + strlen(name) + 2;
    char *path = malloc(size);
    if (path != NULL)
        snprintf(path, size, "%s/%s", v->output, name);
    return path;
}

static char *frame_in_folder(const values *v, uint64_t index) {
    char name[32];
    snprintf(name, sizeof name, "frame_%04llu.%s", (unsigned long long)index, formats[v->format]);
    return in_folder(v, name);
}

/* A longer morph before has left frames behind, which would be read as if they were of this one. */
static void warn_of_former_frames(cli_session *session, const values *v) {
    SCOPED char *next = frame_in_folder(v, v->frames);
    if (next != NULL && access(next, F_OK) == 0)
        cli_warn(session,
                 "%s and what follows are of an earlier morph; remove them, or 'view' and "
                 "'verify' read them as frames of this one",
                 next);
}

/* Announces `path` and frees it. */
static starg_status announce_path(cli_session *session, char *path) {
    starg_status status = path != NULL ? cli_announce(session, path) : cli_fail_memory(session);
    free(path);
    return status;
}

static starg_status announce_folder(cli_session *session, const values *v) {
    static const char *const guards[] = {"guards_a.json", "guards_b.json"};
    static const char *const pieces[] = {"pieces_a.vtk", "pieces_a.json", "pieces_b.vtk",
                                         "pieces_b.json"};
    TRY(cli_announce_folder(session, v->output));
    for (uint64_t i = 0; i < v->frames; i++)
        TRY(announce_path(session, frame_in_folder(v, i)));
    if (v->report)
        TRY(announce_path(session, in_folder(v, "morph.json")));
    for (int i = 0; v->guards && i < 2; i++)
        TRY(announce_path(session, in_folder(v, guards[i])));
    for (int i = 0; v->pieces && i < 4; i++)
        TRY(announce_path(session, in_folder(v, pieces[i])));
    return STARG_OK;
}

/* ---- options ---- */

static starg_status prepare(cli_session *session, void *data) {
    const values *v = data;
    if (v->output == NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT, "no output folder; add -o DIR");
    if (strcmp(v->output, "-") == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "-o must name a folder, since a morph has several frames");
    if (v->map != NULL && v->landmarks != NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--map and --landmarks exclude each other; give one of them");
    if (v->guards && v->wanted.method != STARG_MORPH_STAR &&
        v->wanted.method != STARG_MORPH_SPHERICAL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--guards: method %s has no guards; use star or spherical", method_word(v));
    TRY(cli_announce_with_extension(session, "--glb", v->glb, ".glb"));
    TRY(cli_announce_with_extension(session, "--picture", v->picture, ".png"));
    TRY(cli_announce_with_extension(session, "--certificate", v->certificate, ".vtu"));
    if (v->certificate != NULL && v->wanted.method != STARG_MORPH_SOLID)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--certificate: only method solid has one, and this is %s", method_word(v));
    if (v->connectivity > 0 && (v->overlay || v->wanted.method != STARG_MORPH_SOLID))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--connectivity is for method solid, and excludes --overlay");
    if (v->glb != NULL && v->frames > STARG_ANIMATION_FRAMES)
        return cli_fail(session, STARG_ERROR_ARGUMENT, "--glb takes at most %d frames",
                        STARG_ANIMATION_FRAMES);
    return announce_folder(session, v);
}

/* ---- both ends ---- */

/* Both ends of the morph. */
typedef struct subject {
    starg_mesh *target;
    starg_map *map;
    starg_mesh *refined; /* A with the overlay's faces; NULL without overlay */
    double *images;
    double distance, diagonal; /* of the last frame from B, and of B */
    double volumes[2];         /* of the last frame, and of B */
} subject;

/* The first frame: A, or A refined. */
static const starg_mesh *source_of(const cli_session *session, const subject *s) {
    return s->refined != NULL ? s->refined : session->mesh;
}

static void subject_free(cli_session *session, subject *s) {
    starg_mesh_free(s->target);
    starg_map_free(session->context, s->map);
    starg_mesh_free(s->refined);
    free(s->images);
}

static starg_status make_map(cli_session *session, const values *v, subject *s) {
    starg_map_options wanted;
    SCOPED_BY(starg_landmarks_drop) uint32_t *pairs = NULL;
    starg_map_options_default(&wanted);
    wanted.solid = v->wanted.method == STARG_MORPH_SOLID && v->connectivity == 0;
    if (v->map != NULL)
        return starg_map_read(session->context, v->map, session->mesh, s->target, &s->map);
    if (v->landmarks != NULL)
        TRY(starg_landmarks_read(session->context, v->landmarks, session->mesh, s->target, &pairs,
                                 &wanted.landmark_count));
    wanted.landmarks = pairs;
    return starg_map_create(session->context, session->mesh, s->target, &wanted, &s->map);
}

/* A map that keeps vertices may still connect surfaces with some different faces. */
static bool has_same_faces(const starg_mesh *a, const starg_mesh *b) {
    size_t count = starg_mesh_face_count(a);
    return starg_mesh_face_count(b) == count &&
           starg_mesh_vertex_count(a) == starg_mesh_vertex_count(b) &&
           memcmp(starg_mesh_faces(a), starg_mesh_faces(b), 3 * count * sizeof(uint32_t)) == 0;
}

/* Both ends with the faces of the overlay. */
static starg_status refine(cli_session *session, subject *s) {
    const starg_overlay *overlay = &s->map->overlay;
    SCOPED double *positions = NULL;
    if (overlay->face_count == 0)
        TRY(starg_map_overlay(session->context, session->mesh, s->target, s->map));
    positions = malloc((3 * overlay->vertex_count + 1) * sizeof *positions);
    s->images = malloc((3 * overlay->vertex_count + 1) * sizeof *s->images);
    if (positions == NULL || s->images == NULL)
        return cli_fail_memory(session);
    starg_overlay_positions(overlay, session->mesh, 0, positions);
    starg_overlay_positions(overlay, s->target, 1, s->images);
    TRY(starg_mesh_create(session->context, positions, overlay->vertex_count, overlay->faces,
                          overlay->face_count, &s->refined));
    return starg_overlay_look(session->context, overlay, session->mesh, s->refined);
}

/* How far the last frame is from B. */
static starg_status measure_end(cli_session *session, subject *s) {
    const starg_mesh *source = source_of(session, s);
    SCOPED_BY(starg_mesh_drop) starg_mesh *last = NULL;
    double lower[3], upper[3];
    starg_mesh_bounds(s->target, lower, upper);
    s->diagonal = hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
    TRY(starg_mesh_create(session->context, s->images, starg_mesh_vertex_count(source),
                          starg_mesh_faces(source), starg_mesh_face_count(source), &last));
    TRY(starg_mesh_apart(session->context, last, s->target, &s->distance));
    s->volumes[0] = fabs(starg_mesh_volume(last));
    s->volumes[1] = fabs(starg_mesh_volume(s->target));
    return STARG_OK;
}

/* A surface of few vertices is no picture of B, whatever their places: then both get the faces of
 * the overlay. */
static starg_status refine_if_poor(cli_session *session, subject *s) {
    if (s->distance <= POOR * s->diagonal ||
        starg_mesh_vertex_count(session->mesh) >= starg_mesh_vertex_count(s->target))
        return STARG_OK;
    cli_warn(session,
             "in A's %zu vertices the last frame would be %.3g from B (%.3g %% of its diagonal): "
             "all frames have the faces of the overlay (--overlay)",
             starg_mesh_vertex_count(session->mesh), s->distance, 100 * s->distance / s->diagonal);
    free(s->images);
    s->images = NULL;
    TRY(refine(session, s));
    return measure_end(session, s);
}

static starg_status read_subject(cli_session *session, const values *v, subject *s) {
    TRY(starg_mesh_read(session->context, session->operands[1], &s->target));
    TRY(make_map(session, v, s));
    bool same = s->map->kind == STARG_MAP_SAME && has_same_faces(session->mesh, s->target);
    bool itself = v->wanted.method == STARG_MORPH_SOLID && v->connectivity == 0;
    if (v->overlay || (itself && !same)) {
        TRY(refine(session, s));
        return measure_end(session, s);
    }
    s->images = malloc((3 * starg_mesh_vertex_count(session->mesh) + 1) * sizeof *s->images);
    if (s->images == NULL)
        return cli_fail_memory(session);
    starg_map_positions(s->map, s->target, s->images);
    TRY(measure_end(session, s));
    if (v->connectivity == 0)
        TRY(refine_if_poor(session, s));
    return STARG_OK;
}

/* ---- frames ---- */

/* Sums over the frames, for the text report. */
typedef struct totals {
    size_t intersections, most_intersections, inverted;
    size_t ends[2]; /* pairs of intersecting faces in the first and the last frame */
    double drift;
} totals;

static json_t *frame_json(cli_session *session, double t, const starg_frame_measures *f) {
    json_t *item = json_object();
    cli_put(session, item, "t", cli_json_real(t));
    cli_put(session, item, "intersections", json_integer((json_int_t)f->intersections));
    cli_put(session, item, "inverted", json_integer((json_int_t)f->inverted));
    cli_put(session, item, "collapsed", json_integer((json_int_t)f->collapsed));
    cli_put(session, item, "volume", cli_json_real(f->volume));
    cli_put(session, item, "area", cli_json_real(f->area));
    cli_put(session, item, "volume_drift", cli_json_real(f->volume_drift));
    cli_put(session, item, "area_drift", cli_json_real(f->area_drift));
    return item;
}

/* Frees `name`. */
static starg_status write_frame(cli_session *session, const values *v, const starg_mesh *source,
                                const double *positions, char *name) {
    starg_status status = STARG_OK;
    starg_mesh *mesh = NULL;
    if (name == NULL)
        return cli_fail_memory(session);
    CLI_TRY(starg_mesh_create(session->context, positions, starg_mesh_vertex_count(source),
                              starg_mesh_faces(source), starg_mesh_face_count(source), &mesh));
    CLI_TRY(starg_mesh_set_colors(mesh, starg_mesh_colors(source)));
    CLI_TRY(starg_mesh_set_texture(mesh, starg_mesh_texture(source)));
    CLI_TRY(cli_mesh_write(session, mesh, v->format == 0 ? STARG_MESH_OFF : STARG_MESH_PLY_BINARY,
                           name));
done:
    starg_mesh_free(mesh);
    free(name);
    return status;
}

static starg_status write_frames(cli_session *session, const values *v, const subject *s,
                                 const starg_morph *morph, json_t *list, totals *sum) {
    const starg_mesh *source = source_of(session, s);
    SCOPED double *positions =
        malloc((3 * starg_mesh_vertex_count(source) + 1) * sizeof *positions);
    if (positions == NULL)
        return cli_fail_memory(session);
    for (uint64_t i = 0; i < v->frames; i++) {
        double t = (double)i / (double)(v->frames - 1);
        starg_frame_measures measures;
        TRY(starg_morph_frame(morph, t, positions));
        TRY(starg_morph_measure(morph, t, positions, &measures));
        TRY(write_frame(session, v, source, positions, frame_in_folder(v, i)));
        cli_append(session, list, frame_json(session, t, &measures));
        sum->intersections += measures.intersections;
        sum->ends[i > 0] = measures.intersections;
        sum->inverted += measures.inverted;
        if (measures.intersections > sum->most_intersections)
            sum->most_intersections = measures.intersections;
        double drift = measures.volume_drift < 0 ? -measures.volume_drift : measures.volume_drift;
        if (drift > sum->drift)
            sum->drift = drift;
    }
    return STARG_OK;
}

/* ---- animation ---- */

static starg_status write_animation(cli_session *session, const values *v, const subject *s,
                                    const starg_morph *morph) {
    const starg_mesh *source = source_of(session, s);
    size_t size = 3 * starg_mesh_vertex_count(source), count = (size_t)v->frames;
    SCOPED const double **frames = calloc(count, sizeof *frames);
    SCOPED double *positions =
        size <= SIZE_MAX / sizeof(double) / count ? malloc(size * count * sizeof *positions) : NULL;
    if (frames == NULL || positions == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < count; i++) {
        TRY(starg_morph_frame(morph, (double)i / (double)(count - 1), positions + i * size));
        frames[i] = positions + i * size;
    }
    return starg_animation_write(session->context, source, frames, count, SECONDS,
                                 cli_outputs_place(&session->outputs, v->glb));
}

/* ---- results of both ends ---- */

/* An end is the model itself if it equals the frame, otherwise that frame. NULL when out of
 * memory. */
static char *model_of(const cli_session *session, const values *v, const subject *s, int end) {
    bool given = s->map->kind == STARG_MAP_SAME && has_same_faces(session->mesh, s->target);
    if (end == 0)
        return s->refined != NULL ? frame_in_folder(v, 0) : strdup(session->operands[0]);
    return given ? strdup(session->operands[1]) : frame_in_folder(v, v->frames - 1);
}

/* ---- guards ---- */

/* The number of guards that each end would need alone, with proven bounds. */
typedef struct separate {
    size_t count[2], bound[2];
} separate;

/* Results of --guards and --pieces; otherwise empty. */
typedef struct extras {
    separate alone;
    starg_decomposition *pieces[2];
} extras;

static starg_status write_end(cli_session *session, const values *v, const subject *s,
                              const starg_morph *morph, int end) {
    SCOPED_BY(starg_guards_drop) starg_guards *guards = NULL;
    SCOPED char *name = in_folder(v, end == 0 ? "guards_a.json" : "guards_b.json");
    SCOPED char *model = model_of(session, v, s, end);
    if (name == NULL || model == NULL)
        return cli_fail_memory(session);
    TRY(starg_morph_guards_result(morph, end, &guards));
    return starg_guards_write(session->context, guards, model,
                              cli_outputs_place(&session->outputs, name));
}

static starg_status write_guards(cli_session *session, const values *v, const subject *s,
                                 const starg_morph *morph, separate *out) {
    for (int end = 0; end < 2; end++) {
        starg_guards *guards = NULL;
        TRY(write_end(session, v, s, morph, end));
        TRY(starg_morph_guards_separate(morph, end, &guards));
        out->count[end] = guards->count;
        out->bound[end] = guards->lower_bound;
        starg_guards_free(session->context, guards);
    }
    return STARG_OK;
}

static json_t *separate_json(cli_session *session, const separate *found) {
    json_t *list = json_array();
    for (int end = 0; end < 2; end++)
        cli_append(session, list,
                   json_pack("{s:I, s:I}", "guards", (json_int_t)found->count[end], "lower_bound",
                             (json_int_t)found->bound[end]));
    return list;
}

/* ---- pieces ---- */

static starg_status write_pieces_of(cli_session *session, const values *v, const subject *s,
                                    const starg_decomposition *pieces, int end) {
    SCOPED char *grid = in_folder(v, end == 0 ? "pieces_a.vtk" : "pieces_b.vtk");
    SCOPED char *told = in_folder(v, end == 0 ? "pieces_a.json" : "pieces_b.json");
    SCOPED char *model = model_of(session, v, s, end);
    if (grid == NULL || told == NULL || model == NULL)
        return cli_fail_memory(session);
    TRY(starg_decomposition_write(session->context, pieces,
                                  cli_outputs_place(&session->outputs, grid), false));
    return starg_decomposition_write_report(session->context, pieces, model,
                                            cli_outputs_place(&session->outputs, told));
}

static starg_status write_pieces(cli_session *session, const values *v, const subject *s,
                                 const starg_morph *morph, starg_decomposition *pieces[2]) {
    TRY(starg_morph_solids(morph, pieces));
    for (int end = 0; end < 2; end++)
        TRY(write_pieces_of(session, v, s, pieces[end], end));
    return STARG_OK;
}

static json_t *pieces_json(const starg_decomposition *const pieces[2]) {
    return json_pack("{s:I, s:I, s:[I, I], s:[f, f]}", "count", (json_int_t)pieces[0]->piece_count,
                     "tetrahedra", (json_int_t)starg_tetmesh_count(pieces[0]->mesh),
                     "strictly_star", (json_int_t)pieces[0]->strictly_star,
                     (json_int_t)pieces[1]->strictly_star, "flattest", pieces[0]->flattest,
                     pieces[1]->flattest);
}

/* ---- the path of a solid ---- */

static starg_status write_certificate(cli_session *session, const values *v, const subject *s,
                                      const starg_morph *morph) {
    SCOPED_BY(starg_solid_map_drop) starg_solid_map *map = NULL;
    TRY(starg_morph_solid_map(morph, &map));
    if (v->connectivity > 0)
        TRY(starg_solid_map_compare(session->context, s->target, map));
    return starg_solid_map_write(session->context, map,
                                 cli_outputs_place(&session->outputs, v->certificate));
}

/* ---- picture ---- */

static starg_status draw_row(cli_session *session, const subject *s, starg_morph_options wanted,
                             double *positions, starg_mesh **meshes) {
    SCOPED_BY(starg_morph_drop) starg_morph *morph = NULL;
    const starg_mesh *source = source_of(session, s);
    TRY(starg_morph_create(session->context, source, s->images, &wanted, &morph));
    for (size_t i = 0; i < SHEET_COLUMNS; i++) {
        TRY(starg_morph_frame(morph, (double)i / (SHEET_COLUMNS - 1), positions));
        TRY(starg_mesh_create(session->context, positions, starg_mesh_vertex_count(source),
                              starg_mesh_faces(source), starg_mesh_face_count(source), &meshes[i]));
    }
    return STARG_OK;
}

static starg_status write_picture(cli_session *session, const values *v, const subject *s) {
    static const starg_morph_method rows[] = {STARG_MORPH_STAR, STARG_MORPH_ARAP,
                                              STARG_MORPH_LINEAR};
    static const char *const names[] = {"star", "arap", "linear"};
    enum { ROWS = sizeof rows / sizeof *rows };
    starg_status status = STARG_OK;
    starg_mesh *meshes[ROWS * SHEET_COLUMNS] = {NULL};
    const starg_mesh *shown[ROWS * SHEET_COLUMNS];
    starg_picture_options picture;
    double *positions =
        malloc((3 * starg_mesh_vertex_count(source_of(session, s)) + 1) * sizeof *positions);
    if (positions == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < ROWS; i++)
        CLI_TRY(
            draw_row(session, s,
                     (starg_morph_options){.method = rows[i], .candidates = v->wanted.candidates},
                     positions, meshes + i * SHEET_COLUMNS));
    starg_picture_options_default(&picture);
    picture.width = TILE_WIDTH;
    picture.height = TILE_HEIGHT;
    picture.opacity = 1;
    picture.up = v->up;
    picture.row_names = names;
    for (size_t i = 0; i < ROWS * SHEET_COLUMNS; i++)
        shown[i] = meshes[i];
    CLI_TRY(starg_picture_sheet_write(session->context, shown, ROWS, SHEET_COLUMNS, &picture,
                                      cli_outputs_place(&session->outputs, v->picture)));
done:
    for (size_t i = 0; i < ROWS * SHEET_COLUMNS; i++)
        starg_mesh_free(meshes[i]);
    free(positions);
    return status;
}

/* ---- report ---- */

static json_t *guards_json(cli_session *session, const starg_morph *morph, int end) {
    json_t *list = json_array();
    for (size_t i = 0; i < starg_morph_guard_count(morph); i++)
        cli_append(session, list, cli_json_point(starg_morph_guards(morph, end) + 3 * i));
    return list;
}

static json_t *overlay_json(const subject *s) {
    return json_pack("{s:I, s:I}", "vertices", (json_int_t)starg_mesh_vertex_count(s->refined),
                     "faces", (json_int_t)starg_mesh_face_count(s->refined));
}

static void report_morph(cli_session *session, json_t *report, const values *v, const subject *s,
                         const starg_morph *morph, const extras *found, json_t *frames) {
    cli_put(session, report, "output", cli_json_text(v->output));
    cli_put(session, report, "target", cli_json_text(session->operands[1]));
    cli_put(session, report, "method", json_string(method_word(v)));
    if (s->refined != NULL)
        cli_put(session, report, "overlay", overlay_json(s));
    cli_put(session, report, "distance", cli_json_real(s->distance));
    cli_put(session, report, "guards", guards_json(session, morph, 0));
    cli_put(session, report, "counterparts", guards_json(session, morph, 1));
    cli_put(session, report, "unguarded_faces",
            json_integer((json_int_t)starg_morph_unguarded(morph)));
    if (v->guards)
        cli_put(session, report, "separate", separate_json(session, &found->alone));
    if (v->pieces)
        cli_put(session, report, "pieces",
                pieces_json((const starg_decomposition *const *)found->pieces));
    if (starg_morph_tetrahedron_count(morph) > 0)
        cli_put(session, report, "solid",
                json_pack("{s:I, s:I, s:i}", "tetrahedra",
                          (json_int_t)starg_morph_tetrahedron_count(morph), "keys",
                          (json_int_t)starg_morph_key_count(morph), "inverted", 0));
    cli_put(session, report, "frames", json_incref(frames));
}

/* morph.json: the report without seconds and memory. */
static starg_status write_report(cli_session *session, const values *v, const subject *s,
                                 const starg_morph *morph, const extras *found, json_t *frames) {
    char *name = in_folder(v, "morph.json");
    json_t *report = json_object();
    cli_put_head(session, report, "starguard-morph", session->operands[0], session->mesh);
    report_morph(session, report, v, s, morph, found, frames);
    starg_status status =
        name != NULL ? cli_report_write(session, report, name) : cli_fail_memory(session);
    json_decref(report);
    free(name);
    return status;
}

/* Frames as OFF have places and faces only. */
static void warn_of_look(cli_session *session, const values *v) {
    unsigned look = starg_mesh_left_out(session->mesh);
    bool kept = v->glb != NULL || v->format > 0;
    if (!kept && starg_mesh_colors(session->mesh) != NULL)
        look |= STARG_MESH_COLORS;
    if (!kept && starg_mesh_texture(session->mesh) != NULL)
        look |= STARG_MESH_TEXTURE;
    if (look != 0)
        cli_warn(session, "the frames leave out the %s of A%s",
                 look == STARG_MESH_COLORS    ? "colours"
                 : look == STARG_MESH_TEXTURE ? "texture coordinates"
                                              : "colours and texture coordinates",
                 starg_mesh_left_out(session->mesh) == 0
                     ? " (--frames-format ply and --glb keep them)"
                     : "");
}

static void say_morph(cli_session *session, const values *v, const subject *s,
                      const starg_morph *morph, const extras *found, const totals *sum) {
    const separate *alone = &found->alone;
    if (v->connectivity > 0)
        cli_say(session,
                "ends at       B in A's faces, up to %.3g from B (%.3g %% of its diagonal), of "
                "volume %.4g where B has %.4g\n",
                s->distance, s->diagonal > 0 ? 100 * s->distance / s->diagonal : 0, s->volumes[0],
                s->volumes[1]);
    cli_say(session, "frames        %llu\n", (unsigned long long)v->frames);
    if (starg_morph_guard_count(morph) > 0)
        cli_say(session, "guards        %zu in each shape; %s seen in both by none\n",
                starg_morph_guard_count(morph),
                cli_count_of(starg_morph_unguarded(morph), "face", "faces").text);
    if (v->guards)
        cli_say(session,
                "alone         %zu guards for A (at least %zu), %zu for B (at least %zu): for all "
                "that is seen there\n",
                alone->count[0], alone->bound[0], alone->count[1], alone->bound[1]);
    if (v->pieces)
        cli_say(session, "pieces        %zu, star-shaped in both solids (proven)\n",
                found->pieces[0]->piece_count);
    if (s->refined != NULL)
        cli_say(session, "overlay       %zu vertices, %zu faces\n",
                starg_mesh_vertex_count(s->refined), starg_mesh_face_count(s->refined));
    if (starg_morph_tetrahedron_count(morph) > 0)
        cli_say(session, "tetrahedra    %zu, none inverted at any time (proven between %zu keys)\n",
                starg_morph_tetrahedron_count(morph), starg_morph_key_count(morph));
    cli_say(session, "intersecting  %zu pairs of faces, at most %zu in a frame\n",
            sum->intersections, sum->most_intersections);
    cli_say(session, "at the ends   %zu pairs in the first frame, %zu in the last\n", sum->ends[0],
            sum->ends[1]);
    cli_say(session, "distance      %.3g of the last frame from B, %.3g %% of its diagonal\n",
            s->distance, s->diagonal > 0 ? 100 * s->distance / s->diagonal : 0);
    cli_say(session, "flipped       %zu faces\n", sum->inverted);
    cli_say(session, "volume drift  at most %.3g %%\n", 100 * sum->drift);
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    subject s = {0};
    starg_morph *morph = NULL;
    totals sum = {0};
    extras found = {0};
    json_t *frames = json_array();
    CLI_TRY(read_subject(session, v, &s));
    starg_morph_options wanted = v->wanted;
    wanted.centers = s.refined != NULL ? s.map->centers : NULL;
    CLI_TRY(
        starg_morph_create(session->context, source_of(session, &s), s.images, &wanted, &morph));
    CLI_TRY(write_frames(session, v, &s, morph, frames, &sum));
    warn_of_former_frames(session, v);
    if (v->guards)
        CLI_TRY(write_guards(session, v, &s, morph, &found.alone));
    if (v->pieces)
        CLI_TRY(write_pieces(session, v, &s, morph, found.pieces));
    if (v->certificate != NULL)
        CLI_TRY(write_certificate(session, v, &s, morph));
    if (v->glb != NULL)
        CLI_TRY(write_animation(session, v, &s, morph));
    if (v->picture != NULL)
        CLI_TRY(write_picture(session, v, &s));
    warn_of_look(session, v);
    say_morph(session, v, &s, morph, &found, &sum);
    if (session->report != NULL)
        report_morph(session, session->report, v, &s, morph, &found, frames);
    if (v->report)
        CLI_TRY(write_report(session, v, &s, morph, &found, frames));
done:
    json_decref(frames);
    for (int end = 0; end < 2; end++)
        starg_decomposition_free(session->context, found.pieces[end]);
    starg_morph_free(morph);
    subject_free(session, &s);
    return status;
}

const cli_command cli_command_morph = {
    .name = "morph",
    .usage = "A B [--map FILE] --frames N -o DIR [options]",
    .summary = "interpolate between two surfaces",
    .description =
        "Writes frames from A to B with the connectivity of A: the first is A, the last is B. The "
        "method star places guards in both shapes so that each pair sees corresponding pieces; "
        "pieces rotate and stretch about their guards, and the non-rigid residual is interpolated "
        "linearly. Reports self-intersecting faces per frame and the volume drift.",
    .examples = "# two poses of one model\n"
                "starguard morph horse_0.off horse_1.off --frames 21 -o frames\n"
                "# with corresponding guards; verify both files\n"
                "starguard morph horse_0.off horse_1.off --frames 21 -o frames --guards\n"
                "starguard verify horse_0.off frames/guards_a.json\n"
                "starguard verify horse_1.off frames/guards_b.json\n"
                "# with compatible star-shaped pieces\n"
                "starguard morph horse_0.off horse_1.off --frames 21 -o frames --pieces\n"
                "starguard verify horse_1.off frames/pieces_b.vtk frames/pieces_b.json\n"
                "# without an inverted tetrahedron inside, at any time, and the proof\n"
                "starguard morph horse_0.off horse_1.off --frames 21 -o frames --method solid \\\n"
                "    --certificate horse.vtu\n"
                "starguard verify horse_0.off horse_1.off horse.vtu\n"
                "# two animals with a landmark map, and linear interpolation for comparison\n"
                "starguard map cat.off dog.off --landmarks cat_dog.txt -o cat_dog.json\n"
                "starguard morph cat.off dog.off --map cat_dog.json --frames 21 -o frames\n"
                "starguard morph cat.off dog.off --map cat_dog.json --frames 21 -o plain \\\n"
                "    --method linear",
    CLI_OPTIONS(options),
    CLI_OPERANDS(2, 2),
    CLI_LIBRARY(starg_morph_options_fields, wanted),
    .input = CLI_INPUT_MESH,
    .prepare = prepare,
    .run = run,
};
