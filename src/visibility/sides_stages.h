/* SPDX-License-Identifier: Apache-2.0 */
/* Sides of faces (visibility/scene.h), written once and compiled per instruction set: the including
 * file names the function and selects the lanes. */
#include "visibility/lanes.h"
#include "visibility/scene.h"

void SIDES_RUN(const visibility_scene *scene, const double p[3], double bound, size_t rank,
               size_t end, int8_t *side) {
    enum { LANES = 8 };
    const double back[3] = {scene->centre[0] - p[0], scene->centre[1] - p[1],
                            scene->centre[2] - p[2]};
    for (; rank + LANES <= end; rank += LANES) {
        lanes above = lanes_dot(back, lanes_load(scene->nx + rank), lanes_load(scene->ny + rank),
                                lanes_load(scene->nz + rank));
        lanes_store_signs(lanes_add(above, lanes_load(scene->offset + rank)), bound, side + rank);
    }
    for (; rank < end; rank++) {
        double s = scene->offset[rank] + scene->nx[rank] * back[0] + scene->ny[rank] * back[1] +
                   scene->nz[rank] * back[2];
        side[rank] = (int8_t)((s > bound) - (s < -bound));
    }
}
