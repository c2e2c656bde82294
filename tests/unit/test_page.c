/* SPDX-License-Identifier: Apache-2.0 */
/* Pages: independent code reads back their contents (blocks, base64, JSON); names are tested with
 * everything that HTML could take for markup, surfaces of pieces against the volumes of their
 * tetrahedra; and invalid input is rejected. Without a viewer in the build, pages are refused. */
#include "support.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/rng.h"
#include "export/export.h"
#include "models.h"
#include "starguard/page.h"
#include "starguard/picture.h"
#include "tetrahedra.h"

static char folder[64];
static char page_path[128];

static int make_folder(void **state) {
    (void)state;
    strcpy(folder, "/tmp/test_page_XXXXXX");
    if (mkdtemp(folder) == NULL)
        return 1;
    snprintf(page_path, sizeof page_path, "%s/page.html", folder);
    return 0;
}

static int remove_folder(void **state) {
    (void)state;
    return rmdir(folder); /* fails if a test has left anything */
}

static char *read_path(const char *path, size_t *size) {
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    *size = (size_t)info.st_size;
    char *text = calloc(*size + 1, 1);
    FILE *file = fopen(path, "rb");
    assert_true(text != NULL && file != NULL);
    assert_int_equal(fread(text, 1, *size, file), *size);
    fclose(file);
    return text;
}

/* The page as text; removes the file. */
static char *write_page(starg_context *context, const starg_page *page) {
    size_t size;
    test_ok(context, starg_page_write(context, page, page_path));
    char *text = read_path(page_path, &size);
    assert_int_equal(strlen(text), size);
    assert_int_equal(unlink(page_path), 0);
    return text;
}

/* Text of the element with that id, as the browser sees it. */
static char *block_of(const char *text, const char *id) {
    char mark[64];
    snprintf(mark, sizeof mark, " id=\"%s\">", id);
    const char *begin = strstr(text, mark);
    if (begin == NULL)
        return NULL;
    begin += strlen(mark);
    const char *end = strstr(begin, "</script");
    assert_non_null(end);
    return strndup(begin, (size_t)(end - begin));
}

static int digit(char c) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *found = strchr(digits, c);
    assert_true(c != '\0' && found != NULL);
    return (int)(found - digits);
}

/* Base64, bit by bit. */
static uint8_t *decode(const char *page, const char *id, size_t *size) {
    char *text = block_of(page, id);
    assert_non_null(text);
    assert_int_equal(strlen(text) % 4, 0);
    uint8_t *bytes = calloc(strlen(text) + 1, 1);
    assert_non_null(bytes);
    size_t bits = 0;
    for (const char *c = text; *c != '\0' && *c != '='; c++)
        for (int k = 5; k >= 0; k--, bits++)
            bytes[bits / 8] |= (uint8_t)((digit(*c) >> k & 1) << (7 - bits % 8));
    *size = bits / 8;
    free(text);
    return bytes;
}

static uint32_t word_at(const uint8_t *bytes, size_t i) {
    const uint8_t *b = bytes + 4 * i;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static double single_at(const uint8_t *bytes, size_t i) {
    uint32_t word = word_at(bytes, i);
    float value;
    memcpy(&value, &word, sizeof value);
    return (double)value;
}

static json_t *data_of(const char *text) {
    char *block = block_of(text, "data");
    assert_non_null(block);
    json_t *data = json_loads(block, 0, NULL);
    free(block);
    assert_non_null(data);
    return data;
}

/* Points of a block, scaled back, equal the given ones to single precision of the extent. */
static void check_points(const char *text, const char *id, const double *points, size_t count) {
    size_t size;
    uint8_t *bytes = decode(text, id, &size);
    json_t *data = data_of(text), *frame = json_object_get(data, "frame");
    double scale = json_number_value(json_object_get(frame, "scale"));
    assert_int_equal(size, 12 * count);
    for (size_t i = 0; i < 3 * count; i++) {
        double center = json_number_value(json_array_get(json_object_get(frame, "center"), i % 3));
        assert_true(fabs(single_at(bytes, i)) <= 1.001);
        assert_true(fabs(single_at(bytes, i) * scale + center - points[i]) <= 1e-6 * scale);
    }
    json_decref(data);
    free(bytes);
}

static void check_indices(const char *text, const char *id, const uint32_t *indices, size_t count) {
    size_t size;
    uint8_t *bytes = decode(text, id, &size);
    assert_int_equal(size, 4 * count);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(word_at(bytes, i), indices[i]);
    free(bytes);
}

static bool viewer_is_missing(void) {
    if (!starg_page_available())
        print_message("this build has no viewer\n");
    return !starg_page_available();
}

/* ---- contents of a page ---- */

static size_t count_of(const char *text, const char *what) {
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, what)) != NULL; at++)
        count++;
    return count;
}

