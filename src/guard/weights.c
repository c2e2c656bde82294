/* SPDX-License-Identifier: Apache-2.0 */
#include "guard/weights.h"

#include <math.h>

#include "core/memory.h"
#include "geometry/vec3.h"
#include "visibility/rows.h"

static const char STAGE[] = "guard";

/* The binary exponent of the largest coordinate. */
static int find_exponent(const starg_mesh *mesh) {
    double most = 0;
    int exponent = 0;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        most = fmax(most, fabs(mesh->vertices[i]));
    frexp(most, &exponent);
    return exponent;
}

/* Areas of the model scaled to unit size by a power of two: ratios are unchanged, and areas of tiny
 * or huge models neither underflow nor overflow. */
static starg_status measure_areas(starg_context *context, const starg_solid *solid,
                                  column_weights *out) {
    starg_status status = STARG_OK;
    const starg_mesh *mesh = solid->mesh;
    int exponent = find_exponent(mesh);
    STARG_NEW(context, STAGE, out->areas, mesh->face_count);
    for (size_t f = 0; f < mesh->face_count; f++) {
        double corner[3][3];
        for (size_t k = 0; k < 9; k++)
            corner[k / 3][k % 3] =
                ldexp(mesh->vertices[3 * (size_t)mesh->faces[3 * f + k / 3] + k % 3], -exponent);
        out->areas[f] = vec3_triangle_area(corner[0], corner[1], corner[2]);
        if (solid->importance != NULL)
            out->areas[f] *= solid->importance[f];
        out->faces += solid_is_target(solid, false, f);
        out->area += out->areas[f];
    }
done:
    return status;
}

starg_status column_weights_create(starg_context *context, const starg_solid *solid,
                                   starg_target target, column_weights *out) {
    starg_status status = STARG_OK;
    const starg_mesh *mesh = solid->mesh;
    bool vertices = target == STARG_TARGET_VERTICES, faces = target == STARG_TARGET_FACES;
    size_t columns = target_columns(mesh, target);
    *out = (column_weights){0};
    STARG_TRY(measure_areas(context, solid, out));
    STARG_NEW(context, STAGE, out->weights, columns);
    for (size_t j = 0; j < columns; j++) {
        if (!solid_is_target(solid, vertices, target == STARG_TARGET_CORNERS ? j / 3 : j)) {
            out->weights[j] = 0;
            continue;
        }
        double share = !faces || !(out->area > 0) ? 0 : out->areas[j] / out->area;
        uint64_t weight = (uint64_t)llround(share * 0x1p40);
        out->weights[j] = weight > 0 ? weight : 1;
        out->total += out->weights[j];
    }
done:
    return status;
}

void column_weights_free(starg_context *context, column_weights *weights) {
    starg_release(context, weights->areas);
    starg_release(context, weights->weights);
    *weights = (column_weights){0};
}
