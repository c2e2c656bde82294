/* SPDX-License-Identifier: Apache-2.0 */
/* starguard db query: finds the stored models most similar to a given one. */
#include "commands.h"
#include "database.h"

typedef struct values {
    uint64_t count;
    int distance;
} values;

static const cli_option options[] = {
    {CLI_OPTION("count", STARG_FIELD_COUNT, count, "N", "Number of models to list."), .letter = 'k',
     .least = 1, .most = UINT32_MAX, .initial = 10},
    CLI_DISTANCE_OPTION,
};

static void tell(cli_session *session, const starg_database_models *found) {
    for (size_t i = 0; i < found->count; i++)
        cli_say(session, "%4zu  %-12.6g %s\n", i + 1, found->items[i].distance,
                found->items[i].path);
    if (found->count == 0)
        cli_say(session, "the database is empty\n");
}

static void report(cli_session *session, const values *v, const starg_mesh *mesh,
                   const starg_database_models *found) {
    json_t *list = json_array();
    cli_report_head(session, "starguard-db-query", session->operands[1], mesh);
    cli_put(session, session->report, "database", cli_json_text(session->operands[0]));
    cli_put(session, session->report, "distance", json_string(cli_distance_words[v->distance]));
    for (size_t i = 0; i < found->count; i++) {
        json_t *model = cli_json_model(&found->items[i]);
        cli_put(session, model, "distance", cli_json_real(found->items[i].distance));
        cli_append(session, list, model);
    }
    cli_put(session, session->report, "models", list);
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_context *context = session->context;
    starg_status status = STARG_OK;
    starg_database *database = NULL;
    starg_mesh *mesh = NULL;
    starg_signature *signature = NULL;
    starg_database_models *found = NULL;
    CLI_TRY(cli_database_open(session, &database));
    CLI_TRY(starg_mesh_read(context, session->operands[1], &mesh));
    CLI_TRY(starg_signature_create(context, mesh, (starg_signature_kind)v->distance, &signature));
    CLI_TRY(starg_database_query(database, signature, v->count, &found));
    tell(session, found);
    if (session->report != NULL)
        report(session, v, mesh, found);
done:
    starg_database_models_free(context, found);
    starg_signature_free(context, signature);
    starg_mesh_free(mesh);
    starg_database_close(database);
    return status;
}

const cli_command cli_command_db_query = {
    .name = "db query",
    .usage = "DB MODEL [-k N] [options]",
    .summary = "find the stored models most similar to a given one",
    .description = "Lists the stored models nearest to MODEL with their distances. MODEL itself "
                   "need not be stored. Distances of different kinds are not comparable.",
    .examples = "# the five nearest models\n"
                "starguard db query shapes.db new.off -k 5\n"
                "# the nearest one by another distance, for a script\n"
                "starguard db query shapes.db new.off -k 1 --distance star --json | jq .models[0]",
    CLI_OPTIONS(options),
    CLI_OPERANDS(2, 2),
    .run = run,
};
