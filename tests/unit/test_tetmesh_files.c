/* SPDX-License-Identifier: Apache-2.0 */
/* Files of tetrahedra: hand-written files of every format, round trips, and rejections, quick and
 * with a message that gives the place. */
#include "support.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "starguard/tetra.h"

static const char MEDIT[] = "MeshVersionFormatted 2\n# a comment\nDimension\n3\nVertices 5\n"
                            "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 -1.0 3\n"
                            "Edges\n1\n1 2 0\nTriangles 1 1 2 3 5\nHexahedra\n0\n"
                            "Tetrahedra\n2\n1 2 3 4 1\n1 2 3 5 2\nEnd\n";
static const char VTK[] = "# vtk DataFile Version 3.0\nwith a title 1 2 3\nASCII\n"
                          "DATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n"
                          "0 0 0 1 0 0\n0 1 0 0 0 1 0 0 -1\n"
                          "CELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 0 1 2 4\nCELL_TYPES 3\n10 5 10\n"
                          "CELL_DATA 3\nSCALARS material int 1\nLOOKUP_TABLE default\n1 9 2\n";
static const char VTK5[] = "# vtk DataFile Version 5.1\ntitle\nASCII\n"
                           "DATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
                           "0 0 0 1 0 0 0 1 0 0 0 1 0 0 -1\n\n"
                           "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n"
                           "0 1 2 3 0 1 2 4\nCELL_TYPES 2\n10\n10\n\nCELL_DATA 2\n"
                           "SCALARS piece int\nLOOKUP_TABLE default\n1 2\n";
static const char GMSH2[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n"
                            "3 1 \"Tetrahedra\"\n$EndPhysicalNames\n$Nodes\n5\n"
                            "10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n7 0 0 -1\n$EndNodes\n"
                            "$Elements\n3\n1 2 2 5 1 10 20 30\n2 4 2 1 6 10 20 30 40\n"
                            "3 4 2 2 6 10 20 30 7\n$EndElements\n";
static const char GMSH4[] = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 0\n"
                            "$EndEntities\n$Nodes\n2 5 1 5\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n"
                            "0 1 0\n3 1 1 2\n4\n5\n0 0 1 0.5 0.5 0.5\n0 0 -1 0 0 0\n$EndNodes\n"
                            "$Elements\n3 3 1 3\n2 1 2 1\n1 1 2 3\n3 1 4 1\n2 1 2 3 4\n3 2 4 1\n"
                            "3 1 2 3 5\n$EndElements\n";

static starg_status read_text(starg_context *context, const char *text, starg_tetmesh **mesh) {
    return starg_tetmesh_read_memory(context, text, strlen(text), "model.txt", mesh);
}

/* Two tetrahedra, the second negative, with regions 1 and 2. */
static void check_two(const starg_tetmesh *mesh) {
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};
    static const uint32_t tetrahedra[] = {0, 1, 2, 3, 0, 1, 4, 2};
    static const int32_t regions[] = {1, 2};
    assert_int_equal(starg_tetmesh_vertex_count(mesh), 5);
    assert_int_equal(starg_tetmesh_count(mesh), 2);
    assert_memory_equal(starg_tetmesh_vertices(mesh), points, sizeof points);
    assert_memory_equal(starg_tetmesh_tetrahedra(mesh), tetrahedra, sizeof tetrahedra);
    assert_non_null(starg_tetmesh_regions(mesh));
    assert_memory_equal(starg_tetmesh_regions(mesh), regions, sizeof regions);
}

