/* SPDX-License-Identifier: Apache-2.0 */
/* Gmsh .msh, versions 2 and 4.1, text or binary. Nodes have tags, not necessarily consecutive;
 * elements come in blocks of one type. Other sections are skipped.
 *
 * Version 2 binary: element blocks of (type, count, tags), four-byte numbers; text: one element a
 * line. Version 4: entity blocks in both, tags as size_t. */
#include <stdlib.h>

#include "tetra/io.h"

static const char STAGE[] = STARG_MESH_FILE;

typedef struct node {
    int64_t tag;
    size_t index;
} node;

typedef struct gmsh_reader {
    tet_builder *builder;
    number_scan numbers;
    bool version4;
    number_type size_type; /* of counts and tags in binary data of version 4 */
    STARG_ARRAY(node) nodes;
} gmsh_reader;

static const starg_source *source_of(const gmsh_reader *gmsh) {
    return gmsh->builder->points.source;
}

bool tet_gmsh_matches(const starg_source *source) {
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    scan.comments = false;
    return starg_scan_word(&scan, &word) &&
           (starg_word_is(word, "$MeshFormat") || starg_word_is(word, "$Comments") ||
            starg_word_is(word, "$NOD"));
}

static starg_status tick(gmsh_reader *gmsh) {
    return starg_builder_tick(&gmsh->builder->points,
                              (size_t)(gmsh->numbers.scan.at - source_of(gmsh)->bytes));
}

static starg_status integer(gmsh_reader *gmsh, number_type type, const char *what, int64_t *value) {
    return numbers_integer(&gmsh->numbers, type, what, value);
}

/* Counts and tags that are size_t in version 4. */
static starg_status size(gmsh_reader *gmsh, const char *what, int64_t *value) {
    return integer(gmsh, gmsh->size_type, what, value);
}

static void begin_data(gmsh_reader *gmsh) {
    if (gmsh->numbers.encoding != NUMBERS_TEXT)
        starg_scan_next_line(&gmsh->numbers.scan);
}

/* ---- sections ---- */

/* Version, 0 or 1 for binary, size of a size_t; binary: a one that reveals the byte order. */
static starg_status read_format(gmsh_reader *gmsh) {
    starg_scan *scan = &gmsh->numbers.scan;
    double version;
    int64_t binary, bytes, one;
    TRY(starg_scan_real(scan, "the version", &version));
    TRY(starg_scan_integer(scan, "the file type", &binary));
    TRY(starg_scan_integer(scan, "the data size", &bytes));
    gmsh->version4 = version >= 4.1 && version < 5;
    if (!gmsh->version4 && !(version >= 2 && version < 3))
        return starg_source_fail(
            source_of(gmsh), starg_at_line(scan->line),
            "Gmsh version %g is not supported; save the mesh in version 4.1 or 2.2", version);
    if ((binary != 0 && binary != 1) || (binary == 1 && bytes != 8 && bytes != 4))
        return starg_source_fail(source_of(gmsh), starg_at_line(scan->line),
                                 "file type %lld with numbers of %lld bytes is not read",
                                 (long long)binary, (long long)bytes);
    gmsh->size_type = bytes == 8 ? NUMBER_INT64 : NUMBER_INT32;
    if (binary == 0)
        return STARG_OK;
    gmsh->numbers.encoding = NUMBERS_LITTLE;
    begin_data(gmsh);
    TRY(integer(gmsh, NUMBER_INT32, "the number one", &one));
    if (one != 1)
        gmsh->numbers.encoding = NUMBERS_BIG;
    return STARG_OK;
}

static starg_status add_node(gmsh_reader *gmsh, int64_t tag, const double point[3]) {
    node n = {tag, gmsh->nodes.count};
    PUSH(source_of(gmsh)->context, STAGE, &gmsh->nodes, n);
    TRY(starg_builder_vertex(&gmsh->builder->points, point, numbers_place(&gmsh->numbers)));
    return tick(gmsh);
}

