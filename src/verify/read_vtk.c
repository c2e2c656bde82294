/* SPDX-License-Identifier: Apache-2.0 */
/* PIECES.vtk, read for the verifier: a legacy VTK file of this form only (docs/formats.md):
 *
 *     # vtk DataFile Version 2.0 to 4.2      CELLS m 5m          of "4 a b c d"
 *     a title                                CELL_TYPES m        of 10
 *     ASCII or BINARY                        CELL_DATA m
 *     DATASET UNSTRUCTURED_GRID              SCALARS piece int 1
 *     POINTS n float or double               LOOKUP_TABLE default
 *
 * and with maps to balls FIELD FieldData 1, ball 12 m double. Binary numbers are big-endian,
 * integers of 32 bits. Further sections after the labels are skipped. Declared counts are compared
 * with the remaining bytes before allocating. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/file.h"
#include "core/memory.h"
#include "starguard/verify.h"
#include "verify/pieces.h"

static const char STAGE[] = "pieces file";

enum { TETRAHEDRON = 10, WORD = 64, CANCEL_STEP = 1 << 16 };

typedef struct reader {
    starg_context *context;
    const char *name;
    const char *begin, *at, *end;
    bool binary;
    bool single; /* points are floats */
} reader;

/* ---- failures ---- */

/* Reports what is wrong at the reader's position. */
static starg_status reject(const reader *r, const char *what) {
    uint64_t place = 1;
    if (r->binary) {
        place = (uint64_t)(r->at - r->begin);
        return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_BYTE, &place, 1,
                             "'%s', byte %llu: %s", r->name, (unsigned long long)place, what);
    }
    for (const char *c = r->begin; c < r->at; c++)
        place += *c == '\n';
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_LINE, &place, 1,
                         "'%s', line %llu: %s", r->name, (unsigned long long)place, what);
}

static starg_status reject_tetrahedron(const reader *r, uint64_t tetrahedron, const char *what,
                                       long long found) {
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_TETRAHEDRON,
                         &tetrahedron, 1, "'%s': cell %llu %s %lld", r->name,
                         (unsigned long long)tetrahedron, what, found);
}

/* ---- words ---- */

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static void skip_blanks(reader *r) {
    while (r->at < r->end && is_blank(*r->at))
        r->at++;
}

/* Copies the next word; false if there is none, or if it is longer than any valid word (the reader
 * then stays before it). */
static bool next_word(reader *r, char word[WORD]) {
    size_t length = 0;
    skip_blanks(r);
    while (r->at + length < r->end && !is_blank(r->at[length])) {
        if (length == WORD - 1)
            return false;
        word[length] = r->at[length];
        length++;
    }
    word[length] = '\0';
    r->at += length;
    return length > 0;
}

static starg_status expect(reader *r, const char *wanted) {
    char word[WORD], message[2 * WORD];
    skip_blanks(r);
    const char *before = r->at;
    if (next_word(r, word) && strcasecmp(word, wanted) == 0)
        return STARG_OK;
    r->at = before;
    snprintf(message, sizeof message,
             before == r->end ? "it ends where \"%s\" is expected" : "\"%s\" is expected here",
             wanted);
    return reject(r, message);
}

/* Skips the rest of the line; binary numbers start right after it. */
static void skip_line(reader *r) {
    while (r->at < r->end && *r->at != '\n')
        r->at++;
    r->at += r->at < r->end;
}

/* The next decimal integer of a text. */
static starg_status text_integer(reader *r, int64_t *value) {
    skip_blanks(r);
    *value = 0;
    const char *c = r->at;
    bool negative = c < r->end && *c == '-';
    int64_t sum = 0;
    int digits = 0;
    for (c += negative; c < r->end && *c >= '0' && *c <= '9' && digits < 18; c++, digits++)
        sum = 10 * sum + (*c - '0');
    if (digits == 0 || (c < r->end && !is_blank(*c)))
        return reject(r, r->at == r->end ? "it ends where a whole number is expected"
                                         : "a whole number is expected here");
    r->at = c;
    *value = negative ? -sum : sum;
    return STARG_OK;
}

