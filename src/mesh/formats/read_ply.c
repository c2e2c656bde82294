/* SPDX-License-Identifier: Apache-2.0 */
/* PLY (Stanford polygon format): a text header that declares elements and their properties, then
 * the elements as text or binary of either byte order. Types and order of properties are free;
 * unknown elements and properties are skipped. If faces precede the vertices, they are skipped
 * first and read at the end.
 *
 * Text is read value by value, ignoring line breaks. Some programs write more values per item than
 * declared: if that makes reading fail, it is repeated line by line. */
#include <math.h>

#include "mesh/formats/ply.h"

static size_t bytes_read(const ply_reader *ply) {
    return ply->dropped + (size_t)(ply->scan.at - ply->base);
}

static starg_place place_of(const ply_reader *ply) {
    return ply->encoding == PLY_TEXT ? starg_at_line(ply->scan.line)
                                     : starg_at_byte(bytes_read(ply));
}

/* The place of the value just read, given the cursor's place before it: a text scanner advances to
 * a word's line only when it reads the word. */
static starg_place place_since(const ply_reader *ply, starg_place before) {
    return ply->encoding == PLY_TEXT ? place_of(ply) : before;
}

static starg_status need(const ply_reader *ply, size_t bytes) {
    if (bytes <= (size_t)(ply->scan.end - ply->scan.at))
        return STARG_OK;
    return starg_source_fail(ply->source, place_of(ply),
                             "the file ends within its data; it seems to be truncated");
}

/* The next `size` bytes as a number in the file's byte order. */
static uint64_t take_bits(ply_reader *ply, size_t size) {
    const unsigned char *bytes = (const unsigned char *)ply->scan.at;
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)bytes[i] << 8 * (ply->encoding == PLY_LITTLE ? i : size - 1 - i);
    ply->scan.at += size;
    return bits;
}

