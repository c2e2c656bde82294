/* SPDX-License-Identifier: Apache-2.0 */
/* Every exact decision against rationals, on points of any doubles: those of the engines
 * (geometry/predicates.h, intersect.h, linear_program.h) and those of the verifier
 * (verify/signs.h).
 */
#include <string.h>

#include "exact_oracle.h"
#include "geometry/intersect.h"
#include "geometry/linear_program.h"
#include "geometry/predicates.h"
#include "support.h"
#include "verify/sight.h"
#include "verify/signs.h"

enum { POINTS = 6 };

typedef double (*points)[3];

static void check_signs(points x) {
    int side = oracle_orient3d(x[0], x[1], x[2], x[3]);
    fuzz_require(orient3d(x[0], x[1], x[2], x[3]) == side, "orient3d");
    fuzz_require(verify_side(x[0], x[1], x[2], x[3]) == side, "verify_side");
    fuzz_require(insphere(x[0], x[1], x[2], x[3], x[4]) ==
                     oracle_insphere(x[0], x[1], x[2], x[3], x[4]),
                 "insphere");
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3, turn = oracle_orient2d(x[0], x[1], x[2], u, v);
        fuzz_require(orient2d(x[0], x[1], x[2], u, v) == turn, "orient2d");
        fuzz_require(verify_turn(x[0], x[1], x[2], axis) == turn, "verify_turn");
    }
    fuzz_require(collinear(x[0], x[1], x[2]) == oracle_collinear(x[0], x[1], x[2]), "collinear");
}

static void check_distances(points x, double radius, double cosine) {
    radius = radius < 0 ? -radius : radius;
    cosine = cosine >= -1 && cosine <= 1 ? cosine : 0.5;
    int far = oracle_compare_distance(x[0], x[1], radius);
    fuzz_require(compare_distance(x[0], x[1], radius) == far, "compare_distance");
    fuzz_require(verify_within(x[0], x[1], radius) == (far <= 0), "verify_within");
    if (x[2][0] == 0 && x[2][1] == 0 && x[2][2] == 0)
        return;
    int within = oracle_compare_cone(x[0], x[2], cosine, x[1]);
    fuzz_require(compare_cone(x[0], x[2], cosine, x[1]) == within, "compare_cone");
    fuzz_require(verify_in_cone(x[0], x[2], cosine, x[1]) == (within >= 0), "verify_in_cone");
}

static void check_contacts(points x) {
    const double *s[3] = {x[0], x[1], x[2]}, *t[3] = {x[3], x[4], x[5]};
    const double *r[3] = {x[2], x[3], x[4]};
    bool on = oracle_point_on_triangle(x[0], x[1], x[2], x[3]);
    fuzz_require(point_on_triangle(x[0], x[1], x[2], x[3]) == on, "point_on_triangle");
    bool meets = oracle_segment_meets_triangle(x[0], x[1], x[2], x[3], x[4]);
    fuzz_require(segment_meets_triangle(x[0], x[1], x[2], x[3], x[4]) == meets,
                 "segment_meets_triangle");
    if (!verify_on_triangle(x[0], r))
        fuzz_require(verify_blocks(x[0], x[1], r) == meets, "verify_blocks");
    fuzz_require(segments_meet(x[0], x[1], x[2], x[3]) ==
                     oracle_segments_meet(x[0], x[1], x[2], x[3]),
                 "segments_meet");
    fuzz_require((triangles_contact(s, t, 0) != TRIANGLES_APART) ==
                     oracle_triangles_contact(s, t, 0),
                 "triangles_contact");
}

/* Is what is proven so? */
static void check_half_spaces(points x) {
    const half_space spaces[4] = {
        {x[0], x[1], x[2]}, {x[1], x[0], x[3]}, {x[2], x[3], x[4]}, {x[5], x[4], x[0]}};
    const double *corners[12];
    for (int i = 0; i < 4; i++) {
        corners[3 * i + 0] = spaces[i].a;
        corners[3 * i + 1] = spaces[i].b;
        corners[3 * i + 2] = spaces[i].c;
    }
    for (int count = 1; count <= 4; count++)
        fuzz_require(!half_spaces_apart(spaces, count) ||
                         !oracle_half_spaces_meet(corners, count, NULL, NULL),
                     "half_spaces_apart");
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    fuzz_input in = {data, size};
    double x[POINTS][3];
    uint32_t raw = fuzz_byte(&in);
    for (int i = 0; i < 3 * POINTS; i++)
        x[i / 3][i % 3] = raw >> i % 8 & 1 ? fuzz_double(&in) : fuzz_coordinate(&in);
    if (raw % 5 == 0) /* a point that is told twice */
        memcpy(x[fuzz_below(&in, POINTS)], x[0], sizeof x[0]);
    check_signs(x);
    check_distances(x, fuzz_coordinate(&in), fuzz_coordinate(&in));
    check_contacts(x);
    check_half_spaces(x);
    return 0;
}
