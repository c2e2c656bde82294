/* SPDX-License-Identifier: Apache-2.0 */
/* Morphs: from A to the images of its vertices by one of several methods [YL11, section 5.2].
 *
 * Stages: check and scale both ends; for methods with guards, choose guards and pieces
 * (consistent.c); for the rigid ones, the paths of the faces (face_paths.c; flipped_faces.c for
 * star) and guards (guard_paths.c), the factorized system (rigid.c) and its residual (residual.c);
 * for solid, the path of its tetrahedra (solid_path.c).
 * Frames are then independent of one another.
 *
 * All computations are relative to the centre of each end's box, in units that give closed ends
 * equal volumes, so that global growth does not stretch single faces. The unit varies so that its
 * cube, and hence the volume, is linear in t; the centre moves straight. */
#include "morph/morph.h"
#include "core/fields.h"

#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "morph/solid_map.h"

static const char STAGE[] = "morph";
enum { CANDIDATES = 1000, CANDIDATES_MOST = 100000 };
static const double GROWTH_MOST = 1e6; /* largest ratio of volumes that is normalized */

static const char *const METHODS[] = {"star", "arap", "linear", "spherical", "solid", NULL};

static const starg_field OPTIONS[] = {
    {.key = "method",
     .option = "method",
     .group = "search",
     .brief = "star, arap, linear or solid",
     .kind = STARG_FIELD_CHOICE,
     FIELD_MEMBER(starg_morph_options, method),
     .words = METHODS,
     .initial = STARG_MORPH_STAR,
     .value = "star|arap|linear|spherical|solid",
     .help = "star: pieces about corresponding guards; arap: as rigid as possible, without guards; "
             "linear: straight vertex paths; spherical: spherical coordinates about the guards; "
             "solid: tetrahedra inside are never inverted, at any time (needs TetGen)."},
    {.key = "candidates",
     .option = "candidates",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_morph_options, candidates),
     .least = 1,
     .most = CANDIDATES_MOST,
     .initial = CANDIDATES,
     .value = "N",
     .help = "Approximate number of guard candidates."},
};
static const starg_fields OPTIONS_TABLE = {
    .name = "morph options", .size = sizeof(starg_morph_options), FIELD_ROWS(OPTIONS)};
OPTIONS_BY(OPTIONS_TABLE, starg_morph_options)

static starg_status check_input(starg_context *context, const starg_mesh *a, const double *images,
                                const starg_morph_options *options) {
    TRY(fields_check(context, STAGE, &OPTIONS_TABLE, options));
    if (a->face_count == 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the mesh has no faces");
    for (size_t i = 0; i < 3 * a->vertex_count; i++) {
        uint64_t vertex = i / 3;
        if (!(fabs(images[i]) < STARG_COORDINATE_LIMIT))
            return starg_fail_at(context, STARG_ERROR_RANGE, STAGE, STARG_ELEMENT_VERTEX, &vertex,
                                 1, "the image of vertex %zu must be finite and below 1e100",
                                 i / 3);
    }
    return STARG_OK;
}

/* Centre of the box and its largest side. */
static double box_of(const double *positions, size_t count, double center[3]) {
    double extent = 0;
    for (size_t k = 0; k < 3; k++) {
        double lower = positions[k], upper = positions[k];
        for (size_t v = 1; v < count; v++) {
            lower = fmin(lower, positions[3 * v + k]);
            upper = fmax(upper, positions[3 * v + k]);
        }
        center[k] = 0.5 * lower + 0.5 * upper;
        extent = fmax(extent, upper - lower);
    }
    return extent;
}

static bool is_closed(const mesh_topology *topology) {
    for (size_t h = 0; h < 3 * topology->face_count; h++)
        if (topology->twin[h] == TOPOLOGY_NONE)
            return false;
    return true;
}

/* The scale that brings A to the volume of the images; 1 if either volume is negligible. */
static starg_status find_growth(starg_morph *m, double *growth) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *other = NULL;
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    *growth = 1;
    TRY(starg_mesh_create(m->context, m->images, m->mesh->vertex_count, m->mesh->faces,
                          m->mesh->face_count, &other));
    TRY(topology_create(m->context, m->mesh, &topology));
    double ratio = starg_mesh_volume(other) / starg_mesh_volume(m->mesh);
    if (is_closed(topology) && starg_mesh_volume(m->mesh) > 0 && ratio * GROWTH_MOST > 1 &&
        ratio < GROWTH_MOST)
        *growth = cbrt(ratio);
    return STARG_OK;
}

double morph_size(const starg_morph *m, double t) {
    double growth = m->sizes[1] / m->sizes[0];
    return m->sizes[0] * cbrt(1 - t + t * growth * growth * growth);
}

