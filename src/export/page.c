/* SPDX-License-Identifier: Apache-2.0 */
/* Interactive pages: the text before the data, the data, the text after it.
 *
 * Small values are in one block of JSON ("data"), arrays in separate base64 blocks with the names
 * of viewer/data.js. Positions are translated and scaled to about the unit ball (the transform is
 * in the JSON), so that single precision suffices for models of any size and place. Cost: that of
 * the output, and of sorting the faces of pieces. */
#include "starguard/page.h"

#include "core/file.h"
#include "core/json.h"
#include "core/memory.h"
#include "export/export.h"
#include "export/viewer.h"
#include "geometry/vec3.h"
#include "starguard/picture.h"

static const char STAGE[] = "page";
static const char NO_VIEWER[] =
    "this build of starguard has no viewer: Node.js and npm were missing, or npm could not fetch "
    "packages, when it was built; install them (scripts/install-deps.sh build) and build again "
    "(docs/viewer.md)";

enum { MOST_GUARDS = 1 << 20 }; /* each of which is described by itself */

/* Where positions go: (p - center) / scale. */
typedef struct frame {
    double lower[3], upper[3], center[3], scale;
    bool begun;
} frame;

/* What a page is made of. */
typedef struct book {
    const starg_page *page;
    frame frame, image_frame; /* of everything in the model's space; of a map's images */
    starg_piece_surfaces surfaces, map_surfaces;
    size_t *map_tetrahedra; /* of each piece of the map */
    /* As text that JSON can hold: */
    char **names; /* of shapes */
    char *title, *model_name, *command, *pieces_command, *table_command;
    bool broken; /* a part of the description could not be made: memory is out */
} book;

bool starg_page_available(void) {
    return starg_viewer_head_size > 0;
}

/* ---- checks ---- */

static starg_status check_guards(starg_context *context, const starg_page *p) {
    const starg_guards *g = p->guards;
    if (g == NULL)
        return STARG_OK;
    if (g->count > MOST_GUARDS)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "%zu guards are too many for a page", g->count);
    if (p->model != NULL && (g->face_count != starg_mesh_face_count(p->model) ||
                             g->vertex_count != starg_mesh_vertex_count(p->model)))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the guards belong to a model with %zu vertices and %zu faces, but this "
                          "one has %zu and %zu; give the right model",
                          g->vertex_count, g->face_count, starg_mesh_vertex_count(p->model),
                          starg_mesh_face_count(p->model));
    if (p->seen != NULL && (p->model == NULL || starg_bits_rows(p->seen) != g->count ||
                            starg_bits_columns(p->seen) != g->face_count))
        return starg_fail(
            context, STARG_ERROR_ARGUMENT, STAGE,
            "visibility needs one row per guard and one column per face of the model");
    return STARG_OK;
}

static starg_status check_proof(starg_context *context, const starg_page *p) {
    const starg_certificate_outline *proof = p->proof;
    if (proof == NULL)
        return STARG_OK;
    if (p->guards == NULL || p->model == NULL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a certificate needs its guards and their model");
    if (proof->vertex_count != p->guards->vertex_count ||
        proof->face_count != p->guards->face_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the certificate belongs to a model with %zu vertices and %zu faces, but "
                          "this one has %zu and %zu; give the certificate of these guards",
                          proof->vertex_count, proof->face_count, p->guards->vertex_count,
                          p->guards->face_count);
    return STARG_OK;
}

static starg_status check_pieces(starg_context *context, const starg_page *p,
                                 const starg_piece_surfaces *surfaces) {
    if (p->report != NULL && p->pieces == NULL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a pieces report needs its tetrahedra");
    if (p->report != NULL && p->report->piece_count != surfaces->piece_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the report has %zu pieces, the tetrahedra have %zu; give two files of "
                          "the same decomposition",
                          p->report->piece_count, surfaces->piece_count);
    return STARG_OK;
}

/* Files of maps are read without any guarantee. */
static starg_status check_map(starg_context *context, const starg_page *p,
                              const starg_piece_surfaces *surfaces) {
    if (p->map != NULL && p->map->piece_count != surfaces->piece_count)
        return starg_fail(
            context, STARG_ERROR_ARGUMENT, STAGE,
            "the map has guards of %zu pieces, its tetrahedra belong to %zu; check it "
            "with 'starguard verify'",
            p->map->piece_count, surfaces->piece_count);
    return STARG_OK;
}

static starg_status check_frames(starg_context *context, const starg_page *p) {
    if (p->frame_count == 1)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the morph has one frame; it needs at least two");
    for (size_t i = 1; i < p->frame_count; i++) {
        const starg_mesh *a = p->frames[0], *b = p->frames[i];
        size_t faces = starg_mesh_face_count(a);
        if (starg_mesh_vertex_count(a) != starg_mesh_vertex_count(b) ||
            faces != starg_mesh_face_count(b) ||
            memcmp(starg_mesh_faces(a), starg_mesh_faces(b), 3 * faces * sizeof(uint32_t)) != 0)
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "frame %zu and frame 0 differ in vertices or faces; all frames must "
                              "belong to one morph",
                              i);
    }
    return STARG_OK;
}

static starg_status check_ends(starg_context *context, const starg_page *p) {
    const starg_guards *a = p->ends[0], *b = p->ends[1];
    if (a == NULL && b == NULL)
        return STARG_OK;
    if (p->frame_count > 0 && a != NULL && b != NULL && a->count == b->count)
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                      "guards of a morph need its frames, and as many in the last as in the first");
}

