/* SPDX-License-Identifier: Apache-2.0 */
/* starguard guard: places guards. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"
#include "options.h"
#include "scene.h"
#include "session.h"
#include "starguard/guard.h"
#include "starguard/picture.h"
#include "starguard/skeleton.h"

CLI_DROP(starg_guards, starg_guards)
CLI_DROP(starg_patches, uint32_t)
CLI_DROP(starg_text, char)

static const struct {
    const char *word;
    starg_candidates source;
} sources[] = {{"skeleton", STARG_CANDIDATES_SKELETON},
               {"medial", STARG_CANDIDATES_MEDIAL},
               {"interior", STARG_CANDIDATES_INTERIOR}};

static const uint8_t UNCOVERED[3] = {139, 0, 0};

typedef struct values {
    const char *output, *marks, *picture, *certificate, *candidates, *poses_file, *leak;
    starg_guard_options wanted;
    cli_scene scene;
    cli_tables tables;
    starg_poses poses; /* --candidates FILE */
    const char *curve, *matrix;
    const char *keep_file;
    starg_poses keep; /* --keep FILE */
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("GUARDS.json", "Guards (docs/formats.md); '-' writes to standard output.",
                      .group = "output", .brief = "the guards (docs/formats.md)"),
    CLI_INPUT_OPTION(
        "candidates", candidates, "skeleton|medial|interior|FILE",
        "Candidate positions: on the curve skeleton (default), on the medial axis, on "
        "an interior lattice, or from a file: text with three numbers per line, or "
        "six with the direction in which a camera looks (--cone, --fov), or nine with what is up "
        "for it, a skeleton of 'starguard skeleton', or another GUARDS.json.",
        .group = "places", .brief = "where guards may stand, or a file of positions"),
    CLI_INPUT_OPTION(
        "keep", keep_file, "FILE",
        "Cameras that stay: poses as with --candidates, or CSV or JSON as --poses "
        "writes it, or the cameras of a GLB. They come first, and guards are added for "
        "what they leave: --max-guards, bounds and proofs are of those.",
        .group = "number", .brief = "cameras that stay; others are added"),
    CLI_TEXT_OPTION("picture", picture, "FILE.png",
                    "Picture of the translucent model with its guards, and with --cone or --fov "
                    "where they look; uncovered faces are dark red.",
                    .group = "output", .brief = "a picture of the guards"),
    CLI_TEXT_OPTION("certificate", certificate, "FILE",
                    "With --prove: writes why the bound for guards anywhere holds, for 'starguard "
                    "verify' (docs/formats.md).",
                    .group = "output"),
    CLI_TEXT_OPTION("marks", marks, "FILE.ply|.vtp",
                    "Model with each face in the colour of the first guard that sees it; uncovered "
                    "faces are dark red.",
                    .group = "output"),
    CLI_TEXT_OPTION("poses", poses_file, "FILE.csv|.json",
                    "Poses for other programs: positions, and with --cone or --fov rotations "
                    "(quaternions) and points to look at.",
                    .group = "output", .brief = "positions and directions for other programs"),
    CLI_TEXT_OPTION("leak", leak, "FILE.obj|.vtk",
                    "--soup --from: the way by which the space that is reached leaks to the "
                    "outside, or through a gap hardly wider than a cube, as a line.",
                    .group = "places"),
    CLI_TABLE_OPTIONS,
    CLI_TEXT_OPTION("curve", curve, "FILE.csv|.svg",
                    "For 1, 2, ... guards up to those found: the share of the area that so many of "
                    "the candidates were found to see, and an upper bound of it.",
                    .group = "output"),
    CLI_TEXT_OPTION("matrix", matrix, "FILE",
                    "What the candidates see, as a set cover in text: the numbers of elements and "
                    "sets, and for each element its number, that of its sets, and these.",
                    .group = "output"),
    CLI_INPUTS_OPTION(
        "require", scene.require, "FACES=K[,DENSITY]",
        "Faces that K guards must see, in place of --redundancy, and with that density "
        "of pixels in place of --density (a number or a name); faces as with --see. "
        "Repeatable: the last that names a face counts.",
        .group = "targets"),
    CLI_SCENE_OPTIONS,
    CLI_PLACE_OPTIONS,
};

