/* SPDX-License-Identifier: Apache-2.0 */
/* starguard db create, add, remove, list: manage the stored models. */
#include "commands.h"
#include "database.h"

CLI_DROP(starg_database_models, starg_database_models)
CLI_DROP(starg_database_report, starg_database_report)

static void report_file(cli_session *session, const char *format) {
    cli_report_head(session, format, NULL, NULL);
    if (session->report != NULL)
        cli_put(session, session->report, "database", cli_json_text(session->operands[0]));
}

/* ---- create ---- */

static starg_status create(cli_session *session, void *data) {
    (void)data;
    TRY(starg_database_create(session->context, session->operands[0]));
    cli_say(session, "%s: an empty database\n", session->operands[0]);
    report_file(session, "starguard-db-create");
    return STARG_OK;
}

const cli_command cli_command_db_create = {
    .name = "db create",
    .usage = "DB [options]",
    .summary = "create an empty database",
    .description = "Creates an empty database. Existing files are never overwritten.",
    .examples = "# create a database and add models\n"
                "starguard db create shapes.db\n"
                "starguard db add shapes.db models/*.off",
    CLI_OPERANDS(1, 1),
    .run = create,
};

/* ---- add ---- */

static const char *const outcome_words[] = {
    [STARG_DATABASE_ADDED] = "added",
    [STARG_DATABASE_KNOWN] = "known",
    [STARG_DATABASE_REFUSED] = "refused",
};

static json_t *result_json(cli_session *session, const char *file,
                           const starg_database_result *result) {
    json_t *object = json_object();
    cli_put(session, object, "file", cli_json_text(file));
    cli_put(session, object, "outcome", json_string(outcome_words[result->outcome]));
    if (result->text != NULL)
        cli_put(session, object, result->outcome == STARG_DATABASE_KNOWN ? "as" : "message",
                cli_json_text(result->text));
    return object;
}

/* Reports what happened to the files; rejected ones last, where they are noticed. */
static void tell_added(cli_session *session, const starg_database_report *r) {
    for (size_t i = 0; i < r->count; i++)
        if (r->results[i].outcome == STARG_DATABASE_KNOWN)
            cli_say(session, "%s: already stored as %s\n", session->operands[i + 1],
                    r->results[i].text);
    cli_say(session, "%zu added, %zu already stored, %zu refused\n", r->added, r->known,
            r->refused);
    for (size_t i = 0; i < r->count; i++)
        if (r->results[i].outcome == STARG_DATABASE_REFUSED)
            cli_warn(session, "not added: %s", r->results[i].text);
        else if (r->results[i].outcome == STARG_DATABASE_ADDED && r->results[i].text != NULL)
            cli_warn(session, "warning: '%s': %s", session->operands[i + 1], r->results[i].text);
    if (r->refused > 0)
        session->outcome = CLI_EXIT_UNFINISHED;
}

static void report_added(cli_session *session, const starg_database_report *r) {
    json_t *list = json_array(), *report = session->report;
    report_file(session, "starguard-db-add");
    cli_put(session, report, "added", json_integer((json_int_t)r->added));
    cli_put(session, report, "known", json_integer((json_int_t)r->known));
    cli_put(session, report, "refused", json_integer((json_int_t)r->refused));
    for (size_t i = 0; i < r->count; i++)
        cli_append(session, list, result_json(session, session->operands[i + 1], &r->results[i]));
    cli_put(session, report, "files", list);
}

static starg_status add(cli_session *session, void *data) {
    (void)data;
    SCOPED_BY(cli_database_drop) starg_database *database = NULL;
    SCOPED_BY(starg_database_report_drop) starg_database_report *report = NULL;
    TRY(cli_database_open(session, &database));
    TRY(starg_database_add(database, (const char *const *)session->operands + 1,
                           session->operand_count - 1, &report));
    tell_added(session, report);
    if (session->report != NULL)
        report_added(session, report);
    return STARG_OK;
}

const cli_command cli_command_db_add = {
    .name = "db add",
    .usage = "DB MODEL... [options]",
    .summary = "add models with their signatures",
    .description =
        "Computes signatures of models and stores them under the given paths. Files with stored "
        "content are skipped, whatever their name. Unusable files do not stop the others from "
        "being added: they are listed at the end, and the exit status is 3. Several processes may "
        "add to one database at once. After an interruption, repeat the command to continue.",
    .examples =
        "# add all models of a folder\n"
        "starguard db add shapes.db models/*.off\n"
        "# list the refused files, for a script\n"
        "starguard db add shapes.db *.stl --json | jq '.files[] | select(.outcome == \"refused\")'",
    CLI_OPERANDS(2, SIZE_MAX),
    .run = add,
};