static void test_text_formats(void **state) {
    (void)state;
    static const char *const texts[] = {MEDIT, VTK, VTK5, GMSH2, GMSH4};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        starg_tetmesh *mesh = NULL;
        assert_true(starg_tetmesh_recognized(texts[i], strlen(texts[i]), "x"));
        test_ok(context, read_text(context, texts[i], &mesh));
        check_two(mesh);
        starg_tetmesh_free(mesh);
    }
    /* without cell types: four corners make a tetrahedron */
    char cut[sizeof VTK];
    starg_tetmesh *mesh = NULL;
    memcpy(cut, VTK, sizeof VTK);
    *strstr(cut, "CELL_TYPES") = '\0';
    test_ok(context, read_text(context, cut, &mesh));
    assert_int_equal(starg_tetmesh_count(mesh), 2);
    starg_tetmesh_free(mesh);
    assert_false(starg_tetmesh_recognized("OFF\n", 4, "x.off"));
    assert_false(starg_tetmesh_recognized("", 0, "x.mesh"));
    assert_true(starg_tetmesh_recognized("", 0, "x.ele"));
    test_context_free(context);
}

/* ---- hand-made binary files ---- */

typedef struct bytes {
    unsigned char data[4096];
    size_t size;
    bool big;
} bytes;

static void put_text(bytes *b, const char *text) {
    memcpy(b->data + b->size, text, strlen(text));
    b->size += strlen(text);
}

static void put(bytes *b, uint64_t bits, size_t size) {
    for (size_t i = 0; i < size; i++)
        b->data[b->size + (b->big ? size - 1 - i : i)] = (unsigned char)(bits >> 8 * i);
    b->size += size;
}

static void put_int(bytes *b, int64_t value) {
    put(b, (uint64_t)value, 4);
}

static void put_double(bytes *b, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(b, bits, 8);
}

static const double FIVE[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};
static const int CORNERS[2][4] = {{1, 2, 3, 4}, {1, 2, 3, 5}};

static void gmsh2(bytes *b) {
    put_text(b, "$MeshFormat\n2.2 1 8\n");
    put_int(b, 1);
    put_text(b, "\n$EndMeshFormat\n$Nodes\n5\n");
    for (int i = 0; i < 5; i++) {
        put_int(b, i + 1);
        for (int k = 0; k < 3; k++)
            put_double(b, FIVE[3 * i + k]);
    }
    put_text(b, "\n$EndNodes\n$Elements\n3\n");
    for (int v = 0; v < 3; v++)
        put_int(b, (const int[]){15, 1, 0}[v]); /* a point without tags */
    put_int(b, 1);
    put_int(b, 1);
    for (int v = 0; v < 3; v++)
        put_int(b, (const int[]){4, 2, 2}[v]);
    for (int t = 0; t < 2; t++) {
        put_int(b, t + 2);
        put_int(b, t + 1);
        put_int(b, 77);
        for (int k = 0; k < 4; k++)
            put_int(b, CORNERS[t][k]);
    }
    put_text(b, "\n$EndElements\n");
}

static void gmsh4(bytes *b) {
    put_text(b, "$MeshFormat\n4.1 1 8\n");
    put_int(b, 1);
    put_text(b, "\n$EndMeshFormat\n$Nodes\n");
    for (int v = 0; v < 4; v++)
        put(b, (const uint64_t[]){1, 5, 1, 5}[v], 8);
    for (int v = 0; v < 3; v++)
        put_int(b, (const int[]){3, 1, 0}[v]);
    put(b, 5, 8);
    for (uint64_t i = 0; i < 5; i++)
        put(b, i + 1, 8);
    for (int i = 0; i < 15; i++)
        put_double(b, FIVE[i]);
    put_text(b, "\n$EndNodes\n$Elements\n");
    for (int v = 0; v < 4; v++)
        put(b, (const uint64_t[]){2, 2, 1, 2}[v], 8);
    for (int t = 0; t < 2; t++) {
        put_int(b, 3);
        put_int(b, t + 1);
        put_int(b, 4);
        put(b, 1, 8);
        put(b, (uint64_t)t + 1, 8);
        for (int k = 0; k < 4; k++)
            put(b, (uint64_t)CORNERS[t][k], 8);
    }
    put_text(b, "\n$EndElements\n");
}

