/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of what guards see, of the commands that have guards. */
#ifndef STARGUARD_CLI_TABLES_H
#define STARGUARD_CLI_TABLES_H

#include "session.h"
#include "starguard/guard.h"

typedef struct cli_tables {
    const char *table, *summary;
} cli_tables;

/* Rows for a struct `values` with a member `tables`. */
#define CLI_TABLE_OPTIONS                                                                          \
    CLI_TEXT_OPTION("table", tables.table, "FILE.csv",                                             \
                    "A row for each face: its group, area, seen share, how many cameras see some " \
                    "of it and each part of it at least, and which.",                              \
                    .group = "output"),                                                            \
        CLI_TEXT_OPTION("summary", tables.summary, "FILE.csv",                                     \
                        "A row for each camera: the area that it sees, and that it alone sees, "   \
                        "and its mean density of pixels; and for each group of faces: the shares " \
                        "of its area that at least 1, 2 and 3 cameras see.",                       \
                        .group = "output")

static inline bool cli_tables_wanted(const cli_tables *tables) {
    return tables->table != NULL || tables->summary != NULL;
}

/* Announces them. */
starg_status cli_tables_announce(cli_session *session, const cli_tables *tables);

/* The groups of faces of a model by its file; none of standard input, or of another number of
 * faces. Free with starg_face_groups_free. */
starg_status cli_groups_read(cli_session *session, const char *model, size_t faces,
                             starg_face_groups *groups, bool *any);

/* Writes them, of the session's solid; groups of faces are those of the first operand. */
starg_status cli_tables_write(cli_session *session, const cli_tables *tables,
                              const starg_guards *guards);

#endif