/* ---- remove ---- */

static starg_status run_remove(cli_session *session, void *data) {
    (void)data;
    SCOPED_BY(cli_database_drop) starg_database *database = NULL;
    size_t count = session->operand_count - 1;
    TRY(cli_database_open(session, &database));
    TRY(starg_database_remove(database, (const char *const *)session->operands + 1, count));
    cli_say(session, "%s removed\n", cli_count_of(count, "model", "models").text);
    report_file(session, "starguard-db-remove");
    if (session->report != NULL)
        cli_put(session, session->report, "removed", json_integer((json_int_t)count));
    return STARG_OK;
}

const cli_command cli_command_db_remove = {
    .name = "db remove",
    .usage = "DB MODEL... [options]",
    .summary = "remove models",
    .description =
        "Removes all named models, or none if one of them is not found. Name a model by the path "
        "under which it was added, by its file name, or as id:N with its number from 'db list'.",
    .examples = "# by name\n"
                "starguard db remove shapes.db cat_1.off\n"
                "# by path, and by number\n"
                "starguard db remove shapes.db models/cat_2.off id:3",
    CLI_OPERANDS(2, SIZE_MAX),
    .run = run_remove,
};

/* ---- list ---- */

static void report_list(cli_session *session, const starg_database_models *models) {
    json_t *list = json_array();
    report_file(session, "starguard-db-list");
    for (size_t i = 0; i < models->count; i++) {
        json_t *model = cli_json_model(&models->items[i]);
        cli_put(session, model, "hash", json_string(models->items[i].hash));
        cli_append(session, list, model);
    }
    cli_put(session, session->report, "models", list);
}

static starg_status list(cli_session *session, void *data) {
    (void)data;
    SCOPED_BY(cli_database_drop) starg_database *database = NULL;
    SCOPED_BY(starg_database_models_drop) starg_database_models *models = NULL;
    TRY(cli_database_open(session, &database));
    TRY(starg_database_list(database, &models));
    for (size_t i = 0; i < models->count; i++) {
        const starg_database_model *model = &models->items[i];
        cli_say(session, "%6lld  %-24s %8zu vertices %8zu faces  %s\n", (long long)model->id,
                model->name, model->vertices, model->faces, model->path);
    }
    cli_say(session, "%s\n", cli_count_of(models->count, "model", "models").text);
    if (session->report != NULL)
        report_list(session, models);
    return STARG_OK;
}

const cli_command cli_command_db_list = {
    .name = "db list",
    .usage = "DB [options]",
    .summary = "list the stored models",
    .description = "Lists the stored models, sorted by file name.",
    .examples = "# list all models\n"
                "starguard db list shapes.db\n"
                "# only the file names, for a script\n"
                "starguard db list shapes.db --json | jq -r '.models[].name'",
    CLI_OPERANDS(1, 1),
    .run = list,
};

/* starguard db: the group of database commands. */

static const cli_command *const members[] = {
    &cli_command_db_create, &cli_command_db_add,    &cli_command_db_remove,   &cli_command_db_list,
    &cli_command_db_query,  &cli_command_db_matrix, &cli_command_db_evaluate, NULL,
};

const cli_command cli_command_db = {
    .name = "db",
    .usage = "COMMAND DB ... [options]",
    .summary = "store shapes, find similar ones, evaluate retrieval",
    .description =
        "Stores signatures of models in an SQLite database (docs/formats.md), finds the models "
        "most similar to a given one, and evaluates how well distances separate classes of shapes "
        "(docs/retrieval.md). 'starguard db COMMAND --help' explains one command.",
    .examples = "# make a database and find the models most similar to another one\n"
                "starguard db create shapes.db\n"
                "starguard db add shapes.db models/*.off\n"
                "starguard db query shapes.db new.off -k 5\n"
                "# evaluate retrieval by class (cat_1.off: class cat)\n"
                "starguard db evaluate shapes.db --classes by-prefix",
    .members = members,
};
