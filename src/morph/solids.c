/* SPDX-License-Identifier: Apache-2.0 */
/* Consistent decomposition of solids [YL11, section 5.2]: both ends of a morph cut into the same
 * pieces, each star-shaped in both.
 *
 * Stages: check that both ends bound a solid without self-intersections; fill A with tetrahedra
 * that keep its surface; deform these to B along the morph (deform.c); find sets of tetrahedra that
 * are star-shaped in both places (star/compatible/compatible.c).
 *
 * Invariant: the tetrahedra are positive in A and in B, exactly, and their boundary is the
 * respective surface, so they fill both without overlap. Cost: that of its stages. */
#include "geometry/vec3.h"
#include "mesh/solid.h"
#include "morph/morph.h"
#include "morph/solid_map.h"
#include "star/compatible/compatible.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "consistent pieces";

/* ---- ends ---- */

static starg_status fail_end(starg_context *context, const char *what, const starg_solid *solid) {
    const starg_finding *found = solid->check->findings;
    return starg_fail(
        context, STARG_ERROR_MESH, STAGE,
        "%s meets itself (%zu pairs of its faces pass through one another, %zu touch, "
        "%zu faces have no area), so that it cannot be filled with tetrahedra; "
        "'starguard repair' may help, and the surface can be cut without (--guards)",
        what, found[STARG_FINDING_SELF_INTERSECTION].count, found[STARG_FINDING_SELF_CONTACT].count,
        found[STARG_FINDING_DEGENERATE_FACE].count);
}

static bool meets_itself(const starg_solid *solid) {
    const starg_finding *found = solid->check->findings;
    return found[STARG_FINDING_SELF_INTERSECTION].count + found[STARG_FINDING_SELF_CONTACT].count +
               found[STARG_FINDING_DEGENERATE_FACE].count >
           0;
}

static starg_status check_end(const starg_morph *m, int end, const starg_solid *solid) {
    return meets_itself(solid)
               ? fail_end(m->context, end == 0 ? "A" : "B in A's connectivity", solid)
               : STARG_OK;
}

starg_status solids_check_crossings(starg_context *context, const starg_mesh *mesh,
                                    const char *what) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    TRY(solid_make(context, mesh, &solid));
    return solid->check->findings[STARG_FINDING_SELF_INTERSECTION].count > 0
               ? fail_end(context, what, solid)
               : STARG_OK;
}

static starg_status make_end(const starg_morph *m, int end, starg_solid **out) {
    TRY(morph_solid(m, end, out));
    return check_end(m, end, *out);
}

starg_status solids_check_last(const starg_morph *m) {
    starg_solid *solid = NULL;
    starg_status status = make_end(m, 1, &solid);
    starg_solid_free(solid);
    return status;
}

starg_status solids_last_meets_itself(const starg_morph *m, bool *out) {
    starg_solid *solid = NULL;
    starg_status status = morph_solid(m, 1, &solid);
    if (status == STARG_OK)
        *out = meets_itself(solid);
    starg_solid_free(solid);
    return status;
}

/* ---- tetrahedra ---- */

starg_status solids_list_surface(const starg_mesh *a, deform_mesh *c, uint32_t **out) {
    SCOPED uint8_t *used = NULL;
    NEW_ZERO(c->context, STAGE, used, a->vertex_count);
    NEW(c->context, STAGE, *out, a->vertex_count);
    for (size_t i = 0; i < 3 * a->face_count; i++)
        used[a->faces[i]] = 1;
    for (uint32_t v = 0; v < a->vertex_count; v++)
        if (used[v])
            (*out)[c->fixed++] = v;
    c->surface = *out;
    return STARG_OK;
}

