/* SPDX-License-Identifier: Apache-2.0 */
/* Wavefront OBJ: lines of a keyword and values; only v, vt and f matter, and for values of faces by
 * a name the groups, objects and materials that they are in. Faces may refer to later
 * vertices, so a first pass reads vertices and a second one faces. Referenced files are never
 * opened. */
#include <math.h>

#include "mesh/formats/scan.h"

bool starg_obj_matches(const starg_source *source) {
    static const char *const keywords[] = {"v", "vn", "vt", "vp", "f",      "o",
                                           "g", "s",  "l",  "p",  "mtllib", "usemtl"};
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    if (!starg_scan_word(&scan, &word))
        return false;
    for (size_t i = 0; i < sizeof keywords / sizeof keywords[0]; i++)
        if (starg_word_is(word, keywords[i]))
            return true;
    return false;
}

static starg_scan scan_lines(const starg_source *source) {
    starg_scan scan = starg_scan_make(source);
    scan.continuations = true;
    return scan;
}

/* x y z, optionally followed by a weight or a colour. */
static starg_status read_vertex(starg_scan *scan, starg_mesh_builder *builder) {
    enum { MOST_EXTRAS = 5 };
    starg_place place = starg_at_line(scan->line);
    double point[3];
    for (int k = 0; k < 3; k++) {
        starg_word word;
        if (!starg_scan_word_here(scan, &word))
            return starg_source_fail(scan->source, place,
                                     "a vertex has %d coordinate%s; it needs 3", k,
                                     k == 1 ? "" : "s");
        TRY(starg_word_real(scan, word, "a coordinate of a vertex", &point[k]));
    }
    TRY(starg_builder_vertex(builder, point, place));
    double color[3];
    bool whole;
    if (starg_scan_peek(*scan, 0, color, &whole)) /* one number is a weight */
        TRY(starg_builder_color(builder, color,
                                fmax(color[0], fmax(color[1], color[2])) > 1 ? 255 : 1));
    return starg_scan_extra_numbers(scan, MOST_EXTRAS, "a weight or a colour");
}

typedef STARG_ARRAY(double) numbers;

/* u v, optionally followed by w; what is no number is 0. */
static starg_status read_texture(starg_scan *scan, numbers *texture) {
    for (int k = 0; k < 2; k++) {
        double number = 0;
        starg_word word;
        if (starg_scan_word_here(scan, &word))
            (void)starg_parse_real(word.text, word.length, &number);
        PUSH(scan->source->context, STARG_MESH_FILE, texture, number);
    }
    return STARG_OK;
}

/* Parses v, v/t, v//n or v/t/n; t and n must be numbers. *texture: t, 0 if there is none. */
static bool parse_corner(starg_word word, int64_t *vertex, int64_t *texture) {
    size_t begin = 0;
    *texture = 0;
    for (int part = 0; part < 3; part++) {
        size_t end = begin;
        while (end < word.length && word.text[end] != '/')
            end++;
        int64_t value = 0;
        bool empty = end == begin;
        if (!empty && !starg_parse_integer(word.text + begin, end - begin, &value))
            return false;
        if (part == 0 && empty)
            return false;
        if (part == 0)
            *vertex = value;
        if (part == 1)
            *texture = value;
        if (end == word.length)
            return true;
        begin = end + 1;
    }
    return false;
}

/* Positive indices count from 1, negative ones backward from the last vertex before this line;
 * `out` counts from 0. */
static starg_status resolve(starg_scan *scan, int64_t given, size_t before,
                            const starg_mesh_builder *builder, int64_t *out) {
    size_t count = starg_builder_vertex_count(builder);
    if (given > 0 && (uint64_t)given <= count)
        *out = given - 1;
    else if (given < 0 && given >= -(int64_t)before)
        *out = (int64_t)before + given;
    else
        return starg_source_fail(scan->source, starg_at_line(scan->line),
                                 "a face refers to vertex %lld, but there are %zu vertices, %zu of "
                                 "them before this line; indices count from 1, or backward from -1",
                                 (long long)given, count, before);
    return STARG_OK;
}

/* What precedes a line. */
typedef struct counts {
    size_t vertices, textures;
} counts;

/* Reads the corners of a face. A texture coordinate that is not there is none. */
static starg_status read_face(starg_scan *scan, const counts *before, const numbers *texture,
                              starg_mesh_builder *builder) {
    starg_place place = starg_at_line(scan->line);
    starg_word word;
    while (starg_scan_word_here(scan, &word)) {
        int64_t vertex = 0, uv = 0;
        if (!parse_corner(word, &vertex, &uv))
            return starg_source_fail(scan->source, starg_at_line(word.line),
                                     "'%s' is not a corner of a face, which is v, v/t, v//n or "
                                     "v/t/n in whole numbers",
                                     starg_word_excerpt(word).text);
        TRY(resolve(scan, vertex, before->vertices, builder, &vertex));
        TRY(starg_builder_corner(builder, vertex, starg_at_line(word.line)));
        size_t at = (uv < 0 ? before->textures + (size_t)uv : (size_t)uv - 1);
        if (uv != 0 && at < texture->count / 2)
            TRY(starg_builder_corner_texture(builder, texture->data + 2 * at));
    }
    return starg_builder_face(builder, place);
}

