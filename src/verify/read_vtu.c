/* SPDX-License-Identifier: Apache-2.0 */
/* MAP.vtu, read for the verifier: a VTK XML unstructured grid of this form only (docs/formats.md):
 *
 *     VTKFile > UnstructuredGrid > FieldData: distortion (3), guard (3 p), guard_image (3 p)
 *                                             time (k)
 *                                  Piece > PointData: image (3 n), key_0000 (3 n) ...
 *                                          CellData: piece (m), ratio (m)
 *                                          Points (3 n); Cells: connectivity (4 m),
 *                                          offsets (m: 4, 8, ...), types (m: 10)
 *
 * Elements are taken in any order, arrays of other names are skipped, and numbers are text
 * (format="ascii"). Nothing else of XML is understood: neither entities nor sections of raw text.
 * Counts are compared with the numbers that are there, never allocated in advance. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/file.h"
#include "verify/pieces.h"

static const char STAGE[] = "map file";

enum { TETRAHEDRON = 10, WORD = 64, CANCEL_STEP = 1 << 16 };

typedef STARG_ARRAY(double) number_list;

/* The arrays that are wanted. */
typedef enum vtu_name {
    POINTS,
    IMAGE,
    CONNECTIVITY,
    OFFSETS,
    TYPES,
    PIECE,
    RATIO,
    DISTORTION,
    GUARD,
    GUARD_IMAGE,
    MISSED,
    TIME,
    NAMES
} vtu_name;

typedef struct vtu_array {
    const char *section, *name; /* NULL: any name */
} vtu_array;

static const vtu_array WANTED[NAMES] = {
    [POINTS] = {"Points", NULL},
    [IMAGE] = {"PointData", "image"},
    [CONNECTIVITY] = {"Cells", "connectivity"},
    [OFFSETS] = {"Cells", "offsets"},
    [TYPES] = {"Cells", "types"},
    [PIECE] = {"CellData", "piece"},
    [RATIO] = {"CellData", "ratio"},
    [DISTORTION] = {"FieldData", "distortion"},
    [GUARD] = {"FieldData", "guard"},
    [GUARD_IMAGE] = {"FieldData", "guard_image"},
    [MISSED] = {"FieldData", "missed"},
    [TIME] = {"FieldData", "time"},
};

typedef struct reader {
    starg_context *context;
    const char *name;
    const char *begin, *at, *end;
    char section[WORD]; /* the last element that may hold arrays */
    bool found[NAMES];
    number_list numbers[NAMES];
    number_list keys; /* of arrays key_0000, key_0001, ..., one after the other */
    size_t key_count;
    size_t points, cells; /* as declared */
    bool counted;
} reader;

/* ---- failures ---- */

static starg_status reject(const reader *r, const char *what) {
    uint64_t place = 1;
    for (const char *c = r->begin; c < r->at && c < r->end; c++)
        place += *c == '\n';
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_LINE, &place, 1,
                         "'%s', line %llu: %s", r->name, (unsigned long long)place, what);
}

static starg_status reject_array(const reader *r, const char *name, const char *what) {
    return starg_fail(r->context, STARG_ERROR_FORMAT, STAGE, "'%s': array '%s' %s", r->name, name,
                      what);
}

/* ---- tags ---- */

/* A start tag: its name, and the text of its attributes. */
typedef struct tag {
    char name[WORD];
    const char *attributes, *end;
    bool closed; /* it has no contents */
} tag;

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/* The value of an attribute; false if there is none, or if it is too long to be of use. */
static bool attribute(const tag *t, const char *key, char value[WORD]) {
    size_t length = strlen(key);
    for (const char *c = t->attributes; c + length + 2 < t->end; c++) {
        if (!is_blank(c[-1]) || memcmp(c, key, length) != 0 || c[length] != '=')
            continue;
        char quote = c[length + 1];
        const char *from = c + length + 2;
        const char *to = memchr(from, quote, (size_t)(t->end - from));
        if ((quote != '"' && quote != '\'') || to == NULL || to - from >= WORD)
            return false;
        memcpy(value, from, (size_t)(to - from));
        value[to - from] = '\0';
        return true;
    }
    return false;
}

