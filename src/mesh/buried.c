/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices within matter, where shells overlap, and faces with matter on their inner side, from
 * which they are seen, where shells touch.
 *
 * What is seen of a vertex is seen along a segment that meets no face on its way, so that its end
 * runs in one part of space at the vertex, which must be free. If the faces at the vertex are a
 * single cycle in which no two meet but along their common edge, and no other face touches it,
 * there are two such parts: the faces cut a small sphere about the vertex in one simple curve.
 * Their winding numbers differ by one. A point from which a segment reaches the vertex, met by
 * nothing, tells that of its part, exactly.
 *
 * A face is seen whole by segments to all of its points, which come from its inner side. If there
 * is matter on that side just beside a corner, the face is never seen whole.
 *
 * Stages: the faces at the vertex; are they a cycle without folds; points above and below them
 * until both parts are known. Cost: O(d^2) contacts of triangles for d faces, and a few segments.
 */
#include "mesh/solid.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

enum { MOST = 64 }; /* faces at a vertex */

typedef struct fan {
    const starg_mesh *mesh;
    uint32_t vertex;
    uint32_t faces[MOST];
    size_t count;
} fan;

static const double *at(const fan *f, uint32_t vertex) {
    return f->mesh->vertices + 3 * (size_t)vertex;
}

/* ---- the faces ---- */

/* Which corner of a face the vertex is; 3: none. */
static int corner_of(const fan *f, uint32_t face) {
    const uint32_t *c = f->mesh->faces + 3 * (size_t)face;
    return c[0] == f->vertex ? 0 : c[1] == f->vertex ? 1 : c[2] == f->vertex ? 2 : 3;
}

/* False: another face touches the vertex, or there are too many, or one without area. */
static bool take_face(void *user, uint32_t face) {
    fan *f = user;
    const uint32_t *c = f->mesh->faces + 3 * (size_t)face;
    if (corner_of(f, face) == 3)
        return !point_on_triangle(at(f, f->vertex), at(f, c[0]), at(f, c[1]), at(f, c[2]));
    if (f->count == MOST || collinear(at(f, c[0]), at(f, c[1]), at(f, c[2])))
        return false;
    f->faces[f->count++] = face;
    return true;
}

/* The corner of a face `step` after the vertex. */
static uint32_t after(const fan *f, size_t i, int step) {
    return f->mesh
        ->faces[3 * (size_t)f->faces[i] + (size_t)((corner_of(f, f->faces[i]) + step) % 3)];
}

/* Do all faces follow each other around the vertex, once? */
static bool is_cycle(const fan *f) {
    size_t place = 0, passed = 0;
    do {
        size_t next = 0;
        while (next < f->count && after(f, next, 1) != after(f, place, 2))
            next++;
        if (next == f->count)
            return false;
        place = next;
    } while (++passed < f->count && place != 0);
    return f->count >= 3 && passed == f->count && place == 0;
}

static bool is_unfolded(const fan *f) {
    for (size_t i = 0; i < f->count; i++)
        for (size_t k = 0; k < i; k++)
            if (faces_contact(f->mesh->vertices, f->mesh->faces + 3 * (size_t)f->faces[i],
                              f->mesh->faces + 3 * (size_t)f->faces[k]) != TRIANGLES_SHARE)
                return false;
    return true;
}

/* ---- the parts of space ---- */

typedef struct sight {
    const starg_mesh *mesh;
    const bvh *tree;
    const double *from, *to;
} sight;

static bool passes(void *user, size_t rank) {
    const sight *s = user;
    const uint32_t *c = s->mesh->faces + 3 * (size_t)s->tree->order[rank];
    const double *v = s->mesh->vertices;
    return !segment_meets_triangle(s->from, s->to, v + 3 * (size_t)c[0], v + 3 * (size_t)c[1],
                                   v + 3 * (size_t)c[2]);
}

