/* SPDX-License-Identifier: Apache-2.0 */
/* Descent of a composed map, one vertex at a time.
 *
 * A vertex moves straight along the second surface against the gradient of its triangles' energy
 * (distortion.c), by the longest of some halved steps that lowers it. Steps are measured on the
 * surface, not on the sphere, so that they have one scale. A move looks at the neighbours only, so
 * that vertices of one colour, of which no two are neighbours, move side by side. Cost of a sweep:
 * O(edges). */

#include "core/parallel.h"
#include "geometry/vec3.h"
#include "morph/surface_map.h"

static const char STAGE[] = "map";
enum { HALVINGS = 6 };
static const double FLOOR = 1e-3;     /* relative to the mean face area */
static const double FIRST_STEP = 0.5; /* relative to the distance of the nearest image */

/* The uphill direction in the face of a place, from both slopes; returns its length. */
static double uphill(const composition *c, const trial *t, double out[3]) {
    const sphere *s = c->to->sphere;
    const uint32_t *corner = s->mesh->faces + 3 * (size_t)t->point.face;
    double slopes[3], sum[3] = {0};
    for (size_t k = 0; k < 3; k++)
        vec3_along(sum, t->point.coordinates[k], s->directions + 3 * (size_t)corner[k], sum);
    double length = vec3_length(sum), along = vec3_dot(t->spherical_slope, t->direction);
    for (size_t k = 0; k < 3; k++) {
        const double *d = s->directions + 3 * (size_t)corner[k];
        slopes[k] = c->scale * vec3_dot(t->slope, s->mesh->vertices + 3 * (size_t)corner[k]) +
                    (vec3_dot(t->spherical_slope, d) - along * vec3_dot(t->direction, d)) / length;
    }
    return surface_gradient(s->mesh, &t->point, slopes, out) ? vec3_length(out) : 0;
}

static void descend(composition *c, uint32_t v) {
    trial now, next;
    double way[3];
    trial_here(c, v, &now);
    trial_measure(c, v, true, &now);
    double slope = uphill(c, &now, way), step = FIRST_STEP * composition_nearest(c, v) / c->scale;
    if (!(slope > 0 && slope < INFINITY))
        return;
    for (int i = 0; i < HALVINGS; i++, step *= 0.5) {
        surface_point point = now.point;
        const double d[3] = {-step / slope * way[0], -step / slope * way[1],
                             -step / slope * way[2]};
        surface_walk(c->to->sphere->mesh, c->to->topology, d, &point);
        trial_at(c, &point, &next);
        trial_measure(c, v, false, &next);
        if (next.energy < now.energy && trial_is_valid(c, v, &next)) {
            trial_accept(c, v, &next);
            return;
        }
    }
}

/* ---- vertices of one colour, side by side ---- */

enum { COLOURS = 32, CHUNK = 64 };

/* The movable vertices, colour by colour. Neighbours differ in colour, but for those of the last
 * one, which move one after the other. */
typedef struct colouring {
    composition *c;
    uint32_t *vertices;
    size_t start[COLOURS + 1];
    size_t first, end; /* of the loop that runs */
} colouring;

static starg_status colour(composition *c, colouring *out) {
    const sphere *s = c->from;
    SCOPED uint8_t *of = NULL;
    size_t counts[COLOURS] = {0};
    NEW_ZERO(s->context, STAGE, of, s->mesh->vertex_count); /* 0: none yet */
    NEW(s->context, STAGE, out->vertices, s->rings->left);
    for (size_t k = 0; k < s->rings->left; k++) {
        const uint32_t v = s->alive[k];
        const ring *around = &s->rings->of[v];
        uint64_t used = 0;
        for (size_t i = 0; i < around->count; i++)
            used |= UINT64_C(1) << of[around->data[i]];
        uint8_t own = 1;
        while (own < COLOURS && used >> own & 1)
            own++;
        of[v] = own;
        counts[own - 1] += !c->kept[v];
    }
    for (size_t i = 0; i < COLOURS; i++)
        out->start[i + 1] = out->start[i] + counts[i];
    memset(counts, 0, sizeof counts);
    for (size_t k = 0; k < s->rings->left; k++) {
        const uint32_t v = s->alive[k];
        if (!c->kept[v])
            out->vertices[out->start[of[v] - 1] + counts[of[v] - 1]++] = v;
    }
    return STARG_OK;
}

static starg_status descend_some(starg_context *context, void *shared, void *scratch, size_t item) {
    const colouring *all = shared;
    const size_t from = all->first + item * CHUNK;
    (void)context;
    (void)scratch;
    for (size_t k = from; k < from + CHUNK && k < all->end; k++)
        descend(all->c, all->vertices[k]);
    return STARG_OK;
}

static starg_status descend_colour(colouring *all, size_t number) {
    starg_context *context = all->c->from->context;
    all->first = all->start[number];
    all->end = all->start[number + 1];
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = (all->end - all->first + CHUNK - 1) / CHUNK,
                                      .shared = all,
                                      .item = descend_some,
                                      .silent = true};
    if (number + 1 < COLOURS)
        return starg_parallel_for(context, &loop);
    for (size_t k = all->first; k < all->end; k++)
        descend(all->c, all->vertices[k]);
    return STARG_OK;
}

starg_status composition_descend(composition *c, int sweeps) {
    const sphere *s = c->from;
    starg_status status = STARG_OK;
    colouring all = {.c = c};
    c->floor = FLOOR * starg_mesh_area(s->mesh) / (double)s->rings->left;
    STARG_TRY(colour(c, &all));
    for (int i = 0; i < sweeps; i++) {
        STARG_TRY(starg_check_cancel(s->context, STAGE));
        for (size_t k = 0; k < COLOURS; k++)
            STARG_TRY(descend_colour(&all, k));
    }
done:
    RELEASE(all.vertices);
    return status;
}
