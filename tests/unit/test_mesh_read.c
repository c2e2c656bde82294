/* SPDX-License-Identifier: Apache-2.0 */
/* Readers: every accepted form, and every documented error with its status and place. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support.h"

/* The good files contain a tetrahedron, unless stated otherwise. */
static const double points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

static starg_status read_text(starg_context *context, const char *text, const char *name,
                              starg_mesh **mesh) {
    return starg_mesh_read_memory(context, text, strlen(text), name, mesh);
}

static void expect_tetrahedron(const char *text, size_t size, const char *name) {
    starg_context *context = test_context(1);
    starg_mesh *mesh = NULL;
    char *exact = malloc(size); /* nothing after the end, so that sanitizers see overruns */
    assert_non_null(exact);
    memcpy(exact, text, size);
    test_ok(context, starg_mesh_read_memory(context, exact, size, name, &mesh));
    free(exact);
    assert_int_equal(starg_mesh_vertex_count(mesh), 4);
    assert_int_equal(starg_mesh_face_count(mesh), 4);
    assert_memory_equal(starg_mesh_vertices(mesh), points, sizeof points);
    assert_memory_equal(starg_mesh_faces(mesh), faces, sizeof faces);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void expect_tetrahedra(const char *const *texts, size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        expect_tetrahedron(texts[i], strlen(texts[i]), name);
}

/* Replaces every '\n' of `text` by `end`; the caller frees the result. */
static char *with_line_ends(const char *text, const char *end) {
    char *out = malloc(2 * strlen(text) + 1), *at = out;
    assert_non_null(out);
    for (; *text != '\0'; text++) {
        if (*text == '\n')
            at += sprintf(at, "%s", end);
        else
            *at++ = *text;
    }
    *at = '\0';
    return out;
}

typedef struct bad_file {
    const char *name, *text;
    starg_status status;
    starg_element element;
    uint64_t index;
    const char *says;
} bad_file;

static void expect_error(const bad_file *bad, size_t size) {
    starg_context *context = test_context(1);
    starg_mesh *mesh = (starg_mesh *)(uintptr_t)1;
    char *exact = malloc(size + 1);
    assert_non_null(exact);
    memcpy(exact + 1, bad->text, size); /* odd address, nothing after it */
    starg_status status = starg_mesh_read_memory(context, exact + 1, size, bad->name, &mesh);
    free(exact);
    const starg_error *error = starg_context_error(context);
    if (status != bad->status || error->element != bad->element ||
        (bad->element != STARG_ELEMENT_NONE && error->indices[0] != bad->index) ||
        strstr(error->message, bad->says) == NULL || strstr(error->message, bad->name) == NULL)
        fail_msg("status %d, element %d, index %llu: %s\nof:\n%s", (int)status, (int)error->element,
                 (unsigned long long)error->indices[0], error->message, bad->text);
    assert_null(mesh);
    assert_int_equal(error->index_count, bad->element != STARG_ELEMENT_NONE);
    test_context_free(context);
}

static void expect_errors(const bad_file *files, size_t count) {
    for (size_t i = 0; i < count; i++)
        expect_error(&files[i], strlen(files[i].text));
}

#define COUNT(ARRAY)    (sizeof(ARRAY) / sizeof(ARRAY)[0])
#define FORMAT_AT(LINE) STARG_ERROR_FORMAT, STARG_ELEMENT_LINE, LINE

/* ---- OFF ---- */

#define OFF_VERTICES "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define OFF_FACES    "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"

static void off_forms(void **state) {
    (void)state;
    static const char *const texts[] = {
        "OFF\n4 4 6\n" OFF_VERTICES OFF_FACES,
        "OFF 4 4 6\n" OFF_VERTICES OFF_FACES,
        "OFF4 4 6\n" OFF_VERTICES OFF_FACES,
        "OFF\n4 4\n" OFF_VERTICES OFF_FACES,
        "OFF\n4\n4\n6\n" OFF_VERTICES OFF_FACES,
        "\xEF\xBB\xBFOFF\n4 4 0\n" OFF_VERTICES OFF_FACES,
        "# first\n\n  OFF # x\n#\n4 #c\n 4 0# d\n\n\n" OFF_VERTICES "#\n\n" OFF_FACES "\n\n# end",
        "OFF 4 4 0 0 0 0 1 0 0 0 1 0 0\n0 1\n" OFF_FACES,
        "OFF\n4 4 0\n+0 0e5 .0\n1.0 0. 0\n0 1e0 0\n0 0 10E-1\n" OFF_FACES,
        "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1 255 0 0\n3 0 1 3 0.5 .5 1 1\n3 1 2 3 7\n3 2 0 3",
        "OFF\n4 4 0\n" OFF_VERTICES "3\n0\n2 1\n3 0 1 3\n3 1 2\n3\n3 2 0 3\n",
        "COFF\n4 4 0\n0 0 0 255 0 0 255\n1 0 0 1 0 0 1\n0 1 0 0 0 0\n0 0 1 9 9 9 9\n" OFF_FACES,
        "NOFF\n4 4 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n0 0 1 0 0 1\n" OFF_FACES,
        "STOFF\n4 4 0\n0 0 0 .5 1\n1 0 0 0 1\n0 1 0 0 1\n0 0 1 0 1\n" OFF_FACES,
        "STCNOFF 4 4 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0\n0 1 0\n0 0 1\n" OFF_FACES,
    };
    expect_tetrahedra(texts, COUNT(texts), "a.off");
    expect_tetrahedra(texts, COUNT(texts), "misleading.stl"); /* the content decides */
    for (size_t i = 0; i < COUNT(texts); i++) {
        static const char *const ends[] = {"\r\n", "\r"};
        for (size_t k = 0; k < 2; k++) {
            char *text = with_line_ends(texts[i], ends[k]);
            expect_tetrahedron(text, strlen(text), "a.off");
            free(text);
        }
    }
}

static void off_errors(void **state) {
    (void)state;
    static const bad_file files[] = {
        {"a.off", "4 4 6\n" OFF_VERTICES OFF_FACES, FORMAT_AT(1), "keyword OFF"},
        {"a.off", "# c\nOFFX\n", FORMAT_AT(2), "'OFFX'"},
        {"a.off", "OFF BINARY\n", FORMAT_AT(1), "binary OFF is not supported"},
        {"a.off", "4OFF\n4 4 0\n", FORMAT_AT(1), "three coordinates"},
        {"a.off", "nOFF\n3\n4 4 0\n", FORMAT_AT(1), "three coordinates"},
        {"a.off", "OFF\n", FORMAT_AT(2), "the vertex count"},
        {"a.off", "OFF\n4", FORMAT_AT(2), "the face count"},
        {"a.off", "OFF\n4 four 0\n", FORMAT_AT(2), "'four' is not a whole number"},
        {"a.off", "OFF\n4 4 x\n", FORMAT_AT(2), "the edge count"},
        {"a.off", "OFF\n-4 4 0\n" OFF_VERTICES OFF_FACES, FORMAT_AT(2), "-4 vertices"},
        {"a.off", "OFF\n100000000 4 0\n" OFF_VERTICES OFF_FACES, FORMAT_AT(2), "100000000"},
        {"a.off", "OFF\n4 9223372036854775807 0\n" OFF_VERTICES OFF_FACES, FORMAT_AT(2),
         "the header declares"},
        {"a.off", "OFF\n4 99999999999999999999 0\n", FORMAT_AT(2), "not a whole number"},
        {"a.off", "OFF\n4 4 0\n0 0 0\n1,0 0 0\n0 1 0\n0 0 1\n" OFF_FACES, FORMAT_AT(4), "'1,0'"},
        {"a.off", "OFF\n4 4 0\n0 0 0\n1.0abc 0 0\n0 1 0\n0 0 1\n" OFF_FACES, FORMAT_AT(4), "abc"},
        {"a.off", "OFF\n4 4 0\n0 0 0\n0x10 0 0\n0 1 0\n0 0 1\n" OFF_FACES, FORMAT_AT(4), "0x10"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1\n3 0 4 3\n3 1 2 3\n3 2 0 3\n", FORMAT_AT(8),
         "vertex 4"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1\n3 0 -1 3\n3 1 2 3\n3 2 0 3\n", FORMAT_AT(8),
         "vertex -1"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1\n2 0 1\n3 1 2 3\n3 2 0 3 \n", FORMAT_AT(8),
         "2 corners"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1\n1 0\n3 1 2 3\n3 2 0 3   \n", FORMAT_AT(8),
         "1 corner;"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1\n0\n3 1 2 3\n3 2 0 3      \n", FORMAT_AT(8),
         "0 corners"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1 red\n3 0 1 3\n3 1 2 3\n3 2 0 3\n",
         FORMAT_AT(7), "'red'"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1 3 0 1 3\n3 1 2 3 3 2 0 3\n      ",
         FORMAT_AT(9), "truncated"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1 9 9 9 9 9\n3 1 2 3 3 2 0 3\n      ",
         FORMAT_AT(7), "more than 4"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES "3 0 2 1\n3 0 1 3\n3 1 2 3\n             ",
         FORMAT_AT(10), "truncated"},
        {"a.off", "OFF\n4 4 0\n" OFF_VERTICES OFF_FACES "3 1 2 0\n", FORMAT_AT(11), "'3' follows"},
        {"a.off", "OFF\n4 0 0\n" OFF_VERTICES, STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0,
         "no faces"},
        {"a.off", "OFF\n0 0 0\n", STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0, "no faces"},
        {"a.off", "OFF\n4 4 0\n0 0 0\n0 nan 0\n0 1 0\n0 0 1\n" OFF_FACES, STARG_ERROR_RANGE,
         STARG_ELEMENT_VERTEX, 1, "line 4: coordinate y"},
        {"a.off", "OFF\n4 4 0\n0 0 0\n0 0 0\n0 0 -inf\n0 0 1\n" OFF_FACES, STARG_ERROR_RANGE,
         STARG_ELEMENT_VERTEX, 2, "coordinate z"},
        {"a.off", "OFF\n4 4 0\n1e100 0 0\n0 0 0\n0 0 0\n0 0 1\n" OFF_FACES, STARG_ERROR_RANGE,
         STARG_ELEMENT_VERTEX, 0, "coordinate x"},
        {"a.off", "OFF\n4 4 0\n1e999 0 0\n0 0 0\n0 0 0\n0 0 1\n" OFF_FACES, STARG_ERROR_RANGE,
         STARG_ELEMENT_VERTEX, 0, "coordinate x"},
        {"a.off", "", STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0, "empty"},
        {"a.off", "\xEF\xBB\xBF", STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0, "empty"},
        {"a.txt", "hello\n", STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0, "unknown format"},
    };
    expect_errors(files, COUNT(files));
}

/* ---- OBJ ---- */

#define OBJ_VERTICES "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
#define OBJ_FACES    "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"

static void obj_forms(void **state) {
    (void)state;
    static const char *const texts[] = {
        OBJ_VERTICES OBJ_FACES,
        "# a\nmtllib /etc/passwd missing.mtl\no thing\n" OBJ_VERTICES
        "vt 0 0\nvn 0 0 1\ng x\ns off\n"
        "usemtl #9\nl 1 2\nnonsense here\n" OBJ_FACES "# end",
        OBJ_VERTICES "f 1/1 3/2 2/3\nf 1//1 2//2 4//3\nf 2/1/1 3/9/9 4/-1/-1\nf 3/ 1// 4\n",
        OBJ_VERTICES "f -4 -2 -3\nf -4/1 -3/1 -1/1\nf -3//1 -2//1 -1//1\nf -2/1/1 -4/1/1 -1/1/1\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
        OBJ_FACES OBJ_VERTICES, /* faces may refer to later vertices */
        "v 0 0 0 1\nv 1 0 0 1 0 0\nv 0 1 0 1 1 1\nv 0 0 1 1 1 1 1\n" OBJ_FACES,
        "v \\\n 0 0\\\n 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 \\\n3 2\nf 1 2 4\nf 2 3 4\nf 3\\\n 1 4",
        "\n\n \tv 0 0 0 # remark \\\n\tv\t1 0 0\n v 0 1 0\n v 0 0 1\n" OBJ_FACES,
    };
    expect_tetrahedra(texts, COUNT(texts), "a.obj");
    expect_tetrahedra(texts, COUNT(texts), "A.OBJ");
    for (size_t i = 0; i < COUNT(texts); i++) {
        static const char *const ends[] = {"\r\n", "\r"};
        for (size_t k = 0; k < 2; k++) {
            char *text = with_line_ends(texts[i], ends[k]);
            expect_tetrahedron(text, strlen(text), "a.obj");
            free(text);
        }
    }
    expect_tetrahedron(texts[0], strlen(texts[0]),
                       "standard input"); /* recognized by content only */
}

static void obj_errors(void **state) {
    (void)state;
    static const bad_file files[] = {
        {"a.obj", "v 0 0\n", FORMAT_AT(1), "2 coordinates"},
        {"a.obj", "v\n", FORMAT_AT(1), "0 coordinates"},
        {"a.obj", "v 0 0 1,5\n", FORMAT_AT(1), "'1,5'"},
        {"a.obj", "v 0 0 0 x\n", FORMAT_AT(1), "'x'"},
        {"a.obj", "\nv 0 0 0 1 2 3 4 5 6\n", FORMAT_AT(2), "more than 5"},
        {"a.obj", OBJ_VERTICES "f 1 2 5\n", FORMAT_AT(5), "vertex 5"},
        {"a.obj", OBJ_VERTICES "f 1 2 0\n", FORMAT_AT(5), "vertex 0"},
        {"a.obj", OBJ_VERTICES "f 1 2 -5\n", FORMAT_AT(5), "vertex -5"},
        {"a.obj", "v 0 0 0\nf 1 2 -2\n" OBJ_VERTICES, FORMAT_AT(2), "vertex -2"},
        {"a.obj", OBJ_VERTICES "f 1 2\n", FORMAT_AT(5), "2 corners"},
        {"a.obj", OBJ_VERTICES "f\n", FORMAT_AT(5), "0 corners"},
        {"a.obj", OBJ_VERTICES "f 1 2 x\n", FORMAT_AT(5), "'x' is not a corner"},
        {"a.obj", OBJ_VERTICES "f 1 2 /3\n", FORMAT_AT(5), "'/3'"},
        {"a.obj", OBJ_VERTICES "f 1 2 3/x\n", FORMAT_AT(5), "'3/x'"},
        {"a.obj", OBJ_VERTICES "f 1 2 3/1/1/1\n", FORMAT_AT(5), "'3/1/1/1'"},
        {"a.obj", OBJ_VERTICES "f 1 2 3.0\n", FORMAT_AT(5), "'3.0'"},
        {"a.obj", OBJ_VERTICES "f 1 2 99999999999999999999\n", FORMAT_AT(5), "is not a corner"},
        {"a.obj", OBJ_VERTICES "f 1 2 \\\n 4294967297\n", FORMAT_AT(6), "vertex 4294967297"},
        {"a.obj", OBJ_VERTICES, STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0, "no faces"},
        {"a.obj", "# only this\n", STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0, "no faces"},
        {"a.obj", "v 0 0 0\nv 0 inf 0\n", STARG_ERROR_RANGE, STARG_ELEMENT_VERTEX, 1, "line 2"},
    };
    expect_errors(files, COUNT(files));
}

/* ---- polygons ---- */

static void polygons_are_cut_in_place(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = NULL;
    test_ok(context, read_text(context,
                               "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1.5 .5 0\n"
                               "f 1 2 3\nf 1 2 3 4\nf 1 2 3 5\nf 2 2 3\nf 3 4 1\n",
                               "a.obj", &mesh));
    static const uint32_t expected[] = {0, 1, 2, 0, 1, 2, 0, 2, 3, 4, 0,
                                        1, 4, 1, 2, 1, 1, 2, 2, 3, 0};
    assert_int_equal(starg_mesh_face_count(mesh), 7);
    assert_memory_equal(starg_mesh_faces(mesh), expected, sizeof expected);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* A zigzag of 5,000 corners is rejected instead of taking quadratic time. */
static void huge_concave_polygons_are_refused(void **state) {
    (void)state;
    enum { CORNERS = 5000 };
    char *text = malloc(CORNERS * 40), *at = text;
    assert_non_null(text);
    for (int i = 0; i < CORNERS; i++)
        at += sprintf(at, "v %d %d 0\n", i < CORNERS / 2 ? i : CORNERS - i,
                      i % 2 + (i >= CORNERS / 2) * 3);
    at += sprintf(at, "f");
    for (int i = 0; i < CORNERS; i++)
        at += sprintf(at, " %d", i + 1);
    const bad_file bad = {"a.obj", text, FORMAT_AT(CORNERS + 1), "5000 corners"};
    expect_error(&bad, strlen(text));
    free(text);
}

/* ---- STL ---- */

#define FACET(A, B, C)                                                                             \
    "facet normal 0 0 0\n outer loop\n vertex " A "\n vertex " B "\n vertex " C                    \
    "\n endloop\nendfacet\n"
#define STL_FACETS                                                                                 \
    FACET("0 0 0", "1 0 0", "0 1 0")                                                               \
    FACET("0 -0.0 0", "0 1 0", "0 0 1")                                                            \
    FACET("0 1 0", "1e0 -0 0", "0 0 1") FACET("1 0 0", "0 0 0", "0 0 1")

static const uint32_t stl_faces[4][3] = {{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {1, 0, 3}};

/* Corners in order of first appearance, so the order of STL_FACETS shows. */
static void expect_stl(const char *bytes, size_t size, const char *name) {
    starg_context *context = test_context(1);
    starg_mesh *mesh = NULL;
    char *exact = malloc(size);
    assert_non_null(exact);
    memcpy(exact, bytes, size);
    test_ok(context, starg_mesh_read_memory(context, exact, size, name, &mesh));
    free(exact);
    assert_int_equal(starg_mesh_vertex_count(mesh), 4);
    assert_int_equal(starg_mesh_face_count(mesh), 4);
    assert_memory_equal(starg_mesh_vertices(mesh), points, sizeof points); /* no -0 either */
    assert_memory_equal(starg_mesh_faces(mesh), stl_faces, sizeof stl_faces);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void stl_text_forms(void **state) {
    (void)state;
    static const char *const texts[] = {
        "solid\n" STL_FACETS "endsolid\n",
        "solid a name with # and facet\n" STL_FACETS "endsolid a name with # and facet",
        "  SOLID x\r\n" FACET("0 0 0", "1 0 0",
                              "0 1 0") "endsolid x\nsolid y\n" FACET("0 0 0", "0 1 0", "0 0 1")
            FACET("0 1 0", "1 0 0", "0 0 1") "FACET normal nan -1.#IND 0 OUTER LOOP Vertex 1 0 "
                                             "0\tVertex 0 0 0 Vertex 0 0 1 EndLoop "
                                             "EndFacet\r\nENDSOLID",
    };
    for (size_t i = 0; i < COUNT(texts); i++) {
        expect_stl(texts[i], strlen(texts[i]), "a.stl");
        expect_stl(texts[i], strlen(texts[i]), "nameless");
    }
}

/* The facets as binary STL with a header that starts with `header`. */
static size_t make_binary_stl(unsigned char *bytes, const char *header) {
    memset(bytes, 0, 84 + 4 * 50);
    memcpy(bytes, header, strlen(header));
    bytes[80] = 4;
    for (size_t f = 0; f < 4; f++) {
        for (size_t c = 0; c < 3; c++) {
            for (size_t k = 0; k < 3; k++) {
                float value = (float)points[stl_faces[f][c]][k];
                if (value == 0 && f == 2)
                    value = -value;
                memcpy(bytes + 84 + 50 * f + 12 + 12 * c + 4 * k, &value, 4); /* little endian */
            }
        }
    }
    return 84 + 4 * 50;
}

static void stl_binary_forms(void **state) {
    (void)state;
    unsigned char bytes[512];
    size_t size = make_binary_stl(bytes, "made by hand");
    expect_stl((const char *)bytes, size, "a.stl");
    expect_stl((const char *)bytes, size, "nameless");
    size = make_binary_stl(bytes, "solid that is none\n facet normal");
    expect_stl((const char *)bytes, size, "a.stl");
    memset(bytes, ' ', 80);
    memcpy(bytes, "solid", 5); /* without a zero byte: the size decides */
    expect_stl((const char *)bytes, size, "a.stl");
}

/* Bytes after the triangles are ignored. */
static void stl_trailing_bytes(void **state) {
    (void)state;
    unsigned char bytes[512] = {0};
    size_t size = make_binary_stl(bytes, "made by hand");
    for (size_t more = 1; more <= 120; more += 7)
        expect_stl((const char *)bytes, size + more, "a.stl");
}

static void stl_errors(void **state) {
    (void)state;
    static const bad_file files[] = {
        {"a.stl", "solid x\n", FORMAT_AT(2), "facet or endsolid"},
        {"a.stl", "solid x\nendsolid x\n", STARG_ERROR_FORMAT, STARG_ELEMENT_NONE, 0, "no faces"},
        {"a.stl", "solid x\n" STL_FACETS, FORMAT_AT(30), "facet or endsolid"},
        {"a.stl", "solid x\nfacet nromal 0 0 0\n", FORMAT_AT(2),
         "found 'nromal' instead of 'normal'"},
        {"a.stl", "solid x\nfacet normal 0 0 0\nouter loop\nvertex 0 0\nvertex 0 0 1\n",
         FORMAT_AT(5), "'vertex' is not a number"},
        {"a.stl", "solid x\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nendloop",
         FORMAT_AT(6), "found 'endloop' instead of 'vertex'"},
        {"a.stl", "solid x\n" STL_FACETS "endsolid x\nrubbish\n", FORMAT_AT(31), "'rubbish'"},
        {"a.stl", "solid x\nfacet normal 0 0 0\nouter loop\nvertex 0 0 nan\n", STARG_ERROR_RANGE,
         STARG_ELEMENT_VERTEX, 0, "line 4"},
        {"a.stl", "what is this", STARG_ERROR_FORMAT, STARG_ELEMENT_BYTE, 12,
         "header of a binary STL"},
    };
    expect_errors(files, COUNT(files));
    unsigned char bytes[512];
    size_t size = make_binary_stl(bytes, "solid");
    bad_file bad = {"a.stl", (const char *)bytes, STARG_ERROR_FORMAT, STARG_ELEMENT_BYTE,
                    80,      "truncated"};
    expect_error(&bad, size - 1);
    float infinite = 1e38f * 10;
    memcpy(bytes + 84 + 12 + 12, &infinite, 4);
    bad = (bad_file){"a.stl", (const char *)bytes, STARG_ERROR_RANGE, STARG_ELEMENT_VERTEX,
                     1,       "byte 108"};
    expect_error(&bad, size);
    memset(bytes, 0, 84);
    bad = (bad_file){"a.stl", (const char *)bytes, STARG_ERROR_FORMAT, STARG_ELEMENT_NONE,
                     0,       "no faces"};
    expect_error(&bad, 84);
}

/* ---- PLY ---- */

#define PLY_VERTEX "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACE   "element face 4\nproperty list uchar int vertex_indices\n"
#define PLY_TEXT   "ply\nformat ascii 1.0\n"

static void ply_text_forms(void **state) {
    (void)state;
    static const char *const texts[] = {
        PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES OFF_FACES,
        PLY_TEXT
        "comment # end_header\nobj_info x\n" PLY_VERTEX
        "element face 4\nproperty list int32 uint16 vertex_index\nend_header\n" OFF_VERTICES
            OFF_FACES "\n\n",
        /* other properties in any place and order; other elements */
        PLY_TEXT
        "element camera 2\nproperty list uchar float path\nproperty int id\n"
        "element nothing 1000000000000\n"
        "element vertex 4\nproperty uchar red\nproperty double z\nproperty list uchar int ring\n"
        "property int x\nproperty float64 y\n"
        "element face 4\nproperty uchar flags\nproperty list uint8 float vertex_indices\n"
        "property list uchar float texcoord\nelement edge 1\nproperty int vertex1\nend_header\n"
        "2 .5 .5 7\n0 8\n"
        "9 0 0 0 0\n9 0 2 5 5 1 0\n9 0 1 7 0 1\n9 1 0 0 0\n"
        "1 3 0 2 1 2 .1 .1\n1 3 0 1 3 0\n1 3 1 2 3.0 0\n1 3 2 0 3 0\n77\n",
        /* faces before vertices */
        PLY_TEXT PLY_FACE PLY_VERTEX "end_header\n" OFF_FACES OFF_VERTICES,
    };
    expect_tetrahedra(texts, COUNT(texts), "a.ply");
    for (size_t i = 0; i < COUNT(texts); i++) {
        static const char *const ends[] = {"\r\n", "\r"};
        for (size_t k = 0; k < 2; k++) {
            char *text = with_line_ends(texts[i], ends[k]);
            expect_tetrahedron(text, strlen(text), "nameless");
            free(text);
        }
    }
}

static const bool is_little = true, is_big = false;

static void append(unsigned char *bytes, size_t *size, uint64_t value, size_t width, bool little) {
    for (size_t i = 0; i < width; i++)
        bytes[(*size)++] = (unsigned char)(value >> 8 * (little ? i : width - 1 - i));
}

static void append_real(unsigned char *bytes, size_t *size, double value, size_t width,
                        bool little) {
    uint64_t bits = 0;
    float single = (float)value;
    if (width == 4) {
        uint32_t half;
        memcpy(&half, &single, 4);
        bits = half;
    } else {
        memcpy(&bits, &value, 8);
    }
    append(bytes, size, bits, width, little);
}

/* While a binary file is read, less than twice the memory of its mesh is in use; what comes out is
 * the same as from memory, where nothing is given back. Where the allocator is the caller's, all
 * stays. */
static void ply_memory(void **state) {
    (void)state;
    enum { SIDE = 300, VERTICES = SIDE * SIDE, FACES = 2 * (SIDE - 1) * (SIDE - 1) };
    const char *path = "ply_memory.ply";
    starg_context *context = test_context(1);
    starg_mesh *mesh = NULL, *same = NULL;
    size_t size = 0;
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\n"
            "property double y\nproperty double z\nelement face %d\n"
            "property list uchar uint vertex_indices\nproperty ushort group\nend_header\n",
            VERTICES, FACES);
    for (int i = 0; i < VERTICES; i++)
        fwrite((double[3]){i % SIDE, i / SIDE, i / 7.0}, sizeof(double), 3, file);
    for (uint32_t f = 0; f < FACES; f++) {
        const uint32_t at = f / 2 % (SIDE - 1) + SIDE * (f / 2 / (SIDE - 1));
        const uint32_t corners[2][3] = {{at, at + 1, at + SIDE},
                                        {at + 1, at + SIDE + 1, at + SIDE}};
        fputc(3, file);
        fwrite(corners[f % 2], sizeof(uint32_t), 3, file);
        fwrite(&(uint16_t){0}, sizeof(uint16_t), 1, file);
    }
    assert_int_equal(fclose(file), 0);
    const size_t before = starg_context_peak_bytes(context);
    test_ok(context, starg_mesh_read(context, path, &mesh));
    const size_t own = 3 * VERTICES * sizeof(double) + 3 * FACES * sizeof(uint32_t);
    assert_true(starg_context_peak_bytes(context) - before < 2 * own - own / 8);
    file = fopen(path, "rb");
    assert_non_null(file);
    char *bytes = malloc(2 * own);
    assert_non_null(bytes);
    size = fread(bytes, 1, 2 * own, file);
    fclose(file);
    test_ok(context, starg_mesh_read_memory(context, bytes, size, path, &same));
    assert_int_equal(starg_mesh_vertex_count(same), VERTICES);
    assert_int_equal(starg_mesh_face_count(same), FACES);
    assert_memory_equal(starg_mesh_vertices(mesh), starg_mesh_vertices(same),
                        3 * VERTICES * sizeof(double));
    assert_memory_equal(starg_mesh_faces(mesh), starg_mesh_faces(same),
                        3 * FACES * sizeof(uint32_t));
    starg_mesh_free(mesh);
    starg_mesh_free(same);
    /* The place of a fault is that in the file. */
    char told[64];
    memset(bytes + size - 6, 0xff, 4);
    file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
    assert_int_equal(starg_mesh_read(context, path, &mesh), STARG_ERROR_FORMAT);
    snprintf(told, sizeof told, "byte %zu", size - 6);
    assert_non_null(strstr(starg_context_error(context)->message, told));
    assert_int_equal(unlink(path), 0);
    free(bytes);
    test_context_free(context);
}

typedef struct ply_case {
    const char *coordinate, *count, *index; /* type names */
    size_t coordinate_width, count_width, index_width;
    bool little, faces_first;
    const char *line_end;
} ply_case;

static size_t make_header(unsigned char *bytes, const ply_case *c) {
    char vertex[256], face[256], whole[800];
    snprintf(vertex, sizeof vertex,
             "element vertex 4\nproperty short skipped\nproperty %s x\nproperty %s y\n"
             "property list ushort double also\nproperty %s z\n",
             c->coordinate, c->coordinate, c->coordinate);
    snprintf(face, sizeof face,
             "element face 4\nproperty list %s %s vertex_indices\nproperty char flag\n", c->count,
             c->index);
    snprintf(whole, sizeof whole, "ply\nformat binary_%s_endian 1.0\n%s%send_header\n",
             c->little ? "little" : "big", c->faces_first ? face : vertex,
             c->faces_first ? vertex : face);
    char *text = with_line_ends(whole, c->line_end);
    size_t size = strlen(text);
    memcpy(bytes, text, size);
    free(text);
    return size;
}

static void append_vertices(unsigned char *bytes, size_t *size, const ply_case *c) {
    bool real = strcmp(c->coordinate, "float") == 0 || strcmp(c->coordinate, "double") == 0;
    for (size_t v = 0; v < 4; v++) {
        append(bytes, size, 0x0a0d, 2, c->little); /* bytes that look like line ends */
        for (size_t k = 0; k < 3; k++) {
            if (k == 2) {
                append(bytes, size, v, 2, c->little);
                for (size_t i = 0; i < v; i++)
                    append_real(bytes, size, 1e300, 8, c->little);
            }
            if (real)
                append_real(bytes, size, points[v][k], c->coordinate_width, c->little);
            else
                append(bytes, size, (uint64_t)points[v][k], c->coordinate_width, c->little);
        }
    }
}

static void append_faces(unsigned char *bytes, size_t *size, const ply_case *c) {
    for (size_t f = 0; f < 4; f++) {
        append(bytes, size, 3, c->count_width, c->little);
        for (size_t k = 0; k < 3; k++) {
            if (strcmp(c->index, "float") == 0)
                append_real(bytes, size, faces[f][k], 4, c->little);
            else
                append(bytes, size, faces[f][k], c->index_width, c->little);
        }
        append(bytes, size, 0xff, 1, c->little);
    }
}

static size_t make_binary_ply(unsigned char *bytes, const ply_case *c) {
    size_t size = make_header(bytes, c);
    if (c->faces_first)
        append_faces(bytes, &size, c);
    append_vertices(bytes, &size, c);
    if (!c->faces_first)
        append_faces(bytes, &size, c);
    return size;
}

static void ply_binary_forms(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t width;
    } types[] = {{"char", 1}, {"uint8", 1}, {"short", 2}, {"ushort", 2},
                 {"int", 4},  {"uint", 4},  {"float", 4}, {"double", 8}};
    static const char *const ends[] = {"\n", "\r\n", "\r"};
    unsigned char bytes[2048];
    for (size_t t = 0; t < 8; t++) {
        for (int variant = 0; variant < 12; variant++) {
            size_t count = (t + 1) % 6, index = (t + 2) % 7;
            const ply_case c = {.coordinate = types[t].name,
                                .coordinate_width = types[t].width,
                                .count = types[count].name,
                                .count_width = types[count].width,
                                .index = types[index].name,
                                .index_width = types[index].width,
                                .little = variant % 2 ? is_little : is_big,
                                .faces_first = variant / 2 % 2,
                                .line_end = ends[variant / 4]};
            size_t size = make_binary_ply(bytes, &c);
            expect_tetrahedron((const char *)bytes, size, "a.ply");
            bytes[size] = '\n'; /* some programs append one */
            expect_tetrahedron((const char *)bytes, size + 1, "nameless");
        }
    }
}

/* A binary file cut anywhere is an error, and so is one byte too many. */
static void ply_binary_truncations(void **state) {
    (void)state;
    const ply_case c = {"float", "uchar", "int", 4, 1, 4, is_big, false, "\n"};
    unsigned char bytes[2048];
    size_t size = make_binary_ply(bytes, &c);
    starg_context *context = test_context(1);
    for (size_t cut = 0; cut < size; cut++) {
        starg_mesh *mesh = NULL;
        unsigned char *exact = malloc(cut + 1);
        assert_non_null(exact);
        memcpy(exact, bytes, cut);
        assert_int_equal(starg_mesh_read_memory(context, exact, cut, "cut.ply", &mesh),
                         STARG_ERROR_FORMAT);
        assert_non_null(strstr(starg_context_error(context)->message, "cut.ply"));
        free(exact);
    }
    test_context_free(context);
    bytes[size] = 'x';
    const bad_file bad = {"a.ply", (const char *)bytes, STARG_ERROR_FORMAT, STARG_ELEMENT_BYTE,
                          size,    "1 bytes follow"};
    expect_error(&bad, size + 1);
}

/* More values on a line than the header declares: of vertices, of faces, of both. */
static void ply_extra_values(void **state) {
    (void)state;
    static const char *const texts[] = {
        PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n0 0 0 1 0 0\n1 0 0\n0 1 0 9\n0 0 1\n" OFF_FACES,
        PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES
                                     "3 0 2 1 255 0 0\n3 0 1 3\n3 1 2 3 1\n3 2 0 3\n",
        PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n0 0 0 7\n1 0 0 7\n0 1 0 7\n0 0 1 7\n3 0 2 1 x\n3 "
                                     "0 1 3 x\n3 1 2 3 x\n3 2 0 3 x"};
    starg_context *context = test_context(1);
    starg_mesh *plain = NULL;
    static const char good[] = PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES OFF_FACES;
    test_ok(context, starg_mesh_read_memory(context, good, strlen(good), "a.ply", &plain));
    for (size_t i = 0; i < COUNT(texts); i++) {
        starg_mesh *mesh = NULL;
        test_ok(context,
                starg_mesh_read_memory(context, texts[i], strlen(texts[i]), "a.ply", &mesh));
        assert_int_equal(starg_mesh_vertex_count(mesh), 4);
        assert_int_equal(starg_mesh_face_count(mesh), 4);
        assert_memory_equal(starg_mesh_vertices(mesh), starg_mesh_vertices(plain),
                            12 * sizeof(double));
        assert_memory_equal(starg_mesh_faces(mesh), starg_mesh_faces(plain), 12 * sizeof(uint32_t));
        starg_mesh_free(mesh);
    }
    starg_mesh_free(plain);
    test_context_free(context);
}

static void ply_errors(void **state) {
    (void)state;
    static const bad_file files[] = {
        {"a.ply", "OFF_\n", FORMAT_AT(1), "line 'ply'"},
        {"a.ply", "ply\n", FORMAT_AT(2), "end_header"},
        {"a.ply", "ply\nformat\n", FORMAT_AT(2), "the encoding is missing"},
        {"a.ply", "ply\nformat utf8 1.0\n", FORMAT_AT(2), "'utf8'"},
        {"a.ply", "ply\n" PLY_VERTEX PLY_FACE "end_header\n", FORMAT_AT(9), "format line"},
        {"a.ply", PLY_TEXT "rubbish\n", FORMAT_AT(3), "'rubbish'"},
        {"a.ply", PLY_TEXT "element vertex\n", FORMAT_AT(3), "count of the element is missing"},
        {"a.ply", PLY_TEXT "element vertex x\n", FORMAT_AT(3), "'x' is not a whole number"},
        {"a.ply", PLY_TEXT "element vertex -4\n", FORMAT_AT(3), "negative"},
        {"a.ply", PLY_TEXT "property float x\n", FORMAT_AT(3), "precedes the first element"},
        {"a.ply", PLY_TEXT PLY_VERTEX "property quad w\n", FORMAT_AT(7), "unknown type 'quad'"},
        {"a.ply", PLY_TEXT PLY_VERTEX "property float x\n", FORMAT_AT(7), "twice"},
        {"a.ply", PLY_TEXT PLY_VERTEX "element vertex 3\n", FORMAT_AT(7), "twice"},
        {"a.ply", PLY_TEXT PLY_VERTEX "property list float int a\n", FORMAT_AT(7), "integer type"},
        {"a.ply", PLY_TEXT PLY_VERTEX "property list uchar int\n", FORMAT_AT(7),
         "name of the property"},
        {"a.ply", PLY_TEXT PLY_VERTEX PLY_FACE "end_header x\n", FORMAT_AT(9), "after end_header"},
        {"a.ply", PLY_TEXT PLY_VERTEX "end_header\n" OFF_VERTICES, STARG_ERROR_FORMAT,
         STARG_ELEMENT_NONE, 0, "no faces"},
        {"a.ply",
         PLY_TEXT "element vertex 4\nproperty float x\nproperty float z\n" PLY_FACE "end_header\n",
         FORMAT_AT(3), "no property y"},
        {"a.ply", PLY_TEXT PLY_VERTEX "element face 4\nproperty int vertex_indices\nend_header\n",
         FORMAT_AT(7), "no list property vertex_indices"},
        {"a.ply",
         PLY_TEXT
         "element vertex 100000000\nproperty float x\nproperty float y\nproperty float z\n" PLY_FACE
         "end_header\n" OFF_VERTICES OFF_FACES,
         FORMAT_AT(3), "100000000 items"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX "element face 9223372036854775807\nproperty list uchar int "
                             "vertex_index\nend_header\n" OFF_VERTICES OFF_FACES,
         FORMAT_AT(7), "the header declares"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES
                                      "3 0 2 1\n3 0 1 3\n3 1 2 4\n3 2 0 3\n",
         FORMAT_AT(16), "vertex 4"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES
                                      "3 0 2 1\n-3 0 1 3\n3 1 2 4\n3 2 0 3\n",
         FORMAT_AT(15), "negative"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES
                                      "3 0 2 1\n2 0 1\n3 1 2 4\n3 2 0 3\n  ",
         FORMAT_AT(15), "2 corners"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES
                                      "3 0 2 1\n3 0 1 1.5\n3 1 2 4\n3 2 0 3\n",
         FORMAT_AT(15), "'1.5'"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX
         "element face 4\nproperty list uchar float vertex_index\nend_header\n" OFF_VERTICES
         "3 0 2 1\n3 0 1 1.5\n3 1 2 4\n3 2 0 3\n",
         FORMAT_AT(15), "1.5 is not a whole number"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES
                                      "3 0 2 1\n3 0 1 3\n3 1 2 3\n        ",
         FORMAT_AT(17), "truncated"},
        {"a.ply", PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES OFF_FACES "5\n",
         FORMAT_AT(18), "'5' follows"},
        {"a.ply",
         PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n0 0 0\n0 0 0\n0 0 nan\n0 0 0\n" OFF_FACES,
         STARG_ERROR_RANGE, STARG_ELEMENT_VERTEX, 2, "line 12"},
    };
    expect_errors(files, COUNT(files));
}

/* ---- files ---- */

static void unreadable_files(void **state) {
    (void)state;
    static const char *const paths[] = {"/nonexistent/a.off", "/tmp", "/proc/self/mem"};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < COUNT(paths); i++) {
        starg_mesh *mesh = NULL;
        assert_int_equal(starg_mesh_read(context, paths[i], &mesh), STARG_ERROR_READ);
        assert_null(mesh);
        assert_non_null(strstr(starg_context_error(context)->message, paths[i]));
    }
    test_context_free(context);
}

static void long_names_leave_room_for_the_message(void **state) {
    (void)state;
    char name[2000];
    memset(name, 'n', sizeof name);
    memcpy(name + sizeof name - 5, ".off", 5);
    starg_context *context = test_context(1);
    starg_mesh *mesh = NULL;
    assert_int_equal(read_text(context, "OFF\n1 1 0\nx 0 0\n3 0 0 0\n", name, &mesh),
                     STARG_ERROR_FORMAT);
    const char *message = starg_context_error(context)->message;
    assert_non_null(strstr(message, "nnn.off', line 3: 'x' is not a number"));
    test_context_free(context);
}

static void reading_can_be_cancelled(void **state) {
    (void)state;
    starg_context_options options;
    starg_context_options_default(&options);
    options.progress = test_refuse;
    starg_context *context = NULL;
    starg_mesh *mesh = NULL;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    assert_int_equal(read_text(context, "OFF\n4 4 0\n" OFF_VERTICES OFF_FACES, "a.off", &mesh),
                     STARG_ERROR_CANCELLED);
    assert_null(mesh);
    test_context_free(context);
}

/* Memory runs out at the n-th block, for every n until reading succeeds. */
static void memory_may_give_out_anywhere(void **state) {
    (void)state;
    static const char *const texts[] = {
        "OFF\n4 1 0\n0 0 0\n2 0 0\n2 2 0\n1.5 .5 0\n4 0 1 2 3\n",
        "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1.5 .5 0\nf 1 2 3 4\n",
        PLY_TEXT PLY_VERTEX PLY_FACE "end_header\n" OFF_VERTICES OFF_FACES,
        "solid\n" STL_FACETS "endsolid\n",
    };
    for (size_t i = 0; i < COUNT(texts); i++) {
        starg_status status = STARG_ERROR_MEMORY;
        size_t n = 0;
        for (; status == STARG_ERROR_MEMORY; n++) {
            size_t left = 1;
            starg_context *context = test_scarce_context(0, &left);
            starg_mesh *mesh = NULL;
            left = n;
            status = read_text(context, texts[i], "nameless", &mesh);
            assert_true((mesh == NULL) == (status != STARG_OK));
            starg_mesh_free(mesh);
            test_context_free(context);
        }
        assert_int_equal(status, STARG_OK);
        assert_true(n > 3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(off_forms),
        cmocka_unit_test(off_errors),
        cmocka_unit_test(obj_forms),
        cmocka_unit_test(obj_errors),
        cmocka_unit_test(polygons_are_cut_in_place),
        cmocka_unit_test(huge_concave_polygons_are_refused),
        cmocka_unit_test(stl_text_forms),
        cmocka_unit_test(stl_binary_forms),
        cmocka_unit_test(stl_trailing_bytes),
        cmocka_unit_test(stl_errors),
        cmocka_unit_test(ply_memory),
        cmocka_unit_test(ply_text_forms),
        cmocka_unit_test(ply_binary_forms),
        cmocka_unit_test(ply_binary_truncations),
        cmocka_unit_test(ply_extra_values),
        cmocka_unit_test(ply_errors),
        cmocka_unit_test(unreadable_files),
        cmocka_unit_test(long_names_leave_room_for_the_message),
        cmocka_unit_test(reading_can_be_cancelled),
        cmocka_unit_test(memory_may_give_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
