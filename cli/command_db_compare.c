/* SPDX-License-Identifier: Apache-2.0 */
/* starguard db matrix, evaluate: compare all stored models with one another. */
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "database.h"
#include "starguard/picture.h"

CLI_DROP(starg_classes, starg_classes)

typedef struct values {
    const char *output, *picture, *classes;
    int distance;
} values;

static void report_head(cli_session *session, const values *v, const char *format) {
    cli_report_head(session, format, NULL, NULL);
    cli_put(session, session->report, "database", cli_json_text(session->operands[0]));
    cli_put(session, session->report, "distance", json_string(cli_distance_words[v->distance]));
}

/* ---- matrix ---- */

static const cli_option matrix_options[] = {
    CLI_OUTPUT_OPTION("FILE.csv", "Distance matrix, one row and column per model, sorted by file "
                                  "name; '-' writes to standard output."),
    CLI_TEXT_OPTION("picture", picture, "FILE.png",
                    "Matrix as a picture with the names of up to 120 models: black is similar, "
                    "white is different."),
    CLI_DISTANCE_OPTION,
};

static starg_status prepare_matrix(cli_session *session, void *data) {
    const values *v = data;
    if (v->output == NULL && v->picture == NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "no output; add -o FILE.csv, --picture FILE.png, or both");
    TRY(cli_announce_with_extension(session, "-o", v->output, ".csv"));
    return cli_announce_with_extension(session, "--picture", v->picture, ".png");
}

static starg_status write_matrix(cli_session *session, const char *name, const cli_table *t) {
    size_t count = t->models->count;
    cli_csv csv;
    TRY(cli_csv_open(session, name, &csv));
    cli_csv_text(&csv, "model");
    for (size_t i = 0; i < count; i++)
        cli_csv_text(&csv, t->models->items[i].name);
    cli_csv_end_line(&csv);
    for (size_t i = 0; i < count; i++) {
        cli_csv_text(&csv, t->models->items[i].name);
        for (size_t k = 0; k < count; k++)
            cli_csv_real(&csv, t->distances[i * count + k]);
        cli_csv_end_line(&csv);
    }
    return cli_csv_close(&csv);
}

static starg_status draw_matrix(cli_session *session, const char *name, const cli_table *t) {
    size_t count = t->models->count;
    const char **names = malloc(count * sizeof *names);
    if (names == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < count; i++)
        names[i] = t->models->items[i].name;
    starg_status status = starg_matrix_picture_write(session->context, t->distances, count, names,
                                                     cli_outputs_place(&session->outputs, name));
    free(names);
    return status;
}

static starg_status run_matrix(cli_session *session, void *data) {
    const values *v = data;
    SCOPED_BY(cli_table_free) cli_table t = {0};
    TRY(cli_table_make(session, session->operands[0], v->distance, &t));
    if (v->picture != NULL)
        TRY(draw_matrix(session, v->picture, &t));
    if (v->output != NULL)
        TRY(write_matrix(session, v->output, &t));
    cli_say(session, "%s, %s distances\n", cli_count_of(t.models->count, "model", "models").text,
            cli_distance_words[v->distance]);
    if (session->report != NULL) {
        report_head(session, v, "starguard-db-matrix");
        cli_put(session, session->report, "models", json_integer((json_int_t)t.models->count));
    }
    return STARG_OK;
}

const cli_command cli_command_db_matrix = {
    .name = "db matrix",
    .usage = "DB -o FILE.csv [--picture FILE.png] [options]",
    .summary = "compute all pairwise distances",
    .description = "Computes the distance between each pair of stored models, sorted by file name.",
    .examples = "# as a table and a picture\n"
                "starguard db matrix shapes.db -o distances.csv --picture distances.png\n"
                "# with another distance\n"
                "starguard db matrix shapes.db -o seen.csv --distance star",
    .options = matrix_options,
    .option_count = sizeof matrix_options / sizeof *matrix_options,
    .values_size = sizeof(values),
    CLI_OPERANDS(1, 1),
    .prepare = prepare_matrix,
    .run = run_matrix,
};

starg_status cli_matrix_command(cli_session *session, const char *database, int distance,
                                const char *output, char **line) {
    values v = {.distance = distance};
    starg_context_options usual; /* distances do not depend on the seed */
    starg_context_options_default(&usual);
    return cli_command_print(session, &cli_command_db_matrix, &v, usual.seed, database, output,
                             line);
}

