/* SPDX-License-Identifier: Apache-2.0 */
/* Header of a PLY file: declares the encoding, the elements and their properties. */

#include "mesh/formats/ply.h"

static const struct type_info {
    const char *name, *other_name;
    size_t size;
} type_infos[PLY_TYPES] = {
    [PLY_INT8] = {"char", "int8", 1},        [PLY_UINT8] = {"uchar", "uint8", 1},
    [PLY_INT16] = {"short", "int16", 2},     [PLY_UINT16] = {"ushort", "uint16", 2},
    [PLY_INT32] = {"int", "int32", 4},       [PLY_UINT32] = {"uint", "uint32", 4},
    [PLY_FLOAT32] = {"float", "float32", 4}, [PLY_FLOAT64] = {"double", "float64", 8},
};

bool starg_ply_matches(const starg_source *source) {
    return source->size >= 4 && memcmp(source->bytes, "ply", 3) == 0 &&
           (source->bytes[3] == '\n' || source->bytes[3] == '\r');
}

size_t starg_ply_type_size(ply_type type) {
    return type_infos[type].size;
}

static starg_status fail_header(const ply_reader *ply, const char *what) {
    return starg_source_fail(ply->source, starg_at_line(ply->scan.line), "%s", what);
}

static starg_status header_word(ply_reader *ply, const char *what, starg_word *word) {
    if (starg_scan_word_here(&ply->scan, word))
        return STARG_OK;
    return starg_source_fail(ply->source, starg_at_line(ply->scan.line),
                             "%s is missing on this line of the header", what);
}

static starg_status read_format(ply_reader *ply) {
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    starg_word word;
    TRY(header_word(ply, "the encoding", &word));
    for (int i = 0; i < 3; i++) {
        if (starg_word_is(word, names[i])) {
            ply->encoding = (ply_encoding)i;
            ply->has_encoding = true;
            return STARG_OK;
        }
    }
    return starg_source_fail(
        ply->source, starg_at_line(word.line),
        "unknown encoding '%s'; use ascii, binary_little_endian or binary_big_endian",
        starg_word_excerpt(word).text);
}

static starg_status read_element(ply_reader *ply) {
    starg_word name, word;
    int64_t count;
    TRY(header_word(ply, "the name of the element", &name));
    TRY(header_word(ply, "the count of the element", &word));
    TRY(starg_word_integer(&ply->scan, word, "the count of the element", &count));
    if (count < 0)
        return fail_header(ply, "the count of the element is negative");
    bool strips = starg_word_is(name, "tristrips");
    bool faces = strips || starg_word_is(name, "face");
    if (strips && (count == 0 || starg_ply_find(ply, PLY_FACES) != NULL))
        faces = false; /* the others hold the faces */
    ply_element element = {.kind = starg_word_is(name, "vertex") ? PLY_VERTICES
                                   : faces                       ? PLY_FACES
                                                                 : PLY_OTHERS,
                           .strips = strips,
                           .count = (size_t)count,
                           .first = ply->properties.count,
                           .line = name.line};
    for (size_t i = 0; i < ply->elements.count; i++)
        if (element.kind != PLY_OTHERS && ply->elements.data[i].kind == element.kind)
            return fail_header(ply, "the element is declared twice");
    PUSH(ply->source->context, STARG_MESH_FILE, &ply->elements, element);
    return STARG_OK;
}

static starg_status read_type(ply_reader *ply, ply_type *out) {
    starg_word word;
    TRY(header_word(ply, "the type of the property", &word));
    for (int i = 0; i < PLY_TYPES; i++) {
        if (starg_word_is(word, type_infos[i].name) ||
            starg_word_is(word, type_infos[i].other_name)) {
            *out = (ply_type)i;
            return STARG_OK;
        }
    }
    return starg_source_fail(
        ply->source, starg_at_line(word.line),
        "unknown type '%s'; use char, uchar, short, ushort, int, uint, float or double",
        starg_word_excerpt(word).text);
}

static ply_role find_role(ply_kind kind, bool list, starg_word name) {
    if (kind == PLY_FACES && list &&
        (starg_word_is(name, "vertex_indices") || starg_word_is(name, "vertex_index")))
        return PLY_CORNERS;
    if (kind == PLY_FACES && list && starg_word_is(name, "texcoord"))
        return PLY_TEXTURE;
    static const char *const texture[2][3] = {{"s", "u", "texture_u"}, {"t", "v", "texture_v"}};
    for (int k = 0; k < 2 && kind == PLY_VERTICES && !list; k++)
        for (int i = 0; i < 3; i++)
            if (starg_word_is(name, texture[k][i]))
                return (ply_role)(PLY_U + k);
    if (kind == PLY_VERTICES && !list && name.length == 1 && name.text[0] >= 'x' &&
        name.text[0] <= 'z')
        return (ply_role)(name.text[0] - 'x');
    static const char *const colors[3][3] = {{"red", "diffuse_red", "r"},
                                             {"green", "diffuse_green", "g"},
                                             {"blue", "diffuse_blue", "b"}};
    for (int k = 0; k < 3 && kind == PLY_VERTICES && !list; k++)
        for (int i = 0; i < 3; i++)
            if (starg_word_is(name, colors[k][i]))
                return (ply_role)(PLY_RED + k);
    return PLY_OTHER;
}

