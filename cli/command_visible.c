/* SPDX-License-Identifier: Apache-2.0 */
/* starguard visible: computes what points inside a solid, or boxes in it, see. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "options.h"
#include "scene.h"
#include "session.h"
#include "starguard/guard.h"
#include "starguard/picture.h"
#include "starguard/visibility.h"

CLI_DROP(starg_guards, starg_guards)
CLI_DROP(starg_patches, uint32_t)
CLI_DROP(starg_unseen, uint8_t)

typedef struct values {
    starg_places from, boxes;
    const char *poses_file;
    starg_poses poses; /* of it, or those of `from`, borrowed */
    cli_tables tables;
    bool share;
    bool unseen;
    uint64_t work;
    starg_visibility_options view;
    const char *output;
    cli_scene scene;
} values;

static const cli_option options[] = {
    CLI_POINTS_OPTION("from", from, "X,Y,Z", "Viewpoint, in model coordinates. Repeatable.",
                      .group = "places", .brief = "a point from which to look"),
    CLI_INPUT_OPTION("poses", poses_file, "FILE",
                     "Cameras to look from: text with three numbers per line, six with the "
                     "direction in which it looks (--cone, --fov), or nine with what is up for it; "
                     "CSV or JSON as 'guard --poses' writes it; a GUARDS.json; or the cameras of a "
                     "GLB.",
                     .group = "places", .brief = "cameras from a file"),
    CLI_TABLE_OPTIONS,
    CLI_FLAG_OPTION("share", share,
                    "For each face: the share of the points, poses or boxes that see it, and the "
                    "mean solid angle, in steradians, under which points see what they see of it.",
                    .group = "output"),
    CLI_BOXES_OPTION("box", boxes, "X0,Y0,Z0,X1,Y1,Z1",
                     "View box, by two opposite corners, instead of points. Reports the "
                     "potentially visible set: everything else is proven hidden from all interior "
                     "points of the box. The smaller the box, the tighter the set. Repeatable.",
                     .group = "places"),
    CLI_OUTPUT_OPTION(
        "FILE.ply|.vtp",
        "Model with each face in the colour of the first point or box that sees it; unseen faces "
        "are grey. With --target vertices, a face counts if one point sees all its vertices.",
        .group = "output", .brief = "the model with its visible faces marked"),
    {CLI_OPTION("unseen", STARG_FIELD_FLAG, unseen, NULL,
                "Faces that no point of the free space sees, with proof, instead of what points "
                "see. --from, if given, says where the free space is reached from.",
                .group = "output", .brief = "faces that no point or place sees")},
    {CLI_OPTION("work", STARG_FIELD_COUNT, work, "N",
                "--unseen: budget, in tests of a vertex against a box (about a microsecond each).",
                .group = "search"),
     .most = UINT64_MAX >> 1, .initial = 30000000},
    CLI_SCENE_OPTIONS,
    CLI_LIMIT_OPTIONS,
};

/* Data of one call. */
typedef struct look {
    const values *wanted;
    const starg_solid *solid;
    const starg_bits *seen;
    const double *fractions; /* area fractions by face */
    json_t *places;
} look;

/* Exactly 1 if everything is seen, never more. */
static double area_seen(const look *l, size_t row) {
    double seen = 0, hidden = 0;
    for (size_t face = 0; face < starg_space_model_faces(l->solid); face++)
        *(starg_bits_test(l->seen, row, face) ? &seen : &hidden) += l->fractions[face];
    return seen / (seen + hidden);
}

/* Reports what the point or box of the row sees; `place` describes its position. */
static void tell_seen(cli_session *session, const look *l, size_t row, const char *sees,
                      json_t *place) {
    bool faces = l->wanted->view.target == STARG_TARGET_FACES;
    size_t count = starg_bits_count(l->seen, row), all = starg_bits_columns(l->seen);
    double area = faces ? area_seen(l, row) : 0;
    if (faces && sees != NULL)
        cli_say(session, "%s %zu of %zu faces, %.2f %% of the area\n", sees, count, all,
                cli_percent(area));
    else if (sees != NULL)
        cli_say(session, "%s %zu of %zu vertices\n", sees, count, all);
    if (place == NULL)
        return;
    cli_put(session, place, "count", json_integer((json_int_t)count));
    if (faces)
        cli_put(session, place, "area", cli_json_real(area));
    cli_put(session, place, faces ? "faces" : "vertices", cli_json_row(session, l->seen, row));
    cli_append(session, l->places, place);
}

