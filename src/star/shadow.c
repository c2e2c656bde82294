/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes that guards of two pieces may stand in, and which faces their shadows are on.
 *
 * Problem. Given a box B and a point x off it, find a patch of faces that each ray x + t (x - g),
 * t >= 0, g in B, meets, with x strictly on the inner side of all of its faces.
 *
 * Method. The rays within the solid's bounding box lie in the hull of x and a box, the image of B
 * under the map g -> x + s (x - g): far outside if s is large. It is exact if s is a power of two
 * and coordinates have few digits; a point for which it is not has no shadow. A flood over edges
 * that may meet this hull, from a face that the ray from the middle of B ends on, gives the patch,
 * if x is on the inner side of all of its faces (visibility/box_flood.c has the proof that all
 * rays meet it then).
 *
 * Cost: a flood is linear in the faces that meet the hull; places keep their shadows. */
#include "star/shadow.h"

#include <math.h>

#include "core/bits.h"
#include "core/rng.h"
#include "geometry/intersect.h"
#include "geometry/vec3.h"

static const char STAGE[] = "pieces";

enum {
    PATCH_MOST = 120, /* faces */
    MIDDLES = 60,     /* random points for the middle of a place */
    RNG_STREAM = 91,
    DIGITS = 9 /* bits of the first place's coordinates after the solid's size */
};

static const uint32_t NONE = SHADOW_NONE, UNKNOWN = SHADOW_NONE - 1;

/* Points have to be this far from a place, by the solid's size. */
static const double APART = 1e-3;

/* ---- places ---- */

static void corner_of(const bvh_box *box, int i, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = i >> k & 1 ? box->upper[k] : box->lower[k];
}

/* Is no point of the box strictly on the inner side? */
static bool is_behind(const box_scene *scene, const box_triangle *f, const bvh_box *box) {
    double corner[3];
    for (int i = 0; i < 8; i++) {
        corner_of(box, i, corner);
        if (box_side(scene, f, corner) > 0)
            return false;
    }
    return true;
}

static void find_blind(const shadow_tables *t, const shadow_place *around, shadow_place *out) {
    for (size_t i = 0; i < t->scene->face_count; i++)
        if ((around != NULL && starg_bit_test(around->blind, i)) ||
            is_behind(t->scene, &t->scene->triangles[i], &out->box))
            starg_bit_set(out->blind, i);
}

/* The centre, if that is in the solid or nothing found is. */
static void find_middle(const shadow_tables *t, shadow_place *out) {
    starg_rng rng = starg_rng_make(t->context->seed, RNG_STREAM, t->places.count);
    for (int k = 0; k < 3; k++)
        out->middle[k] = 0.5 * (out->box.lower[k] + out->box.upper[k]);
    double at[3];
    vec3_copy(out->middle, at);
    for (int i = 0; i < MIDDLES; i++) {
        bool on_surface;
        if (bvh_winding(t->scene->tree, at, &on_surface) > 0 && !on_surface) {
            vec3_copy(at, out->middle);
            return;
        }
        for (int k = 0; k < 3; k++)
            at[k] =
                out->box.lower[k] + starg_rng_unit(&rng) * (out->box.upper[k] - out->box.lower[k]);
    }
}

static starg_status add_place(shadow_tables *t, const bvh_box *box, uint32_t around) {
    starg_status status = STARG_OK;
    shadow_place fresh = {.box = *box, .halves = {NONE, NONE}};
    const shadow_place *parent = around == NONE ? NULL : &t->places.data[around];
    fresh.outside = (parent != NULL && parent->outside) || !box_enter(t->worker, box);
    STARG_NEW_ZERO(t->context, STAGE, fresh.blind, t->words);
    if (!fresh.outside) {
        find_blind(t, parent, &fresh);
        find_middle(t, &fresh);
    }
    STARG_PUSH(t->context, STAGE, &t->places, fresh);
    fresh.blind = NULL;
done:
    starg_release(t->context, fresh.blind);
    return status;
}

int shadow_axis(const bvh_box *box) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (box->upper[k] - box->lower[k] > box->upper[axis] - box->lower[axis])
            axis = k;
    return axis;
}

