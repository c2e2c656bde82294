/* Every tetrahedron a piece of its own, seen from its centroid: valid, and the most pieces that
 * there can be. */
#include "star/strict.h"

#include "core/memory.h"
#include "star/decomposition.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "strict pieces";

static void place_guard(const starg_tetmesh *mesh, size_t tetrahedron, double out[3]) {
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int c = 0; c < 4; c++)
            out[k] += 0.25 * tetmesh_corner(mesh, tetrahedron, c)[k];
    }
}

starg_status strict_decompose(starg_context *context, const starg_tetmesh *mesh,
                              const starg_decompose_options *options, starg_decomposition **out) {
    starg_status status = STARG_OK;
    starg_tetmesh *copy = NULL;
    int32_t *labels = NULL;
    double *guards = NULL;
    *out = NULL;
    (void)options;
    STARG_TRY(tetmesh_copy(context, mesh, &copy));
    STARG_NEW(context, STAGE, labels, mesh->count);
    STARG_NEW(context, STAGE, guards, 3 * mesh->count);
    for (size_t t = 0; t < mesh->count; t++) {
        labels[t] = (int32_t)t;
        place_guard(mesh, t, guards + 3 * t);
    }
    status = decomposition_finish(context, STARG_DECOMPOSE_STRICT, copy, labels, guards,
                                  mesh->count, out);
    copy = NULL;
    labels = NULL;
done:
    starg_tetmesh_free(copy);
    starg_release(context, labels);
    starg_release(context, guards);
    return status;
}
