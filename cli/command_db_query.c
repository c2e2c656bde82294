/* SPDX-License-Identifier: Apache-2.0 */
/* starguard db query: finds the stored models most similar to a given one. */
#include <stdlib.h>
#include <sys/stat.h>

#include "commands.h"
#include "database.h"

CLI_DROP(starg_database_models, starg_database_models)
CLI_DROP(starg_signature, starg_signature)

typedef struct values {
    uint64_t count;
    int distance;
    cli_weights weights;
} values;

/* A stored model that was found; aligned, if it is still where it was. */
typedef struct found_model {
    const starg_database_model *model;
    double distance; /* with what the weights add */
    bool aligned;
    starg_alignment alignment;
} found_model;

static const cli_option options[] = {
    {CLI_OPTION("count", STARG_FIELD_COUNT, count, "N", "Number of models to list."), .letter = 'k',
     .least = 1, .most = UINT32_MAX, .initial = 10},
    CLI_DISTANCE_OPTION,
    CLI_ALIGN_OPTIONS(weights)};

/* A model that cannot be read is not aligned; this is not an error. */
static starg_status align(cli_session *session, const starg_mesh *mesh, const values *v,
                          found_model *found) {
    starg_status status = STARG_OK;
    starg_mesh *other = NULL;
    struct stat info;
    found->distance = found->model->distance;
    if (!v->weights.align || stat(found->model->path, &info) != 0 || !S_ISREG(info.st_mode))
        return STARG_OK;
    status = starg_mesh_read(session->context, found->model->path, &other);
    if (status == STARG_OK)
        status = starg_alignment_measure(session->context, mesh, other, &found->alignment);
    starg_mesh_free(other);
    if (status == STARG_ERROR_READ || status == STARG_ERROR_FORMAT || status == STARG_ERROR_MESH)
        return STARG_OK;
    found->aligned = status == STARG_OK;
    if (found->aligned)
        found->distance = cli_weigh(&v->weights, &found->alignment, found->distance);
    return status;
}

/* By distance; on ties the order stays. */
static void sort(found_model *list, size_t count) {
    for (size_t i = 1; i < count; i++)
        for (size_t k = i; k > 0 && list[k - 1].distance > list[k].distance; k--) {
            found_model swap = list[k];
            list[k] = list[k - 1];
            list[k - 1] = swap;
        }
}

static void tell(cli_session *session, const values *v, const found_model *list, size_t count) {
    for (size_t i = 0; i < count; i++) {
        cli_say(session, "%4zu  %-12.6g %s\n", i + 1, list[i].distance, list[i].model->path);
        if (v->weights.align)
            cli_say(session, "      ");
        if (list[i].aligned)
            cli_say_alignment(session, &list[i].alignment);
        else if (v->weights.align)
            cli_say(session, "not aligned: the model cannot be read there\n");
    }
    if (count == 0)
        cli_say(session, "the database is empty\n");
}

static void report(cli_session *session, const values *v, const starg_mesh *mesh,
                   const found_model *found, size_t count) {
    json_t *list = json_array();
    cli_report_head(session, "starguard-db-query", session->operands[1], mesh);
    cli_put(session, session->report, "database", cli_json_text(session->operands[0]));
    cli_put(session, session->report, "distance", json_string(cli_distance_words[v->distance]));
    for (size_t i = 0; i < count; i++) {
        json_t *model = cli_json_model(found[i].model);
        cli_put(session, model, "distance", cli_json_real(found[i].distance));
        if (v->weights.align)
            cli_put(session, model, "alignment",
                    found[i].aligned ? cli_json_alignment(&found[i].alignment) : json_null());
        cli_append(session, list, model);
    }
    cli_put(session, session->report, "models", list);
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_context *context = session->context;
    SCOPED_BY(cli_database_drop) starg_database *database = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED_BY(starg_signature_drop) starg_signature *signature = NULL;
    SCOPED_BY(starg_database_models_drop) starg_database_models *found = NULL;
    SCOPED found_model *list = NULL;
    TRY(cli_weights_check(session, &v->weights));
    TRY(cli_database_open(session, &database));
    TRY(starg_mesh_read(context, session->operands[1], &mesh));
    TRY(starg_signature_create(context, mesh, (starg_signature_kind)v->distance, &signature));
    TRY(starg_database_query(database, signature, v->count, &found));
    list = calloc(found->count + 1, sizeof *list);
    if (list == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < found->count; i++) {
        list[i].model = &found->items[i];
        TRY(align(session, mesh, v, &list[i]));
    }
    sort(list, found->count);
    tell(session, v, list, found->count);
    if (session->report != NULL)
        report(session, v, mesh, list, found->count);
    return STARG_OK;
}

const cli_command cli_command_db_query = {
    .name = "db query",
    .usage = "DB MODEL [-k N] [options]",
    .summary = "find the stored models most similar to a given one",
    .description = "Lists the stored models nearest to MODEL with their distances. MODEL itself "
                   "need not be stored. Distances of different kinds are not comparable. --align "
                   "also reads the models found, where they were when they were added.",
    .examples = "# the five nearest models\n"
                "starguard db query shapes.db new.off -k 5\n"
                "# the nearest one by another distance, for a script\n"
                "starguard db query shapes.db new.off -k 1 --distance star --json | jq .models[0]",
    CLI_OPTIONS(options),
    CLI_OPERANDS(2, 2),
    .run = run,
};