static starg_status check_shapes(starg_context *context, const starg_page *p) {
    for (size_t i = 0; i < p->shape_count * p->shape_count; i++)
        if (!isfinite(p->distances[i]))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "the distance of shapes %zu and %zu is not finite",
                              i / p->shape_count, i % p->shape_count);
    return STARG_OK;
}

static starg_status check(starg_context *context, const book *b) {
    const starg_page *p = b->page;
    if (p->model == NULL && p->guards == NULL && p->pieces == NULL && p->map == NULL &&
        p->skeleton == NULL && p->frame_count == 0 && p->shape_count == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "the page has no content");
    TRY(check_guards(context, p));
    TRY(check_proof(context, p));
    TRY(check_pieces(context, p, &b->surfaces));
    TRY(check_map(context, p, &b->map_surfaces));
    TRY(check_frames(context, p));
    TRY(check_ends(context, p));
    return check_shapes(context, p);
}

/* ---- frame ---- */

static void cover_points(frame *f, const double *points, size_t count) {
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++) {
            double x = points[3 * i + k];
            f->lower[k] = f->begun || i > 0 ? fmin(f->lower[k], x) : x;
            f->upper[k] = f->begun || i > 0 ? fmax(f->upper[k], x) : x;
        }
    f->begun = f->begun || count > 0;
}

static void cover_mesh(frame *f, const starg_mesh *mesh) {
    cover_points(f, starg_mesh_vertices(mesh), starg_mesh_vertex_count(mesh));
}

static void close_frame(frame *f) {
    double span[3];
    for (int k = 0; k < 3; k++) {
        span[k] = f->upper[k] - f->lower[k];
        f->center[k] = f->lower[k] + 0.5 * span[k];
    }
    f->scale = 0.5 * hypot(hypot(span[0], span[1]), span[2]);
    if (!(f->scale > 0))
        f->scale = 1;
}

static void find_frame(const starg_page *p, frame *f) {
    if (p->model != NULL)
        cover_mesh(f, p->model);
    if (p->obstacles != NULL)
        cover_mesh(f, p->obstacles);
    if (p->guards != NULL)
        cover_points(f, p->guards->positions, p->guards->count);
    if (p->pieces != NULL)
        cover_points(f, p->pieces->vertices, p->pieces->vertex_count);
    if (p->map != NULL)
        cover_points(f, p->map->vertices, p->map->vertex_count);
    if (p->skeleton != NULL)
        cover_points(f, p->skeleton->positions, p->skeleton->node_count);
    for (size_t i = 0; i < p->frame_count; i++)
        cover_mesh(f, p->frames[i]);
    for (int i = 0; i < 2 && p->ends[0] != NULL; i++)
        cover_points(f, p->ends[i]->positions, p->ends[i]->count);
    close_frame(f);
}

