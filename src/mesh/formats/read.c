/* SPDX-License-Identifier: Apache-2.0 */
/* Reads a mesh of any format, recognized by content, or by file name if the content is
 * ambiguous. */
#include <strings.h>

#include "mesh/formats/io.h"

static const struct format {
    const char *extension;
    bool (*matches)(const starg_source *source);
    starg_status (*read)(starg_mesh_builder *builder);
} formats[] = {
    {".ply", starg_ply_matches, starg_ply_read}, {".vtk", starg_vtk_matches, starg_vtk_read},
    {".stl", starg_stl_matches, starg_stl_read}, {".off", starg_off_matches, starg_off_read},
    {".obj", starg_obj_matches, starg_obj_read}, {".vtp", starg_vtp_matches, starg_vtp_read},
};

enum { FORMATS = sizeof formats / sizeof formats[0] };

bool starg_has_extension(const char *name, const char *extension) {
    size_t length = strlen(name), tail = strlen(extension);
    return length >= tail && strcasecmp(name + length - tail, extension) == 0;
}

static starg_status detect(const starg_source *source, const char *name,
                           const struct format **out) {
    if (source->size == 0)
        return starg_source_fail(source, starg_at_file(), "the file is empty");
    for (int i = 0; i < FORMATS; i++) {
        if (formats[i].matches(source)) {
            *out = &formats[i];
            return STARG_OK;
        }
    }
    for (int i = 0; i < FORMATS; i++) {
        if (starg_has_extension(name, formats[i].extension)) {
            *out = &formats[i];
            return STARG_OK;
        }
    }
    if (starg_import_recognized(source->bytes, source->size, name))
        return starg_source_fail(source, starg_at_file(),
                                 "a scene (glTF, 3MF, COLLADA, FBX, X3D, IFC) is read from a file, "
                                 "not from memory or standard input");
    return starg_source_fail(
        source, starg_at_file(),
        "unknown format; use OFF, OBJ, PLY, STL or VTK (.vtk, .vtp), to which Blender, MeshLab "
        "or 'assimp export FILE MODEL.ply' convert others");
}

/* Skips a byte order mark. */
static void pass_byte_order_mark(starg_source *source) {
    if (source->size >= 3 && memcmp(source->bytes, "\xEF\xBB\xBF", 3) == 0) {
        source->bytes += 3;
        source->size -= 3;
    }
}

void starg_source_shorten(const char *name, char *shown, size_t size) {
    size_t length = strlen(name);
    if (length < size)
        memcpy(shown, name, length + 1);
    else
        snprintf(shown, size, "...%s", name + length - (size - 4));
}

static starg_status read_source(starg_source source, char **owned, starg_face_values *values,
                                starg_mesh **out) {
    starg_context *context = source.context;
    const char *name = source.name;
    char shown[256];
    starg_source_shorten(name, shown, sizeof shown);
    source.name = shown;
    SCOPED_BY(starg_builder_free)
    starg_mesh_builder builder = {.source = &source, .owned = owned, .values = values};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    const struct format *format = NULL;
    *out = NULL;
    IN_STAGE(context, "read");
    pass_byte_order_mark(&source);
    TRY(starg_check_cancel(context, STARG_MESH_FILE));
    TRY(starg_c_locale_enter(context, &locale));
    TRY(detect(&source, name, &format));
    TRY(format->read(&builder));
    return starg_builder_finish(&builder, out);
}

starg_status starg_mesh_read_with(starg_context *context, const void *bytes, size_t size,
                                  const char *name, starg_face_values *values, starg_mesh **out) {
    return read_source((starg_source){context, name, bytes, size}, NULL, values, out);
}

starg_status starg_mesh_read_memory(starg_context *context, const void *bytes, size_t size,
                                    const char *name, starg_mesh **out) {
    return starg_mesh_read_with(context, bytes, size, name, NULL, out);
}

starg_status starg_mesh_read(starg_context *context, const char *path, starg_mesh **out) {
    SCOPED char *bytes = NULL;
    const char *up;
    size_t size = 0;
    *out = NULL;
    TRY(starg_mesh_bytes(context, path, &bytes, &size, &up));
    if (up != NULL)
        starg_log(context, STARG_LOG_NOTICE, "%s ('starguard-import --up-axis' turns it)", up);
    const char *name = strcmp(path, "-") == 0 ? "standard input" : path;
    return read_source((starg_source){context, name, bytes, size}, &bytes, NULL, out);
}
