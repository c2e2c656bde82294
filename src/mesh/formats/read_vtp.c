/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces in VTK XML files of polydata (.vtp): pieces with points, polygons and strips of
 * triangles; points and lines of a piece are passed over. Arrays of cells with one number each are
 * properties of faces, strings are names of groups.
 *
 * Two passes: the elements, of which only places are kept, and the arrays, piece by piece. Corners
 * and the ends of their polygons are read side by side, so that nothing but the mesh grows. */
#include "mesh/formats/vtk.h"

static const char STAGE[] = STARG_MESH_FILE;

enum { KINDS = VTP_STRIPS + 1, DEEPEST = 16 };

/* VTKFile, PolyData, Piece, a section, its arrays */
enum { DEPTH_SET = 1, DEPTH_PIECE = 2, DEPTH_SECTION = 3, DEPTH_ARRAY = 4 };

typedef struct vtp_piece {
    int64_t points, cells[KINDS];
    size_t first, arrays;
    size_t line;
} vtp_piece;

typedef struct vtp_reader {
    vtp_file file;
    const starg_source *source;
    xml_scan scan;
    starg_word open[DEEPEST];
    size_t depth;
    STARG_ARRAY(vtp_piece) pieces;
    STARG_ARRAY(vtp_array) arrays;
} vtp_reader;

bool starg_vtp_matches(const starg_source *source) {
    return xml_root_is(source, "VTKFile");
}

/* ---- elements ---- */

static bool attribute_is(const xml_tag *tag, const char *name, const char *value) {
    starg_word found;
    return xml_attribute(tag, name, &found) && starg_word_is(found, value);
}

static starg_status fail_attribute(vtp_reader *r, const xml_tag *tag, const char *name,
                                   const char *wanted) {
    starg_word found = {"", 0, tag->name.line};
    xml_attribute(tag, name, &found);
    return starg_source_fail(
        r->source, starg_at_line(tag->name.line), "%s of the element %s is '%s', not %s", name,
        starg_word_excerpt(tag->name).text, starg_word_excerpt(found).text, wanted);
}

static starg_status take_root(vtp_reader *r, const xml_tag *tag) {
    starg_word found;
    starg_place place = starg_at_line(tag->name.line);
    if (!starg_word_is(tag->name, "VTKFile"))
        return starg_source_fail(r->source, place, "found '%s' instead of VTKFile",
                                 starg_word_excerpt(tag->name).text);
    if (!xml_attribute(tag, "type", &found) || !starg_word_is(found, "PolyData"))
        return starg_source_fail(
            r->source, place,
            "a VTK file of type '%s' is no surface, which is PolyData in one file (.vtp); ParaView "
            "makes it by 'Extract Surface' and 'Save Data', and 'decompose' reads tetrahedra from "
            "legacy .vtk",
            xml_attribute(tag, "type", &found) ? starg_word_excerpt(found).text : "");
    if (xml_attribute(tag, "compressor", &found) && !starg_word_is(found, "vtkZLibDataCompressor"))
        return starg_source_fail(r->source, place,
                                 "the data are compressed by %s; save them with zlib, or without "
                                 "compression",
                                 starg_word_excerpt(found).text);
    r->file.compressed = xml_attribute(tag, "compressor", &found);
    r->file.encoding = NUMBERS_LITTLE;
    if (attribute_is(tag, "byte_order", "BigEndian"))
        r->file.encoding = NUMBERS_BIG;
    else if (xml_attribute(tag, "byte_order", &found) && !starg_word_is(found, "LittleEndian"))
        return fail_attribute(r, tag, "byte_order", "LittleEndian or BigEndian");
    r->file.header = attribute_is(tag, "header_type", "UInt64") ? 8 : 4;
    if (r->file.header == 4 && xml_attribute(tag, "header_type", &found) &&
        !starg_word_is(found, "UInt32"))
        return fail_attribute(r, tag, "header_type", "UInt32 or UInt64");
    return STARG_OK;
}

/* A count that is 0 where it is missing. */
static starg_status take_count(vtp_reader *r, const xml_tag *tag, const char *name,
                               int64_t *count) {
    starg_word found;
    *count = 0;
    if (xml_attribute(tag, name, &found) &&
        (!starg_parse_integer(found.text, found.length, count) || *count < 0 ||
         (uint64_t)*count > STARG_FILE_LIMIT))
        return fail_attribute(r, tag, name, "a count that a file can hold");
    return STARG_OK;
}

