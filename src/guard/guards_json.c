/* SPDX-License-Identifier: Apache-2.0 */
/* GUARDS.json: the result of guarding as text (docs/formats.md). */
#include <string.h>

#include "core/file.h"
#include "core/json.h"
#include "core/memory.h"
#include "guard/stages.h"
#include "starguard/guard.h"

static const char STAGE[] = "guards file";

static bool put(FILE *stream, const void *result, const char *model_file) {
    starg_guards shown = *(const starg_guards *)result;
    shown.file = (char *)(uintptr_t)model_file;
    return record_put(stream, &guards_file_fields, &shown, 0);
}

static starg_status keep_name(starg_context *context, const char *name, char **file) {
    size_t size = strlen(name) + 1;
    char *copy = NULL;
    NEW(context, STAGE, copy, size);
    memcpy(copy, name, size);
    starg_release(context, *file);
    *file = copy;
    return STARG_OK;
}

starg_status starg_guards_name_obstacles(starg_context *context, starg_guards *guards,
                                         const char *const *files) {
    for (size_t i = 0; i < guards->obstacle_count; i++)
        TRY(keep_name(context, files[i], &guards->obstacles[i].file));
    return STARG_OK;
}

starg_status starg_guards_name_zones(starg_context *context, starg_guards *guards,
                                     const char *const *files) {
    for (size_t i = 0; i < guards->zone_count; i++)
        if (guards->zones[i].face_count > 0)
            TRY(keep_name(context, files[i], &guards->zones[i].file));
    return STARG_OK;
}

starg_status starg_guards_write(starg_context *context, const starg_guards *guards,
                                const char *model_file, const char *path) {
    return starg_json_write(context, STAGE, path, put, guards, model_file);
}

starg_status starg_guards_write_memory(starg_context *context, const starg_guards *guards,
                                       const char *model_file, char **text, size_t *size) {
    return starg_json_write_memory(context, STAGE, put, guards, model_file, text, size);
}

/* Checks that the field tables do not express. */
static starg_status check_targets(starg_context *context, const char *name, const starg_guards *g) {
    for (size_t i = 0; i < g->target_count; i++)
        if (g->targets[i] >= g->face_count || (i > 0 && g->targets[i] <= g->targets[i - 1]))
            return record_reject(context, name, &guards_file_fields, "targets",
                                 "ascending faces of the model");
    return STARG_OK;
}

static starg_status check_needs(starg_context *context, const char *name, const starg_guards *g) {
    for (size_t i = 0; i < g->need_count; i++)
        if (g->needs[i].face >= g->face_count ||
            (i > 0 && g->needs[i].face <= g->needs[i - 1].face))
            return record_reject(context, name, &guards_file_fields, "needs",
                                 "ascending faces of the model");
    return STARG_OK;
}

static starg_status check_tour(starg_context *context, const char *name, const starg_guards *g) {
    const starg_tour *t = &g->tour;
    bool fits = t->point_count == 0 || (t->stop_count > 0 && t->stops[0] == 0 &&
                                        t->stops[t->stop_count - 1] + 1 == t->point_count);
    for (size_t i = 1; i < t->stop_count; i++)
        fits = fits && t->stops[i - 1] < t->stops[i];
    if (!fits)
        return record_reject(context, name, &guards_file_fields, "stops",
                             "ascending numbers from the first point to the last");
    return STARG_OK;
}

static starg_status check_levels(starg_context *context, const char *name, const starg_guards *g) {
    for (size_t i = 0; i < g->level_count; i++)
        if (g->level_list[i].kept > g->level_list[i].count)
            return record_reject(context, name, &guards_file_fields, "kept",
                                 "at most the number of guards of its level");
    return STARG_OK;
}

starg_status starg_guards_read_memory(starg_context *context, const void *bytes, size_t size,
                                      const char *name, starg_guards **out) {
    SCOPED_BY(starg_guards_drop) starg_guards *guards = NULL;
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    *out = NULL;
    TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    NEW_ZERO(context, STAGE, guards, 1);
    TRY(record_read(context, name, root, &guards_file_fields, guards));
    TRY(check_levels(context, name, guards));
    TRY(check_targets(context, name, guards));
    TRY(check_needs(context, name, guards));
    TRY(check_tour(context, name, guards));
    *out = guards;
    guards = NULL;
    return STARG_OK;
}

starg_status starg_guards_read(starg_context *context, const char *path, starg_guards **out) {
    char *bytes = NULL;
    size_t size;
    *out = NULL;
    starg_status status = starg_file_read(context, STAGE, path, &bytes, &size);
    if (status == STARG_OK)
        status = starg_guards_read_memory(context, bytes, size, path, out);
    starg_release(context, bytes);
    return status;
}