static starg_status read_vertices(starg_mesh_builder *builder, numbers *texture) {
    starg_scan scan = scan_lines(builder->source);
    starg_word word;
    while (starg_scan_word(&scan, &word)) {
        if (starg_word_is(word, "v"))
            TRY(read_vertex(&scan, builder));
        else if (starg_word_is(word, "vt"))
            TRY(read_texture(&scan, texture));
        else if (starg_word_is(word, "usemtl"))
            builder->left_out |= STARG_MESH_COLORS;
        starg_scan_next_line(&scan);
        TRY(starg_builder_tick(builder, (size_t)(scan.at - scan.source->bytes) / 2));
    }
    return STARG_OK;
}

/* Which of group, object and material have a wanted name at this line? A group may have several,
 * and any name may have spaces. */
enum { GROUP, OBJECT, MATERIAL, KEYWORDS };

static void take_names(starg_scan *scan, starg_word keyword, starg_face_values *values,
                       bool held[KEYWORDS]) {
    static const char *const keywords[KEYWORDS] = {"g", "o", "usemtl"};
    for (int k = 0; k < KEYWORDS; k++) {
        starg_word name;
        if (!starg_word_is(keyword, keywords[k]))
            continue;
        held[k] = false;
        const char *begin = NULL, *end = NULL;
        while (starg_scan_word_here(scan, &name)) {
            begin = begin != NULL ? begin : name.text;
            end = name.text + name.length;
            held[k] = starg_values_want(values, name.text, name.length) || held[k];
            if (k == GROUP)
                starg_values_note(values, name.text, name.length);
        }
        if (begin != NULL && k != GROUP)
            starg_values_note(values, begin, (size_t)(end - begin));
        if (begin != NULL)
            held[k] = starg_values_want(values, begin, (size_t)(end - begin)) || held[k];
    }
    values->current = held[GROUP] || held[OBJECT] || held[MATERIAL];
}

/* The same where groups are collected: a face is in its group, of these the last, or else in its
 * object, or in its material. */
static starg_status collect_names(starg_scan *scan, starg_word keyword, starg_context *context,
                                  starg_face_values *values, double held[KEYWORDS]) {
    static const char *const keywords[KEYWORDS] = {"g", "o", "usemtl"};
    for (int k = 0; k < KEYWORDS; k++) {
        starg_word name;
        if (!starg_word_is(keyword, keywords[k]))
            continue;
        const char *begin = NULL, *end = NULL;
        while (starg_scan_word_here(scan, &name)) {
            begin = begin != NULL ? begin : name.text;
            end = name.text + name.length;
        }
        held[k] = 0;
        if (begin != NULL)
            TRY(starg_values_collect(context, values, begin, (size_t)(end - begin), &held[k]));
    }
    values->current = held[GROUP] > 0    ? held[GROUP]
                      : held[OBJECT] > 0 ? held[OBJECT]
                                         : held[MATERIAL];
    return STARG_OK;
}

static starg_status read_faces(starg_mesh_builder *builder, const numbers *texture) {
    starg_scan scan = scan_lines(builder->source);
    starg_word word;
    counts before = {0};
    bool held[KEYWORDS] = {false};
    double groups[KEYWORDS] = {0};
    while (starg_scan_word(&scan, &word)) {
        before.vertices += starg_word_is(word, "v");
        before.textures += starg_word_is(word, "vt");
        if (builder->values != NULL && builder->values->collects)
            TRY(collect_names(&scan, word, builder->source->context, builder->values, groups));
        else if (builder->values != NULL)
            take_names(&scan, word, builder->values, held);
        if (starg_word_is(word, "f"))
            TRY(read_face(&scan, &before, texture, builder));
        starg_scan_next_line(&scan);
        size_t done = (size_t)(scan.at - scan.source->bytes);
        TRY(starg_builder_tick(builder, (scan.source->size + done) / 2));
    }
    return STARG_OK;
}

starg_status starg_obj_read(starg_mesh_builder *builder) {
    numbers texture = {0};
    starg_status status = read_vertices(builder, &texture);
    if (status == STARG_OK)
        status = read_faces(builder, &texture);
    if (texture.count > 0 && builder->texture.count == 0)
        builder->left_out |= STARG_MESH_TEXTURE;
    starg_release(builder->source->context, texture.data);
    return status;
}
