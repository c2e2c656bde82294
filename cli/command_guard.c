/* starguard guard: places guards, the main job. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"
#include "endings.h"
#include "model.h"
#include "numbers.h"
#include "report.h"
#include "starguard/guard.h"
#include "starguard/picture.h"
#include "suggest.h"
#include "view.h"

static const char *const method_words[] = {"ilp", "greedy", "pilp", NULL};
static const struct {
    const char *word;
    starg_candidates source;
} sources[] = {{"skeleton", STARG_CANDIDATES_SKELETON},
               {"medial", STARG_CANDIDATES_MEDIAL},
               {"interior", STARG_CANDIDATES_INTERIOR}};

static const uint8_t UNCOVERED[3] = {139, 0, 0};

typedef struct values {
    const char *output, *marks, *picture;
    const char *candidates;
    int method;
    uint64_t count, max_guards, redundancy, max_nodes, coarsest, step, refine_lines;
    double coverage, clearance, significance, cone;
    bool no_refine;
    cli_view view;
    starg_guard_options wanted; /* all of the above for the library */
    double *points;             /* --candidates FILE               */
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION(
        "GUARDS.json",
        "Where to write the guards (docs/formats.md); '-' writes to standard output."),
    CLI_CHOICE_OPTION(
        "method", method, method_words, "pilp|ilp|greedy",
        "pilp (default) goes from coarse to fine levels of detail and then refines; ilp finds "
        "the fewest of the candidates and proves it, or gives its best and a bound; greedy "
        "is fastest, with more guards and a weaker bound."),
    CLI_INPUT_OPTION(
        "candidates", candidates, "skeleton|medial|interior|FILE",
        "Where guards may stand: on the curve skeleton (default), on the medial axis, on a "
        "lattice inside, or at the points of a file: three numbers a line, a skeleton of "
        "'starguard skeleton', or another GUARDS.json."),
    CLI_COUNT_OPTION(
        "count", count, "N", 1, 10000000,
        "About how many candidates to make; more are added for faces that none of them sees. "
        "Default 1,000."),
    CLI_VIEW_OPTIONS("visibility"),
    CLI_POSITIVE_OPTION(
        "cone", cone, "DEGREES", 360,
        "Guards look in one direction, with this full opening angle, like cameras. Default "
        "360: all around."),
    CLI_POSITIVE_OPTION(
        "coverage", coverage, "F", 1,
        "Fraction of the coverable area that must be seen (of the vertices with --target "
        "vertices), above 0 and at most 1. Default 1."),
    CLI_COUNT_OPTION(
        "max-guards", max_guards, "K", 0, UINT32_MAX,
        "No more than K guards, which see as much area as possible. Default 0: as many as it "
        "takes."),
    CLI_COUNT_OPTION(
        "redundancy", redundancy, "K", 1, 1000,
        "Every face is to be seen by K guards, as far as there are so many candidates that "
        "see it. Default 1."),
    CLI_REAL_OPTION("clearance", clearance, "D", 0, 1e100,
                    "Guards stand at least D from the walls, in units of the model. Default 0."),
    CLI_COUNT_OPTION(
        "max-nodes", max_nodes, "N", 0, UINT32_MAX,
        "Branch-and-bound nodes for each independent part before the best so far is taken. "
        "Default 100,000 for ilp, 30 for each level of pilp."),
    CLI_FLAG_OPTION(
        "no-refine", no_refine,
        "pilp: leave the guards as the levels give them; do not look for better places."),
    CLI_COUNT_OPTION("refine-lines", refine_lines, "N", 0, UINT32_MAX,
                     "pilp: sight lines that refinement may test. Default 10 million."),
    CLI_COUNT_OPTION("coarsest", coarsest, "N", 4, UINT32_MAX,
                     "pilp: vertices of the coarsest level. Default 5,000."),
    CLI_COUNT_OPTION(
        "step", step, "N", 1, UINT32_MAX,
        "pilp: vertices that each finer level has more. Default 10,000; of models that have more "
        "than 40,000 above the coarsest level, each level has a quarter of the next finer one."),
    CLI_REAL_OPTION(
        "significance", significance, "F", 0, 1,
        "pilp: guards that see less than this fraction of a level's area are chosen anew "
        "there. Default 0.1."),
    CLI_TEXT_OPTION(
        "picture", picture, "FILE.png",
        "Draw the model half transparent with its guards; uncovered faces are dark red."),
    CLI_TEXT_OPTION("marks", marks, "FILE.ply",
                    "Write the model with each face in the colour of the first guard that sees it; "
                    "uncovered faces are dark red."),
};

