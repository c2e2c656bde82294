/* SPDX-License-Identifier: Apache-2.0 */
/* A scene as 3MF, for printers: an object for each piece, or for the model if there are no pieces,
 * closed and outward as the format wants. A 3MF is a ZIP archive of XML; its entries are stored as
 * they are, so that their text is made twice: to find its length and checksum, and to write it. */
#include <stdarg.h>
#include <zlib.h>

#include "export/export.h"
#include "mesh/formats/io.h"
#include "starguard/picture.h"

static const char STAGE[] = "scene";

/* Where text goes: counted, and written where there is a stream. */
typedef struct sink {
    FILE *stream;
    uint64_t size;
    uLong checksum;
} sink;

__attribute__((format(printf, 2, 3))) static void put(sink *s, const char *format, ...) {
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    s->size += (uint64_t)length;
    s->checksum = crc32(s->checksum, (const Bytef *)line, (uInt)length);
    if (s->stream != NULL)
        fwrite(line, 1, (size_t)length, s->stream);
}

/* ---- texts ---- */

typedef struct printed_scene {
    const scene_job *job;
    uint32_t *local; /* number of a vertex of the pieces within its piece; UINT32_MAX: none */
} printed_scene;

static void put_types(sink *s, const printed_scene *scene) {
    (void)scene;
    put(s, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
           "<Default Extension=\"rels\" "
           "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
           "<Default Extension=\"model\" "
           "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n</Types>\n");
}

static void put_relations(sink *s, const printed_scene *scene) {
    (void)scene;
    put(s,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
        "<Relationship Target=\"/3D/3dmodel.model\" Id=\"model\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n"
        "</Relationships>\n");
}

static void put_vertex(sink *s, const double p[3]) {
    put(s, "<vertex x=\"%.17g\" y=\"%.17g\" z=\"%.17g\"/>\n", p[0], p[1], p[2]);
}

static void put_triangle(sink *s, const uint32_t corners[3]) {
    put(s, "<triangle v1=\"%lu\" v2=\"%lu\" v3=\"%lu\"/>\n", (unsigned long)corners[0],
        (unsigned long)corners[1], (unsigned long)corners[2]);
}

/* The same name for an object and its colour: some readers keep one of them, some the other. */
static const char *name_of(const printed_scene *scene, size_t object, char room[32]) {
    if (scene->job->surfaces.piece_count == 0)
        return "model";
    snprintf(room, 32, "piece_%04zu", object);
    return room;
}

static void begin_object(sink *s, const printed_scene *scene, size_t number) {
    char room[32];
    put(s,
        "<object id=\"%zu\" name=\"%s\" type=\"model\" pid=\"1\" pindex=\"%zu\">\n<mesh>\n"
        "<vertices>\n",
        number + 2, name_of(scene, number, room), number);
}

static void end_object(sink *s) {
    put(s, "</triangles>\n</mesh>\n</object>\n");
}

static void put_model(sink *s, const printed_scene *scene) {
    const starg_mesh *model = scene->job->scene->model;
    begin_object(s, scene, 0);
    for (size_t i = 0; i < starg_mesh_vertex_count(model); i++)
        put_vertex(s, starg_mesh_vertices(model) + 3 * i);
    put(s, "</vertices>\n<triangles>\n");
    for (size_t f = 0; f < starg_mesh_face_count(model); f++)
        put_triangle(s, starg_mesh_faces(model) + 3 * f);
    end_object(s);
}

/* Vertices are numbered within the piece, in the order in which its faces meet them. */
static void put_piece(sink *s, const printed_scene *scene, size_t piece) {
    const starg_piece_surfaces *surfaces = &scene->job->surfaces;
    size_t begin = 3 * surfaces->first_face[piece], end = 3 * surfaces->first_face[piece + 1];
    uint32_t count = 0;
    begin_object(s, scene, piece);
    for (size_t i = begin; i < end; i++)
        scene->local[surfaces->faces[i]] = UINT32_MAX;
    for (size_t i = begin; i < end; i++) {
        uint32_t *local = &scene->local[surfaces->faces[i]];
        if (*local == UINT32_MAX) {
            *local = count++;
            put_vertex(s, scene_piece_vertex(scene->job, surfaces->faces[i]));
        }
    }
    put(s, "</vertices>\n<triangles>\n");
    for (size_t i = begin; i < end; i += 3) {
        const uint32_t corners[3] = {scene->local[surfaces->faces[i]],
                                     scene->local[surfaces->faces[i + 1]],
                                     scene->local[surfaces->faces[i + 2]]};
        put_triangle(s, corners);
    }
    end_object(s);
}

