/* PLY, the Stanford polygon format: a text header that declares elements and their properties,
 * then the elements in text or in binary of either byte order. Any types and order of properties
 * are read; elements and properties that do not matter here are stepped over. Faces may stand
 * before the vertices: then they are stepped over first and read at the end. */
#include <math.h>
#include <string.h>

#include "mesh/scan.h"

typedef enum ply_encoding { TEXT, LITTLE, BIG } ply_encoding;

typedef enum ply_type {
    INT8,
    UINT8,
    INT16,
    UINT16,
    INT32,
    UINT32,
    FLOAT32,
    FLOAT64,
    TYPES
} ply_type;

static const struct type_info {
    const char *name, *other_name;
    size_t size;
} type_infos[TYPES] = {
    [INT8] = {"char", "int8", 1},        [UINT8] = {"uchar", "uint8", 1},
    [INT16] = {"short", "int16", 2},     [UINT16] = {"ushort", "uint16", 2},
    [INT32] = {"int", "int32", 4},       [UINT32] = {"uint", "uint32", 4},
    [FLOAT32] = {"float", "float32", 4}, [FLOAT64] = {"double", "float64", 8},
};

/* What a property is to us. X, Y, Z are 0, 1, 2. */
typedef enum ply_role { X, Y, Z, CORNERS, OTHER } ply_role;

typedef struct ply_property {
    ply_role role;
    bool list;
    ply_type count_type; /* of a list */
    ply_type type;
} ply_property;

typedef enum ply_kind { VERTICES, FACES, OTHERS } ply_kind;

typedef struct ply_element {
    ply_kind kind;
    size_t count;
    size_t first, properties; /* in the array of all properties */
    size_t line;
} ply_element;

typedef struct ply_reader {
    starg_mesh_builder *builder;
    const starg_source *source;
    starg_scan scan; /* in binary data only its `at` is used */
    ply_encoding encoding;
    bool has_encoding;
    STARG_ARRAY(ply_element) elements;
    STARG_ARRAY(ply_property) properties;
} ply_reader;

bool starg_ply_matches(const starg_source *source) {
    return source->size >= 4 && memcmp(source->bytes, "ply", 3) == 0 &&
           (source->bytes[3] == '\n' || source->bytes[3] == '\r');
}

/* ---- header ---- */

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
    starg_status status = header_word(ply, "the encoding", &word);
    if (status != STARG_OK)
        return status;
    for (int i = 0; i < 3; i++) {
        if (starg_word_is(word, names[i])) {
            ply->encoding = (ply_encoding)i;
            ply->has_encoding = true;
            return STARG_OK;
        }
    }
    return starg_source_fail(ply->source, starg_at_line(word.line),
                             "the encoding '%s' is unknown; ascii, binary_little_endian and "
                             "binary_big_endian are read",
                             starg_word_excerpt(word).text);
}

static starg_status read_element(ply_reader *ply) {
    starg_status status = STARG_OK;
    starg_word name, word;
    int64_t count;
    STARG_TRY(header_word(ply, "the name of the element", &name));
    STARG_TRY(header_word(ply, "the count of the element", &word));
    STARG_TRY(starg_word_integer(&ply->scan, word, "the count of the element", &count));
    if (count < 0)
        return fail_header(ply, "the count of the element is negative");
    ply_element element = {.kind = starg_word_is(name, "vertex") ? VERTICES
                                   : starg_word_is(name, "face") ? FACES
                                                                 : OTHERS,
                           .count = (size_t)count,
                           .first = ply->properties.count,
                           .line = name.line};
    for (size_t i = 0; i < ply->elements.count; i++)
        if (element.kind != OTHERS && ply->elements.data[i].kind == element.kind)
            return fail_header(ply, "the element is declared twice");
    STARG_PUSH(ply->source->context, STARG_MESH_FILE, &ply->elements, element);
done:
    return status;
}

static starg_status read_type(ply_reader *ply, ply_type *out) {
    starg_word word;
    starg_status status = header_word(ply, "the type of the property", &word);
    if (status != STARG_OK)
        return status;
    for (int i = 0; i < TYPES; i++) {
        if (starg_word_is(word, type_infos[i].name) ||
            starg_word_is(word, type_infos[i].other_name)) {
            *out = (ply_type)i;
            return STARG_OK;
        }
    }
    return starg_source_fail(ply->source, starg_at_line(word.line),
                             "the type '%s' is unknown; char, uchar, short, ushort, int, uint, "
                             "float and double are read",
                             starg_word_excerpt(word).text);
}