static double float_of(ply_type type, uint64_t bits) {
    if (type == PLY_FLOAT32) {
        uint32_t half = (uint32_t)bits;
        float value;
        memcpy(&value, &half, sizeof value);
        return (double)value;
    }
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int64_t integer_of(ply_type type, uint64_t bits) {
    switch (type) {
    case PLY_INT8:
        return (int8_t)bits;
    case PLY_INT16:
        return (int16_t)bits;
    case PLY_INT32:
        return (int32_t)bits;
    default:
        return (int64_t)bits; /* unsigned, at most 32 bits */
    }
}

static starg_status read_real(ply_reader *ply, ply_type type, const char *what, double *value) {
    if (ply->encoding == PLY_TEXT)
        return starg_scan_real(&ply->scan, what, value);
    TRY(need(ply, starg_ply_type_size(type)));
    uint64_t bits = take_bits(ply, starg_ply_type_size(type));
    *value = type >= PLY_FLOAT32 ? float_of(type, bits) : (double)integer_of(type, bits);
    return STARG_OK;
}

/* Floating types may hold integers. */
static starg_status read_integer(ply_reader *ply, ply_type type, const char *what, int64_t *value) {
    if (type >= PLY_FLOAT32) {
        double real;
        starg_place before = place_of(ply);
        starg_status status = read_real(ply, type, what, &real);
        if (status != STARG_OK)
            return status;
        if (!(fabs(real) <= 0x1p53) || real != floor(real))
            return starg_source_fail(ply->source, place_since(ply, before),
                                     "%g is not a whole number; %s should stand here", real, what);
        *value = (int64_t)real;
        return STARG_OK;
    }
    if (ply->encoding == PLY_TEXT)
        return starg_scan_integer(&ply->scan, what, value);
    starg_status status = need(ply, starg_ply_type_size(type));
    if (status == STARG_OK)
        *value = integer_of(type, take_bits(ply, starg_ply_type_size(type)));
    return status;
}

static starg_status skip_values(ply_reader *ply, ply_type type, uint64_t count) {
    if (ply->encoding == PLY_TEXT) {
        starg_word word;
        for (uint64_t i = 0; i < count; i++)
            TRY(starg_scan_expect(&ply->scan, "the value of a property", &word));
        return STARG_OK;
    }
    size_t left = (size_t)(ply->scan.end - ply->scan.at);
    if (count > left / starg_ply_type_size(type))
        return need(ply, left + 1);
    ply->scan.at += count * starg_ply_type_size(type);
    return STARG_OK;
}

/* Reads texture coordinates of the corners of a face. */
static starg_status read_texture(ply_reader *ply, const ply_property *property, uint64_t count) {
    for (uint64_t i = 0; i < count / 2; i++) {
        double uv[2];
        for (int k = 0; k < 2; k++)
            TRY(read_real(ply, property->type, "a texture coordinate", &uv[k]));
        TRY(starg_builder_corner_texture(ply->builder, uv));
    }
    return skip_values(ply, property->type, count % 2);
}

static starg_status read_list(ply_reader *ply, const ply_property *property, bool skip) {
    int64_t count, vertex;
    starg_place before = place_of(ply);
    TRY(read_integer(ply, property->count_type, "the size of a list", &count));
    if (count < 0)
        return starg_source_fail(ply->source, place_since(ply, before),
                                 "the size of a list is negative");
    if (property->role == PLY_TEXTURE && !skip)
        return read_texture(ply, property, (uint64_t)count);
    if (property->role != PLY_CORNERS || skip)
        return skip_values(ply, property->type, (uint64_t)count);
    for (int64_t i = 0; i < count; i++) {
        before = place_of(ply);
        TRY(read_integer(ply, property->type, "a vertex index", &vertex));
        TRY(starg_builder_corner(ply->builder, vertex, place_since(ply, before)));
    }
    return STARG_OK;
}

/* Reads a strip: each vertex makes a triangle with the two before it, of alternating sides; -1
 * begins anew. Triangles that repeat a corner only turn the strip. */
static starg_status read_strip(ply_reader *ply, const ply_property *property) {
    int64_t count, vertex, former[2] = {-1, -1};
    size_t length = 0;
    TRY(read_integer(ply, property->count_type, "the size of a list", &count));
    for (int64_t i = 0; i < count; i++) {
        starg_place before = place_of(ply);
        TRY(read_integer(ply, property->type, "a vertex index", &vertex));
        starg_place place = place_since(ply, before);
        bool distinct = vertex != former[0] && vertex != former[1] && former[0] != former[1];
        if (vertex != -1 && length >= 2 && distinct) {
            TRY(starg_builder_corner(ply->builder, former[length % 2], place));
            TRY(starg_builder_corner(ply->builder, former[1 - length % 2], place));
            TRY(starg_builder_corner(ply->builder, vertex, place));
            TRY(starg_builder_face(ply->builder, place));
        }
        length = vertex == -1 ? 0 : length + 1;
        former[0] = former[1];
        former[1] = vertex;
    }
    return STARG_OK;
}

/* The value of a face with this number: 0 if no name with it is wanted. */
static double value_of(const ply_reader *ply, ply_naming naming, double number) {
    for (size_t i = 0; i < ply->names.count; i++) {
        const ply_name *name = &ply->names.data[i];
        if (name->naming == naming && (double)name->number == number)
            return name->collected > 0 ? name->collected : 1;
    }
    return 0;
}

/* The largest part of a colour. */
static double largest_part(ply_type type) {
    return type >= PLY_FLOAT32 ? 1 : type == PLY_UINT16 ? 65535 : 255;
}

/* Reads one item of an element; ignores its values if `skip`. */
static starg_status read_item(ply_reader *ply, const ply_element *element, bool skip) {
    starg_place before = place_of(ply);
    double point[3] = {0, 0, 0}, color[3], uv[2], most = 1, value;
    int colors = 0, textures = 0;
    if (ply->builder->values != NULL)
        ply->builder->values->current = 0;
    for (size_t i = 0; i < element->properties; i++) {
        const ply_property *property = &ply->properties.data[element->first + i];
        if (property->role == PLY_CORNERS && element->strips && !skip)
            TRY(read_strip(ply, property));
        else if (property->list)
            TRY(read_list(ply, property, skip));
        else if (property->role <= PLY_Z)
            TRY(read_real(ply, property->type, "a coordinate of a vertex", &point[property->role]));
        else if (property->role == PLY_U || property->role == PLY_V) {
            TRY(read_real(ply, property->type, "a texture coordinate",
                          &uv[property->role - PLY_U]));
            textures++;
        } else if (property->role >= PLY_RED) {
            TRY(read_real(ply, property->type, "a colour", &color[property->role - PLY_RED]));
            most = largest_part(property->type);
            colors++;
        } else if (property->naming != PLY_NAMELESS && ply->names.count > 0) {
            TRY(read_real(ply, property->type, "the value of a property", &value));
            value = value_of(ply, property->naming, value);
            if (value > 0)
                ply->builder->values->current = value;
        } else if (property->wanted) {
            TRY(read_real(ply, property->type, "the value of a property", &value));
            starg_values_take(ply->builder->values, value);
        } else
            TRY(skip_values(ply, property->type, 1));
    }
    starg_place place = place_since(ply, before);
    if (element->kind == PLY_VERTICES)
        TRY(starg_builder_vertex(ply->builder, point, place));
    if (element->kind == PLY_VERTICES && colors == 3)
        TRY(starg_builder_color(ply->builder, color, most));
    if (element->kind == PLY_VERTICES && textures == 2)
        TRY(starg_builder_vertex_texture(ply->builder, uv));
    if (element->kind == PLY_FACES && !element->strips && !skip)
        TRY(starg_builder_face(ply->builder, place));
    return starg_builder_tick(ply->builder, bytes_read(ply));
}

/* Reads one item on a line of its own. */
static starg_status read_line(ply_reader *ply, const ply_element *element, bool skip) {
    starg_scan ahead = ply->scan;
    starg_word word;
    TRY(starg_scan_expect(&ahead, "the value of a property", &word));
    TRY(read_item(ply, element, skip));
    if (ply->scan.line != word.line)
        return starg_source_fail(ply->source, starg_at_line(word.line), "the line is too short");
    if (starg_scan_word_here(&ply->scan, &word)) {
        if (ply->extra++ == 0)
            ply->first_extra = word.line;
        starg_scan_next_line(&ply->scan);
    }
    return STARG_OK;
}

static starg_status read_items(ply_reader *ply, const ply_element *element, bool skip) {
    if (element->properties == 0)
        return STARG_OK; /* items without bytes, whatever their number */
    starg_status status = STARG_OK;
    for (size_t i = 0; i < element->count && status == STARG_OK; i++)
        status = ply->by_lines ? read_line(ply, element, skip) : read_item(ply, element, skip);
    return status;
}

/* Only line ends may follow. */
static starg_status check_end(ply_reader *ply) {
    static const char hint[] = "the counts in the header do not fit the data";
    if (ply->encoding == PLY_TEXT)
        return starg_scan_end(&ply->scan, hint);
    const char *at = ply->scan.at;
    while (at < ply->scan.end && (*at == '\n' || *at == '\r'))
        at++;
    if (at == ply->scan.end)
        return STARG_OK;
    return starg_source_fail(ply->source, place_of(ply), "%zu bytes follow the data; %s",
                             (size_t)(ply->scan.end - ply->scan.at), hint);
}

/* Gives back what has been read, so that no more than the larger part of a file is in memory beside
 * the mesh. */
static void drop_read(ply_reader *ply) {
    char **owned = ply->builder->owned;
    const size_t left = (size_t)(ply->scan.end - ply->scan.at);
    if (owned == NULL || ply->encoding == PLY_TEXT)
        return;
    ply->dropped = bytes_read(ply);
    memmove(*owned, ply->scan.at, left);
    *owned = starg_shrink(ply->source->context, *owned, left + 1);
    ply->base = ply->scan.at = *owned;
    ply->scan.end = *owned + left;
}

static starg_status read_data(ply_reader *ply) {
    const ply_element *faces = starg_ply_find(ply, PLY_FACES),
                      *vertices = starg_ply_find(ply, PLY_VERTICES);
    bool late = faces < vertices;
    starg_scan begin_of_faces = ply->scan;
    for (size_t i = 0; i < ply->elements.count; i++) {
        const ply_element *element = &ply->elements.data[i];
        if (element == faces)
            begin_of_faces = ply->scan;
        if (element == faces && !late) {
            drop_read(ply);
            TRY(starg_builder_reserve(ply->builder, vertices->count, faces->count));
        }
        TRY(read_items(ply, element, late && element == faces));
    }
    TRY(check_end(ply));
    if (late) {
        ply->scan = begin_of_faces;
        TRY(starg_builder_reserve(ply->builder, vertices->count, faces->count));
        TRY(read_items(ply, faces, false));
    }
    return STARG_OK;
}

/* Reads the data from its beginning into an empty builder. */
static starg_status read_anew(ply_reader *ply, const starg_scan *begin, bool by_lines) {
    ply->scan = *begin;
    ply->by_lines = by_lines;
    ply->extra = 0;
    starg_builder_restart(ply->builder);
    return read_data(ply);
}

/* If reading line by line fails too, the first error is reported. */
static starg_status read_either_way(ply_reader *ply) {
    const starg_scan begin = ply->scan;
    starg_status status = read_anew(ply, &begin, false);
    if (status != STARG_ERROR_FORMAT || ply->encoding != PLY_TEXT)
        return status;
    status = read_anew(ply, &begin, true);
    if (status == STARG_ERROR_FORMAT)
        return read_anew(ply, &begin, false);
    if (status == STARG_OK)
        starg_log(ply->source->context, STARG_LOG_NOTICE,
                  "'%s': %zu lines, the first being line %zu, have more values than the header "
                  "declares, which were ignored",
                  ply->source->name, ply->extra, ply->first_extra);
    return status;
}

starg_status starg_ply_read(starg_mesh_builder *builder) {
    starg_status status = STARG_OK;
    ply_reader ply = {.builder = builder,
                      .source = builder->source,
                      .base = builder->source->bytes,
                      .scan = starg_scan_make(builder->source)};
    ply.scan.comments = false;
    STARG_TRY(starg_ply_read_header(&ply));
    STARG_TRY(starg_builder_reserve(builder, starg_ply_find(&ply, PLY_VERTICES)->count, 0));
    STARG_TRY(read_either_way(&ply));
done:
    RELEASE(ply.elements.data, ply.properties.data, ply.names.data);
    return status;
}