static starg_status text_real(reader *r, double *value) {
    char word[WORD], *rest;
    skip_blanks(r);
    const char *before = r->at;
    bool good = next_word(r, word) && strspn(word, "+-.0123456789eEnNaAiIfF") == strlen(word);
    *value = good ? strtod(word, &rest) : 0;
    if (good && *rest == '\0')
        return STARG_OK;
    r->at = before;
    return reject(r, before == r->end ? "it ends where a number is expected"
                                      : "a number is expected here");
}

/* ---- binary numbers ---- */

static uint64_t big_endian(reader *r, int bytes) {
    uint64_t bits = 0;
    for (int i = 0; i < bytes; i++)
        bits = bits << 8 | (unsigned char)*r->at++;
    return bits;
}

/* The caller has checked that the bytes of the section exist. */
static starg_status read_integer(reader *r, int64_t *value) {
    if (!r->binary)
        return text_integer(r, value);
    *value = (int32_t)(uint32_t)big_endian(r, 4);
    return STARG_OK;
}

static starg_status read_real(reader *r, double *value) {
    if (!r->binary)
        return text_real(r, value);
    if (r->single) {
        uint32_t bits = (uint32_t)big_endian(r, 4);
        float number;
        memcpy(&number, &bits, sizeof number);
        *value = number;
    } else {
        uint64_t bits = big_endian(r, 8);
        memcpy(value, &bits, sizeof *value);
    }
    return STARG_OK;
}

/* ---- sections ---- */

/* A declared count: its numbers must fit into the rest of the file. */
static starg_status read_count(reader *r, size_t numbers_each, size_t bytes_each, size_t *count) {
    int64_t declared;
    starg_status status = text_integer(r, &declared);
    *count = 0;
    if (status != STARG_OK)
        return status;
    size_t left = (size_t)(r->end - r->at);
    size_t each = r->binary ? bytes_each : 2 * numbers_each;
    if (declared < 0 || (uint64_t)declared > (left + 1) / each)
        return reject(r, "the count is negative, or more is declared than the file holds");
    *count = (size_t)declared;
    return STARG_OK;
}

static starg_status expect_same(reader *r, size_t expected, const char *what) {
    int64_t count;
    starg_status status = text_integer(r, &count);
    if (status == STARG_OK && count != (int64_t)expected)
        status = reject(r, what);
    return status;
}

/* Does the file have that many more bytes for a binary section? */
static starg_status expect_bytes(const reader *r, size_t bytes) {
    if (r->binary && (size_t)(r->end - r->at) < bytes)
        return reject(r, "the file is truncated in the section that begins here");
    return STARG_OK;
}

static starg_status check_cancel(const reader *r, size_t i) {
    return i % CANCEL_STEP == 0 ? starg_check_cancel(r->context, STAGE) : STARG_OK;
}

static starg_status read_head(reader *r) {
    static const char magic[] = "# vtk DataFile Version ";
    starg_status status = STARG_OK;
    char word[WORD];
    if ((size_t)(r->end - r->at) < sizeof magic - 1 || memcmp(r->at, magic, sizeof magic - 1) != 0)
        return reject(r, "not a legacy VTK file: \"# vtk DataFile Version\" is missing");
    r->at += sizeof magic - 1;
    if (r->at == r->end || *r->at < '1' || *r->at > '4')
        return reject(r, "only versions below 5 of the legacy VTK format are read");
    skip_line(r);
    skip_line(r);
    bool known = next_word(r, word);
    bool binary = known && strcasecmp(word, "BINARY") == 0;
    if (!binary && !(known && strcasecmp(word, "ASCII") == 0))
        return reject(r, "ASCII or BINARY is expected as the third line");
    STARG_TRY(expect(r, "DATASET"));
    STARG_TRY(expect(r, "UNSTRUCTURED_GRID"));
    STARG_TRY(expect(r, "POINTS"));
    r->binary = binary;
done:
    return status;
}