static void vtk(bytes *b) {
    put_text(b, "# vtk DataFile Version 2.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
                "POINTS 5 double\n");
    for (int i = 0; i < 15; i++)
        put_double(b, FIVE[i]);
    put_text(b, "\nCELLS 2 10\n");
    for (int t = 0; t < 2; t++) {
        put_int(b, 4);
        for (int k = 0; k < 4; k++)
            put_int(b, CORNERS[t][k] - 1);
    }
    put_text(b, "\nCELL_TYPES 2\n");
    put_int(b, 10);
    put_int(b, 10);
    put_text(b, "\nCELL_DATA 2\nSCALARS piece int 1\nLOOKUP_TABLE default\n");
    put_int(b, 1);
    put_int(b, 2);
    put_text(b, "\n");
}

/* Every binary file, complete and truncated after every byte: an error or a mesh. */
static void check_binary(starg_context *context, const bytes *b, size_t least) {
    starg_tetmesh *mesh = NULL;
    test_ok(context, starg_tetmesh_read_memory(context, b->data, b->size, "b", &mesh));
    check_two(mesh);
    starg_tetmesh_free(mesh);
    for (size_t size = 0; size < b->size; size++) {
        unsigned char *copy = malloc(size + 1);
        assert_non_null(copy);
        memcpy(copy, b->data, size);
        starg_status status = starg_tetmesh_read_memory(context, copy, size, "b", &mesh);
        assert_true(status == STARG_ERROR_FORMAT || (size >= least && status == STARG_OK));
        assert_int_equal(mesh != NULL, status == STARG_OK);
        starg_tetmesh_free(mesh);
        free(copy);
    }
}

static void test_binary_formats(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int big = 0; big < 2; big++) {
        bytes two = {.big = big != 0}, four = {.big = big != 0};
        gmsh2(&two);
        gmsh4(&four);
        check_binary(context, &two, two.size - 14);
        check_binary(context, &four, four.size - 14);
    }
    bytes grid = {.big = true};
    vtk(&grid);
    check_binary(context, &grid, 200); /* labels and even types may be missing */
    test_context_free(context);
}

/* ---- rejections ---- */

typedef struct bad {
    const char *text, *says;
} bad;

#define MEDIT_HEAD "MeshVersionFormatted 1\nDimension 3\n"
#define FOUR       "Vertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
#define VTK_HEAD   "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n"
#define VTK_FOUR   "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n"
#define GMSH_HEAD  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define GMSH_FOUR  "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"