static ply_role find_role(ply_kind kind, bool list, starg_word name) {
    if (kind == FACES && list &&
        (starg_word_is(name, "vertex_indices") || starg_word_is(name, "vertex_index")))
        return CORNERS;
    if (kind == VERTICES && !list && name.length == 1 && name.text[0] >= 'x' && name.text[0] <= 'z')
        return (ply_role)(name.text[0] - 'x');
    return OTHER;
}

static starg_status read_property(ply_reader *ply) {
    starg_status status = STARG_OK;
    starg_word word;
    ply_property property = {0};
    if (ply->elements.count == 0)
        return fail_header(ply, "a property stands before the first element");
    ply_element *element = &ply->elements.data[ply->elements.count - 1];
    starg_scan ahead = ply->scan;
    property.list = starg_scan_word_here(&ahead, &word) && starg_word_is(word, "list");
    if (property.list) {
        ply->scan = ahead;
        STARG_TRY(read_type(ply, &property.count_type));
        if (property.count_type >= FLOAT32)
            return fail_header(ply, "the size of a list has to be of a whole type");
    }
    STARG_TRY(read_type(ply, &property.type));
    STARG_TRY(header_word(ply, "the name of the property", &word));
    property.role = find_role(element->kind, property.list, word);
    for (size_t i = 0; i < element->properties; i++)
        if (property.role != OTHER &&
            ply->properties.data[element->first + i].role == property.role)
            return fail_header(ply, "the property is declared twice");
    STARG_PUSH(ply->source->context, STARG_MESH_FILE, &ply->properties, property);
    element->properties++;
done:
    return status;
}

/* Goes behind the line end of "end_header". A lone CR ends it only if it does so in the first
 * line: the LF behind it is data then, but not in a file with CR LF. */
static starg_status pass_header_end(ply_reader *ply) {
    starg_scan *scan = &ply->scan;
    starg_word word;
    if (starg_scan_word_here(scan, &word))
        return fail_header(ply, "something stands behind end_header");
    if (scan->at == scan->end)
        return STARG_OK;
    bool two = *scan->at == '\r' && scan->end - scan->at > 1 && scan->at[1] == '\n' &&
               ply->source->bytes[4] == '\n';
    scan->at += two ? 2 : 1;
    scan->line++;
    return STARG_OK;
}

/* A line that only people read. */
static bool is_remark(starg_word word) {
    return starg_word_is(word, "comment") || starg_word_is(word, "obj_info");
}

static starg_status read_header(ply_reader *ply) {
    starg_status status = STARG_OK;
    starg_word word;
    STARG_TRY(starg_scan_expect(&ply->scan, "the word ply", &word));
    if (!starg_word_is(word, "ply"))
        return fail_header(ply, "a PLY file begins with a line that says ply");
    for (;;) {
        starg_scan_next_line(&ply->scan);
        STARG_TRY(starg_scan_expect(&ply->scan, "a line of the header or end_header", &word));
        if (starg_word_is(word, "end_header"))
            break;
        if (starg_word_is(word, "format"))
            STARG_TRY(read_format(ply));
        else if (starg_word_is(word, "element"))
            STARG_TRY(read_element(ply));
        else if (starg_word_is(word, "property"))
            STARG_TRY(read_property(ply));
        else if (!is_remark(word))
            return starg_source_fail(ply->source, starg_at_line(word.line),
                                     "'%s' begins no line of a PLY header",
                                     starg_word_excerpt(word).text);
    }
    STARG_TRY(pass_header_end(ply));
    if (!ply->has_encoding)
        return fail_header(ply, "the header has no line that says the format");
done:
    return status;
}

