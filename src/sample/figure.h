/* SPDX-License-Identifier: Apache-2.0 */
/* An articulated figure: joints, the solid around them, and poses. */
#ifndef STARG_SAMPLE_FIGURE_H
#define STARG_SAMPLE_FIGURE_H

#include <stddef.h>

#include "sample/implicit.h"

enum { FIGURE_MAX_JOINTS = 40, FIGURE_MAX_TURNS = 160, FIGURE_POSES = 5 };

/* Rotation of one joint, with all its descendants, in one pose: about the direction of `degrees` in
 * the rest pose, by its length in degrees. */
typedef struct figure_turn {
    int pose, joint;
    double degrees[3];
} figure_turn;

/* x is forward, y up, z to the right. Joint 0 is the root; parents come before their children. */
typedef struct figure {
    int joint_count;
    int parents[FIGURE_MAX_JOINTS]; /* -1 for the root */
    double pivots[FIGURE_MAX_JOINTS][3];
    implicit_field field;
    int owners[IMPLICIT_MAX_PARTS]; /* joint that moves each part */
    figure_turn turns[FIGURE_MAX_TURNS];
    size_t turn_count;
} figure;

typedef enum figure_kind {
    FIGURE_HORSE,
    FIGURE_DOG,
    FIGURE_CAT,
    FIGURE_GIRAFFE,
    FIGURE_DINOSAUR,
    FIGURE_BIRD,
    FIGURE_HUMAN,
    FIGURE_OCTOPUS
} figure_kind;

void figure_build(figure_kind kind, figure *out);

#endif
