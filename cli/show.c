/* SPDX-License-Identifier: Apache-2.0 */
#include "show.h"
#include "commands.h"
#include "scene.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "starguard/animation.h"

enum { HEAD = 4096 }; /* bytes used to recognize a file */

/* ---- kinds of files ---- */

typedef enum kind {
    KIND_MODEL,
    KIND_RESULT, /* guards, a certificate, pieces, a report of pieces, a map between solids */
    KIND_SKELETON,
    KIND_FRAMES,
    KIND_ANIMATION,
    KIND_DATABASE,
    KIND_TABLE
} kind;

/* Does an OBJ or VTK file have no faces, or edges before the first one? */
static bool is_curve(FILE *file) {
    char *line = NULL;
    size_t capacity = 0;
    bool edges = false, faces = false;
    rewind(file);
    while (!edges && !faces && getline(&line, &capacity, file) >= 0) {
        edges = strncmp(line, "l ", 2) == 0;
        faces = strncmp(line, "f ", 2) == 0 || strncmp(line, "POLYGONS ", 9) == 0 ||
                strncmp(line, "TRIANGLE_STRIPS ", 16) == 0;
    }
    free(line);
    return !faces;
}

/* Has a binary glTF morph targets, as animations have? Its words lie in a first chunk of JSON. */
static bool is_animation(const char *head, FILE *file) {
    char *word = NULL;
    size_t capacity = 0;
    bool targets = false;
    const uint8_t *size =
        (const uint8_t *)head + 12; /* little endian, after magic, version and size */
    long end = 20 + (long)(size[0] | size[1] << 8 | size[2] << 16 | (uint32_t)size[3] << 24);
    rewind(file);
    while (!targets && ftell(file) < end && getdelim(&word, &capacity, '"', file) > 0)
        targets = strcmp(word, "targets\"") == 0;
    free(word);
    return targets;
}

static kind kind_of_content(const char *name, const char *head, size_t size, FILE *file) {
    static const char database[] = "SQLite format 3", vtk[] = "# vtk",
                      curve[] = "# D:", certificate[] = "starguard-certificate";
    const char *first = head + strspn(head, " \t\r\n");
    if (size >= sizeof database && memcmp(head, database, sizeof database) == 0)
        return KIND_DATABASE;
    if (memcmp(head, "glTF", 4) == 0)
        return is_animation(head, file) ? KIND_ANIMATION : KIND_MODEL;
    if (strncmp(head, vtk, sizeof vtk - 1) == 0)
        return strstr(head, "DATASET POLYDATA") == NULL ? KIND_RESULT
               : is_curve(file)                         ? KIND_SKELETON
                                                        : KIND_MODEL;
    if (strncmp(head, curve, sizeof curve - 1) == 0 || cli_has_extension(name, ".swc"))
        return KIND_SKELETON;
    if (strstr(head, "<VTKFile") != NULL && strstr(head, "PolyData") != NULL)
        return KIND_MODEL;
    if (cli_has_extension(name, ".gltf") || cli_has_extension(name, ".dae") ||
        cli_has_extension(name, ".x3d"))
        return KIND_MODEL;
    if (*first == '{' || strncmp(first, "<?xml", 5) == 0 || strncmp(first, "<VTKFile", 8) == 0 ||
        strncmp(head, certificate, sizeof certificate - 1) == 0)
        return KIND_RESULT;
    if (cli_has_extension(name, ".csv"))
        return KIND_TABLE;
    return cli_has_extension(name, ".obj") && is_curve(file) ? KIND_SKELETON : KIND_MODEL;
}

/* A file that cannot be opened is left to a reader, which reports why. */
static kind kind_of(const char *name) {
    char head[HEAD + 1] = {0};
    struct stat info;
    if (strcmp(name, "-") == 0)
        return KIND_RESULT;
    if (stat(name, &info) != 0 || !(S_ISREG(info.st_mode) || S_ISDIR(info.st_mode)))
        return KIND_RESULT;
    if (S_ISDIR(info.st_mode))
        return KIND_FRAMES;
    FILE *file = fopen(name, "rb");
    if (file == NULL)
        return KIND_RESULT;
    size_t size = fread(head, 1, HEAD, file);
    kind found = kind_of_content(name, head, size, file);
    fclose(file);
    return found;
}

/* ---- results ---- */

static starg_status fail_twice(cli_session *session, const char *what, const char *file) {
    return cli_fail(session, STARG_ERROR_ARGUMENT,
                    "'%.300s' is a second %s; give at most one of each kind", file, what);
}

