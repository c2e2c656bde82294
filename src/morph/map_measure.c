/* SPDX-License-Identifier: Apache-2.0 */
/* Distortion of a map: the singular values of the linear maps between faces and their images. */
#include "morph/surface_map.h"

#include "geometry/vec3.h"
#include "mesh/mesh.h"

static const char STAGE[] = "map";
static const double WORST = 1000; /* per face */

/* Area and first fundamental form of the triangle in the basis of its first two edges. */
typedef struct form {
    double e, f, g, area;
} form;

static form form_of(const double *vertices, const uint32_t corner[3]) {
    const double *p = vertices + 3 * (size_t)corner[0];
    double u[3], v[3], n[3];
    vec3_subtract(vertices + 3 * (size_t)corner[1], p, u);
    vec3_subtract(vertices + 3 * (size_t)corner[2], p, v);
    vec3_cross(u, v, n);
    return (form){vec3_dot(u, u), vec3_dot(u, v), vec3_dot(v, v), 0.5 * vec3_length(n)};
}

/* s^2 + r^2: the trace of the image's form in an orthonormal basis of the face. */
static double trace_of(const form *a, const form *b) {
    return (a->g * b->e - 2 * a->f * b->f + a->e * b->g) / (4 * a->area * a->area);
}

/* Maps NaN to the worst value. */
static double capped(double x) {
    return x < WORST ? x : WORST;
}

starg_status map_measure(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map) {
    /* of unit size, so that squares do not overflow */
    SCOPED_BY(starg_mesh_drop) starg_mesh *from = NULL, *to = NULL;
    SCOPED double *images = NULL;
    double angles = 0, areas = 0;
    TRY(map_unit_copy(context, a, &from));
    TRY(map_unit_copy(context, b, &to));
    NEW(context, STAGE, images, 3 * map->vertex_count);
    starg_map_positions(map, to, images);
    map->collapsed = 0;
    double area = starg_mesh_area(from), scale = area / starg_mesh_area(to);
    for (size_t f = 0; f < from->face_count; f++) {
        form own = form_of(from->vertices, from->faces + 3 * f);
        form image = form_of(images, from->faces + 3 * f);
        map->collapsed += !(image.area > 0);
        if (!(own.area > 0))
            continue;
        double grown = scale * image.area / own.area;
        angles += own.area * capped(trace_of(&own, &image) / 2 * own.area / image.area);
        areas += own.area * capped((grown + 1 / grown) / 2);
    }
    map->mean_angle_distortion = area > 0 ? angles / area : 0;
    map->mean_area_distortion = area > 0 ? areas / area : 0;
    return STARG_OK;
}