/* The other solid of a map may be of any size, in any place. */
static void find_image_frame(const starg_solid_map *map, frame *f) {
    cover_points(f, map->images, map->vertex_count);
    close_frame(f);
}

/* ---- blocks ---- */

static void put_point(starg_page_block *block, const frame *f, const double point[3]) {
    for (int k = 0; k < 3; k++)
        starg_page_block_float(block, (point[k] - f->center[k]) / f->scale);
}

static void put_points(FILE *stream, const char *name, size_t index, const frame *f,
                       const double *points, size_t count) {
    starg_page_block block = starg_page_block_open(stream, name, index);
    for (size_t i = 0; i < count; i++)
        put_point(&block, f, points + 3 * i);
    starg_page_block_close(&block);
}

static void put_indices(FILE *stream, const char *name, const uint32_t *indices, size_t count) {
    starg_page_block block = starg_page_block_open(stream, name, STARG_PAGE_SINGLE);
    for (size_t i = 0; i < count; i++)
        starg_page_block_uint32(&block, indices[i]);
    starg_page_block_close(&block);
}

/* A row is as many bytes as its columns need; bit i of a byte is column 8 byte + i. */
static void put_bits(FILE *stream, const char *name, const starg_bits *bits) {
    starg_page_block block = starg_page_block_open(stream, name, STARG_PAGE_SINGLE);
    for (size_t row = 0; row < starg_bits_rows(bits); row++)
        for (size_t i = 0; i < (starg_bits_columns(bits) + 7) / 8; i++)
            starg_page_block_byte(&block,
                                  (uint8_t)(starg_bits_row(bits, row)[i / 8] >> (i % 8 * 8)));
    starg_page_block_close(&block);
}

static void put_surface(FILE *stream, const book *b, const starg_mesh *m, const char *points,
                        const char *faces) {
    put_points(stream, points, STARG_PAGE_SINGLE, &b->frame, starg_mesh_vertices(m),
               starg_mesh_vertex_count(m));
    put_indices(stream, faces, starg_mesh_faces(m), 3 * starg_mesh_face_count(m));
}

static void put_guards(FILE *stream, const book *b) {
    const starg_guards *g = b->page->guards;
    put_points(stream, "guard-points", STARG_PAGE_SINGLE, &b->frame, g->positions, g->count);
    if (g->tour.point_count > 0)
        put_points(stream, "guard-tour", STARG_PAGE_SINGLE, &b->frame, g->tour.points,
                   g->tour.point_count);
    if (b->page->seen != NULL)
        put_bits(stream, "guard-seen", b->page->seen);
    if (b->page->proof != NULL)
        put_points(stream, "proof-cells", STARG_PAGE_SINGLE, &b->frame, b->page->proof->cells,
                   2 * b->page->proof->cell_count);
}

/* Those of the vertices that the surfaces use. */
static void put_used(FILE *stream, const char *name, size_t index, const frame *f,
                     const starg_piece_surfaces *s, const double *vertices) {
    starg_page_block block = starg_page_block_open(stream, name, index);
    for (size_t i = 0; i < s->vertex_count; i++)
        put_point(&block, f, vertices + 3 * (size_t)s->vertices[i]);
    starg_page_block_close(&block);
}

static void put_map(FILE *stream, const book *b) {
    const starg_solid_map *map = b->page->map;
    const starg_piece_surfaces *s = &b->map_surfaces;
    put_used(stream, "map-points", 0, &b->frame, s, map->vertices);
    put_used(stream, "map-points", 1, &b->image_frame, s, map->images);
    put_indices(stream, "map-faces", s->faces, 3 * s->first_face[s->piece_count]);
    put_points(stream, "map-guards", 0, &b->frame, map->guards, map->piece_count);
    put_points(stream, "map-guards", 1, &b->image_frame, map->guard_images, map->piece_count);
}

static void put_pieces(FILE *stream, const book *b) {
    const starg_piece_surfaces *s = &b->surfaces;
    starg_page_block block;
    put_used(stream, "piece-points", STARG_PAGE_SINGLE, &b->frame, s, b->page->pieces->vertices);
    put_indices(stream, "piece-faces", s->faces, 3 * s->first_face[s->piece_count]);
    if (b->page->report == NULL)
        return;
    block = starg_page_block_open(stream, "piece-guards", STARG_PAGE_SINGLE);
    for (size_t i = 0; i < s->piece_count; i++)
        put_point(&block, &b->frame, b->page->report->pieces[i].guard);
    starg_page_block_close(&block);
}

