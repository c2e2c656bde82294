/* SPDX-License-Identifier: Apache-2.0 */
/* Cones that meet, where there is no border.
 *
 * Problem: which triangles that only the first guard is inside of, and others that it is not, have
 * cones from their guards that meet, so that no border leaves both to their guards (border.c)?
 *
 * Method: planes of the cone's sides, which part most pairs, and else parting.c. A pair counts
 * unless there is a plane between the cones that keeps the gap: a few that touch count, too.
 *
 * Cost: for each pair four planes at most, and for few of them a search. */
#include "star/strict/search/search.h"

#include "geometry/vec3.h"

enum { PAIR_WORK = 12 /* for two cones, in what a row costs */ };

/* The planes of the four sides of a cone, outward. */
typedef struct cone_sides {
    partition_plane planes[4];
} cone_sides;

static void set_side(const double a[3], const double b[3], const double c[3], const double inner[3],
                     partition_plane *out) {
    double normal[3];
    vec3_triangle_normal(a, b, c, normal);
    double length = vec3_length(normal), offset = vec3_dot(normal, a);
    double scale = length > 0 ? (vec3_dot(normal, inner) > offset ? -1 : 1) / length : 0;
    for (int k = 0; k < 3; k++)
        out->normal[k] = scale * normal[k];
    out->offset = scale * offset;
}

static void find_cone(const parting *p, uint32_t triangle, cone_sides *out) {
    const double *guard = p->guards[0];
    const double *c[3] = {parting_vertex(p->r, triangle, 0), parting_vertex(p->r, triangle, 1),
                          parting_vertex(p->r, triangle, 2)};
    for (int k = 0; k < 3; k++)
        set_side(guard, c[k], c[(k + 1) % 3], c[(k + 2) % 3], &out->planes[k]);
    set_side(c[0], c[1], c[2], guard, &out->planes[3]);
}

/* Is everything of the other cone, but for shared vertices, beyond this side of the cone? */
static bool is_beyond(const parting *p, const partition_plane *side, uint32_t own, uint32_t other) {
    const uint32_t *c = p->r->triangles.data[own].corners, *d = p->r->triangles.data[other].corners;
    double limit = side->offset + p->gap;
    for (size_t i = 1; i < p->guard_count; i++)
        if (vec3_dot(side->normal, p->guards[i]) <= limit)
            return false;
    for (int k = 0; k < 3; k++)
        if (d[k] != c[0] && d[k] != c[1] && d[k] != c[2] &&
            vec3_dot(side->normal, parting_vertex(p->r, other, k)) <= limit)
            return false;
    return true;
}

static starg_status cross(parting *p, const cone_sides *cone, uint32_t own, uint32_t other,
                          bool *crossed) {
    const parting_triangles low = {.data = &own, .count = 1}, high = {.data = &other, .count = 1};
    partition_plane plane;
    *crossed = false;
    for (int i = 0; i < 4; i++)
        if (is_beyond(p, &cone->planes[i], own, other))
            return STARG_OK;
    TRY(parting_find(p, &low, &high, &plane, crossed));
    *crossed = !*crossed;
    return STARG_OK;
}

starg_status crossings_count(const border_task *task, size_t most, region_scratch *scratch,
                             size_t *count) {
    SCOPED_BY(parting_free) parting p = border_parting(task, scratch);
    *count = 0;
    for (size_t i = 0; i < task->own.count && *count < most; i++) {
        cone_sides cone;
        find_cone(&p, task->own.data[i], &cone);
        scratch->work += PAIR_WORK * task->others.count;
        for (size_t k = 0; k < task->others.count && *count < most; k++) {
            bool crossed;
            TRY(cross(&p, &cone, task->own.data[i], task->others.data[k], &crossed));
            *count += crossed;
        }
    }
    return STARG_OK;
}