static const bad BAD[] = {
    {"", "unknown format"},
    {"hello", "unknown format"},
    {MEDIT_HEAD, "no tetrahedra"},
    {"MeshVersionFormatted 1\nDimension 2\n", "dimension is 2"},
    {"MeshVersionUnformatted 1\n", "text format"},
    {MEDIT_HEAD "Vertices\n100000000\n0 0 0 0\n", "too many for"},
    {MEDIT_HEAD FOUR "Tetrahedra\n100000000\n1 2 3 4 0\n", "too many for"},
    {MEDIT_HEAD FOUR "Tetrahedra\n-1\n1 2 3 4 0\n", "too many for"},
    {MEDIT_HEAD FOUR "Tetrahedra\n1\n1 2 3 5 0\n", "vertex 4"},
    {MEDIT_HEAD FOUR "Tetrahedra\n1\n0 1 2 3 0\n", "line 11"},
    {MEDIT_HEAD FOUR "Tetrahedra\n1\n1 2 3 x 0\n", "'x' is not a whole number"},
    {MEDIT_HEAD FOUR "Tetrahedra\n1\n1 2 3 4", "too many for"},
    {MEDIT_HEAD FOUR "Tetrahedra\n2\n1 2 3 4 0\n1 2 3 4  ", "truncated"},
    {MEDIT_HEAD FOUR "Hexahedra\n1\n1 2 3 4 5 6 7 8 0\n", "a hexahedron"},
    {MEDIT_HEAD "Vertices\n1\n0 0 1e100 0\n", "coordinate z"},
    {"# vtk DataFile Version 2.0\nt\nASCII\nDATASET POLYDATA\n", "POLYDATA"},
    {"# vtk DataFile Version 2.0\nt\nXML\n", "ASCII or BINARY"},
    {VTK_HEAD "POINTS 100000000 double\n0 0 0\n", "too many for"},
    {VTK_HEAD "POINTS 1 int\n0 0 0\n", "double or float"},
    {VTK_HEAD VTK_FOUR "CELLS 100000000 500000000\n4 0 1 2 3\n", "too many for"},
    {VTK_HEAD VTK_FOUR "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 100000000\n10\n", "cell types"},
    {VTK_HEAD VTK_FOUR "CELLS 1 4\n4 0 1 2 3\nCELL_TYPES 1\n10\n", "do not add up"},
    {VTK_HEAD VTK_FOUR "CELLS 1 6\n4 0 1 2 3\nCELL_TYPES 1\n10\n", "do not add up"},
    {VTK_HEAD VTK_FOUR "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n12\n", "type 12"},
    {VTK_HEAD VTK_FOUR "CELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n", "vertex 4"},
    {VTK_HEAD VTK_FOUR "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n", "no tetrahedra"},
    {VTK_HEAD VTK_FOUR "CELLS 2 4\nOFFSETS vtktypeint64\n0 5\nCONNECTIVITY vtktypeint64\n0 1 2 3\n",
     "do not add up"},
    {"$MeshFormat\n4 0 8\n$EndMeshFormat\n", "version 4 is not supported"},
    {"$NOD\n1\n", "version 1"},
    {GMSH_HEAD "$Nodes\n100000000\n1 0 0 0\n", "too many for"},
    {GMSH_HEAD GMSH_FOUR "$Elements\n100000000\n1 4 0 1 2 3 4\n", "too many for"},
    {GMSH_HEAD GMSH_FOUR "$Elements\n1\n1 4 0 1 2 3 5\n", "node 5"},
    {GMSH_HEAD GMSH_FOUR "$Elements\n1\n1 5 0 1 2 3 4 1 2 3 4\n", "type 5"},
    {GMSH_HEAD "$Other\n1 2 3\n", "no end"},
    {"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 100000000\n1\n", "too many for"},
};

static void test_refused(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
        starg_tetmesh *mesh = NULL;
        starg_status status = read_text(context, BAD[i].text, &mesh);
        const char *message = starg_context_error(context)->message;
        if (status == STARG_OK || strstr(message, BAD[i].says) == NULL ||
            strstr(message, "model.txt") == NULL)
            fail_msg("case %zu: %s", i, message);
        assert_true(status == STARG_ERROR_FORMAT || status == STARG_ERROR_RANGE);
        assert_null(mesh);
    }
    assert_true(starg_context_peak_bytes(context) < 100000);
    /* errors that do not concern the text are reported with indices */
    starg_tetmesh *mesh = NULL;
    assert_int_equal(
        read_text(context, MEDIT_HEAD FOUR "Tetrahedra\n2\n1 2 3 4 0\n2 3 4 4 0\n", &mesh),
        STARG_ERROR_MESH);
    assert_int_equal(starg_context_error(context)->indices[0], 1);
    test_context_free(context);
}