static starg_status take_ends(starg_morph *m, const starg_mesh *a, const double *images) {
    starg_context *context = m->context;
    size_t count = 3 * a->vertex_count;
    SCOPED double *scaled = NULL;
    double growth;
    NEW(context, STAGE, m->source, count);
    NEW(context, STAGE, m->target, count);
    NEW(context, STAGE, m->images, count);
    NEW(context, STAGE, scaled, count);
    memcpy(m->source, a->vertices, count * sizeof *m->source);
    memcpy(m->target, images, count * sizeof *m->target);
    double own = box_of(m->source, a->vertex_count, m->centers[0]);
    double other = box_of(m->target, a->vertex_count, m->centers[1]);
    double size = fmax(own, other);
    if (!(own > 0 && other > 0))
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "one of the two shapes is a single point");
    for (size_t i = 0; i < count; i++) {
        scaled[i] = (m->source[i] - m->centers[0][i % 3]) / size;
        m->images[i] = (m->target[i] - m->centers[1][i % 3]) / size;
    }
    TRY(starg_mesh_create(context, scaled, a->vertex_count, a->faces, a->face_count, &m->mesh));
    TRY(find_growth(m, &growth));
    m->sizes[0] = size;
    m->sizes[1] = size * growth;
    for (size_t i = 0; i < count; i++)
        m->images[i] /= growth;
    return STARG_OK;
}

starg_status starg_morph_create(starg_context *context, const starg_mesh *a, const double *images,
                                const starg_morph_options *options, starg_morph **out) {
    starg_morph_options defaults;
    SCOPED_BY(starg_morph_drop) starg_morph *m = NULL;
    bool stars = false; /* all is prepared */
    starg_morph_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(check_input(context, a, images, options));
    NEW_ZERO(context, STAGE, m, 1);
    m->context = context;
    m->method = options->method;
    TRY(take_ends(m, a, images));
    m->seen_from = options->centers;
    if (m->method == STARG_MORPH_SOLID)
        TRY(morph_prepare_stars(m, &stars));
    if (morph_has_guards(m))
        TRY(morph_guard(m, options->candidates));
    if (morph_is_rigid(m) && !stars)
        TRY(morph_prepare_faces(m));
    if (m->method == STARG_MORPH_STAR) {
        TRY(morph_fill_flipped(m));
        TRY(morph_prepare_guards(m));
    }
    if (morph_is_rigid(m) && !stars)
        TRY(morph_prepare_rigid(m));
    if (m->method == STARG_MORPH_SOLID && !stars)
        TRY(morph_prepare_solid(m));
    m->seen_from = NULL;
    *out = m;
    m = NULL;
    return STARG_OK;
}

void starg_morph_free(starg_morph *m) {
    if (m == NULL)
        return;
    void *const blocks[] = {m->source,        m->target,    m->images,    m->faces,
                            m->weights,       m->component, m->residual,  m->candidates[0],
                            m->candidates[1], m->guards[0], m->guards[1], m->places[0],
                            m->places[1],     m->pieces,    m->guarded,   m->guard_paths,
                            m->flipped,       m->late};
    starg_mesh_free(m->mesh);
    sparse_free(m->system);
    solid_path_free(m->solid);
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        starg_release(m->context, blocks[i]);
    starg_release(m->context, m);
}

/* ---- frames ---- */

static void unscale(const starg_morph *m, double t, double *positions) {
    double size = morph_size(m, t);
    for (size_t i = 0; i < 3 * m->mesh->vertex_count; i++)
        positions[i] =
            (1 - t) * m->centers[0][i % 3] + t * m->centers[1][i % 3] + size * positions[i];
}

starg_status starg_morph_frame(const starg_morph *m, double t, double *positions) {
    size_t count = 3 * m->mesh->vertex_count;
    if (!(t >= 0 && t <= 1))
        return starg_fail(m->context, STARG_ERROR_ARGUMENT, STAGE,
                          "time is %g; it must be in [0, 1]", t);
    TIME_RULE(m->context, STARG_TIME_FAILS);
    TRY(starg_check_cancel(m->context, STAGE));
    if (t == 0 || t == 1) {
        memcpy(positions, t == 0 ? m->source : m->target, count * sizeof *positions);
        return STARG_OK;
    }
    if (m->method == STARG_MORPH_LINEAR) {
        for (size_t i = 0; i < count; i++)
            positions[i] = (1 - t) * m->source[i] + t * m->target[i];
        return STARG_OK;
    }
    if (m->method == STARG_MORPH_SOLID) {
        morph_frame_solid(m, t, positions);
        return STARG_OK;
    }
    TRY(m->method == STARG_MORPH_SPHERICAL ? morph_frame_spherical(m, t, positions)
                                           : morph_frame_rigid(m, t, positions));
    unscale(m, t, positions);
    return STARG_OK;
}

size_t starg_morph_guard_count(const starg_morph *m) {
    return m->guard_count;
}

const double *starg_morph_guards(const starg_morph *m, int end) {
    return m->guards[end != 0];
}

const uint32_t *starg_morph_pieces(const starg_morph *m) {
    return m->pieces;
}

size_t starg_morph_unguarded(const starg_morph *m) {
    return m->unguarded;
}
