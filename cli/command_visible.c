/* SPDX-License-Identifier: Apache-2.0 */
/* starguard visible: computes what points inside a solid, or boxes in it, see. */
#include <stdlib.h>

#include "commands.h"
#include "extensions.h"
#include "model.h"
#include "numbers.h"
#include "report.h"
#include "scene.h"
#include "starguard/picture.h"
#include "starguard/visibility.h"

typedef struct values {
    starg_places from, boxes;
    starg_visibility_options view;
    const char *output;
    cli_scene scene;
} values;

static const cli_option options[] = {
    CLI_POINTS_OPTION("from", from, "X,Y,Z", "Viewpoint, in model coordinates. Repeatable."),
    CLI_BOXES_OPTION("box", boxes, "X0,Y0,Z0,X1,Y1,Z1",
                     "View box, by two opposite corners, instead of points. Reports the "
                     "potentially visible set: everything else is proven hidden from all interior "
                     "points of the box. The smaller the box, the tighter the set. Repeatable."),
    CLI_OUTPUT_OPTION(
        "FILE.ply",
        "Model with each face in the colour of the first point or box that sees it; unseen faces "
        "are grey. With --target vertices, a face counts if one point sees all its vertices."),
    CLI_SCENE_OPTIONS,
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
    for (size_t face = 0; face < starg_bits_columns(l->seen); face++)
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
    starg_status status =
        cli_mesh_write(session, mesh, STARG_MESH_PLY_BINARY, colors, l->wanted->output);
    free(colors);
    return status;
}

static starg_status prepare(cli_session *session, void *data) {
    const values *v = data;
    if (v->from.count == 0 && v->boxes.count == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "no viewpoint; add --from X,Y,Z or --box X0,Y0,Z0,X1,Y1,Z1");
    if (v->from.count > 0 && v->boxes.count > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--from and --box exclude each other: visibility from points is exact, "
                        "from boxes conservative");
    starg_status status = cli_scene_prepare(session, &v->scene);
    return status != STARG_OK ? status
                              : cli_announce_with_extension(session, "-o", v->output, ".ply");
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
    starg_status status = STARG_OK;
    starg_bits *seen = NULL;
    double *fractions = NULL;
    CLI_TRY(cli_scene_make(session, &v->scene));
    const starg_solid *solid = session->solid;
    CLI_TRY(see(session, v, &seen));
    fractions = cli_area_fractions(starg_solid_mesh(solid));
    if (fractions == NULL) {
        status = cli_fail_memory(session);
        goto done;
    }
    look l = {.wanted = v, .solid = solid, .seen = seen, .fractions = fractions};
    CLI_TRY(tell(session, &l));
    if (v->output != NULL)
        CLI_TRY(write_seen(session, &l));
done:
    free(fractions);
    starg_bits_free(seen);
    return status;
}

const cli_command cli_command_visible = {
    .name = "visible",
    .usage = "MODEL --from X,Y,Z|--box X0,Y0,Z0,X1,Y1,Z1 [-o FILE.ply] [...]",
    .summary = "compute which faces are visible from points or boxes",
    .description =
        "Computes exactly which faces (or vertices) of a solid each point sees. A vertex is "
        "visible if the segment from the point to it meets the boundary nowhere else; a face, if "
        "its three vertices are and the point is on its inner side. A point that is not inside "
        "sees nothing. --json lists the face indices (from 0, in file order). From a box, the "
        "result is conservative: all that any interior point of the box sees, and possibly more.",
    .examples = "# how much of the room is visible from here\n"
                "starguard visible room.off --from 1,1.7,2\n"
                "# two points, and a coloured model for a mesh viewer\n"
                "starguard visible room.off --from 1,1.7,2 --from 6,1.7,2 -o seen.ply\n"
                "# all that is visible from any point of a box\n"
                "starguard visible room.off --box 0.5,0.5,0.5,1.5,1.5,1.5\n"
                "# indices of the faces that are entirely visible, within 5 units\n"
                "starguard visible room.off --from 1,1.7,2 --faces whole --range 5 --json",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, 1),
    CLI_LIBRARY(starg_visibility_options_fields, view),
    .input = CLI_INPUT_MESH,
    .prepare = prepare,
    .run = run,
};