static starg_status read_point(gmsh_reader *gmsh, double point[3]) {
    for (int k = 0; k < 3; k++)
        TRY(numbers_real(&gmsh->numbers, NUMBER_FLOAT64, "a coordinate of a node", &point[k]));
    return STARG_OK;
}

static starg_status read_nodes2(gmsh_reader *gmsh) {
    int64_t count, tag;
    double point[3];
    TRY(starg_scan_integer(&gmsh->numbers.scan, "the number of nodes", &count));
    begin_data(gmsh);
    size_t bytes = numbers_least_bytes(&gmsh->numbers, NUMBER_INT32) +
                   3 * numbers_least_bytes(&gmsh->numbers, NUMBER_FLOAT64);
    TRY(numbers_check_count(&gmsh->numbers, count, bytes, "nodes"));
    for (int64_t i = 0; i < count; i++) {
        TRY(integer(gmsh, NUMBER_INT32, "the tag of a node", &tag));
        TRY(read_point(gmsh, point));
        TRY(add_node(gmsh, tag, point));
    }
    return STARG_OK;
}

/* Nodes of one entity: all tags, then all positions (with parameters if present). */
static starg_status read_node_block(gmsh_reader *gmsh) {
    int64_t dimension, entity, parametric, count;
    SCOPED int64_t *tags = NULL;
    TRY(integer(gmsh, NUMBER_INT32, "a dimension", &dimension));
    TRY(integer(gmsh, NUMBER_INT32, "the tag of an entity", &entity));
    TRY(integer(gmsh, NUMBER_INT32, "0 or 1", &parametric));
    TRY(size(gmsh, "the number of nodes in a block", &count));
    size_t bytes = numbers_least_bytes(&gmsh->numbers, gmsh->size_type) +
                   3 * numbers_least_bytes(&gmsh->numbers, NUMBER_FLOAT64);
    TRY(numbers_check_count(&gmsh->numbers, count, bytes, "nodes"));
    if (dimension < 0 || dimension > 3)
        return starg_source_fail(source_of(gmsh), numbers_place(&gmsh->numbers),
                                 "an entity has the dimension %lld", (long long)dimension);
    NEW(source_of(gmsh)->context, STAGE, tags, (size_t)count);
    for (int64_t i = 0; i < count; i++)
        TRY(size(gmsh, "the tag of a node", &tags[i]));
    for (int64_t i = 0; i < count; i++) {
        double point[3], ignored;
        TRY(read_point(gmsh, point));
        for (int64_t k = 0; parametric != 0 && k < dimension; k++)
            TRY(numbers_real(&gmsh->numbers, NUMBER_FLOAT64, "a parameter of a node", &ignored));
        TRY(add_node(gmsh, tags[i], point));
    }
    return STARG_OK;
}

/* Header of version 4 sections: blocks, items, least and greatest tag. */
static starg_status read_blocks(gmsh_reader *gmsh, starg_status (*read)(gmsh_reader *)) {
    int64_t header[4];
    begin_data(gmsh);
    for (int i = 0; i < 4; i++)
        TRY(size(gmsh, "a count", &header[i]));
    TRY(numbers_check_count(&gmsh->numbers, header[0], 8, "blocks"));
    TRY(numbers_check_count(&gmsh->numbers, header[1],
                            numbers_least_bytes(&gmsh->numbers, NUMBER_INT32), "items"));
    for (int64_t i = 0; i < header[0]; i++)
        TRY(read(gmsh));
    return STARG_OK;
}

/* ---- elements ---- */

/* Number of nodes of the first types; 0 if unknown. */
static int64_t type_nodes(int64_t type) {
    static const uint8_t nodes[] = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                    8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
    return type > 0 && type < (int64_t)sizeof nodes ? nodes[type] : 0;
}

