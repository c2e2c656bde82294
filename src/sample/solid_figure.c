/* Articulated figures as meshes: an isosurface of the rest pose, coarsened to the wanted number of
 * vertices, bent by skinning. All poses of one size share their connectivity, because the mesh is
 * made from the rest pose only.
 *
 * The isosurface starts finer than what is asked for, so that the coarsening can throw its thin
 * triangles away; its spacing is extrapolated from a first mesh, as the number of vertices grows
 * with the inverse square. Small meshes start from that first one: thin limbs need it to hold
 * together, and a collapse never breaks them. */
#include <math.h>

#include "sample/builder.h"
#include "sample/figure.h"
#include "sample/isosurface.h"
#include "sample/remesh.h"
#include "sample/skin.h"
#include "sample/solids.h"

static const char STAGE[] = "sample";

/* First spacing, over the diagonal of the figure's box. */
static const double FIRST_SPACING = 0.009;
/* Vertices of the isosurface for one of the result. */
static const double EXCESS = 2.2;

static double box_diagonal(const implicit_field *field) {
    double lower[3], upper[3];
    implicit_bounds(field, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

static starg_status extract(starg_context *context, const implicit_field *field, double spacing,
                            starg_mesh **out) {
    starg_status status = STARG_OK;
    mesh_builder builder = {.context = context};
    STARG_TRY(isosurface_extract(field, spacing, &builder));
    STARG_TRY(builder_finish(&builder, out));
done:
    builder_free(&builder);
    return status;
}

static starg_status rest_mesh(starg_context *context, const implicit_field *field,
                              size_t vertex_count, starg_mesh **out) {
    starg_status status = STARG_OK;
    starg_mesh *raw = NULL;
    double spacing = FIRST_SPACING * box_diagonal(field);
    STARG_TRY(extract(context, field, spacing, &raw));
    double wanted = EXCESS * (double)vertex_count;
    if ((double)raw->vertex_count < wanted) {
        spacing *= sqrt((double)raw->vertex_count / wanted);
        starg_mesh_free(raw);
        raw = NULL;
        STARG_TRY(extract(context, field, spacing, &raw));
    }
    STARG_TRY(remesh_isosurface(context, field, raw, vertex_count, out));
done:
    starg_mesh_free(raw);
    return status;
}

starg_status solid_figure(starg_context *context, figure_kind kind, int pose, size_t vertex_count,
                          starg_mesh **out) {
    starg_status status = STARG_OK;
    figure *f = NULL;
    starg_mesh *mesh = NULL;
    STARG_NEW(context, STAGE, f, 1);
    figure_build(kind, f);
    STARG_TRY(rest_mesh(context, &f->field, vertex_count, &mesh));
    STARG_TRY(skin_pose(context, f, pose, mesh->vertices, mesh->vertex_count));
    *out = mesh;
    mesh = NULL;
done:
    starg_mesh_free(mesh);
    starg_release(context, f);
    return status;
}
