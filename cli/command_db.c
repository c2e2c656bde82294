/* SPDX-License-Identifier: Apache-2.0 */
/* starguard db: the group of the commands about a retrieval database. */
#include "commands.h"

static const cli_command *const members[] = {
    &cli_command_db_create, &cli_command_db_add,    &cli_command_db_remove,   &cli_command_db_list,
    &cli_command_db_query,  &cli_command_db_matrix, &cli_command_db_evaluate, NULL,
};

const cli_command cli_command_db = {
    .name = "db",
    .usage = "COMMAND DB ... [options]",
    .summary = "store shapes, find similar ones, measure how well that works",
    .description =
        "Keeps signatures of models in a database, an SQLite file (docs/formats.md), finds "
        "the stored models most like a given one, and measures how well distances tell "
        "classes of shapes apart (docs/retrieval.md). 'starguard db COMMAND --help' tells "
        "all about one.",
    .examples = "# a database of some models, and what is most like another one\n"
                "starguard db create shapes.db\n"
                "starguard db add shapes.db models/*.off\n"
                "starguard db query shapes.db new.off -k 5\n"
                "# how well do distances find models of the same class (cat_1.off: class cat)\n"
                "starguard db evaluate shapes.db --classes by-prefix",
    .members = members,
};
