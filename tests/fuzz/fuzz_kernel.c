/* SPDX-License-Identifier: Apache-2.0 */
/* The kernel of a small closed surface: each verdict is held against rationals. A guard is strictly
 * on the inner side of every face, and wound around once; a witness leaves no point in the box. */
#include <math.h>

#include "exact_oracle.h"
#include "starguard/kernel.h"
#include "support.h"

static void face_corners(const shape *s, size_t face, const double *t[3]) {
    for (size_t k = 0; k < 3; k++)
        t[k] = s->vertices + 3 * (size_t)s->faces[3 * face + k];
}

static bool is_behind_no_face(const shape *s, const double p[3]) {
    for (size_t f = 0; f < s->face_count; f++) {
        const double *t[3];
        face_corners(s, f, t);
        if (oracle_orient3d(t[0], t[1], t[2], p) <= 0)
            return false;
    }
    return true;
}

static int winding(const shape *s, const double p[3]) {
    bool on_surface;
    return oracle_winding(s->vertices, s->faces, s->face_count, p, &on_surface);
}

/* The box of the corners of all faces. */
static void find_box(const shape *s, double lower[3], double upper[3]) {
    for (size_t i = 0; i < 9 * s->face_count; i++) {
        double x = s->vertices[3 * (size_t)s->faces[i / 3] + i % 3];
        lower[i % 3] = i < 3 ? x : fmin(lower[i % 3], x);
        upper[i % 3] = i < 3 ? x : fmax(upper[i % 3], x);
    }
}

static void check_witness(const shape *s, const starg_kernel_result *result) {
    const double *corners[3 * STARG_KERNEL_WITNESS];
    double lower[3], upper[3];
    fuzz_require(result->witness_count <= STARG_KERNEL_WITNESS, "witnesses are few");
    for (size_t i = 0; i < result->witness_count; i++)
        face_corners(s, result->witness[i], corners + 3 * i);
    find_box(s, lower, upper);
    fuzz_require(!oracle_half_spaces_meet(corners, (int)result->witness_count, lower, upper),
                 "a witness leaves no room");
}

static void check_result(const shape *s, const starg_kernel_result *result) {
    switch (result->verdict) {
    case STARG_KERNEL_INTERIOR:
        fuzz_require(is_behind_no_face(s, result->guard), "the guard is inside of all faces");
        fuzz_require(winding(s, result->guard) == 1, "the guard is wound around once");
        break;
    case STARG_KERNEL_EMPTY:
        if (result->witness_count > 0)
            check_witness(s, result);
        else /* then it is the number of windings that proves it */
            fuzz_require(is_behind_no_face(s, result->guard) && winding(s, result->guard) != 1,
                         "the guard is wound around more than once");
        break;
    case STARG_KERNEL_UNDECIDED:
        break;
    }
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    fuzz_input in = {data, size};
    starg_context *context = fuzz_context();
    shape s = fuzz_shape(&in);
    starg_mesh *mesh = fuzz_mesh(context, &s);
    starg_kernel_result result;
    starg_status status = starg_kernel(context, mesh, NULL, &result);
    fuzz_require(status == STARG_OK || status == STARG_ERROR_MESH, "only open meshes are refused");
    if (status == STARG_OK)
        check_result(&s, &result);
    starg_mesh_free(mesh);
    shape_free(&s);
    fuzz_context_end(context);
    return 0;
}
