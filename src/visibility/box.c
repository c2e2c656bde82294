/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility from a box: tables, the question of a box, and the order in which reasons are tried.
 *
 * The cheap ones come first: planes, then where segments begin, patches, and entries. A vertex is
 * asked about once in a box, however many faces share it; only where the box had to be clipped to
 * the inner half-space of a face, the vertices of the face are asked about once more. */
#include "visibility/box.h"

#include <math.h>

#include "core/bits.h"
#include "core/memory.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "visibility/box_parts.h"

static const char STAGE[] = "visibility";

/* ---- the scene ---- */

/* The error bound is that of visibility/scene.c, with the extent of the triangle itself. */
static void make_plane(const box_scene *scene, box_triangle *t) {
    const double *a = box_corner(scene, t, 0), *b = box_corner(scene, t, 1);
    const double *c = box_corner(scene, t, 2);
    double from_centre[3], edge = 0;
    for (int k = 0; k < 3; k++)
        edge = fmax(edge, fmax(fabs(b[k] - a[k]), fabs(c[k] - a[k])));
    vec3_triangle_normal(a, b, c, t->normal);
    vec3_subtract(a, scene->centre, from_centre);
    t->offset = vec3_dot(t->normal, from_centre);
    t->bound = 128 * 0x1p-53 * edge * edge * scene->extent;
    if (!(t->bound > 1e-250))
        t->bound = INFINITY; /* too small for the analysis: always decide exactly */
}

static void make_triangles(box_scene *scene, const mesh_topology *topology) {
    const uint32_t *faces = scene->solid->mesh->faces, *order = scene->tree->order;
    for (size_t v = 0; v < scene->vertex_count; v++)
        scene->outgoing[v] = BOX_NONE;
    for (size_t rank = 0; rank < scene->face_count; rank++)
        scene->rank_of[order[rank]] = (uint32_t)rank;
    for (size_t rank = 0; rank < scene->face_count; rank++) {
        box_triangle *t = &scene->triangles[rank];
        size_t face = order[rank];
        for (size_t k = 0; k < 3; k++) {
            uint32_t twin = solid_twin(scene->solid, topology->twin, (uint32_t)(3 * face + k));
            t->corner[k] = faces[3 * face + k];
            t->twin[k] = 3 * scene->rank_of[twin / 3] + twin % 3;
            if (scene->outgoing[t->corner[k]] == BOX_NONE)
                scene->outgoing[t->corner[k]] = (uint32_t)(3 * rank + k);
        }
        make_plane(scene, t);
    }
}

static starg_status make_points(box_scene *scene) {
    const mesh_patches *patches = scene->solid->patches;
    if (patches == NULL)
        return STARG_OK;
    NEW(scene->context, STAGE, scene->between, patches->points.count);
    for (size_t i = 0; i < patches->points.count; i++) {
        const patch_point *of = &patches->points.data[i];
        scene->between[i] = (box_point){patch_point_dyadic(of, scene->points), of};
    }
    return STARG_OK;
}

/* Vertices and points that can be asked about. */
static size_t target_count(const box_scene *scene) {
    const mesh_patches *patches = scene->solid->patches;
    return scene->vertex_count + (patches != NULL ? patches->points.count : 0);
}

starg_status box_scene_create(starg_context *context, const starg_solid *solid, box_scene **out) {
    SCOPED_BY(box_scene_drop) box_scene *scene = NULL;
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    *out = NULL;
    TRY(wings_create(context, solid->mesh, &topology));
    NEW_ZERO(context, STAGE, scene, 1);
    scene->context = context;
    scene->solid = solid;
    scene->tree = solid->tree;
    scene->points = solid->mesh->vertices;
    scene->vertex_count = solid->mesh->vertex_count;
    scene->face_count = solid->mesh->face_count;
    solid_extent(solid, &scene->all);
    const bvh_box *all = &scene->all;
    for (int k = 0; k < 3; k++) {
        scene->centre[k] = 0.5 * all->lower[k] + 0.5 * all->upper[k];
        scene->extent = fmax(scene->extent, all->upper[k] - all->lower[k]);
    }
    NEW(context, STAGE, scene->triangles, scene->face_count);
    NEW(context, STAGE, scene->rank_of, scene->face_count);
    NEW(context, STAGE, scene->outgoing, scene->vertex_count);
    make_triangles(scene, topology);
    TRY(make_points(scene));
    TRY(box_find_sound(scene));
    TRY(box_tree_create(context, scene->tree, scene->centre, scene->extent, &scene->boxes));
    *out = scene;
    scene = NULL;
    return STARG_OK;
}