/* What is left out with a property of this name, a part of a colour or of a texture's place. */
static unsigned look_of(starg_word name) {
    static const char *const colors[] = {"red", "diffuse_red", "r"};
    static const char *const texture[] = {"s", "u", "texture_u", "texcoord", "texcoords"};
    for (size_t i = 0; i < sizeof colors / sizeof *colors; i++)
        if (starg_word_is(name, colors[i]))
            return STARG_MESH_COLORS;
    for (size_t i = 0; i < sizeof texture / sizeof *texture; i++)
        if (starg_word_is(name, texture[i]))
            return STARG_MESH_TEXTURE;
    return 0;
}

static ply_naming naming_of(starg_word word) {
    return starg_word_is(word, "group")      ? PLY_GROUP
           : starg_word_is(word, "material") ? PLY_MATERIAL
                                             : PLY_NAMELESS;
}

/* Notes the name in a comment "group NUMBER NAME" or "material NUMBER NAME"; others mean nothing.
 */
static starg_status read_comment(ply_reader *ply) {
    starg_face_values *values = ply->builder->values;
    starg_word kind, number, word;
    ply_name name = {0};
    if (values == NULL || !starg_scan_word_here(&ply->scan, &kind) ||
        naming_of(kind) == PLY_NAMELESS || !starg_scan_word_here(&ply->scan, &number) ||
        !starg_parse_integer(number.text, number.length, &name.number) ||
        !starg_scan_word_here(&ply->scan, &word))
        return STARG_OK;
    name.naming = naming_of(kind);
    const char *text = word.text, *end = text + word.length;
    while (starg_scan_word_here(&ply->scan, &word))
        end = word.text + word.length;
    starg_values_note(values, text, (size_t)(end - text));
    if (values->collects && name.naming == PLY_GROUP)
        TRY(starg_values_collect(ply->source->context, values, text, (size_t)(end - text),
                                 &name.collected));
    if (name.collected > 0 ||
        (!values->collects && starg_values_want(values, text, (size_t)(end - text))))
        PUSH(ply->source->context, STARG_MESH_FILE, &ply->names, name);
    return STARG_OK;
}

static starg_status read_property(ply_reader *ply) {
    starg_word word;
    ply_property property = {0};
    if (ply->elements.count == 0)
        return fail_header(ply, "a property precedes the first element");
    ply_element *element = &ply->elements.data[ply->elements.count - 1];
    starg_scan ahead = ply->scan;
    property.list = starg_scan_word_here(&ahead, &word) && starg_word_is(word, "list");
    if (property.list) {
        ply->scan = ahead;
        TRY(read_type(ply, &property.count_type));
        if (property.count_type >= PLY_FLOAT32)
            return fail_header(ply, "the size of a list must have an integer type");
    }
    TRY(read_type(ply, &property.type));
    TRY(header_word(ply, "the name of the property", &word));
    property.role = find_role(element->kind, property.list, word);
    if ((element->kind == PLY_VERTICES || element->kind == PLY_FACES) && property.role == PLY_OTHER)
        ply->builder->left_out |= look_of(word);
    starg_face_values *values = element->kind == PLY_FACES ? ply->builder->values : NULL;
    if (values != NULL && !property.list) {
        property.naming = naming_of(word);
        starg_values_note(values, word.text, word.length);
        property.wanted =
            !values->collects && starg_values_want_property(values, word.text, word.length);
    }
    for (size_t i = 0; i < element->properties; i++)
        if (property.role != PLY_OTHER &&
            ply->properties.data[element->first + i].role == property.role) {
            if (property.role < PLY_OTHER)
                return fail_header(ply, "the property is declared twice");
            property.role = PLY_OTHER; /* a colour, say, by another name */
        }
    PUSH(ply->source->context, STARG_MESH_FILE, &ply->properties, property);
    element->properties++;
    return STARG_OK;
}

/* Skips the line end of "end_header". A lone CR is a line end only if it also ends the first line:
 * an LF after it is then data, but not in a file with CR LF. */
