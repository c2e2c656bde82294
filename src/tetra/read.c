/* SPDX-License-Identifier: Apache-2.0 */
/* Reads a tetrahedral mesh of any format, recognized by content; TetGen's pair of files by name. */
#include "tetra/io.h"

static const struct format {
    bool (*matches)(const starg_source *source);
    starg_status (*read)(tet_builder *builder);
} formats[] = {
    {tet_vtk_matches, tet_vtk_read},
    {tet_gmsh_matches, tet_gmsh_read},
    {tet_medit_matches, tet_medit_read},
};

static const struct format *detect(const starg_source *source) {
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].matches(source))
            return &formats[i];
    return NULL;
}

static bool is_tetgen(const char *name) {
    return starg_has_extension(name, ".node") || starg_has_extension(name, ".ele");
}

bool starg_tetmesh_recognized(const void *bytes, size_t size, const char *name) {
    const starg_source source = {NULL, name, bytes, size};
    return is_tetgen(name) || (detect(&source) != NULL && !tet_vtk_is_surface(&source));
}

/* Runs a reader on sources with shortened names. */
static starg_status read_source(const starg_source *source, const starg_source *elements,
                                starg_tetmesh **out) {
    SCOPED_BY(tet_builder_free) tet_builder builder = {.points = {.source = source}};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    const struct format *format = NULL;
    IN_STAGE(source->context, "read");
    TRY(starg_check_cancel(source->context, STARG_MESH_FILE));
    TRY(starg_c_locale_enter(source->context, &locale));
    if (elements != NULL) {
        TRY(tet_tetgen_read(&builder, elements));
    } else {
        format = detect(source);
        if (format == NULL)
            return starg_source_fail(source, starg_at_file(),
                                     "unknown format; use MEDIT .mesh, legacy .vtk, Gmsh .msh, "
                                     "or TetGen .node and .ele; 'meshio convert IN out.vtk' "
                                     "converts others");
        TRY(format->read(&builder));
    }
    return tet_builder_finish(&builder, out);
}

starg_status starg_tetmesh_read_memory(starg_context *context, const void *bytes, size_t size,
                                       const char *name, starg_tetmesh **out) {
    char shown[256];
    *out = NULL;
    starg_source_shorten(name, shown, sizeof shown);
    const starg_source source = {context, shown, bytes, size};
    return read_source(&source, NULL, out);
}

/* The name with another extension, in a block of the context. */
static starg_status with_extension(starg_context *context, const char *path, const char *extension,
                                   char **out) {
    size_t stem = (size_t)(strrchr(path, '.') - path), tail = strlen(extension);
    NEW(context, STARG_MESH_FILE, *out, stem + tail + 1);
    memcpy(*out, path, stem);
    memcpy(*out + stem, extension, tail + 1);
    return STARG_OK;
}

static starg_status read_pair(starg_context *context, const char *path, starg_tetmesh **out) {
    starg_status status = STARG_OK;
    char *names[2] = {NULL}, *bytes[2] = {NULL}, shown[2][256];
    size_t size[2];
    STARG_TRY(with_extension(context, path, ".node", &names[0]));
    STARG_TRY(with_extension(context, path, ".ele", &names[1]));
    for (int i = 0; i < 2; i++) {
        STARG_TRY(starg_file_read(context, STARG_MESH_FILE, names[i], &bytes[i], &size[i]));
        starg_source_shorten(names[i], shown[i], sizeof shown[i]);
    }
    const starg_source points = {context, shown[0], bytes[0], size[0]};
    const starg_source elements = {context, shown[1], bytes[1], size[1]};
    STARG_TRY(read_source(&points, &elements, out));
done:
    for (int i = 0; i < 2; i++) {
        RELEASE(names[i], bytes[i]);
    }
    return status;
}

starg_status starg_tetmesh_read(starg_context *context, const char *path, starg_tetmesh **out) {
    SCOPED char *bytes = NULL;
    size_t size = 0;
    *out = NULL;
    if (is_tetgen(path))
        return read_pair(context, path, out);
    TRY(starg_file_read(context, STARG_MESH_FILE, path, &bytes, &size));
    const char *name = strcmp(path, "-") == 0 ? "standard input" : path;
    return starg_tetmesh_read_memory(context, bytes, size, name, out);
}