static void set_defaults(void *data) {
    values *v = data;
    starg_guard_options library;
    starg_guard_options_default(&library);
    v->candidates = "skeleton";
    v->method = (int)library.method;
    v->count = library.candidate_count;
    v->max_guards = library.max_guards;
    v->redundancy = library.redundancy;
    v->max_nodes = UINT64_MAX;
    v->coarsest = library.coarsest;
    v->step = UINT64_MAX;
    v->significance = library.significance;
    v->cone = library.visibility.cone;
    v->refine_lines = library.refine_lines;
    v->coverage = library.coverage;
    v->clearance = library.clearance;
    cli_view_default(&v->view);
}

/* ---- what was asked for ---- */

/* A known source, or a file with points, which is read here. A bare word that names no file is a
 * slip of the command line. */
static starg_status take_candidates(cli_session *session, const char *word,
                                    starg_guard_options *wanted, double **points) {
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
    starg_status status = starg_points_read(session->context, word, points, &wanted->point_count);
    wanted->points = *points;
    return status;
}

static starg_guard_options make_options(const values *v) {
    starg_guard_options wanted;
    starg_guard_options_default(&wanted);
    wanted.method = (starg_guard_method)v->method;
    wanted.candidate_count = v->count;
    wanted.visibility = cli_view_options(&v->view);
    wanted.visibility.cone = v->cone;
    wanted.coverage = v->coverage;
    wanted.max_guards = v->max_guards;
    wanted.redundancy = (uint32_t)v->redundancy;
    wanted.clearance = v->clearance;
    if (v->max_nodes != UINT64_MAX)
        wanted.max_nodes = v->max_nodes;
    wanted.coarsest = v->coarsest;
    if (v->step != UINT64_MAX)
        wanted.step = v->step;
    wanted.significance = v->significance;
    wanted.refine = !v->no_refine;
    wanted.refine_lines = v->refine_lines;
    return wanted;
}

/* ---- what was found ---- */

static void say_bound(cli_session *session, const starg_guards *g) {
    size_t gap = g->count - g->lower_bound;
    cli_say(session, "lower bound   %zu", g->lower_bound);
    if (g->optimal)
        cli_say(session, " (optimal: no fewer of the candidates do)\n");
    else
        cli_say(session, " (gap %zu, %.1f %%)\n", gap, 100.0 * (double)gap / (double)g->count);
}

static void say_guards(cli_session *session, const starg_guards *g) {
    cli_say(session, "guards        %zu\n", g->count);
    say_bound(session, g);
    cli_say(session, "coverage      %g %% of the faces, %g %% of the area\n",
            cli_percent(g->coverage_faces), cli_percent(g->coverage_area));
    if (g->options.visibility.target == STARG_TARGET_VERTICES)
        cli_say(session, "              %g %% of the vertices\n",
                cli_percent(g->coverage_vertices));
    if (g->options.max_guards > 0)
        cli_say(session, "area bound    %g %% with %s\n", cli_percent(g->area_bound),
                cli_count_of(g->options.max_guards, "guard", "guards").text);
    cli_say(session, "uncovered     %s", cli_count_of(g->uncovered_count, "face", "faces").text);
    size_t hidden = g->face_count - g->coverable_faces;
    if (hidden > 0)
        cli_say(session, " (%s that no candidate sees)",
                cli_count_of(hidden, "face", "faces").text);
    cli_say(session, "\ncandidates    %zu\n", g->candidate_count);
    if (g->time_limited)
        cli_say(session, "time limit    reached; this is the best that was found\n");
}