/* ---- files ---- */

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static void test_tetgen(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    char folder[] = "/tmp/starguard-test-XXXXXX", node[64], ele[64];
    assert_non_null(mkdtemp(folder));
    snprintf(node, sizeof node, "%s/m.node", folder);
    snprintf(ele, sizeof ele, "%s/m.ele", folder);
    write_file(node, "5 3 1 1\n# c\n1 0 0 0 9 1\n2 1 0 0 9 1\n3 0 1 0 9 1\n4 0 0 1 9 0\n"
                     "5 0 0 -1 9 0\n# Generated\n");
    starg_tetmesh *mesh = NULL;
    assert_int_equal(starg_tetmesh_read(context, node, &mesh), STARG_ERROR_READ);
    write_file(ele, "2 4 1\n1 1 2 3 4 1\n2 1 2 3 5 2\n");
    test_ok(context, starg_tetmesh_read(context, node, &mesh));
    check_two(mesh);
    starg_tetmesh_free(mesh);
    test_ok(context, starg_tetmesh_read(context, ele, &mesh));
    check_two(mesh);
    starg_tetmesh_free(mesh);
    write_file(ele, "2 10 0\n");
    assert_int_equal(starg_tetmesh_read(context, ele, &mesh), STARG_ERROR_FORMAT);
    write_file(ele, "100000000 4 0\n1 1 2 3 4\n");
    assert_int_equal(starg_tetmesh_read(context, ele, &mesh), STARG_ERROR_FORMAT);
    write_file(ele, "1 4 0\n1 1 2 3 6\n");
    assert_int_equal(starg_tetmesh_read(context, ele, &mesh), STARG_ERROR_FORMAT);
    unlink(node);
    unlink(ele);
    assert_int_equal(starg_tetmesh_read(context, "/tmp/.node/none", &mesh), STARG_ERROR_READ);
    assert_int_equal(rmdir(folder), 0);
    test_context_free(context);
}

static void test_round_trip(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    char folder[] = "/tmp/starguard-test-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/m.vtk", folder);
    const double points[] = {0.1, 1.0 / 3, 1e-300, 1e90, 0, -0.0, 0, 1e90, 3, 0, 0, 1e90};
    const uint32_t tetrahedra[] = {0, 1, 2, 3};
    const int32_t labels[] = {-5}, two_labels[] = {3, 4};
    starg_tetmesh_write_options options;
    starg_tetmesh_write_options_default(&options);
    for (int binary = 0; binary < 2; binary++) {
        starg_tetmesh *mesh = NULL, *again = NULL;
        options.binary = binary != 0;
        options.labels = labels;
        test_ok(context, starg_tetmesh_create(context, points, 4, tetrahedra, 1, NULL, &mesh));
        test_ok(context, starg_tetmesh_write(context, mesh, path, &options));
        test_ok(context, starg_tetmesh_read(context, path, &again));
        assert_memory_equal(starg_tetmesh_vertices(again), points, sizeof points);
        assert_memory_equal(starg_tetmesh_tetrahedra(again), tetrahedra, sizeof tetrahedra);
        assert_null(starg_tetmesh_regions(again)); /* a uniform label is dropped */
        starg_tetmesh_free(again);
        starg_tetmesh_free(mesh);
        test_ok(context, read_text(context, MEDIT, &mesh));
        options.labels = two_labels;
        test_ok(context, starg_tetmesh_write(context, mesh, path, &options));
        test_ok(context, starg_tetmesh_read(context, path, &again));
        assert_memory_equal(starg_tetmesh_regions(again), two_labels, sizeof two_labels);
        starg_tetmesh_free(again);
        options.labels = NULL; /* the mesh's own */
        test_ok(context, starg_tetmesh_write(context, mesh, path, &options));
        test_ok(context, starg_tetmesh_read(context, path, &again));
        check_two(again);
        starg_tetmesh_free(again);
        options.name = "two words";
        assert_int_equal(starg_tetmesh_write(context, mesh, path, &options), STARG_ERROR_ARGUMENT);
        options.name = "piece";
        assert_int_equal(starg_tetmesh_write(context, mesh, "/nowhere/m.vtk", NULL),
                         STARG_ERROR_WRITE);
        starg_tetmesh_free(mesh);
    }
    unlink(path);
    assert_int_equal(rmdir(folder), 0);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text_formats), cmocka_unit_test(test_binary_formats),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_tetgen),
        cmocka_unit_test(test_round_trip)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
