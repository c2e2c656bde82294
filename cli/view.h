/* Options about seeing that several commands share. */
#ifndef STARGUARD_CLI_VIEW_H
#define STARGUARD_CLI_VIEW_H

#include "starguard/visibility.h"

/* Words in the order of the library's enums; end with NULL. */
extern const char *const cli_engine_words[];
extern const char *const cli_target_words[];
extern const char *const cli_face_rule_words[];

/* What the options fill. */
typedef struct cli_view {
    int engine, target, face_rule;
    double range;
} cli_view;

void cli_view_default(cli_view *view);
starg_visibility_options cli_view_options(const cli_view *view);

/* The options for a member `view` of the struct VALUES; the engine goes by another name in each
 * command. */
#define CLI_VIEW_OPTIONS(VALUES, ENGINE)                                                           \
    {.name = ENGINE,                                                                               \
     .kind = CLI_CHOICE,                                                                           \
     .offset = offsetof(VALUES, view.engine),                                                      \
     .value = "grid|bvh|sweep",                                                                    \
     .choices = cli_engine_words,                                                                  \
     .help = "How to see: a grid over directions (default), a bounding volume hierarchy, or the "  \
             "sweep. All are exact and agree; they differ in speed."},                             \
        {.name = "target",                                                                         \
         .kind = CLI_CHOICE,                                                                       \
         .offset = offsetof(VALUES, view.target),                                                  \
         .value = "faces|vertices",                                                                \
         .choices = cli_target_words,                                                              \
         .help = "What is to be seen. Default faces."},                                            \
        {.name = "faces",                                                                          \
         .kind = CLI_CHOICE,                                                                       \
         .offset = offsetof(VALUES, view.face_rule),                                               \
         .value = "vertices|whole",                                                                \
         .choices = cli_face_rule_words,                                                           \
         .help = "When a face counts as seen: its three vertices are (default), or every point "   \
                 "of it is."},                                                                     \
    {                                                                                              \
        .name = "range", .kind = CLI_REAL, .offset = offsetof(VALUES, view.range), .value = "R",   \
        .high = 1e100, .above = true,                                                              \
        .help = "See no farther than R, in units of the model. Default: any distance."             \
    }

#endif
