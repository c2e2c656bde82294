/* SPDX-License-Identifier: Apache-2.0 */
/* Where is a surface embedded: which faces have area and meet others only in shared corners and
 * edges, where the faces at each vertex form one fan? And on which of them is the outer side surely
 * outside of the solid?
 *
 * Two triangles have a common point exactly if an edge of one meets the other. If they share one
 * corner, any other common point lies on a common segment from that corner, which extends to the
 * opposite edge of one of them; if they share an edge, they have more in common only if coplanar
 * and on the same side of the edge. All by exact signs.
 *
 * The winding number beside such faces is the same on both sides of an edge between two of them,
 * since nothing else meets the edge. So it is found for one face of each connected part, by a short
 * segment across it that meets no other face. Cost: O(n log n) for ordinary surfaces.
 *
 * A surface that touches itself in vertices and edges, at equal positions, may still bound: where
 * no face meets another elsewhere, the winding number just before it is the same everywhere, and is
 * found for each by such a segment. */
#include <math.h>

#include "core/parallel.h"
#include "verify/everywhere.h"

static const char STAGE[] = "verify";

static bool segment_meets(const double p[3], const double q[3], const double *const t[3]) {
    return verify_on_triangle(p, t) || verify_on_triangle(q, t) || verify_blocks(p, q, t);
}

