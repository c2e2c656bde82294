/* SPDX-License-Identifier: Apache-2.0 */
/* Flatness of tetrahedra: least height over longest edge, 0.816 for the regular one and 0 without
 * volume. Rounded; decides nothing. */
#include <math.h>

#include "geometry/vec3.h"
#include "tetra/tetmesh.h"

static double flatness(const starg_tetmesh *mesh, size_t tetrahedron) {
    const double *p[4];
    double longest = 0, largest = 0, edge[3][3];
    for (int k = 0; k < 4; k++)
        p[k] = tetmesh_corner(mesh, tetrahedron, k);
    for (int i = 0; i < 4; i++)
        for (int k = i + 1; k < 4; k++)
            longest = fmax(longest, vec3_distance(p[i], p[k]));
    if (longest == 0)
        return 0;
    /* in units of the longest edge, to avoid overflow and underflow */
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            edge[k][c] = (p[k + 1][c] - p[0][c]) / longest;
    double volume = fabs(vec3_triple(edge[0], edge[1], edge[2])) / 6;
    const double origin[3] = {0, 0, 0};
    largest = fmax(vec3_triangle_area(origin, edge[0], edge[1]),
                   vec3_triangle_area(origin, edge[1], edge[2]));
    largest = fmax(largest, fmax(vec3_triangle_area(origin, edge[2], edge[0]),
                                 vec3_triangle_area(edge[0], edge[1], edge[2])));
    return largest > 0 ? 3 * volume / largest : 0;
}

double tetmesh_flattest(const starg_tetmesh *mesh) {
    double least = 1;
    for (size_t t = 0; t < mesh->count; t++)
        least = fmin(least, flatness(mesh, t));
    return least;
}