void box_scene_free(box_scene *scene) {
    if (scene == NULL)
        return;
    box_tree_free(scene->boxes);
    RELEASE(scene->between, scene->triangles, scene->rank_of, scene->outgoing, scene->sound,
            scene->sound_about, scene);
}

/* ---- a triangle against a box ---- */

/* The values of an affine function on a box: that at its lower corner plus the sum of an interval
 * an axis. The function is gradient . (x - origin), where the gradient's components are differences
 * of two products, or single differences; `size` is the sum of their absolute values times the
 * distances. The error is below 16 x 2^-53 times the sum of absolute products. */
typedef struct interval {
    double least, most, bound;
} interval;

static interval range_on_box(const double gradient[3], const double size[3], const double origin[3],
                             const bvh_box *box) {
    interval r = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double low = box->lower[k] - origin[k], high = box->upper[k] - origin[k];
        double at_low = gradient[k] * low, at_high = gradient[k] * high;
        r.least += at_low < at_high ? at_low : at_high;
        r.most += at_low < at_high ? at_high : at_low;
        r.bound += size[k] * fmax(fabs(low), fabs(high));
    }
    r.bound = 16 * 0x1p-53 * r.bound + SHAFT_TINY_3;
    return r;
}

/* Outward normal of the triangle, and the sums of the absolute products in its components. */
static void normal_with_size(const double *const corner[3], double normal[3], double size[3]) {
    double u[3], v[3];
    vec3_subtract(corner[1], corner[0], u);
    vec3_subtract(corner[2], corner[0], v);
    for (int k = 0; k < 3; k++) {
        double x = u[(k + 1) % 3] * v[(k + 2) % 3], y = u[(k + 2) % 3] * v[(k + 1) % 3];
        normal[k] = x - y;
        size[k] = fabs(x) + fabs(y);
    }
}

/* In the projection along axis k: is there a strip beside the line through a and b, on its other
 * side than c or on this, that keeps the box from the triangle? */
static bool edge_separates(int k, const double a[3], const double b[3], const double c[3],
                           const bvh_box *box) {
    int u = (k + 1) % 3, w = (k + 2) % 3;
    double gradient[3] = {0}, size[3] = {0};
    gradient[u] = a[w] - b[w];
    gradient[w] = b[u] - a[u];
    size[u] = fabs(gradient[u]);
    size[w] = fabs(gradient[w]);
    interval r = range_on_box(gradient, size, a, box);
    double x = gradient[u] * (c[u] - a[u]), y = gradient[w] * (c[w] - a[w]), at_c = x + y;
    double bound = r.bound + 16 * 0x1p-53 * (fabs(x) + fabs(y));
    return r.least > bound + fmax(at_c, 0) || r.most < fmin(at_c, 0) - bound;
}

bool box_may_cross(const box_scene *scene, const box_triangle *t, const bvh_box *box) {
    const double *const corner[3] = {box_corner(scene, t, 0), box_corner(scene, t, 1),
                                     box_corner(scene, t, 2)};
    double normal[3], size[3];
    for (int k = 0; k < 3; k++)
        if ((corner[0][k] < box->lower[k] && corner[1][k] < box->lower[k] &&
             corner[2][k] < box->lower[k]) ||
            (corner[0][k] > box->upper[k] && corner[1][k] > box->upper[k] &&
             corner[2][k] > box->upper[k]))
            return false;
    normal_with_size(corner, normal, size);
    interval r = range_on_box(normal, size, corner[0], box);
    if (r.least > r.bound || r.most < -r.bound)
        return false;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (edge_separates(k, corner[i], corner[(i + 1) % 3], corner[(i + 2) % 3], box))
                return false;
    return true;
}

/* ---- the inner half-space of a face ---- */

typedef enum clip_result { CLIP_NOTHING_LEFT, CLIP_ALL_LEFT, CLIP_SOME_LEFT } clip_result;

static bool no_corner_is_inner(const box_scene *scene, const box_triangle *t, const bvh_box *box) {
    for (int i = 0; i < 8; i++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = i >> k & 1 ? box->upper[k] : box->lower[k];
        if (orient3d(box_corner(scene, t, 0), box_corner(scene, t, 1), box_corner(scene, t, 2), p) >
            0)
            return false;
    }
    return true;
}

/* *out = a box about what of `box` is on the inner side of the triangle, with a margin above the
 * rounding error. On axis k the inner side reaches to where the function is zero if it is as low
 * as can be on the other axes. */