static starg_status pass_header_end(ply_reader *ply) {
    starg_scan *scan = &ply->scan;
    starg_word word;
    if (starg_scan_word_here(scan, &word))
        return fail_header(ply, "unexpected text after end_header");
    if (scan->at == scan->end)
        return STARG_OK;
    bool two = *scan->at == '\r' && scan->end - scan->at > 1 && scan->at[1] == '\n' &&
               ply->source->bytes[4] == '\n';
    scan->at += two ? 2 : 1;
    scan->line++;
    return STARG_OK;
}

/* A comment or obj_info line. */
static bool is_remark(starg_word word) {
    return starg_word_is(word, "comment") || starg_word_is(word, "obj_info");
}

static starg_status read_lines(ply_reader *ply) {
    starg_word word;
    TRY(starg_scan_expect(&ply->scan, "the word ply", &word));
    if (!starg_word_is(word, "ply"))
        return fail_header(ply, "a PLY file must begin with the line 'ply'");
    for (;;) {
        starg_scan_next_line(&ply->scan);
        TRY(starg_scan_expect(&ply->scan, "a line of the header or end_header", &word));
        if (starg_word_is(word, "end_header"))
            break;
        if (starg_word_is(word, "format"))
            TRY(read_format(ply));
        else if (starg_word_is(word, "element"))
            TRY(read_element(ply));
        else if (starg_word_is(word, "property"))
            TRY(read_property(ply));
        else if (starg_word_is(word, "comment"))
            TRY(read_comment(ply));
        else if (!is_remark(word))
            return starg_source_fail(ply->source, starg_at_line(word.line),
                                     "'%s' is not a keyword of a PLY header",
                                     starg_word_excerpt(word).text);
    }
    TRY(pass_header_end(ply));
    if (!ply->has_encoding)
        return fail_header(ply, "the header has no format line");
    return STARG_OK;
}

const ply_element *starg_ply_find(const ply_reader *ply, ply_kind kind) {
    for (size_t i = 0; i < ply->elements.count; i++)
        if (ply->elements.data[i].kind == kind)
            return &ply->elements.data[i];
    return NULL;
}

static bool has_role(const ply_reader *ply, const ply_element *element, ply_role role) {
    for (size_t i = 0; i < element->properties; i++)
        if (ply->properties.data[element->first + i].role == role)
            return true;
    return false;
}

/* Smallest size of an item. */
static size_t least_bytes(const ply_reader *ply, const ply_element *element) {
    size_t bytes = 0;
    for (size_t i = 0; i < element->properties; i++) {
        const ply_property *property = &ply->properties.data[element->first + i];
        size_t values = !property->list ? 1 : property->role == PLY_CORNERS ? 3 : 0;
        if (ply->encoding == PLY_TEXT)
            bytes += 2 * (values + property->list);
        else
            bytes += values * starg_ply_type_size(property->type) +
                     (property->list ? starg_ply_type_size(property->count_type) : 0);
    }
    return bytes;
}

/* Rejects counts that the rest of the file cannot hold, before allocating. */
static starg_status check_counts(const ply_reader *ply) {
    size_t left = (size_t)(ply->scan.end - ply->scan.at);
    for (size_t i = 0; i < ply->elements.count; i++) {
        const ply_element *element = &ply->elements.data[i];
        size_t bytes = least_bytes(ply, element);
        if (bytes != 0 && element->count > (left + 1) / bytes)
            return starg_source_fail(ply->source, starg_at_line(element->line),
                                     "the header declares %zu items, too many for the %zu bytes "
                                     "after it; the header is wrong or the file is truncated",
                                     element->count, left);
    }
    return STARG_OK;
}

static starg_status check_header(const ply_reader *ply) {
    const ply_element *vertices = starg_ply_find(ply, PLY_VERTICES),
                      *faces = starg_ply_find(ply, PLY_FACES);
    if (vertices == NULL || faces == NULL)
        return starg_source_fail(ply->source, starg_at_file(),
                                 "the file has no faces: a surface needs the elements vertex and "
                                 "face");
    for (int k = 0; k < 3; k++)
        if (!has_role(ply, vertices, (ply_role)k))
            return starg_source_fail(ply->source, starg_at_line(vertices->line),
                                     "vertices have no property %c", "xyz"[k]);
    if (!has_role(ply, faces, PLY_CORNERS))
        return starg_source_fail(ply->source, starg_at_line(faces->line),
                                 "faces have no list property vertex_indices");
    return check_counts(ply);
}

starg_status starg_ply_read_header(ply_reader *ply) {
    starg_status status = read_lines(ply);
    return status == STARG_OK ? check_header(ply) : status;
}
