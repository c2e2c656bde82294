/* SPDX-License-Identifier: Apache-2.0 */
#include "database.h"

#include <math.h>
#include <stdlib.h>

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

/* ---- scale and hand ---- */

starg_status cli_weights_check(cli_session *session, const cli_weights *w) {
    if (w->align || (w->scale == 0 && w->mirror == 0))
        return STARG_OK;
    return cli_fail(session, STARG_ERROR_ARGUMENT,
                    "--weigh-scale and --weigh-mirror weigh what --align finds; add it");
}

double cli_weigh(const cli_weights *w, const starg_alignment *alignment, double distance) {
    return distance + w->scale * fabs(log2(alignment->scale)) +
           (alignment->hand == STARG_HAND_MIRRORED ? w->mirror : 0);
}

void cli_say_alignment(cli_session *session, const starg_alignment *a) {
    cli_say(session, "scale %.6g, hand %s (off by %.2g %% of the diagonal, mirrored by %.2g %%)\n",
            a->scale, starg_hand_name(a->hand), 100 * a->same, 100 * a->mirrored);
}

json_t *cli_json_alignment(const starg_alignment *a) {
    return json_pack("{s:o, s:s, s:o, s:o}", "scale", cli_json_real(a->scale), "hand",
                     starg_hand_name(a->hand), "same", cli_json_real(a->same), "mirrored",
                     cli_json_real(a->mirrored));
}

/* ---- all distances ---- */

static starg_status make_distances(cli_session *session, cli_table *t) {
    size_t count = t->models->count;
    SCOPED starg_signature **signatures = calloc(count, sizeof(starg_signature *));
    t->distances = count <= SIZE_MAX / sizeof(double) / count
                       ? malloc(count * count * sizeof *t->distances)
                       : NULL;
    if (signatures == NULL || t->distances == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < count; i++)
        signatures[i] = t->models->items[i].signature;
    return starg_signature_distances(session->context, signatures, count, t->distances);
}

starg_status cli_table_make(cli_session *session, const char *file, int kind, cli_table *t) {
    TRY(starg_database_open(session->context, file, &t->database));
    TRY(starg_database_signatures(t->database, (starg_signature_kind)kind, &t->models));
    if (t->models->count == 0)
        return cli_fail(session, STARG_ERROR_FORMAT,
                        "'%s' has no models; add some with 'starguard db add'", file);
    return make_distances(session, t);
}

void cli_table_free(cli_table *t) {
    free(t->distances);
    starg_database_models_free(NULL, t->models);
    starg_database_close(t->database);
}
