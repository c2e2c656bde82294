/* SPDX-License-Identifier: Apache-2.0 */
/* Figures with a spine, a head, a tail and four limbs, as tables.
 *
 * A table gives the right side only (z > 0): parts off the middle plane and the joints of the right
 * limbs are mirrored to the left. */
#pragma once

#include "sample/solids.h"

enum {
    BODY,
    CHEST, /* on BODY */
    NECK,  /* on CHEST */
    NECK2, /* on NECK */
    HEAD,  /* on NECK2 */
    TAIL,  /* on BODY */
    TAIL2,
    TAIL3,
    ARM_R, /* foreleg, arm or wing, on CHEST */
    ARM_R2,
    ARM_R3,
    LEG_R, /* hindleg or leg, on BODY */
    LEG_R2,
    LEG_R3,
    ARM_L,
    ARM_L2,
    ARM_L3,
    LEG_L,
    LEG_L2,
    LEG_L3,
    VERTEBRATE_JOINTS,
    RIGHT_JOINTS = ARM_L,
    TO_LEFT = ARM_L - ARM_R
};

typedef struct vertebrate_part {
    int joint;
    double a[3], ra; /* a ball ... */
    double b[3], rb; /* ... and another, and their convex hull */
    double blend;
    double flat[3], flatten; /* see solids.h */
} vertebrate_part;

typedef struct vertebrate {
    double pivots[RIGHT_JOINTS][3];
    const vertebrate_part *parts;
    size_t part_count;
    const figure_turn *turns; /* pose 0 is the rest pose and has none */
    size_t turn_count;
} vertebrate;

extern const vertebrate HORSE, DOG, CAT, GIRAFFE, DINOSAUR, BIRD, HUMAN;

#define TABLE_SIZE(TABLE) (sizeof(TABLE) / sizeof *(TABLE))
