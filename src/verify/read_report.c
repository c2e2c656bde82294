/* SPDX-License-Identifier: Apache-2.0 */
/* PIECES.json, read for the verifier (docs/formats.md). Checks types and shapes here; verification
 * checks the numbers. Skips unknown keys.
 *
 * Independent of starg_decomposition_read, which uses the same field table as the writer. The two
 * share only the JSON parser, so a mistake in the table shows here. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/json.h"
#include "core/memory.h"
#include "starguard/verify.h"

static const char STAGE[] = "pieces file";

/* State of the reader: the first error ends it. */
typedef struct reader {
    starg_context *context;
    const char *name;
    starg_status status;
} reader;

static void reject(reader *r, const char *key, const char *expected) {
    if (r->status == STARG_OK)
        r->status = starg_fail(r->context, STARG_ERROR_FORMAT, STAGE,
                               "'%s' is not a valid pieces report: \"%s\" must be %s", r->name, key,
                               expected);
}

static size_t read_count(reader *r, const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    if (json_is_integer(value) && json_integer_value(value) >= 0)
        return (size_t)json_integer_value(value);
    reject(r, key, "a whole number, zero or more");
    return 0;
}

static double read_real(reader *r, const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    if (json_is_number(value))
        return json_number_value(value);
    reject(r, key, "a number");
    return 0;
}

/* Of what is 0 if it is not given: a number that is told is above. */
static double read_told(reader *r, const json_t *object, const char *key) {
    return fmax(read_real(r, object, key), DBL_MIN);
}

static bool read_bool(reader *r, const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    if (!json_is_boolean(value))
        reject(r, key, "true or false");
    return json_is_true(value);
}

/* Which of two words? 0 for the first one. */
static int read_word(reader *r, const json_t *object, const char *key, const char *first,
                     const char *second) {
    const char *word = json_string_value(json_object_get(object, key));
    char expected[64];
    if (word != NULL && (strcmp(word, first) == 0 || strcmp(word, second) == 0))
        return strcmp(word, second) == 0;
    snprintf(expected, sizeof expected, "\"%s\" or \"%s\"", first, second);
    reject(r, key, expected);
    return 0;
}

static void read_point(reader *r, const json_t *object, const char *key, double point[3]) {
    const json_t *list = json_object_get(object, key);
    bool good = json_array_size(list) == 3;
    for (size_t k = 0; k < 3 && good; k++) {
        const json_t *x = json_array_get(list, k);
        point[k] = json_number_value(x);
        good = json_is_number(x) && fabs(point[k]) < 1e100;
    }
    if (!good)
        reject(r, key, "an array of three numbers below 1e100");
}

static void read_pieces(reader *r, const json_t *list, starg_pieces_report *report) {
    starg_status status = STARG_OK;
    if (!json_is_array(list) || json_array_size(list) == 0) {
        reject(r, "pieces", "an array that is not empty");
        return;
    }
    report->piece_count = json_array_size(list);
    STARG_NEW_ZERO(r->context, STAGE, report->pieces, report->piece_count);
    for (size_t i = 0; i < report->piece_count; i++) {
        const json_t *object = json_array_get(list, i);
        starg_piece *piece = &report->pieces[i];
        read_point(r, object, "guard", piece->guard);
        piece->tetrahedra = read_count(r, object, "tetrahedra");
        piece->volume = read_real(r, object, "volume");
        piece->star = read_bool(r, object, "star");
        piece->radius = read_real(r, object, "radius");
        piece->margin = read_real(r, object, "margin");
    }
done:
    if (status != STARG_OK)
        r->status = status;
}

static bool read_contact(const json_t *triple, starg_piece_contact *contact) {
    const json_t *first = json_array_get(triple, 0), *second = json_array_get(triple, 1);
    const json_t *area = json_array_get(triple, 2);
    if (json_array_size(triple) != 3 || !json_is_integer(first) || !json_is_integer(second) ||
        !json_is_number(area))
        return false;
    json_int_t i = json_integer_value(first), j = json_integer_value(second);
    *contact = (starg_piece_contact){(uint32_t)i, (uint32_t)j, json_number_value(area)};
    return i >= 0 && i <= INT32_MAX && j >= 0 && j <= INT32_MAX;
}

