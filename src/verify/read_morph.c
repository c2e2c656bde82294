/* SPDX-License-Identifier: Apache-2.0 */
/* The report of a morph, read for the verifier (docs/formats.md). Skips unknown keys. */
#include <math.h>

#include "core/json.h"
#include "verify/map.h"

STARG_DROP(starg_morph_report, starg_morph_report)

static const char STAGE[] = "morph report";

static starg_status reject(starg_context *context, const char *name, const char *key,
                           const char *expected) {
    return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                      "'%.200s' is not a valid morph report: \"%s\" must be %s", name, key,
                      expected);
}

static bool read_real(const json_t *object, const char *key, double *out) {
    const json_t *value = json_object_get(object, key);
    *out = json_number_value(value);
    return json_is_number(value);
}

static bool read_frame(const json_t *object, verify_frame *frame) {
    const json_t *pairs = json_object_get(object, "intersections");
    frame->intersections = (size_t)json_integer_value(pairs);
    return json_is_integer(pairs) && json_integer_value(pairs) >= 0 &&
           read_real(object, "t", &frame->t) && read_real(object, "volume", &frame->volume) &&
           read_real(object, "area", &frame->area) &&
           read_real(object, "volume_drift", &frame->volume_drift) &&
           read_real(object, "area_drift", &frame->area_drift);
}

static starg_status read_frames(starg_context *context, const char *name, const json_t *list,
                                starg_morph_report *report) {
    size_t count = json_array_size(list);
    if (!json_is_array(list) || count < 2)
        return reject(context, name, "frames", "an array of at least two");
    NEW(context, STAGE, report->frames, count);
    for (size_t i = 0; i < count; i++)
        if (!read_frame(json_array_get(list, i), &report->frames[i]))
            return reject(context, name, "frames",
                          "objects with t, intersections, volume, area and their drifts");
    report->frame_count = count;
    return STARG_OK;
}

starg_status starg_morph_report_read_memory(starg_context *context, const void *bytes, size_t size,
                                            const char *name, starg_morph_report **out) {
    SCOPED_BY(starg_morph_report_drop) starg_morph_report *report = NULL;
    SCOPED_BY(json_decrefp) json_t *root = NULL;
    *out = NULL;
    TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    NEW_ZERO(context, STAGE, report, 1);
    report->context = context;
    const char *format = json_string_value(json_object_get(root, "format"));
    if (format == NULL || strcmp(format, "starguard-morph") != 0)
        TRY(reject(context, name, "format", "\"starguard-morph\""));
    if (json_integer_value(json_object_get(root, "version")) != 1)
        TRY(reject(context, name, "version", "1, the only supported one"));
    TRY(read_frames(context, name, json_object_get(root, "frames"), report));
    *out = report;
    report = NULL;
    return STARG_OK;
}

void starg_morph_report_free(starg_morph_report *report) {
    if (report == NULL)
        return;
    RELEASE(report->frames, report);
}
