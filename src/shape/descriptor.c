/* SPDX-License-Identifier: Apache-2.0 */
/* Descriptor of a shape [YL11, section 5.1]: what its guards see, and how they are connected.
 *
 * Stages: the model at two standard levels of detail (level.c); a strict star decomposition of the
 * coarser one within a trial budget; its guards with the volumes of their pieces; an edge between
 * pieces in contact, with the centroid of their common faces; from each guard the distance to the
 * boundary in directions that cover the sphere evenly; the spectrum of the finer level
 * and its wave kernel signature (wks.c), which do not depend on the positions of
 * guards.
 *
 * The paper's graph follows the curve skeleton that contains its guards. Here guards lie anywhere
 * in the kernels of their pieces and edges are contacts of pieces, so the graph has a component per
 * component of the solid, whatever the skeleton.
 *
 * Invariants: rays (rays.c) are cast against the boundary of the tetrahedra, which is closed and
 * has each guard strictly inside.
 *
 * Cost: that of the decomposition and of the spectra, and O(log n) per ray. */

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "shape/measures.h"
#include "shape/spectrum.h"

static const char STAGE[] = "descriptor";

/* Spectrum of a solid's boundary, and where it vibrates.
 *
 * Problem: numbers that do not change with a shape's pose, its decomposition or noise on its
 * surface: Shape-DNA [RWP06].
 *
 * Stages: the boundary; the smallest eigenvalues of its Laplacian and their eigenfunctions
 * (spectrum.c); the wave kernel signature of both (wks.c).
 *
 * Invariants: eigenvalues are multiplied by the area, hence independent of scale. Cost: that of
 * spectrum.c. */

static const char STAGE_VIBRATIONS[] = "vibrations";

enum { EIGENVALUES = STARG_DESCRIPTOR_EIGENVALUES };

/* All but the first eigenvalue, clamped to at least 0. */
static void keep_behind_zero(double *eigenvalues, double *out) {
    for (size_t i = 0; i <= EIGENVALUES; i++)
        eigenvalues[i] = fmax(eigenvalues[i], 0);
    memcpy(out, eigenvalues + 1, EIGENVALUES * sizeof *out);
}

static starg_status take_surface(starg_context *context, const starg_mesh *surface, double *out,
                                 double *wks) {
    SCOPED_BY(laplacian_free) laplacian l = {0};
    double eigenvalues[EIGENVALUES + 1];
    SCOPED double *functions = NULL;
    TRY(laplacian_create(context, surface, &l));
    NEW(context, STAGE_VIBRATIONS, functions, (EIGENVALUES + 1) * l.count);
    TRY(spectrum_smallest(context, &l, EIGENVALUES + 1, eigenvalues, functions));
    keep_behind_zero(eigenvalues, out);
    return wks_measure(context, &l, eigenvalues, functions, wks);
}

/* The smallest nonzero eigenvalues of the surface's Laplacian, ascending, times the area; and where
 * the surface vibrates (spectrum.h). Fills these fields of the descriptor. `surface` is the
 * boundary before pieces cut it; NULL: that of `mesh`. Errors: MESH (no area), SOLVER, MEMORY,
 * CANCELLED. */
static starg_status vibrations_measure(starg_context *context, const starg_tetmesh *mesh,
                                       const starg_mesh *surface, starg_descriptor *out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *boundary = NULL;
    if (surface == NULL)
        TRY(starg_tetmesh_surface(context, mesh, &boundary, NULL));
    return take_surface(context, surface != NULL ? surface : boundary, out->surface_spectrum,
                        &out->wave_kernel[0][0]);
}

enum {
    LEAST_DIRECTIONS = 12,
    MOST_DIRECTIONS = 65536,
    LEAST_DETAIL = 100,
    FINER = 3 /* vertices of the surface for each of the pieces */
};

static const starg_field OPTIONS[] = {
    {.key = "directions",
     .option = "directions",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_descriptor_options, direction_count),
     .least = LEAST_DIRECTIONS,
     .most = MOST_DIRECTIONS,
     .initial = STARG_DESCRIPTOR_DIRECTIONS,
     .value = "N",
     .help = "Number of ray directions per guard, evenly distributed."},
    {.key = "effort",
     .option = "effort",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_descriptor_options, effort),
     .least = 1,
     .most = INT64_MAX,
     .initial = STARG_DESCRIPTOR_EFFORT,
     .value = "N",
     .help = "Trials of the star decomposition; more trials give fewer guards."},
    {.key = "detail",
     .option = "detail",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_descriptor_options, detail),
     .most = STARG_MESH_LIMIT / 8,
     .initial = STARG_DESCRIPTOR_DETAIL,
     .value = "N",
     .help = "Simplify the model to N vertices for its spectrum and to a third for its pieces, to "
             "reduce the influence of noise and resolution; 0 keeps the model."},
};
static const starg_fields OPTIONS_TABLE = {
    .name = "descriptor options", .size = sizeof(starg_descriptor_options), FIELD_ROWS(OPTIONS)};