static void read_contacts(reader *r, const json_t *list, starg_pieces_report *report) {
    starg_status status = STARG_OK;
    if (!json_is_array(list)) {
        reject(r, "adjacency", "an array");
        return;
    }
    report->contact_count = json_array_size(list);
    STARG_NEW_ZERO(r->context, STAGE, report->contacts, report->contact_count);
    for (size_t i = 0; i < report->contact_count; i++)
        if (!read_contact(json_array_get(list, i), &report->contacts[i]))
            reject(r, "adjacency", "an array of [piece, piece, area]");
done:
    if (status != STARG_OK)
        r->status = status;
}

/* Relation of the boundary to the model; files without the keys keep the surface. */
static void read_surface(reader *r, const json_t *root, starg_pieces_report *report) {
    if (json_object_get(root, "surface") != NULL)
        report->approximated = read_word(r, root, "surface", "kept", "approximated") == 1;
    report->distance_back = INFINITY;
    if (!report->approximated)
        return;
    report->distance = read_real(r, root, "distance");
    report->distance_back = read_real(r, root, "distance_back");
}

static void read_model(reader *r, const json_t *model, starg_pieces_report *report) {
    starg_status status = STARG_OK;
    const char *file = json_string_value(json_object_get(model, "file"));
    report->model_vertices = read_count(r, model, "vertices");
    if (json_object_get(model, "tetrahedra") != NULL)
        report->model_tetrahedra = read_count(r, model, "tetrahedra");
    else
        report->model_faces = read_count(r, model, "faces");
    if (file == NULL)
        return;
    size_t size = strlen(file) + 1;
    STARG_NEW(r->context, STAGE, report->file, size);
    memcpy(report->file, file, size);
done:
    if (status != STARG_OK)
        r->status = status;
}

static void read_balls(reader *r, const json_t *balls, starg_pieces_report *report) {
    report->balls = balls != NULL;
    if (!report->balls)
        return;
    read_word(r, balls, "kind", "rays", "even");
    report->ball_worst = read_real(r, balls, "worst");
    report->ball_mean = read_real(r, balls, "mean");
    if (json_object_get(balls, "above_10") != NULL)
        report->ball_above_10 = read_real(r, balls, "above_10");
}

static void read_document(reader *r, const json_t *root, starg_pieces_report *report) {
    const char *format = json_string_value(json_object_get(root, "format"));
    if (format == NULL || strcmp(format, "starguard-pieces") != 0)
        reject(r, "format", "\"starguard-pieces\"");
    if (read_count(r, root, "version") != 1)
        reject(r, "version", "1, the only supported one");
    read_model(r, json_object_get(root, "model"), report);
    report->mode = read_word(r, root, "mode", "strict", "paper") == 0 ? STARG_DECOMPOSE_STRICT
                                                                      : STARG_DECOMPOSE_PAPER;
    report->tetrahedra = read_count(r, root, "tetrahedra");
    read_pieces(r, json_object_get(root, "pieces"), report);
    read_contacts(r, json_object_get(root, "adjacency"), report);
    report->strictly_star = read_count(r, root, "strictly_star");
    report->visible_vertices = read_real(r, root, "visible_vertices");
    report->flattest = read_told(r, root, "flattest");
    report->smallest_angle = read_told(r, root, "smallest_angle");
    report->median_angle = read_told(r, root, "median_angle");
    read_surface(r, root, report);
    if (json_object_get(root, "smallest_angle_made") != NULL)
        report->smallest_angle_made = read_told(r, root, "smallest_angle_made");
    if (json_object_get(root, "lower_bound") != NULL) {
        report->lower_bound = read_count(r, root, "lower_bound");
        report->optimal = read_bool(r, root, "optimal");
    }
    read_balls(r, json_object_get(root, "balls"), report);
}

starg_status starg_pieces_report_read_memory(starg_context *context, const void *bytes, size_t size,
                                             const char *name, starg_pieces_report **out) {
    starg_status status = STARG_OK;
    reader r = {context, name, STARG_OK};
    starg_pieces_report *report = NULL;
    json_t *root = NULL;
    *out = NULL;
    STARG_TRY(starg_json_parse(context, STAGE, name, bytes, size, &root));
    STARG_NEW_ZERO(context, STAGE, report, 1);
    read_document(&r, root, report);
    STARG_TRY(r.status);
    *out = report;
done:
    json_decref(root);
    if (status != STARG_OK)
        starg_pieces_report_free(context, report);
    return status;
}

void starg_pieces_report_free(starg_context *context, starg_pieces_report *report) {
    if (report == NULL)
        return;
    starg_release(context, report->file);
    starg_release(context, report->pieces);
    starg_release(context, report->contacts);
    starg_release(context, report);
}