/* Whatever a model's name, the page has the same elements and its JSON contains the name. */
static void names_are_text(void **state) {
    (void)state;
    static const char *const names[] = {
        "plain.off",
        "<script>alert(1)</script>.off",
        "</script><img src=x onerror=alert(1)>",
        "<!-- <script> -->&lt;&amp;",
        "\"'\\\n\r\t\x01\x1f",
        "\xe2\x80\xa8\xe2\x80\xa9\xc3\xa9\xf0\x9f\x90\xb4.off", /* U+2028, U+2029, others */
        "]]>--!>${alert(1)}`",
    };
    if (viewer_is_missing())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "l-room", 500);
    size_t elements = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const double distance = 0;
        const starg_page_shape one = {.name = names[i]};
        const starg_page page = {.model = mesh,
                                 .model_name = names[i],
                                 .shapes = &one,
                                 .shape_count = 1,
                                 .distances = &distance};
        char *text = write_page(context, &page);
        json_t *data = data_of(text);
        json_t *model = json_object_get(data, "model");
        json_t *told = json_array_get(json_object_get(data, "shapes"), 0);
        assert_string_equal(json_string_value(json_object_get(data, "title")), names[i]);
        assert_string_equal(json_string_value(json_object_get(model, "name")), names[i]);
        assert_string_equal(json_string_value(json_object_get(told, "name")), names[i]);
        char *block = block_of(text, "data");
        assert_null(strpbrk(block, "<>&"));
        for (const char *c = block; *c != '\0'; c++)
            assert_in_range(*c, 0x20, 0x7e);
        elements = i == 0 ? count_of(text, "<script") : elements;
        assert_int_equal(count_of(text, "<script"), elements);
        assert_int_equal(count_of(text, "</script"), elements);
        free(block);
        json_decref(data);
        free(text);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Invalid UTF-8 is replaced. */
static void odd_bytes_are_replaced(void **state) {
    (void)state;
    if (viewer_is_missing())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "l-room", 500);
    const starg_page page = {.model = mesh, .model_name = "a\xff\xc3.off"};
    char *text = write_page(context, &page);
    json_t *data = data_of(text);
    assert_string_equal(json_string_value(json_object_get(data, "title")), "a??.off");
    json_decref(data);
    free(text);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Nothing is fetched: the policy forbids it, and the page's own markup contains no address. */
