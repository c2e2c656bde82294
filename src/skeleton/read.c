/* SPDX-License-Identifier: Apache-2.0 */
/* Skeleton files in the formats of write.c: OBJ (v and l, from 1), CG (v and e, from 1), VTK
 * (legacy polydata as text, from 0, with radii), and SWC (a line of seven numbers for each node).
 * Counts of the graph are recomputed; whether it lies in a solid is not checked. Cost: linear. */
#include <math.h>
#include <stdlib.h>

#include "mesh/formats/scan.h"
#include "starguard/skeleton.h"

static const char STAGE[] = "skeleton file";

/* A line of an SWC file; ids may have gaps, and parents may come later. */
typedef struct swc_node {
    int64_t id, parent;
    size_t line;
    uint32_t index;
} swc_node;

typedef struct reader {
    const starg_source *source;
    starg_scan scan;
    STARG_ARRAY(double) points;
    STARG_ARRAY(double) radii;
    STARG_ARRAY(uint32_t) edges;
    STARG_ARRAY(swc_node) nodes; /* of an SWC file */
} reader;

static starg_status reject(const reader *r, size_t line, const char *what) {
    return starg_source_fail(r->source, starg_at_line(line), "%s", what);
}

static starg_status read_point(reader *r) {
    for (int k = 0; k < 3; k++) {
        double x;
        TRY(starg_scan_real(&r->scan, "a coordinate of a node", &x));
        if (!(fabs(x) < 1e100))
            return reject(r, r->scan.line, "a coordinate is not finite and below 1e100");
        PUSH(r->source->context, STAGE, &r->points, x);
    }
    return STARG_OK;
}

/* Appends an end of an edge, counted from `base`. */
static starg_status push_end(reader *r, int64_t node, int64_t base) {
    if (node < base || (uint64_t)(node - base) >= UINT32_MAX)
        return reject(r, r->scan.line, "an edge has an impossible node");
    PUSH(r->source->context, STAGE, &r->edges, (uint32_t)(node - base));
    return STARG_OK;
}

/* ---- OBJ and CG ---- */

/* Reads the nodes of a polyline or an edge, and appends an edge per step. */
static starg_status read_line(reader *r) {
    starg_word word;
    int64_t before = 0, node;
    size_t count = 0;
    for (; starg_scan_word_here(&r->scan, &word); count++, before = node) {
        TRY(starg_word_integer(&r->scan, word, "a node of an edge", &node));
        if (count == 0)
            continue;
        TRY(push_end(r, before, 1));
        TRY(push_end(r, node, 1));
    }
    if (count < 2)
        return reject(r, r->scan.line, "an edge needs two nodes");
    return STARG_OK;
}

static starg_status read_lines(reader *r) {
    starg_word word;
    while (starg_scan_word(&r->scan, &word)) {
        if (starg_word_is(word, "v"))
            TRY(read_point(r));
        else if (starg_word_is(word, "l") || starg_word_is(word, "e"))
            TRY(read_line(r));
        else if (starg_word_is(word, "f"))
            return reject(r, word.line,
                          "faces belong to a surface; a skeleton has only nodes and edges");
        starg_scan_next_line(&r->scan);
    }
    return STARG_OK;
}

/* ---- VTK ---- */

static starg_status expect(reader *r, const char *keyword) {
    starg_word word;
    starg_status status = starg_scan_expect(&r->scan, keyword, &word);
    if (status == STARG_OK && !starg_word_is(word, keyword))
        return starg_source_fail(r->source, starg_at_line(word.line), "found '%s' instead of %s",
                                 starg_word_excerpt(word).text, keyword);
    return status;
}

/* Reads a count of items of at least two bytes each; the rest of the file must have room for
 * them. */
static starg_status read_count(reader *r, const char *what, int64_t *count) {
    starg_status status = starg_scan_integer(&r->scan, what, count);
    if (status == STARG_OK && (*count < 0 || (uint64_t)*count > r->source->size / 2))
        return reject(r, r->scan.line, "a count is larger than the file");
    return status;
}

static starg_status read_vtk_points(reader *r) {
    starg_word word;
    int64_t count;
    TRY(read_count(r, "the number of points", &count));
    TRY(starg_scan_expect(&r->scan, "a type of numbers", &word));
    while (count-- > 0)
        TRY(read_point(r));
    return STARG_OK;
}