static void put_skeleton(FILE *stream, const book *b) {
    const starg_skeleton *s = b->page->skeleton;
    put_points(stream, "skeleton-points", STARG_PAGE_SINGLE, &b->frame, s->positions,
               s->node_count);
    put_indices(stream, "skeleton-edges", s->edges, 2 * s->edge_count);
    if (s->radii == NULL)
        return;
    starg_page_block block = starg_page_block_open(stream, "skeleton-radii", STARG_PAGE_SINGLE);
    for (size_t i = 0; i < s->node_count; i++)
        starg_page_block_float(&block, s->radii[i] / b->frame.scale);
    starg_page_block_close(&block);
}

static void put_frames(FILE *stream, const book *b) {
    const starg_mesh *first = b->page->frames[0];
    put_indices(stream, "morph-faces", starg_mesh_faces(first), 3 * starg_mesh_face_count(first));
    for (size_t i = 0; i < b->page->frame_count; i++)
        put_points(stream, "morph-points", i, &b->frame, starg_mesh_vertices(b->page->frames[i]),
                   starg_mesh_vertex_count(first));
    for (size_t i = 0; i < 2 && b->page->ends[0] != NULL; i++)
        put_points(stream, "morph-guards", i, &b->frame, b->page->ends[i]->positions,
                   b->page->ends[i]->count);
}

static void put_shapes(FILE *stream, const starg_page *p) {
    starg_page_block block = starg_page_block_open(stream, "shape-distances", STARG_PAGE_SINGLE);
    for (size_t i = 0; i < p->shape_count * p->shape_count; i++)
        starg_page_block_double(&block, p->distances[i]);
    starg_page_block_close(&block);
    for (size_t i = 0; i < p->shape_count; i++) {
        if (p->shapes[i].png == NULL)
            continue;
        block = starg_page_block_open(stream, "shape-picture", i);
        starg_page_block_bytes(&block, p->shapes[i].png, p->shapes[i].png_size);
        starg_page_block_close(&block);
    }
}

static void put_blocks(FILE *stream, const book *b) {
    if (b->page->model != NULL)
        put_surface(stream, b, b->page->model, "model-points", "model-faces");
    if (b->page->obstacles != NULL)
        put_surface(stream, b, b->page->obstacles, "obstacle-points", "obstacle-faces");
    if (b->page->guards != NULL)
        put_guards(stream, b);
    if (b->page->pieces != NULL)
        put_pieces(stream, b);
    if (b->page->map != NULL)
        put_map(stream, b);
    if (b->page->skeleton != NULL)
        put_skeleton(stream, b);
    if (b->page->frame_count > 0)
        put_frames(stream, b);
    if (b->page->shape_count > 0)
        put_shapes(stream, b->page);
}

/* ---- description ---- */

static void put(book *b, json_t *object, const char *key, json_t *value) {
    b->broken |= json_object_set_new(object, key, value) != 0;
}

static void append(book *b, json_t *array, json_t *value) {
    b->broken |= json_array_append_new(array, value) != 0;
}

static json_t *point_json(const double p[3]) {
    return json_pack("[f, f, f]", p[0], p[1], p[2]);
}

static json_t *model_json(book *b) {
    const starg_mesh *m = b->page->model;
    return json_pack("{s:s?, s:I, s:I}", "name", b->model_name, "vertices",
                     (json_int_t)starg_mesh_vertex_count(m), "faces",
                     (json_int_t)starg_mesh_face_count(m));
}

static json_t *uncovered_json(book *b) {
    json_t *list = json_array();
    for (size_t i = 0; i < b->page->guards->uncovered_count; i++)
        append(b, list, json_integer(b->page->guards->uncovered[i]));
    return list;
}

