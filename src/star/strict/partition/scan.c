/* SPDX-License-Identifier: Apache-2.0 */
/* Which of many half-spaces a point is least inside of: the loop that the search for cuts spends
 * its time in. Written so that compilers make vector code of it (core/versions.h). */
#include "star/strict/partition/scan.h"

#include <math.h>

#include "core/versions.h"

enum { LANES = 8 };

STARG_SEVERAL_VERSIONS
static size_t scan(const double *block, const double *lowest, double bound, const double point[3],
                   double room) {
    const double *nx = block, *ny = nx + SCAN_BLOCK, *nz = ny + SCAN_BLOCK, *b = nz + SCAN_BLOCK;
    const double x = point[0], y = point[1], z = point[2];
    double inside[SCAN_BLOCK], least[LANES];
    for (int i = 0; i < SCAN_BLOCK; i++)
        inside[i] = b[i] - (nx[i] * x + ny[i] * y + nz[i] * z);
    for (int i = 0; i < SCAN_BLOCK; i++)
        inside[i] = lowest[i] < bound ? inside[i] : INFINITY;
    for (int k = 0; k < LANES; k++)
        least[k] = inside[k];
    for (int i = LANES; i < SCAN_BLOCK; i += LANES)
        for (int k = 0; k < LANES; k++)
            least[k] = inside[i + k] < least[k] ? inside[i + k] : least[k];
    double worst = least[0];
    for (int k = 1; k < LANES; k++)
        worst = least[k] < worst ? least[k] : worst;
    if (!(worst < room))
        return SCAN_BLOCK;
    size_t at = 0;
    while (inside[at] != worst)
        at++;
    return at;
}

size_t scan_block(const double *block, const double *lowest, double bound, const double point[3],
                  double room) {
    return scan(block, lowest, bound, point, room);
}