static void put_content(sink *s, const printed_scene *scene) {
    size_t pieces = scene->job->surfaces.piece_count, objects = pieces > 0 ? pieces : 1;
    char room[32];
    put(s, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           "<model unit=\"millimeter\" xml:lang=\"en-US\" "
           "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
           "<resources>\n<basematerials id=\"1\">\n");
    for (size_t i = 0; i < objects; i++) {
        uint8_t rgb[3] = {SCENE_NEUTRAL[0], SCENE_NEUTRAL[1], SCENE_NEUTRAL[2]};
        if (pieces > 0)
            starg_distinct_color(i, rgb);
        put(s, "<base name=\"%s\" displaycolor=\"#%02X%02X%02X\"/>\n", name_of(scene, i, room),
            rgb[0], rgb[1], rgb[2]);
    }
    put(s, "</basematerials>\n");
    if (pieces == 0)
        put_model(s, scene);
    for (size_t p = 0; p < pieces; p++)
        put_piece(s, scene, p);
    put(s, "</resources>\n<build>\n");
    for (size_t i = 0; i < objects; i++)
        put(s, "<item objectid=\"%zu\"/>\n", i + 2);
    put(s, "</build>\n</model>\n");
}

/* ---- the archive ---- */

typedef struct zip_entry {
    const char *name;
    void (*put)(sink *s, const printed_scene *scene);
    sink counted;
    uint32_t offset;
} zip_entry;

enum { LOCAL_HEADER = 30, CENTRAL_HEADER = 46, ENTRIES = 3 };

static void put_half(FILE *stream, unsigned value) {
    fputc((int)(value & 0xFF), stream);
    fputc((int)(value >> 8 & 0xFF), stream);
}

/* What both headers of an entry have: no flags, stored, the first of January 1980. */
static void put_facts(FILE *stream, const zip_entry *entry) {
    enum { VERSION = 20, DATE = 0x21 };
    put_half(stream, VERSION);
    put_half(stream, 0);
    put_half(stream, 0);
    put_half(stream, 0);
    put_half(stream, DATE);
    little_put_word(stream, (uint32_t)entry->counted.checksum);
    little_put_word(stream, (uint32_t)entry->counted.size);
    little_put_word(stream, (uint32_t)entry->counted.size);
    put_half(stream, (unsigned)strlen(entry->name));
    put_half(stream, 0);
}

static void put_archive(FILE *stream, const printed_scene *scene, zip_entry *entries) {
    enum { LOCAL = 0x04034b50, CENTRAL = 0x02014b50, END = 0x06054b50, VERSION = 20 };
    uint32_t central = 0, size = 0;
    for (zip_entry *e = entries; e < entries + ENTRIES; e++) {
        sink writing = {.stream = stream};
        little_put_word(stream, LOCAL);
        put_facts(stream, e);
        fputs(e->name, stream);
        e->put(&writing, scene);
        central = e->offset + LOCAL_HEADER + (uint32_t)(strlen(e->name) + e->counted.size);
    }
    for (zip_entry *e = entries; e < entries + ENTRIES; e++) {
        little_put_word(stream, CENTRAL);
        put_half(stream, VERSION);
        put_facts(stream, e);
        put_half(stream, 0);        /* length of a comment */
        put_half(stream, 0);        /* disk */
        put_half(stream, 0);        /* attributes */
        little_put_word(stream, 0); /* more of them */
        little_put_word(stream, e->offset);
        fputs(e->name, stream);
        size += CENTRAL_HEADER + (uint32_t)strlen(e->name);
    }
    little_put_word(stream, END);
    put_half(stream, 0);
    put_half(stream, 0);
    put_half(stream, ENTRIES);
    put_half(stream, ENTRIES);
    little_put_word(stream, size);
    little_put_word(stream, central);
    put_half(stream, 0);
}

starg_status scene_write_3mf(starg_context *context, const scene_job *job, const char *path) {
    enum { SLACK = 1 << 16 }; /* for headers */
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    SCOPED_BY(starg_output_discard) starg_output output = {0};
    SCOPED uint32_t *local = NULL;
    zip_entry entries[ENTRIES] = {{.name = "[Content_Types].xml", .put = put_types},
                                  {.name = "_rels/.rels", .put = put_relations},
                                  {.name = "3D/3dmodel.model", .put = put_content}};
    uint64_t offset = 0;
    if (job->surfaces.piece_count == 0 && job->model_faces == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a .3mf holds pieces or a model, and there are none");
    TRY(starg_c_locale_enter(context, &locale));
    NEW(context, STAGE, local, job->surfaces.vertex_count);
    const printed_scene scene = {job, local};
    for (zip_entry *e = entries; e < entries + ENTRIES; e++) {
        e->offset = (uint32_t)offset;
        e->put(&e->counted, &scene);
        offset += LOCAL_HEADER + strlen(e->name) + e->counted.size;
        TRY(starg_check_cancel(context, STAGE));
    }
    if (offset > UINT32_MAX - SLACK)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "the surfaces make a .3mf of more than 4 GiB, which it cannot be");
    TRY(starg_output_open(context, STAGE, path, &output));
    put_archive(output.stream, &scene, entries);
    return starg_output_commit(&output);
}
