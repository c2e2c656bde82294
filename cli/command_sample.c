/* SPDX-License-Identifier: Apache-2.0 */
/* starguard sample: generates procedural solids. */
#include "commands.h"
#include "starguard/sample.h"

typedef struct values {
    const char *output;
    starg_sample_options wanted;
    bool list;
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("FILE.off|.obj|.ply|.stl|.vtp", "Mesh; '-' writes OFF to standard output."),
    CLI_FLAG_OPTION("list", list, "List the samples and their poses."),
};

static const char *sample_word(size_t index) {
    const starg_sample_info *info = starg_sample_at(index);
    return info != NULL ? info->name : NULL;
}

static starg_status list_samples(cli_session *session) {
    json_t *list = json_array();
    cli_report_head(session, "starguard-samples", NULL, NULL);
    for (size_t i = 0; i < starg_sample_count(); i++) {
        const starg_sample_info *info = starg_sample_at(i);
        cli_say(session, "%-12s %s%s\n", info->name, info->description,
                info->poses > 1 ? "" : " (one pose)");
        cli_append(session, list,
                   json_pack("{s:s, s:s, s:i}", "name", info->name, "description",
                             info->description, "poses", info->poses));
    }
    if (session->report != NULL)
        cli_put(session, session->report, "samples", list);
    else
        json_decref(list);
    return STARG_OK;
}

static starg_status check_name(cli_session *session, const char *name) {
    cli_suggestion near;
    cli_suggest_begin(&near, name);
    for (size_t i = 0; i < starg_sample_count(); i++)
        cli_suggest_try(&near, starg_sample_at(i)->name);
    if (near.best == NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "there is no sample '%.100s'; 'starguard sample --list' lists them", name);
    if (near.distance > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "there is no sample '%.100s'; did you mean '%s'?", name, near.best);
    return STARG_OK;
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_mesh_format format;
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    if (v->list)
        return list_samples(session);
    if (session->operand_count == 0 || v->output == NULL)
        return cli_fail(
            session, STARG_ERROR_ARGUMENT,
            "give a sample and an output: starguard sample NAME -o FILE; --list lists the names");
    const char *name = session->operands[0];
    TRY(check_name(session, name));
    TRY(cli_mesh_format(session, v->output, &format));
    TRY(cli_announce(session, v->output));
    TRY(starg_sample_create(session->context, name, &v->wanted, &mesh));
    TRY(cli_mesh_write(session, mesh, format, v->output));
    cli_say(session, "%s, pose %d: %zu vertices, %zu faces\n", name, v->wanted.pose,
            starg_mesh_vertex_count(mesh), starg_mesh_face_count(mesh));
    cli_report_head(session, "starguard-sample", v->output, mesh);
    return STARG_OK;
}

const cli_command cli_command_sample = {
    .name = "sample",
    .usage = "[NAME] -o FILE [--pose K] [--vertices N] [--list]",
    .summary = "generate a sample solid",
    .description = "Generates a closed solid for experiments: animals and a person in several "
                   "poses, families of ten different vases, busts, bearings, tables and tools, "
                   "rooms and machine parts. The same options give the same file.",
    .examples = "# list the samples\n"
                "starguard sample --list\n"
                "# a horse in its third pose with about 20,000 vertices\n"
                "starguard sample horse --pose 2 --vertices 20000 -o horse.off\n"
                "# the fourth of ten vases\n"
                "starguard sample vase --pose 3 -o vase.off\n"
                "# piped into another command\n"
                "starguard sample gallery -o - | starguard check -",
    CLI_OPTIONS(options),
    CLI_OPERANDS(0, 1),
    .operand_word = sample_word,
    CLI_LIBRARY(starg_sample_options_fields, wanted),
    .run = run,
};