/* A direction beside face i: to its middle, off its plane by `slope`. */
static void aim_beside(const fan *f, size_t i, double slope, double d[3]) {
    const double *v = at(f, f->vertex), *a = at(f, after(f, i, 1)), *b = at(f, after(f, i, 2));
    double normal[3], u[3], w[3];
    vec3_subtract(a, v, u);
    vec3_subtract(b, v, w);
    vec3_cross(u, w, normal);
    for (int k = 0; k < 3; k++)
        d[k] = (u[k] + w[k]) / 3;
    double size = vec3_length(normal), reach = slope * vec3_length(d);
    for (int k = 0; k < 3; k++)
        d[k] += (size > 0 ? reach / size : 0) * normal[k];
}

/* A direction amid all faces, as into a needle, or away from them. */
static void aim_amid(const fan *f, double sign, double d[3]) {
    double middle[3], length = 0;
    d[0] = d[1] = d[2] = 0;
    for (size_t i = 0; i < f->count; i++) {
        aim_beside(f, i, 0, middle);
        length = fmax(length, vec3_length(middle));
        for (int k = 0; k < 3; k++)
            d[k] += middle[k] / fmax(vec3_length(middle), 1e-300);
    }
    double size = vec3_length(d);
    for (int k = 0; k < 3 && size > 0; k++)
        d[k] *= sign * length / size;
}

/* The winding number in a direction, if nothing is between there and the vertex. */
static bool look(const starg_solid *solid, const fan *f, const double d[3], double share,
                 int *winding) {
    const double *v = at(f, f->vertex);
    double p[3];
    bool on_surface;
    for (int k = 0; k < 3; k++)
        p[k] = v[k] + share * d[k];
    sight s = {solid->mesh, solid->tree, p, v};
    if ((p[0] == v[0] && p[1] == v[1] && p[2] == v[2]) ||
        !bvh_query_segment(solid->tree, p, v, passes, &s))
        return false;
    *winding = bvh_winding(solid->tree, p, &on_surface);
    return !on_surface;
}

/* Direction number i, on either side in turn. */
static void aim(const fan *f, size_t i, double slope, double d[3]) {
    double sign = i % 2 == 0 ? 1 : -1;
    if (i / 2 == f->count)
        aim_amid(f, sign, d);
    else
        aim_beside(f, i / 2, sign * slope, d);
}

/* The larger winding number of the two parts at the vertex; false: not both were met. */
static bool find_winding(const starg_solid *solid, const fan *f, int *larger) {
    int found[2] = {0, 0};
    bool any = false;
    for (double share = 0.5; share > 1e-4; share *= 0.125)
        for (double slope = 0.3; slope > 1e-3;
             slope *= 0.1) /* in thin corners only flat ones fit */
            for (size_t i = 0; i < 2 * (f->count + 1); i++) {
                double d[3];
                int winding;
                aim(f, i, slope, d);
                if (!look(solid, f, d, share, &winding))
                    continue;
                found[0] = any && found[0] < winding ? found[0] : winding;
                found[1] = any && found[1] > winding ? found[1] : winding;
                any = true;
                if (found[0] < found[1]) {
                    *larger = found[1];
                    return true;
                }
            }
    return false;
}

bool solid_buries(const starg_solid *solid, uint32_t vertex) {
    fan f = {.mesh = solid->mesh, .vertex = vertex};
    const double *v = at(&f, vertex);
    const bvh_box point = {{v[0], v[1], v[2]}, {v[0], v[1], v[2]}};
    int winding;
    return solid->clear == NULL && bvh_query_box(solid->tree, &point, take_face, &f) &&
           is_cycle(&f) && is_unfolded(&f) && find_winding(solid, &f, &winding) &&
           winding + solid->ambient <= 0;
}

/* ---- faces ---- */

bool solid_hides(const starg_solid *solid, uint32_t face) {
    const uint32_t *c = solid->mesh->faces + 3 * (size_t)face;
    const double *v = solid->mesh->vertices;
    bool from_behind = solid_is_two_sided(solid) && solid->other_side[face] != TOPOLOGY_NONE;
    if (solid->clear != NULL) /* views go through matter behind glass */
        return false;
    bool has_area = !collinear(v + 3 * (size_t)c[0], v + 3 * (size_t)c[1], v + 3 * (size_t)c[2]);
    for (int k = 0; k < 3; k++)
        if (solid_buries(solid, c[k]) ||
            (has_area && !from_behind &&
             bvh_winding_behind(solid->tree, face, k) + solid->ambient <= 0))
            return true;
    return false;
}
