/* SPDX-License-Identifier: Apache-2.0 */
/* Formats of scenes (glTF, 3MF, COLLADA, FBX, X3D, IFC), read by the program starguard-import. It
 * runs as a child with limits of memory and time and hands over a binary PLY: what crashes it does
 * not harm this process. It is the one beside the running program, or else in the search path. */
#include <stdlib.h>
#include <unistd.h>

#include "core/process.h"
#include "mesh/formats/io.h"

#define PROGRAM "starguard-import"

static const double SECONDS = 120; /* of processor time */
static const size_t LEAST_MEMORY = (size_t)1 << 30, MOST_MEMORY = (size_t)1 << 34;

enum { MEMORY_PER_BYTE = 64, PATH_ROOM = 4096, MOST_NAME = 4000 };

static bool begins_with(const char *bytes, size_t size, const char *text) {
    size_t length = strlen(text);
    return size >= length && memcmp(bytes, text, length) == 0;
}

bool starg_import_recognized(const char *bytes, size_t size, const char *name) {
    static const char *const extensions[] = {".glb", ".gltf", ".3mf", ".dae",
                                             ".fbx", ".x3d",  ".ifc"};
    static const char *const heads[] = {"glTF", "PK\003\004", "Kaydara FBX Binary",
                                        "ISO-10303-21;"};
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
        if (begins_with(bytes, size, heads[i]))
            return true;
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (starg_has_extension(name, extensions[i]))
            return true;
    return false;
}

/* The program beside this one, if there is any; otherwise its name. */
static const char *find_program(char room[PATH_ROOM]) {
    ssize_t length = readlink("/proc/self/exe", room, PATH_ROOM - sizeof PROGRAM - 1);
    while (length > 0 && room[length - 1] != '/')
        length--;
    if (length <= 0)
        return PROGRAM;
    memcpy(room + length, PROGRAM, sizeof PROGRAM);
    return access(room, X_OK) == 0 ? room : PROGRAM;
}

/* What that program makes of it: a PLY. */
static starg_status import(starg_context *context, const char *path, size_t file_size, char **bytes,
                           size_t *size) {
    char room[PATH_ROOM], safe[PATH_ROOM], shown[256], complaint[200] = "", reason[200];
    const char *program = find_program(room);
    size_t memory = file_size < MOST_MEMORY / MEMORY_PER_BYTE ? MEMORY_PER_BYTE * file_size : 0;
    starg_source_shorten(path, shown, sizeof shown);
    if (strcmp(path, "-") == 0 || strlen(path) > MOST_NAME)
        return starg_fail(
            context, STARG_ERROR_READ, STARG_MESH_FILE,
            "a scene (glTF, 3MF, COLLADA, FBX, X3D, IFC) is read from a file, not from "
            "standard input");
    snprintf(safe, sizeof safe, "%s%s", path[0] == '-' ? "./" : "", path);
    memory = memory == 0 ? MOST_MEMORY : memory < LEAST_MEMORY ? LEAST_MEMORY : memory;
    const char *const arguments[] = {program, safe, NULL};
    const starg_process_options options = {.seconds = SECONDS,
                                           .memory = memory,
                                           .output = bytes,
                                           .size = size,
                                           .complaint = complaint,
                                           .room = sizeof complaint};
    starg_status status = starg_process_run_with(context, STARG_MESH_FILE, arguments, &options);
    if (status != STARG_ERROR_SOLVER)
        return status;
    snprintf(reason, sizeof reason, "%s", starg_context_error(context)->message);
    if (strstr(reason, "is it installed") != NULL)
        return starg_fail(
            context, STARG_ERROR_FORMAT, STARG_MESH_FILE,
            "'%s' is a scene, which takes the program " PROGRAM
            ": install libassimp-dev and build again, or convert it by 'assimp export "
            "FILE MODEL.ply' (package assimp-utils)",
            shown);
    return starg_fail(context, STARG_ERROR_FORMAT, STARG_MESH_FILE, "'%s': %s", shown,
                      complaint[0] != '\0' ? complaint : reason);
}

/* glTF and 3MF define which axis is up; the others leave it to the file. */
static const char *up_of(const char *bytes, size_t size, const char *path) {
    if (begins_with(bytes, size, "glTF") || starg_has_extension(path, ".gltf"))
        return "y is up in glTF";
    return begins_with(bytes, size, "PK\003\004") ? "z is up in 3MF" : NULL;
}

starg_status starg_mesh_bytes(starg_context *context, const char *path, char **bytes, size_t *size,
                              const char **up) {
    TRY(starg_file_read(context, STARG_MESH_FILE, path, bytes, size));
    *up = NULL;
    if (!starg_import_recognized(*bytes, *size, path))
        return STARG_OK;
    size_t file_size = *size;
    *up = up_of(*bytes, *size, path);
    starg_release(context, *bytes);
    *bytes = NULL;
    return import(context, path, file_size, bytes, size);
}