static void tell_point(cli_session *session, const look *l, size_t row) {
    const double *p = l->wanted->from.values + 3 * row;
    bool inside = starg_solid_contains(l->solid, p);
    json_t *point = session->report == NULL ? NULL : json_object();
    cli_say(session, "%.17g,%.17g,%.17g  ", p[0], p[1], p[2]);
    if (!inside)
        cli_say(session, "not inside the solid: sees nothing\n");
    if (point != NULL) {
        cli_put(session, point, "position", cli_json_point(p));
        cli_put(session, point, "inside", json_boolean(inside));
    }
    tell_seen(session, l, row, inside ? "sees" : NULL, point);
}

static void tell_box(cli_session *session, const look *l, size_t row) {
    const double *b = l->wanted->boxes.values + 6 * row;
    json_t *box = session->report == NULL ? NULL : json_object();
    cli_say(session, "%.17g,%.17g,%.17g to %.17g,%.17g,%.17g  ", b[0], b[1], b[2], b[3], b[4],
            b[5]);
    if (box != NULL) {
        cli_put(session, box, "lower", cli_json_point(b));
        cli_put(session, box, "upper", cli_json_point(b + 3));
    }
    tell_seen(session, l, row, "sees at most", box);
}

static starg_status tell(cli_session *session, look *l) {
    bool boxes = l->wanted->boxes.count > 0;
    l->places = json_array();
    for (size_t row = 0; row < starg_bits_rows(l->seen); row++)
        (boxes ? tell_box : tell_point)(session, l, row);
    if (session->report == NULL) {
        json_decref(l->places);
        return STARG_OK;
    }
    cli_put(session, session->report, "options",
            cli_json_record(session, starg_visibility_options_fields(), &l->wanted->view));
    cli_put(session, session->report, boxes ? "boxes" : "points", l->places);
    return STARG_OK;
}

/* Colours the faces whose vertices a point sees; the first point is painted last. */
static void paint_by_vertices(uint8_t *colors, const starg_mesh *mesh, const starg_bits *seen) {
    const uint32_t *faces = starg_mesh_faces(mesh);
    for (size_t row = starg_bits_rows(seen); row-- > 0;)
        for (size_t f = 0; f < starg_mesh_face_count(mesh); f++)
            if (starg_bits_test(seen, row, faces[3 * f]) &&
                starg_bits_test(seen, row, faces[3 * f + 1]) &&
                starg_bits_test(seen, row, faces[3 * f + 2]))
                starg_distinct_color(row, colors + 3 * f);
}

static starg_status write_seen(cli_session *session, const look *l) {
    const starg_mesh *mesh = starg_solid_mesh(l->solid);
    uint8_t *colors = cli_colors_create(mesh);
    if (colors == NULL)
        return cli_fail_memory(session);
    if (l->wanted->view.target == STARG_TARGET_FACES)
        cli_colors_by_viewer(colors, l->seen);
    else
        paint_by_vertices(colors, mesh, l->seen);
    starg_status status = cli_marks_write(
        session, mesh, colors, NULL, l->wanted->view.target == STARG_TARGET_FACES ? l->seen : NULL,
        l->wanted->output);
    free(colors);
    return status;
}

/* ---- shares ---- */

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The solid angle of a triangle from p [Van Oosterom, Strackee 1983]. */
static double solid_angle(const starg_mesh *mesh, size_t face, const double p[3]) {
    const uint32_t *corner = starg_mesh_faces(mesh) + 3 * face;
    double a[3], b[3], c[3];
    subtract(starg_mesh_vertices(mesh) + 3 * (size_t)corner[0], p, a);
    subtract(starg_mesh_vertices(mesh) + 3 * (size_t)corner[1], p, b);
    subtract(starg_mesh_vertices(mesh) + 3 * (size_t)corner[2], p, c);
    double la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
    double triple = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                    a[2] * (b[0] * c[1] - b[1] * c[0]);
    double sum = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la;
    return 2 * fabs(atan2(triple, sum));
}

/* A face's share counts those that see all of it. `parts` are rows of what is seen of `mesh`, whose
 * triangles belong to the faces of `of`, or to themselves; places are NULL for boxes. */