static bool is_flat(int64_t type) {
    static const uint8_t flat[] = {1, 2, 3, 8, 9, 10, 15, 16, 20, 21, 22, 23, 24, 25, 26, 27, 28};
    for (size_t i = 0; i < sizeof flat; i++)
        if (flat[i] == type)
            return true;
    return false;
}

enum { TETRAHEDRON = 4 };

static starg_status check_type(gmsh_reader *gmsh, int64_t type) {
    char what[48];
    if (type == TETRAHEDRON || is_flat(type))
        return STARG_OK;
    snprintf(what, sizeof what, "an element of type %lld", (long long)type);
    return tet_builder_refuse(gmsh->builder, what, numbers_place(&gmsh->numbers));
}

static int compare_nodes(const void *left, const void *right) {
    const node *a = left, *b = right;
    return (a->tag > b->tag) - (a->tag < b->tag);
}

/* Tags are mostly 1, 2, 3, ...; otherwise binary search after sorting. */
static starg_status find_node(gmsh_reader *gmsh, int64_t tag, int64_t *index) {
    const node key = {tag, 0}, *found = NULL;
    if (tag >= 1 && (uint64_t)tag <= gmsh->nodes.count && gmsh->nodes.data[tag - 1].tag == tag)
        found = &gmsh->nodes.data[tag - 1];
    else if (gmsh->nodes.count > 0)
        found = bsearch(&key, gmsh->nodes.data, gmsh->nodes.count, sizeof key, compare_nodes);
    if (found == NULL)
        return starg_source_fail(source_of(gmsh), numbers_place(&gmsh->numbers),
                                 "an element refers to the missing node %lld", (long long)tag);
    *index = (int64_t)found->index;
    return STARG_OK;
}

/* Reads the nodes of an element, after its tag and other tags. */
static starg_status read_corners(gmsh_reader *gmsh, number_type number, int64_t type,
                                 int64_t region) {
    int64_t corner[4] = {0}, tag;
    starg_place place = numbers_place(&gmsh->numbers);
    for (int64_t k = 0; k < type_nodes(type); k++) {
        TRY(integer(gmsh, number, "the tag of a node", &tag));
        if (type == TETRAHEDRON)
            TRY(find_node(gmsh, tag, &corner[k]));
    }
    if (type == TETRAHEDRON)
        TRY(tet_builder_add(gmsh->builder, corner, region, place));
    return tick(gmsh);
}

/* Version 2: an element's tag, its other tags (the first is the physical group), its nodes. */
static starg_status read_element2(gmsh_reader *gmsh, int64_t type, int64_t tags) {
    int64_t region = 0, tag;
    for (int64_t k = 0; k < tags; k++) {
        TRY(integer(gmsh, NUMBER_INT32, "a tag of an element", &tag));
        if (k == 0)
            region = tag;
    }
    return read_corners(gmsh, NUMBER_INT32, type, region);
}

static starg_status read_elements2(gmsh_reader *gmsh) {
    bool text = gmsh->numbers.encoding == NUMBERS_TEXT;
    int64_t count, number, type, tags, block = 1;
    TRY(starg_scan_integer(&gmsh->numbers.scan, "the number of elements", &count));
    begin_data(gmsh);
    TRY(numbers_check_count(&gmsh->numbers, count,
                            2 * numbers_least_bytes(&gmsh->numbers, NUMBER_INT32), "elements"));
    for (int64_t i = 0; i < count; i += block) {
        if (text)
            TRY(integer(gmsh, NUMBER_INT32, "the tag of an element", &number));
        TRY(integer(gmsh, NUMBER_INT32, "the type of an element", &type));
        TRY(check_type(gmsh, type));
        if (!text)
            TRY(integer(gmsh, NUMBER_INT32, "the number of elements in a block", &block));
        TRY(integer(gmsh, NUMBER_INT32, "the number of tags", &tags));
        if (block < 1 || block > count - i || tags < 0)
            return starg_source_fail(source_of(gmsh), numbers_place(&gmsh->numbers),
                                     "a block announces %lld elements with %lld tags",
                                     (long long)block, (long long)tags);
        for (int64_t k = 0; k < block; k++) {
            if (!text)
                TRY(integer(gmsh, NUMBER_INT32, "the tag of an element", &number));
            TRY(read_element2(gmsh, type, tags));
        }
    }
    return STARG_OK;
}

