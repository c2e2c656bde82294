/* SPDX-License-Identifier: Apache-2.0 */
/* starguard match: computes the distance between two models. */
#include "commands.h"
#include "database.h"

typedef struct values {
    int distance;
    cli_weights weights;
} values;

static const cli_option options[] = {
    CLI_CHOICE_OPTION(
        "distance", distance, cli_distance_words, STARG_SIGNATURE_STAR, "star|paper|shape-dna|d2",
        "star: what guards see and how pieces conduct, independent of pose. paper: cost of "
        "deforming "
        "one guarding graph into the other. shape-dna: Laplace-Beltrami spectrum. d2: distances "
        "between random surface points."),
    CLI_ALIGN_OPTIONS(weights)};

/* The mesh, too, if it is one. */
static starg_status make_signature(cli_session *session, const char *file,
                                   starg_signature_kind kind, starg_signature **out,
                                   starg_mesh **model) {
    starg_status status = STARG_OK;
    starg_mesh *mesh = NULL;
    starg_descriptor *descriptor = NULL;
    CLI_TRY(cli_described_read(session, file, &mesh, &descriptor));
    if (mesh != NULL)
        CLI_TRY(starg_signature_create(session->context, mesh, kind, out));
    else if (starg_signature_needs_descriptor(kind))
        CLI_TRY(starg_signature_of_descriptor(session->context, descriptor, kind, out));
    else
        status = cli_fail(session, STARG_ERROR_ARGUMENT,
                          "'%s' is a descriptor; --distance %s needs the model itself", file,
                          cli_distance_words[kind]);
done:
    starg_descriptor_free(session->context, descriptor);
    *model = mesh;
    return status;
}

static starg_status align(cli_session *session, const starg_mesh *const *models,
                          starg_alignment *out) {
    for (size_t i = 0; i < 2; i++)
        if (models[i] == NULL)
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "'%s' is a descriptor; --align needs the model itself",
                            session->operands[i]);
    return starg_alignment_measure(session->context, models[0], models[1], out);
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_context *context = session->context;
    starg_signature_kind kind = (starg_signature_kind)v->distance;
    starg_status status = STARG_OK;
    starg_signature *a = NULL, *b = NULL;
    starg_mesh *models[2] = {NULL, NULL};
    starg_alignment alignment;
    double distance, weighed;
    CLI_TRY(cli_weights_check(session, &v->weights));
    CLI_TRY(make_signature(session, session->operands[0], kind, &a, &models[0]));
    CLI_TRY(make_signature(session, session->operands[1], kind, &b, &models[1]));
    CLI_TRY(starg_signature_distance(context, a, b, &distance));
    if (v->weights.align)
        CLI_TRY(align(session, (const starg_mesh *const *)models, &alignment));
    weighed = v->weights.align ? cli_weigh(&v->weights, &alignment, distance) : distance;
    cli_say(session, "%.6g\n", weighed);
    if (v->weights.align)
        cli_say_alignment(session, &alignment);
    if (session->report != NULL) {
        cli_report_head(session, "starguard-match", NULL, NULL);
        cli_put(session, session->report, "models",
                json_pack("[o, o]", cli_json_text(session->operands[0]),
                          cli_json_text(session->operands[1])));
        cli_put(session, session->report, "kind", json_string(cli_distance_words[kind]));
        cli_put(session, session->report, "distance", cli_json_real(weighed));
        if (v->weights.align)
            cli_put(session, session->report, "alignment", cli_json_alignment(&alignment));
    }
done:
    starg_mesh_free(models[0]);
    starg_mesh_free(models[1]);
    starg_signature_free(context, a);
    starg_signature_free(context, b);
    return status;
}

const cli_command cli_command_match = {
    .name = "match",
    .usage = "A B [--distance star|paper|shape-dna|d2] [--align]",
    .summary = "compute the distance between two shapes",
    .description = "Prints the distance between two shapes: 0 for identical shapes, larger for "
                   "less similar ones. A and B are models, or descriptors from 'starguard "
                   "describe' (for star and paper), all with the same options. Distances of "
                   "different kinds are not comparable (docs/retrieval.md).",
    .examples = "# independent of pose\n"
                "starguard match cat.off dog.off\n"
                "# the published distance, from stored descriptors\n"
                "starguard match cat.json dog.json --distance paper\n"
                "# is one the mirror image of the other, and how large?\n"
                "starguard match cat.off dog.off --align",
    CLI_OPTIONS(options),
    CLI_OPERANDS(2, 2),
    .run = run,
};
