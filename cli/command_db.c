/* SPDX-License-Identifier: Apache-2.0 */
/* starguard db: the group of database commands. */
#include "commands.h"

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