OPTIONS_BY(OPTIONS_TABLE, starg_descriptor_options)

/* Equal steps in height give equal areas; the golden angle separates neighbours. */
void starg_descriptor_direction(size_t count, size_t index, double out[3]) {
    const double golden_angle = 2.39996322972865332;
    double z = 1 - (2 * (double)index + 1) / (double)count, radius = sqrt(fmax(0, 1 - z * z));
    double longitude = golden_angle * (double)index;
    out[0] = radius * cos(longitude);
    out[1] = radius * sin(longitude);
    out[2] = z;
}

/* ---- guards ---- */

/* A mesh that does not bound a solid is filled where its winding number exceeds 1/2; *closed is
 * then false. */
static starg_status decompose_mesh(starg_context *context, const starg_mesh *mesh,
                                   const starg_descriptor_options *options,
                                   starg_decomposition **out, bool *closed) {
    starg_decompose_options wanted;
    starg_solid *solid = NULL;
    starg_decompose_options_default(&wanted);
    wanted.effort = options->effort;
    wanted.fill = true;
    starg_status status = solid_make(context, mesh, &solid);
    *closed = status == STARG_OK;
    if (status == STARG_ERROR_MESH)
        return starg_decompose_open_mesh(context, mesh, &wanted, out);
    if (status == STARG_OK)
        status = starg_decompose(context, solid, &wanted, out);
    starg_solid_free(solid);
    return status;
}

/* The described object. */
typedef struct subject {
    starg_mesh *level, *coarse; /* NULL: there is none */
    starg_decomposition *pieces;
    const starg_mesh *surface; /* before it was cut; NULL if holes were filled */
} subject;

static void subject_free(subject *s) {
    starg_mesh_free(s->level);
    starg_mesh_free(s->coarse);
    starg_decomposition_free(NULL, s->pieces);
}

/* The spectrum needs more vertices than the pieces, whose views come from inside. If nothing is
 * left of the model at a level of detail, the next finer one is used, at last the model. */
static starg_status decompose(starg_context *context, const starg_mesh *mesh,
                              const starg_descriptor_options *options, subject *out) {
    starg_status status = STARG_OK;
    bool closed = false, found = false;
    if (options->detail > 0)
        TRY(level_create(context, mesh, options->detail, &out->level));
    if (out->level != NULL)
        TRY(level_coarsen(context, out->level, options->detail / FINER, &out->coarse));
    const starg_mesh *const levels[] = {out->coarse, out->level, mesh};
    for (size_t i = 0; i < 3 && !found; i++) {
        if (levels[i] == NULL)
            continue;
        out->surface = i == 0 ? out->level : levels[i];
        status = decompose_mesh(context, levels[i], options, &out->pieces, &closed);
        found = status != STARG_ERROR_MESH && status != STARG_ERROR_SOLVER;
    }
    if (!closed)
        out->surface = NULL;
    if (!closed && status == STARG_OK)
        starg_log(context, STARG_LOG_WARNING,
                  "the surface bounds no solid; isosurface stuffing closes its holes, and the "
                  "filled solid is described");
    return status;
}

static starg_status add_guards(starg_context *context, const starg_decomposition *pieces,
                               starg_descriptor *d) {
    NEW_ZERO(context, STAGE, d->guards, pieces->piece_count);
    d->guard_count = pieces->piece_count;
    for (size_t i = 0; i < d->guard_count; i++) {
        vec3_copy(pieces->pieces[i].guard, d->guards[i].position);
        d->guards[i].volume = pieces->pieces[i].volume;
    }
    return STARG_OK;
}

/* ---- edges ---- */

static starg_descriptor_edge *find_edge(const starg_descriptor *d, uint32_t first,
                                        uint32_t second) {
    size_t low = 0, high = d->edge_count - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        const starg_descriptor_edge *e = &d->edges[middle];
        if (e->first < first || (e->first == first && e->second < second))
            low = middle + 1;
        else
            high = middle;
    }
    return &d->edges[low];
}

/* Adds a face to the sums of its edge: area times centroid in `gate`, both relative to the
 * extent. */
static void add_face(const starg_tetmesh *mesh, size_t face, double scale, double *area,
                     starg_descriptor_edge *edge) {
    uint32_t corners[3];
    double p[3][3];
    piece_face_corners(mesh, face, corners);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            p[c][k] =
                (mesh->vertices[3 * (size_t)corners[c] + (size_t)k] - mesh->vertices[k]) * scale;
    double part = vec3_triangle_area(p[0], p[1], p[2]);
    *area += part;
    for (int k = 0; k < 3; k++)
        edge->gate[k] += part * (p[0][k] + p[1][k] + p[2][k]) / 3;
}

