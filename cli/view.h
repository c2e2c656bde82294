/* Options about seeing that several commands share. */
#ifndef STARGUARD_CLI_VIEW_H
#define STARGUARD_CLI_VIEW_H

#include "options.h"
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

/* The options for a member `view`; the engine goes by another name in each command. */
#define CLI_VIEW_OPTIONS(ENGINE)                                                                   \
    CLI_CHOICE_OPTION(ENGINE, view.engine, cli_engine_words, "fastest|contours|grid|bvh|sweep",    \
                      "How to see: by counting across contours, by a grid over directions, by "    \
                      "the one of them that suits the point (default), by a bounding volume "      \
                      "hierarchy, or by the sweep. All are exact and agree; they differ in "       \
                      "speed."),                                                                   \
        CLI_CHOICE_OPTION("target", view.target, cli_target_words, "faces|vertices",               \
                          "What is to be seen. Default faces."),                                   \
        CLI_CHOICE_OPTION("faces", view.face_rule, cli_face_rule_words, "vertices|whole",          \
                          "When a face counts as seen: its three vertices are (default), or "      \
                          "every point of it is."),                                                \
        CLI_POSITIVE_OPTION("range", view.range, "R", 1e100,                                       \
                            "See no farther than R, in units of the model. Default: any "          \
                            "distance.")

#endif