static void page_fetches_nothing(void **state) {
    (void)state;
    if (viewer_is_missing())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "l-room", 500);
    const starg_page page = {.model = mesh};
    char *text = write_page(context, &page);
    assert_non_null(strstr(text, "default-src 'none'"));
    assert_null(strstr(text, "'unsafe-"));
    assert_null(strstr(text, " src="));
    assert_null(strstr(text, "@import"));
    free(text);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void guards_and_what_they_see(void **state) {
    (void)state;
    if (viewer_is_missing())
        skip();
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "gallery", 600);
    const starg_mesh *mesh = starg_solid_mesh(solid);
    starg_guards *guards = test_guard(context, solid, NULL);
    starg_bits *seen = NULL;
    test_ok(context, starg_visibility(context, solid, guards->positions, guards->count,
                                      &guards->options.visibility, &seen));
    uint32_t witnesses[] = {7, 3};
    double cells[] = {0, 0, 0, 1, 1, 1, 1, 0, 0, 1.5, 0.5, 1};
    const starg_certificate_outline proof = {.vertex_count = guards->vertex_count,
                                             .face_count = guards->face_count,
                                             .bound = 2,
                                             .witness_count = 2,
                                             .witnesses = witnesses,
                                             .cell_count = 2,
                                             .cells = cells};
    const starg_page page = {.model = mesh, .guards = guards, .seen = seen, .proof = &proof};
    char *text = write_page(context, &page);
    size_t size, faces = starg_mesh_face_count(mesh), row = (faces + 7) / 8;
    check_points(text, "model-points", starg_mesh_vertices(mesh), starg_mesh_vertex_count(mesh));
    check_indices(text, "model-faces", starg_mesh_faces(mesh), 3 * faces);
    check_points(text, "guard-points", guards->positions, guards->count);
    check_points(text, "proof-cells", cells, 4);
    uint8_t *bits = decode(text, "guard-seen", &size);
    assert_int_equal(size, guards->count * row);
    for (size_t g = 0; g < guards->count; g++)
        for (size_t f = 0; f < faces; f++)
            assert_int_equal(bits[g * row + f / 8] >> (f % 8) & 1, starg_bits_test(seen, g, f));
    json_t *data = data_of(text), *told = json_object_get(data, "guards");
    assert_int_equal(json_array_size(json_object_get(told, "list")), guards->count);
    assert_int_equal(json_integer_value(json_object_get(told, "lower_bound")), guards->lower_bound);
    for (size_t g = 0; g < guards->count; g++)
        assert_int_equal(json_integer_value(json_object_get(
                             json_array_get(json_object_get(told, "list"), g), "faces")),
                         guards->seen_faces[g]);
    json_t *why = json_object_get(told, "proof");
    assert_int_equal(json_integer_value(json_object_get(why, "bound")), 2);
    assert_int_equal(json_integer_value(json_array_get(json_object_get(why, "witnesses"), 1)), 3);
    json_decref(data);
    free(bits);
    free(text);
    starg_bits_free(seen);
    starg_guards_free(context, guards);
    starg_solid_free(solid);
    test_context_free(context);
}

static void skeletons_and_morphs(void **state) {
    (void)state;
    if (viewer_is_missing())
        skip();
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "horse", 600);
    starg_skeleton *skeleton = NULL;
    test_ok(context, starg_skeleton_create(context, solid, NULL, &skeleton));
    const starg_mesh *mesh = starg_solid_mesh(solid);
    size_t count = starg_mesh_vertex_count(mesh), size;
    double *moved = malloc(3 * count * sizeof *moved);
    assert_non_null(moved);
    for (size_t i = 0; i < 3 * count; i++)
        moved[i] = 1.5 * starg_mesh_vertices(mesh)[i] + 0.25;
    starg_mesh *second = NULL;
    test_ok(context, starg_mesh_create(context, moved, count, starg_mesh_faces(mesh),
                                       starg_mesh_face_count(mesh), &second));
    const starg_mesh *frames[] = {mesh, second};
    const starg_page page = {.skeleton = skeleton, .frames = frames, .frame_count = 2};
    char *text = write_page(context, &page);
    check_points(text, "skeleton-points", skeleton->positions, skeleton->node_count);
    check_indices(text, "skeleton-edges", skeleton->edges, 2 * skeleton->edge_count);
    check_points(text, "morph-points-0", starg_mesh_vertices(mesh), count);
    check_points(text, "morph-points-1", moved, count);
    uint8_t *radii = decode(text, "skeleton-radii", &size);
    json_t *data = data_of(text);
    double scale = json_number_value(json_object_get(json_object_get(data, "frame"), "scale"));
    assert_int_equal(size, 4 * skeleton->node_count);
    for (size_t i = 0; i < skeleton->node_count; i++)
        assert_true(fabs(single_at(radii, i) * scale - skeleton->radii[i]) <= 1e-6 * scale);
    json_decref(data);
    free(radii);
    free(text);
    free(moved);
    starg_mesh_free(second);
    starg_skeleton_free(context, skeleton);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Single precision relative to the model suffices, for any place and size. */
