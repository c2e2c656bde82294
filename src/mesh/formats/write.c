/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a mesh of any format; the file gets its name once it is complete. */
#include <string.h>

#include "core/file.h"
#include "mesh/formats/io.h"
#include "mesh/single.h"

typedef void write_fn(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);

static write_fn *const writers[] = {
    [STARG_MESH_OFF] = starg_off_write,
    [STARG_MESH_OBJ] = starg_obj_write,
    [STARG_MESH_PLY_ASCII] = starg_ply_write_ascii,
    [STARG_MESH_PLY_BINARY] = starg_ply_write_binary,
    [STARG_MESH_STL_ASCII] = starg_stl_write_ascii,
    [STARG_MESH_STL_BINARY] = starg_stl_write_binary,
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
    return STARG_MESH_AUTO;
}

static starg_status choose_format(starg_context *context, const char *path,
                                  starg_mesh_format *format) {
    if (*format == STARG_MESH_AUTO)
        *format = format_by_name(path);
    if (*format >= STARG_MESH_OFF && *format <= STARG_MESH_STL_BINARY)
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_ARGUMENT, STARG_MESH_FILE,
                      "'%s' has no known format; use a name that ends in .off, .obj, .ply or .stl, "
                      "or give a format",
                      path);
}

/* Does binary STL, which holds single precision, keep the surface? */
static starg_status check_single(starg_context *context, const starg_mesh *mesh, const char *path) {
    static const double origin[3] = {0};
    const single_place place = {.stage = STARG_MESH_FILE,
                                .file = path,
                                .what = "the mesh",
                                .remedy = "OFF, OBJ, PLY and text STL keep it, and 'starguard "
                                          "repair --origin auto' puts it near the origin"};
    return single_check(context, mesh, origin, &place);
}

starg_status starg_mesh_write(starg_context *context, const starg_mesh *mesh, const char *path,
                              const starg_mesh_write_options *options) {
    starg_status status = STARG_OK;
    starg_mesh_write_options defaults;
    starg_mesh_write_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    starg_mesh_format format = options->format;
    starg_output output = {0};
    starg_c_locale locale = {0};
    STARG_TRY(choose_format(context, path, &format));
    if (format == STARG_MESH_STL_BINARY)
        STARG_TRY(check_single(context, mesh, path));
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_TRY(starg_output_open(context, STARG_MESH_FILE, path, &output));
    writers[format](output.stream, mesh, options->face_colors);
    STARG_TRY(starg_check_cancel(context, STARG_MESH_FILE));
    STARG_TRY(starg_output_commit(&output));
done:
    starg_output_discard(&output);
    starg_c_locale_leave(&locale);
    return status;
}