static starg_status take_result(cli_session *session, size_t operand, cli_show *show) {
    const char *file = session->operands[operand];
    starg_status status = starg_result_read(session->context, file, &show->results[operand]);
    if (status != STARG_OK)
        return status;
    const starg_result *result = show->results[operand];
    starg_page *page = &show->page;
    if (result->guards != NULL) {
        if (page->guards != NULL)
            return fail_twice(session, "guards file", file);
        show->guards = page->guards = result->guards;
        show->guards_file = file;
    } else if (result->certificate != NULL) {
        if (show->proof != NULL)
            return fail_twice(session, "certificate", file);
        status =
            starg_certificate_outline_create(session->context, result->certificate, &show->proof);
        page->proof = show->proof;
    } else if (result->pieces != NULL) {
        if (page->pieces != NULL)
            return fail_twice(session, "pieces file", file);
        page->pieces = result->pieces;
        show->pieces_file = file;
    } else if (result->solid_map != NULL) {
        if (page->map != NULL)
            return fail_twice(session, "map", file);
        page->map = result->solid_map;
    } else if (result->map != NULL || result->morph != NULL) {
        return cli_fail(session, STARG_ERROR_ARGUMENT, "'%.300s' has no page; %s", file,
                        result->map != NULL ? "'starguard map --picture' draws a map"
                                            : "give the folder of the morph");
    } else {
        if (page->report != NULL)
            return fail_twice(session, "pieces report", file);
        page->report = result->report;
        show->report_file = file;
    }
    return status;
}

static starg_status take_animation(cli_session *session, const char *file, cli_show *show) {
    show->from_animation = true;
    return starg_animation_read(session->context, file, &show->frames, &show->frame_count);
}

/* `model` becomes the operand that is a model. */
static starg_status take_operand(cli_session *session, size_t operand, int distance,
                                 const char **model, cli_show *show) {
    const char *file = session->operands[operand];
    kind found = kind_of(file);
    switch (found) {
    case KIND_MODEL:
        if (*model != NULL)
            return fail_twice(session, "model", file);
        *model = file;
        return STARG_OK;
    case KIND_RESULT:
        return take_result(session, operand, show);
    case KIND_SKELETON:
        if (show->skeleton != NULL)
            return fail_twice(session, "skeleton", file);
        return starg_skeleton_read(session->context, file, &show->skeleton);
    case KIND_FRAMES:
    case KIND_ANIMATION:
        if (show->frame_count > 0)
            return fail_twice(session, "morph", file);
        return found == KIND_FRAMES ? cli_show_frames(session, file, show)
                                    : take_animation(session, file, show);
    case KIND_DATABASE:
    case KIND_TABLE:
        if (show->shape_count > 0)
            return fail_twice(session, "shape table", file);
        return found == KIND_TABLE ? cli_show_table(session, file, show)
                                   : cli_show_database(session, file, distance, show);
    }
    return STARG_OK;
}

static starg_status take_operands(cli_session *session, int distance, const char **model,
                                  cli_show *show) {
    starg_status status = STARG_OK;
    show->results = calloc(session->operand_count + 1, sizeof(starg_result *));
    if (show->results == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < session->operand_count && status == STARG_OK; i++)
        status = take_operand(session, i, distance, model, show);
    return status;
}

/* ---- the model ---- */

/* The model named by a result: relative to the current folder, or beside the result. The caller
 * frees it. */
static char *find_model(const char *named, const char *result) {
    struct stat info;
    if (named == NULL || strcmp(named, "-") == 0)
        return NULL;
    const char *slash = strrchr(result, '/');
    size_t folder = slash != NULL ? (size_t)(slash - result) + 1 : 0;
    if (stat(named, &info) == 0)
        return strdup(named);
    if (named[0] == '/' || folder == 0)
        return NULL;
    size_t size = folder + strlen(named) + 1;
    char *beside = malloc(size);
    if (beside != NULL)
        snprintf(beside, size, "%.*s%s", (int)folder, result, named);
    if (beside != NULL && stat(beside, &info) == 0)
        return beside;
    free(beside);
    return NULL;
}

/* The model name in the results, and the result that contains it; NULL if none does. */
static const char *named_model(const cli_show *show, const char **result) {
    const starg_page *page = &show->page;
    *result = page->guards != NULL ? show->guards_file : show->report_file;
    if (page->guards != NULL)
        return page->guards->file;
    return page->report != NULL ? page->report->file : NULL;
}

static const char *base_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash != NULL && slash[1] != '\0' ? slash + 1 : path;
}

static starg_status read_model(cli_session *session, const char *file, cli_show *show) {
    show->model_file = strdup(file);
    if (show->model_file == NULL)
        return cli_fail_memory(session);
    TRY(cli_shape_read(session, file, &show->model, &show->tetmesh));
    if (show->tetmesh != NULL)
        TRY(starg_tetmesh_surface(session->context, show->tetmesh, &show->model, NULL));
    show->page.model = show->model;
    return STARG_OK;
}