static starg_status tell_shares(cli_session *session, const starg_bits *faces,
                                const starg_mesh *mesh, const starg_bits *parts, const uint32_t *of,
                                const double *places) {
    size_t count = starg_bits_columns(faces), rows = starg_bits_rows(faces), seen_by_all = 0;
    double *angle = calloc(count + 1, sizeof *angle);
    size_t *times = calloc(count + 1, sizeof *times), none = 0;
    if (angle == NULL || times == NULL) {
        free(angle);
        free(times);
        return cli_fail_memory(session);
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t f = 0; f < count; f++)
            times[f] += starg_bits_test(faces, i, f);
        for (size_t j = 0; places != NULL && j < starg_bits_columns(parts); j++)
            if (starg_bits_test(parts, i, j))
                angle[of != NULL ? of[j] : j] +=
                    solid_angle(mesh, j, places + 3 * i) / (double)rows;
    }
    json_t *list = session->report != NULL ? json_array() : NULL;
    for (size_t f = 0; f < count; f++) {
        double share = (double)times[f] / (double)rows;
        seen_by_all += times[f] == rows;
        none += times[f] == 0;
        if (list == NULL)
            continue;
        json_t *face = json_object();
        cli_put(session, face, "face", json_integer((json_int_t)f));
        cli_put(session, face, "share", cli_json_real(share));
        if (places != NULL)
            cli_put(session, face, "solid_angle", cli_json_real(angle[f]));
        cli_append(session, list, face);
    }
    cli_say(session, "shares        %s seen whole by all of %zu, %zu by none\n",
            cli_count_of(seen_by_all, "face", "faces").text, rows, none);
    if (session->report == NULL)
        for (size_t f = 0; f < count; f++) {
            cli_say(session, "%zu  %.6g", f, (double)times[f] / (double)rows);
            cli_say(session, places != NULL ? "  %.9g sr\n" : "\n", angle[f]);
        }
    if (list != NULL)
        cli_put(session, session->report, "shares", list);
    free(angle);
    free(times);
    return STARG_OK;
}

/* ---- cameras ---- */

/* What one of them sees: whole faces, and the area of all that it sees. */
static void tell_pose(cli_session *session, const values *v, const starg_guards *g,
                      const starg_bits *faces, json_t *list, size_t i, double area) {
    const double *p = g->positions + 3 * i;
    bool inside = starg_solid_contains(session->solid, p);
    (void)v;
    cli_say(session, "%zu  %.17g,%.17g,%.17g  ", i, p[0], p[1], p[2]);
    if (inside)
        cli_say(session, "sees %zu of %zu faces, %.2f %% of the area\n", g->seen_faces[i],
                g->target_count > 0 ? g->target_count : g->face_count, cli_percent(area));
    else
        cli_say(session, "not in the free space: sees nothing\n");
    if (list == NULL)
        return;
    json_t *pose = json_object();
    cli_put(session, pose, "position", cli_json_point(p));
    if (g->directions != NULL)
        cli_put(session, pose, "direction", cli_json_point(g->directions + 3 * i));
    if (g->ups != NULL)
        cli_put(session, pose, "up", cli_json_point(g->ups + 3 * i));
    cli_put(session, pose, "inside", json_boolean(inside));
    cli_put(session, pose, "count", json_integer((json_int_t)g->seen_faces[i]));
    cli_put(session, pose, "area", cli_json_real(area));
    cli_put(session, pose, "faces", cli_json_row(session, faces, i));
    cli_append(session, list, pose);
}

/* The share of the area that one camera sees: of every point, or of faces or their parts. */
static starg_status find_area(cli_session *session, const values *v, const starg_guards *g,
                              const starg_bits *parts, const double *fractions, size_t i,
                              double *area) {
    if (v->view.target != STARG_TARGET_POINTS) {
        double seen = 0, hidden = 0;
        for (size_t j = 0; j < starg_bits_columns(parts); j++)
            *(starg_bits_test(parts, i, j) ? &seen : &hidden) += fractions[j];
        *area = seen / (seen + hidden);
        return STARG_OK;
    }
    starg_guards *alone = NULL;
    const starg_poses one = {.points = g->positions + 3 * i,
                             .directions = g->directions != NULL ? g->directions + 3 * i : NULL,
                             .ups = g->ups != NULL ? g->ups + 3 * i : NULL,
                             .count = 1};
    TRY(starg_guards_audit(session->context, session->solid, &one, &v->view, &alone));
    *area = alone->points_seen;
    starg_guards_free(session->context, alone);
    return STARG_OK;
}

