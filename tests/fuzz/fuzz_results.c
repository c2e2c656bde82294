/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a result file, of each kind: read or rejected with a message; what is read can be
 * written, and read and written again as the same bytes, by its table and by the library's calls.
 * Descriptors are made into signatures at distance 0 from themselves, maps put every vertex on the
 * target, and pieces are verified against a tetrahedron, whatever the verdict. */
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "guard/stages.h"
#include "morph/surface_map.h"
#include "records.h"
#include "shape/measures.h"
#include "star/decomposition.h"
#include "starguard/starguard.h"
#include "support.h"

/* ---- by tables ---- */

static char *written(const starg_fields *fields, const void *record, size_t *size) {
    char *text = NULL;
    FILE *stream = open_memstream(&text, size);
    fuzz_require(stream != NULL && record_put(stream, fields, record, 0) && fclose(stream) == 0,
                 "what was read can be written");
    return text;
}

static void check_table(starg_context *context, const starg_fields *fields,
                        const unsigned char *data, size_t size) {
    record_space first = {{0}}, second = {{0}};
    starg_status status = record_parse(context, fields, (const char *)data, size, &first);
    if (status == STARG_OK) {
        size_t sizes[2];
        char *text = written(fields, &first, &sizes[0]);
        fuzz_require_ok(context, record_parse(context, fields, text, sizes[0], &second),
                        "what was written can be read");
        char *again = written(fields, &second, &sizes[1]);
        fuzz_require(sizes[0] == sizes[1] && memcmp(text, again, sizes[0]) == 0 &&
                         record_equal(fields, &first, &second),
                     "reading and writing keeps everything");
        free(text);
        free(again);
    } else {
        fuzz_require_explained(context, status);
    }
    record_release(context, fields, &first);
    record_release(context, fields, &second);
}

/* ---- guards and pieces ---- */

/* A text of the library is that of another call; both are freed. */
static void require_same(starg_context *context, char *text, char *again) {
    fuzz_require(strcmp(text, again) == 0, "reading and writing keeps everything");
    starg_text_free(context, text);
    starg_text_free(context, again);
}

static void check_guards(starg_context *context, const unsigned char *data, size_t size) {
    starg_guards *guards = NULL, *second = NULL;
    char *text, *again;
    starg_status status = starg_guards_read_memory(context, data, size, "fuzz.json", &guards);
    if (status != STARG_OK) {
        fuzz_require_explained(context, status);
        return;
    }
    fuzz_require_ok(context, starg_guards_write_memory(context, guards, guards->file, &text, &size),
                    "guards can be written");
    fuzz_require_ok(context, starg_guards_read_memory(context, text, size, "again", &second),
                    "and read");
    fuzz_require_ok(context,
                    starg_guards_write_memory(context, second, second->file, &again, &size),
                    "and written");
    require_same(context, text, again);
    starg_guards_free(context, guards);
    starg_guards_free(context, second);
}

/* The file of a report of one tetrahedron. */
static const char ONE_PIECE[] =
    "# vtk DataFile Version 3.0\nstarguard\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";

static void check_decomposition(starg_context *context, const unsigned char *data, size_t size) {
    const starg_file_bytes pieces = {ONE_PIECE, sizeof ONE_PIECE - 1, "pieces"};
    starg_file_bytes report = {data, size, "report"};
    starg_decomposition *d = NULL, *second = NULL;
    char *text, *again;
    starg_status status = starg_decomposition_read_memory(context, &pieces, &report, &d);
    if (status != STARG_OK) {
        fuzz_require_explained(context, status);
        return;
    }
    fuzz_require_ok(
        context, starg_decomposition_write_report_memory(context, d, d->file, &text, &report.size),
        "a report can be written");
    report.bytes = text;
    fuzz_require_ok(context, starg_decomposition_read_memory(context, &pieces, &report, &second),
                    "and read");
    fuzz_require_ok(
        context,
        starg_decomposition_write_report_memory(context, second, second->file, &again, &size),
        "and written");
    require_same(context, text, again);
    starg_decomposition_free(context, d);
    starg_decomposition_free(context, second);
}

/* ---- what the verifier reads ---- */