static starg_status reject_point(const reader *r, size_t vertex) {
    uint64_t index = vertex;
    return starg_fail_at(r->context, STARG_ERROR_RANGE, STAGE, STARG_ELEMENT_VERTEX, &index, 1,
                         "'%s': point %zu is not finite, or not below 1e100 in magnitude", r->name,
                         vertex);
}

static starg_status read_points(reader *r, starg_pieces_mesh *mesh) {
    starg_status status = STARG_OK;
    char word[WORD];
    size_t count;
    STARG_TRY(read_count(r, 3, 3 * sizeof(float), &count));
    bool known = next_word(r, word);
    r->single = known && strcasecmp(word, "float") == 0;
    if (!r->single && !(known && strcasecmp(word, "double") == 0)) {
        status = reject(r, "points must be of type float or double");
        goto done;
    }
    skip_line(r);
    STARG_TRY(expect_bytes(r, 3 * count * (r->single ? sizeof(float) : sizeof(double))));
    STARG_NEW(r->context, STAGE, mesh->vertices, 3 * count);
    mesh->vertex_count = count;
    for (size_t i = 0; i < 3 * count; i++) {
        STARG_TRY(check_cancel(r, i));
        STARG_TRY(read_real(r, &mesh->vertices[i]));
        if (!(fabs(mesh->vertices[i]) < 1e100)) {
            status = reject_point(r, i / 3);
            goto done;
        }
    }
done:
    return status;
}

static starg_status read_tetrahedron(reader *r, const starg_pieces_mesh *mesh, size_t t) {
    starg_status status = STARG_OK;
    int64_t value;
    STARG_TRY(read_integer(r, &value));
    if (value != 4)
        return reject_tetrahedron(r, t, "is no tetrahedron: its number of corners is", value);
    for (size_t i = 0; i < 4; i++) {
        STARG_TRY(read_integer(r, &value));
        if (value < 0 || (uint64_t)value >= mesh->vertex_count)
            return reject_tetrahedron(r, t, "names a point that does not exist:", value);
        mesh->tetrahedra[4 * t + i] = (uint32_t)value;
    }
done:
    return status;
}

static starg_status read_cells(reader *r, starg_pieces_mesh *mesh) {
    starg_status status = STARG_OK;
    size_t count;
    STARG_TRY(expect(r, "CELLS"));
    STARG_TRY(read_count(r, 5, 5 * sizeof(int32_t), &count));
    if (count == 0 || count > VERIFY_TETRAHEDRA) {
        status = reject(r, count == 0 ? "there are no cells" : "more cells than 2^29");
        goto done;
    }
    STARG_TRY(expect_same(r, 5 * count,
                          "cells must all be tetrahedra: five numbers for each are expected"));
    skip_line(r);
    STARG_TRY(expect_bytes(r, 5 * count * sizeof(int32_t)));
    STARG_NEW(r->context, STAGE, mesh->tetrahedra, 4 * count);
    mesh->count = count;
    for (size_t t = 0; t < count; t++) {
        STARG_TRY(check_cancel(r, t));
        STARG_TRY(read_tetrahedron(r, mesh, t));
    }
done:
    return status;
}

static starg_status read_types(reader *r, const starg_pieces_mesh *mesh) {
    starg_status status = STARG_OK;
    STARG_TRY(expect(r, "CELL_TYPES"));
    STARG_TRY(expect_same(r, mesh->count, "as many types as cells are expected"));
    skip_line(r);
    STARG_TRY(expect_bytes(r, mesh->count * sizeof(int32_t)));
    for (size_t t = 0; t < mesh->count; t++) {
        int64_t type;
        STARG_TRY(read_integer(r, &type));
        if (type != TETRAHEDRON)
            return reject_tetrahedron(r, t, "must be of type 10, a tetrahedron; it is of type",
                                      type);
    }
done:
    return status;
}