/* ---- evaluate ---- */

static const cli_option evaluate_options[] = {
    CLI_INPUT_OPTION(
        "classes", classes, "by-prefix|FILE",
        "Classes of the models: by-prefix (default) takes the file name up to the last '_'; a FILE "
        "has lines 'MODEL CLASS', and models it does not name are left out."),
    CLI_DISTANCE_OPTION,
    CLI_OUTPUT_OPTION(
        "FILE.csv",
        "Precision-recall curves, overall and per class; '-' writes to standard output."),
    CLI_TEXT_OPTION("picture", picture, "FILE.svg", "Precision-recall curves as a picture."),
};

static starg_status prepare_evaluate(cli_session *session, void *data) {
    const values *v = data;
    TRY(cli_announce_with_extension(session, "-o", v->output, ".csv"));
    return cli_announce_with_extension(session, "--picture", v->picture, ".svg");
}

typedef struct evaluation {
    const starg_classes *classes;
    const starg_retrieval *by_class, *overall;
    double recall[STARG_RECALL_LEVELS];
} evaluation;

static const struct {
    const char *key, *head;
    size_t offset;
} measures[] = {{"nearest_neighbour", "nearest", offsetof(starg_retrieval, nearest_neighbour)},
                {"first_tier", "tier 1", offsetof(starg_retrieval, first_tier)},
                {"second_tier", "tier 2", offsetof(starg_retrieval, second_tier)},
                {"e_measure", "E", offsetof(starg_retrieval, e_measure)},
                {"dcg", "DCG", offsetof(starg_retrieval, dcg)}};
enum { MEASURES = sizeof measures / sizeof *measures };

static double measure(const starg_retrieval *r, size_t i) {
    const void *at = (const char *)r + measures[i].offset;
    return *(const double *)at;
}

static void tell_line(cli_session *session, const char *name, const starg_retrieval *r) {
    cli_say(session, "%-16s %6zu", name, r->models);
    for (size_t i = 0; i < MEASURES && r->queries > 0; i++)
        cli_say(session, "  %7.3f", measure(r, i));
    cli_say(session, "\n");
}

static void tell_evaluation(cli_session *session, const evaluation *e) {
    cli_say(session, "%-16s %6s", "class", "models");
    for (size_t i = 0; i < MEASURES; i++)
        cli_say(session, "  %7s", measures[i].head);
    cli_say(session, "\n");
    for (size_t c = 0; c < e->classes->count; c++)
        tell_line(session, e->classes->names[c], &e->by_class[c]);
    tell_line(session, "all", e->overall);
}

static void put_measures(cli_session *session, json_t *object, const starg_retrieval *r) {
    for (size_t i = 0; i < MEASURES; i++)
        cli_put(session, object, measures[i].key,
                r->queries > 0 ? json_real(measure(r, i)) : json_null());
    cli_put(session, object, "models", json_integer((json_int_t)r->models));
    cli_put(session, object, "queries", json_integer((json_int_t)r->queries));
}

static void report_evaluation(cli_session *session, const values *v, const evaluation *e) {
    json_t *classes = json_object(), *precision = json_array(), *report = session->report;
    report_head(session, v, "starguard-db-evaluate");
    put_measures(session, report, e->overall);
    for (size_t i = 0; i < STARG_RECALL_LEVELS; i++)
        cli_append(session, precision, json_pack("[f, f]", e->recall[i], e->overall->precision[i]));
    cli_put(session, report, "precision_at_recall", precision);
    for (size_t c = 0; c < e->classes->count; c++) {
        json_t *class = json_object(), *name = cli_json_text(e->classes->names[c]);
        put_measures(session, class, &e->by_class[c]);
        cli_put(session, classes, json_string_value(name), class);
        json_decref(name);
    }
    cli_put(session, report, "classes", classes);
}