static void models_far_away(void **state) {
    (void)state;
    static const double scales[] = {1e-290, 1e-5, 1, 1e90};
    static const double offsets[] = {0, 3e6, 1e9, 0};
    if (viewer_is_missing())
        skip();
    starg_context *context = test_context(1);
    for (size_t i = 0; i < 4; i++) {
        shape s = shape_columns();
        shape_place(&s, scales[i], offsets[i]);
        starg_mesh *mesh = test_mesh_of(context, &s);
        const starg_page page = {.model = mesh};
        char *text = write_page(context, &page);
        check_points(text, "model-points", s.vertices, s.vertex_count);
        free(text);
        starg_mesh_free(mesh);
        shape_free(&s);
    }
    test_context_free(context);
}

/* ---- pieces ---- */

static double volume_of_tetrahedron(const double *p, const uint32_t *t) {
    double m[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            m[i][k] = p[3 * t[i + 1] + (uint32_t)k] - p[3 * t[0] + (uint32_t)k];
    return (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
            m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
            m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])) /
           6;
}

static double volume_of_face(const starg_pieces_mesh *mesh, const starg_piece_surfaces *s,
                             const uint32_t *face) {
    const uint32_t t[4] = {0, 1, 2, 3};
    double p[12] = {0};
    for (size_t k = 0; k < 3; k++)
        memcpy(p + 3 * k + 3, mesh->vertices + 3 * s->vertices[face[k]], 3 * sizeof *p);
    return volume_of_tetrahedron(p, t);
}

/* Number of occurrences of a directed edge in faces [begin, end). */
static size_t count_edge(const uint32_t *faces, size_t begin, size_t end, uint32_t a, uint32_t b) {
    size_t count = 0;
    for (size_t f = begin; f < end; f++)
        for (size_t k = 0; k < 3; k++)
            count += faces[3 * f + k] == a && faces[3 * f + (k + 1) % 3] == b;
    return count;
}

/* The surface of each piece is closed, and encloses the volume of its tetrahedra. */
static void check_surfaces(const starg_pieces_mesh *mesh, const starg_piece_surfaces *s) {
    for (size_t p = 0; p < s->piece_count; p++) {
        size_t begin = s->first_face[p], end = s->first_face[p + 1];
        double inside = 0, around = 0;
        for (size_t t = 0; t < mesh->count; t++)
            if ((size_t)mesh->labels[t] == p)
                inside += volume_of_tetrahedron(mesh->vertices, mesh->tetrahedra + 4 * t);
        for (size_t f = begin; f < end; f++)
            around += volume_of_face(mesh, s, s->faces + 3 * f);
        assert_true(fabs(inside - around) <= 1e-9 * (fabs(inside) + 1));
        for (size_t f = begin; f < end; f++)
            for (size_t k = 0; k < 3; k++) {
                uint32_t a = s->faces[3 * f + k], b = s->faces[3 * f + (k + 1) % 3];
                assert_int_equal(count_edge(s->faces, begin, end, a, b),
                                 count_edge(s->faces, begin, end, b, a));
            }
    }
    assert_int_equal(s->first_face[0], 0);
    for (size_t i = 1; i < s->vertex_count; i++)
        assert_true(s->vertices[i - 1] < s->vertices[i]);
}

static void pieces_are_enclosed(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 30; seed++) {
        starg_rng rng = starg_rng_make(seed, 7, 0);
        starg_tetmesh *tets = random_tetmesh(context, seed, 12 + seed, seed % 2 == 1, 1);
        size_t count = starg_tetmesh_count(tets), pieces = 1 + (size_t)starg_rng_below(&rng, 5);
        int32_t *labels = malloc(count * sizeof *labels);
        double *vertices = malloc(3 * starg_tetmesh_vertex_count(tets) * sizeof *vertices);
        uint32_t *corners = malloc(4 * count * sizeof *corners);
        assert_true(labels != NULL && vertices != NULL && corners != NULL);
        memcpy(vertices, starg_tetmesh_vertices(tets),
               3 * starg_tetmesh_vertex_count(tets) * sizeof *vertices);
        memcpy(corners, starg_tetmesh_tetrahedra(tets), 4 * count * sizeof *corners);
        for (size_t t = 0; t < count; t++)
            labels[t] = (int32_t)starg_rng_below(&rng, pieces < count ? pieces : count);
        const starg_pieces_mesh mesh = {.vertex_count = starg_tetmesh_vertex_count(tets),
                                        .count = count,
                                        .vertices = vertices,
                                        .tetrahedra = corners,
                                        .labels = labels};
        starg_piece_surfaces surfaces;
        test_ok(context, starg_piece_surfaces_create(context, &mesh, &surfaces));
        check_surfaces(&mesh, &surfaces);
        starg_piece_surfaces_free(&surfaces);
        free(labels);
        free(vertices);
        free(corners);
        starg_tetmesh_free(tets);
    }
    test_context_free(context);
}

