/* SPDX-License-Identifier: Apache-2.0 */
/* Field tables of the visibility options: rows shared with other tables. */
#ifndef STARG_VISIBILITY_FIELDS_H
#define STARG_VISIBILITY_FIELDS_H

#include <math.h>

#include "core/fields.h"
#include "starguard/visibility.h"

extern const char *const visibility_engine_words[];
extern const char *const visibility_target_words[];
extern const char *const visibility_face_rule_words[];

/* Rows for a struct T that has the options as MEMBER. The engine has a different name in each
 * command; GUARDS.json omits it, because all engines give the same bits. */
#define VISIBILITY_ENGINE_FIELD(T, MEMBER, KEY, OPTION)                                            \
    {                                                                                              \
        .key = (KEY), .option = (OPTION), .kind = STARG_FIELD_CHOICE, FIELD_MEMBER(T, MEMBER),     \
        .words = visibility_engine_words, .initial = STARG_VISIBILITY_FASTEST,                     \
        .value = "fastest|contours|grid|bvh|sweep",                                                \
        .help = "Visibility engine: counting across contours, a direction grid, the faster of "    \
                "the two per point (fastest), a bounding volume hierarchy, or the published "      \
                "sweep. All are exact and agree; they differ in speed."                            \
    }
#define VISIBILITY_TARGET_FIELD(T, MEMBER)                                                         \
    {                                                                                              \
        .key = "target", .option = "target", .kind = STARG_FIELD_CHOICE, FIELD_MEMBER(T, MEMBER),  \
        .words = visibility_target_words, .value = "faces|vertices",                               \
        .help = "Whether to cover faces or vertices."                                              \
    }
#define VISIBILITY_FACE_RULE_FIELD(T, MEMBER)                                                      \
    {                                                                                              \
        .key = "faces", .option = "faces", .kind = STARG_FIELD_CHOICE, FIELD_MEMBER(T, MEMBER),    \
        .words = visibility_face_rule_words, .value = "vertices|whole",                            \
        .help = "Visibility of a face: all three vertices are visible (corners), or every point "  \
                "of it (whole)."                                                                   \
    }
#define VISIBILITY_RANGE_FIELD(T, MEMBER)                                                          \
    {                                                                                              \
        .key = "range", .option = "range", .kind = STARG_FIELD_REAL,                               \
        .flags = STARG_FIELD_NULLABLE | STARG_FIELD_ABOVE, FIELD_MEMBER(T, MEMBER), .high = 1e100, \
        .standard = INFINITY, .value = "R", .help = "Viewing range, in model units.",              \
        .default_text = "unlimited"                                                                \
    }
#define VISIBILITY_CONE_FIELD(T, MEMBER, OPTION)                                                   \
    {                                                                                              \
        .key = "cone", .option = (OPTION), .kind = STARG_FIELD_REAL,                               \
        .flags = STARG_FIELD_NULLABLE | STARG_FIELD_OPTIONAL | STARG_FIELD_ABOVE,                  \
        FIELD_MEMBER(T, MEMBER), .high = 360, .standard = 360, .value = "DEGREES",                 \
        .help = "Full opening angle of guards that look in one direction, like cameras.",          \
        .default_text = "360, all directions"                                                      \
    }

#endif