/* Moves behind the next start tag; false at the end of the file. */
static bool next_tag(reader *r, tag *out) {
    for (;;) {
        const char *open = memchr(r->at, '<', (size_t)(r->end - r->at));
        const char *close = open != NULL ? memchr(open, '>', (size_t)(r->end - open)) : NULL;
        if (close == NULL)
            return false;
        r->at = close + 1;
        const char *c = open + 1;
        if (c == close || *c == '/' || *c == '?' || *c == '!')
            continue;
        size_t length = 0;
        while (c < close && !is_blank(*c) && *c != '/' && length < WORD - 1)
            out->name[length++] = *c++;
        out->name[length] = '\0';
        out->attributes = c;
        out->end = close;
        out->closed = close[-1] == '/';
        return true;
    }
}

/* ---- numbers ---- */

/* The numbers up to the next tag. */
static starg_status read_numbers(reader *r, number_list *out) {
    while (true) {
        while (r->at < r->end && is_blank(*r->at))
            r->at++;
        if (r->at == r->end || *r->at == '<')
            break;
        if (out->count % CANCEL_STEP == 0)
            TRY(starg_check_cancel(r->context, STAGE));
        char *rest;
        double value = strtod(r->at, &rest); /* a zero byte follows the file */
        if (rest == r->at || (rest < r->end && !is_blank(*rest) && *rest != '<'))
            return reject(r, "a number is expected here");
        PUSH(r->context, STAGE, out, value);
        r->at = rest;
    }
    return STARG_OK;
}

/* Arrays of keys must come in order. */
static starg_status read_key(reader *r, const tag *t, const char *name) {
    char expected[WORD], format[WORD] = "";
    snprintf(expected, sizeof expected, "key_%04zu", r->key_count++);
    if (strcmp(name, expected) != 0)
        return reject(r, "places at times must be named key_0000, key_0001 and so on");
    if (!attribute(t, "format", format) || strcmp(format, "ascii") != 0)
        return reject(r, "only arrays of format \"ascii\" are read");
    return t->closed ? STARG_OK : read_numbers(r, &r->keys);
}

static starg_status read_array(reader *r, const tag *t) {
    char name[WORD] = "", format[WORD] = "";
    attribute(t, "Name", name);
    if (strcmp(r->section, "PointData") == 0 && strncmp(name, "key_", 4) == 0)
        return read_key(r, t, name);
    for (int i = 0; i < NAMES; i++) {
        if (strcmp(r->section, WANTED[i].section) != 0 ||
            (WANTED[i].name != NULL && strcmp(name, WANTED[i].name) != 0))
            continue;
        if (r->found[i])
            return reject(r, "this array is there twice");
        r->found[i] = true;
        if (!attribute(t, "format", format) || strcmp(format, "ascii") != 0)
            return reject(r, "only arrays of format \"ascii\" are read");
        return t->closed ? STARG_OK : read_numbers(r, &r->numbers[i]);
    }
    return STARG_OK;
}

static starg_status read_counts(reader *r, const tag *t) {
    char points[WORD], cells[WORD], *rest[2];
    if (r->counted)
        return reject(r, "only grids of one Piece are read");
    r->counted = true;
    if (!attribute(t, "NumberOfPoints", points) || !attribute(t, "NumberOfCells", cells))
        return reject(r, "NumberOfPoints and NumberOfCells are expected");
    r->points = (size_t)strtoull(points, &rest[0], 10);
    r->cells = (size_t)strtoull(cells, &rest[1], 10);
    if (*rest[0] != '\0' || *rest[1] != '\0' || *points == '-' || *cells == '-')
        return reject(r, "NumberOfPoints and NumberOfCells must be whole numbers");
    return STARG_OK;
}