static starg_status tell_all(cli_session *session, const starg_guards *g, const starg_bits *faces,
                             const starg_bits *parts, const double *fractions, const values *v) {
    bool points = v->view.target == STARG_TARGET_POINTS;
    SCOPED_BY(json_decrefp) json_t *list = session->report == NULL ? NULL : json_array();
    for (size_t i = 0; i < g->count; i++) {
        double area = 0;
        TRY(find_area(session, v, g, parts, fractions, i, &area));
        tell_pose(session, v, g, faces, list, i, area);
    }
    cli_say(session, "together  %.2f %% of the area%s; %s not seen whole\n",
            cli_percent(g->coverage_area), points ? ", point by point" : "",
            cli_count_of(g->uncovered_count, "face", "faces").text);
    if (list == NULL)
        return STARG_OK;
    json_t *coverage = json_object();
    if (points)
        cli_put(session, coverage, "points",
                json_pack("{s:f, s:f, s:b}", "seen", g->points_seen, "open", g->points_open,
                          "complete", g->points_complete));
    cli_put(session, coverage, "faces", cli_json_real(g->coverage_faces));
    cli_put(session, coverage, "area", cli_json_real(g->coverage_area));
    cli_put(session, coverage, "uncovered_faces",
            cli_json_indices(session, g->uncovered, g->uncovered_count));
    cli_put(session, session->report, "options",
            cli_json_record(session, starg_visibility_options_fields(), &g->options.visibility));
    cli_put(session, session->report, "points", json_incref(list));
    cli_put(session, session->report, "coverage", coverage);
    return STARG_OK;
}

static starg_status write_parts(cli_session *session, const values *v, const starg_mesh *mesh,
                                const starg_bits *parts) {
    uint8_t *colors = cli_colors_create(mesh);
    if (colors == NULL)
        return cli_fail_memory(session);
    cli_colors_by_viewer(colors, parts);
    starg_status status = cli_marks_write(session, mesh, colors, NULL, parts, v->output);
    free(colors);
    return status;
}

/* What given cameras see: no search. */
static starg_status run_audit(cli_session *session, values *v) {
    SCOPED_BY(starg_guards_drop) starg_guards *guards = NULL;
    SCOPED_BY(starg_bits_drop) starg_bits *faces = NULL;
    SCOPED_BY(starg_bits_drop) starg_bits *parts = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED double *fractions = NULL;
    SCOPED_BY(starg_patches_drop) uint32_t *of = NULL;
    size_t count = 0;
    starg_poses points = {.points = v->from.values, .count = v->from.count};
    TRY(starg_guards_audit(session->context, session->solid,
                           v->poses_file != NULL ? &v->poses : &points, &v->view, &guards));
    TRY(starg_guards_see(session->context, session->solid, guards, &faces));
    TRY(starg_guards_patches(session->context, session->solid, guards, &mesh, &parts, NULL, NULL));
    fractions = cli_area_fractions(mesh, starg_mesh_face_count(mesh));
    if (fractions == NULL)
        return cli_fail_memory(session);
    TRY(cli_tables_write(session, &v->tables, guards));
    if (v->output != NULL)
        TRY(write_parts(session, v, mesh, parts));
    TRY(tell_all(session, guards, faces, parts, fractions, v));
    if (v->share) {
        TRY(starg_guards_patch_faces(session->context, session->solid, guards, &of, &count));
        TRY(tell_shares(session, faces, mesh, parts, of, guards->positions));
    }
    return STARG_OK;
}

static bool audits(const values *v) {
    return v->poses_file != NULL || cli_tables_wanted(&v->tables) ||
           (v->share && v->boxes.count == 0) || v->view.patch > 0 ||
           v->view.target == STARG_TARGET_POINTS;
}

/* ---- what nobody sees ---- */

static const uint8_t UNSEEN[3] = {139, 0, 0}, UNDECIDED[3] = {230, 159, 0};

static const struct {
    starg_face_state state;
    const char *key, *name;
} states[] = {{STARG_FACE_SEEN, "seen", NULL},
              {STARG_FACE_UNSEEN, "unseen", "that no point of the free space sees"},
              {STARG_FACE_UNDECIDED, "undecided", "of which neither is known"}};