static starg_status add_edges(starg_context *context, const starg_decomposition *pieces,
                              starg_descriptor *d) {
    const starg_tetmesh *mesh = pieces->mesh;
    SCOPED double *areas = NULL;
    double scale = ldexp(1, -tetmesh_exponent(mesh));
    NEW_ZERO(context, STAGE, d->edges, pieces->contact_count);
    NEW_ZERO(context, STAGE, areas, pieces->contact_count);
    d->edge_count = pieces->contact_count;
    for (size_t i = 0; i < d->edge_count; i++)
        d->edges[i] = (starg_descriptor_edge){.first = pieces->contacts[i].first,
                                              .second = pieces->contacts[i].second,
                                              .area = pieces->contacts[i].area};
    for (size_t f = 0; f < 4 * mesh->count; f++) {
        uint32_t other = mesh->neighbours[f];
        if (other == STARG_TETMESH_NONE || pieces->labels[f / 4] >= pieces->labels[other])
            continue;
        starg_descriptor_edge *edge =
            find_edge(d, (uint32_t)pieces->labels[f / 4], (uint32_t)pieces->labels[other]);
        add_face(mesh, f, scale, &areas[edge - d->edges], edge);
    }
    for (size_t i = 0; i < d->edge_count; i++)
        for (int k = 0; k < 3; k++)
            d->edges[i].gate[k] = /* the area of a tiny contact may vanish: use its first guard */
                areas[i] > 0 ? mesh->vertices[k] + d->edges[i].gate[k] / areas[i] / scale
                             : d->guards[d->edges[i].first].position[k];
    return STARG_OK;
}

/* ---- rays ---- */

typedef struct viewer {
    const ray_caster *caster;
    starg_descriptor *result;
} viewer;

static starg_status cast_from_guard(starg_context *context, void *shared, void *scratch,
                                    size_t guard) {
    const viewer *v = shared;
    starg_descriptor *d = v->result;
    (void)context, (void)scratch;
    for (size_t i = 0; i < d->direction_count; i++) {
        double direction[3];
        starg_descriptor_direction(d->direction_count, i, direction);
        d->distances[guard * d->direction_count + i] =
            ray_length(v->caster, d->guards[guard].position, direction);
    }
    return STARG_OK;
}

static starg_status add_distances(starg_context *context, const ray_caster *caster,
                                  starg_descriptor *d) {
    viewer v = {.caster = caster, .result = d};
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = d->guard_count, .shared = &v, .item = cast_from_guard};
    NEW_ZERO(context, STAGE, d->distances, d->guard_count * d->direction_count);
    return starg_parallel_for(context, &loop);
}

/* ---- public function ---- */

static starg_status check_options(starg_context *context, const starg_descriptor_options *o) {
    if (o->detail != 0 && o->detail < LEAST_DETAIL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "detail is %zu vertices; it must be %d or more, or 0 to keep the model",
                          o->detail, LEAST_DETAIL);
    return fields_check(context, STAGE, &OPTIONS_TABLE, o);
}

static void add_head(const starg_mesh *mesh, const starg_descriptor_options *options,
                     const starg_decomposition *pieces, starg_descriptor *d) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    d->model_vertices = starg_mesh_vertex_count(mesh);
    d->model_faces = starg_mesh_face_count(mesh);
    d->diagonal = vec3_distance(lower, upper);
    d->detail = options->detail;
    d->effort = options->effort;
    d->time_limited = pieces->time_limited;
    d->direction_count = options->direction_count;
}

starg_status starg_descriptor_create(starg_context *context, const starg_mesh *mesh,
                                     const starg_descriptor_options *options,
                                     starg_descriptor **out) {
    starg_descriptor_options defaults;
    SCOPED_BY(subject_free) subject s = {0};
    SCOPED_BY(starg_descriptor_drop) starg_descriptor *d = NULL;
    SCOPED_BY(ray_caster_free) ray_caster caster = {0};
    starg_descriptor_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    *out = NULL;
    TRY(check_options(context, options));
    TRY(decompose(context, mesh, options, &s));
    NEW_ZERO(context, STAGE, d, 1);
    add_head(mesh, options, s.pieces, d);
    TRY(add_guards(context, s.pieces, d));
    TRY(add_edges(context, s.pieces, d));
    TRY(ray_caster_create(context, s.pieces->mesh, &caster));
    TRY(add_distances(context, &caster, d));
    TRY(views_measure(context, s.pieces->mesh, &caster, &d->views[0][0]));
    TRY(vibrations_measure(context, s.pieces->mesh, s.surface, d));
    *out = d;
    d = NULL;
    return STARG_OK;
}

void starg_descriptor_free(starg_context *context, starg_descriptor *descriptor) {
    (void)context;
    if (descriptor == NULL)
        return;
    RELEASE(descriptor->file, descriptor->guards, descriptor->edges, descriptor->distances,
            descriptor);
}