/* ---- options ---- */

/* Recognizes a known source, or reads a file of points. A bare word that names no file is an error
 * in the command line. */
static starg_status take_candidates(cli_session *session, const char *word,
                                    starg_guard_options *wanted, starg_poses *poses) {
    cli_suggestion near;
    cli_suggest_begin(&near, word);
    for (size_t i = 0; i < sizeof sources / sizeof *sources; i++) {
        if (strcmp(word, sources[i].word) == 0) {
            wanted->candidates = sources[i].source;
            return STARG_OK;
        }
        cli_suggest_try(&near, sources[i].word);
    }
    if (strpbrk(word, "./") == NULL && strcmp(word, "-") != 0 && access(word, F_OK) != 0)
        return cli_fail(
            session, STARG_ERROR_ARGUMENT,
            "--candidates takes skeleton, medial, interior or a file of points, and there is no "
            "file '%.100s'%s%s%s",
            word, near.best != NULL ? "; did you mean '" : "", near.best != NULL ? near.best : "",
            near.best != NULL ? "'?" : "");
    if (strcmp(word, "-") == 0 && strcmp(session->operands[0], "-") == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "the model and the candidates cannot both come from standard input");
    wanted->candidates = STARG_CANDIDATES_GIVEN;
    starg_status status = starg_poses_read(session->context, word, poses);
    wanted->points = poses->points;
    wanted->directions = poses->directions;
    wanted->ups = poses->ups;
    wanted->point_count = poses->count;
    if (poses->directions != NULL && wanted->visibility.cone >= 360 &&
        wanted->visibility.fov[0] == 0)
        cli_log(session, STARG_LOG_NOTICE,
                "the candidates have directions, which matter with --cone DEG or --fov H,V only");
    return status;
}

static starg_status take_keep(cli_session *session, values *v) {
    if (v->keep_file == NULL)
        return STARG_OK;
    if (strcmp(v->keep_file, "-") == 0 && strcmp(session->operands[0], "-") == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "the model and the cameras to keep cannot both come from standard input");
    TRY(starg_poses_read(session->context, v->keep_file, &v->keep));
    v->wanted.keep = v->keep.points;
    v->wanted.keep_directions = v->keep.directions;
    v->wanted.keep_ups = v->keep.ups;
    v->wanted.keep_count = v->keep.count;
    return STARG_OK;
}

/* ---- report ---- */

static size_t count_kept(const starg_guards *g) {
    return g->options.keep_count;
}

static void say_bound(cli_session *session, const starg_guards *g) {
    size_t gap = g->count - count_kept(g) - g->lower_bound;
    cli_say(session, "lower bound   %zu of these candidates", g->lower_bound);
    if (g->optimal)
        cli_say(session, " (no fewer of them do)\n");
    else
        cli_say(session, " (gap %zu, %.1f %%)\n", gap,
                100.0 * (double)gap / (double)(g->count - count_kept(g)));
}

/* With a given number of guards, the result is the area that they see. */
static void say_area_bound(cli_session *session, const starg_guards *g) {
    bool anywhere = g->area_bound_everywhere > 0;
    cli_say(session, "area          %g %% seen, at most %g %% possible with %s%s\n",
            cli_percent(g->coverage_area),
            cli_percent(anywhere ? g->area_bound_everywhere : g->area_bound),
            cli_count_of(g->options.max_guards, "guard", "guards").text,
            anywhere ? " wherever they stand" : " of these candidates");
}

/* Why there is no bound for guards anywhere. */
static const char *why_unbound(const starg_guards *g) {
    if (g->options.prove)
        return "was not found in the time";
    return g->options.coverage < 1 ? "is not sought for a part of the area (--prove does)"
                                   : "was not sought (--prove does)";
}

