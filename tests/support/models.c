/* SPDX-License-Identifier: Apache-2.0 */
#include "models.h"

#include <string.h>

#include "starguard/sample.h"
#include "starguard/verify.h"

starg_mesh *test_mesh_of(starg_context *context, const shape *s) {
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, s->vertices, s->vertex_count, s->faces,
                                       s->face_count, &mesh));
    return mesh;
}

/* Consumes the mesh. */
static starg_solid *solid_from(starg_context *context, starg_mesh *mesh) {
    starg_solid *solid = NULL;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    starg_mesh_free(mesh);
    return solid;
}

starg_solid *test_solid_of(starg_context *context, const shape *s) {
    return solid_from(context, test_mesh_of(context, s));
}

starg_mesh *test_pose(starg_context *context, const char *name, int pose, size_t vertices) {
    starg_sample_options options;
    starg_mesh *mesh = NULL;
    starg_sample_options_default(&options);
    options.pose = pose;
    options.vertex_count = vertices;
    test_ok(context, starg_sample_create(context, name, &options, &mesh));
    return mesh;
}

starg_mesh *test_sample_mesh(starg_context *context, const char *name, size_t vertices) {
    return test_pose(context, name, 0, vertices);
}

starg_solid *test_sample(starg_context *context, const char *name, size_t vertices) {
    return solid_from(context, test_sample_mesh(context, name, vertices));
}

starg_morph *test_morph(starg_context *context, const starg_mesh *a, const double *images,
                        starg_morph_method method) {
    starg_morph_options options;
    starg_morph *morph = NULL;
    starg_morph_options_default(&options);
    options.method = method;
    options.candidates = 200;
    test_ok(context, starg_morph_create(context, a, images, &options, &morph));
    return morph;
}

bool test_same_mesh(const starg_mesh *a, const starg_mesh *b) {
    size_t vertices = starg_mesh_vertex_count(a), faces = starg_mesh_face_count(a);
    return vertices == starg_mesh_vertex_count(b) && faces == starg_mesh_face_count(b) &&
           memcmp(starg_mesh_vertices(a), starg_mesh_vertices(b), 24 * vertices) == 0 &&
           memcmp(starg_mesh_faces(a), starg_mesh_faces(b), 12 * faces) == 0;
}

void test_verified(starg_context *context, const char *name, const starg_mesh *mesh,
                   const starg_guards *guards) {
    starg_verdict *verdict = NULL;
    test_ok(context, starg_verify_guards(context, mesh, guards, &verdict));
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            print_error("%s: %s\n", name, verdict->claims[i].text);
    assert_true(verdict->passed);
    starg_verdict_free(context, verdict);
}

starg_guards *test_guard(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options) {
    starg_guards *guards = NULL;
    test_ok(context, starg_guard(context, solid, options, &guards));
    test_verified(context, "guards", starg_solid_mesh(solid), guards);
    return guards;
}

/* ---- tables ---- */

FILE *test_tables(const char *data) {
    char path[4400];
    snprintf(path, sizeof path, "%s/README.md", data);
    FILE *readme = fopen(path, "r");
    assert_non_null(readme);
    return readme;
}

static bool is_surface(const char *name) {
    static const char *const extensions[] = {".off", ".obj", ".ply", ".stl", ".STL"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot != NULL && i < sizeof extensions / sizeof *extensions; i++)
        if (strcmp(dot, extensions[i]) == 0)
            return true;
    return false;
}

bool test_next_row(FILE *readme, const char *data, test_row *row) {
    char line[8192];
    while (fgets(line, sizeof line, readme) != NULL) {
        if (sscanf(line, "## %63s", row->folder) == 1)
            continue;
        memset(row->cells, 0, sizeof row->cells);
        if (sscanf(line, "| %127s | %31s | %31s | %31s | %31s | %31s | %31s | %31s |", row->file,
                   row->cells[0], row->cells[1], row->cells[2], row->cells[3], row->cells[4],
                   row->cells[5], row->cells[6]) < 3 ||
            !is_surface(row->file))
            continue;
        snprintf(row->path, sizeof row->path, "%s/%s/%s", data, row->folder, row->file);
        return true;
    }
    return false;
}