/* An axis along which the triangle's projection has area, or -1. */
static int broad_axis(const double *const t[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (verify_turn(t[0], t[1], t[2], axis) != 0)
            return axis;
    return -1;
}

static bool at_one_place(const double *p, const double *q) {
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Number of corners of f shared with g, by_place: or at the same position: *own and *other are the
 * opposite corners if two are shared, or the shared ones if one is. */
static int shared_corners(const verify_surface *surface, uint32_t f, uint32_t g, bool by_place,
                          int *own, int *other) {
    int count = 0, own_sum = 0, other_sum = 0;
    const uint32_t *s = surface->faces + 3 * (size_t)f, *t = surface->faces + 3 * (size_t)g;
    const double *v = surface->vertices;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (s[i] == t[j] ||
                (by_place && at_one_place(v + 3 * (size_t)s[i], v + 3 * (size_t)t[j]))) {
                count++;
                own_sum += i;
                other_sum += j;
            }
    *own = count == 2 ? 3 - own_sum : own_sum;
    *other = count == 2 ? 3 - other_sum : other_sum;
    return count;
}

static bool is_contact(const verify_surface *surface, uint32_t f, uint32_t g, bool by_place) {
    const double *s[3], *t[3];
    int own, other;
    int shared = shared_corners(surface, f, g, by_place, &own, &other);
    verify_corners(surface, f, s);
    verify_corners(surface, g, t);
    if (shared == 1)
        return segment_meets(s[(own + 1) % 3], s[(own + 2) % 3], t) ||
               segment_meets(t[(other + 1) % 3], t[(other + 2) % 3], s);
    if (shared == 2) {
        int axis = broad_axis(s);
        const double *a = s[(own + 1) % 3], *b = s[(own + 2) % 3];
        return verify_side(s[0], s[1], s[2], t[other]) == 0 &&
               verify_turn(a, b, s[own], axis) * verify_turn(a, b, t[other], axis) >= 0;
    }
    for (int i = 0; shared == 0 && i < 3; i++)
        if (segment_meets(s[i], s[(i + 1) % 3], t) || segment_meets(t[i], t[(i + 1) % 3], s))
            return true;
    return shared == 3;
}

bool verify_faces_touch(const verify_surface *surface, uint32_t f, uint32_t g) {
    return is_contact(surface, f, g, true);
}

bool verify_faces_share(const verify_surface *surface, uint32_t f, uint32_t g) {
    int own, other;
    return shared_corners(surface, f, g, true, &own, &other) > 0;
}

typedef struct search {
    const verify_scene *scene;
    bool by_place;
    uint8_t *sound; /* by face */
} search;

typedef struct one_face {
    const verify_surface *surface;
    uint32_t face;
    bool by_place;
} one_face;

static bool is_clear_of(void *data, uint32_t other) {
    const one_face *own = data;
    return other == own->face || !is_contact(own->surface, own->face, other, own->by_place);
}

static starg_status examine_face(starg_context *context, void *shared, void *scratch, size_t f) {
    const search *own = shared;
    const double *t[3];
    double lower[3], upper[3];
    one_face one = {own->scene->surface, (uint32_t)f, own->by_place};
    (void)context;
    (void)scratch;
    verify_corners(one.surface, f, t);
    for (int k = 0; k < 3; k++) {
        lower[k] = upper[k] = t[0][k];
        for (int i = 1; i < 3; i++) {
            lower[k] = t[i][k] < lower[k] ? t[i][k] : lower[k];
            upper[k] = t[i][k] > upper[k] ? t[i][k] : upper[k];
        }
    }
    own->sound[f] =
        broad_axis(t) >= 0 && verify_tree_visit(own->scene->tree, lower, upper, is_clear_of, &one);
    return STARG_OK;
}

/* Faces at a vertex where they form more than one fan are not sound: does a walk around from one
 * edge reach all? */
static void drop_fans(const verify_scene *scene, uint32_t *count, uint8_t *sound) {
    const verify_surface *surface = scene->surface;
    for (size_t e = 0; e < 3 * surface->face_count; e++)
        count[surface->faces[e]]++;
    for (size_t v = 0; v < surface->vertex_count; v++) {
        uint32_t first = scene->outgoing[v], e = first, passed = 0;
        if (first == UINT32_MAX)
            continue;
        do {
            passed++;
            e = scene->twin[e % 3 == 0 ? e + 2 : e - 1];
        } while (e != first);
        count[v] = passed == count[v];
    }
    for (size_t e = 0; e < 3 * surface->face_count; e++)
        if (!count[surface->faces[e]])
            sound[e / 3] = 0;
}

/* ---- what is beside them ---- */

typedef struct needle {
    const verify_surface *surface;
    uint32_t face;
    double inner[3], outer[3];
} needle;

static bool is_missed(void *data, uint32_t other) {
    const needle *own = data;
    const double *t[3];
    verify_corners(own->surface, other, t);
    return other == own->face || !segment_meets(own->inner, own->outer, t);
}

/* A segment across the face, as long as a share of it, that meets no other one. */
static bool find_needle(const verify_scene *scene, uint32_t face, double share, needle *out) {
    const double *t[3];
    double u[3], v[3], normal[3], length = 0, size = 0;
    verify_corners(scene->surface, face, t);
    *out = (needle){.surface = scene->surface, .face = face};
    for (int k = 0; k < 3; k++) {
        u[k] = t[1][k] - t[0][k];
        v[k] = t[2][k] - t[0][k];
        size = fmax(size, fmax(fabs(u[k]), fabs(v[k])));
    }
    for (int k = 0; k < 3; k++) {
        normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        length = fmax(length, fabs(normal[k]));
    }
    for (int k = 0; k < 3; k++) {
        double middle = (t[0][k] + t[1][k] + t[2][k]) / 3, step = share * size * normal[k] / length;
        out->inner[k] = middle - step;
        out->outer[k] = middle + step;
        if (!(fabs(out->inner[k]) < 1e100 && fabs(out->outer[k]) < 1e100))
            return false;
    }
    return verify_side(t[0], t[1], t[2], out->inner) > 0 &&
           verify_side(t[0], t[1], t[2], out->outer) < 0 &&
           segment_meets(out->inner, out->outer, t) &&
           verify_tree_follow(scene->tree, out->inner, out->outer, is_missed, out);
}

/* Faces whose outer side is not surely outside of the solid are not sound. `part` has room for all
 * faces. */
static void drop_inner(const verify_scene *scene, uint8_t *seen, uint32_t *part, uint8_t *sound) {
    for (uint32_t f = 0; f < scene->surface->face_count; f++) {
        size_t count = 0;
        bool outside = false, on_surface = false;
        needle found;
        if (seen[f] || !sound[f])
            continue;
        part[count++] = f;
        seen[f] = 1;
        for (size_t i = 0; i < count; i++)
            for (size_t k = 0; k < 3; k++) {
                uint32_t next = scene->twin[3 * (size_t)part[i] + k] / 3;
                if (sound[next] && !seen[next]) {
                    seen[next] = 1;
                    part[count++] = next;
                }
            }
        for (size_t i = 0; i < count; i++)
            if (find_needle(scene, part[i], 0x1p-9, &found)) {
                outside = verify_tree_winding(scene->tree, found.outer, &on_surface) < 1;
                break;
            }
        for (size_t i = 0; i < count && (!outside || on_surface); i++)
            sound[part[i]] = 0;
    }
}

starg_status verify_find_sound(const verify_scene *scene, uint8_t *sound, bool *embedded) {
    const verify_surface *surface = scene->surface;
    starg_context *context = surface->context;
    search own = {scene, false, sound};
    SCOPED uint32_t *count = NULL, *part = NULL;
    SCOPED uint8_t *seen = NULL;
    size_t faces = surface->face_count;
    NEW_ZERO(context, STAGE, count, surface->vertex_count);
    NEW(context, STAGE, part, faces);
    NEW_ZERO(context, STAGE, seen, faces);
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = faces, .shared = &own, .item = examine_face, .silent = true};
    TRY(starg_parallel_for(context, &loop));
    drop_fans(scene, count, sound);
    *embedded = true;
    for (size_t f = 0; f < faces; f++)
        *embedded = *embedded && sound[f];
    drop_inner(scene, seen, part, sound);
    return STARG_OK;
}

/* ---- surfaces that touch themselves ---- */

/* Is the outer side of the face surely outside of the solid, at its middle? */
static bool is_outside_before(const verify_scene *scene, uint32_t face) {
    needle found;
    bool on_surface;
    for (double share = 0x1p-9; share > 0x1p-40; share /= 16)
        if (find_needle(scene, face, share, &found))
            return verify_tree_winding(scene->tree, found.outer, &on_surface) < 1 && !on_surface;
    return false;
}

static starg_status judge_face(starg_context *context, void *shared, void *scratch, size_t f) {
    const search *own = shared;
    starg_status status = examine_face(context, shared, scratch, f);
    own->sound[f] = own->sound[f] && is_outside_before(own->scene, (uint32_t)f);
    return status;
}

starg_status verify_find_bounding(const verify_scene *scene, bool *bounding) {
    starg_status status = STARG_OK;
    starg_context *context = scene->surface->context;
    search own = {scene, true, NULL};
    STARG_NEW_ZERO(context, STAGE, own.sound, scene->surface->face_count);
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = scene->surface->face_count,
                                      .shared = &own,
                                      .item = judge_face,
                                      .silent = true};
    STARG_TRY(starg_parallel_for(context, &loop));
    *bounding = true;
    for (size_t f = 0; f < scene->surface->face_count; f++)
        *bounding = *bounding && own.sound[f];
done:
    starg_release(context, own.sound);
    return status;
}