static clip_result clip(const box_scene *scene, const box_triangle *t, const bvh_box *box,
                        bvh_box *out) {
    const double *const corner[3] = {box_corner(scene, t, 0), box_corner(scene, t, 1),
                                     box_corner(scene, t, 2)};
    double normal[3], size[3];
    normal_with_size(corner, normal, size);
    interval r = range_on_box(normal, size, corner[0], box); /* negative on the inner side */
    *out = *box;
    if (r.most < -r.bound)
        return CLIP_ALL_LEFT;
    if (r.least > r.bound || (r.least > -r.bound && no_corner_is_inner(scene, t, box)))
        return CLIP_NOTHING_LEFT;
    for (int k = 0; k < 3; k++) {
        double a = corner[0][k];
        double least = fmin(normal[k] * (box->lower[k] - a), normal[k] * (box->upper[k] - a));
        double reach = (least - r.least) / normal[k];
        double margin = 4 * r.bound / fabs(normal[k]) + 8 * 0x1p-53 * (fabs(reach) + fabs(a));
        if (normal[k] > 0 && a + reach + margin < out->upper[k])
            out->upper[k] = fmax(a + reach + margin, out->lower[k]);
        if (normal[k] < 0 && a + reach - margin > out->lower[k])
            out->lower[k] = fmin(a + reach - margin, out->upper[k]);
    }
    return CLIP_SOME_LEFT;
}

/* ---- a box's question ---- */

enum { STEPS = 32 }; /* triangles that take about a microsecond */

starg_status box_worker_create(const box_scene *scene, box_worker **out) {
    starg_context *context = scene->context;
    size_t n = target_count(scene), m = scene->face_count;
    box_worker *w = starg_allocate_zero(context, 1, sizeof *w);
    *out = NULL;
    if (w == NULL)
        return STARG_ERROR_MEMORY;
    w->scene = scene;
    w->crossing = starg_allocate(context, m, sizeof *w->crossing);
    w->crossing_mark = starg_allocate_zero(context, m, sizeof *w->crossing_mark);
    w->visit = starg_allocate_zero(context, m, sizeof *w->visit);
    w->stack = starg_allocate(context, 2 * m, sizeof *w->stack);
    w->seed = starg_allocate(context, n, sizeof *w->seed);
    w->answer_mark = starg_allocate_zero(context, n, sizeof *w->answer_mark);
    w->answer = starg_allocate(context, n, sizeof *w->answer);
    if (w->crossing == NULL || w->crossing_mark == NULL || w->visit == NULL || w->stack == NULL ||
        w->seed == NULL || w->answer_mark == NULL || w->answer == NULL) {
        box_worker_free(w);
        return STARG_ERROR_MEMORY;
    }
    for (size_t v = 0; v < n; v++)
        w->seed[v] = BOX_NONE;
    *out = w;
    return STARG_OK;
}

void box_worker_free(box_worker *w) {
    if (w == NULL)
        return;
    RELEASE(w->crossing, w->crossing_mark, w->visit, w->stack, w->seed, w->answer_mark, w->answer,
            w);
}

uint64_t box_worker_tests(const box_worker *worker) {
    return worker->tests;
}

uint64_t box_worker_take_work(box_worker *worker) {
    uint64_t work = worker->tests + worker->steps / STEPS;
    worker->tests = worker->steps = 0;
    return work;
}

static bool add_crossing(void *user, uint32_t face) {
    box_worker *w = user;
    w->steps++;
    uint32_t rank = w->scene->rank_of[face];
    if (box_may_cross(w->scene, &w->scene->triangles[rank], &w->box)) {
        w->crossing[w->crossing_count++] = rank;
        w->crossing_mark[rank] = w->question;
    }
    return true;
}

/* Numbers of floods and questions begin anew before they run out. */
static void renew_marks(box_worker *w) {
    if (w->flood < UINT32_MAX / 2 && w->question < UINT32_MAX / 2)
        return;
    memset(w->visit, 0, w->scene->face_count * sizeof *w->visit);
    memset(w->crossing_mark, 0, w->scene->face_count * sizeof *w->crossing_mark);
    memset(w->answer_mark, 0, target_count(w->scene) * sizeof *w->answer_mark);
    w->flood = w->question = w->meeting = 0;
}

static void set_current(box_worker *w, const bvh_box *box) {
    w->current = box;
    for (int k = 0; k < 3; k++)
        w->centre[k] =
            fmin(fmax(0.5 * box->lower[k] + 0.5 * box->upper[k], box->lower[k]), box->upper[k]);
}

static bool holds(const bvh_box *box, const double p[3]) {
    for (int k = 0; k < 3; k++)
        if (p[k] < box->lower[k] || p[k] > box->upper[k])
            return false;
    return true;
}