/* Invalid labels and vertices. */
static void wrong_pieces(void **state) {
    (void)state;
    double vertices[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    uint32_t corners[4] = {0, 1, 2, 3};
    int32_t label = 0;
    starg_piece_surfaces s;
    starg_context *context = test_context(1);
    starg_pieces_mesh mesh = {.vertex_count = 4,
                              .count = 1,
                              .vertices = vertices,
                              .tetrahedra = corners,
                              .labels = &label};
    test_ok(context, starg_piece_surfaces_create(context, &mesh, &s));
    starg_piece_surfaces_free(&s);
    static const int32_t labels[] = {-1, 1, INT32_MAX, INT32_MIN};
    for (size_t i = 0; i < 4; i++) {
        label = labels[i];
        assert_int_equal(starg_piece_surfaces_create(context, &mesh, &s), STARG_ERROR_ARGUMENT);
    }
    label = 0;
    corners[2] = 4;
    assert_int_equal(starg_piece_surfaces_create(context, &mesh, &s), STARG_ERROR_ARGUMENT);
    assert_int_equal(starg_context_error(context)->element, STARG_ELEMENT_TETRAHEDRON);
    mesh.count = 0;
    assert_int_equal(starg_piece_surfaces_create(context, &mesh, &s), STARG_ERROR_ARGUMENT);
    test_context_free(context);
}

/* ---- writing ---- */

static void same_bytes(void **state) {
    (void)state;
    if (viewer_is_missing())
        skip();
    starg_context *one = test_context(1), *three = test_context(3);
    starg_mesh *mesh = test_sample_mesh(one, "gallery", 600);
    const starg_page page = {.model = mesh, .title = "twice"};
    char *first = write_page(one, &page), *second = write_page(three, &page);
    assert_string_equal(first, second);
    free(first);
    free(second);
    starg_mesh_free(mesh);
    test_context_free(one);
    test_context_free(three);
}

static void expect_refused(starg_context *context, const starg_page *page, const char *says) {
    assert_int_equal(starg_page_write(context, page, page_path), STARG_ERROR_ARGUMENT);
    assert_non_null(strstr(starg_context_error(context)->message, says));
    assert_int_not_equal(access(page_path, F_OK), 0);
}

static void parts_that_do_not_fit(void **state) {
    (void)state;
    if (viewer_is_missing())
        skip();
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "l-room", 500);
    starg_mesh *other = test_sample_mesh(context, "gallery", 600);
    const starg_mesh *mesh = starg_solid_mesh(solid);
    starg_guards *guards = test_guard(context, solid, NULL);
    starg_bits *bits = NULL;
    test_ok(context, starg_bits_create(context, guards->count, guards->face_count + 1, &bits));
    expect_refused(context, &(starg_page){.title = "nothing"}, "no content");
    expect_refused(context, &(starg_page){.model = other, .guards = guards}, "to a model with");
    expect_refused(context, &(starg_page){.model = mesh, .guards = guards, .seen = bits},
                   "one row");
    expect_refused(context, &(starg_page){.guards = guards, .seen = bits}, "one row");
    const starg_certificate_outline proof = {.vertex_count = 3, .face_count = 1};
    expect_refused(context, &(starg_page){.model = mesh, .proof = &proof}, "needs its guards");
    expect_refused(context, &(starg_page){.model = mesh, .guards = guards, .proof = &proof},
                   "certificate belongs to a model with 3 vertices");
    const starg_mesh *frames[] = {mesh, other};
    expect_refused(context, &(starg_page){.frames = frames, .frame_count = 1}, "one frame");
    expect_refused(context, &(starg_page){.frames = frames, .frame_count = 2}, "frame 1");
    const starg_pieces_report report = {.piece_count = 2};
    expect_refused(context, &(starg_page){.report = &report, .model = mesh},
                   "needs its tetrahedra");
    const starg_page_shape shapes[2] = {{.name = "a"}, {.name = "b"}};
    const double distances[4] = {0, 1, NAN, 0};
    expect_refused(context,
                   &(starg_page){.shapes = shapes, .shape_count = 2, .distances = distances},
                   "not finite");
    starg_bits_free(bits);
    starg_guards_free(context, guards);
    starg_mesh_free(other);
    starg_solid_free(solid);
    test_context_free(context);
}

