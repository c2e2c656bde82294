#include "view.h"

#include <stddef.h>

const char *const cli_engine_words[] = {"grid", "bvh", "sweep", "contours", "fastest", NULL};
const char *const cli_target_words[] = {"faces", "vertices", NULL};
const char *const cli_face_rule_words[] = {"vertices", "whole", NULL};

void cli_view_default(cli_view *view) {
    starg_visibility_options library;
    starg_visibility_options_default(&library);
    *view = (cli_view){.engine = (int)library.engine,
                       .target = (int)library.target,
                       .face_rule = (int)library.face_rule,
                       .range = library.range};
}

starg_visibility_options cli_view_options(const cli_view *view) {
    starg_visibility_options options;
    starg_visibility_options_default(&options);
    options.engine = (starg_visibility_engine)view->engine;
    options.target = (starg_target)view->target;
    options.face_rule = (starg_face_rule)view->face_rule;
    options.range = view->range;
    return options;
}