static starg_status read_element_block(gmsh_reader *gmsh) {
    int64_t dimension, entity, type, count, tag;
    TRY(integer(gmsh, NUMBER_INT32, "a dimension", &dimension));
    TRY(integer(gmsh, NUMBER_INT32, "the tag of an entity", &entity));
    TRY(integer(gmsh, NUMBER_INT32, "the type of the elements", &type));
    TRY(check_type(gmsh, type));
    TRY(size(gmsh, "the number of elements in a block", &count));
    TRY(numbers_check_count(&gmsh->numbers, count,
                            2 * numbers_least_bytes(&gmsh->numbers, gmsh->size_type), "elements"));
    for (int64_t i = 0; i < count; i++) {
        TRY(size(gmsh, "the tag of an element", &tag));
        TRY(read_corners(gmsh, gmsh->size_type, type, entity));
    }
    return STARG_OK;
}

/* ---- the file ---- */

/* Skips lines up to the one that ends the section. */
static starg_status skip_section(gmsh_reader *gmsh, starg_word name) {
    starg_scan *scan = &gmsh->numbers.scan;
    starg_word word;
    while (starg_scan_next_line(scan)) {
        starg_scan ahead = *scan;
        if (starg_scan_word_here(&ahead, &word) && word.length > 4 &&
            memcmp(word.text, "$End", 4) == 0)
            return STARG_OK;
    }
    return starg_source_fail(source_of(gmsh), starg_at_line(name.line),
                             "the section %s has no end; the file seems to be truncated",
                             starg_word_excerpt(name).text);
}

static starg_status read_section(gmsh_reader *gmsh, starg_word name) {
    if (starg_word_is(name, "$Nodes")) {
        TRY(gmsh->version4 ? read_blocks(gmsh, read_node_block) : read_nodes2(gmsh));
    } else if (starg_word_is(name, "$Elements")) {
        if (gmsh->nodes.count > 0)
            qsort(gmsh->nodes.data, gmsh->nodes.count, sizeof *gmsh->nodes.data, compare_nodes);
        TRY(gmsh->version4 ? read_blocks(gmsh, read_element_block) : read_elements2(gmsh));
    } else if (name.text[0] == '$') {
        return skip_section(gmsh, name);
    } else {
        return starg_source_fail(source_of(gmsh), numbers_place(&gmsh->numbers),
                                 "found '%s' where a section should begin",
                                 starg_word_excerpt(name).text);
    }
    return STARG_OK;
}

starg_status tet_gmsh_read(tet_builder *builder) {
    starg_status status = STARG_OK;
    gmsh_reader gmsh = {.builder = builder,
                        .numbers = {.scan = starg_scan_make(builder->points.source)}};
    starg_word word;
    bool known = false;
    gmsh.numbers.scan.comments = false;
    while (starg_scan_word(&gmsh.numbers.scan, &word)) {
        if (word.length > 4 && memcmp(word.text, "$End", 4) == 0)
            continue;
        if (starg_word_is(word, "$NOD")) {
            status = starg_source_fail(
                builder->points.source, starg_at_line(word.line),
                "Gmsh version 1 is not supported; save the mesh in version 4.1 or 2.2");
            goto done;
        }
        if (starg_word_is(word, "$MeshFormat")) {
            STARG_TRY(read_format(&gmsh));
            known = true;
        } else if (known) {
            STARG_TRY(read_section(&gmsh, word));
        } else {
            STARG_TRY(skip_section(&gmsh, word));
        }
    }
done:
    STARG_ARRAY_FREE(builder->points.source->context, &gmsh.nodes);
    return status;
}
