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
extern const char *const visibility_patch_words[];
extern const char *const visibility_density_words[];
extern const char *const visibility_unit_words[];

/* Rows for a struct T that has the options as MEMBER. The engine has a different name in each
 * command; GUARDS.json omits it, because all engines give the same bits. */
#define VISIBILITY_ENGINE_FIELD(T, MEMBER, KEY, OPTION)                                            \
    {                                                                                              \
        .key = (KEY), .option = (OPTION), .group = "search", .kind = STARG_FIELD_CHOICE,           \
        FIELD_MEMBER(T, MEMBER), .words = visibility_engine_words,                                 \
        .initial = STARG_VISIBILITY_FASTEST, .value = "fastest|contours|grid|bvh|sweep",           \
        .help = "Visibility engine: counting across contours, a direction grid, the faster of "    \
                "the two per point (fastest), a bounding volume hierarchy, or the published "      \
                "sweep. All are exact and agree; they differ in speed."                            \
    }
#define VISIBILITY_TARGET_FIELD(T, MEMBER)                                                         \
    {                                                                                              \
        .key = "target", .option = "target", .group = "targets",                                   \
        .brief = "faces, vertices, or every point: points", .kind = STARG_FIELD_CHOICE,            \
        FIELD_MEMBER(T, MEMBER), .words = visibility_target_words,                                 \
        .value = "faces|vertices|points",                                                          \
        .help = "What is to be seen: faces by their corners (or whole, --faces), vertices, or "    \
                "every point of the boundary."                                                     \
    }
#define VISIBILITY_FACE_RULE_FIELD(T, MEMBER)                                                      \
    {                                                                                              \
        .key = "faces", .option = "faces", .group = "targets", .kind = STARG_FIELD_CHOICE,         \
        FIELD_MEMBER(T, MEMBER), .words = visibility_face_rule_words, .value = "vertices|whole",   \
        .help = "Visibility of a face: all three vertices are visible (corners), or every point "  \
                "of it (whole)."                                                                   \
    }
/* Only in files where there are patches. */
#define VISIBILITY_PATCH_FIELD(T, MEMBER, APPLIES)                                                 \
    {                                                                                              \
        .key = "patch", .option = "patch", .group = "targets", .kind = STARG_FIELD_REAL,           \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE | STARG_FIELD_ABOVE,                      \
        FIELD_MEMBER(T, MEMBER), .high = 1e100, .standard = STARG_PATCH_AUTO,                      \
        .words = visibility_patch_words, .applies = (APPLIES), .value = "D|auto|off",              \
        .help = "Faces are seen in parts whose edges are at most D long, so that several guards "  \
                "may share a face. auto chooses D for views that are limited (range, field of "    \
                "view, incidence), soups and mounts, and leaves faces whole elsewhere."            \
    }
#define VISIBILITY_RANGE_FIELD(T, MEMBER)                                                          \
    {                                                                                              \
        .key = "range", .option = "range", .group = "cameras", .brief = "how far a camera sees",   \
        .kind = STARG_FIELD_REAL, .flags = STARG_FIELD_NULLABLE | STARG_FIELD_ABOVE,               \
        FIELD_MEMBER(T, MEMBER), .high = 1e100, .standard = INFINITY, .value = "R",                \
        .help = "Viewing range, in model units.", .default_text = "unlimited"                      \
    }
#define VISIBILITY_CONE_FIELD(T, MEMBER, OPTION)                                                   \
    {                                                                                              \
        .key = "cone", .option = (OPTION), .group = "cameras", .kind = STARG_FIELD_REAL,           \
        .flags = STARG_FIELD_NULLABLE | STARG_FIELD_OPTIONAL | STARG_FIELD_ABOVE,                  \
        FIELD_MEMBER(T, MEMBER), .high = 360, .standard = 360, .value = "DEGREES",                 \
        .help = "Full opening angle of guards that look in one direction, like cameras.",          \
        .default_text = "360, all directions"                                                      \
    }
#define VISIBILITY_NEAR_FIELD(T, MEMBER)                                                           \
    {                                                                                              \
        .key = "near", .option = "near", .group = "cameras", .kind = STARG_FIELD_REAL,             \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE, FIELD_MEMBER(T, MEMBER), .high = 1e100,  \
        .value = "R", .help = "Smallest distance at which corners of faces are seen."              \
    }
