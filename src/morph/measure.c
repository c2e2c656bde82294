/* SPDX-License-Identifier: Apache-2.0 */
/* Measures a frame of a morph: exact counts of intersections, folds, and drifts. */

#include "geometry/vec3.h"
#include "mesh/examine.h"
#include "mesh/topology.h"
#include "morph/morph.h"

static const char STAGE[] = "measure";
static const double COLLAPSED = 1e-6; /* relative to the smaller area at the ends */

static void normal_of(const double *positions, const uint32_t corner[3], double out[3]) {
    vec3_triangle_normal(positions + 3 * (size_t)corner[0], positions + 3 * (size_t)corner[1],
                         positions + 3 * (size_t)corner[2], out);
}

/* Does a face oppose the sum of its neighbours' normals? */
static bool is_flipped(const starg_mesh *mesh, const mesh_topology *topology,
                       const double *positions, size_t face) {
    double own[3], sum[3] = {0}, other[3];
    normal_of(positions, mesh->faces + 3 * face, own);
    for (size_t h = 3 * face; h < 3 * face + 3; h++) {
        if (topology->twin[h] == TOPOLOGY_NONE)
            continue;
        normal_of(positions, mesh->faces + 3 * (size_t)(topology->twin[h] / 3), other);
        vec3_along(sum, 1, other, sum);
    }
    return vec3_dot(own, sum) < 0;
}

static starg_status count_faces(const starg_morph *m, const double *scaled,
                                starg_frame_measures *out) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    TRY(topology_create(m->context, m->mesh, &topology));
    for (size_t f = 0; f < m->mesh->face_count; f++) {
        const uint32_t *corner = m->mesh->faces + 3 * f;
        double own[3], first[3], last[3];
        normal_of(scaled, corner, own);
        normal_of(m->mesh->vertices, corner, first);
        normal_of(m->images, corner, last);
        double least = fmin(vec3_length(first), vec3_length(last));
        out->collapsed += least > 0 && vec3_length(own) <= COLLAPSED * least;
        out->inverted += is_flipped(m->mesh, topology, scaled, f) &&
                         !is_flipped(m->mesh, topology, m->mesh->vertices, f) &&
                         !is_flipped(m->mesh, topology, m->images, f);
    }
    return STARG_OK;
}

static starg_status size_of(const starg_morph *m, const double *positions, double *volume,
                            double *area) {
    starg_mesh *mesh = NULL;
    TRY(starg_mesh_create(m->context, positions, m->mesh->vertex_count, m->mesh->faces,
                          m->mesh->face_count, &mesh));
    *volume = starg_mesh_volume(mesh);
    *area = starg_mesh_area(mesh);
    starg_mesh_free(mesh);
    return STARG_OK;
}

/* Deviation of a value from the interpolated one, relative to that. */
static double drift(double value, double first, double last, double t) {
    double wanted = (1 - t) * first + t * last;
    return wanted != 0 ? (value - wanted) / fabs(wanted) : 0;
}

starg_status starg_morph_measure(const starg_morph *m, double t, const double *positions,
                                 starg_frame_measures *out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED_BY(starg_check_drop) starg_check *check = NULL;
    SCOPED double *scaled = NULL;
    double volumes[3], areas[3], size = morph_size(m, t);
    size_t count = 3 * m->mesh->vertex_count;
    *out = (starg_frame_measures){0};
    NEW(m->context, STAGE, scaled, count);
    for (size_t i = 0; i < count; i++)
        scaled[i] =
            (positions[i] - (1 - t) * m->centers[0][i % 3] - t * m->centers[1][i % 3]) / size;
    TRY(count_faces(m, scaled, out));
    TRY(size_of(m, m->mesh->vertices, &volumes[0], &areas[0]));
    TRY(size_of(m, m->images, &volumes[1], &areas[1]));
    TRY(size_of(m, scaled, &volumes[2], &areas[2]));
    TRY(starg_mesh_create(m->context, positions, m->mesh->vertex_count, m->mesh->faces,
                          m->mesh->face_count, &mesh));
    TRY(starg_mesh_check(m->context, mesh, &check));
    out->intersections = check->findings[STARG_FINDING_SELF_INTERSECTION].count;
    for (int i = 0; i < 3; i++) {
        double own = (i < 2 ? m->sizes[i] : size) / m->sizes[0];
        volumes[i] *= own * own * own;
        areas[i] *= own * own;
    }
    out->volume = volumes[2] * m->sizes[0] * m->sizes[0] * m->sizes[0];
    out->area = areas[2] * m->sizes[0] * m->sizes[0];
    out->volume_drift = drift(volumes[2], volumes[0], volumes[1], t);
    out->area_drift = drift(areas[2], areas[0], areas[1], t);
    return STARG_OK;
}