static void say_count(cli_session *session, const starg_guards *g) {
    if (count_kept(g) > 0)
        cli_say(session, "kept          %s\n",
                cli_count_of(count_kept(g), "guard that stays", "guards that stay").text);
    cli_say(session, count_kept(g) > 0 ? "added         %zu" : "guards        %zu",
            g->count - count_kept(g));
    if (count_kept(g) > 0 && g->count == count_kept(g))
        cli_say(session, ": they see all that can be seen");
    else if (g->options.max_guards > 0)
        cli_say(session, " of at most %zu", (size_t)g->options.max_guards);
    else if (g->optimal_everywhere)
        cli_say(session, ", the fewest possible wherever they stand");
    else if (g->lower_bound_everywhere > 0)
        cli_say(session, "; at least %zu %s needed wherever they stand", g->lower_bound_everywhere,
                g->lower_bound_everywhere == 1 ? "is" : "are");
    else
        cli_say(session, "; how many are needed wherever they stand %s", why_unbound(g));
    cli_say(session, "\n");
}

/* Faces that nothing sees are of two kinds: more candidates help with one of them. */
static void say_uncovered(cli_session *session, const starg_guards *g) {
    size_t wanted = g->target_count > 0 ? g->target_count : g->face_count;
    size_t hidden = wanted - g->coverable_faces;
    size_t unseen = g->unseen_count < hidden ? g->unseen_count : hidden, left = hidden - unseen;
    cli_say(session, "uncovered     %s", cli_count_of(g->uncovered_count, "face", "faces").text);
    if (hidden > 0)
        cli_say(session, " (");
    if (unseen > 0)
        cli_say(session, "%zu that no place sees%s", unseen, left > 0 ? ", " : "");
    if (left > 0)
        cli_say(session, "%zu that no candidate sees", left);
    if (left > 0 && g->options.candidates != STARG_CANDIDATES_GIVEN)
        cli_say(session, ": --count %zu may", 5 * g->candidate_count);
    cli_say(session, "%s\n", hidden > 0 ? ")" : "");
}

/* Says what is proven: of faces by their corners, whole faces, or every point. */
static void say_coverage(cli_session *session, const starg_guards *g) {
    const starg_visibility_options *view = &g->options.visibility;
    if (view->target == STARG_TARGET_POINTS && g->points_complete) {
        cli_say(session, "coverage      every point of the boundary\n");
        return;
    }
    if (view->target == STARG_TARGET_POINTS) {
        cli_say(session, "coverage      %g %% of the area point by point; %.2g %% is not decided\n",
                cli_percent(g->points_seen), 100 * g->points_open);
        return;
    }
    cli_say(session, "coverage      %g %% of the faces%s, %g %% of the area",
            cli_percent(g->coverage_faces),
            view->face_rule == STARG_FACES_WHOLE ? " as a whole" : " by their corners",
            cli_percent(g->coverage_area));
    if (view->patch > 0)
        cli_say(session, ", in parts of at most %.3g", view->patch);
    cli_say(session, "\n");
}

static void say_tour(cli_session *session, const starg_tour *t) {
    if (t->stop_count == 0)
        return;
    cli_say(session, "tour          %.9g long", t->length);
    if (t->blocked_count > 0)
        cli_say(session, "; between %zu of %s no free way was found (--count N may help)",
                t->blocked_count, cli_count_of(t->stop_count - 1, "pair", "pairs").text);
    cli_say(session, "\n");
}

