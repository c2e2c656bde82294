/* SPDX-License-Identifier: Apache-2.0 */
/* Common interface of the generators: choice, density and report. */
#include "tetra/generate.h"

#include <math.h>
#include <stdio.h>

static const char STAGE[] = TETRA_STAGE;

static const double LARGEST_VOLUME = 1.8; /* of TetGen's tetrahedra, relative to the mean volume */
static const double LATTICE_DENSITY = 12; /* lattice tetrahedra per cube */
static const double STEPS_PER_CUBE = 4;   /* for measuring distances */

const char *const tetra_generator_words[] = {"auto", "tetgen", "stuffing", NULL};

static const starg_field OPTIONS[] = {
    {.key = "density",
     .kind = STARG_FIELD_REAL,
     FIELD_MEMBER(starg_tetra_options, density),
     .high = 1e6,
     .standard = TETRA_PAPER_DENSITY,
     .value = "T",
     .help = "Tetrahedra per surface vertex; 0: as few as possible."},
    TETRA_FIELDS(starg_tetra_options, ),
};
static const starg_fields OPTIONS_TABLE = {
    .name = "tetrahedra options", .size = sizeof(starg_tetra_options), FIELD_ROWS(OPTIONS)};
OPTIONS_BY(OPTIONS_TABLE, starg_tetra_options)

/* Wanted number of tetrahedra; 0: as few as possible. */
static double wanted(const starg_mesh *mesh, const starg_tetra_options *o) {
    return o->target > 0 ? (double)o->target : o->density * (double)mesh->vertex_count;
}

static starg_status by_tetgen(starg_context *context, const starg_solid *solid,
                              const starg_tetra_options *o, starg_tetra_report *report,
                              starg_tetmesh **out) {
    double count = wanted(solid->mesh, o);
    double volume = count > 0 ? LARGEST_VOLUME * solid->check->volume / count : 0;
    *report = (starg_tetra_report){.generator = STARG_TETRA_TETGEN, .surface_kept = true};
    return tetra_by_tetgen(context, solid, volume, o, out);
}

static starg_status by_stuffing(starg_context *context, const tetra_shape *shape,
                                const starg_tetra_options *o, starg_tetra_report *report,
                                starg_tetmesh **out) {
    double count = wanted(shape->mesh, o);
    if (count == 0)
        count = TETRA_PAPER_DENSITY * (double)shape->mesh->vertex_count;
    *report = (starg_tetra_report){.generator = STARG_TETRA_STUFFING};
    report->spacing = cbrt(LATTICE_DENSITY * fabs(shape->volume) / count);
    TRY(tetra_by_stuffing(context, shape, &report->spacing, out));
    report->step = report->spacing / STEPS_PER_CUBE;
    TRY(tetra_measure(context, shape, *out, report->step, &report->to_surface,
                      &report->from_surface));
    report->distance = report->to_surface + report->step;
    report->distance_back = report->from_surface + report->step;
    return STARG_OK;
}

/* Inputs that crash the program. What it changes silently (coincident vertices) is found by
 * comparing the boundary. */
static const char *unfit_for_tetgen(const starg_solid *solid) {
    const starg_finding *found = solid->check->findings;
    if (found[STARG_FINDING_SELF_INTERSECTION].count > 0 ||
        found[STARG_FINDING_SELF_CONTACT].count > 0)
        return "the surface intersects itself";
    if (found[STARG_FINDING_DEGENERATE_FACE].count > 0)
        return "the surface has degenerate faces";
    return NULL;
}

static starg_status try_tetgen(starg_context *context, const starg_solid *solid,
                               const starg_tetra_options *o, starg_tetra_report *report,
                               starg_tetmesh **out) {
    const char *reason = unfit_for_tetgen(solid);
    if (reason != NULL)
        return starg_fail(context, STARG_ERROR_SOLVER, STAGE, "%s, which TetGen does not support",
                          reason);
    return by_tetgen(context, solid, o, report, out);
}

starg_status starg_tetmesh_from_solid(starg_context *context, const starg_solid *solid,
                                      const starg_tetra_options *options,
                                      starg_tetra_report *report, starg_tetmesh **out) {
    starg_status status = STARG_OK;
    starg_tetra_options defaults;
    starg_tetra_report ignored;
    starg_tetra_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    if (report == NULL)
        report = &ignored;
    *out = NULL;
    *report = (starg_tetra_report){.generator = options->generator};
    starg_progress_begin(context, STAGE);
    STARG_TRY(fields_check(context, STAGE, &OPTIONS_TABLE, options));
    if (options->generator == STARG_TETRA_TETGEN) {
        status = try_tetgen(context, solid, options, report, out);
        goto done;
    }
    if (options->generator == STARG_TETRA_AUTO)
        starg_log(context, STARG_LOG_WARNING,
                  "isosurface stuffing fills the solid; its surface only approximates the model's");
    const tetra_shape shape = {
        .mesh = solid->mesh, .tree = solid->tree, .volume = solid->check->volume};
    STARG_TRY(by_stuffing(context, &shape, options, report, out));
done:
    if (status != STARG_OK) {
        starg_tetmesh_free(*out);
        *out = NULL;
    }
    starg_progress_end(context);
    return status;
}

/* ---- open meshes ---- */

/* Signed volume, only an estimate if there are holes; bounded so that the spacing is. */
static double guess_volume(const starg_mesh *mesh) {
    double lower[3], upper[3], volume = starg_mesh_volume(mesh);
    starg_mesh_bounds(mesh, lower, upper);
    double box = (upper[0] - lower[0]) * (upper[1] - lower[1]) * (upper[2] - lower[2]);
    return copysign(fmin(box, fmax(fabs(volume), 0.01 * box)), volume);
}

starg_status starg_tetmesh_from_open_mesh(starg_context *context, const starg_mesh *mesh,
                                          const starg_tetra_options *options,
                                          starg_tetra_report *report, starg_tetmesh **out) {
    starg_status status = STARG_OK;
    starg_tetra_options defaults;
    starg_tetra_report ignored;
    starg_tetra_options_default(&defaults);
    bvh *tree = NULL;
    winding_field field = {0};
    bool hollow = false;
    *out = NULL;
    if (options == NULL)
        options = &defaults;
    if (report == NULL)
        report = &ignored;
    *report = (starg_tetra_report){.generator = STARG_TETRA_STUFFING};
    starg_progress_begin(context, STAGE);
    STARG_TRY(fields_check(context, STAGE, &OPTIONS_TABLE, options));
    STARG_TRY(mesh_check_extent(context, mesh, STAGE));
    tetra_shape shape = {.mesh = mesh, .field = &field, .volume = guess_volume(mesh)};
    STARG_TRY(tetra_is_hollow(context, mesh, &hollow));
    if (hollow || shape.volume == 0) {
        status = starg_fail(context, STARG_ERROR_MESH, STAGE,
                            "the surface encloses no volume: it has no faces, is planar, or its "
                            "faces cancel out; give a surface that encloses a volume");
        goto done;
    }
    STARG_TRY(bvh_create(context, mesh->vertices, mesh->faces, mesh->face_count, &tree));
    STARG_TRY(winding_create(context, tree, &field));
    shape.tree = tree;
    STARG_TRY(by_stuffing(context, &shape, options, report, out));
done:
    if (status != STARG_OK) {
        starg_tetmesh_free(*out);
        *out = NULL;
    }
    winding_free(&field);
    bvh_free(tree);
    starg_progress_end(context);
    return status;
}