static starg_status read_tags(reader *r) {
    static const char *const SECTIONS[] = {"FieldData", "PointData", "CellData", "Points", "Cells"};
    starg_status status = STARG_OK;
    char value[WORD];
    tag t;
    if (!next_tag(r, &t) || strcmp(t.name, "VTKFile") != 0 || !attribute(&t, "type", value) ||
        strcmp(value, "UnstructuredGrid") != 0)
        return reject(r, "not a VTKFile of type UnstructuredGrid");
    while (status == STARG_OK && next_tag(r, &t)) {
        for (size_t i = 0; i < sizeof SECTIONS / sizeof *SECTIONS; i++)
            if (strcmp(t.name, SECTIONS[i]) == 0)
                strcpy(r->section, t.name);
        if (strcmp(t.name, "Piece") == 0)
            status = read_counts(r, &t);
        else if (strcmp(t.name, "DataArray") == 0)
            status = read_array(r, &t);
    }
    return status;
}

/* ---- the map ---- */

static starg_status expect_count(const reader *r, vtu_name array, size_t count) {
    const char *name = WANTED[array].name != NULL ? WANTED[array].name : WANTED[array].section;
    char text[128];
    if (!r->found[array])
        return reject_array(r, name, "is missing; is this a MAP.vtu of 'starguard map --solid'?");
    if (r->numbers[array].count == count)
        return STARG_OK;
    snprintf(text, sizeof text, "has %zu numbers where %zu are expected", r->numbers[array].count,
             count);
    return reject_array(r, name, text);
}

static starg_status take_points(const reader *r, const number_list *from, double **out) {
    NEW(r->context, STAGE, *out, from->count);
    for (size_t i = 0; i < from->count; i++) {
        uint64_t index = i / 3;
        if (!(fabs(from->data[i]) < 1e100))
            return starg_fail_at(
                r->context, STARG_ERROR_RANGE, STAGE, STARG_ELEMENT_VERTEX, &index, 1,
                "'%s': point %zu is not finite, or not below 1e100 in magnitude", r->name, i / 3);
        (*out)[i] = from->data[i];
    }
    return STARG_OK;
}

static starg_status reject_cell(const reader *r, size_t t, const char *what, double found) {
    uint64_t index = t;
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_TETRAHEDRON, &index,
                         1, "'%s': cell %zu %s: %.9g", r->name, t, what, found);
}

static starg_status take_cells(const reader *r, starg_solid_map *map) {
    NEW(r->context, STAGE, map->tetrahedra, 4 * r->cells);
    NEW(r->context, STAGE, map->labels, r->cells);
    NEW(r->context, STAGE, map->ratios, r->cells);
    for (size_t t = 0; t < r->cells; t++) {
        double label = r->numbers[PIECE].data[t];
        if (r->numbers[TYPES].data[t] != TETRAHEDRON)
            return reject_cell(r, t, "must be of type 10, a tetrahedron",
                               r->numbers[TYPES].data[t]);
        for (size_t i = 4 * t; i < 4 * t + 4; i++) {
            double v = r->numbers[CONNECTIVITY].data[i];
            if (!(v >= 0 && v < (double)r->points && v == floor(v)))
                return reject_cell(r, t, "names a point that is not there", v);
            map->tetrahedra[i] = (uint32_t)v;
        }
        if (!(label >= 0 && label < (double)map->piece_count && label == floor(label)))
            return reject_cell(r, t, "belongs to a piece that is not there", label);
        map->labels[t] = (int32_t)label;
        map->ratios[t] = r->numbers[RATIO].data[t];
        if (r->numbers[OFFSETS].data[t] != (double)(4 * t + 4) && map->misplaced++ == 0)
            map->first_misplaced = t;
    }
    map->count = r->cells;
    return STARG_OK;
}

/* Places at times that ascend between 0 and 1. */
static starg_status take_keys(const reader *r, starg_solid_map *map) {
    double before = 0;
    if (r->key_count == 0 && !r->found[TIME])
        return STARG_OK;
    TRY(expect_count(r, TIME, r->key_count));
    if (r->keys.count != 3 * r->points * r->key_count)
        return reject_array(r, "key_0000", "and those that follow have not three numbers a point");
    NEW(r->context, STAGE, map->times, r->key_count);
    for (size_t key = 0; key < r->key_count; key++) {
        map->times[key] = r->numbers[TIME].data[key];
        if (!(map->times[key] > before && map->times[key] < 1))
            return reject_array(r, "time", "does not ascend between 0 and 1");
        before = map->times[key];
    }
    TRY(take_points(r, &r->keys, &map->keys));
    map->key_count = r->key_count;
    return STARG_OK;
}