static starg_status write_precision(cli_session *session, const char *name, const evaluation *e) {
    cli_csv csv;
    TRY(cli_csv_open(session, name, &csv));
    cli_csv_text(&csv, "recall");
    cli_csv_text(&csv, "all");
    for (size_t c = 0; c < e->classes->count; c++)
        cli_csv_text(&csv, e->classes->names[c]);
    cli_csv_end_line(&csv);
    for (size_t i = 0; i < STARG_RECALL_LEVELS; i++) {
        cli_csv_real(&csv, e->recall[i]);
        cli_csv_real(&csv, e->overall->precision[i]);
        for (size_t c = 0; c < e->classes->count; c++)
            cli_csv_real(&csv, e->by_class[c].precision[i]);
        cli_csv_end_line(&csv);
    }
    return cli_csv_close(&csv);
}

static starg_status draw_precision(cli_session *session, const char *name, const evaluation *e) {
    starg_curve *curves = calloc(e->classes->count + 1, sizeof *curves);
    if (curves == NULL)
        return cli_fail_memory(session);
    curves[0] = (starg_curve){"all", e->recall, e->overall->precision, STARG_RECALL_LEVELS, true};
    size_t count = 1;
    for (size_t c = 0; c < e->classes->count; c++)
        if (e->by_class[c].queries > 0)
            curves[count++] = (starg_curve){e->classes->names[c], e->recall,
                                            e->by_class[c].precision, STARG_RECALL_LEVELS, false};
    starg_status status = starg_chart_write(session->context, curves, count, "recall", "precision",
                                            cli_outputs_place(&session->outputs, name));
    free(curves);
    return status;
}

static starg_status make_classes(cli_session *session, const values *v, const cli_table *t,
                                 starg_classes **out) {
    if (v->classes == NULL || strcmp(v->classes, "by-prefix") == 0)
        return starg_classes_by_prefix(session->context, t->models, out);
    return starg_classes_read(session->context, v->classes, t->models, out);
}

static starg_status deliver(cli_session *session, const values *v, evaluation *e) {
    for (size_t i = 0; i < STARG_RECALL_LEVELS; i++)
        e->recall[i] = (double)(i + 1) / STARG_RECALL_LEVELS;
    tell_evaluation(session, e);
    if (e->overall->queries == 0)
        cli_warn(session, "warning: no class has two models; all measures are undefined");
    if (session->report != NULL)
        report_evaluation(session, v, e);
    if (v->picture != NULL)
        TRY(draw_precision(session, v->picture, e));
    if (v->output != NULL)
        TRY(write_precision(session, v->output, e));
    return STARG_OK;
}

static starg_status run_evaluate(cli_session *session, void *data) {
    const values *v = data;
    SCOPED_BY(cli_table_free) cli_table t = {0};
    SCOPED_BY(starg_classes_drop) starg_classes *classes = NULL;
    SCOPED starg_retrieval *by_class = NULL;
    starg_retrieval overall;
    TRY(cli_table_make(session, session->operands[0], v->distance, &t));
    TRY(make_classes(session, v, &t, &classes));
    by_class = calloc(classes->count + 1, sizeof *by_class);
    if (by_class == NULL)
        return cli_fail_memory(session);
    TRY(starg_retrieval_measure(session->context, t.distances, classes->class_of, t.models->count,
                                classes->count, by_class, &overall));
    evaluation e = {.classes = classes, .by_class = by_class, .overall = &overall};
    return deliver(session, v, &e);
}

const cli_command cli_command_db_evaluate = {
    .name = "db evaluate",
    .usage = "DB [--classes by-prefix|FILE] [options]",
    .summary = "evaluate retrieval by class",
    .description = "Takes each stored model as a query, ranks the others by distance and computes "
                   "nearest neighbour, first and second tier, E-measure and discounted cumulative "
                   "gain, per class and overall, each in [0, 1] (docs/retrieval.md). Models that "
                   "are alone in their class are ranked but not used as queries.",
    .examples = "# classes by name: cat_1.off, cat_2.off, dog_1.off ...\n"
                "starguard db evaluate shapes.db\n"
                "# another distance, with its precision-recall curves\n"
                "starguard db evaluate shapes.db --distance d2 -o d2.csv --picture d2.svg",
    .options = evaluate_options,
    .option_count = sizeof evaluate_options / sizeof *evaluate_options,
    .values_size = sizeof(values),
    CLI_OPERANDS(1, 1),
    .prepare = prepare_evaluate,
    .run = run_evaluate,
};
