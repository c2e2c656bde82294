/* SPDX-License-Identifier: Apache-2.0 */
/* Reads PIECES.vtk and PIECES.json back as a decomposition. What the tables do not know is checked
 * here: that both files are of one decomposition, and that its counts agree. Whether pieces are
 * star-shaped is not proven anew; that is what verification is for. */
#include <float.h>
#include <math.h>

#include "core/json.h"
#include "star/decomposition.h"
#include "starguard/verify.h"
#include "tetra/io.h"

static const char STAGE[] = "pieces file";

static starg_status reject(starg_context *context, const char *name, const char *key,
                           const char *expected) {
    return record_reject(context, name, &decomposition_file_fields, key, expected);
}

static starg_status check_contacts(starg_context *context, const char *name,
                                   const starg_decomposition *d) {
    for (size_t i = 0; i < d->contact_count; i++) {
        const starg_piece_contact *c = &d->contacts[i];
        bool ascending = i == 0 || c[-1].first < c->first ||
                         (c[-1].first == c->first && c[-1].second < c->second);
        if (c->first >= c->second || c->second >= d->piece_count || !ascending)
            return reject(context, name, "adjacency", "ascending pairs of two ascending pieces");
    }
    return STARG_OK;
}

static starg_status check_report(starg_context *context, const char *name,
                                 const starg_decomposition *d) {
    size_t star = 0, tetrahedra = 0;
    for (size_t p = 0; p < d->piece_count; p++) {
        star += d->pieces[p].star;
        tetrahedra += d->pieces[p].tetrahedra;
    }
    if (tetrahedra != d->tetrahedra)
        return reject(context, name, "tetrahedra", "the sum of those of the pieces");
    if (star != d->strictly_star)
        return reject(context, name, "strictly_star", "the number of pieces with \"star\": true");
    return check_contacts(context, name, d);
}

static starg_status read_report(starg_context *context, const starg_file_bytes *file,
                                starg_decomposition *d) {
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    TRY(starg_json_parse(context, STAGE, file->name, file->bytes, file->size, &root));
    starg_decompose_options_default(&d->options);
    d->options_known = json_object_get(root, "options") != NULL;
    TRY(record_read(context, file->name, root, &decomposition_file_fields, d));
    TRY(check_report(context, file->name, d));
    d->tetra.generator = d->tetra.surface_kept ? STARG_TETRA_AUTO : STARG_TETRA_STUFFING;
    d->tetra.to_surface = d->tetra.distance;
    d->tetra.from_surface = d->tetra.distance_back;
    return STARG_OK;
}

/* The piece of each tetrahedron; a mesh with the same label everywhere has none of its own. */
static starg_status take_labels(starg_context *context, const starg_file_bytes *report,
                                starg_decomposition *d) {
    const int32_t *regions = starg_tetmesh_regions(d->mesh);
    SCOPED size_t *left = NULL;
    if (d->mesh->count != d->tetrahedra)
        return reject(context, report->name, "tetrahedra", "the number of cells of PIECES.vtk");
    NEW_ZERO(context, STAGE, d->labels, d->tetrahedra);
    NEW_ZERO(context, STAGE, left, d->piece_count);
    for (size_t p = 0; p < d->piece_count; p++)
        left[p] = d->pieces[p].tetrahedra;
    for (size_t t = 0; t < d->tetrahedra; t++) {
        int32_t label = regions != NULL ? regions[t] : 0;
        d->labels[t] = label;
        uint64_t index = t;
        if (label < 0 || (size_t)label >= d->piece_count || left[label]-- == 0)
            return starg_fail_at(context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_TETRAHEDRON,
                                 &index, 1,
                                 "tetrahedron %zu has the label %d, which does not match "
                                 "'%.200s'; the files belong to different decompositions",
                                 t, label, report->name);
    }
    return STARG_OK;
}