static void say_guards(cli_session *session, const starg_guards *g) {
    say_count(session, g);
    if (g->options.max_guards > 0)
        say_area_bound(session, g);
    else if (session->common.verbose || g->options.candidates == STARG_CANDIDATES_GIVEN)
        say_bound(session, g);
    say_coverage(session, g);
    if (g->options.visibility.target == STARG_TARGET_VERTICES)
        cli_say(session, "              %g %% of the vertices\n",
                cli_percent(g->coverage_vertices));
    for (size_t k = 0; k < g->redundant_count; k++)
        cli_say(session, "%s%s seen%s by at least %s\n",
                k == 0 ? "redundancy    " : "              ",
                cli_count_of(g->redundant_faces[k], "face", "faces").text,
                g->options.visibility.patch > 0 ? " in all parts" : "",
                cli_count_of(k + 1, "guard", "guards").text);
    if (g->need_count > 0)
        cli_say(session, "required      %s, %zu as they need\n",
                cli_count_of(g->need_count, "face", "faces").text, g->met_needs);
    if (g->options.baseline > 0)
        cli_say(session, "baseline      %s seen by two guards %g degrees apart\n",
                cli_count_of(g->baseline_faces, "face", "faces").text, g->options.baseline);
    say_tour(session, &g->tour);
    say_uncovered(session, g);
    cli_say(session, "candidates    %zu\n", g->candidate_count);
    if (g->time_limited)
        cli_say_limited(session);
}

/* Reports the file's contents and data about the run. */
static starg_status report_guards(cli_session *session, const starg_guards *g, const char *output) {
    char *text;
    size_t size;
    TRY(starg_guards_write_memory(session->context, g, session->operands[0], &text, &size));
    cli_report_take(session, text, size);
    cli_put(session, session->report, "output", cli_json_text(output));
    cli_put(session, session->report, "unseen_faces", json_integer((json_int_t)g->unseen_count));
    cli_put(session, session->report, "sight_lines", json_integer((json_int_t)g->lines_tested));
    if (g->cells > 0) { /* a star-shaped solid needs no search */
        cli_put(session, session->report, "cells", json_integer((json_int_t)g->cells));
        cli_put(session, session->report, "witnesses", json_integer((json_int_t)g->witnesses));
        cli_put(session, session->report, "work", json_integer((json_int_t)g->prove_work));
    }
    return STARG_OK;
}

/* ---- files ---- */

/* The surface as guards see it, and which of its faces or patches each sees. */
typedef struct drawing {
    starg_mesh *mesh;
    starg_bits *seen;
    uint8_t *colors;
} drawing;

static void drawing_free(drawing *d) {
    starg_mesh_free(d->mesh);
    starg_bits_free(d->seen);
    free(d->colors);
}

/* Targets that nothing sees are dark red. */
static starg_status draw(cli_session *session, const starg_solid *solid, const starg_guards *g,
                         drawing *d) {
    size_t count = 0;
    SCOPED_BY(starg_patches_drop) uint32_t *missing = NULL;
    *d = (drawing){0};
    TRY(starg_guards_patches(session->context, solid, g, &d->mesh, &d->seen, &missing, &count));
    d->colors = cli_colors_create(d->mesh);
    for (size_t i = 0; d->colors != NULL && i < count; i++)
        memcpy(d->colors + 3 * (size_t)missing[i], UNCOVERED, sizeof UNCOVERED);
    return d->colors != NULL ? STARG_OK : cli_fail_memory(session);
}

static starg_status write_marks(cli_session *session, const starg_solid *solid,
                                const starg_guards *g, const char *name) {
    SCOPED_BY(drawing_free) drawing d = {0};
    TRY(draw(session, solid, g, &d));
    cli_colors_by_viewer(d.colors, d.seen);
    return cli_marks_write(session, d.mesh, d.colors, NULL, d.seen, name);
}