static starg_status read_labels(reader *r, starg_pieces_mesh *mesh) {
    starg_status status = STARG_OK;
    STARG_TRY(expect(r, "CELL_DATA"));
    STARG_TRY(expect_same(r, mesh->count, "as many labels as cells are expected"));
    STARG_TRY(expect(r, "SCALARS"));
    STARG_TRY(expect(r, "piece"));
    STARG_TRY(expect(r, "int"));
    skip_line(r); /* the number of components, 1, is optional */
    STARG_TRY(expect(r, "LOOKUP_TABLE"));
    skip_line(r);
    STARG_TRY(expect_bytes(r, mesh->count * sizeof(int32_t)));
    STARG_NEW(r->context, STAGE, mesh->labels, mesh->count);
    for (size_t t = 0; t < mesh->count; t++) {
        int64_t label;
        STARG_TRY(read_integer(r, &label));
        if (label < INT32_MIN || label > INT32_MAX)
            return reject_tetrahedron(r, t, "has a label beyond 32 bits:", label);
        mesh->labels[t] = (int32_t)label;
    }
done:
    return status;
}

/* Images of the corners, if they come next. */
static starg_status read_corners(reader *r, starg_pieces_mesh *mesh) {
    starg_status status = STARG_OK;
    char word[WORD];
    const char *before = r->at;
    if (!next_word(r, word) || strcasecmp(word, "FIELD") != 0) {
        r->at = before;
        return STARG_OK;
    }
    STARG_TRY(expect(r, "FieldData"));
    STARG_TRY(expect_same(r, 1, "one array of data is expected"));
    STARG_TRY(expect(r, "ball"));
    STARG_TRY(expect_same(r, 12, "twelve numbers for each cell are expected"));
    STARG_TRY(expect_same(r, mesh->count, "as many images as cells are expected"));
    STARG_TRY(expect(r, "double"));
    skip_line(r);
    if (!r->binary && (size_t)(r->end - r->at) / 24 < mesh->count)
        return reject(r, "more is declared than the file holds");
    STARG_TRY(expect_bytes(r, 12 * mesh->count * sizeof(double)));
    STARG_NEW(r->context, STAGE, mesh->corners, 12 * mesh->count);
    r->single = false;
    for (size_t i = 0; i < 12 * mesh->count; i++) {
        STARG_TRY(check_cancel(r, i));
        STARG_TRY(read_real(r, &mesh->corners[i]));
    }
done:
    return status;
}

/* Rejects numbers beyond the declared count. */
static starg_status read_end(reader *r) {
    skip_blanks(r);
    if (r->at == r->end || (*r->at >= 'A' && *r->at <= 'Z'))
        return STARG_OK;
    return reject(r, "more follows behind the last label");
}

static starg_status read_all(reader *r, starg_pieces_mesh *mesh) {
    starg_status status = STARG_OK;
    STARG_TRY(read_head(r));
    STARG_TRY(read_points(r, mesh));
    STARG_TRY(read_cells(r, mesh));
    STARG_TRY(read_types(r, mesh));
    STARG_TRY(read_labels(r, mesh));
    STARG_TRY(read_corners(r, mesh));
    STARG_TRY(read_end(r));
done:
    return status;
}

starg_status starg_pieces_mesh_read_memory(starg_context *context, const void *bytes, size_t size,
                                           const char *name, starg_pieces_mesh **out) {
    starg_status status = STARG_OK;
    starg_pieces_mesh *mesh = NULL;
    const char *begin = size > 0 ? bytes : "";
    reader r = {.context = context, .name = name, .begin = begin, .at = begin, .end = begin + size};
    starg_c_locale locale = {0};
    *out = NULL;
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_NEW_ZERO(context, STAGE, mesh, 1);
    STARG_TRY(read_all(&r, mesh));
    *out = mesh;
done:
    starg_c_locale_leave(&locale);
    if (status != STARG_OK)
        starg_pieces_mesh_free(context, mesh);
    return status;
}

void starg_pieces_mesh_free(starg_context *context, starg_pieces_mesh *mesh) {
    if (mesh == NULL)
        return;
    starg_release(context, mesh->vertices);
    starg_release(context, mesh->tetrahedra);
    starg_release(context, mesh->labels);
    starg_release(context, mesh->corners);
    starg_release(context, mesh);
}
