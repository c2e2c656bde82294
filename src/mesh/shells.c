/* SPDX-License-Identifier: Apache-2.0 */
/* Which shells lie in which.
 *
 * Problem: a shell lies in another if that has a nonzero winding number about it. Shells may touch
 * in corners, edges and parts of faces; one that crosses another, perhaps along edges alone, lies
 * in none.
 *
 * Method: winding numbers are counted along a vertical line, exactly, from points just beside a
 * corner, within a face (bvh_crossing_beside), about all shells but those a face of which overlaps
 * this one there (bvh_covers_beside). Shells without contacts are asked at one point, others also
 * at all corners of faces in contact: there a shell that crosses another along edges has points on
 * both sides. A shell does not lie in one that covers it all. Which way a shell faces is the sign
 * of its volume, in integers if doubles do not tell.
 *
 * Cost: O(log n) a shell and a contact, if few shells lie around one. */
#include "mesh/examine.h"

#include <float.h>
#include <limits.h>
#include <math.h>

#include "geometry/exact.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const char STAGE[] = "check";

/* What is known of another shell, about the one in question. */
typedef struct other_shell {
    bool listed;
    bool covers;    /* the point is on it */
    size_t covered; /* points before that were on it */
    int winding;    /* about the point */
    int known;      /* about points before that were not on it */
} other_shell;

typedef struct nesting {
    const starg_mesh *mesh;
    const mesh_topology *topology;
    const bvh *tree;
    int exponent;        /* starg_mesh_exponent */
    bvh_box *boxes;      /* by shell */
    other_shell *others; /* by shell; all zero but for those in `list` */
    uint32_t *list;
    size_t count;
    uint32_t own;
    size_t asked;                 /* points before */
    bool covered;                 /* so far each has been on another shell */
    const double *p[3];           /* the point: beside p[0], towards p[1], a little to p[2] */
    STARG_ARRAY(uint32_t) around; /* pairs: a cavity, and a shell that it lies in */
} nesting;

static const double *corner(const nesting *n, size_t face, size_t k) {
    return n->mesh->vertices + 3 * (size_t)n->mesh->faces[3 * face + k % 3];
}

static bool has_area(const nesting *n, size_t face) {
    return !collinear(corner(n, face, 0), corner(n, face, 1), corner(n, face, 2));
}

/* Shells whose boxes do not hold the point have no winding number about it. */
static bool count_crossing(void *user, uint32_t triangle) {
    nesting *n = user;
    uint32_t name = n->topology->component[triangle];
    const double *p = n->p[0];
    const bvh_box point = {{p[0], p[1], p[2]}, {p[0], p[1], p[2]}};
    if (name == n->own || !bvh_boxes_meet(&n->boxes[name], &point))
        return true;
    other_shell *other = &n->others[name];
    int crossing = bvh_crossing_beside(n->tree, triangle, n->p);
    bool covers = bvh_covers_beside(n->tree, triangle, n->p) != 0;
    if (!other->listed && (crossing != 0 || covers)) {
        other->listed = true;
        n->list[n->count++] = name;
    }
    other->winding += crossing;
    other->covers = other->covers || covers;
    return true;
}

/* Compares the winding numbers about a point of a shell with those about others of its points. */
static void ask(nesting *n, mesh_shell *shells, size_t face, size_t k) {
    for (size_t i = 0; i < 3; i++)
        n->p[i] = corner(n, face, k + i);
    const double *p = n->p[0];
    const bvh_box line = {{p[0], p[1], p[2]}, {p[0], p[1], INFINITY}};
    bool covered = false;
    bvh_query_box(n->tree, &line, count_crossing, n);
    for (size_t i = 0; i < n->count; i++) {
        other_shell *other = &n->others[n->list[i]];
        if (!other->covers && other->covered < n->asked && other->known != other->winding)
            shells[n->own].crossed = shells[n->list[i]].crossed = true;
        other->known = other->covers ? other->known : other->winding;
        other->covered += other->covers;
        covered = covered || other->covers;
        other->winding = 0;
        other->covers = false;
    }
    n->asked++;
    n->covered = n->covered && covered;
}

/* Asks about all others, and forgets. */
static starg_status nest(starg_context *context, nesting *n, const uint32_t *faces, size_t count,
                         const uint8_t *touching, mesh_shell *shells) {
    mesh_shell *own = &shells[n->own];
    size_t listed = n->around.count;
    n->asked = 0;
    n->covered = true;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3 && (touching[faces[i]] || n->covered) && has_area(n, faces[i]);
             k++)
            ask(n, shells, faces[i], k);
    for (; n->count > 0; n->count--) {
        other_shell *other = &n->others[n->list[n->count - 1]];
        int winding = other->known;
        own->depth += winding != 0;
        own->around += winding;
        *other = (other_shell){0};
        if (winding == 0)
            continue;
        PUSH(context, STAGE, &n->around, n->own);
        PUSH(context, STAGE, &n->around, n->list[n->count - 1]);
    }
    own->cavity = own->depth % 2 == 1;
    if (!own->cavity)
        n->around.count = listed;
    return STARG_OK;
}