/* LINES (edges) or VERTICES (ignored): each is a count and that many points. */
static starg_status read_vtk_cells(reader *r, bool edges) {
    int64_t cells, numbers, size, node, before = 0;
    TRY(read_count(r, "a number of cells", &cells));
    TRY(read_count(r, "a number of numbers", &numbers));
    while (cells-- > 0) {
        TRY(read_count(r, "the size of a cell", &size));
        for (int64_t i = 0; i < size; i++, before = node) {
            TRY(starg_scan_integer(&r->scan, "a point of a cell", &node));
            if (!edges || i == 0)
                continue;
            TRY(push_end(r, before, 0));
            TRY(push_end(r, node, 0));
        }
    }
    return STARG_OK;
}

static starg_status read_vtk_radii(reader *r) {
    starg_word word;
    TRY(expect(r, "radius"));
    starg_scan_next_line(&r->scan); /* the type */
    TRY(expect(r, "LOOKUP_TABLE"));
    TRY(starg_scan_expect(&r->scan, "a table's name", &word));
    for (size_t i = 0; i < r->points.count / 3; i++) {
        double radius;
        TRY(starg_scan_real(&r->scan, "a radius", &radius));
        if (!(radius >= 0 && radius < 1e101))
            return reject(r, r->scan.line, "a radius is negative or not finite");
        PUSH(r->source->context, STAGE, &r->radii, radius);
    }
    return STARG_OK;
}

static starg_status read_vtk(reader *r) {
    starg_word word;
    int64_t count;
    starg_scan_next_line(&r->scan); /* the magic */
    starg_scan_next_line(&r->scan); /* the title */
    TRY(expect(r, "ASCII"));
    TRY(expect(r, "DATASET"));
    TRY(expect(r, "POLYDATA"));
    while (starg_scan_word(&r->scan, &word)) {
        if (starg_word_is(word, "POINTS"))
            TRY(read_vtk_points(r));
        else if (starg_word_is(word, "LINES") || starg_word_is(word, "VERTICES"))
            TRY(read_vtk_cells(r, starg_word_is(word, "LINES")));
        else if (starg_word_is(word, "POINT_DATA"))
            TRY(read_count(r, "the number of points", &count));
        else if (starg_word_is(word, "SCALARS") && r->radii.count == 0)
            TRY(read_vtk_radii(r));
        else
            return starg_source_fail(r->source, starg_at_line(word.line),
                                     "'%s' is not part of a skeleton",
                                     starg_word_excerpt(word).text);
    }
    return STARG_OK;
}

/* ---- SWC ---- */

static int compare_ids(const void *left, const void *right) {
    const swc_node *a = left, *b = right;
    return (a->id > b->id) - (a->id < b->id);
}

static starg_status read_swc_line(reader *r) {
    swc_node node = {.index = (uint32_t)(r->points.count / 3)};
    int64_t type;
    double radius;
    TRY(starg_scan_integer(&r->scan, "the id of a node", &node.id));
    node.line = r->scan.line;
    TRY(starg_scan_integer(&r->scan, "the type of a node", &type));
    TRY(read_point(r));
    TRY(starg_scan_real(&r->scan, "a radius", &radius));
    if (!(radius >= 0 && radius < 1e101))
        return reject(r, r->scan.line, "a radius is negative or not finite");
    PUSH(r->source->context, STAGE, &r->radii, radius);
    TRY(starg_scan_integer(&r->scan, "the parent of a node", &node.parent));
    PUSH(r->source->context, STAGE, &r->nodes, node);
    starg_scan_next_line(&r->scan);
    return STARG_OK;
}

/* Finds parents by their ids. */
static starg_status join_parents(reader *r) {
    swc_node *nodes = r->nodes.data;
    size_t count = r->nodes.count;
    qsort(nodes, count, sizeof *nodes, compare_ids);
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && nodes[i].id == nodes[i - 1].id)
            return reject(r, nodes[i].line, "two nodes have one id");
        if (nodes[i].parent < 0)
            continue;
        const swc_node wanted = {.id = nodes[i].parent};
        const swc_node *parent = bsearch(&wanted, nodes, count, sizeof *nodes, compare_ids);
        if (parent == NULL || parent == &nodes[i])
            return reject(r, nodes[i].line, "the parent of a node is missing");
        PUSH(r->source->context, STAGE, &r->edges, parent->index);
        PUSH(r->source->context, STAGE, &r->edges, nodes[i].index);
    }
    return STARG_OK;
}