starg_status shadow_halve(shadow_tables *t, uint32_t place, uint32_t halves[2]) {
    starg_status status = STARG_OK;
    for (int i = 0; i < 2; i++) {
        if (t->places.data[place].halves[i] == NONE) {
            bvh_box box = t->places.data[place].box;
            const int k = shadow_axis(&box);
            const double at = 0.5 * box.lower[k] + 0.5 * box.upper[k];
            *(i == 0 ? &box.upper[k] : &box.lower[k]) = at;
            STARG_TRY(add_place(t, &box, place));
            t->places.data[place].halves[i] = (uint32_t)t->places.count - 1;
        }
        halves[i] = t->places.data[place].halves[i];
    }
done:
    return status;
}

starg_status shadow_tables_make(starg_context *context, const starg_solid *solid,
                                shadow_tables *out) {
    starg_status status = STARG_OK;
    bvh_box box;
    *out = (shadow_tables){.context = context};
    STARG_TRY(box_scene_create(context, solid, &out->scene));
    STARG_TRY(box_worker_create(out->scene, &out->worker));
    out->words = starg_bit_words(out->scene->face_count);
    out->size = out->scene->extent;
    STARG_NEW_ZERO(context, STAGE, out->visit, out->scene->face_count);
    STARG_NEW(context, STAGE, out->stack, out->scene->face_count);
    const double grid = ldexp(1, ilogb(out->size) - DIGITS);
    for (int k = 0; k < 3; k++) {
        box.lower[k] = floor(out->scene->all.lower[k] / grid) * grid;
        box.upper[k] = ceil(out->scene->all.upper[k] / grid) * grid;
    }
    STARG_TRY(add_place(out, &box, NONE));
done:
    return status;
}

void shadow_tables_free(shadow_tables *t) {
    for (size_t i = 0; i < t->places.count; i++) {
        starg_release(t->context, t->places.data[i].blind);
        STARG_ARRAY_FREE(t->context, &t->places.data[i].shadows);
    }
    STARG_ARRAY_FREE(t->context, &t->places);
    STARG_ARRAY_FREE(t->context, &t->points);
    STARG_ARRAY_FREE(t->context, &t->patches);
    starg_release(t->context, t->visit);
    starg_release(t->context, t->stack);
    box_worker_free(t->worker);
    box_scene_free(t->scene);
}

/* ---- rays ---- */

/* The image of a box far beyond the solid; false if it is rounded, or x too close. */
static bool reflect(const shadow_tables *t, const bvh_box *box, const double x[3], bvh_box *out) {
    double gap = 0;
    int exponent;
    for (int k = 0; k < 3; k++) {
        gap = fmax(gap, fmax(box->lower[k] - x[k], x[k] - box->upper[k]));
        if (!(t->scene->all.lower[k] <= x[k] && x[k] <= t->scene->all.upper[k]))
            return false;
    }
    if (!(gap >= APART * t->size))
        return false;
    frexp(2 * t->size / gap, &exponent);
    for (int i = 0; i < 6; i++) {
        const int k = i / 2;
        const double from = i % 2 ? box->lower[k] : box->upper[k], way = x[k] - from;
        const double longer = ldexp(way, exponent), to = x[k] + longer;
        if (x[k] - way != from || from + way != x[k] || to - longer != x[k] || to - x[k] != longer)
            return false;
        *(i % 2 ? &out->upper[k] : &out->lower[k]) = to;
    }
    return true;
}

typedef struct first_face {
    const box_scene *scene;
    const double *from, *to;
    double at;
    uint32_t rank;
} first_face;

static bool look_at(void *user, size_t rank) {
    first_face *n = user;
    const box_triangle *f = &n->scene->triangles[rank];
    double height = f->offset, slope = 0;
    if (!segment_meets_triangle(n->from, n->to, box_corner(n->scene, f, 0),
                                box_corner(n->scene, f, 1), box_corner(n->scene, f, 2)))
        return true;
    for (int k = 0; k < 3; k++) {
        height -= f->normal[k] * (n->from[k] - n->scene->centre[k]);
        slope += f->normal[k] * (n->to[k] - n->from[k]);
    }
    if (slope > 0 && height / slope < n->at) {
        n->at = height / slope;
        n->rank = (uint32_t)rank;
    }
    return true;
}