/* What is outside of the bounding box of all is outside of the solid. False: all of it. */
static bool crop(const bvh_box *all, const bvh_box *box, bvh_box *out) {
    bool any = true;
    for (int k = 0; k < 3; k++) {
        out->lower[k] = fmax(box->lower[k], all->lower[k]);
        out->upper[k] = fmin(box->upper[k], all->upper[k]);
        any = any && out->lower[k] <= out->upper[k];
    }
    return any;
}

/* Outside of a solid there are boxes for which the error bounds do not hold. */
static bool is_in_reach(const box_scene *scene, const bvh_box *box) {
    return scene->solid->ambient == 0 ||
           (holds(&scene->all, box->lower) && holds(&scene->all, box->upper));
}

bool box_enter(box_worker *w, const bvh_box *box) {
    const starg_solid *solid = w->scene->solid;
    w->box = *box;
    w->crossing_count = 0;
    if (!is_in_reach(w->scene, box))
        return true;
    if (solid->ambient == 0 && !crop(&w->scene->tree->nodes[0].box, box, &w->box))
        return false;
    renew_marks(w);
    w->question++;
    set_current(w, &w->box);
    bvh_query_box(w->scene->tree, &w->box, add_crossing, w);
    return w->crossing_count > 0 || starg_solid_contains(solid, w->centre);
}

static bool is_beyond(const bvh_box *box, const double v[3], double range) {
    double nearest[3];
    for (int k = 0; k < 3; k++)
        nearest[k] = fmin(fmax(v[k], box->lower[k]), box->upper[k]);
    return range < 1e100 && compare_distance(nearest, v, range) > 0;
}

/* Is the point in the box, as far as it is known where it lies? */
static bool may_hold(const bvh_box *box, const dyadic_point *v) {
    bool in = true;
    for (int k = 0; k < 3; k++)
        in = in && v->at[k] + v->blur >= box->lower[k] && v->at[k] - v->blur <= box->upper[k];
    return in;
}

/* Why the current box does not see the point between vertices. Where segments to it begin is for
 * the face to say. */
static box_reason_kind ask_point(box_worker *w, const box_question *q, uint32_t target,
                                 bool recorded, uint32_t *seed) {
    const dyadic_point *v = &w->scene->between[target - w->scene->vertex_count].place;
    box_shaft shaft;
    box_reason_kind kind = BOX_OPEN;
    if (is_beyond(w->current, v->at, q->range))
        return BOX_FAR;
    if (may_hold(w->current, v))
        return BOX_OPEN;
    w->point = &w->scene->between[target - w->scene->vertex_count];
    shaft_make(&shaft, v->at, v->blur, w->current);
    if (box_patch_hides(w, &shaft, FLOOD_PATCH, recorded, seed))
        kind = BOX_PATCH;
    else if (box_entry_hides(w, &shaft))
        kind = BOX_ENTRY;
    w->point = NULL;
    return kind;
}

/* Why the current box does not see the vertex or point. */
static box_reason_kind ask_vertex(box_worker *w, const box_question *q, uint32_t vertex,
                                  bool recorded, uint32_t *seed) {
    const double *v = w->scene->points + 3 * (size_t)vertex;
    box_shaft shaft;
    *seed = BOX_NONE;
    w->tests++;
    w->vertex = vertex;
    if (vertex >= w->scene->vertex_count)
        return ask_point(w, q, vertex, recorded, seed);
    if (w->scene->outgoing[vertex] == BOX_NONE)
        return BOX_OUTSIDE;
    if (is_beyond(w->current, v, q->range))
        return BOX_FAR;
    if (holds(w->current, v))
        return BOX_OPEN;
    shaft_make(&shaft, v, 0, w->current);
    if (box_start_hides(w, &shaft))
        return BOX_START;
    if (box_patch_hides(w, &shaft, FLOOD_PATCH, recorded, seed))
        return BOX_PATCH;
    if (box_fold_hides(w, &shaft, recorded, seed))
        return BOX_FOLD;
    return box_entry_hides(w, &shaft) ? BOX_ENTRY : BOX_OPEN;
}

/* The same for the whole box, asked once. */
static box_reason_kind ask_vertex_once(box_worker *w, const box_question *q, uint32_t vertex,
                                       bool recorded, uint32_t *seed) {
    *seed = BOX_NONE;
    if (!recorded && w->answer_mark[vertex] == w->question)
        return w->answer[vertex];
    box_reason_kind kind = ask_vertex(w, q, vertex, recorded, seed);
    w->answer_mark[vertex] = w->question;
    w->answer[vertex] = (uint8_t)kind;
    return kind;
}

