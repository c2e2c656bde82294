/* SPDX-License-Identifier: Apache-2.0 */
/* starguard decompose: cuts a solid into star-shaped pieces. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "starguard/decompose.h"
#include "starguard/picture.h"

static const double APART = 0.18; /* pictures: displacement of the pieces from the common centre */

typedef struct values {
    const char *output, *report, *guards, *tets, *surfaces, *picture, *certificate;
    starg_decompose_options wanted;
    bool binary;
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("PIECES.vtk",
                      "Tetrahedra, labelled by piece, as a VTK unstructured grid "
                      "(for ParaView); '-' writes to standard output.",
                      .group = "output", .brief = "the pieces, as tetrahedra"),
    CLI_TEXT_OPTION("report", report, "PIECES.json",
                    "Guard, size and proof of each piece, and the contact areas between pieces "
                    "(docs/formats.md).",
                    .group = "output", .brief = "guards, volumes and proofs of the pieces"),
    CLI_INPUT_OPTION(
        "guards", guards, "GUARDS.json",
        "Initial guards: a result of 'starguard guard', a skeleton, or text with three numbers per "
        "line. Default for --mode paper: the guards of 'starguard guard'.",
        .group = "input", .brief = "begin with these guards"),
    CLI_INPUT_OPTION("tets", tets, "FILE",
                     "Read tetrahedra from this file instead of MODEL: MEDIT .mesh, .vtk, Gmsh "
                     ".msh, or TetGen .node with its .ele beside it.",
                     .group = "input", .brief = "a tetrahedral mesh in place of a surface"),
    CLI_TEXT_OPTION(
        "surfaces", surfaces, "DIR",
        "Write the closed surface of each piece into this folder (created if missing): "
        "piece_0000.ply, piece_0001.ply, ..., in colour, and all of them as groups of pieces.obj.",
        .group = "output", .brief = "the surface of each piece as a file"),
    CLI_TEXT_OPTION("picture", picture, "FILE.png",
                    "Coloured, slightly exploded view of the pieces.", .group = "output",
                    .brief = "a picture of the pieces"),
    CLI_TEXT_OPTION("certificate", certificate, "FILE",
                    "With --prove: writes why no fewer pieces are possible than lower_bound says, "
                    "for 'starguard verify' (docs/formats.md).",
                    .group = "output"),
    CLI_FLAG_OPTION(
        "binary", binary,
        "Write PIECES.vtk in binary: smaller and faster to read, with the same numbers.",
        .group = "output"),
};

/* ---- the model ---- */

/* The input: one of the two. */
typedef struct subject {
    const char *file;
    starg_mesh *surface; /* as read */
    starg_tetmesh *tets;
} subject;

static void subject_free(subject *s) {
    starg_mesh_free(s->surface);
    starg_tetmesh_free(s->tets);
}

static starg_status read_subject(cli_session *session, const values *v, subject *s) {
    if ((session->operand_count == 0) == (v->tets == NULL))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "give either MODEL (a surface or tetrahedra) or --tets FILE");
    s->file = v->tets != NULL ? v->tets : session->operands[0];
    if (v->tets != NULL)
        return starg_tetmesh_read(session->context, s->file, &s->tets);
    return cli_shape_read(session, s->file, &s->surface, &s->tets);
}

/* ---- cutting ---- */

/* Why the bound holds, if a certificate is wanted. */
typedef struct proof {
    bool wanted;
    char *text;
    size_t size;
} proof;

static starg_status cut_solid(cli_session *session, const starg_solid *solid,
                              const starg_decompose_options *wanted, proof *why,
                              starg_decomposition **out) {
    return why->wanted ? starg_decompose_certified(session->context, solid, wanted, out, &why->text,
                                                   &why->size)
                       : starg_decompose(session->context, solid, wanted, out);
}

