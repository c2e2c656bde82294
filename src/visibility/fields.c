/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility/fields.h"

const char *const visibility_engine_words[] = {"grid", "bvh", "sweep", "contours", "fastest", NULL};
const char *const visibility_target_words[] = {"faces", "vertices", "points", NULL};
const char *const visibility_face_rule_words[] = {"vertices", "whole", NULL};
const char *const visibility_patch_words[] = {"auto", "off", NULL};
const char *const visibility_density_words[] = {"monitor",   "detect",   "observe",
                                                "recognise", "identify", NULL};
const char *const visibility_unit_words[] = {"m", "cm", "mm", "ft", "in", NULL};

static bool has_patches(const void *record) {
    return ((const starg_visibility_options *)record)->patch > 0;
}

static const starg_field ROWS[] = {
    VISIBILITY_ENGINE_FIELD(starg_visibility_options, engine, "engine", "engine"),
    VISIBILITY_TARGET_FIELD(starg_visibility_options, target),
    VISIBILITY_FACE_RULE_FIELD(starg_visibility_options, face_rule),
    VISIBILITY_PATCH_FIELD(starg_visibility_options, patch, has_patches),
    VISIBILITY_RANGE_FIELD(starg_visibility_options, range),
    VISIBILITY_NEAR_FIELD(starg_visibility_options, near),
    VISIBILITY_INCIDENCE_FIELD(starg_visibility_options, incidence),
    VISIBILITY_CONE_FIELD(starg_visibility_options, cone, "cone"),
    VISIBILITY_FOV_FIELD(starg_visibility_options, fov, "fov"),
    VISIBILITY_UP_FIELD(starg_visibility_options, up, "up"),
    VISIBILITY_TILT_FIELD(starg_visibility_options, tilt, NULL),
    VISIBILITY_RESOLUTION_FIELD(starg_visibility_options, resolution),
    VISIBILITY_DENSITY_FIELD(starg_visibility_options, density),
    VISIBILITY_UNIT_FIELD(starg_visibility_options, unit),
};
static const starg_fields TABLE = {
    .name = "visibility options", .size = sizeof(starg_visibility_options), FIELD_ROWS(ROWS)};
OPTIONS_BY(TABLE, starg_visibility_options)