/* Images of corners, which the tetrahedral mesh has kept. */
static starg_status take_balls(starg_context *context, const starg_file_bytes *pieces,
                               starg_decomposition *d) {
    if ((d->mesh->corners != NULL) != (d->balls != STARG_BALLS_NONE) ||
        (d->mesh->corners != NULL && d->mesh->turned > 0))
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "'%.200s' and its report differ in maps to balls, or its cells are not "
                          "positively oriented",
                          pieces->name);
    d->ball_corners = d->mesh->corners;
    d->mesh->corners = NULL;
    return STARG_OK;
}

starg_status starg_decomposition_read_memory(starg_context *context, const starg_file_bytes *pieces,
                                             const starg_file_bytes *report,
                                             starg_decomposition **out) {
    SCOPED_BY(starg_decomposition_drop) starg_decomposition *d = NULL;
    *out = NULL;
    NEW_ZERO(context, STAGE, d, 1);
    TRY(read_report(context, report, d));
    if (pieces != NULL) {
        TRY(starg_tetmesh_read_memory(context, pieces->bytes, pieces->size, pieces->name,
                                      &d->mesh));
        TRY(take_labels(context, report, d));
        TRY(take_balls(context, pieces, d));
    }
    *out = d;
    d = NULL;
    return STARG_OK;
}

starg_status starg_decomposition_read(starg_context *context, const char *pieces_path,
                                      const char *report_path, starg_decomposition **out) {
    starg_file_bytes pieces = {.name = pieces_path}, report = {.name = report_path};
    SCOPED char *pieces_bytes = NULL, *report_bytes = NULL;
    *out = NULL;
    TRY(starg_file_read(context, STAGE, report_path, &report_bytes, &report.size));
    if (pieces_path != NULL)
        TRY(starg_file_read(context, STAGE, pieces_path, &pieces_bytes, &pieces.size));
    report.bytes = report_bytes;
    pieces.bytes = pieces_bytes;
    return starg_decomposition_read_memory(context, pieces_path != NULL ? &pieces : NULL, &report,
                                           out);
}

/* ---- either file alone, as it stands: verification checks what it says ---- */

starg_status starg_pieces_mesh_read_memory(starg_context *context, const void *bytes, size_t size,
                                           const char *name, starg_pieces_mesh **out) {
    char shown[256];
    starg_source_shorten(name, shown, sizeof shown);
    const starg_source source = {context, shown, bytes, size};
    SCOPED_BY(tet_builder_free) tet_builder builder = {.points = {.source = &source}};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    *out = NULL;
    IN_STAGE(context, "read");
    TRY(starg_c_locale_enter(context, &locale));
    if (!tet_vtk_matches(&source))
        TRY(starg_source_fail(&source, starg_at_file(), "this is no legacy VTK file"));
    TRY(tet_vtk_read(&builder));
    TRY(tet_builder_check(&builder));
    if (!builder.labelled)
        TRY(starg_source_fail(&source, starg_at_file(),
                              "the cells have no labels: whole numbers \"piece\""));
    NEW(context, STAGE, *out, 1);
    **out = (starg_pieces_mesh){.vertex_count = starg_builder_vertex_count(&builder.points),
                                .vertices = builder.points.vertices.data,
                                .count = tet_builder_count(&builder),
                                .tetrahedra = builder.tetrahedra.data,
                                .labels = builder.regions.data,
                                .corners = builder.corners};
    builder.points.vertices.data = NULL;
    builder.tetrahedra.data = NULL;
    builder.regions.data = NULL;
    builder.corners = NULL;
    return STARG_OK;
}

void starg_pieces_mesh_free(starg_context *context, starg_pieces_mesh *mesh) {
    (void)context;
    if (mesh == NULL)
        return;
    RELEASE(mesh->vertices, mesh->tetrahedra, mesh->labels, mesh->corners, mesh);
}

