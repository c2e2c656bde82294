/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility/fields.h"

const char *const visibility_engine_words[] = {"grid", "bvh", "sweep", "contours", "fastest", NULL};
const char *const visibility_target_words[] = {"faces", "vertices", NULL};
const char *const visibility_face_rule_words[] = {"vertices", "whole", NULL};

static const starg_field ROWS[] = {
    VISIBILITY_ENGINE_FIELD(starg_visibility_options, engine, "engine", "engine"),
    VISIBILITY_TARGET_FIELD(starg_visibility_options, target),
    VISIBILITY_FACE_RULE_FIELD(starg_visibility_options, face_rule),
    VISIBILITY_RANGE_FIELD(starg_visibility_options, range),
    VISIBILITY_NEAR_FIELD(starg_visibility_options, near),
    VISIBILITY_INCIDENCE_FIELD(starg_visibility_options, incidence),
    VISIBILITY_CONE_FIELD(starg_visibility_options, cone, NULL),
    VISIBILITY_FOV_FIELD(starg_visibility_options, fov, NULL),
    VISIBILITY_UP_FIELD(starg_visibility_options, up, NULL),
};
static const starg_fields TABLE = {
    .name = "visibility options", .size = sizeof(starg_visibility_options), FIELD_ROWS(ROWS)};

const starg_fields *starg_visibility_options_fields(void) {
    return &TABLE;
}

void starg_visibility_options_default(starg_visibility_options *options) {
    *options = (starg_visibility_options){0};
    starg_fields_default(&TABLE, options);
}
