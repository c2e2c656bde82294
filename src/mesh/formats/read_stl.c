/* SPDX-License-Identifier: Apache-2.0 */
/* STL: a triangle soup, three points per triangle, as text or binary. Points at exactly equal
 * positions are welded; normals are ignored, orientation comes from the corner order.
 *
 * Many binary files start with "solid", so a size that matches the triangle count is tested first,
 * then whether the header contains a zero byte, which text never does. */
#include <strings.h>

#include "mesh/formats/io.h"
#include "mesh/formats/scan.h"

enum { HEADER = 84, RECORD = 50 };

static uint32_t little_endian(const char *bytes) {
    uint32_t value = 0;
    for (int i = 3; i >= 0; i--)
        value = value << 8 | (unsigned char)bytes[i];
    return value;
}

static uint64_t announced_size(const starg_source *source) {
    return HEADER + RECORD * (uint64_t)little_endian(source->bytes + 80);
}

static bool size_fits(const starg_source *source) {
    return source->size >= HEADER && announced_size(source) == source->size;
}

static bool keyword_is(starg_word word, const char *text) {
    return word.length == strlen(text) && strncasecmp(word.text, text, word.length) == 0;
}

static bool begins_with_solid(const starg_source *source) {
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    return starg_scan_word(&scan, &word) && keyword_is(word, "solid");
}

static bool is_binary(const starg_source *source) {
    size_t header = source->size < HEADER ? source->size : HEADER;
    return size_fits(source) || !begins_with_solid(source) ||
           memchr(source->bytes, '\0', header) != NULL;
}

bool starg_stl_matches(const starg_source *source) {
    return size_fits(source) || begins_with_solid(source);
}

/* One corner of the open face. */
static starg_status add_corner(starg_weld *weld, const double point[3], starg_place place) {
    uint32_t vertex;
    starg_status status = starg_weld_point(weld, point, place, &vertex);
    return status == STARG_OK ? starg_builder_corner(weld->builder, vertex, place) : status;
}

static starg_status expect_keyword(starg_scan *scan, const char *keyword) {
    starg_word word;
    starg_status status = starg_scan_expect(scan, keyword, &word);
    if (status != STARG_OK || keyword_is(word, keyword))
        return status;
    return starg_source_fail(scan->source, starg_at_line(word.line), "found '%s' instead of '%s'",
                             starg_word_excerpt(word).text, keyword);
}

/* After "facet": normal, outer loop, three points, endloop, endfacet. Normals of zero-area facets
 * are written in many ways, so their numbers may be anything. */
static starg_status read_facet(starg_scan *scan, starg_weld *weld) {
    starg_place place = starg_at_line(scan->line);
    starg_word ignored;
    double point[3];
    TRY(expect_keyword(scan, "normal"));
    for (int k = 0; k < 3; k++)
        TRY(starg_scan_expect(scan, "a coordinate of a normal", &ignored));
    TRY(expect_keyword(scan, "outer"));
    TRY(expect_keyword(scan, "loop"));
    for (int corner = 0; corner < 3; corner++) {
        TRY(expect_keyword(scan, "vertex"));
        for (int k = 0; k < 3; k++)
            TRY(starg_scan_real(scan, "a coordinate of a vertex", &point[k]));
        TRY(add_corner(weld, point, starg_at_line(scan->line)));
    }
    TRY(expect_keyword(scan, "endloop"));
    TRY(expect_keyword(scan, "endfacet"));
    TRY(starg_builder_face(weld->builder, place));
    return starg_builder_tick(weld->builder, (size_t)(scan->at - scan->source->bytes));
}

/* Reads facets up to "endsolid"; after either keyword the rest of the line is a name. */
static starg_status read_solid(starg_scan *scan, starg_weld *weld) {
    starg_word word;
    TRY(expect_keyword(scan, "solid"));
    starg_scan_next_line(scan);
    for (;;) {
        TRY(starg_scan_expect(scan, "facet or endsolid", &word));
        if (keyword_is(word, "endsolid"))
            break;
        if (!keyword_is(word, "facet"))
            return starg_source_fail(scan->source, starg_at_line(word.line),
                                     "found '%s' instead of 'facet' or 'endsolid'",
                                     starg_word_excerpt(word).text);
        TRY(read_facet(scan, weld));
    }
    starg_scan_next_line(scan);
    return STARG_OK;
}

/* Reads all solids of the text. */
static starg_status read_text(const starg_source *source, starg_weld *weld) {
    starg_scan scan = starg_scan_make(source);
    starg_scan ahead;
    starg_word word;
    scan.comments = false; /* STL has none, and names may contain any character */
    do {
        TRY(read_solid(&scan, weld));
        ahead = scan;
    } while (starg_scan_word(&ahead, &word));
    return STARG_OK;
}

/* Bytes after the triangles are ignored. */
static starg_status check_size(const starg_source *source) {
    if (source->size < HEADER)
        return starg_source_fail(
            source, starg_at_byte(source->size),
            "the file ends within the header of a binary STL file; it is truncated or not STL");
    uint64_t announced = announced_size(source);
    if (source->size < announced)
        return starg_source_fail(source, starg_at_byte(80),
                                 "the header declares %u triangles, which need %llu bytes, but the "
                                 "file has %zu; it is truncated or not STL",
                                 little_endian(source->bytes + 80), (unsigned long long)announced,
                                 source->size);
    if (source->size > announced)
        starg_log(source->context, STARG_LOG_NOTICE,
                  "'%s': ignored %llu bytes after the %u declared triangles", source->name,
                  (unsigned long long)(source->size - announced),
                  little_endian(source->bytes + 80));
    return STARG_OK;
}

static starg_status read_binary(const starg_source *source, starg_weld *weld) {
    enum { NORMAL = 12, POINT = 12, COORDINATE = 4 };
    TRY(check_size(source));
    for (size_t at = HEADER; at < announced_size(source); at += RECORD) {
        for (size_t corner = 0; corner < 3; corner++) {
            double point[3];
            size_t begin = at + NORMAL + POINT * corner;
            for (size_t k = 0; k < 3; k++) {
                uint32_t bits = little_endian(source->bytes + begin + COORDINATE * k);
                float value;
                memcpy(&value, &bits, sizeof value);
                point[k] = (double)value;
            }
            TRY(add_corner(weld, point, starg_at_byte(begin)));
        }
        TRY(starg_builder_face(weld->builder, starg_at_byte(at)));
        TRY(starg_builder_tick(weld->builder, at));
    }
    return STARG_OK;
}

starg_status starg_stl_read(starg_mesh_builder *builder) {
    starg_weld weld = {.builder = builder};
    starg_status status = is_binary(builder->source) ? read_binary(builder->source, &weld)
                                                     : read_text(builder->source, &weld);
    starg_weld_free(&weld);
    return status;
}