static const ply_element *find_element(const ply_reader *ply, ply_kind kind) {
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

/* The fewest bytes that one item takes. */
static size_t least_bytes(const ply_reader *ply, const ply_element *element) {
    size_t bytes = 0;
    for (size_t i = 0; i < element->properties; i++) {
        const ply_property *property = &ply->properties.data[element->first + i];
        size_t values = !property->list ? 1 : property->role == CORNERS ? 3 : 0;
        if (ply->encoding == TEXT)
            bytes += 2 * (values + property->list);
        else
            bytes += values * type_infos[property->type].size +
                     (property->list ? type_infos[property->count_type].size : 0);
    }
    return bytes;
}

/* A count that the rest of the file cannot hold is refused before any memory is asked for. */
static starg_status check_counts(const ply_reader *ply) {
    size_t left = (size_t)(ply->scan.end - ply->scan.at);
    for (size_t i = 0; i < ply->elements.count; i++) {
        const ply_element *element = &ply->elements.data[i];
        size_t bytes = least_bytes(ply, element);
        if (bytes != 0 && element->count > (left + 1) / bytes)
            return starg_source_fail(ply->source, starg_at_line(element->line),
                                     "%zu items are announced, which the %zu bytes behind the "
                                     "header cannot hold; the header is wrong or the file is cut "
                                     "off",
                                     element->count, left);
    }
    return STARG_OK;
}

static starg_status check_header(const ply_reader *ply) {
    const ply_element *vertices = find_element(ply, VERTICES), *faces = find_element(ply, FACES);
    if (vertices == NULL || faces == NULL)
        return starg_source_fail(ply->source, starg_at_file(),
                                 "the file has no faces: a surface needs the elements vertex and "
                                 "face");
    for (int k = 0; k < 3; k++)
        if (!has_role(ply, vertices, (ply_role)k))
            return starg_source_fail(ply->source, starg_at_line(vertices->line),
                                     "vertices have no property %c", "xyz"[k]);
    if (!has_role(ply, faces, CORNERS))
        return starg_source_fail(ply->source, starg_at_line(faces->line),
                                 "faces have no list property vertex_indices");
    return check_counts(ply);
}

/* ---- data ---- */

static starg_place place_of(const ply_reader *ply) {
    return ply->encoding == TEXT ? starg_at_line(ply->scan.line)
                                 : starg_at_byte((size_t)(ply->scan.at - ply->source->bytes));
}

/* The place of what was just read, given that of the cursor before: a scanner of text reaches the
 * line of a word only when it reads it. */
static starg_place place_since(const ply_reader *ply, starg_place before) {
    return ply->encoding == TEXT ? place_of(ply) : before;
}

static starg_status need(const ply_reader *ply, size_t bytes) {
    if (bytes <= (size_t)(ply->scan.end - ply->scan.at))
        return STARG_OK;
    return starg_source_fail(ply->source, place_of(ply),
                             "the file ends within its data; it seems to be cut off");
}

/* The next `size` bytes as a number, whatever their order. */
static uint64_t take_bits(ply_reader *ply, size_t size) {
    const unsigned char *bytes = (const unsigned char *)ply->scan.at;
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)bytes[i] << 8 * (ply->encoding == LITTLE ? i : size - 1 - i);
    ply->scan.at += size;
    return bits;
}

static double float_of(ply_type type, uint64_t bits) {
    if (type == FLOAT32) {
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
    case INT8:
        return (int8_t)bits;
    case INT16:
        return (int16_t)bits;
    case INT32:
        return (int32_t)bits;
    default:
        return (int64_t)bits; /* unsigned, at most 32 bits */
    }
}

static starg_status read_real(ply_reader *ply, ply_type type, const char *what, double *value) {
    if (ply->encoding == TEXT)
        return starg_scan_real(&ply->scan, what, value);
    starg_status status = need(ply, type_infos[type].size);
    if (status != STARG_OK)
        return status;
    uint64_t bits = take_bits(ply, type_infos[type].size);
    *value = type >= FLOAT32 ? float_of(type, bits) : (double)integer_of(type, bits);
    return STARG_OK;
}

