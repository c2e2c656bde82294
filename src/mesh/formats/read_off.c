/* SPDX-License-Identifier: Apache-2.0 */
/* Geomview OFF: a keyword, the counts of vertices, faces and edges, the vertices, the faces.
 * Letters before OFF declare further vertex data, which ends with the line, as do face colours.
 * Otherwise line breaks are free. */

#include "mesh/formats/scan.h"

typedef struct off_header {
    bool texture, color, normal;
    bool vertex_extras; /* normals, colours or texture coordinates follow each position */
    bool homogeneous;   /* 4OFF: four coordinates */
    bool dimension;     /* nOFF: states its number of coordinates */
    size_t length;      /* of the keyword */
} off_header;

static bool take(const char **at, const char *end, const char *prefix) {
    size_t length = strlen(prefix);
    if ((size_t)(end - *at) < length || memcmp(*at, prefix, length) != 0)
        return false;
    *at += length;
    return true;
}

/* [ST][C][N][4][n]OFF, followed by nothing or by a digit of the first count. */
static bool parse_keyword(starg_word word, off_header *header) {
    const char *at = word.text, *end = word.text + word.length;
    header->texture = take(&at, end, "ST");
    header->color = take(&at, end, "C");
    header->normal = take(&at, end, "N");
    header->vertex_extras = header->texture || header->color || header->normal;
    header->homogeneous = take(&at, end, "4");
    header->dimension = take(&at, end, "n");
    if (!take(&at, end, "OFF"))
        return false;
    header->length = (size_t)(at - word.text);
    return at == end || (*at >= '0' && *at <= '9');
}

bool starg_off_matches(const starg_source *source) {
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    off_header ignored;
    return starg_scan_word(&scan, &word) && parse_keyword(word, &ignored);
}

/* Reads the keyword and leaves the scanner after its last letter. */
static starg_status read_keyword(starg_scan *scan, off_header *header) {
    starg_word word;
    TRY(starg_scan_expect(scan, "the keyword OFF", &word));
    starg_place place = starg_at_line(word.line);
    if (!parse_keyword(word, header))
        return starg_source_fail(
            scan->source, place,
            "found '%s' instead of the keyword OFF, with which an OFF file begins",
            starg_word_excerpt(word).text);
    if (header->homogeneous || header->dimension)
        return starg_source_fail(
            scan->source, place,
            "%s: only points with three coordinates are supported; convert the file to plain OFF",
            starg_word_excerpt(word).text);
    scan->at = word.text + header->length;
    starg_scan ahead = *scan;
    if (starg_scan_word_here(&ahead, &word) && starg_word_is(word, "BINARY"))
        return starg_source_fail(
            scan->source, place,
            "binary OFF is not supported; convert the file to text OFF or to PLY");
    return STARG_OK;
}

/* Skips the edge count. It is unused and often missing; it is on the line of the face count, or
 * alone on the next one. */
static starg_status pass_edge_count(starg_scan *scan) {
    starg_word word;
    starg_scan ahead = *scan;
    if (!starg_scan_word_here(&ahead, &word)) {
        starg_word neighbour;
        if (!starg_scan_word(&ahead, &word) || starg_scan_word_here(&ahead, &neighbour))
            return STARG_OK;
    }
    *scan = ahead;
    int64_t edges;
    return starg_word_integer(scan, word, "the edge count", &edges);
}

/* Rejects counts that the rest of the file cannot hold, before allocating. */
static starg_status read_counts(starg_scan *scan, size_t *vertices, size_t *faces) {
    int64_t v, f;
    TRY(starg_scan_integer(scan, "the vertex count", &v));
    TRY(starg_scan_integer(scan, "the face count", &f));
    size_t line = scan->line;
    TRY(pass_edge_count(scan));
    enum { VERTEX_BYTES = 6, FACE_BYTES = 8 }; /* "0 0 0\n", "3 0 0 0\n" */
    int64_t left = (int64_t)(scan->end - scan->at) + 1;
    if (v < 0 || f < 0 || v > left / VERTEX_BYTES || f > left / FACE_BYTES)
        return starg_source_fail(
            scan->source, starg_at_line(line),
            "the header declares %lld vertices and %lld faces, too many for the %lld bytes that "
            "follow; the header is wrong or the file is truncated",
            (long long)v, (long long)f, (long long)left - 1);
    *vertices = (size_t)v;
    *faces = (size_t)f;
    return STARG_OK;
}