/* Unit vectors to the corners of a rectangular view, in turn: the edges in which its sides meet. */
static json_t *corners_json(book *b, size_t i) {
    static const int sides[4][2] = {{0, 2}, {2, 1}, {1, 3}, {3, 0}};
    static const double usual_up[3] = {0, 1, 0};
    const starg_guards *g = b->page->guards;
    const double *ahead = g->directions + 3 * i, *up = g->ups + 3 * i;
    double planes[4][3];
    json_t *corners = json_array();
    if (vec3_length(up) == 0)
        up = usual_up;
    starg_frustum(ahead, up, g->options.visibility.fov, planes);
    for (int corner = 0; corner < 4; corner++) {
        double ray[3];
        vec3_cross(planes[sides[corner][0]], planes[sides[corner][1]], ray);
        double length = vec3_length(ray) * (vec3_dot(ray, ahead) < 0 ? -1 : 1);
        for (int k = 0; k < 3; k++)
            ray[k] /= length;
        append(b, corners, point_json(ray));
    }
    return corners;
}

static json_t *guard_json(book *b, size_t i) {
    const starg_guards *g = b->page->guards;
    size_t seen = b->page->seen != NULL ? starg_bits_count(b->page->seen, i) : g->seen_faces[i];
    json_t *guard = json_pack("{s:o, s:I, s:i}", "position", point_json(g->positions + 3 * i),
                              "faces", (json_int_t)seen, "level", g->levels[i]);
    if (g->directions != NULL)
        put(b, guard, "direction", point_json(g->directions + 3 * i));
    if (g->directions != NULL && g->ups != NULL && g->options.visibility.fov[0] > 0)
        put(b, guard, "corners", corners_json(b, i));
    if (g->curve_faces != NULL)
        put(b, guard, "covered", json_pack("[f, f]", g->curve_faces[i], g->curve_area[i]));
    return guard;
}

static json_t *proof_json(book *b) {
    const starg_certificate_outline *proof = b->page->proof;
    json_t *list = json_array();
    for (size_t i = 0; i < proof->witness_count; i++)
        append(b, list, json_integer(proof->witnesses[i]));
    return json_pack("{s:I, s:b, s:o}", "bound", (json_int_t)proof->bound, "vertices",
                     (int)(proof->target == STARG_TARGET_VERTICES), "witnesses", list);
}

/* Pairs of work and guards. */
static json_t *steps_json(book *b) {
    const starg_guards *g = b->page->guards;
    json_t *list = json_array();
    for (size_t i = 0; i < g->step_count; i++)
        append(b, list,
               json_pack("[I, I]", (json_int_t)g->step_work[i], (json_int_t)g->step_guards[i]));
    return list;
}

static json_t *guards_json(book *b) {
    const starg_guards *g = b->page->guards;
    const char *method =
        starg_fields_word(starg_guard_options_fields(), "method", g->options.method);
    json_t *list = json_array();
    for (size_t i = 0; i < g->count; i++)
        append(b, list, guard_json(b, i));
    json_t *guards = json_pack(
        "{s:o, s:I, s:s, s:f, s:f, s:I, s:I, s:b, s:I, s:f, s:f, s:b, s:o}", "list", list, "faces",
        (json_int_t)g->face_count, "method", method, "coverage_faces", g->coverage_faces,
        "coverage_area", g->coverage_area, "lower_bound", (json_int_t)g->lower_bound,
        "lower_bound_everywhere", (json_int_t)g->lower_bound_everywhere, "optimal_everywhere",
        (int)g->optimal_everywhere, "max_guards", (json_int_t)g->options.max_guards, "area_bound",
        g->area_bound, "area_bound_everywhere", g->area_bound_everywhere, "seen",
        (int)(b->page->seen != NULL), "uncovered", uncovered_json(b));
    if (g->options.visibility.cone < 360)
        put(b, guards, "cone", json_real(g->options.visibility.cone));
    if (g->options.visibility.patch > 0 && !g->space.outside && !g->space.soup)
        put(b, guards, "hollow", json_true()); /* a room, more likely than a body */
    if (g->tour.point_count > 0)
        put(b, guards, "tour", json_real(g->tour.length));
    if (g->step_count > 0)
        put(b, guards, "search", steps_json(b));
    if (b->page->proof != NULL)
        put(b, guards, "proof", proof_json(b));
    if (b->command != NULL)
        put(b, guards, "command", json_string(b->command));
    return guards;
}

