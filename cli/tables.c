/* SPDX-License-Identifier: Apache-2.0 */
#include "scene.h"

#include <string.h>

starg_status cli_tables_announce(cli_session *session, const cli_tables *tables) {
    TRY(cli_announce_with_extension(session, "--table", tables->table, ".csv"));
    return cli_announce_with_extension(session, "--summary", tables->summary, ".csv");
}

starg_status cli_groups_read(cli_session *session, const char *model, size_t faces,
                             starg_face_groups *groups, bool *any) {
    *any = strcmp(model, "-") != 0;
    if (*any)
        TRY(starg_face_groups_read(session->context, model, groups));
    *any = *any && groups->face_count == faces;
    return STARG_OK;
}

starg_status cli_tables_write(cli_session *session, const cli_tables *tables,
                              const starg_guards *guards) {
    SCOPED_BY(cli_groups_free) starg_face_groups groups = {0};
    bool any = false;
    if (!cli_tables_wanted(tables))
        return STARG_OK;
    TRY(cli_groups_read(session, session->operands[0], starg_space_model_faces(session->solid),
                        &groups, &any));
    const starg_face_groups *used = any ? &groups : NULL;
    if (tables->table != NULL)
        TRY(starg_guards_write_table(session->context, session->solid, guards, used,
                                     cli_outputs_place(&session->outputs, tables->table)));
    if (tables->summary != NULL)
        TRY(starg_guards_write_summary(session->context, session->solid, guards, used,
                                       cli_outputs_place(&session->outputs, tables->summary)));
    return STARG_OK;
}