static starg_status cut(cli_session *session, const subject *s,
                        const starg_decompose_options *wanted, proof *why,
                        starg_decomposition **out) {
    starg_solid *solid = NULL;
    if (s->tets != NULL)
        return starg_decompose_tetmesh(session->context, s->tets, wanted, out);
    starg_status status = starg_solid_create(session->context, s->surface, &solid);
    /* a surface with holes is filled where its winding number exceeds 1/2; errors without a place
     * are not about holes */
    if (status == STARG_ERROR_MESH && starg_context_error(session->context)->index_count > 0) {
        char reason[400];
        snprintf(reason, sizeof reason, "%s", starg_context_error(session->context)->message);
        TRY(starg_decompose_open_mesh(session->context, s->surface, wanted, out));
        if (!(*out)->joined)
            cli_log(session, STARG_LOG_WARNING,
                    "%s; isosurface stuffing fills the region whose winding number exceeds 1/2 and "
                    "thereby closes holes",
                    reason);
        return STARG_OK;
    }
    if (status == STARG_OK)
        status = cut_solid(session, solid, wanted, why, out);
    starg_solid_free(solid);
    return status;
}

/* ---- report ---- */

static size_t count_single(const starg_decomposition *d) {
    size_t count = 0;
    for (size_t p = 0; p < d->piece_count; p++)
        count += d->pieces[p].tetrahedra == 1;
    return count;
}

static void say_count(cli_session *session, const starg_decomposition *d) {
    cli_say(session, "pieces        %zu", d->piece_count);
    if (d->optimal)
        cli_say(session, ", the fewest possible");
    else if (d->lower_bound > 0)
        cli_say(session, "; at least %zu %s needed, however the model is cut", d->lower_bound,
                d->lower_bound == 1 ? "is" : "are");
    cli_say(session, "\n");
}

/* By rank; the quadratic count is nothing beside the search. */
static double margin_at(const starg_decomposition *d, size_t rank) {
    for (size_t i = 0; i < d->piece_count; i++) {
        size_t below = 0, same = 0;
        for (size_t k = 0; k < d->piece_count; k++) {
            below += d->pieces[k].margin < d->pieces[i].margin;
            same += d->pieces[k].margin == d->pieces[i].margin;
        }
        if (below <= rank && rank < below + same)
            return d->pieces[i].margin;
    }
    return 0;
}

static void say_pieces(cli_session *session, const starg_decomposition *d) {
    say_count(session, d);
    cli_say(session, "star-shaped   %zu (proven)\n", d->strictly_star);
    cli_say(session, "visible       %g %% of the vertices, from their guards\n",
            cli_percent(d->visible_vertices));
    cli_say(session, "tetrahedra    %zu\n", starg_tetmesh_count(d->mesh));
    cli_say(session, "angles        %.3g degrees at least, median %.3g\n", d->smallest_angle,
            d->median_angle);
    if (d->strictly_star == d->piece_count)
        cli_say(session, "margins       %.3g of a piece's size at least, median %.3g\n",
                margin_at(d, 0), margin_at(d, d->piece_count / 2));
    if (d->tetra.surface_kept)
        cli_say(session, "surface       kept\n");
    else
        cli_say(session, "surface       within %.3g of the model's, which is within %.3g of it\n",
                d->tetra.distance, d->tetra.distance_back);
    if (d->faces_kept > 0)
        cli_say(session, "faces kept    %zu of %zu; the others %s\n", d->faces_kept, d->model_faces,
                d->joined ? "are divided where faces touch them"
                          : "intersect, lie inside, or were merged");
    if (d->balls != STARG_BALLS_NONE)
        cli_say(
            session,
            "balls         %zu, no tetrahedron inverted; stretch ratio %.3g on average, above 10 "
            "in %g %% of the volume\n",
            d->piece_count, d->ball_mean, cli_percent(d->ball_above_10));
    if (d->time_limited)
        cli_say_limited(session);
}

