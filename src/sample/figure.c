/* SPDX-License-Identifier: Apache-2.0 */
/* Builds figures: vertebrates from their tables, the octopus from one arm. */

#include "geometry/vec3.h"
#include "sample/vertebrate.h"

static void add_part(figure *f, int joint, const vertebrate_part *row) {
    implicit_part *part = &f->field.parts[f->field.count];
    f->owners[f->field.count++] = joint;
    *part =
        (implicit_part){.ra = row->ra, .rb = row->rb, .blend = row->blend, .flatten = row->flatten};
    vec3_copy(row->a, part->a);
    vec3_copy(row->b, part->b);
    double length = vec3_length(row->flat);
    for (int k = 0; k < 3; k++)
        part->flat[k] = length > 0 ? row->flat[k] / length : 0;
    implicit_prepare(part);
}

static int mirrored_joint(int joint) {
    return joint >= ARM_R ? joint + TO_LEFT : joint;
}

static void build_vertebrate(const vertebrate *table, figure *f) {
    static const int parents[VERTEBRATE_JOINTS] = {
        [BODY] = -1,       [CHEST] = BODY,    [NECK] = CHEST,    [NECK2] = NECK,
        [HEAD] = NECK2,    [TAIL] = BODY,     [TAIL2] = TAIL,    [TAIL3] = TAIL2,
        [ARM_R] = CHEST,   [ARM_R2] = ARM_R,  [ARM_R3] = ARM_R2, [LEG_R] = BODY,
        [LEG_R2] = LEG_R,  [LEG_R3] = LEG_R2, [ARM_L] = CHEST,   [ARM_L2] = ARM_L,
        [ARM_L3] = ARM_L2, [LEG_L] = BODY,    [LEG_L2] = LEG_L,  [LEG_L3] = LEG_L2};
    f->joint_count = VERTEBRATE_JOINTS;
    for (int j = 0; j < VERTEBRATE_JOINTS; j++)
        f->parents[j] = parents[j];
    for (int j = 0; j < RIGHT_JOINTS; j++) {
        double *left = f->pivots[mirrored_joint(j)];
        vec3_copy(table->pivots[j], left);
        left[2] = -left[2];
        vec3_copy(table->pivots[j], f->pivots[j]);
    }
    for (size_t i = 0; i < table->part_count; i++) {
        vertebrate_part row = table->parts[i];
        add_part(f, row.joint, &row);
        if (row.a[2] == 0 && row.b[2] == 0)
            continue;
        row.a[2] = -row.a[2];
        row.b[2] = -row.b[2];
        row.flat[2] = -row.flat[2];
        add_part(f, mirrored_joint(row.joint), &row);
    }
    for (size_t i = 0; i < table->turn_count && i < FIGURE_MAX_TURNS; i++)
        f->turns[f->turn_count++] = table->turns[i];
}

/* ---- octopus ---- */

enum { ARMS = 8, SEGMENTS = 4 };

static int arm_joint(int arm, int segment) {
    return 1 + arm * SEGMENTS + segment;
}

static double arm_angle(int arm) {
    return 6.28318530717958648 * (arm + 0.5) / ARMS;
}

/* The arm along x, rotated about y to its place. */
static void octopus_point(int arm, const double along[3], double out[3]) {
    double angle = arm_angle(arm);
    out[0] = along[0] * cos(angle) - along[2] * sin(angle);
    out[1] = along[1];
    out[2] = along[0] * sin(angle) + along[2] * cos(angle);
}

static void build_octopus_arm(int arm, figure *f) {
    static const double path[SEGMENTS + 1][4] = {/* x, y, z, radius */
                                                 {0.20, 0.40, 0.00, 0.135},
                                                 {0.52, 0.20, 0.03, 0.105},
                                                 {0.90, 0.10, 0.09, 0.078},
                                                 {1.25, 0.12, 0.06, 0.055},
                                                 {1.52, 0.24, -0.04, 0.030}};
    double points[SEGMENTS + 1][3];
    for (int i = 0; i <= SEGMENTS; i++)
        octopus_point(arm, path[i], points[i]);
    for (int i = 0; i < SEGMENTS; i++) {
        int joint = arm_joint(arm, i);
        f->parents[joint] = i == 0 ? 0 : joint - 1;
        vec3_copy(points[i], f->pivots[joint]);
        vertebrate_part row = {.ra = path[i][3], .rb = path[i + 1][3], .blend = 0.06};
        vec3_copy(points[i], row.a);
        vec3_copy(points[i + 1], row.b);
        add_part(f, joint, &row);
    }
}