static json_t *curve_json(cli_session *session, const starg_guards *g) {
    json_t *list = json_array();
    for (size_t i = 0; i < g->count; i++)
        cli_append(session, list, json_pack("[f, f]", g->curve_faces[i], g->curve_area[i]));
    return list;
}

/* The levels in numbers; their guards stand in the file. */
static json_t *levels_json(cli_session *session, const starg_guards *g) {
    json_t *list = json_array();
    for (size_t i = 0; i < g->level_count; i++) {
        const starg_guard_level *level = &g->level_list[i];
        cli_append(session, list,
                   json_pack("{s:I, s:I, s:I, s:I}", "vertices", (json_int_t)level->vertex_count,
                             "faces", (json_int_t)level->face_count, "guards",
                             (json_int_t)level->count, "kept", (json_int_t)level->kept));
    }
    return list;
}

static json_t *coverage_json(cli_session *session, const starg_guards *g) {
    json_t *coverage = json_object();
    cli_put(session, coverage, "faces", cli_json_real(g->coverage_faces));
    cli_put(session, coverage, "area", cli_json_real(g->coverage_area));
    cli_put(session, coverage, "coverable_faces", json_integer((json_int_t)g->coverable_faces));
    cli_put(session, coverage, "uncovered_faces",
            cli_json_indices(session, g->uncovered, g->uncovered_count));
    cli_put(session, coverage, "curve", curve_json(session, g));
    if (g->options.max_guards > 0)
        cli_put(session, coverage, "area_bound", cli_json_real(g->area_bound));
    if (g->options.visibility.target != STARG_TARGET_VERTICES)
        return coverage;
    cli_put(session, coverage, "vertices", cli_json_real(g->coverage_vertices));
    cli_put(session, coverage, "coverable_vertices",
            json_integer((json_int_t)g->coverable_vertices));
    cli_put(session, coverage, "uncovered_vertices",
            cli_json_indices(session, g->uncovered_vertices, g->uncovered_vertex_count));
    return coverage;
}

static void report_guards(cli_session *session, const starg_guards *g, const char *output) {
    json_t *report = session->report, *list = json_array();
    for (size_t i = 0; i < g->count; i++) {
        json_t *guard = json_object();
        cli_put(session, guard, "position", cli_json_point(g->positions + 3 * i));
        if (g->directions != NULL)
            cli_put(session, guard, "direction", cli_json_point(g->directions + 3 * i));
        cli_put(session, guard, "faces", json_integer((json_int_t)g->seen_faces[i]));
        cli_put(session, guard, "level", json_integer(g->levels[i]));
        cli_append(session, list, guard);
    }
    cli_put(session, report, "output", cli_json_text(output));
    cli_put(session, report, "guards", list);
    cli_put(session, report, "coverage", coverage_json(session, g));
    if (g->level_count > 0)
        cli_put(session, report, "levels", levels_json(session, g));
    cli_put(session, report, "sight_lines", json_integer((json_int_t)g->lines_tested));
    cli_put(session, report, "candidates", json_integer((json_int_t)g->candidate_count));
    cli_put(session, report, "lower_bound", json_integer((json_int_t)g->lower_bound));
    cli_put(session, report, "optimal", json_boolean(g->optimal));
    cli_put(session, report, "time_limited", json_boolean(g->time_limited));
}

/* ---- files ---- */

static void paint_uncovered(uint8_t *colors, const starg_guards *g) {
    for (size_t i = 0; i < g->uncovered_count; i++)
        memcpy(colors + 3 * (size_t)g->uncovered[i], UNCOVERED, sizeof UNCOVERED);
}