/* The first face that a segment leaves the solid by, up to rounding, or NONE. */
static uint32_t find_end(const shadow_tables *t, const double from[3], const double to[3]) {
    first_face n = {t->scene, from, to, INFINITY, NONE};
    bvh_query_segment(t->scene->tree, from, to, look_at, &n);
    return n.rank;
}

bool shadow_may_be_blind(const shadow_tables *t, uint32_t from, const double x[3], uint32_t place) {
    const double *middle = t->places.data[from].middle, way = vec3_distance(x, middle);
    double to[3];
    if (way < APART * t->size)
        return false;
    for (int k = 0; k < 3; k++)
        to[k] = x[k] + 2 * t->size / way * (x[k] - middle[k]);
    uint32_t end = find_end(t, x, to);
    return end != NONE && starg_bit_test(t->places.data[place].blind, end);
}

/* ---- shadows ---- */

/* Removed again if it does not close. */
static starg_status flood(shadow_tables *t, const box_shaft *shaft, uint32_t seed,
                          uint32_t *patch) {
    starg_status status = STARG_OK;
    const size_t first = t->patches.count;
    size_t depth = 0;
    *patch = NONE;
    t->visit[seed] = ++t->flood;
    t->stack[depth++] = seed;
    STARG_PUSH(t->context, STAGE, &t->patches, 0);
    while (depth > 0) {
        const uint32_t rank = t->stack[--depth];
        const box_triangle *f = &t->scene->triangles[rank];
        unsigned code[3];
        t->looks++;
        if (t->patches.count - first > PATCH_MOST || box_side(t->scene, f, shaft->v) <= 0) {
            t->patches.count = first;
            return STARG_OK;
        }
        STARG_PUSH(t->context, STAGE, &t->patches, rank);
        for (int k = 0; k < 3; k++)
            code[k] = shaft_code(shaft, box_corner(t->scene, f, k));
        for (int k = 0; k < 3; k++) {
            const uint32_t next = f->twin[k] / 3;
            const int end = (k + 1) % 3;
            if (t->visit[next] == t->flood ||
                !shaft_may_meet(shaft, box_corner(t->scene, f, k), code[k],
                                box_corner(t->scene, f, end), code[end]))
                continue;
            t->visit[next] = t->flood;
            t->stack[depth++] = next;
        }
    }
    t->patches.data[first] = (uint32_t)(t->patches.count - first - 1);
    *patch = (uint32_t)first;
done:
    return status;
}

static starg_status find_shadow(shadow_tables *t, uint32_t place, const double x[3],
                                uint32_t *patch) {
    bvh_box image;
    box_shaft shaft;
    double centre[3];
    *patch = NONE;
    if (!reflect(t, &t->places.data[place].box, x, &image))
        return STARG_OK;
    for (int k = 0; k < 3; k++)
        centre[k] = 0.5 * image.lower[k] + 0.5 * image.upper[k];
    const uint32_t seed = find_end(t, x, centre);
    if (seed == NONE)
        return STARG_OK;
    shaft_make(&shaft, x, &image);
    return flood(t, &shaft, seed, patch);
}

starg_status shadow_of(shadow_tables *t, uint32_t place, uint32_t point, uint32_t *patch) {
    starg_status status = STARG_OK;
    *patch = NONE;
    while (t->places.data[place].shadows.count <= point)
        STARG_PUSH(t->context, STAGE, &t->places.data[place].shadows, UNKNOWN);
    uint32_t *known = &t->places.data[place].shadows.data[point];
    if (*known == UNKNOWN)
        STARG_TRY(find_shadow(t, place, t->points.data + 3 * (size_t)point, known));
    *patch = *known;
done:
    return status;
}

bool shadow_is_blind(const shadow_tables *t, uint32_t place, uint32_t patch) {
    for (uint32_t i = 1; i <= t->patches.data[patch]; i++)
        if (!starg_bit_test(t->places.data[place].blind, t->patches.data[patch + i]))
            return false;
    return true;
}