/* Reports the file's contents and data about the run. */
static starg_status report_pieces(cli_session *session, const starg_decomposition *d,
                                  const char *file, const values *v) {
    json_t *report = session->report;
    char *text;
    size_t size;
    TRY(starg_decomposition_write_report_memory(session->context, d, file, &text, &size));
    cli_report_take(session, text, size);
    cli_put(session, report, "output", cli_json_text(v->output));
    cli_put(session, report, "volume", cli_json_real(starg_tetmesh_volume(d->mesh)));
    cli_put(session, report, "single_tetrahedra", json_integer((json_int_t)count_single(d)));
    cli_put(session, report, "contacts", json_integer((json_int_t)d->contact_count));
    return STARG_OK;
}

/* ---- surfaces ---- */

/* The surfaces of all pieces, and where each starts. */
typedef struct shells {
    starg_mesh *mesh;
    uint32_t *first;
} shells;

static void shells_free(cli_session *session, shells *s) {
    starg_mesh_free(s->mesh);
    starg_tetmesh_map_free(session->context, s->first);
}

/* The surface of one piece as a separate mesh: its vertices are a contiguous range that starts
 * where the previous piece's range ends. */
static starg_status extract(cli_session *session, const shells *s, size_t piece,
                            uint32_t *next_vertex, starg_mesh **out) {
    size_t count = s->first[piece + 1] - s->first[piece];
    const uint32_t *faces = starg_mesh_faces(s->mesh) + 3 * (size_t)s->first[piece];
    uint32_t base = *next_vertex, *own = malloc((3 * count + 1) * sizeof *own);
    if (own == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < 3 * count; i++) {
        own[i] = faces[i] - base;
        if (faces[i] >= *next_vertex)
            *next_vertex = faces[i] + 1;
    }
    starg_status status =
        starg_mesh_create(session->context, starg_mesh_vertices(s->mesh) + 3 * (size_t)base,
                          *next_vertex - base, own, count, out);
    free(own);
    return status;
}

static starg_status write_coloured(cli_session *session, const starg_mesh *mesh, size_t piece,
                                   const char *name) {
    size_t count = starg_mesh_face_count(mesh);
    uint8_t *colors = malloc(3 * count + 1);
    if (colors == NULL)
        return cli_fail_memory(session);
    for (size_t f = 0; f < count; f++)
        starg_distinct_color(piece, colors + 3 * f);
    starg_status status = cli_marks_write(session, mesh, colors, NULL, NULL, name);
    free(colors);
    return status;
}

static starg_status write_piece(cli_session *session, const shells *s, size_t piece,
                                uint32_t *next_vertex, const char *name) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    TRY(extract(session, s, piece, next_vertex, &mesh));
    TRY(cli_announce(session, name));
    return write_coloured(session, mesh, piece, name);
}

static starg_status write_surfaces(cli_session *session, const starg_decomposition *d,
                                   const shells *s, const char *folder) {
    uint32_t next_vertex = 0;
    size_t size = strlen(folder) + 64;
    SCOPED char *name = malloc(size);
    if (name == NULL)
        return cli_fail_memory(session);
    for (size_t p = 0; p < d->piece_count; p++) {
        snprintf(name, size, "%s/piece_%04zu.ply", folder, p);
        TRY(write_piece(session, s, p, &next_vertex, name));
    }
    snprintf(name, size, "%s/pieces.obj", folder);
    TRY(cli_announce(session, name));
    return starg_decomposition_write_groups(session->context, d,
                                            cli_outputs_place(&session->outputs, name));
}

/* ---- picture ---- */

static void middle_of(const double *vertices, size_t count, double out[3]) {
    double lower[3], upper[3];
    for (int k = 0; k < 3; k++)
        lower[k] = upper[k] = vertices[k];
    for (size_t i = 0; i < 3 * count; i++) {
        lower[i % 3] = fmin(lower[i % 3], vertices[i]);
        upper[i % 3] = fmax(upper[i % 3], vertices[i]);
    }
    for (int k = 0; k < 3; k++)
        out[k] = 0.5 * lower[k] + 0.5 * upper[k];
}

