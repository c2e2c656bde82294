/* SPDX-License-Identifier: Apache-2.0 */
/* Field tables of the visibility options: rows that other tables share. */
#ifndef STARG_VISIBILITY_FIELDS_H
#define STARG_VISIBILITY_FIELDS_H

#include <math.h>

#include "core/fields.h"
#include "starguard/visibility.h"

extern const char *const visibility_engine_words[];
extern const char *const visibility_target_words[];
extern const char *const visibility_face_rule_words[];

/* Rows for a struct T that has the options as MEMBER. The engine goes by another name in each
 * command; GUARDS.json does not have it, as all of them give the same bits. */
#define VISIBILITY_ENGINE_FIELD(T, MEMBER, KEY, OPTION)                                            \
    {                                                                                              \
        .key = (KEY), .option = (OPTION), .kind = STARG_FIELD_CHOICE, FIELD_MEMBER(T, MEMBER),     \
        .words = visibility_engine_words, .initial = STARG_VISIBILITY_FASTEST,                     \
        .value = "fastest|contours|grid|bvh|sweep",                                                \
        .help =                                                                                    \
            "Visibility engine: counting across contours, a grid over directions, whichever of "   \
            "the two suits the point (fastest), a bounding volume hierarchy, or the paper's "      \
            "sweep. All are exact and agree; they differ in speed."                                \
    }
#define VISIBILITY_TARGET_FIELD(T, MEMBER)                                                         \
    {                                                                                              \
        .key = "target", .option = "target", .kind = STARG_FIELD_CHOICE, FIELD_MEMBER(T, MEMBER),  \
        .words = visibility_target_words, .value = "faces|vertices", .help = "What is to be seen." \
    }
#define VISIBILITY_FACE_RULE_FIELD(T, MEMBER)                                                      \
    {                                                                                              \
        .key = "faces", .option = "faces", .kind = STARG_FIELD_CHOICE, FIELD_MEMBER(T, MEMBER),    \
        .words = visibility_face_rule_words, .value = "vertices|whole",                            \
        .help =                                                                                    \
            "When a face counts as seen: when its three vertices are, or only when every point "   \
            "of it is (whole)."                                                                    \
    }
#define VISIBILITY_RANGE_FIELD(T, MEMBER)                                                          \
    {                                                                                              \
        .key = "range", .option = "range", .kind = STARG_FIELD_REAL,                               \
        .flags = STARG_FIELD_NULLABLE | STARG_FIELD_ABOVE, FIELD_MEMBER(T, MEMBER), .high = 1e100, \
        .standard = INFINITY, .value = "R",                                                        \
        .help = "See no farther than R, in units of the model.", .default_text = "any distance"    \
    }
#define VISIBILITY_CONE_FIELD(T, MEMBER, OPTION)                                                   \
    {                                                                                              \
        .key = "cone", .option = (OPTION), .kind = STARG_FIELD_REAL,                               \
        .flags = STARG_FIELD_NULLABLE | STARG_FIELD_OPTIONAL | STARG_FIELD_ABOVE,                  \
        FIELD_MEMBER(T, MEMBER), .high = 360, .standard = 360, .value = "DEGREES",                 \
        .help = "Guards look in one direction, with this full opening angle, like cameras.",       \
        .default_text = "360, all around"                                                          \
    }

#endif