static void tell_states(cli_session *session, const starg_solid *solid, const uint8_t *state,
                        const double *fractions) {
    for (size_t i = 0; i < sizeof states / sizeof *states; i++) {
        json_t *faces = session->report != NULL ? json_array() : NULL;
        size_t count = 0;
        double area = 0;
        for (size_t f = 0; f < starg_space_model_faces(solid); f++) {
            if (state[f] != states[i].state)
                continue;
            count++;
            area += fractions[f];
            if (faces != NULL && states[i].name != NULL)
                cli_append(session, faces, json_integer((json_int_t)f));
        }
        cli_say(session, "%-13s %s, %.2f %% of the area%s%s\n", states[i].key,
                cli_count_of(count, "face", "faces").text,
                cli_percent(count == starg_space_model_faces(solid) ? 1 : area),
                states[i].name != NULL ? ", " : "", states[i].name != NULL ? states[i].name : "");
        if (faces != NULL && states[i].name != NULL)
            cli_put(session, session->report, states[i].key, faces);
        else if (faces != NULL) {
            json_decref(faces);
            cli_put(session, session->report, states[i].key, json_integer((json_int_t)count));
        }
    }
}

static starg_status write_states(cli_session *session, const values *v, const starg_solid *solid,
                                 const uint8_t *state) {
    uint8_t *colors = cli_colors_create(starg_solid_mesh(solid));
    if (colors == NULL)
        return cli_fail_memory(session);
    for (size_t f = 0; f < starg_space_model_faces(solid); f++)
        if (state[f] == STARG_FACE_UNSEEN || state[f] == STARG_FACE_UNDECIDED)
            memcpy(colors + 3 * f, state[f] == STARG_FACE_UNSEEN ? UNSEEN : UNDECIDED, 3);
    starg_status status =
        cli_marks_write(session, starg_solid_mesh(solid), colors, NULL, NULL, v->output);
    free(colors);
    return status;
}

static starg_status run_unseen(cli_session *session, values *v, const double *fractions) {
    SCOPED_BY(starg_unseen_drop) uint8_t *state = NULL;
    TRY(starg_unseen(session->context, session->solid, &v->view, 0, v->work, &state));
    tell_states(session, session->solid, state, fractions);
    if (session->report != NULL)
        cli_put(session, session->report, "options",
                cli_json_record(session, starg_visibility_options_fields(), &v->view));
    if (v->output != NULL)
        TRY(write_states(session, v, session->solid, state));
    return STARG_OK;
}

/* ---- the command ---- */

static starg_status check_viewpoints(cli_session *session, const values *v) {
    if (v->unseen && v->boxes.count > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--unseen asks about the whole free space; leave out --box, or say where "
                        "guards may stand by --within");
    if (v->unseen && v->from.count > 1)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--unseen: --from says where the free space is reached from; give one "
                        "point, not %zu",
                        v->from.count);
    if (v->unseen && (audits(v) || v->share))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--unseen is about whole faces and no cameras; leave out --poses, --share, "
                        "--table, --summary, --patch and --target points");
    if (v->unseen)
        return STARG_OK;
    if (v->scene.cell > 0 || v->scene.standoff.count > 0 || v->scene.within.count > 0 ||
        v->scene.without.count > 0)
        return cli_fail(
            session, STARG_ERROR_ARGUMENT,
            "--standoff, --within, --without and --cell are about the free space; add --unseen");
    bool looks = v->view.cone < 360 || v->view.fov[0] > 0;
    if (v->poses_file != NULL && (v->from.count > 0 || v->boxes.count > 0))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--poses names the points to look from; leave out --from and --box");
    if (looks && v->poses_file == NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--cone and --fov need to know where cameras look: give --poses FILE with "
                        "directions");
    if (audits(v) && v->boxes.count > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--table, --summary, --patch and --target points are about what points "
                        "see; leave out --box");
    if ((v->share || audits(v)) && v->view.target == STARG_TARGET_VERTICES)
        return cli_fail(
            session, STARG_ERROR_ARGUMENT,
            "--poses, --share, --table and --summary tell of faces; leave out --target vertices");
    if (v->from.count == 0 && v->boxes.count == 0 && v->poses_file == NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "no viewpoint; add --from X,Y,Z, --poses FILE or --box X0,Y0,Z0,X1,Y1,Z1");
    if (v->from.count > 0 && v->boxes.count > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--from and --box exclude each other: visibility from points is exact, "
                        "from boxes conservative");
    return STARG_OK;
}