/* Adds what stands in the way, in its own colour; the vertices of obstacles follow the model's. */
static starg_status draw_obstacles(cli_session *session, const starg_solid *solid, drawing *d) {
    static const uint8_t OBSTACLE[3] = {150, 118, 78};
    const starg_mesh *all = starg_solid_mesh(solid);
    const size_t own = starg_space_model_vertices(solid), base = starg_mesh_vertex_count(d->mesh),
                 more = starg_mesh_vertex_count(all) - own;
    const uint32_t *faces = starg_mesh_faces(all);
    size_t count = starg_mesh_face_count(d->mesh);
    starg_mesh *mesh = NULL;
    if (more == 0)
        return STARG_OK;
    SCOPED double *points = malloc(3 * (base + more) * sizeof *points);
    SCOPED uint32_t *corners = malloc(3 * (count + starg_mesh_face_count(all)) * sizeof *corners);
    SCOPED uint8_t *colors = malloc(3 * (count + starg_mesh_face_count(all)));
    if (points == NULL || corners == NULL || colors == NULL)
        return cli_fail_memory(session);
    memcpy(points, starg_mesh_vertices(d->mesh), 3 * base * sizeof *points);
    memcpy(points + 3 * base, starg_mesh_vertices(all) + 3 * own, 3 * more * sizeof *points);
    memcpy(corners, starg_mesh_faces(d->mesh), 3 * count * sizeof *corners);
    memcpy(colors, d->colors, 3 * count);
    for (size_t f = starg_space_model_faces(solid); f < starg_mesh_face_count(all); f++) {
        if (faces[3 * f] < own) /* the back of a face of the model */
            continue;
        for (size_t k = 0; k < 3; k++)
            corners[3 * count + k] = (uint32_t)(faces[3 * f + k] - own + base);
        memcpy(colors + 3 * count++, OBSTACLE, sizeof OBSTACLE);
    }
    TRY(starg_mesh_create(session->context, points, base + more, corners, count, &mesh));
    starg_mesh_free(d->mesh);
    free(d->colors);
    d->mesh = mesh;
    d->colors = colors;
    colors = NULL;
    return STARG_OK;
}

static starg_status write_picture(cli_session *session, const starg_solid *solid,
                                  const starg_guards *g, const char *name) {
    starg_picture_options picture;
    SCOPED_BY(drawing_free) drawing d = {0};
    starg_picture_options_default(&picture);
    TRY(draw(session, solid, g, &d));
    TRY(draw_obstacles(session, solid, &d));
    picture.face_colors = d.colors;
    picture.points = g->positions;
    picture.point_count = g->count;
    picture.point_numbers = true;
    picture.views = g;
    return starg_picture_write(session->context, d.mesh, &picture,
                               cli_outputs_place(&session->outputs, name));
}

/* Standard output comes last: output to it cannot be undone. */
static starg_status write_files(cli_session *session, const values *v, const starg_solid *solid,
                                const starg_guards *g, const char *why, size_t size) {
    if (v->certificate != NULL)
        TRY(starg_certificate_write(session->context, why, size,
                                    cli_outputs_place(&session->outputs, v->certificate)));
    if (v->poses_file != NULL)
        TRY(starg_guards_write_poses(session->context, g, cli_has_extension(v->poses_file, ".csv"),
                                     cli_outputs_place(&session->outputs, v->poses_file)));
    TRY(cli_tables_write(session, &v->tables, g));
    if (v->curve != NULL)
        TRY(starg_guards_write_curve(session->context, g, cli_has_extension(v->curve, ".svg"),
                                     cli_outputs_place(&session->outputs, v->curve)));
    if (v->matrix != NULL)
        TRY(starg_guards_write_matrix(session->context, g,
                                      cli_outputs_place(&session->outputs, v->matrix)));
    if (v->marks != NULL)
        TRY(write_marks(session, solid, g, v->marks));
    if (v->picture != NULL)
        TRY(write_picture(session, solid, g, v->picture));
    return starg_guards_write(session->context, g, session->operands[0],
                              cli_outputs_place(&session->outputs, v->output));
}

static starg_status announce_poses(cli_session *session, const char *name) {
    if (name != NULL && !cli_has_extension(name, ".csv") && !cli_has_extension(name, ".json"))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--poses needs a name that ends in .csv or .json, not '%.200s'", name);
    return cli_announce(session, name);
}