/* Guards require their model, skeletons can use one, pieces do not need it. */
static starg_status take_model(cli_session *session, const char *model, cli_show *show) {
    starg_status status = STARG_OK;
    const char *result, *named = named_model(show, &result);
    if (model != NULL)
        return read_model(session, model, show);
    if (show->page.guards == NULL && show->skeleton == NULL)
        return STARG_OK;
    char *found = find_model(named, result);
    if (found != NULL && (status = cli_name_input(session, found)) == STARG_OK)
        status = read_model(session, found, show);
    else if (found == NULL && show->page.guards != NULL)
        status = cli_fail(session, STARG_ERROR_READ,
                          "model '%.200s' of '%.200s' not found; give it with --model FILE",
                          named != NULL ? named : "-", result);
    free(found);
    return status;
}

/* ---- computed contents ---- */

static starg_status check_model(cli_session *session, const cli_show *show) {
    const starg_guards *g = show->page.guards;
    size_t vertices = starg_mesh_vertex_count(show->model);
    size_t faces = starg_mesh_face_count(show->model);
    if (g->vertex_count == vertices && g->face_count == faces)
        return STARG_OK;
    return cli_fail(session, STARG_ERROR_FORMAT,
                    "'%.200s' belongs to a model with %zu vertices and %zu faces, but this one has "
                    "%zu and %zu; give the right one with --model FILE",
                    show->guards_file, g->vertex_count, g->face_count, vertices, faces);
}

static void warn_of_faces(cli_session *session, const cli_show *show) {
    const starg_guards *g = show->page.guards;
    for (size_t i = 0; i < g->count; i++)
        if (starg_bits_count(show->seen, i) != g->seen_faces[i]) {
            cli_warn(session,
                     "warning: guard %zu sees %zu faces, but '%.200s' says %zu; this may be the "
                     "wrong model (check with 'starguard verify')",
                     i, starg_bits_count(show->seen, i), show->guards_file, g->seen_faces[i]);
            break;
        }
}

/* Shows the patches in place of the faces. */
static starg_status show_patches(cli_session *session, cli_show *show) {
    const starg_guards *g = show->page.guards;
    size_t missing = 0;
    starg_bits_free(show->seen);
    show->seen = NULL;
    TRY(starg_guards_patches(session->context, show->solid, g, &show->patches, &show->seen,
                             &show->uncovered, &missing));
    show->shown = *g;
    show->shown.vertex_count = starg_mesh_vertex_count(show->patches);
    show->shown.face_count = starg_mesh_face_count(show->patches);
    show->shown.uncovered = show->uncovered;
    show->shown.uncovered_count = missing;
    show->page.guards = &show->shown;
    show->page.model = show->patches;
    return STARG_OK;
}

/* Computes what every guard sees, and compares it with the file. */
static starg_status see(cli_session *session, cli_show *show) {
    starg_status status = STARG_OK;
    const starg_guards *g = show->page.guards;
    starg_mesh **obstacles = NULL;
    CLI_TRY(check_model(session, show));
    CLI_TRY(cli_scene_read_obstacles(session, g, &obstacles));
    CLI_TRY(starg_guards_scene(session->context, show->model, (const starg_mesh *const *)obstacles,
                               g, &show->solid));
    CLI_TRY(cli_scene_join(session, obstacles, g->obstacle_count, &show->obstacles));
    show->page.obstacles = show->obstacles;
    CLI_TRY(starg_guards_see(session->context, show->solid, g, &show->seen));
    warn_of_faces(session, show);
    if (!g->time_limited) /* what a clock has stopped does not come again */
        CLI_TRY(cli_guard_command(session, g, base_of(show->guards_file), &show->command));
    show->page.command = show->command;
    if (g->options.visibility.patch > 0)
        CLI_TRY(show_patches(session, show));
    show->page.seen = show->seen;
done:
    cli_scene_free_obstacles(obstacles, g->obstacle_count);
    return status;
}

/* The skeleton to show: computes radii from the solid if the file has none. */
static starg_status measure(cli_session *session, cli_show *show) {
    const starg_skeleton *s = show->skeleton;
    show->measured = *s;
    show->page.skeleton = &show->measured;
    if (s->radii != NULL || show->solid == NULL)
        return STARG_OK;
    show->radii = malloc(s->node_count * sizeof *show->radii);
    if (show->radii == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < s->node_count; i++)
        show->radii[i] = starg_solid_distance(show->solid, s->positions + 3 * i);
    show->measured.radii = show->radii;
    return STARG_OK;
}