static starg_status prepare(cli_session *session, void *data) {
    values *v = data;
    TRY(check_viewpoints(session, v));
    if (v->unseen) /* lent: freed where it comes from */
        v->scene.from = v->from;
    TRY(cli_scene_prepare(session, &v->scene));
    TRY(cli_announce_marks(session, "-o", v->output));
    TRY(cli_tables_announce(session, &v->tables));
    if (v->poses_file != NULL && strcmp(v->poses_file, "-") == 0 &&
        strcmp(session->operands[0], "-") == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "the model and the cameras cannot both come from standard input");
    if (v->poses_file != NULL)
        return starg_poses_read(session->context, v->poses_file, &v->poses);
    return STARG_OK;
}

/* Converts boxes given by opposite corners to lower and upper corners. */
static void order_corners(starg_places *boxes) {
    for (size_t i = 0; i < boxes->count; i++)
        for (size_t k = 6 * i; k < 6 * i + 3; k++) {
            double a = boxes->values[k], b = boxes->values[k + 3];
            boxes->values[k] = a < b ? a : b;
            boxes->values[k + 3] = a < b ? b : a;
        }
}

static starg_status see(cli_session *session, values *v, starg_bits **seen) {
    if (v->boxes.count == 0)
        return starg_visibility(session->context, session->solid, v->from.values, v->from.count,
                                &v->view, seen);
    order_corners(&v->boxes);
    return starg_visibility_region(session->context, session->solid, v->boxes.values,
                                   v->boxes.count, &v->view, seen);
}

static starg_status run(cli_session *session, void *data) {
    values *v = data;
    SCOPED_BY(starg_bits_drop) starg_bits *seen = NULL;
    SCOPED double *fractions = NULL;
    TRY(cli_scene_make(session, &v->scene));
    const starg_solid *solid = session->solid;
    fractions = cli_area_fractions(starg_solid_mesh(solid), starg_space_model_faces(solid));
    if (fractions == NULL)
        return cli_fail_memory(session);
    if (audits(v))
        return run_audit(session, v);
    if (v->unseen)
        return run_unseen(session, v, fractions);
    TRY(see(session, v, &seen));
    look l = {.wanted = v, .solid = solid, .seen = seen, .fractions = fractions};
    TRY(tell(session, &l));
    if (v->share)
        TRY(tell_shares(session, seen, starg_solid_mesh(solid), seen, NULL, NULL));
    if (v->output != NULL)
        TRY(write_seen(session, &l));
    return STARG_OK;
}

static void release(cli_session *session, void *data) {
    values *v = data;
    starg_poses_free(session->context, &v->poses);
    cli_scene_release(&v->scene);
}

const cli_command cli_command_visible = {
    .name = "visible",
    .usage = "MODEL --from X,Y,Z|--poses FILE|--box X0,...,Z1|--unseen [...]",
    .summary = "compute which faces are visible from points or boxes",
    .description =
        "Computes exactly which faces (or vertices) of a solid each point sees. A vertex is "
        "visible if the segment from the point to it meets the boundary nowhere else; a face, if "
        "its three vertices are and the point is on its inner side. A point that is not inside "
        "sees nothing. --json lists the face indices (from 0, in file order). From a box, the "
        "result is conservative: all that any interior point of the box sees, and possibly more. "
        "--poses takes cameras, and says what each of them and what all see; large faces are then "
        "seen "
        "in parts, as by 'guard'. --unseen finds the faces that no point of the free space sees, "
        "and tells those for which "
        "that is proven from those for which neither is known.",
    .examples = "# how much of the room is visible from here\n"
                "starguard visible room.off --from 1,1.7,2\n"
                "# two points, and a coloured model for a mesh viewer\n"
                "starguard visible room.off --from 1,1.7,2 --from 6,1.7,2 -o seen.ply\n"
                "# all that is visible from any point of a box\n"
                "starguard visible room.off --box 0.5,0.5,0.5,1.5,1.5,1.5\n"
                "# indices of the faces that are entirely visible, within 5 units\n"
                "starguard visible room.off --from 1,1.7,2 --faces whole --range 5 --json\n"
                "# what given cameras see, with tables of faces, cameras and groups\n"
                "starguard visible room.off --poses cameras.txt --fov 90,60 --range 8 \\\n"
                "    --table faces.csv --summary cameras.csv\n"
                "# what nobody sees of the room from outside\n"
                "starguard visible room.off --outside --unseen",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    CLI_LIBRARY(starg_visibility_options_fields, view),
    .input = CLI_INPUT_MESH,
    .prepare = prepare,
    .run = run,
    .release = release,
};