static starg_status write_marks(cli_session *session, const starg_solid *solid,
                                const starg_guards *g, const char *name) {
    starg_status status = STARG_OK;
    starg_bits *seen = NULL;
    starg_visibility_options view = g->options.visibility;
    view.target = STARG_TARGET_FACES;
    view.directions = g->directions;
    uint8_t *colors = cli_colors_create(starg_solid_mesh(solid));
    if (colors == NULL)
        return cli_fail_memory(session);
    CLI_TRY(starg_visibility(session->context, solid, g->positions, g->count, &view, &seen));
    cli_colors_by_viewer(colors, seen);
    paint_uncovered(colors, g);
    CLI_TRY(cli_mesh_write(session, starg_solid_mesh(solid), STARG_MESH_PLY_BINARY, colors, name));
done:
    starg_bits_free(seen);
    free(colors);
    return status;
}

static starg_status write_picture(cli_session *session, const starg_solid *solid,
                                  const starg_guards *g, const char *name) {
    starg_picture_options picture;
    starg_picture_options_default(&picture);
    uint8_t *colors = cli_colors_create(starg_solid_mesh(solid));
    if (colors == NULL)
        return cli_fail_memory(session);
    paint_uncovered(colors, g);
    picture.face_colors = colors;
    picture.points = g->positions;
    picture.point_count = g->count;
    starg_status status = starg_picture_write(session->context, starg_solid_mesh(solid), &picture,
                                              cli_outputs_place(&session->outputs, name));
    free(colors);
    return status;
}

/* Standard output comes last: what has gone there cannot be taken back. */
static starg_status write_files(cli_session *session, const values *v, const starg_solid *solid,
                                const starg_guards *g) {
    starg_status status = STARG_OK;
    if (v->marks != NULL)
        CLI_TRY(write_marks(session, solid, g, v->marks));
    if (v->picture != NULL)
        CLI_TRY(write_picture(session, solid, g, v->picture));
    CLI_TRY(starg_guards_write(session->context, g, session->operands[0],
                               cli_outputs_place(&session->outputs, v->output)));
done:
    return status;
}

static starg_status prepare(cli_session *session, void *data) {
    values *v = data;
    starg_status status = STARG_OK;
    CLI_TRY(cli_announce_needed(session, v->output, "GUARDS.json"));
    CLI_TRY(cli_announce_with_ending(session, "--marks", v->marks, ".ply"));
    CLI_TRY(cli_announce_with_ending(session, "--picture", v->picture, ".png"));
    v->wanted = make_options(v);
    CLI_TRY(take_candidates(session, v->candidates, &v->wanted, &v->points));
done:
    return status;
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    starg_guards *guards = NULL;
    CLI_TRY(starg_guard(session->context, session->solid, &v->wanted, &guards));
    CLI_TRY(write_files(session, v, session->solid, guards));
    say_guards(session, guards);
    if (session->report != NULL)
        report_guards(session, guards, v->output);
done:
    starg_guards_free(session->context, guards);
    return status;
}

static void release(cli_session *session, void *data) {
    const values *v = data;
    starg_points_free(session->context, v->points);
}

const cli_command cli_command_guard = {
    .name = "guard",
    .usage = "MODEL -o GUARDS.json [options]",
    .summary = "place the fewest guards that together see the whole boundary",
    .description =
        "Makes candidate points inside the solid, computes exactly which faces each sees, and "
        "chooses the fewest that together see every face that can be seen. The result holds the "
        "guards, what they cover, and a proven lower bound: no choice of fewer candidates covers "
        "as much. Faces that nothing sees are listed, and are no error.\n"
        "With --time-limit the best that was found is written, with its bound.",
    .examples = "# the fewest guards for a model, and the proof\n"
                "starguard guard model.off -o guards.json\n"
                "starguard verify model.off guards.json\n"
                "# 99 % of the area is enough; guards 0.1 from the walls; a picture\n"
                "starguard guard room.obj -o guards.json --coverage 0.99 --clearance 0.1 \\\n"
                "    --picture guards.png\n"
                "# the best places for five cameras that see 20 units far\n"
                "starguard guard hall.stl -o cameras.json --max-guards 5 --range 20",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    .defaults = set_defaults,
    .input = CLI_INPUT_SOLID,
    .prepare = prepare,
    .run = run,
    .release = release,
};
