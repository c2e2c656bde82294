/* SPDX-License-Identifier: Apache-2.0 */
/* Low-distortion map between two surfaces, coarse to fine.
 *
 * Problem: two spherical embeddings compose to a bijection, but each was computed alone: between
 * landmarks the composed map twists and compresses. Find directions of the first surface's
 * vertices, with landmarks fixed, for which the map of surface to surface distorts little. Source:
 * J. Schreiner, A. Asirvatham, E. Praun, H. Hoppe, Inter-surface mapping, 2004, which uses a common
 * coarse mesh; here the sphere is the common domain, and only the first surface's vertices move.
 *
 * Stages of a cycle: remove vertices of the first surface, except landmarks, as long as the
 * embedding stays valid; move landmarks to their counterparts, which few triangles then obstruct;
 * move all vertices together (flow.c) and one by one (descend.c); restore vertices, each to the
 * centre of the kernel of its polygon, and move all whenever there are a third more. Landmarks that
 * could not be met are tried again on each finer level; those not met in the first cycle contradict
 * one another. Further cycles untwist what the previous one left; the best map among the cycles'
 * ends is kept.
 *
 * Invariant: all spherical triangles are positive by the exact predicate: the map is a bijection at
 * all times. Cost: all levels of a cycle together take a few sweeps of the finest. */
#include "morph/surface_map.h"

#include <math.h>

static const char STAGE[] = "map";
enum {
    CYCLES = 3,
    LEAST = 500,      /* vertices of the coarsest level, */
    LEAST_FACTOR = 3, /* or so many per landmark */
    COARSE_SWEEPS = 30,
    COARSE_STEPS = 20,
    LEVEL_STEPS = 5,
    STEPS_MOST = 5000, /* vertices: finer levels only descend */
    LEVEL_SWEEPS = 15,
    FINAL_SWEEPS = 30
};
static const double GROWTH = 1.3;

typedef struct composer {
    composition c;
    const landmark_list *landmarks;
    sphere_work work;
    double *best; /* directions of the best map so far */
    double least; /* its energy */
    bool met;
} composer;

static starg_status coarsen(composer *p) {
    size_t least = LEAST_FACTOR * p->landmarks->count;
    const rings_limits limits = {.least = least > LEAST ? least : LEAST,
                                 .kept = p->c.kept,
                                 .directions = p->c.from->directions};
    TRY(rings_reduce(p->c.from->rings, &limits));
    sphere_list_alive(p->c.from);
    composition_locate_all(&p->c);
    return STARG_OK;
}

static starg_status meet(composer *p) {
    if (p->met)
        return STARG_OK;
    starg_status status = landmarks_meet(p->c.from, p->c.to->sphere, p->landmarks, &p->met);
    composition_locate_all(&p->c);
    return status;
}

static starg_status better(composer *p, int steps) {
    TRY(meet(p));
    if (p->c.from->rings->left < STEPS_MOST)
        TRY(composition_flow(&p->c, steps));
    return composition_descend(&p->c, LEVEL_SWEEPS);
}

static starg_status refine(composer *p) {
    sphere *s = p->c.from;
    double next = GROWTH * (double)s->rings->left;
    IN_STAGE(s->context, STAGE);
    while (s->rings->removals.count > 0) {
        TRY(sphere_insert(s, &p->work));
        uint32_t v = s->alive[s->rings->left - 1];
        composition_locate(&p->c, v, p->c.points[s->rings->of[v].data[0]].face);
        if ((double)s->rings->left >= next) {
            TRY(better(p, LEVEL_STEPS));
            next = GROWTH * (double)s->rings->left;
        }
        starg_progress_step(s->context, s->rings->left, s->rings->vertex_count);
    }
    TRY(meet(p));
    TRY(composition_descend(&p->c, FINAL_SWEEPS));
    sphere_list_alive(s);
    return STARG_OK;
}

static starg_status cycle(composer *p) {
    sphere *s = p->c.from;
    bool met = p->met;
    TRY(coarsen(p));
    TRY(meet(p));
    TRY(composition_descend(&p->c, COARSE_SWEEPS));
    TRY(better(p, COARSE_STEPS));
    TRY(refine(p));
    double energy = composition_energy(&p->c);
    if (energy < p->least || met != p->met) {
        p->least = energy;
        memcpy(p->best, s->directions, 3 * s->mesh->vertex_count * sizeof *p->best);
    }
    return STARG_OK;
}

starg_status compose_spheres(sphere *from, const locator *to, const landmark_list *landmarks,
                             bool *met) {
    starg_status status = STARG_OK;
    starg_context *context = from->context;
    composer p = {.c = {.from = from, .to = to}, .landmarks = landmarks, .least = INFINITY};
    size_t count = from->mesh->vertex_count;
    *met = false;
    p.c.scale = sqrt(starg_mesh_area(from->mesh) / starg_mesh_area(to->sphere->mesh));
    STARG_NEW_ZERO(context, STAGE, p.c.kept, count);
    STARG_NEW(context, STAGE, p.c.points, count);
    STARG_NEW(context, STAGE, p.c.images, 3 * count);
    STARG_NEW(context, STAGE, p.best, 3 * count);
    for (size_t i = 0; i < landmarks->count; i++)
        p.c.kept[landmarks->from[i]] = 1;
    memcpy(p.best, from->directions, 3 * count * sizeof *p.best);
    for (int i = 0; i < CYCLES && (i == 0 || p.met); i++)
        STARG_TRY(cycle(&p));
    memcpy(from->directions, p.best, 3 * count * sizeof *p.best);
    *met = p.met;
done:
    sphere_work_free(&p.work);
    RELEASE(p.c.kept, p.c.points, p.c.images, p.best);
    return status;
}