/* Keys that the table lets be missing, as files of earlier versions are read, and claims need. */
static starg_status require_keys(starg_context *context, const char *name, const json_t *root,
                                 const starg_decomposition *d) {
    static const char *const keys[] = {"smallest_angle", "median_angle"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (json_object_get(root, keys[i]) == NULL)
            return reject(context, name, keys[i], "a number");
    for (size_t p = 0; p < d->piece_count; p++)
        if (d->pieces[p].margin == -DBL_MAX)
            return reject(context, name, "margin", "a number");
    if (d->lower_bound > 0 && json_object_get(root, "optimal") == NULL)
        return reject(context, name, "optimal", "true or false");
    return STARG_OK;
}

/* Takes over the blocks. Of measures that are 0 if they are not told, those that are told are
 * above. */
static starg_pieces_report report_of(starg_decomposition *d) {
    const bool approximated = !d->tetra.surface_kept;
    const starg_pieces_report report = {
        .file = d->file,
        .model_vertices = d->model_vertices,
        .model_faces = d->model_faces,
        .model_tetrahedra = d->model_tetrahedra,
        .mode = d->mode,
        .tetrahedra = d->tetrahedra,
        .piece_count = d->piece_count,
        .pieces = d->pieces,
        .contact_count = d->contact_count,
        .contacts = d->contacts,
        .strictly_star = d->strictly_star,
        .visible_vertices = d->visible_vertices,
        .approximated = approximated,
        .distance = approximated ? d->tetra.distance : 0,
        .distance_back = approximated ? d->tetra.distance_back : INFINITY,
        .flattest = fmax(d->flattest, DBL_MIN),
        .smallest_angle = fmax(d->smallest_angle, DBL_MIN),
        .median_angle = fmax(d->median_angle, DBL_MIN),
        .smallest_angle_made =
            d->smallest_angle_made < 0 ? 0 : fmax(d->smallest_angle_made, DBL_MIN),
        .lower_bound = d->lower_bound,
        .optimal = d->optimal,
        .balls = d->balls != STARG_BALLS_NONE,
        .ball_worst = d->ball_worst,
        .ball_mean = d->ball_mean,
        .ball_above_10 = d->ball_above_10};
    d->file = NULL;
    d->pieces = NULL;
    d->contacts = NULL;
    return report;
}

starg_status starg_pieces_report_read_memory(starg_context *context, const void *bytes, size_t size,
                                             const char *name, starg_pieces_report **out) {
    SCOPED_BY(starg_decomposition_drop) starg_decomposition *d = NULL;
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    *out = NULL;
    NEW_ZERO(context, STAGE, d, 1);
    TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    TRY(record_read(context, name, root, &decomposition_file_fields, d));
    TRY(require_keys(context, name, root, d));
    NEW(context, STAGE, *out, 1);
    **out = report_of(d);
    return STARG_OK;
}

void starg_pieces_report_free(starg_context *context, starg_pieces_report *report) {
    (void)context;
    if (report == NULL)
        return;
    RELEASE(report->file, report->pieces, report->contacts, report);
}

/* ---- writing ---- */

starg_status starg_decomposition_write(starg_context *context,
                                       const starg_decomposition *decomposition, const char *path,
                                       bool binary) {
    starg_tetmesh_write_options options;
    starg_tetmesh_write_options_default(&options);
    options.binary = binary;
    options.labels = decomposition->labels;
    options.corners = decomposition->ball_corners;
    return starg_tetmesh_write(context, decomposition->mesh, path, &options);
}

static bool put(FILE *stream, const void *result, const char *model_file) {
    starg_decomposition shown = *(const starg_decomposition *)result;
    shown.file = (char *)(uintptr_t)model_file;
    return record_put(stream, &decomposition_file_fields, &shown, 0);
}

starg_status starg_decomposition_write_report(starg_context *context,
                                              const starg_decomposition *decomposition,
                                              const char *model_file, const char *path) {
    return starg_json_write(context, STAGE, path, put, decomposition, model_file);
}

starg_status starg_decomposition_write_report_memory(starg_context *context,
                                                     const starg_decomposition *decomposition,
                                                     const char *model_file, char **text,
                                                     size_t *size) {
    return starg_json_write_memory(context, STAGE, put, decomposition, model_file, text, size);
}