/* One piece about the middle, as far as it goes. */
static void verify(starg_context *context, const starg_pieces_mesh *mesh) {
    starg_piece piece = {
        .guard = {0.25, 0.25, 0.25}, .radius = 0.1, .tetrahedra = mesh->count, .star = true};
    const starg_pieces_report report = {.mode = STARG_DECOMPOSE_PAPER,
                                        .tetrahedra = mesh->count,
                                        .piece_count = 1,
                                        .pieces = &piece,
                                        .strictly_star = 1};
    shape tetrahedron = shape_tetrahedron();
    starg_mesh *model = fuzz_mesh(context, &tetrahedron);
    starg_verdict *verdict = NULL;
    fuzz_require_ok(context, starg_verify_pieces(context, model, mesh, &report, &verdict),
                    "pieces can be verified");
    starg_verdict_free(context, verdict);
    starg_mesh_free(model);
    shape_free(&tetrahedron);
}

static void check_verified(starg_context *context, const unsigned char *data, size_t size) {
    starg_pieces_mesh *mesh = NULL;
    starg_pieces_report *report = NULL;
    starg_status status = starg_pieces_mesh_read_memory(context, data, size, "fuzz", &mesh);
    if (status == STARG_OK)
        verify(context, mesh);
    else
        fuzz_require_explained(context, status);
    status = starg_pieces_report_read_memory(context, data, size, "fuzz", &report);
    if (status != STARG_OK)
        fuzz_require_explained(context, status);
    starg_pieces_mesh_free(context, mesh);
    starg_pieces_report_free(context, report);
}

/* ---- descriptors ---- */

static void check_signature(starg_context *context, const starg_descriptor *descriptor,
                            starg_signature_kind kind) {
    starg_signature *signature = NULL;
    double distance = 0;
    starg_status status = starg_signature_of_descriptor(context, descriptor, kind, &signature);
    if (status == STARG_OK)
        status = starg_signature_distance(context, signature, signature, &distance);
    fuzz_require(status == STARG_OK || status == STARG_ERROR_FORMAT, "signatures are made or not");
    fuzz_require(distance == 0, "nothing is unlike itself");
    starg_signature_free(context, signature);
}

static void check_descriptor(starg_context *context, const unsigned char *data, size_t size) {
    starg_descriptor *descriptor = NULL;
    starg_status status =
        starg_descriptor_read_memory(context, data, size, "fuzz.json", &descriptor);
    if (status == STARG_OK) {
        check_signature(context, descriptor, STARG_SIGNATURE_STAR);
        check_signature(context, descriptor, STARG_SIGNATURE_PAPER);
    } else {
        fuzz_require_explained(context, status);
    }
    starg_descriptor_free(context, descriptor);
}

/* ---- maps ---- */

static void check_images(const starg_map *map, const starg_mesh *a, const starg_mesh *b) {
    double positions[3 * FUZZ_VERTICES], lower[3], upper[3];
    size_t vertices = starg_mesh_vertex_count(a);
    fuzz_require(map->vertex_count == vertices && map->kind == STARG_MAP_GIVEN,
                 "the map is one of these meshes");
    starg_mesh_bounds(b, lower, upper);
    starg_map_positions(map, b, positions);
    for (size_t v = 0; v < vertices; v++)
        fuzz_require(map->faces[v] < starg_mesh_face_count(b), "faces are in range");
    for (size_t i = 0; i < 3 * vertices; i++)
        fuzz_require(positions[i] >= lower[i % 3] - 1e-6 && positions[i] <= upper[i % 3] + 1e-6,
                     "images are near the target");
}

/* Between a tetrahedron and a cube. */
static void check_map(starg_context *context, const unsigned char *data, size_t size) {
    shape from = shape_tetrahedron(), to = shape_cube(1);
    starg_mesh *a = fuzz_mesh(context, &from), *b = fuzz_mesh(context, &to);
    starg_map *map = NULL;
    starg_status status = starg_map_read(context, fuzz_file(".json", data, size), a, b, &map);
    if (status == STARG_OK)
        check_images(map, a, b);
    else
        fuzz_require_explained(context, status);
    starg_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    shape_free(&from);
    shape_free(&to);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    const starg_fields *const tables[] = {&guards_file_fields, &decomposition_file_fields,
                                          &descriptor_file_fields, &map_file_fields};
    starg_context *context = fuzz_context();
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        check_table(context, tables[i], data, size);
    check_guards(context, data, size);
    check_decomposition(context, data, size);
    check_verified(context, data, size);
    check_descriptor(context, data, size);
    check_map(context, data, size);
    fuzz_context_end(context);
    return 0;
}