#define VISIBILITY_INCIDENCE_FIELD(T, MEMBER)                                                      \
    {                                                                                              \
        .key = "incidence", .option = "incidence", .group = "cameras", .kind = STARG_FIELD_REAL,   \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE | STARG_FIELD_ABOVE,                      \
        FIELD_MEMBER(T, MEMBER), .high = 90, .value = "DEGREES", .default_text = "any",            \
        .help = "Faces count only where they are seen at most so far from their normal, at every " \
                "point."                                                                           \
    }
#define VISIBILITY_FOV_FIELD(T, MEMBER, OPTION)                                                    \
    {                                                                                              \
        .key = "fov", .option = (OPTION), .group = "cameras",                                      \
        .brief = "field of view in degrees, across and down", .kind = STARG_FIELD_NUMBERS,         \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE | STARG_FIELD_ABOVE,                      \
        FIELD_MEMBER(T, MEMBER), .length = 2, .high = 179.99, .value = "H,V",                      \
        .help = "Horizontal and vertical opening in degrees of guards with a rectangular view."    \
    }
#define VISIBILITY_TILT_FIELD(T, MEMBER, OPTION)                                                   \
    {                                                                                              \
        .key = "tilt", .option = (OPTION), .group = "cameras", .kind = STARG_FIELD_NUMBERS,        \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE, FIELD_MEMBER(T, MEMBER), .length = 2,    \
        .low = -90, .high = 90, .standard = STARG_TILT_ANY, .value = "MIN,MAX",                    \
        .help = "Guards that look in one direction look so many degrees above the horizon, whose " \
                "up is --up: -45,-10 looks down."                                                  \
    }
#define VISIBILITY_RESOLUTION_FIELD(T, MEMBER)                                                     \
    {                                                                                              \
        .key = "resolution", .option = "resolution", .group = "cameras",                           \
        .kind = STARG_FIELD_NUMBERS,                                                               \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE | STARG_FIELD_ABOVE,                      \
        FIELD_MEMBER(T, MEMBER), .length = 2, .high = 1e6, .value = "W,H",                         \
        .help = "--fov: pixels of the picture across and down."                                    \
    }
#define VISIBILITY_DENSITY_FIELD(T, MEMBER)                                                        \
    {                                                                                              \
        .key = "density", .option = "density", .group = "cameras",                                 \
        .brief = "pixels per unit of length (with --resolution)", .kind = STARG_FIELD_REAL,        \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE | STARG_FIELD_ABOVE,                      \
        FIELD_MEMBER(T, MEMBER), .high = 1e100, .words = visibility_density_words,                 \
        .value = "D|NAME", .default_text = "any",                                                  \
        .help =                                                                                    \
            "--resolution: faces count only where the picture has at least so many pixels for "    \
            "each unit of length at their depth, W / (2 tan(H / 2)) / depth; or a name of "        \
            "EN 62676-4, per metre (--unit): monitor 12.5, detect 25, observe 62.5, "              \
            "recognise 125, identify 250."                                                         \
    }
#define VISIBILITY_UNIT_FIELD(T, MEMBER)                                                           \
    {                                                                                              \
        .key = "unit", .option = "unit", .group = "cameras", .kind = STARG_FIELD_CHOICE,           \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE, FIELD_MEMBER(T, MEMBER),                 \
        .words = visibility_unit_words, .value = "m|cm|mm|ft|in",                                  \
        .help = "Unit of the model's coordinates, for densities by name."                          \
    }
#define VISIBILITY_UP_FIELD(T, MEMBER, OPTION)                                                     \
    {                                                                                              \
        .key = "up", .option = (OPTION), .group = "cameras", .kind = STARG_FIELD_NUMBERS,          \
        .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE, FIELD_MEMBER(T, MEMBER), .length = 3,    \
        .low = -1e100, .high = 1e100, .value = "X,Y,Z",                                            \
        .help = "What is up for guards that look in one direction.", .default_text = "0,1,0"       \
    }

#endif