static starg_status fill(const starg_morph *m, const starg_solid *solid, double density,
                         deform_mesh *c) {
    starg_tetra_options options;
    SCOPED_BY(starg_tetmesh_drop) starg_tetmesh *mesh = NULL;
    starg_tetra_options_default(&options);
    options.generator = STARG_TETRA_TETGEN;
    options.density = density;
    TRY(starg_tetmesh_from_solid(m->context, solid, &options, NULL, &mesh));
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        PUSH(m->context, STAGE, &c->rest, mesh->vertices[i]);
        PUSH(m->context, STAGE, &c->now, mesh->vertices[i]);
    }
    for (size_t i = 0; i < 4 * mesh->count; i++)
        PUSH(m->context, STAGE, &c->tetrahedra, mesh->tetrahedra[i]);
    return STARG_OK;
}

static starg_status fill_freely(const starg_morph *m, const starg_solid *solid, double density,
                                deform_mesh *c, uint32_t **surface) {
    TRY(solids_list_surface(m->mesh, c, surface));
    TRY(fill(m, solid, density, c));
    return deform_free_surface(m, c);
}

starg_status solids_fill_first(const starg_morph *m, double density, deform_mesh *c,
                               starg_solid **solid, uint32_t **surface) {
    TRY(make_end(m, 0, solid));
    return fill_freely(m, *solid, density, c, surface);
}

starg_status solids_fill(const starg_morph *m, double density, deform_mesh *c, starg_solid **solid,
                         uint32_t **surface) {
    TRY(make_end(m, 0, solid));
    TRY(solids_check_last(m));
    return fill_freely(m, *solid, density, c, surface);
}

static starg_status deform_along(const starg_morph *m, deform_mesh *c) {
    size_t inverted;
    double reached;
    starg_status status = deform(m, c, NULL, &inverted, &reached);
    if (status == STARG_OK && reached < 1)
        status = starg_fail(m->context, STARG_ERROR_MESH, STAGE,
                            "%zu of %zu tetrahedra turn over near t = %.3g and cannot be mended: "
                            "the solids are too different for pieces that correspond; poses that "
                            "are nearer to one another, or another --method, may do",
                            inverted, c->tetrahedra.count / 4, reached);
    return status;
}

starg_status solids_place(const deform_mesh *c, const double *places, starg_tetmesh **out) {
    SCOPED double *vertices = NULL;
    SCOPED uint32_t *tetrahedra = NULL;
    NEW(c->context, STAGE, vertices, c->rest.count);
    NEW(c->context, STAGE, tetrahedra, c->tetrahedra.count);
    memcpy(vertices, places, c->rest.count * sizeof *vertices);
    memcpy(tetrahedra, c->tetrahedra.data, c->tetrahedra.count * sizeof *tetrahedra);
    TRY(tetmesh_adopt(c->context, vertices, c->rest.count / 3, tetrahedra, c->tetrahedra.count / 4,
                      NULL, true, out));
    vertices = NULL;
    tetrahedra = NULL;
    return STARG_OK;
}

/* ---- pieces ---- */

static starg_status cut(const starg_morph *m, const deform_mesh *c, starg_decomposition *out[2]) {
    SCOPED_BY(starg_tetmesh_drop) starg_tetmesh *first = NULL, *last = NULL;
    TRY(solids_place(c, c->rest.data, &first));
    TRY(solids_place(c, c->now.data, &last));
    TRY(compatible_decompose(m->context, first, last, true, out));
    for (int end = 0; end < 2; end++) {
        out[end]->model_vertices = m->mesh->vertex_count;
        out[end]->model_faces = m->mesh->face_count;
        out[end]->model_tetrahedra = 0;
        out[end]->tetra.generator = STARG_TETRA_TETGEN;
    }
    return STARG_OK;
}

starg_status starg_morph_solids(const starg_morph *m, starg_decomposition *out[2]) {
    SCOPED_BY(deform_free) deform_mesh c = {.context = m->context};
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED uint32_t *surface = NULL;
    out[0] = out[1] = NULL;
    TIME_RULE(m->context, STARG_TIME_FAILS);
    TRY(solids_fill(m, SOLIDS_DENSITY, &c, &solid, &surface));
    TRY(deform_along(m, &c));
    return cut(m, &c, out);
}