/* Moves the vertices of each piece away from the common centre, and colours its faces. */
static void spread(const shells *s, size_t piece_count, double *vertices, uint8_t *colors) {
    double middle[3];
    size_t next = 0;
    middle_of(vertices, starg_mesh_vertex_count(s->mesh), middle);
    for (size_t p = 0; p < piece_count; p++) {
        size_t base = next;
        double own[3];
        for (size_t i = 3 * (size_t)s->first[p]; i < 3 * (size_t)s->first[p + 1]; i++)
            if (starg_mesh_faces(s->mesh)[i] >= next)
                next = starg_mesh_faces(s->mesh)[i] + (size_t)1;
        for (size_t f = s->first[p]; f < s->first[p + 1]; f++)
            starg_distinct_color(p, colors + 3 * f);
        middle_of(vertices + 3 * base, next - base, own);
        for (size_t i = 3 * base; i < 3 * next; i++)
            vertices[i] += APART * (own[i % 3] - middle[i % 3]);
    }
}

static starg_status write_picture(cli_session *session, const shells *s, size_t piece_count,
                                  const char *name) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *apart = NULL;
    starg_picture_options picture;
    starg_picture_options_default(&picture);
    size_t vertex_count = starg_mesh_vertex_count(s->mesh);
    size_t face_count = starg_mesh_face_count(s->mesh);
    SCOPED double *vertices = malloc((3 * vertex_count + 1) * sizeof *vertices);
    SCOPED uint8_t *colors = malloc(3 * face_count + 1);
    if (vertices == NULL || colors == NULL)
        return cli_fail_memory(session);
    memcpy(vertices, starg_mesh_vertices(s->mesh), 3 * vertex_count * sizeof *vertices);
    spread(s, piece_count, vertices, colors);
    TRY(starg_mesh_create(session->context, vertices, vertex_count, starg_mesh_faces(s->mesh),
                          face_count, &apart));
    picture.face_colors = colors;
    picture.opacity = 1;
    return starg_picture_write(session->context, apart, &picture,
                               cli_outputs_place(&session->outputs, name));
}

/* ---- files ---- */

static starg_status announce_files(cli_session *session, const values *v) {
    if (v->output == NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT, "no output; add -o PIECES.vtk");
    TRY(cli_announce(session, v->output));
    TRY(cli_announce(session, v->report));
    TRY(cli_announce(session, v->certificate));
    if (v->certificate != NULL && !v->wanted.prove)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--certificate says why the bound of --prove holds; add --prove");
    TRY(cli_announce_with_extension(session, "--picture", v->picture, ".png"));
    return cli_announce_folder(session, v->surfaces);
}

/* Standard output comes last: output to it cannot be undone. */
static starg_status write_results(cli_session *session, const values *v, const char *file,
                                  const starg_decomposition *d) {
    bool first_report = v->report != NULL && strcmp(v->report, "-") != 0;
    if (first_report)
        TRY(starg_decomposition_write_report(session->context, d, file,
                                             cli_outputs_place(&session->outputs, v->report)));
    TRY(starg_decomposition_write(session->context, d,
                                  cli_outputs_place(&session->outputs, v->output), v->binary));
    if (v->report != NULL && !first_report)
        TRY(starg_decomposition_write_report(session->context, d, file, v->report));
    return STARG_OK;
}

static starg_status write_files(cli_session *session, const values *v, const char *file,
                                const starg_decomposition *d, const proof *why) {
    starg_status status = STARG_OK;
    shells s = {0};
    if (why->wanted)
        CLI_TRY(starg_certificate_write(session->context, why->text, why->size,
                                        cli_outputs_place(&session->outputs, v->certificate)));
    if (v->surfaces != NULL || v->picture != NULL)
        CLI_TRY(starg_decomposition_surfaces(session->context, d, &s.mesh, &s.first));
    if (v->surfaces != NULL)
        CLI_TRY(write_surfaces(session, d, &s, v->surfaces));
    if (v->picture != NULL)
        CLI_TRY(write_picture(session, &s, d->piece_count, v->picture));
    CLI_TRY(write_results(session, v, file, d));
done:
    shells_free(session, &s);
    return status;
}

/* ---- run ---- */

