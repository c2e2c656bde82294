/* SPDX-License-Identifier: Apache-2.0 */
/* Figures and wares as meshes: an isosurface, coarsened to the wanted number of vertices. Figures
 * are then bent by skinning, and the resulting folds removed; all poses of one size share their
 * connectivity, because the mesh is made from the rest pose only.
 *
 * The isosurface starts finer than wanted, so that coarsening can remove its thin triangles; its
 * spacing is extrapolated from a first mesh, since the number of vertices grows with the inverse
 * square. Small meshes start from that first one: thin limbs need its resolution to stay connected,
 * and a collapse never breaks them. */
#include <math.h>

#include "sample/solids.h"

static const char STAGE[] = "sample";

/* First spacing, over the diagonal of the figure's box. */
static const double FIRST_SPACING = 0.009;
/* Isosurface vertices per vertex of the result. */
static const double EXCESS = 2.2;

enum { MAX_ATTEMPTS = 8 };

static double box_diagonal(const implicit_field *field) {
    double lower[3], upper[3];
    implicit_bounds(field, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

static starg_status extract(starg_context *context, const implicit_field *field, double spacing,
                            starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder builder = {.context = context};
    TRY(isosurface_extract(field, spacing, &builder));
    return builder_finish(&builder, out);
}

/* A web between two fingers becomes arbitrarily thin near its edge, so a lattice may see holes in
 * it: then a slightly finer one is tried. */
static starg_status extract_genus(starg_context *context, const implicit_field *field, int genus,
                                  double spacing, starg_mesh **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    for (int attempt = 0; attempt < MAX_ATTEMPTS; attempt++) {
        starg_mesh_free(mesh);
        mesh = NULL;
        TRY(extract(context, field, spacing, &mesh));
        if (2 * mesh->vertex_count + 4 * (size_t)genus == mesh->face_count + 4)
            break;
        spacing *= 0.95;
    }
    *out = mesh;
    mesh = NULL;
    return STARG_OK;
}

static starg_status mesh_field(starg_context *context, const implicit_field *field, int genus,
                               size_t vertex_count, starg_mesh **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *raw = NULL;
    double spacing = FIRST_SPACING * box_diagonal(field);
    TRY(extract_genus(context, field, genus, spacing, &raw));
    double wanted = EXCESS * (double)vertex_count;
    if ((double)raw->vertex_count < wanted) {
        spacing *= sqrt((double)raw->vertex_count / wanted);
        starg_mesh_free(raw);
        raw = NULL;
        TRY(extract_genus(context, field, genus, spacing, &raw));
    }
    return remesh_isosurface(context, field, raw, vertex_count, out);
}

/* A copy of `rest`, bent into a pose. */
static starg_status bend(starg_context *context, const figure *f, int pose, const starg_mesh *rest,
                         starg_mesh **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *posed = NULL;
    TRY(starg_mesh_create(context, rest->vertices, rest->vertex_count, rest->faces,
                          rest->face_count, &posed));
    TRY(skin_pose(context, f, pose, posed->vertices, posed->vertex_count));
    TRY(unfold_mesh(context, rest, posed));
    *out = posed;
    posed = NULL;
    return STARG_OK;
}

starg_status solid_figure(starg_context *context, figure_kind kind, int pose, size_t vertex_count,
                          starg_mesh **out) {
    SCOPED figure *f = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *rest = NULL;
    NEW(context, STAGE, f, 1);
    figure_build(kind, f);
    TRY(mesh_field(context, &f->field, 0, vertex_count, &rest));
    if (pose == 0) {
        *out = rest;
        rest = NULL;
    } else {
        TRY(bend(context, f, pose, rest, out));
    }
    return STARG_OK;
}

starg_status solid_ware(starg_context *context, ware_kind kind, int member, size_t vertex_count,
                        starg_mesh **out) {
    SCOPED ware *w = NULL;
    NEW(context, STAGE, w, 1);
    ware_build(kind, member, w);
    return mesh_field(context, &w->field, w->genus, vertex_count, out);
}