static json_t *piece_json(book *b, size_t i) {
    const starg_piece_surfaces *s = &b->surfaces;
    json_t *piece =
        json_pack("{s:I}", "faces", (json_int_t)(s->first_face[i + 1] - s->first_face[i]));
    if (b->page->report == NULL)
        return piece;
    const starg_piece *told = &b->page->report->pieces[i];
    put(b, piece, "guard", point_json(told->guard));
    put(b, piece, "tetrahedra", json_integer((json_int_t)told->tetrahedra));
    put(b, piece, "volume", json_real(told->volume));
    put(b, piece, "star", json_boolean(told->star));
    return piece;
}

static json_t *pieces_json(book *b) {
    json_t *list = json_array();
    for (size_t i = 0; i < b->surfaces.piece_count; i++)
        append(b, list, piece_json(b, i));
    const starg_pieces_report *report = b->page->report;
    json_t *pieces =
        json_pack("{s:o, s:I, s:b, s:I, s:b}", "list", list, "tetrahedra",
                  (json_int_t)b->page->pieces->count, "reported", (int)(report != NULL),
                  "lower_bound", (json_int_t)(report != NULL ? report->lower_bound : 0), "optimal",
                  (int)(report != NULL && report->optimal));
    if (b->pieces_command != NULL)
        put(b, pieces, "command", json_string(b->pieces_command));
    return pieces;
}

static json_t *map_json(book *b) {
    const starg_solid_map *map = b->page->map;
    const starg_piece_surfaces *s = &b->map_surfaces;
    json_t *list = json_array();
    for (size_t i = 0; i < s->piece_count; i++)
        append(b, list,
               json_pack("{s:I, s:I}", "faces",
                         (json_int_t)(s->first_face[i + 1] - s->first_face[i]), "tetrahedra",
                         (json_int_t)b->map_tetrahedra[i]));
    return json_pack("{s:o, s:I, s:f, s:f, s:f}", "list", list, "tetrahedra",
                     (json_int_t)map->count, "mean", map->mean, "worst", map->worst, "above_10",
                     map->above_10);
}

static json_t *skeleton_json(const starg_skeleton *s) {
    return json_pack("{s:I, s:I, s:b}", "nodes", (json_int_t)s->node_count, "edges",
                     (json_int_t)s->edge_count, "radii", (int)(s->radii != NULL));
}

static json_t *morph_json(const starg_page *p) {
    size_t guards = p->ends[0] != NULL ? p->ends[0]->count : 0;
    return json_pack("{s:I, s:I, s:I, s:I}", "guards", (json_int_t)guards, "frames",
                     (json_int_t)p->frame_count, "vertices",
                     (json_int_t)starg_mesh_vertex_count(p->frames[0]), "faces",
                     (json_int_t)starg_mesh_face_count(p->frames[0]));
}

static json_t *shapes_json(book *b) {
    json_t *list = json_array();
    for (size_t i = 0; i < b->page->shape_count; i++)
        append(b, list,
               json_pack("{s:s, s:b}", "name", b->names[i], "picture",
                         (int)(b->page->shapes[i].png != NULL)));
    return list;
}

/* Colours of guards and pieces, those of pictures. */
static json_t *colors_json(book *b) {
    size_t count = b->page->guards != NULL ? b->page->guards->count : 0;
    if (count < b->surfaces.piece_count)
        count = b->surfaces.piece_count;
    if (count < b->map_surfaces.piece_count)
        count = b->map_surfaces.piece_count;
    if (b->page->ends[0] != NULL && count < b->page->ends[0]->count)
        count = b->page->ends[0]->count;
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) {
        uint8_t rgb[3];
        char text[8];
        starg_distinct_color(i, rgb);
        snprintf(text, sizeof text, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
        append(b, list, json_string(text));
    }
    return list;
}