/* What a map tells that ends near B. */
static starg_status take_missed(const reader *r, starg_solid_map *map) {
    const double *missed = r->numbers[MISSED].data;
    if (!r->found[MISSED])
        return STARG_OK;
    TRY(expect_count(r, MISSED, 3));
    if (!(missed[0] >= 0 && missed[1] >= 0))
        return reject_array(r, "missed", "has a distance below 0");
    map->compared = true;
    map->distance = missed[0];
    map->distance_back = missed[1];
    map->missing = missed[2];
    return STARG_OK;
}

static starg_status take_map(const reader *r, starg_solid_map *map) {
    size_t pieces = r->numbers[GUARD].count / 3;
    if (!r->counted || r->cells == 0 || r->cells > VERIFY_TETRAHEDRA || r->points > UINT32_MAX / 4)
        return starg_fail(r->context, STARG_ERROR_FORMAT, STAGE,
                          "'%s': there are no cells, or more than 2^29", r->name);
    TRY(expect_count(r, POINTS, 3 * r->points));
    TRY(expect_count(r, IMAGE, 3 * r->points));
    TRY(expect_count(r, CONNECTIVITY, 4 * r->cells));
    TRY(expect_count(r, OFFSETS, r->cells));
    TRY(expect_count(r, TYPES, r->cells));
    TRY(expect_count(r, PIECE, r->cells));
    TRY(expect_count(r, RATIO, r->cells));
    TRY(expect_count(r, DISTORTION, 3));
    TRY(expect_count(r, GUARD, 3 * pieces));
    TRY(expect_count(r, GUARD_IMAGE, 3 * pieces));
    TRY(take_points(r, &r->numbers[POINTS], &map->vertices));
    TRY(take_points(r, &r->numbers[IMAGE], &map->images));
    TRY(take_points(r, &r->numbers[GUARD], &map->guards));
    TRY(take_points(r, &r->numbers[GUARD_IMAGE], &map->guard_images));
    map->vertex_count = r->points;
    map->piece_count = pieces;
    map->worst = r->numbers[DISTORTION].data[0];
    map->mean = r->numbers[DISTORTION].data[1];
    map->above_10 = r->numbers[DISTORTION].data[2];
    TRY(take_cells(r, map));
    TRY(take_keys(r, map));
    return take_missed(r, map);
}

/* strtod needs a byte behind the last number that ends it. */
static starg_status copy_text(reader *r, const void *bytes, size_t size, char **copy) {
    NEW(r->context, STAGE, *copy, size + 1);
    if (size > 0)
        memcpy(*copy, bytes, size);
    (*copy)[size] = '\0';
    r->begin = r->at = *copy;
    r->end = *copy + size;
    return STARG_OK;
}

starg_status starg_solid_map_read_memory(starg_context *context, const void *bytes, size_t size,
                                         const char *name, starg_solid_map **out) {
    starg_status status = STARG_OK;
    starg_solid_map *map = NULL;
    char *copy = NULL;
    reader r = {.context = context, .name = name};
    starg_c_locale locale = {0};
    *out = NULL;
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_TRY(copy_text(&r, bytes, size, &copy));
    STARG_NEW_ZERO(context, STAGE, map, 1);
    STARG_TRY(read_tags(&r));
    STARG_TRY(take_map(&r, map));
    *out = map;
done:
    starg_c_locale_leave(&locale);
    for (int i = 0; i < NAMES; i++)
        STARG_ARRAY_FREE(context, &r.numbers[i]);
    RELEASE(r.keys.data, copy);
    if (status != STARG_OK)
        starg_solid_map_free(context, map);
    return status;
}

void starg_solid_map_free(starg_context *context, starg_solid_map *map) {
    (void)context;
    if (map == NULL)
        return;
    RELEASE(map->vertices, map->images, map->tetrahedra, map->labels, map->guards,
            map->guard_images, map->ratios, map->times, map->keys, map);
}
