/* Spectra of a solid's boundary, as a surface and as a shell of the solid's thickness.
 *
 * Problem: numbers of a shape that change neither with its pose, nor with the decomposition that
 * happens to come out, nor with noise on its surface.
 *
 * A piece is coned from its guard: each face of the solid's boundary spans a tetrahedron with it.
 * From a point in that cone, near the face, one looks both ways along the face's normal: the sum is
 * the width there, the local diameter of [GSC07]. Limbs keep their widths when they move.
 *
 * In a limb of width w, slow diffusion does not notice what is inside: it is that on a shell of the
 * boundary which holds w times the area and conducts w times as well. So the eigenvalues of
 * div(w grad u) = -lambda w u on the boundary stand for those of the solid, at the cost of a
 * surface: Shape-DNA [RWP06] with a thickness.
 *
 * Stages: boundary and widths; widths spread by diffusion over about a tenth of the shape's size
 * (each is one look; the shell wants the thickness of a region); spectra, and of the surface the
 * eigenfunctions too, for what waves.c makes of them.
 *
 * Invariants: lengths are in units of the solid's size meanwhile, so that nothing overflows.
 *
 * Cost: two rays a face, and two spectra (spectrum.c), which take most of the time. */
#include "shape/thickness.h"

#include <math.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec3.h"
#include "shape/spectrum.h"
#include "shape/waves.h"
#include "star/piece_faces.h"

static const char STAGE[] = "thickness";

enum { EIGENVALUES = STARG_DESCRIPTOR_EIGENVALUES };

/* Where one stands: so far from the face's centre to the guard. */
static const double STANDPOINT = 1.0 / 16;
/* Diffusion for the time 1 / RATE, the area being 1. */
static const double RATE = 100;
/* No part of the shell is thinner, by the mean. */
static const double THINNEST = 0.01;

/* ---- widths ---- */

typedef struct width {
    double length, area;
} width;

typedef struct looker {
    const starg_tetmesh *mesh;
    const ray_caster *caster;
    size_t *faces; /* of the boundary: 4 x tetrahedron + corner opposite */
    width *widths;
} looker;

static starg_status list_faces(starg_context *context, looker *l, size_t *count) {
    starg_status status = STARG_OK;
    size_t most = l->caster->sight.tree->triangle_count;
    STARG_NEW(context, STAGE, l->faces, most);
    *count = 0;
    for (size_t f = 0; f < 4 * l->mesh->count; f++)
        if (l->mesh->neighbours[f] == STARG_TETMESH_NONE)
            l->faces[(*count)++] = f;
done:
    return status;
}

/* Corners relative to the first one, and the apex, in units of the solid's size. */
static void face_shape(const looker *l, size_t face, double corner[3][3], double apex[3]) {
    uint32_t v[3];
    const double *all = l->mesh->vertices;
    piece_face_corners(l->mesh, face, v);
    const double *first = all + 3 * (size_t)v[0];
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++)
            corner[c][k] = (all[3 * (size_t)v[c] + (size_t)k] - first[k]) * l->caster->scale;
        apex[k] =
            (all[3 * (size_t)l->mesh->tetrahedra[face] + (size_t)k] - first[k]) * l->caster->scale;
    }
}

static starg_status look(starg_context *context, void *shared, void *scratch, size_t item) {
    const looker *l = shared;
    double corner[3][3], apex[3], normal[3], from[3], sum = 0;
    uint32_t v[3];
    (void)context, (void)scratch;
    face_shape(l, l->faces[item], corner, apex);
    piece_face_corners(l->mesh, l->faces[item], v);
    vec3_triangle_normal(corner[0], corner[1], corner[2], normal);
    double twice = vec3_length(normal);
    for (int k = 0; k < 3 && twice > 0; k++) {
        double centre = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
        from[k] = l->mesh->vertices[3 * (size_t)v[0] + (size_t)k] +
                  (centre + STANDPOINT * (apex[k] - centre)) / l->caster->scale;
        normal[k] /= twice;
    }
    for (int way = 0; way < 2 && twice > 0; way++) {
        sum += ray_length(l->caster, from, normal) / l->caster->length;
        for (int k = 0; k < 3; k++)
            normal[k] = -normal[k];
    }
    l->widths[item] = (width){.length = sum, .area = twice / 2};
    return STARG_OK;
}

/* ---- the shell ---- */