static starg_status read_vertices(starg_scan *scan, const off_header *header, size_t count,
                                  starg_mesh_builder *builder) {
    enum { MOST_EXTRAS = 11 }; /* normal 3, colour 4, texture 4 */
    for (size_t i = 0; i < count; i++) {
        double point[3], color[3];
        bool whole;
        for (int k = 0; k < 3; k++)
            TRY(starg_scan_real(scan, "a coordinate of a vertex", &point[k]));
        TRY(starg_builder_vertex(builder, point, starg_at_line(scan->line)));
        if (header->color && starg_scan_peek(*scan, header->normal ? 3 : 0, color, &whole))
            TRY(starg_builder_color(builder, color, whole ? 255 : 1));
        if (header->vertex_extras)
            TRY(starg_scan_extra_numbers(scan, MOST_EXTRAS, "an attribute of a vertex"));
        TRY(starg_builder_tick(builder, (size_t)(scan->at - scan->source->bytes)));
    }
    return STARG_OK;
}

static starg_status read_faces(starg_scan *scan, size_t count, starg_mesh_builder *builder) {
    enum { MOST_COLORS = 4 };
    for (size_t i = 0; i < count; i++) {
        int64_t corners, vertex;
        TRY(starg_scan_integer(scan, "the number of corners of a face", &corners));
        starg_place place = starg_at_line(scan->line);
        for (int64_t k = 0; k < corners; k++) {
            TRY(starg_scan_integer(scan, "a vertex index", &vertex));
            TRY(starg_builder_corner(builder, vertex, starg_at_line(scan->line)));
        }
        TRY(starg_builder_face(builder, place));
        starg_scan ahead = *scan;
        starg_word word;
        if (starg_scan_word_here(&ahead, &word))
            builder->left_out |= STARG_MESH_COLORS;
        TRY(starg_scan_extra_numbers(scan, MOST_COLORS, "the colour of a face"));
        TRY(starg_builder_tick(builder, (size_t)(scan->at - scan->source->bytes)));
    }
    return STARG_OK;
}

/* Reads what follows the counts into an empty builder. */
static starg_status read_data(starg_scan *scan, const off_header *header, size_t vertices,
                              size_t faces, starg_mesh_builder *builder) {
    starg_builder_restart(builder);
    TRY(starg_builder_reserve(builder, vertices, faces));
    TRY(read_vertices(scan, header, vertices, builder));
    TRY(read_faces(scan, faces, builder));
    return starg_scan_end(scan, "the counts in the header are too small");
}

/* Some programs write colours or normals of vertices that the keyword does not declare: if the file
 * makes no sense without them, what follows a position on its line is passed over. If that fails
 * too, the first error is reported. */
starg_status starg_off_read(starg_mesh_builder *builder) {
    starg_scan scan = starg_scan_make(builder->source);
    off_header header;
    size_t vertices = 0, faces = 0;
    TRY(read_keyword(&scan, &header));
    builder->left_out = header.texture ? STARG_MESH_TEXTURE : 0;
    TRY(read_counts(&scan, &vertices, &faces));
    const starg_scan begin = scan;
    starg_status status = read_data(&scan, &header, vertices, faces, builder);
    if (status != STARG_ERROR_FORMAT || header.vertex_extras)
        return status;
    off_header other = header;
    other.vertex_extras = true;
    scan = begin;
    status = read_data(&scan, &other, vertices, faces, builder);
    builder->left_out |= status == STARG_OK ? STARG_MESH_COLORS : 0;
    if (status != STARG_ERROR_FORMAT)
        return status;
    scan = begin;
    return read_data(&scan, &header, vertices, faces, builder);
}
