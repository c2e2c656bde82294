/* SPDX-License-Identifier: Apache-2.0 */
#include "failing_inputs.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "models.h"
#include "starguard/database.h"

static char folder[] = "/tmp/failing-inputs-XXXXXX";

const char *failing_input(const char *name) {
    static char paths[4][128];
    static size_t next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

input_bytes failing_input_bytes(const char *name) {
    input_bytes bytes = {0};
    struct stat info;
    FILE *file = fopen(failing_input(name), "rb");
    assert_true(file != NULL && fstat(fileno(file), &info) == 0);
    bytes.size = (size_t)info.st_size;
    bytes.data = malloc(bytes.size + 1);
    assert_non_null(bytes.data);
    assert_int_equal(fread(bytes.data, 1, bytes.size, file), bytes.size);
    fclose(file);
    return bytes;
}

static void write_text(const char *name, const char *text) {
    FILE *file = fopen(failing_input(name), "w");
    assert_true(file != NULL && fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* ---- models ---- */

static starg_mesh *mesh_from(starg_context *context, shape s) {
    starg_mesh *mesh = test_mesh_of(context, &s);
    shape_free(&s);
    return mesh;
}

static void make_meshes(failing_inputs *in) {
    static const double aside[3] = {0.5, 0.25, 0.25};
    shape box = shape_cube(1), open = shape_cube(1), crossed = shape_cube(1), other = shape_cube(1);
    for (size_t i = 0; i < box.vertex_count; i++)
        box.vertices[3 * i] *= 2;
    open.face_count--;
    shape_append(&crossed, &other, aside, 0);
    shape_free(&other);
    in->cube = mesh_from(in->context, shape_cube(1));
    in->box = mesh_from(in->context, box);
    in->room = mesh_from(in->context, shape_room());
    in->blob = mesh_from(in->context, shape_blob(1, 1));
    in->other_blob = mesh_from(in->context, shape_blob(0, 2));
    in->fine_blob = mesh_from(in->context, shape_blob(3, 3));
    in->open = mesh_from(in->context, open);
    in->crossed = mesh_from(in->context, crossed);
    test_ok(in->context, starg_solid_create(in->context, in->room, &in->solid));
    test_ok(in->context, starg_solid_create(in->context, in->cube, &in->simple));
}

/* ---- results ---- */

static void make_guards(failing_inputs *in) {
    test_ok(in->context, starg_guard(in->context, in->solid, NULL, &in->guards));
    test_ok(in->context, starg_visibility(in->context, in->solid, in->guards->positions,
                                          in->guards->count, NULL, &in->seen));
    test_ok(in->context, starg_skeleton_create(in->context, in->solid, NULL, &in->skeleton));
}

static void make_pieces(failing_inputs *in) {
    starg_decompose_options options;
    starg_tetra_options tetra;
    starg_decompose_options_default(&options);
    starg_tetra_options_default(&tetra);
    options.effort = 5;
    options.tetra.generator = STARG_TETRA_STUFFING;
    options.tetra.target = 60;
    tetra.generator = STARG_TETRA_STUFFING;
    tetra.target = 20;
    options.balls = STARG_BALLS_RAYS;
    test_ok(in->context, starg_decompose(in->context, in->solid, &options, &in->decomposition));
    test_ok(in->context,
            starg_tetmesh_from_solid(in->context, in->simple, &tetra, NULL, &in->tetmesh));
}

static void make_shapes(failing_inputs *in) {
    starg_descriptor_options options;
    starg_descriptor *other = NULL;
    starg_descriptor_options_default(&options);
    options.direction_count = 12;
    test_ok(in->context, starg_descriptor_create(in->context, in->room, &options, &in->descriptor));
    test_ok(in->context, starg_descriptor_create(in->context, in->box, &options, &other));
    const starg_descriptor *both[] = {in->descriptor, other};
    for (size_t i = 0; i < 2; i++) {
        test_ok(in->context, starg_signature_of_descriptor(in->context, both[i],
                                                           STARG_SIGNATURE_STAR, &in->stars[i]));
        test_ok(in->context, starg_signature_of_descriptor(in->context, both[i],
                                                           STARG_SIGNATURE_PAPER, &in->papers[i]));
    }
    starg_descriptor_free(in->context, other);
    test_ok(in->context, starg_map_create(in->context, in->blob, in->other_blob, NULL, &in->map));
    test_ok(in->context, starg_map_overlay(in->context, in->blob, in->other_blob, in->map));
}

/* ---- files ---- */

static void write_meshes(const failing_inputs *in) {
    static const char *const names[] = {"room.off", "room.obj", "room.ply", "room.stl"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        test_ok(in->context,
                starg_mesh_write(in->context, in->room, failing_input(names[i]), NULL));
    test_ok(in->context, starg_mesh_write(in->context, in->cube, failing_input("cube.off"), NULL));
    test_ok(in->context,
            starg_tetmesh_write(in->context, in->tetmesh, failing_input("tets.vtk"), NULL));
}

static void write_results(const failing_inputs *in) {
    static const char *const skeletons[] = {"skeleton.obj", "skeleton.cg", "skeleton.vtk"};
    starg_context *c = in->context;
    for (size_t i = 0; i < sizeof skeletons / sizeof *skeletons; i++)
        test_ok(c, starg_skeleton_write(c, in->skeleton, failing_input(skeletons[i]), 0));
    test_ok(c, starg_guards_write(c, in->guards, "room.off", failing_input("guards.json")));
    test_ok(c, starg_decomposition_write(c, in->decomposition, failing_input("pieces.vtk"), false));
    test_ok(c, starg_decomposition_write_report(c, in->decomposition, "room.off",
                                                failing_input("pieces.json")));
    test_ok(c, starg_descriptor_write(c, in->descriptor, "r", failing_input("descriptor.json")));
    test_ok(c, starg_map_write(c, in->map, failing_input("map.json")));
}

static void write_texts(void) {
    write_text("faces.txt", "0 2 # a comment\n1\n");
    write_text("weights.txt", "0 2.5\n1\n");
    write_text("named.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng a\nf 1 2 3\ng b\nf 1 3 4\n");
    write_text("points.txt", "0.5 0.5 0.5\nv 0.25 0.5 0.5 # a comment\n");
    write_text("samples.txt", "0.5 0.5 0.5 1 2 3\n# a comment\n0 0 0 4 5 6\n");
    write_text("landmarks.txt", "0 1\n1 2\n# by position\n1 0 0 0 0 1\n");
    write_text("classes.txt", "room.off room\ncube.off cube\n");
    write_text("tets.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"
                            "0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 0\nEnd\n");
    write_text("tets.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n"
                           "3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 6 1 2 3 4\n"
                           "$EndElements\n");
    write_text("tets.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
    write_text("tets.ele", "1 4 0\n1 1 2 3 4\n");
}

static void write_database(const failing_inputs *in) {
    starg_database *database = NULL;
    starg_database_report *report = NULL;
    const char *const files[] = {failing_input("room.off"), failing_input("cube.off")};
    test_ok(in->context, starg_database_create(in->context, failing_input("shapes.db")));
    test_ok(in->context, starg_database_open(in->context, failing_input("shapes.db"), &database));
    test_ok(in->context, starg_database_add(database, files, 2, &report));
    assert_int_equal(report->added, 2);
    starg_database_report_free(in->context, report);
    starg_database_close(database);
}

static void read_pieces(failing_inputs *in) {
    input_bytes mesh = failing_input_bytes("pieces.vtk"),
                report = failing_input_bytes("pieces.json");
    test_ok(in->context,
            starg_pieces_mesh_read_memory(in->context, mesh.data, mesh.size, "p", &in->pieces));
    test_ok(in->context, starg_pieces_report_read_memory(in->context, report.data, report.size, "r",
                                                         &in->report));
    free(mesh.data);
    free(report.data);
}

void failing_inputs_make(failing_inputs *in) {
    *in = (failing_inputs){.context = test_context(1)};
    assert_non_null(mkdtemp(folder));
    make_meshes(in);
    make_guards(in);
    make_pieces(in);
    make_shapes(in);
    write_meshes(in);
    write_results(in);
    write_texts();
    write_database(in);
    read_pieces(in);
}

static void remove_folder(void) {
    DIR *list = opendir(folder);
    for (struct dirent *entry; list != NULL && (entry = readdir(list)) != NULL;)
        if (entry->d_name[0] != '.')
            unlinkat(dirfd(list), entry->d_name, 0);
    if (list != NULL)
        closedir(list);
    rmdir(folder);
}

void failing_inputs_free(failing_inputs *in) {
    starg_context *c = in->context;
    for (size_t i = 0; i < 2; i++) {
        starg_signature_free(c, in->stars[i]);
        starg_signature_free(c, in->papers[i]);
    }
    starg_map_free(c, in->map);
    starg_descriptor_free(c, in->descriptor);
    starg_pieces_report_free(c, in->report);
    starg_pieces_mesh_free(c, in->pieces);
    starg_decomposition_free(c, in->decomposition);
    starg_skeleton_free(c, in->skeleton);
    starg_bits_free(in->seen);
    starg_guards_free(c, in->guards);
    starg_tetmesh_free(in->tetmesh);
    starg_solid_free(in->simple);
    starg_solid_free(in->solid);
    starg_mesh *const meshes[] = {in->cube,       in->box,       in->room, in->blob,
                                  in->other_blob, in->fine_blob, in->open, in->crossed};
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++)
        starg_mesh_free(meshes[i]);
    remove_folder();
    test_context_free(c);
}
