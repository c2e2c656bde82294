/* SPDX-License-Identifier: Apache-2.0 */
/* starguard match: computes the distance between two models. */
#include "commands.h"
#include "database.h"

typedef struct values {
    int distance;
} values;

static const cli_option options[] = {CLI_CHOICE_OPTION(
    "distance", distance, cli_distance_words, STARG_SIGNATURE_STAR, "star|paper|shape-dna|d2",
    "star: what guards see and how pieces conduct, independent of pose. paper: cost of deforming "
    "one guarding graph into the other. shape-dna: Laplace-Beltrami spectrum. d2: distances "
    "between random surface points.")};

static starg_status make_signature(cli_session *session, const char *file,
                                   starg_signature_kind kind, starg_signature **out) {
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
    starg_mesh_free(mesh);
    return status;
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_context *context = session->context;
    starg_signature_kind kind = (starg_signature_kind)v->distance;
    starg_status status = STARG_OK;
    starg_signature *a = NULL, *b = NULL;
    double distance;
    CLI_TRY(make_signature(session, session->operands[0], kind, &a));
    CLI_TRY(make_signature(session, session->operands[1], kind, &b));
    CLI_TRY(starg_signature_distance(context, a, b, &distance));
    cli_say(session, "%.6g\n", distance);
    if (session->report != NULL) {
        cli_report_head(session, "starguard-match", NULL, NULL);
        cli_put(session, session->report, "models",
                json_pack("[o, o]", cli_json_text(session->operands[0]),
                          cli_json_text(session->operands[1])));
        cli_put(session, session->report, "kind", json_string(cli_distance_words[kind]));
        cli_put(session, session->report, "distance", cli_json_real(distance));
    }
done:
    starg_signature_free(context, a);
    starg_signature_free(context, b);
    return status;
}

const cli_command cli_command_match = {
    .name = "match",
    .usage = "A B [--distance star|paper|shape-dna|d2]",
    .summary = "compute the distance between two shapes",
    .description = "Prints the distance between two shapes: 0 for identical shapes, larger for "
                   "less similar ones. A and B are models, or descriptors from 'starguard "
                   "describe' (for star and paper), all with the same options. Distances of "
                   "different kinds are not comparable (docs/retrieval.md).",
    .examples = "# independent of pose\n"
                "starguard match cat.off dog.off\n"
                "# the published distance, from stored descriptors\n"
                "starguard match cat.json dog.json --distance paper",
    CLI_OPTIONS(options),
    CLI_OPERANDS(2, 2),
    .run = run,
};
