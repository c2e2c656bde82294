/* SPDX-License-Identifier: Apache-2.0 */
/* Skeleton files. OBJ: v and l, from 1. CG: a line of counts, then v and e, from 1. VTK: legacy
 * polydata, from 0, with the radius of every point. */
#include <inttypes.h>

#include "core/file.h"
#include "mesh/formats/io.h"
#include "starguard/skeleton.h"

static const char STAGE[] = "skeleton file";

static starg_skeleton_format format_of(const char *path) {
    if (starg_has_extension(path, ".obj"))
        return STARG_SKELETON_OBJ;
    if (starg_has_extension(path, ".cg"))
        return STARG_SKELETON_CG;
    if (starg_has_extension(path, ".vtk"))
        return STARG_SKELETON_VTK;
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

static void write_format(FILE *stream, const starg_skeleton *s, starg_skeleton_format format) {
    if (format == STARG_SKELETON_VTK) {
        write_vtk(stream, s);
        return;
    }
    if (format == STARG_SKELETON_CG)
        fprintf(stream, "# D:3 NV:%zu NE:%zu\n", s->node_count, s->edge_count);
    write_points(stream, s, "v ");
    write_edges(stream, s, format == STARG_SKELETON_CG ? "e" : "l", 1);
}

starg_status starg_skeleton_write(starg_context *context, const starg_skeleton *skeleton,
                                  const char *path, starg_skeleton_format format) {
    starg_status status = STARG_OK;
    starg_output output = {0};
    starg_c_locale locale = {0};
    if (format == STARG_SKELETON_AUTO)
        format = format_of(path);
    if (format < STARG_SKELETON_OBJ || format > STARG_SKELETON_VTK)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "'%s' has no known format; use a name that ends in .obj, .cg or .vtk",
                          path);
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_TRY(starg_output_open(context, STAGE, path, &output));
    write_format(output.stream, skeleton, format);
    STARG_TRY(starg_check_cancel(context, STAGE));
    STARG_TRY(starg_output_commit(&output));
done:
    starg_output_discard(&output);
    starg_c_locale_leave(&locale);
    return status;
}