static starg_status make_options(cli_session *session, const values *v, double **points,
                                 starg_decompose_options *wanted) {
    starg_tetra_options usual;
    starg_tetra_options_default(&usual);
    *wanted = v->wanted;
    /* leaves half of the time for the pieces */
    wanted->tetra.tetgen_limit = fmax(usual.tetgen_limit, session->common.time_limit / 2);
    if (v->guards != NULL)
        TRY(starg_points_read(session->context, v->guards, points, &wanted->guard_count));
    wanted->guards = *points;
    return STARG_OK;
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    starg_decompose_options wanted;
    subject what = {0};
    starg_decomposition *pieces = NULL;
    double *points = NULL;
    proof why = {.wanted = v->certificate != NULL};
    CLI_TRY(announce_files(session, v));
    CLI_TRY(make_options(session, v, &points, &wanted));
    CLI_TRY(read_subject(session, v, &what));
    CLI_TRY(cut(session, &what, &wanted, &why, &pieces));
    CLI_TRY(write_files(session, v, what.file, pieces, &why));
    say_pieces(session, pieces);
    if (session->report != NULL)
        CLI_TRY(report_pieces(session, pieces, what.file, v));
done:
    starg_text_free(session->context, why.text);
    starg_decomposition_free(session->context, pieces);
    starg_points_free(session->context, points);
    subject_free(&what);
    return status;
}

/* ---- the command of a result ---- */

starg_status cli_decompose_command(cli_session *session, const starg_decomposition *d,
                                   const cli_pieces_files *files, char **line) {
    values v = {.report = files->report, .binary = files->binary, .wanted = d->options};
    if (d->options.guard_count > 0)
        v.guards = "GUARDS";
    return cli_command_print(session, &cli_command_decompose, &v, d->seed, d->file, files->pieces,
                             line);
}

const cli_command cli_command_decompose = {
    .name = "decompose",
    .usage = "MODEL -o PIECES.vtk [options]",
    .summary = "cut a solid into few star-shaped pieces",
    .description =
        "Partitions the solid into star-shaped pieces: each has a guard that sees all of it, and "
        "is "
        "made of tetrahedra about the guard. With --mode strict, exact arithmetic proves that "
        "each guard is strictly on the inner side of all faces of its piece. MODEL is a surface or "
        "a tetrahedral mesh, recognized by content.\n"
        "The surface is preserved: its vertices stay where they are, and its faces are subdivided "
        "in their planes where pieces meet. Where it intersects itself, it is cut there, and the "
        "boundary of what it encloses is preserved. Surfaces with holes are filled by isosurface "
        "stuffing instead, with a warning and the distance between both surfaces.\n"
        "The search stops after a fixed amount of work, about 5 seconds, so that the same input "
        "gives the same bytes; --effort quick and best take 2 and 20 seconds, a number is one of "
        "trials. With --time-limit the search continues until that time and returns the best "
        "result; however short the time is, there is one.\n"
        "--prove finds a lower bound that holds for all ways to cut the model into star-shaped "
        "pieces, and ends the search when no more pieces are left than that.",
    .examples = "# pieces with their proofs and a picture\n"
                "starguard decompose model.off -o pieces.vtk --report pieces.json \\\n"
                "    --picture pieces.png\n"
                "# are there fewer? A bound for all partitions, checked independently\n"
                "starguard decompose model.off -o pieces.vtk --report pieces.json --prove \\\n"
                "    --certificate why.txt\n"
                "starguard verify model.off pieces.json pieces.vtk why.txt\n"
                "# the published method, from given guards\n"
                "starguard guard model.off -o guards.json\n"
                "starguard decompose model.off -o pieces.vtk --mode paper --guards guards.json\n"
                "# your own tetrahedra; the surface of each piece as a file\n"
                "starguard decompose --tets solid.msh -o pieces.vtk --surfaces pieces",
    CLI_OPTIONS(options),
    CLI_LIBRARY(starg_decompose_options_fields, wanted),
    .most_operands = 1,
    .run = run,
};