static json_t *describe(book *b) {
    const starg_page *p = b->page;
    json_t *root =
        json_pack("{s:s, s:i, s:s, s:{s:o, s:f}, s:o}", "format", "starguard-page", "version", 1,
                  "title", b->title, "frame", "center", point_json(b->frame.center), "scale",
                  b->frame.scale, "colors", colors_json(b));
    if (p->model != NULL)
        put(b, root, "model", model_json(b));
    if (p->obstacles != NULL)
        put(b, root, "obstacles", json_integer((json_int_t)starg_mesh_face_count(p->obstacles)));
    if (p->guards != NULL)
        put(b, root, "guards", guards_json(b));
    if (p->pieces != NULL)
        put(b, root, "pieces", pieces_json(b));
    if (p->map != NULL)
        put(b, root, "map", map_json(b));
    if (p->skeleton != NULL)
        put(b, root, "skeleton", skeleton_json(p->skeleton));
    if (p->frame_count > 0)
        put(b, root, "morph", morph_json(p));
    if (p->shape_count > 0)
        put(b, root, "shapes", shapes_json(b));
    if (b->table_command != NULL)
        put(b, root, "table_command", json_string(b->table_command));
    return root;
}

/* ---- the page ---- */

static starg_status copy_names(starg_context *context, book *b) {
    const starg_page *p = b->page;
    const char *title = p->title != NULL ? p->title : p->model_name;
    TRY(starg_json_path(context, STAGE, title != NULL ? title : "starguard", &b->title));
    TRY(starg_json_path(context, STAGE, p->model_name, &b->model_name));
    TRY(starg_json_path(context, STAGE, p->command, &b->command));
    TRY(starg_json_path(context, STAGE, p->pieces_command, &b->pieces_command));
    TRY(starg_json_path(context, STAGE, p->table_command, &b->table_command));
    NEW_ZERO(context, STAGE, b->names, p->shape_count);
    for (size_t i = 0; i < p->shape_count; i++)
        TRY(starg_json_path(context, STAGE, p->shapes[i].name, &b->names[i]));
    return STARG_OK;
}

static void free_book(book *b) {
    for (size_t i = 0; b->names != NULL && i < b->page->shape_count; i++)
        RELEASE(b->names[i]);
    RELEASE(b->names, b->map_tetrahedra, b->title, b->model_name, b->command, b->pieces_command,
            b->table_command);
    starg_piece_surfaces_free(&b->surfaces);
    starg_piece_surfaces_free(&b->map_surfaces);
}

/* False when memory is out; errors of the stream are found when it is committed. */
static bool put_page(FILE *stream, book *b) {
    fwrite(starg_viewer_head, 1, starg_viewer_head_size, stream);
    if (!starg_page_json(stream, "data", describe(b)) || b->broken)
        return false;
    put_blocks(stream, b);
    fwrite(starg_viewer_tail, 1, starg_viewer_tail_size, stream);
    return true;
}

static starg_status take_map(starg_context *context, const starg_solid_map *map, book *b) {
    const starg_pieces_mesh pieces = {.vertex_count = map->vertex_count,
                                      .count = map->count,
                                      .vertices = map->vertices,
                                      .tetrahedra = map->tetrahedra,
                                      .labels = map->labels};
    TRY(starg_piece_surfaces_create(context, &pieces, &b->map_surfaces));
    NEW_ZERO(context, STAGE, b->map_tetrahedra, b->map_surfaces.piece_count);
    for (size_t t = 0; t < map->count; t++)
        b->map_tetrahedra[map->labels[t]]++;
    find_image_frame(map, &b->image_frame);
    return STARG_OK;
}

starg_status starg_page_write(starg_context *context, const starg_page *page, const char *path) {
    SCOPED_BY(free_book) book b = {.page = page};
    SCOPED_BY(starg_output_discard) starg_output output = {0};
    if (!starg_page_available())
        return starg_fail(context, STARG_ERROR_WRITE, STAGE, "%s", NO_VIEWER);
    if (page->pieces != NULL)
        TRY(starg_piece_surfaces_create(context, page->pieces, &b.surfaces));
    if (page->map != NULL)
        TRY(take_map(context, page->map, &b));
    TRY(check(context, &b));
    find_frame(page, &b.frame);
    TRY(copy_names(context, &b));
    TRY(starg_output_open(context, STAGE, path, &output));
    if (!put_page(output.stream, &b))
        return starg_fail_memory(context, STAGE);
    TRY(starg_check_cancel(context, STAGE));
    return starg_output_commit(&output);
}
