/* SPDX-License-Identifier: Apache-2.0 */
/* starguard export: writes a model with its results to one file for other programs. */
#include <string.h>

#include "commands.h"
#include "show.h"
#include "starguard/scene.h"

typedef struct values {
    const char *output, *model;
    starg_scene_format format; /* from the name of the output */
} values;

static const cli_option options[] = {
    CLI_OUTPUT_OPTION("FILE.glb|.vtu|.ply|.obj|.3mf",
                      "Output; its extension selects the format (docs/formats.md); '-' writes .glb "
                      "to standard output."),
    CLI_INPUT_OPTION("model", model, "FILE",
                     "Model of the results. Default: the model that they name, relative to the "
                     "current folder or to the result."),
};

static starg_status choose_format(cli_session *session, const char *name,
                                  starg_scene_format *format) {
    static const cli_extension known[] = {{".glb", STARG_SCENE_GLB},
                                          {".vtu", STARG_SCENE_VTU},
                                          {".ply", STARG_SCENE_PLY},
                                          {".obj", STARG_SCENE_OBJ},
                                          {".3mf", STARG_SCENE_3MF}};
    int found;
    starg_status status = cli_format_by_extension(
        session, name, known, sizeof known / sizeof *known, STARG_SCENE_GLB, &found);
    *format = (starg_scene_format)found;
    return status;
}

static starg_status prepare(cli_session *session, void *data) {
    values *v = data;
    TRY(cli_announce_needed(session, v->output, "FILE.glb, .vtu, .ply, .obj or .3mf"));
    return choose_format(session, v->output, &v->format);
}

static starg_status check_kinds(cli_session *session, const starg_page *page) {
    if (page->frame_count > 0)
        return cli_fail(
            session, STARG_ERROR_ARGUMENT,
            "a scene cannot contain a morph; 'starguard morph --glb FILE' writes an animation");
    if (page->map != NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "a scene cannot contain a map between solids; MAP.vtu itself opens in "
                        "ParaView");
    if (page->shape_count > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "a scene cannot contain a table of shapes; 'starguard db matrix' writes a "
                        "table and a picture");
    return STARG_OK;
}

/* Reports the contents of the file. */
static void tell(cli_session *session, const values *v, const cli_show *show) {
    const starg_page *page = &show->page;
    const struct {
        const char *name, *key;
        size_t count;
    } parts[] = {{"model faces", "model_faces",
                  page->model != NULL ? starg_mesh_face_count(page->model) : 0},
                 {"obstacle faces", "obstacle_faces",
                  page->obstacles != NULL ? starg_mesh_face_count(page->obstacles) : 0},
                 {"guards", "guards", page->guards != NULL ? page->guards->count : 0},
                 {"tetrahedra", "tetrahedra", page->pieces != NULL ? page->pieces->count : 0},
                 {"skeleton nodes", "skeleton_nodes",
                  page->skeleton != NULL ? page->skeleton->node_count : 0}};
    json_t *written = json_object();
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (parts[i].count == 0)
            continue;
        cli_say(session, "%-14s %zu\n", parts[i].name, parts[i].count);
        cli_put(session, written, parts[i].key, json_integer((json_int_t)parts[i].count));
    }
    if (session->report == NULL) {
        json_decref(written);
        return;
    }
    cli_report_head(session, "starguard-export", page->model_name, page->model);
    cli_put(session, session->report, "output", cli_json_text(v->output));
    cli_put(session, session->report, "written", written);
}

/* The groups in the model's file, which only a GLB names. */
static starg_status read_groups(cli_session *session, const values *v, const cli_show *show,
                                starg_face_groups *groups) {
    const char *file = show->model_file;
    if (v->format != STARG_SCENE_GLB || show->tetmesh != NULL || file == NULL ||
        strcmp(file, "-") == 0)
        return STARG_OK;
    return starg_face_groups_read(session->context, file, groups);
}

/* The same of what is shown: of patches in place of faces the group of the face; free `of`. */
static starg_status fit_groups(cli_session *session, const cli_show *show,
                               const starg_face_groups *groups, uint32_t **of,
                               starg_face_groups *out) {
    *out = *groups;
    if (groups->count > 0 && show->patches != NULL &&
        groups->face_count == show->guards->face_count) {
        TRY(starg_guards_patch_faces(session->context, show->solid, show->guards, of,
                                     &out->face_count));
        for (size_t i = 0; i < out->face_count; i++)
            (*of)[i] = groups->of[(*of)[i]];
        out->of = *of;
    }
    return STARG_OK;
}

static starg_status run(cli_session *session, void *data) {
    const values *v = data;
    starg_status status = STARG_OK;
    cli_show show = {0};
    starg_face_groups groups = {0}, shown;
    uint32_t *of = NULL;
    const starg_page *page = &show.page;
    CLI_TRY(cli_show_read(session, v->model, STARG_SIGNATURE_DEFAULT, &show));
    CLI_TRY(check_kinds(session, page));
    CLI_TRY(read_groups(session, v, &show, &groups));
    CLI_TRY(fit_groups(session, &show, &groups, &of, &shown));
    bool fit = page->model != NULL && shown.face_count == starg_mesh_face_count(page->model);
    const starg_scene scene = {.model = page->model,
                               .obstacles = page->obstacles,
                               .guards = page->guards,
                               .seen = page->seen,
                               .pieces = page->pieces,
                               .report = page->report,
                               .skeleton = page->skeleton,
                               .groups = fit && shown.count > 0 ? &shown : NULL};
    CLI_TRY(starg_scene_write(session->context, &scene,
                              cli_outputs_place(&session->outputs, v->output), v->format));
    tell(session, v, &show);
done:
    starg_patches_free(session->context, of);
    starg_face_groups_free(session->context, &groups);
    cli_show_free(session, &show);
    return status;
}

const cli_command cli_command_export = {
    .name = "export",
    .usage = "RESULT... [--model FILE] -o FILE.glb|.vtu|.ply|.obj|.3mf [options]",
    .summary = "export a model with guards, pieces and skeleton for other programs",
    .description =
        "Writes results and their model into one file. Inputs are recognized by "
        "content, at most one of each kind: GUARDS.json, PIECES.vtk and PIECES.json, a "
        "skeleton (.obj, .cg, .vtk, .swc), a model.\n"
        ".glb (Blender, browsers, three.js): a named node for the model and each of its groups, "
        "obstacles, "
        "each guard, each piece and the skeleton; extras hold the data of guards and pieces.\n"
        ".vtu (ParaView, VTK): one grid of faces, tetrahedra, points and lines; cell "
        "data give the part, the piece, and the guard that sees a face.\n"
        ".ply (MeshLab): faces coloured by piece, or by the guard that sees them.\n"
        ".obj: one object per part.\n"
        ".3mf (printers): one object per piece, or the model if there are none, in millimetres.",
    .examples = "# guards and pieces of a model for Blender\n"
                "starguard guard horse.off -o guards.json\n"
                "starguard decompose horse.off -o pieces.vtk --report pieces.json\n"
                "starguard export guards.json pieces.vtk pieces.json -o horse.glb\n"
                "# which guard sees which face, for ParaView\n"
                "starguard export guards.json -o guards.vtu\n"
                "# a model with its skeleton\n"
                "starguard skeleton horse.off -o skeleton.vtk\n"
                "starguard export skeleton.vtk --model horse.off -o skeleton.glb",
    CLI_OPTIONS(options),
    CLI_OPERANDS(1, SIZE_MAX),
    .prepare = prepare,
    .run = run,
};
