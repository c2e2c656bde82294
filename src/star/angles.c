/* SPDX-License-Identifier: Apache-2.0 */
/* Dihedral angles of tetrahedra, and which of the small ones are the model's.
 *
 * The angle at an edge e between faces with the normals m and n (as long as their areas twice) and
 * the determinant D of the tetrahedron has the sine D |e| / (|m| |n|) and the cosine
 * -m . n / (|m| |n|): for flat tetrahedra D is more exact than a product of normals.
 *
 * A tetrahedron over a whole face of the model cannot be better than that face: if no dihedral
 * angle of it is smaller than the smallest angle of the face, its angles are the model's. All
 * others are made by where cuts and guards are.
 *
 * Cost: linear, and sorting of the angles and the faces. Rounded; decides nothing. */
#include "star/piece_faces.h"

#include <stdlib.h>

#include "geometry/vec3.h"

static const char STAGE[] = "pieces";
static const double DEGREES = 57.295779513082323;

/* ---- angles ---- */

/* Corners relative to the first, in units of the mesh. */
static void gather(const starg_tetmesh *mesh, size_t tetrahedron, int exponent, double p[4][3]) {
    const double *origin = tetmesh_corner(mesh, tetrahedron, 0);
    for (int i = 0; i < 4; i++) {
        vec3_subtract(tetmesh_corner(mesh, tetrahedron, i), origin, p[i]);
        for (int k = 0; k < 3; k++)
            p[i][k] = ldexp(p[i][k], -exponent);
    }
}

/* Outward, for a positive tetrahedron; of the face opposite of corner i. */
static void normal_of(const double p[4][3], int i, double out[3]) {
    static const int corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    double u[3], v[3];
    vec3_subtract(p[corners[i][1]], p[corners[i][0]], u);
    vec3_subtract(p[corners[i][2]], p[corners[i][0]], v);
    vec3_cross(u, v, out);
}

double angles_smallest(const double p[4][3]) {
    double normal[4][3], least[2] = {0, 0}; /* a sine and a cosine, times some length */
    double determinant = vec3_triple(p[1], p[2], p[3]);
    for (int i = 0; i < 4; i++)
        normal_of(p, i, normal[i]);
    for (int i = 0; i < 4; i++)
        for (int k = i + 1; k < 4; k++) {
            /* the edge that the faces opposite of i and k share joins the other two corners */
            int a = i == 0 ? (k == 1 ? 2 : 1) : 0, b = 6 - i - k - a;
            double sine = fabs(determinant) * vec3_distance(p[a], p[b]);
            double cosine = -vec3_dot(normal[i], normal[k]);
            if (k == 1 || sine * least[1] < cosine * least[0]) {
                least[0] = sine;
                least[1] = cosine;
            }
        }
    return DEGREES * atan2(least[0], least[1]);
}

static double smallest_dihedral(const starg_tetmesh *mesh, size_t tetrahedron, int exponent) {
    double p[4][3];
    gather(mesh, tetrahedron, exponent, p);
    return angles_smallest((const double(*)[3])p);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

starg_status angles_measure(starg_context *context, starg_decomposition *d) {
    SCOPED double *angles = NULL;
    size_t count = d->mesh->count;
    int exponent = tetmesh_exponent(d->mesh);
    NEW(context, STAGE, angles, count);
    for (size_t t = 0; t < count; t++)
        angles[t] = smallest_dihedral(d->mesh, t, exponent);
    qsort(angles, count, sizeof *angles, ascending);
    d->smallest_angle = angles[0];
    d->median_angle = angles[count / 2];
    d->smallest_angle_made = -1;
    return STARG_OK;
}

/* ---- faces of the model ---- */

/* A face by the positions of its corners in their order. */
typedef struct placed_face {
    double corner[9];
} placed_face;

static int compare_points(const double *a, const double *b) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_corners(const void *a, const void *b) {
    return compare_points(a, b);
}

static int compare_faces(const void *x, const void *y) {
    const placed_face *a = x, *b = y;
    for (int i = 0; i < 9; i += 3) {
        int order = compare_points(a->corner + i, b->corner + i);
        if (order != 0)
            return order;
    }
    return 0;
}

static placed_face place_face(const double *vertices, const uint32_t corners[3]) {
    placed_face face;
    for (int i = 0; i < 3; i++)
        vec3_copy(vertices + 3 * (size_t)corners[i], face.corner + 3 * i);
    qsort(face.corner, 3, 3 * sizeof(double), compare_corners);
    return face;
}

/* The smallest angle of a triangle, in degrees. */
static double smallest_plane_angle(const placed_face *face) {
    double least = 180;
    for (int i = 0; i < 3; i++) {
        double u[3], v[3], cross[3];
        vec3_subtract(face->corner + 3 * ((i + 1) % 3), face->corner + 3 * i, u);
        vec3_subtract(face->corner + 3 * ((i + 2) % 3), face->corner + 3 * i, v);
        double a = vec3_length(u), b = vec3_length(v);
        if (!(a > 0 && b > 0))
            return 0;
        for (int k = 0; k < 3; k++) {
            u[k] /= a;
            v[k] /= b;
        }
        vec3_cross(u, v, cross);
        least = fmin(least, DEGREES * atan2(vec3_length(cross), vec3_dot(u, v)));
    }
    return least;
}

/* Has the tetrahedron a whole face of the model that is no better than itself? */
static bool is_forced(const starg_decomposition *d, const placed_face *faces, size_t count,
                      size_t tetrahedron, double angle) {
    for (size_t f = 4 * tetrahedron; f < 4 * tetrahedron + 4; f++) {
        uint32_t corners[3];
        if (d->mesh->neighbours[f] != STARG_TETMESH_NONE)
            continue;
        piece_face_corners(d->mesh, f, corners);
        const placed_face own = place_face(d->mesh->vertices, corners);
        if (angle >= smallest_plane_angle(&own) &&
            bsearch(&own, faces, count, sizeof *faces, compare_faces) != NULL)
            return true;
    }
    return false;
}

starg_status angles_tell_apart(starg_context *context, const starg_mesh *model,
                               starg_decomposition *d) {
    SCOPED placed_face *faces = NULL;
    double least = 180;
    int exponent = tetmesh_exponent(d->mesh);
    NEW(context, STAGE, faces, model->face_count);
    for (size_t f = 0; f < model->face_count; f++)
        faces[f] = place_face(model->vertices, model->faces + 3 * f);
    qsort(faces, model->face_count, sizeof *faces, compare_faces);
    for (size_t t = 0; t < d->mesh->count; t++) {
        double angle = smallest_dihedral(d->mesh, t, exponent);
        if (angle < least && !is_forced(d, faces, model->face_count, t, angle))
            least = angle;
    }
    d->smallest_angle_made = least;
    return STARG_OK;
}