static starg_status read_swc(reader *r) {
    starg_scan ahead;
    starg_word word;
    r->scan.comments = true;
    while (ahead = r->scan, starg_scan_word(&ahead, &word))
        TRY(read_swc_line(r));
    return join_parents(r);
}

/* The first word is a number. */
static bool is_swc(const starg_source *source) {
    starg_scan scan = starg_scan_make(source);
    starg_word word;
    scan.comments = true;
    return starg_scan_word(&scan, &word) && word.text[0] >= '0' && word.text[0] <= '9';
}

/* ---- the graph ---- */

static uint32_t root_of(uint32_t *parents, uint32_t v) {
    while (parents[v] != v)
        v = parents[v] = parents[parents[v]];
    return v;
}

/* Counts components, loops, joints and ends. */
static starg_status count_graph(starg_context *context, starg_skeleton *s) {
    SCOPED uint32_t *parents = NULL, *degrees = NULL;
    NEW(context, STAGE, parents, s->node_count);
    NEW_ZERO(context, STAGE, degrees, s->node_count);
    for (size_t v = 0; v < s->node_count; v++)
        parents[v] = (uint32_t)v;
    s->components = s->node_count;
    for (size_t e = 0; e < s->edge_count; e++) {
        uint32_t a = root_of(parents, s->edges[2 * e]), b = root_of(parents, s->edges[2 * e + 1]);
        s->components -= a != b;
        parents[a] = b;
        degrees[s->edges[2 * e]]++;
        degrees[s->edges[2 * e + 1]]++;
    }
    s->loops = s->edge_count + s->components - s->node_count;
    for (size_t v = 0; v < s->node_count; v++) {
        s->joints += degrees[v] > 2;
        s->ends += degrees[v] == 1;
    }
    return STARG_OK;
}

/* Moves the arrays into the skeleton. */
static starg_status finish(reader *r, starg_skeleton *s) {
    s->node_count = r->points.count / 3;
    s->edge_count = r->edges.count / 2;
    if (s->node_count == 0)
        return starg_source_fail(r->source, starg_at_file(), "the file has no nodes");
    for (size_t i = 0; i < r->edges.count; i++)
        if (r->edges.data[i] >= s->node_count)
            return starg_source_fail(r->source, starg_at_file(),
                                     "edge %zu refers to a missing node", i / 2);
    s->positions = r->points.data;
    s->edges = r->edges.data;
    s->radii = r->radii.data;
    r->points.data = NULL;
    r->edges.data = NULL;
    r->radii.data = NULL;
    return count_graph(r->source->context, s);
}

static bool is_vtk(const starg_source *source) {
    return source->size >= 5 && memcmp(source->bytes, "# vtk", 5) == 0;
}

starg_status starg_skeleton_read_memory(starg_context *context, const void *bytes, size_t size,
                                        const char *name, starg_skeleton **out) {
    starg_status status = STARG_OK;
    const starg_source source = {context, name, bytes, size};
    reader r = {.source = &source, .scan = starg_scan_make(&source)};
    starg_skeleton *skeleton = NULL;
    starg_c_locale locale = {0};
    *out = NULL;
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_NEW_ZERO(context, STAGE, skeleton, 1);
    STARG_TRY(is_vtk(&source) ? read_vtk(&r) : is_swc(&source) ? read_swc(&r) : read_lines(&r));
    STARG_TRY(finish(&r, skeleton));
    *out = skeleton;
done:
    starg_c_locale_leave(&locale);
    RELEASE(r.points.data, r.radii.data, r.edges.data, r.nodes.data);
    if (status != STARG_OK)
        starg_skeleton_free(context, skeleton);
    return status;
}

starg_status starg_skeleton_read(starg_context *context, const char *path, starg_skeleton **out) {
    SCOPED char *bytes = NULL;
    size_t size;
    *out = NULL;
    TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    return starg_skeleton_read_memory(context, bytes, size, path, out);
}
