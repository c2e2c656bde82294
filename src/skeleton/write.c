/* SPDX-License-Identifier: Apache-2.0 */
/* Skeleton files. OBJ: v and l, from 1. CG: a line of counts, then v and e, from 1. VTK: legacy
 * polydata, from 0, with the radius of every point. SWC: a line for each node, id, type, x, y, z,
 * radius and parent, from 1; it holds trees, so a skeleton with a loop is refused. */
#include <inttypes.h>

#include "mesh/formats/io.h"
#include "skeleton/skeleton.h"
#include "starguard/skeleton.h"

static const char STAGE[] = "skeleton file";

static starg_skeleton_format format_of(const char *path) {
    if (starg_has_extension(path, ".obj"))
        return STARG_SKELETON_OBJ;
    if (starg_has_extension(path, ".cg"))
        return STARG_SKELETON_CG;
    if (starg_has_extension(path, ".vtk"))
        return STARG_SKELETON_VTK;
    if (starg_has_extension(path, ".swc"))
        return STARG_SKELETON_SWC;
    return STARG_SKELETON_AUTO;
}

static void write_points(FILE *stream, const starg_skeleton *s, const char *word) {
    for (size_t v = 0; v < s->node_count; v++) {
        const double *p = s->positions + 3 * v;
        fprintf(stream, "%s%.17g %.17g %.17g\n", word, p[0], p[1], p[2]);
    }
}

static void write_edges(FILE *stream, const starg_skeleton *s, const char *word, uint32_t base) {
    for (size_t e = 0; e < s->edge_count; e++)
        fprintf(stream, "%s %" PRIu32 " %" PRIu32 "\n", word, s->edges[2 * e] + base,
                s->edges[2 * e + 1] + base);
}

static void write_vtk(FILE *stream, const starg_skeleton *s) {
    fprintf(stream,
            "# vtk DataFile Version 3.0\ncurve skeleton\nASCII\nDATASET POLYDATA\n"
            "POINTS %zu double\n",
            s->node_count);
    write_points(stream, s, "");
    /* a skeleton that is a point, or has lone points, shows them as vertices */
    fprintf(stream, "VERTICES 1 %zu\n%zu", s->node_count + 1, s->node_count);
    for (size_t v = 0; v < s->node_count; v++)
        fprintf(stream, " %zu", v);
    fprintf(stream, "\nLINES %zu %zu\n", s->edge_count, 3 * s->edge_count);
    write_edges(stream, s, "2", 0);
    if (s->radii == NULL) /* read from a file without radii */
        return;
    fprintf(stream, "POINT_DATA %zu\nSCALARS radius double 1\nLOOKUP_TABLE default\n",
            s->node_count);
    for (size_t v = 0; v < s->node_count; v++)
        fprintf(stream, "%.17g\n", s->radii[v]);
}

static const uint32_t NO_NODE = UINT32_MAX;

/* Lists the nodes of a forest, each after its parent and branch by branch; the root of a tree is
 * its first node. */
static starg_status order_trees(starg_context *context, const starg_skeleton *s, uint32_t *order,
                                uint32_t *parent) {
    SCOPED_BY(graph_free) curve_graph graph = {0};
    SCOPED uint32_t *stack = NULL;
    SCOPED bool *seen = NULL;
    size_t count = 0;
    NEW(context, STAGE, stack, s->node_count);
    NEW_ZERO(context, STAGE, seen, s->node_count);
    TRY(graph_create(context, s->node_count, (uint32_t(*)[2])s->edges, NULL, s->edge_count,
                     &graph));
    for (uint32_t root = 0; root < s->node_count; root++) {
        if (seen[root])
            continue;
        size_t waiting = 0;
        stack[waiting++] = root;
        seen[root] = true;
        parent[root] = NO_NODE;
        while (waiting > 0) {
            uint32_t v = stack[--waiting];
            order[count++] = v;
            for (uint32_t j = graph.first[v]; j < graph.first[v + 1]; j++) {
                uint32_t w = graph.next[j];
                if (seen[w])
                    continue;
                seen[w] = true;
                parent[w] = v;
                stack[waiting++] = w;
            }
        }
    }
    return STARG_OK;
}

/* The type is 0, undefined; a radius that is not known is 0. */
static starg_status write_swc(starg_context *context, FILE *stream, const starg_skeleton *s) {
    SCOPED uint32_t *order = NULL, *parent = NULL, *number = NULL;
    NEW(context, STAGE, order, s->node_count);
    NEW(context, STAGE, parent, s->node_count);
    NEW(context, STAGE, number, s->node_count);
    TRY(order_trees(context, s, order, parent));
    fprintf(stream, "# curve skeleton: id type x y z radius parent\n");
    for (size_t i = 0; i < s->node_count; i++) {
        uint32_t v = order[i];
        const double *p = s->positions + 3 * (size_t)v;
        number[v] = (uint32_t)i + 1;
        fprintf(stream, "%zu 0 %.17g %.17g %.17g %.17g ", i + 1, p[0], p[1], p[2],
                s->radii != NULL ? s->radii[v] : 0);
        if (parent[v] == NO_NODE)
            fprintf(stream, "-1\n");
        else
            fprintf(stream, "%" PRIu32 "\n", number[parent[v]]);
    }
    return STARG_OK;
}

static starg_status write_format(starg_context *context, FILE *stream, const starg_skeleton *s,
                                 starg_skeleton_format format) {
    if (format == STARG_SKELETON_SWC)
        return write_swc(context, stream, s);
    if (format == STARG_SKELETON_VTK) {
        write_vtk(stream, s);
        return STARG_OK;
    }
    if (format == STARG_SKELETON_CG)
        fprintf(stream, "# D:3 NV:%zu NE:%zu\n", s->node_count, s->edge_count);
    write_points(stream, s, "v ");
    write_edges(stream, s, format == STARG_SKELETON_CG ? "e" : "l", 1);
    return STARG_OK;
}

starg_status starg_skeleton_write(starg_context *context, const starg_skeleton *skeleton,
                                  const char *path, starg_skeleton_format format) {
    SCOPED_BY(starg_output_discard) starg_output output = {0};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    if (format == STARG_SKELETON_AUTO)
        format = format_of(path);
    if (format < STARG_SKELETON_OBJ || format > STARG_SKELETON_SWC)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "'%s' has no known format; use a name that ends in .obj, .cg, .vtk or "
                          ".swc",
                          path);
    if (format == STARG_SKELETON_SWC && skeleton->loops > 0)
        return starg_fail(
            context, STARG_ERROR_MESH, STAGE,
            "the skeleton has %zu %s, and SWC holds only trees; write it as .vtk, .cg "
            "or .obj",
            skeleton->loops, skeleton->loops == 1 ? "loop" : "loops");
    TRY(starg_c_locale_enter(context, &locale));
    TRY(starg_output_open(context, STAGE, path, &output));
    TRY(write_format(context, output.stream, skeleton, format));
    TRY(starg_check_cancel(context, STAGE));
    return starg_output_commit(&output);
}