/* Bends of the arms: degrees up at the root, further degrees up at each later joint, and the same
 * sideways. */
typedef struct arm_bend {
    double lift, curl, swing, sway;
} arm_bend;

static void bend_octopus_arm(int pose, int arm, figure *f) {
    static const arm_bend bends[FIGURE_POSES][4] = {
        [1] = {{22, -16, 8, 6}, {-4, 4, -10, -10}, {14, 10, 0, 14}, {0, 2, 12, -14}},   /* crawls */
        [2] = {{-34, -10, 0, 5}, {-30, -8, 0, -5}, {-36, -12, 0, 5}, {-30, -9, 0, -5}}, /* swims */
        [3] = {{34, 20, 0, 4}, {24, 24, 4, 0}, {38, 16, 0, -4}, {26, 22, -4, 0}}, /* arms up */
        [4] = {{4, 0, 12, 24}, {8, 2, 12, 24}, {2, 0, 12, 24}, {8, -2, 12, 24}},  /* whirls */
    };
    const arm_bend *bend = &bends[pose][arm % 4];
    double angle = arm_angle(arm);
    for (int segment = 0; segment < SEGMENTS; segment++) {
        double lift = segment == 0 ? bend->lift : bend->curl;
        double swing = segment == 0 ? bend->swing : bend->sway;
        f->turns[f->turn_count++] =
            (figure_turn){.pose = pose,
                          .joint = arm_joint(arm, segment),
                          .degrees = {-sin(angle) * lift, swing, cos(angle) * lift}};
    }
}

static void build_octopus(figure *f) {
    static const vertebrate_part head[] = {
        {0, {0, 0.48, 0}, 0.27, {0.02, 0.66, 0}, 0.23, 0.1, {0}, 0},       /* head */
        {0, {-0.02, 0.80, 0}, 0.25, {-0.20, 1.22, 0}, 0.34, 0.22, {0}, 0}, /* mantle */
        {0, {-0.24, 1.34, 0}, 0.30, {-0.34, 1.52, 0}, 0.16, 0.20, {0}, 0},
        {0, {0.17, 0.72, 0.16}, 0.085, {0.19, 0.74, 0.175}, 0.08, 0.05, {0}, 0}, /* eyes */
        {0, {0.17, 0.72, -0.16}, 0.085, {0.19, 0.74, -0.175}, 0.08, 0.05, {0}, 0}};
    f->joint_count = 1 + ARMS * SEGMENTS;
    f->parents[0] = -1;
    for (size_t i = 0; i < TABLE_SIZE(head); i++)
        add_part(f, 0, &head[i]);
    for (int arm = 0; arm < ARMS; arm++)
        build_octopus_arm(arm, f);
    for (int pose = 1; pose < FIGURE_POSES; pose++)
        for (int arm = 0; arm < ARMS; arm++)
            bend_octopus_arm(pose, arm, f);
}

void figure_build(figure_kind kind, figure *out) {
    static const vertebrate *const tables[] = {
        [FIGURE_HORSE] = &HORSE,       [FIGURE_DOG] = &DOG,   [FIGURE_CAT] = &CAT,
        [FIGURE_GIRAFFE] = &GIRAFFE,   [FIGURE_BIRD] = &BIRD, [FIGURE_HUMAN] = &HUMAN,
        [FIGURE_DINOSAUR] = &DINOSAUR,
    };
    *out = (figure){0};
    if (kind == FIGURE_OCTOPUS)
        build_octopus(out);
    else
        build_vertebrate(tables[kind], out);
}
