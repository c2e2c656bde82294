#include "database.h"

#include "report.h"

const char *const cli_distance_words[] = {
    [STARG_SIGNATURE_D2] = "d2",     [STARG_SIGNATURE_SHAPE_DNA] = "shape-dna",
    [STARG_SIGNATURE_STAR] = "star", [STARG_SIGNATURE_PAPER] = "paper",
    [STARG_SIGNATURE_KINDS] = NULL,
};

starg_status cli_database_open(cli_session *session, starg_database **out) {
    return starg_database_open(session->context, session->operands[0], out);
}

json_t *cli_json_model(const starg_database_model *model) {
    return json_pack("{s:I, s:o, s:o, s:I, s:I}", "id", (json_int_t)model->id, "name",
                     cli_json_text(model->name), "path", cli_json_text(model->path), "vertices",
                     (json_int_t)model->vertices, "faces", (json_int_t)model->faces);
}