static starg_status take_piece(vtp_reader *r, const xml_tag *tag) {
    static const char *const names[KINDS] = {[VTP_VERTS] = "NumberOfVerts",
                                             [VTP_LINES] = "NumberOfLines",
                                             [VTP_POLYS] = "NumberOfPolys",
                                             [VTP_STRIPS] = "NumberOfStrips"};
    vtp_piece piece = {.first = r->arrays.count, .line = tag->name.line};
    TRY(take_count(r, tag, "NumberOfPoints", &piece.points));
    for (int k = 0; k < KINDS; k++)
        TRY(take_count(r, tag, names[k], &piece.cells[k]));
    PUSH(r->source->context, STAGE, &r->pieces, piece);
    return STARG_OK;
}

static bool find_section(starg_word name, vtp_section *section) {
    static const char *const names[] = {
        [VTP_VERTS] = "Verts",   [VTP_LINES] = "Lines",   [VTP_POLYS] = "Polys",
        [VTP_STRIPS] = "Strips", [VTP_POINTS] = "Points", [VTP_DATA] = "CellData"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (starg_word_is(name, names[i])) {
            *section = (vtp_section)i;
            return true;
        }
    return false;
}

static starg_status take_type(vtp_reader *r, const xml_tag *tag, vtp_array *array) {
    static const struct {
        const char *name;
        number_type type;
    } types[] = {
        {"Float32", NUMBER_FLOAT32}, {"Float64", NUMBER_FLOAT64}, {"Int8", NUMBER_INT8},
        {"UInt8", NUMBER_UINT8},     {"Int16", NUMBER_INT16},     {"UInt16", NUMBER_UINT16},
        {"Int32", NUMBER_INT32},     {"UInt32", NUMBER_UINT32},   {"Int64", NUMBER_INT64},
        {"UInt64", NUMBER_INT64},    {"String", NUMBER_UINT8}};
    starg_word found;
    bool there = xml_attribute(tag, "type", &found);
    for (size_t i = 0; there && i < sizeof types / sizeof *types; i++)
        if (starg_word_is(found, types[i].name)) {
            array->type = types[i].type;
            array->strings = starg_word_is(found, "String");
            return STARG_OK;
        }
    return fail_attribute(r, tag, "type", "one of numbers or String");
}

static starg_status take_array(vtp_reader *r, const xml_tag *tag, vtp_section section) {
    vtp_array array = {.section = section, .line = tag->name.line, .name = {"", 0, 0}};
    starg_word found;
    TRY(take_type(r, tag, &array));
    xml_attribute(tag, "Name", &array.name);
    array.text = (starg_word){tag->name.text, 0, tag->name.line};
    array.several = xml_attribute(tag, "NumberOfComponents", &found) && !starg_word_is(found, "1");
    if (attribute_is(tag, "format", "binary"))
        array.storage = VTP_INLINE;
    else if (attribute_is(tag, "format", "appended"))
        array.storage = VTP_APPENDED;
    else if (xml_attribute(tag, "format", &found) && !starg_word_is(found, "ascii"))
        return fail_attribute(r, tag, "format", "ascii, binary or appended");
    if (array.storage == VTP_APPENDED &&
        (!xml_attribute(tag, "offset", &found) ||
         !starg_parse_integer(found.text, found.length, &array.offset)))
        return fail_attribute(r, tag, "offset", "a number of bytes");
    PUSH(r->source->context, STAGE, &r->arrays, array);
    r->pieces.data[r->pieces.count - 1].arrays++;
    return STARG_OK;
}

/* Within the set of pieces? */
static bool in_piece(const vtp_reader *r) {
    return r->depth > DEPTH_PIECE && starg_word_is(r->open[DEPTH_SET], "PolyData") &&
           starg_word_is(r->open[DEPTH_PIECE], "Piece");
}

static bool is_array(starg_word name) {
    return starg_word_is(name, "DataArray") || starg_word_is(name, "Array");
}

static starg_status take_open(vtp_reader *r, const xml_tag *tag) {
    vtp_section section;
    if (r->depth == 0)
        return take_root(r, tag);
    if (r->depth == DEPTH_PIECE && starg_word_is(tag->name, "Piece") &&
        starg_word_is(r->open[DEPTH_SET], "PolyData"))
        return take_piece(r, tag);
    if (r->depth == DEPTH_ARRAY && in_piece(r) && is_array(tag->name) &&
        find_section(r->open[DEPTH_SECTION], &section))
        return take_array(r, tag, section);
    return STARG_OK;
}

/* The data behind all elements, which are none: they begin behind an underscore. */
static starg_status take_appended(vtp_reader *r, const xml_tag *tag) {
    const char *at = r->scan.at;
    if (!attribute_is(tag, "encoding", "raw") && !attribute_is(tag, "encoding", "base64"))
        return fail_attribute(r, tag, "encoding", "raw or base64");
    while (at < r->scan.end && *at != '_')
        at++;
    if (at == r->scan.end)
        return starg_source_fail(r->source, starg_at_line(tag->name.line),
                                 "no appended data follow; the file seems to be truncated");
    r->file.appended = at + 1;
    r->file.appended_text = attribute_is(tag, "encoding", "base64");
    return STARG_OK;
}

/* Text directly within an array belongs to it; other elements within it may follow. */
static void take_text(vtp_reader *r, starg_word text) {
    starg_scan scan = {.at = text.text, .end = text.text + text.length};
    starg_word word;
    if (r->depth != DEPTH_ARRAY + 1 || !in_piece(r) || !is_array(r->open[DEPTH_ARRAY]) ||
        r->arrays.count == 0)
        return;
    vtp_array *array = &r->arrays.data[r->arrays.count - 1];
    if (array->text.length == 0 && starg_scan_word(&scan, &word))
        array->text = text;
}

static starg_status close_element(vtp_reader *r, starg_word name) {
    if (r->depth == 0 || r->open[r->depth - 1].length != name.length ||
        memcmp(r->open[r->depth - 1].text, name.text, name.length) != 0)
        return starg_source_fail(r->source, starg_at_line(name.line),
                                 "the element '%s' ends here, but did not begin",
                                 starg_word_excerpt(name).text);
    r->depth--;
    return STARG_OK;
}

static starg_status read_elements(vtp_reader *r) {
    xml_tag tag;
    for (;;) {
        TRY(xml_next(&r->scan, &tag));
        if (tag.kind == XML_END && r->depth == 0 && r->scan.at > r->source->bytes)
            return STARG_OK;
        if (tag.kind == XML_END)
            return starg_source_fail(r->source, starg_at_line(r->scan.line),
                                     "the file ends within an element; it seems to be truncated");
        take_text(r, tag.before);
        if (tag.kind == XML_CLOSE) {
            TRY(close_element(r, tag.name));
            if (r->depth == 0)
                return STARG_OK;
            continue;
        }
        TRY(take_open(r, &tag));
        if (r->depth == DEPTH_SET && starg_word_is(tag.name, "AppendedData"))
            return take_appended(r, &tag);
        if (r->depth == DEEPEST)
            return starg_source_fail(r->source, starg_at_line(tag.name.line),
                                     "elements lie more than %d deep", DEEPEST);
        if (!tag.empty)
            r->open[r->depth++] = tag.name;
        TRY(starg_builder_tick(r->file.builder, 0));
    }
}

/* ---- arrays ---- */

static starg_status fail_count(vtp_reader *r, const vtp_array *array, size_t count,
                               int64_t wanted) {
    return starg_source_fail(r->source, starg_at_line(array->line),
                             "the array '%s' has %zu numbers, but its piece needs %lld",
                             starg_word_excerpt(array->name).text, count, (long long)wanted);
}

/* The numbers of the array of that name, or the first of the section; `wanted` below 0: any. */
static starg_status open_array(vtp_reader *r, const vtp_piece *piece, vtp_section section,
                               const char *name, int64_t wanted, vtp_numbers *numbers) {
    for (size_t i = 0; i < piece->arrays; i++) {
        const vtp_array *array = &r->arrays.data[piece->first + i];
        if (array->section != section || (name != NULL && !starg_word_is(array->name, name)))
            continue;
        TRY(vtp_numbers_open(&r->file, array, numbers));
        if (wanted >= 0 && numbers->count != (uint64_t)wanted)
            return fail_count(r, array, numbers->count, wanted);
        return STARG_OK;
    }
    return starg_source_fail(r->source, starg_at_line(piece->line), "the piece has no array %s%s",
                             section == VTP_POINTS ? "of points" : "", name != NULL ? name : "");
}

static starg_status read_points(vtp_reader *r, const vtp_piece *piece) {
    SCOPED_BY(vtp_numbers_close) vtp_numbers numbers = {0};
    starg_mesh_builder *builder = r->file.builder;
    TRY(open_array(r, piece, VTP_POINTS, NULL, 3 * piece->points, &numbers));
    TRY(starg_builder_reserve(builder, starg_builder_vertex_count(builder) + (size_t)piece->points,
                              builder->faces.count / 3));
    for (int64_t i = 0; i < piece->points; i++) {
        double point[3];
        for (int k = 0; k < 3; k++)
            TRY(numbers_real(&numbers.scan, numbers.type, "a coordinate of a point", &point[k]));
        TRY(starg_builder_vertex(builder, point, starg_at_line(numbers.array->line)));
        TRY(starg_builder_tick(builder, numbers.array->line));
    }
    return STARG_OK;
}

/* The cells of one kind: their corners, and where each ends among them. */
typedef struct vtp_cells {
    vtp_reader *r;
    const vtp_piece *piece;
    size_t first; /* vertex of the piece */
    vtp_numbers ends, corners;
    int64_t done; /* corners */
} vtp_cells;

static starg_status next_corner(vtp_cells *cells, int64_t *corner) {
    TRY(numbers_integer(&cells->corners.scan, cells->corners.type, "a vertex index", corner));
    cells->done++;
    if (*corner < 0 || *corner >= cells->piece->points)
        return starg_source_fail(cells->r->source, starg_at_line(cells->corners.array->line),
                                 "a face refers to point %lld (counted from 0), but its piece has "
                                 "only %lld",
                                 (long long)*corner, (long long)cells->piece->points);
    *corner += (int64_t)cells->first;
    return STARG_OK;
}

static starg_status add_corner(vtp_cells *cells, int64_t corner) {
    return starg_builder_corner(cells->r->file.builder, corner,
                                starg_at_line(cells->corners.array->line));
}

static starg_status add_face(vtp_cells *cells) {
    return starg_builder_face(cells->r->file.builder, starg_at_line(cells->corners.array->line));
}

static starg_status add_polygon(vtp_cells *cells, int64_t end) {
    int64_t corner;
    while (cells->done < end) {
        TRY(next_corner(cells, &corner));
        TRY(add_corner(cells, corner));
    }
    return add_face(cells);
}

/* Every other triangle of a strip is turned around. */
static starg_status add_strip(vtp_cells *cells, int64_t end) {
    int64_t last[3] = {0};
    for (int64_t i = 0; cells->done < end; i++) {
        last[0] = last[1];
        last[1] = last[2];
        TRY(next_corner(cells, &last[2]));
        if (i < 2)
            continue;
        TRY(add_corner(cells, last[0]));
        TRY(add_corner(cells, last[i % 2 == 0 ? 1 : 2]));
        TRY(add_corner(cells, last[i % 2 == 0 ? 2 : 1]));
        TRY(add_face(cells));
    }
    return STARG_OK;
}

/* `data`: values of the piece's cells, or NULL. */
static starg_status read_cells(vtp_cells *cells, vtp_section kind, const double *data) {
    vtp_reader *r = cells->r;
    int64_t count = cells->piece->cells[kind], end = 0;
    TRY(open_array(r, cells->piece, kind, "offsets", count, &cells->ends));
    TRY(open_array(r, cells->piece, kind, "connectivity", -1, &cells->corners));
    for (int64_t i = 0; i < count; i++) {
        int64_t before = end;
        TRY(numbers_integer(&cells->ends.scan, cells->ends.type, "the end of a cell", &end));
        if (end < before || (uint64_t)end > cells->corners.count)
            return starg_source_fail(
                r->source, starg_at_line(cells->ends.array->line),
                "the cells do not end one after another within the %zu corners",
                cells->corners.count);
        if (data != NULL)
            r->file.builder->values->current = data[i];
        TRY(kind == VTP_POLYS ? add_polygon(cells, end) : add_strip(cells, end));
        TRY(starg_builder_tick(r->file.builder, cells->ends.array->line));
    }
    if ((uint64_t)end != cells->corners.count)
        return fail_count(r, cells->corners.array, cells->corners.count, end);
    return STARG_OK;
}

static void close_cells(vtp_cells *cells) {
    vtp_numbers_close(&cells->ends);
    vtp_numbers_close(&cells->corners);
}

/* ---- data of cells ---- */

/* Opens an array with `count` numbers at least; zeros for as many cells, if there are none yet. */
static starg_status open_data(vtp_reader *r, const vtp_array *array, int64_t count, double **data,
                              vtp_numbers *numbers) {
    TRY(vtp_numbers_open(&r->file, array, numbers));
    if (numbers->count < (uint64_t)count || (!array->strings && numbers->count > (uint64_t)count))
        return fail_count(r, array, numbers->count, count);
    if (*data == NULL)
        NEW_ZERO(r->source->context, STAGE, *data, (size_t)count);
    return STARG_OK;
}

static starg_status read_property(vtp_reader *r, const vtp_array *array, int64_t count,
                                  double **data) {
    SCOPED_BY(vtp_numbers_close) vtp_numbers numbers = {0};
    starg_face_values *values = r->file.builder->values;
    TRY(open_data(r, array, count, data, &numbers));
    for (int64_t i = 0; i < count; i++) {
        double value;
        TRY(numbers_real(&numbers.scan, numbers.type, "a value of a cell", &value));
        values->current = (*data)[i];
        starg_values_take(values, value);
        (*data)[i] = values->current;
    }
    return STARG_OK;
}

/* The value of a cell of this name. */
static starg_status value_of_name(vtp_reader *r, const char *name, size_t length, double *value) {
    starg_face_values *values = r->file.builder->values;
    *value = 0;
    if (length == 0)
        return STARG_OK;
    starg_values_note(values, name, length);
    if (values->collects)
        return starg_values_collect(r->source->context, values, name, length, value);
    *value = starg_values_want(values, name, length);
    return STARG_OK;
}

static starg_status read_names(vtp_reader *r, const vtp_array *array, int64_t count,
                               double **data) {
    SCOPED_BY(vtp_numbers_close) vtp_numbers numbers = {0};
    SCOPED char *text = NULL;
    size_t begin = 0, before = 0, length_before = 0;
    double value = 0;
    TRY(open_data(r, array, count, data, &numbers));
    NEW(r->source->context, STAGE, text, numbers.count);
    for (size_t i = 0; i < numbers.count; i++) {
        int64_t character;
        TRY(numbers_integer(&numbers.scan, numbers.type, "a character", &character));
        text[i] = (char)character;
    }
    for (int64_t i = 0; i < count; i++) {
        size_t end = begin;
        while (end < numbers.count && text[end] != '\0')
            end++;
        if (end == numbers.count)
            return starg_source_fail(r->source, starg_at_line(array->line),
                                     "the array '%s' has %lld strings, but its piece needs %lld",
                                     starg_word_excerpt(array->name).text, (long long)i,
                                     (long long)count);
        if (i == 0 || end - begin != length_before ||
            memcmp(text + begin, text + before, length_before) != 0)
            TRY(value_of_name(r, text + begin, end - begin, &value));
        if ((*data)[i] == 0)
            (*data)[i] = value;
        before = begin;
        length_before = end - begin;
        begin = end + 1;
    }
    return STARG_OK;
}

/* Values of all cells of a piece, as far as names in the file are wanted; NULL: none are. */
static starg_status read_data(vtp_reader *r, const vtp_piece *piece, double **data) {
    starg_face_values *values = r->file.builder->values;
    int64_t count = 0;
    if (values == NULL)
        return STARG_OK;
    for (int k = 0; k < KINDS; k++)
        count += piece->cells[k];
    for (size_t i = 0; i < piece->arrays; i++) {
        const vtp_array *array = &r->arrays.data[piece->first + i];
        if (array->section != VTP_DATA || array->several || array->name.length == 0)
            continue;
        bool wanted = false;
        if (!array->strings) {
            starg_values_note(values, array->name.text, array->name.length);
            wanted = !values->collects &&
                     starg_values_want_property(values, array->name.text, array->name.length);
        }
        if (wanted)
            TRY(read_property(r, array, count, data));
        else if (array->strings)
            TRY(read_names(r, array, count, data));
    }
    return STARG_OK;
}

static starg_status read_piece(vtp_reader *r, const vtp_piece *piece) {
    SCOPED double *data = NULL;
    size_t first = starg_builder_vertex_count(r->file.builder);
    int64_t cell = 0;
    if (piece->cells[VTP_POLYS] == 0 && piece->cells[VTP_STRIPS] == 0 && piece->points == 0)
        return STARG_OK;
    TRY(read_points(r, piece));
    TRY(read_data(r, piece, &data));
    if (r->file.builder->values != NULL)
        r->file.builder->values->current = 0;
    for (int k = 0; k < KINDS; cell += piece->cells[k++]) {
        SCOPED_BY(close_cells) vtp_cells cells = {.r = r, .piece = piece, .first = first};
        if (piece->cells[k] > 0 && k >= VTP_POLYS)
            TRY(read_cells(&cells, (vtp_section)k, data == NULL ? NULL : data + cell));
    }
    return STARG_OK;
}

static void free_reader(vtp_reader *r) {
    RELEASE(r->pieces.data, r->arrays.data);
}

starg_status starg_vtp_read(starg_mesh_builder *builder) {
    SCOPED_BY(free_reader)
    vtp_reader r = {.file = {.builder = builder},
                    .source = builder->source,
                    .scan = xml_scan_make(builder->source)};
    TRY(read_elements(&r));
    for (size_t p = 0; p < r.pieces.count; p++)
        TRY(read_piece(&r, &r.pieces.data[p]));
    return STARG_OK;
}