/* The shells around a cavity lie in each other: the innermost one is the deepest. */
static void find_innermost(const nesting *n, mesh_shell *shells) {
    for (size_t c = 0; c < n->topology->component_count; c++)
        shells[c].within = UINT32_MAX;
    for (size_t i = 0; i < n->around.count; i += 2) {
        mesh_shell *own = &shells[n->around.data[i]];
        uint32_t other = n->around.data[i + 1];
        if (own->cavity &&
            (own->within == UINT32_MAX || shells[other].depth > shells[own->within].depth))
            own->within = other;
    }
}

static starg_status find_boxes(starg_context *context, nesting *n) {
    const bvh_box nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    NEW(context, STAGE, n->boxes, n->topology->component_count);
    for (size_t c = 0; c < n->topology->component_count; c++)
        n->boxes[c] = nothing;
    for (size_t i = 0; i < 3 * n->mesh->face_count; i++) {
        bvh_box *own = &n->boxes[n->topology->component[i / 3]];
        for (size_t k = 0; k < 3; k++) {
            own->lower[k] = fmin(own->lower[k], corner(n, i / 3, i % 3)[k]);
            own->upper[k] = fmax(own->upper[k], corner(n, i / 3, i % 3)[k]);
        }
    }
    return STARG_OK;
}

/* The faces shell by shell; those of shell c start at start[c]. */
static void sort_faces(const mesh_topology *topology, size_t *start, uint32_t *sorted) {
    for (size_t f = 0; f < topology->face_count; f++)
        start[topology->component[f] + 1]++;
    for (size_t c = 0; c < topology->component_count; c++)
        start[c + 1] += start[c];
    for (size_t f = topology->face_count; f-- > 0;)
        sorted[--start[topology->component[f] + 1]] = (uint32_t)f;
}

static void place_face(const nesting *n, uint32_t face, double p[9]) {
    for (size_t k = 0; k < 3; k++)
        vec3_copy(corner(n, face, k), p + 3 * k);
}

/* The exact sign of the volume within some faces. */
static int sign_of_volume(const nesting *n, const uint32_t *faces, size_t count) {
    exact sums[2] = {{0}}, part, x[9];
    double p[9];
    int bits, scale = INT_MAX;
    for (size_t i = 0; i < count; i++) {
        place_face(n, faces[i], p);
        int own = exact_scale(p, 9, &bits);
        scale = own < scale ? own : scale;
    }
    for (size_t i = 0; i < count; i++) {
        place_face(n, faces[i], p);
        for (int k = 0; k < 9; k++)
            exact_set(&x[k], p[k], scale);
        exact_determinant(&part, x, x + 3, x + 6);
        exact_add(&sums[(i + 1) % 2], &sums[i % 2], &part);
    }
    return sums[count % 2].sign;
}

/* The volume of a shell, about its first corner. The sign is exact: a flat shell has none. */
static void sum_volume(const nesting *n, const uint32_t *faces, size_t count, mesh_shell *own) {
    const double *base = corner(n, faces[0], 0);
    double sum = 0, size = 0, p[9];
    for (size_t i = 0; i < count; i++) {
        place_face(n, faces[i], p);
        for (int k = 0; k < 9; k++)
            p[k] = ldexp(p[k] - base[k % 3], -n->exponent);
        sum += vec3_triple(p, p + 3, p + 6);
        size += vec3_length(p) * vec3_length(p + 3) * vec3_length(p + 6);
    }
    if (!(fabs(sum) > ((double)count + 32) * DBL_EPSILON * size))
        sum = sign_of_volume(n, faces, count) * fmax(fabs(sum), DBL_MIN);
    own->volume = sum / 6;
    own->first_face = faces[0];
}

starg_status shells_classify(starg_context *context, const starg_mesh *mesh,
                             const mesh_topology *topology, const bvh *tree,
                             const uint8_t *touching, mesh_shell *shells) {
    starg_status status = STARG_OK;
    nesting n = {
        .mesh = mesh, .topology = topology, .tree = tree, .exponent = starg_mesh_exponent(mesh)};
    size_t count = topology->component_count, *start = NULL;
    uint32_t *sorted = NULL;
    STARG_TRY(find_boxes(context, &n));
    STARG_NEW_ZERO(context, STAGE, n.others, count);
    STARG_NEW(context, STAGE, n.list, count);
    STARG_NEW_ZERO(context, STAGE, start, count + 2);
    STARG_NEW(context, STAGE, sorted, mesh->face_count);
    sort_faces(topology, start, sorted);
    for (size_t c = 0; c < count; c++) {
        n.own = (uint32_t)c;
        size_t end = c + 1 < count ? start[c + 2] : mesh->face_count;
        sum_volume(&n, sorted + start[c + 1], end - start[c + 1], &shells[c]);
        STARG_TRY(nest(context, &n, sorted + start[c + 1], end - start[c + 1], touching, shells));
        STARG_TRY(starg_check_cancel(context, STAGE));
    }
    for (size_t c = 0; c < count; c++) {
        mesh_shell *own = &shells[c];
        if (own->crossed)
            own->around = own->cavity = 0;
        own->turn = own->cavity ? own->volume > 0 : own->volume < 0;
    }
    find_innermost(&n, shells);
done:
    RELEASE(n.around.data, n.boxes, n.others, n.list, start, sorted);
    return status;
}