/* Can it be read once more? */
static bool is_regular(const char *name) {
    struct stat info;
    return stat(name, &info) == 0 && S_ISREG(info.st_mode);
}

/* Does the third line of PIECES.vtk say so? */
static bool is_binary(const char *name) {
    char head[HEAD + 1] = {0};
    FILE *file = fopen(name, "rb");
    if (file == NULL)
        return false;
    size_t size = fread(head, 1, HEAD, file);
    fclose(file);
    const char *line = size > 0 ? strchr(head, '\n') : NULL;
    line = line != NULL ? strchr(line + 1, '\n') : NULL;
    return line != NULL && strncmp(line + 1, "BINARY", 6) == 0;
}

/* What a clock has stopped does not come again, and there is no option for a target. A report that
 * contradicts itself is shown, without a command. */
static starg_status recall_pieces(cli_session *session, cli_show *show) {
    starg_decomposition *d = NULL;
    if (!is_regular(show->pieces_file) || !is_regular(show->report_file))
        return STARG_OK;
    starg_status status = starg_decomposition_read(session->context, NULL, show->report_file, &d);
    if (status == STARG_ERROR_FORMAT)
        return STARG_OK;
    const cli_pieces_files files = {base_of(show->pieces_file), base_of(show->report_file),
                                    is_binary(show->pieces_file)};
    if (status == STARG_OK && d->options_known && !d->time_limited && d->options.tetra.target == 0)
        status = cli_decompose_command(session, d, &files, &show->pieces_command);
    show->page.pieces_command = show->pieces_command;
    starg_decomposition_free(session->context, d);
    return status;
}

static starg_status compute(cli_session *session, cli_show *show) {
    bool radii = show->skeleton != NULL && show->skeleton->radii == NULL;
    if (show->page.guards != NULL)
        TRY(see(session, show));
    else if (show->model != NULL && radii)
        TRY(starg_solid_create(session->context, show->model, &show->solid));
    if (show->skeleton != NULL)
        TRY(measure(session, show));
    if (show->page.report != NULL)
        TRY(recall_pieces(session, show));
    return STARG_OK;
}

/* ---- public function ---- */

/* The page's title is the model, or the first file. */
static void fill_page(const cli_session *session, const char *model, cli_show *show) {
    starg_page *page = &show->page;
    page->frames = (const starg_mesh *const *)show->frames;
    page->frame_count = show->frame_count;
    page->shapes = show->shapes;
    page->shape_count = show->shape_count;
    page->table_command = show->table_command;
    page->distances = show->distances != NULL ? show->distances : show->table.distances;
    const char *result, *named = model != NULL ? model : named_model(show, &result);
    page->title =
        show->title != NULL ? show->title : base_of(named != NULL ? named : session->operands[0]);
    page->model_name = show->model != NULL ? base_of(named) : NULL;
}

starg_status cli_show_read(cli_session *session, const char *model, int distance, cli_show *show) {
    TRY(take_operands(session, distance, &model, show));
    if (show->page.report != NULL && show->page.pieces == NULL)
        return cli_fail(session, STARG_ERROR_READ,
                        "'%.200s' is a report without tetrahedra; add its PIECES.vtk",
                        show->report_file);
    TRY(take_model(session, model, show));
    TRY(compute(session, show));
    fill_page(session, model, show);
    return STARG_OK;
}

static void free_frames(starg_context *context, cli_show *show) {
    if (show->from_animation) {
        starg_animation_free(context, show->frames, show->frame_count);
        return;
    }
    for (size_t i = 0; i < show->frame_count; i++)
        starg_mesh_free(show->frames[i]);
    free(show->frames);
}

void cli_show_free(cli_session *session, cli_show *show) {
    starg_context *context = session->context;
    for (size_t i = 0; show->results != NULL && i < session->operand_count; i++)
        starg_result_free(context, show->results[i]);
    free(show->results);
    free_frames(context, show);
    cli_show_free_shapes(session, show);
    free(show->radii);
    free(show->model_file);
    for (int end = 0; end < 2; end++)
        starg_guards_free(session->context, show->ends[end]);
    free(show->command);
    free(show->pieces_command);
    free(show->table_command);
    free(show->title);
    starg_skeleton_free(context, show->skeleton);
    starg_bits_free(show->seen);
    starg_mesh_free(show->patches);
    starg_patches_free(context, show->uncovered);
    starg_certificate_outline_free(context, show->proof);
    starg_solid_free(show->solid);
    starg_mesh_free(show->model);
    starg_mesh_free(show->obstacles);
    starg_tetmesh_free(show->tetmesh);
}