static starg_status check_leak(cli_session *session, const values *v) {
    if (v->leak == NULL)
        return STARG_OK;
    if (!v->scene.soup || v->scene.from.count == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--leak is about what is reached in a soup: add --soup --from X,Y,Z");
    if (!cli_has_extension(v->leak, ".obj") && !cli_has_extension(v->leak, ".vtk"))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--leak needs a name that ends in .obj or .vtk, not '%.200s'", v->leak);
    return STARG_OK;
}

/* Without a leak, no file. */
static starg_status write_leak(cli_session *session, const char *name) {
    starg_status status = STARG_OK;
    starg_skeleton way = {0};
    const double *points = starg_space_leak(session->solid, &way.node_count);
    if (name == NULL)
        return STARG_OK;
    if (points == NULL) {
        cli_say(session, "leak          none; '%s' is not written\n", name);
        return STARG_OK;
    }
    CLI_TRY(cli_announce(session, name));
    way.edge_count = way.node_count - 1;
    way.positions = malloc(3 * way.node_count * sizeof *way.positions);
    way.edges = malloc(2 * way.node_count * sizeof *way.edges);
    if (way.positions == NULL || way.edges == NULL) {
        status = cli_fail_memory(session);
        goto done;
    }
    memcpy(way.positions, points, 3 * way.node_count * sizeof *points);
    for (uint32_t i = 0; i < 2 * way.edge_count; i++)
        way.edges[i] = (i + 1) / 2;
    status = starg_skeleton_write(
        session->context, &way, cli_outputs_place(&session->outputs, name),
        cli_has_extension(name, ".obj") ? STARG_SKELETON_OBJ : STARG_SKELETON_VTK);
done:
    free(way.positions);
    free(way.edges);
    return status;
}

static starg_status prepare(cli_session *session, void *data) {
    values *v = data;
    TRY(cli_announce_needed(session, v->output, "GUARDS.json"));
    TRY(cli_announce(session, v->certificate));
    if (v->certificate != NULL && !v->wanted.prove)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--certificate says why the bound of --prove holds; add --prove");
    TRY(cli_announce_marks(session, "--marks", v->marks));
    TRY(cli_announce_with_extension(session, "--picture", v->picture, ".png"));
    TRY(announce_poses(session, v->poses_file));
    TRY(cli_tables_announce(session, &v->tables));
    if (v->curve != NULL && !cli_has_extension(v->curve, ".csv") &&
        !cli_has_extension(v->curve, ".svg"))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--curve needs a name that ends in .csv or .svg, not '%.200s'", v->curve);
    TRY(cli_announce(session, v->curve));
    TRY(cli_announce(session, v->matrix));
    v->wanted.worth = v->curve != NULL || v->matrix != NULL;
    if (v->wanted.worth && v->wanted.visibility.target == STARG_TARGET_POINTS)
        return cli_fail(
            session, STARG_ERROR_ARGUMENT,
            "--curve and --matrix are about faces or vertices; leave out --target points");
    TRY(check_leak(session, v));
    v->scene.clearance = v->wanted.clearance;
    memcpy(v->scene.up, v->wanted.visibility.up, sizeof v->scene.up);
    if (v->scene.require.count > 0 && v->wanted.visibility.fov[0] == 0)
        for (size_t i = 0; i < v->scene.require.count; i++)
            if (strrchr(v->scene.require.values[i], '=') != NULL &&
                strchr(strrchr(v->scene.require.values[i], '='), ',') != NULL)
                return cli_fail(session, STARG_ERROR_ARGUMENT,
                                "--require %.100s asks for a density of pixels; add --fov H,V and "
                                "--resolution W,H",
                                v->scene.require.values[i]);
    TRY(cli_scene_prepare(session, &v->scene));
    if (v->candidates != NULL)
        TRY(take_candidates(session, v->candidates, &v->wanted, &v->poses));
    return take_keep(session, v);
}

static starg_status run(cli_session *session, void *data) {
    values *v = data;
    SCOPED_BY(starg_guards_drop) starg_guards *guards = NULL;
    SCOPED_BY(starg_text_drop) char *why = NULL;
    size_t size = 0;
    TRY(cli_scene_make(session, &v->scene));
    TRY(write_leak(session, v->leak));
    if (v->certificate != NULL)
        TRY(starg_guard_certified(session->context, session->solid, &v->wanted, &guards, &why,
                                  &size));
    else
        TRY(starg_guard(session->context, session->solid, &v->wanted, &guards));
    TRY(starg_guards_name_obstacles(session->context, guards, v->scene.obstacles.values));
    if (v->scene.zone_files != NULL)
        TRY(starg_guards_name_zones(session->context, guards, v->scene.zone_files));
    TRY(write_files(session, v, session->solid, guards, why, size));
    say_guards(session, guards);
    if (session->report != NULL)
        TRY(report_guards(session, guards, v->output));
    return STARG_OK;
}

/* ---- the command of a result ---- */

static starg_status recall(cli_session *session, const starg_guards *g, values *v) {
    size_t vertices = g->vertex_count;
    for (size_t i = 0; i < g->obstacle_count; i++)
        vertices += g->obstacles[i].vertex_count;
    v->wanted = g->options;
    if (v->wanted.step == starg_guard_default_step(vertices, v->wanted.coarsest))
        v->wanted.step = STARG_DEFAULT_STEP;
    for (size_t i = 0; i < sizeof sources / sizeof *sources; i++)
        if (g->options.candidates == sources[i].source && i > 0)
            v->candidates = sources[i].word;
    if (g->options.candidates == STARG_CANDIDATES_GIVEN)
        v->candidates = "CANDIDATES";
    if (g->options.keep_count > 0)
        v->keep_file = "KEEP";
    return cli_scene_recall(session, g, &v->scene);
}

starg_status cli_guard_command(cli_session *session, const starg_guards *g, const char *output,
                               char **line) {
    starg_status status = STARG_OK;
    values v = {0};
    cli_command_default(&cli_command_guard, &v);
    CLI_TRY(recall(session, g, &v));
    CLI_TRY(cli_command_print(session, &cli_command_guard, &v, g->seed, g->file, output, line));
done:
    cli_scene_forget(&v.scene);
    return status;
}

static void release(cli_session *session, void *data) {
    values *v = data;
    starg_poses_free(session->context, &v->poses);
    starg_poses_free(session->context, &v->keep);
    cli_scene_release(&v->scene);
}

const cli_command cli_command_guard = {
    .name = "guard",
    .usage = "MODEL -o GUARDS.json [options]",
    .summary = "place the fewest guards that together see the whole boundary",
    .description =
        "Generates candidate points inside the solid, computes exactly which faces each one sees, "
        "and chooses the fewest that together see every visible face. The result contains the "
        "guards, their coverage, and how many guards are needed at least: wherever they stand, as "
        "far as that is known, and of these candidates (--verbose). With --prove every point of "
        "the solid is a candidate. Faces that no candidate sees are listed; they are not an "
        "error.\n"
        "With --time-limit the best result so far is written with its bound.",
    .examples = "# guard a model and verify the result\n"
                "starguard guard model.off -o guards.json\n"
                "starguard verify model.off guards.json\n"
                "# the fewest guards anywhere in the solid, with a bound for all positions\n"
                "starguard guard model.off -o guards.json --prove\n"
                "# cover 99 % of the area, keep guards 0.1 from the walls, draw a picture\n"
                "starguard guard room.obj -o guards.json --coverage 0.99 --clearance 0.1 \\\n"
                "    --picture guards.png\n"
                "# the best places for five cameras with a range of 20 units\n"
                "starguard guard hall.stl -o cameras.json --max-guards 5 --range 20",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    CLI_LIBRARY(starg_guard_options_fields, wanted),
    .input = CLI_INPUT_MESH,
    .prepare = prepare,
    .run = run,
    .release = release,
};
