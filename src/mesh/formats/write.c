/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a mesh of any format; the file gets its name once it is complete. */
#include <inttypes.h>
#include <math.h>

#include "mesh/formats/io.h"
#include "mesh/mesh.h"

/* OFF: counts, vertices, faces with a colour (0 to 255) after the indices. */
static void write_off(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    const uint8_t *colors = extras->colors;
    fprintf(stream, "OFF\n%zu %zu 0\n", mesh->vertex_count, mesh->face_count);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const double *p = mesh->vertices + 3 * i;
        fprintf(stream, "%.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (size_t i = 0; i < mesh->face_count; i++) {
        const uint32_t *f = mesh->faces + 3 * i;
        fprintf(stream, "3 %" PRIu32 " %" PRIu32 " %" PRIu32, f[0], f[1], f[2]);
        if (colors != NULL)
            fprintf(stream, " %d %d %d", colors[3 * i], colors[3 * i + 1], colors[3 * i + 2]);
        fputc('\n', stream);
    }
}

/* OBJ: lines of v and f; indices count from 1. Face colours are not supported. */
static void write_obj(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    if (extras->note[0] != '\0')
        fprintf(stream, "# %s\n", extras->note);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const double *p = mesh->vertices + 3 * i;
        fprintf(stream, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (size_t i = 0; i < mesh->face_count; i++) {
        const uint32_t *f = mesh->faces + 3 * i;
        fprintf(stream, "f %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", f[0] + 1, f[1] + 1, f[2] + 1);
    }
}

static starg_mesh_writer *const writers[] = {
    [STARG_MESH_OFF] = write_off,
    [STARG_MESH_OBJ] = write_obj,
    [STARG_MESH_PLY_ASCII] = starg_ply_write_ascii,
    [STARG_MESH_PLY_BINARY] = starg_ply_write_binary,
    [STARG_MESH_STL_ASCII] = starg_stl_write_ascii,
    [STARG_MESH_STL_BINARY] = starg_stl_write_binary,
    [STARG_MESH_VTP] = starg_vtp_write,
};

void starg_mesh_write_options_default(starg_mesh_write_options *options) {
    *options = (starg_mesh_write_options){.format = STARG_MESH_AUTO};
}

static starg_mesh_format format_by_name(const char *path) {
    if (starg_has_extension(path, ".off"))
        return STARG_MESH_OFF;
    if (starg_has_extension(path, ".obj"))
        return STARG_MESH_OBJ;
    if (starg_has_extension(path, ".ply"))
        return STARG_MESH_PLY_BINARY;
    if (starg_has_extension(path, ".stl"))
        return STARG_MESH_STL_BINARY;
    if (starg_has_extension(path, ".vtp"))
        return STARG_MESH_VTP;
    return STARG_MESH_AUTO;
}

static starg_status choose_format(starg_context *context, const char *path,
                                  starg_mesh_format *format) {
    if (*format == STARG_MESH_AUTO)
        *format = format_by_name(path);
    if (*format >= STARG_MESH_OFF && *format <= STARG_MESH_VTP)
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_ARGUMENT, STARG_MESH_FILE,
                      "'%s' has no known format; use a name that ends in .off, .obj, .ply, .stl or "
                      ".vtp, or give a format",
                      path);
}

/* Does binary STL, which holds single precision, keep the surface? */
static starg_status check_single(starg_context *context, const starg_mesh *mesh, const char *path) {
    double origin[3];
    starg_mesh_origin(mesh, origin);
    bool far = origin[0] != 0 || origin[1] != 0 || origin[2] != 0;
    const single_place place = {
        .stage = STARG_MESH_FILE,
        .file = path,
        .what = "the mesh",
        .remedy = far ? "OFF, OBJ, PLY and text STL keep it, or put it near the origin "
                        "('starguard repair --origin auto')"
                      : "OFF, OBJ, PLY and text STL keep it"};
    return single_check(context, mesh, NULL, &place);
}

/* Subtracts the origin, and says so in `extras`. *moved is NULL where it is zero. */
static starg_status move_to_origin(starg_context *context, const starg_mesh *mesh,
                                   const double origin[3], starg_mesh_extras *extras,
                                   starg_mesh **moved) {
    SCOPED double *back = NULL;
    const single_place place = {.stage = STARG_MESH_FILE,
                                .what = "the mesh",
                                .how = "about this origin",
                                .remedy = "give one near the mesh"};
    if (origin[0] == 0 && origin[1] == 0 && origin[2] == 0)
        return STARG_OK;
    for (int k = 0; k < 3; k++)
        if (!(fabs(origin[k]) < STARG_COORDINATE_LIMIT))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STARG_MESH_FILE,
                              "the origin must be finite and below 1e100");
    TRY(starg_mesh_create(context, mesh->vertices, mesh->vertex_count, mesh->faces,
                          mesh->face_count, moved));
    TRY(starg_mesh_set_colors(*moved, mesh->colors));
    TRY(starg_mesh_set_texture(*moved, mesh->texture));
    NEW(context, STARG_MESH_FILE, back, 3 * mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        (*moved)->vertices[i] -= origin[i % 3];
        back[i] = (*moved)->vertices[i] + origin[i % 3];
    }
    TRY(single_compare(context, mesh, back, &place));
    snprintf(extras->note, sizeof extras->note, "origin %.17g %.17g %.17g", origin[0], origin[1],
             origin[2]);
    return STARG_OK;
}

starg_status starg_mesh_write(starg_context *context, const starg_mesh *mesh, const char *path,
                              const starg_mesh_write_options *options) {
    starg_mesh_write_options defaults;
    starg_mesh_write_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    starg_mesh_format format = options->format;
    SCOPED_BY(starg_output_discard) starg_output output = {0};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    SCOPED_BY(starg_mesh_drop) starg_mesh *moved = NULL;
    starg_mesh_extras extras = {.colors = options->face_colors, .marks = options->face_marks};
    TRY(choose_format(context, path, &format));
    TRY(starg_c_locale_enter(context, &locale));
    TRY(move_to_origin(context, mesh, options->origin, &extras, &moved));
    mesh = moved != NULL ? moved : mesh;
    if (format == STARG_MESH_STL_BINARY)
        TRY(check_single(context, mesh, path));
    TRY(starg_output_open(context, STARG_MESH_FILE, path, &output));
    writers[format](output.stream, mesh, &extras);
    TRY(starg_check_cancel(context, STARG_MESH_FILE));
    return starg_output_commit(&output);
}