/* Mean width of the faces at each vertex, by area. */
static starg_status put_at_vertices(starg_context *context, const starg_mesh *boundary,
                                    const width *widths, double *at) {
    starg_status status = STARG_OK;
    size_t vertices = starg_mesh_vertex_count(boundary);
    const uint32_t *faces = starg_mesh_faces(boundary);
    double *areas = NULL;
    STARG_NEW_ZERO(context, STAGE, areas, vertices);
    for (size_t i = 0; i < 3 * starg_mesh_face_count(boundary); i++) {
        at[faces[i]] += widths[i / 3].area * widths[i / 3].length;
        areas[faces[i]] += widths[i / 3].area;
    }
    for (size_t v = 0; v < vertices; v++)
        at[v] = areas[v] > 0 ? at[v] / areas[v] : 0;
done:
    starg_release(context, areas);
    return status;
}

/* Replaces a field on the boundary by what an implicit step of diffusion makes of it. */
static starg_status diffuse(starg_context *context, const starg_mesh *boundary, double *at) {
    starg_status status = STARG_OK;
    laplacian l = {0};
    sparse_factors *f = NULL;
    double *x = NULL, *scratch = NULL, mean = 0;
    STARG_TRY(laplacian_create(context, boundary, at, &l));
    STARG_TRY(laplacian_factorise(context, &l, RATE, &f));
    STARG_NEW(context, STAGE, x, l.count);
    STARG_NEW(context, STAGE, scratch, l.count);
    for (size_t i = 0; i < l.count; i++) {
        x[i] = RATE * l.masses[i] * l.field[i];
        mean += l.masses[i] * l.field[i];
    }
    sparse_solve(f, x, scratch);
    for (size_t v = 0; v < starg_mesh_vertex_count(boundary); v++)
        at[v] = l.row_of[v] != LAPLACIAN_NO_ROW && x[l.row_of[v]] > THINNEST * mean
                    ? x[l.row_of[v]]
                    : THINNEST * fmax(mean, 1e-9);
done:
    laplacian_free(context, &l);
    sparse_free(f);
    starg_release(context, x);
    starg_release(context, scratch);
    return status;
}

/* All but the first one; what rounding put below 0 is 0. */
static void keep_behind_zero(double *eigenvalues, double *out) {
    for (size_t i = 0; i <= EIGENVALUES; i++)
        eigenvalues[i] = fmax(eigenvalues[i], 0);
    memcpy(out, eigenvalues + 1, EIGENVALUES * sizeof *out);
}

static starg_status take_solid(starg_context *context, const starg_mesh *boundary,
                               const double *thickness, double *out) {
    starg_status status = STARG_OK;
    laplacian l = {0};
    double eigenvalues[EIGENVALUES + 1];
    STARG_TRY(laplacian_create_shell(context, boundary, thickness, &l));
    STARG_TRY(spectrum_smallest(context, &l, EIGENVALUES + 1, eigenvalues, NULL));
    keep_behind_zero(eigenvalues, out);
done:
    laplacian_free(context, &l);
    return status;
}

static starg_status take_surface(starg_context *context, const starg_mesh *surface, double *out,
                                 double *waves) {
    starg_status status = STARG_OK;
    laplacian l = {0};
    double eigenvalues[EIGENVALUES + 1], *functions = NULL;
    STARG_TRY(laplacian_create(context, surface, NULL, &l));
    STARG_NEW(context, STAGE, functions, (EIGENVALUES + 1) * l.count);
    STARG_TRY(spectrum_smallest(context, &l, EIGENVALUES + 1, eigenvalues, functions));
    keep_behind_zero(eigenvalues, out);
    STARG_TRY(waves_measure(context, &l, eigenvalues, functions, waves));
done:
    starg_release(context, functions);
    laplacian_free(context, &l);
    return status;
}

starg_status thickness_spectra(starg_context *context, const starg_tetmesh *mesh,
                               const starg_mesh *surface, const ray_caster *caster,
                               starg_descriptor *out) {
    starg_status status = STARG_OK;
    looker l = {.mesh = mesh, .caster = caster};
    starg_mesh *boundary = NULL;
    double *at = NULL;
    size_t count = 0;
    STARG_TRY(list_faces(context, &l, &count));
    STARG_NEW(context, STAGE, l.widths, count);
    const starg_parallel_loop loop = {.stage = STAGE, .count = count, .shared = &l, .item = look};
    STARG_TRY(starg_parallel_for(context, &loop));
    STARG_TRY(starg_tetmesh_surface(context, mesh, &boundary, NULL)); /* faces in the same order */
    STARG_NEW_ZERO(context, STAGE, at, starg_mesh_vertex_count(boundary));
    STARG_TRY(put_at_vertices(context, boundary, l.widths, at));
    STARG_TRY(diffuse(context, boundary, at));
    STARG_TRY(take_surface(context, surface != NULL ? surface : boundary, out->surface_spectrum,
                           &out->waves[0][0]));
    STARG_TRY(take_solid(context, boundary, at, out->solid_spectrum));
done:
    starg_mesh_free(boundary);
    starg_release(context, l.faces);
    starg_release(context, l.widths);
    starg_release(context, at);
    return status;
}