/* Whole numbers may be stored in a floating type. */
static starg_status read_integer(ply_reader *ply, ply_type type, const char *what, int64_t *value) {
    if (type >= FLOAT32) {
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
    if (ply->encoding == TEXT)
        return starg_scan_integer(&ply->scan, what, value);
    starg_status status = need(ply, type_infos[type].size);
    if (status == STARG_OK)
        *value = integer_of(type, take_bits(ply, type_infos[type].size));
    return status;
}

static starg_status skip_values(ply_reader *ply, ply_type type, uint64_t count) {
    starg_status status = STARG_OK;
    if (ply->encoding == TEXT) {
        starg_word word;
        for (uint64_t i = 0; i < count; i++)
            STARG_TRY(starg_scan_expect(&ply->scan, "the value of a property", &word));
        return STARG_OK;
    }
    size_t left = (size_t)(ply->scan.end - ply->scan.at);
    if (count > left / type_infos[type].size)
        return need(ply, left + 1);
    ply->scan.at += count * type_infos[type].size;
done:
    return status;
}

static starg_status read_list(ply_reader *ply, const ply_property *property, bool skip) {
    starg_status status = STARG_OK;
    int64_t count, vertex;
    starg_place before = place_of(ply);
    STARG_TRY(read_integer(ply, property->count_type, "the size of a list", &count));
    if (count < 0)
        return starg_source_fail(ply->source, place_since(ply, before),
                                 "the size of a list is negative");
    if (property->role != CORNERS || skip)
        return skip_values(ply, property->type, (uint64_t)count);
    for (int64_t i = 0; i < count; i++) {
        before = place_of(ply);
        STARG_TRY(read_integer(ply, property->type, "a vertex index", &vertex));
        STARG_TRY(starg_builder_corner(ply->builder, vertex, place_since(ply, before)));
    }
done:
    return status;
}

/* One item of an element; its values are used unless `skip`. */
static starg_status read_item(ply_reader *ply, const ply_element *element, bool skip) {
    starg_status status = STARG_OK;
    starg_place before = place_of(ply);
    double point[3] = {0, 0, 0};
    for (size_t i = 0; i < element->properties; i++) {
        const ply_property *property = &ply->properties.data[element->first + i];
        if (property->list)
            STARG_TRY(read_list(ply, property, skip));
        else if (property->role <= Z)
            STARG_TRY(
                read_real(ply, property->type, "a coordinate of a vertex", &point[property->role]));
        else
            STARG_TRY(skip_values(ply, property->type, 1));
    }
    starg_place place = place_since(ply, before);
    if (element->kind == VERTICES)
        STARG_TRY(starg_builder_vertex(ply->builder, point, place));
    if (element->kind == FACES && !skip)
        STARG_TRY(starg_builder_face(ply->builder, place));
    STARG_TRY(starg_builder_tick(ply->builder, (size_t)(ply->scan.at - ply->source->bytes)));
done:
    return status;
}

static starg_status read_items(ply_reader *ply, const ply_element *element, bool skip) {
    if (element->properties == 0)
        return STARG_OK; /* takes no bytes, however many there are */
    starg_status status = STARG_OK;
    for (size_t i = 0; i < element->count && status == STARG_OK; i++)
        status = read_item(ply, element, skip);
    return status;
}

/* Nothing but line ends may follow. */
static starg_status check_end(ply_reader *ply) {
    static const char hint[] = "the counts in the header do not fit the data";
    if (ply->encoding == TEXT)
        return starg_scan_end(&ply->scan, hint);
    const char *at = ply->scan.at;
    while (at < ply->scan.end && (*at == '\n' || *at == '\r'))
        at++;
    if (at == ply->scan.end)
        return STARG_OK;
    return starg_source_fail(ply->source, place_of(ply), "%zu bytes stand behind the data; %s",
                             (size_t)(ply->scan.end - ply->scan.at), hint);
}

static starg_status read_data(ply_reader *ply) {
    starg_status status = STARG_OK;
    const ply_element *faces = find_element(ply, FACES), *vertices = find_element(ply, VERTICES);
    bool late = faces < vertices;
    starg_scan begin_of_faces = ply->scan;
    for (size_t i = 0; i < ply->elements.count; i++) {
        const ply_element *element = &ply->elements.data[i];
        if (element == faces)
            begin_of_faces = ply->scan;
        STARG_TRY(read_items(ply, element, late && element == faces));
    }
    STARG_TRY(check_end(ply));
    if (late) {
        ply->scan = begin_of_faces;
        STARG_TRY(read_items(ply, faces, false));
    }
done:
    return status;
}

starg_status starg_ply_read(starg_mesh_builder *builder) {
    starg_status status = STARG_OK;
    ply_reader ply = {
        .builder = builder, .source = builder->source, .scan = starg_scan_make(builder->source)};
    ply.scan.comments = false;
    STARG_TRY(read_header(&ply));
    STARG_TRY(check_header(&ply));
    STARG_TRY(starg_builder_reserve(builder, find_element(&ply, VERTICES)->count,
                                    find_element(&ply, FACES)->count));
    STARG_TRY(read_data(&ply));
done:
    STARG_ARRAY_FREE(builder->source->context, &ply.elements);
    STARG_ARRAY_FREE(builder->source->context, &ply.properties);
    return status;
}