static void unwritable_places(void **state) {
    (void)state;
    char path[160];
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "l-room", 500);
    const starg_page page = {.model = mesh};
    snprintf(path, sizeof path, "%s/none/page.html", folder);
    assert_int_equal(starg_page_write(context, &page, path), STARG_ERROR_WRITE);
    assert_int_equal(starg_page_write(context, &page, folder), STARG_ERROR_WRITE);
    if (starg_page_available())
        assert_int_equal(starg_page_write(context, &page, "/dev/full"), STARG_ERROR_WRITE);
    else
        assert_non_null(strstr(starg_context_error(context)->message, "no viewer"));
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Any allocation may fail: no leaks, no file is left. */
static void scarce_memory(void **state) {
    (void)state;
    if (viewer_is_missing())
        skip();
    double vertices[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    uint32_t corners[8] = {0, 1, 2, 3, 1, 2, 3, 4};
    int32_t labels[2] = {0, 1};
    const double distance = 0;
    const starg_page_shape one = {.name = "a", .png = "png", .png_size = 3};
    const starg_pieces_mesh pieces = {.vertex_count = 5,
                                      .count = 2,
                                      .vertices = vertices,
                                      .tetrahedra = corners,
                                      .labels = labels};
    const starg_page page = {.title = "scarce",
                             .pieces = &pieces,
                             .shapes = &one,
                             .shape_count = 1,
                             .distances = &distance};
    starg_status status = STARG_ERROR_MEMORY;
    for (size_t limit = 1; status != STARG_OK; limit++) {
        size_t left = limit;
        starg_context *context = test_scarce_context(1, &left);
        status = starg_page_write(context, &page, page_path);
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        assert_int_equal(access(page_path, F_OK) == 0, status == STARG_OK);
        test_context_free(context);
        assert_true(limit < 200);
    }
    assert_int_equal(unlink(page_path), 0);
}

/* ---- pictures in memory ---- */

static void encoded_pictures(void **state) {
    (void)state;
    char path[160];
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "star", 500);
    starg_picture_options options;
    starg_picture_options_default(&options);
    options.width = 108;
    options.height = 80;
    uint8_t *png = NULL;
    size_t size = 0, written = 0;
    snprintf(path, sizeof path, "%s/picture.png", folder);
    test_ok(context, starg_picture_encode(context, mesh, &options, &png, &size));
    test_ok(context, starg_picture_write(context, mesh, &options, path));
    char *bytes = read_path(path, &written);
    assert_int_equal(size, written);
    assert_memory_equal(png, bytes, size);
    unlink(path);
    free(bytes);
    starg_picture_bytes_free(context, png);
    options.width = 0;
    assert_int_equal(starg_picture_encode(context, mesh, &options, &png, &size),
                     STARG_ERROR_ARGUMENT);
    assert_null(png);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_text),       cmocka_unit_test(odd_bytes_are_replaced),
        cmocka_unit_test(page_fetches_nothing), cmocka_unit_test(guards_and_what_they_see),
        cmocka_unit_test(skeletons_and_morphs), cmocka_unit_test(models_far_away),
        cmocka_unit_test(pieces_are_enclosed),  cmocka_unit_test(wrong_pieces),
        cmocka_unit_test(same_bytes),           cmocka_unit_test(parts_that_do_not_fit),
        cmocka_unit_test(unwritable_places),    cmocka_unit_test(scarce_memory),
        cmocka_unit_test(encoded_pictures),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