static box_reason hidden_by(const box_scene *scene, box_reason_kind kind, uint32_t vertex,
                            uint32_t seed, bool clipped) {
    return (box_reason){kind, vertex, seed == BOX_NONE ? BOX_NONE : scene->tree->order[seed],
                        clipped};
}

/* About some vertices and points of the face: hidden if one of them is. */
static box_reason ask_face(box_worker *w, const box_question *q, uint32_t face,
                           const uint32_t *corner, size_t count, bool recorded) {
    const box_scene *scene = w->scene;
    const box_triangle *t = &scene->triangles[scene->rank_of[face]];
    bvh_box left;
    uint32_t seed;
    clip_result inner = clip(scene, t, &w->box, &left);
    if (inner == CLIP_NOTHING_LEFT)
        return (box_reason){BOX_PLANE, BOX_NONE, BOX_NONE, false};
    for (size_t k = 0; k < count; k++) {
        box_reason_kind kind = ask_vertex_once(w, q, corner[k], recorded, &seed);
        if (kind != BOX_OPEN)
            return hidden_by(scene, kind, corner[k], seed, false);
    }
    box_reason reason = {BOX_OPEN, BOX_NONE, BOX_NONE, false};
    if (inner == CLIP_ALL_LEFT)
        return reason;
    set_current(w, &left);
    for (size_t k = 0; k < count && reason.kind == BOX_OPEN; k++) {
        box_reason_kind kind = ask_vertex(w, q, corner[k], recorded, &seed);
        if (kind != BOX_OPEN)
            reason = hidden_by(scene, kind, corner[k], seed, true);
    }
    set_current(w, &w->box);
    return reason;
}

static box_reason ask_patch(box_worker *w, const box_question *q, uint32_t patch, bool recorded) {
    const box_scene *scene = w->scene;
    const mesh_patches *patches = scene->solid->patches;
    if (patches == NULL)
        return ask_face(w, q, patch, scene->triangles[scene->rank_of[patch]].corner, 3, recorded);
    return ask_face(w, q, patches->face.data[patch],
                    patches->corner.data + patches->corners * patch, patches->corners, recorded);
}

/* A patch that counts from either side is hidden where both sides are; scenes of such faces have no
 * certificates, so that nobody asks for both reasons. */
static box_reason ask_sides(box_worker *w, const box_question *q, uint32_t patch, bool recorded) {
    const starg_solid *solid = w->scene->solid;
    size_t face = solid_patch_face(solid, patch);
    box_reason reason = ask_patch(w, q, patch, recorded);
    if (reason.kind != BOX_OPEN && solid_is_two_sided(solid) &&
        solid->other_side[face] != BOX_NONE) {
        size_t back = solid_first_patch(solid, solid->other_side[face]) + patch -
                      solid_first_patch(solid, face);
        reason = ask_patch(w, q, (uint32_t)back, recorded);
    }
    return reason;
}

static box_reason ask(box_worker *w, const box_question *q, uint32_t target, bool recorded) {
    const box_scene *scene = w->scene;
    uint32_t seed;
    if (q->target == STARG_TARGET_FACES)
        return ask_sides(w, q, target, recorded);
    if (q->target == STARG_TARGET_CORNERS)
        return ask_face(w, q, target / 3,
                        &scene->triangles[scene->rank_of[target / 3]].corner[target % 3], 1,
                        recorded);
    box_reason_kind kind = ask_vertex_once(w, q, target, recorded, &seed);
    return hidden_by(w->scene, kind, target, seed, false);
}

void box_look(box_worker *w, const box_question *q, uint64_t *open, box_reason *reasons) {
    memset(open, 0, starg_bit_words(q->count) * sizeof *open);
    bool reached = is_in_reach(w->scene, &q->box);
    bool outside = !box_enter(w, &q->box);
    for (size_t i = 0; i < q->count; i++) {
        if (q->among != NULL && !starg_bit_test(q->among, i))
            continue;
        box_reason reason = {outside ? BOX_OUTSIDE : BOX_OPEN, BOX_NONE, BOX_NONE, false};
        bool known = q->known != NULL && starg_bit_test(q->known, i);
        if (reached && !outside && !known && w->scene->solid->clear == NULL)
            reason = ask(w, q, q->targets != NULL ? q->targets[i] : (uint32_t)i, reasons != NULL);
        if (reason.kind == BOX_OPEN)
            starg_bit_set(open, i);
        if (reasons != NULL)
            reasons[i] = reason;
    }
}
