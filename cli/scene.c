/* SPDX-License-Identifier: Apache-2.0 */
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"

const char *const cli_orientation_words[] = {"nested", "keep", NULL};

starg_status cli_scene_prepare(cli_session *session, const cli_scene *scene) {
    if ((scene->see.count > 0) + (scene->ignore.count > 0) + (scene->weights != NULL) > 1)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--see, --ignore and --weights exclude each other; weights say it all");
    if (scene->cell > 0 && scene->from.count == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--cell is the size of cubes for --from X,Y,Z; add that point");
    if ((scene->over.count > 0) != (scene->height > 0))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        scene->over.count > 0
                            ? "--over needs to know how high guards may stand above "
                              "the faces: add --height H"
                            : "--height is a height above faces: add --over FACES");
    if (scene->mount.count > 0 && !(scene->clearance > 0))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--mount needs to know how far from the faces guards hang: add --clearance "
                        "D");
    if (scene->outside && scene->standoff.count == 0 && scene->within.count == 0 &&
        scene->over.count == 0 && scene->mount.count == 0 && session->command == &cli_command_guard)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--outside needs to know how far guards may stand away: add --standoff "
                        "MIN,MAX or --within X0,Y0,Z0,X1,Y1,Z1");
    return STARG_OK;
}

static bool is_plain(const cli_scene *s) {
    return s->obstacles.count == 0 && s->orientation == STARG_ORIENTATION_NESTED && !s->outside &&
           s->standoff.count == 0 && s->within.count == 0 && s->without.count == 0 &&
           s->see.count == 0 && s->ignore.count == 0 && s->weights == NULL && !s->soup &&
           !s->two_sided && s->require.count == 0 && s->clear.count == 0 && s->from.count == 0 &&
           s->over.count == 0 && s->mount.count == 0;
}

static double diagonal(const starg_mesh *mesh) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

static void take_options(const cli_scene *s, const starg_mesh *model, starg_space_options *out) {
    starg_space_options_default(out);
    out->orientation = s->orientation;
    out->outside = s->outside;
    out->soup = s->soup;
    out->two_sided = s->two_sided;
    if (s->from.count > 0) {
        out->cell = s->cell > 0 ? s->cell : 0.01 * diagonal(model);
        memcpy(out->from, s->from.values, sizeof out->from);
    }
    out->height = s->height;
    if (s->over.count > 0)
        memcpy(out->up, s->up, sizeof out->up);
    if (s->mount.count > 0) /* room for rounding, and for refinement */
        out->mount_distance = 1.001 * s->clearance;
    if (s->standoff.count > 0) {
        out->standoff_least = s->standoff.values[0];
        out->standoff_most = s->standoff.values[1];
    }
}

/* ---- zones ---- */

static void free_zones(starg_zone *zones, size_t count) {
    for (size_t i = 0; zones != NULL && i < count; i++)
        starg_mesh_free((starg_mesh *)(uintptr_t)zones[i].mesh);
    free(zones);
}

/* A box by two opposite corners, or else a file. */
static starg_status read_zone(cli_session *session, const char *option, const char *word,
                              starg_zone *zone) {
    double corners[6];
    starg_mesh *mesh = NULL;
    if (!cli_number_list(word, corners, 6)) {
        if (access(word, F_OK) != 0 && strcmp(word, "-") != 0)
            return cli_fail(session, STARG_ERROR_READ,
                            "%s takes a box of six numbers, X0,Y0,Z0,X1,Y1,Z1, or the file of a "
                            "closed mesh, and there is no file '%.100s'",
                            option, word);
        starg_status status = starg_mesh_read(session->context, word, &mesh);
        zone->mesh = mesh;
        return status;
    }
    for (int k = 0; k < 3; k++) {
        zone->box[k] = fmin(corners[k], corners[k + 3]);
        zone->box[k + 3] = fmax(corners[k], corners[k + 3]);
        if (zone->box[k] == zone->box[k + 3])
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "%s %.100s is a box without an inside: both corners have the same %c",
                            option, word, "xyz"[k]);
    }
    return STARG_OK;
}

/* One box alone is an option of the space, as ever. */
static starg_status read_zones(cli_session *session, cli_scene *s, starg_space_options *out,
                               starg_zone **list) {
    size_t count = s->within.count + s->without.count;
    starg_zone *zones = calloc(count + 1, sizeof *zones);
    *list = zones;
    free((void *)s->zone_files);
    s->zone_files = calloc(count + 1, sizeof *s->zone_files);
    if (zones == NULL || s->zone_files == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < count; i++) {
        bool excludes = i >= s->within.count;
        const char *word = excludes ? s->without.values[i - s->within.count] : s->within.values[i];
        zones[i].excludes = excludes;
        s->zone_files[i] = word;
        TRY(read_zone(session, excludes ? "--without" : "--within", word, &zones[i]));
    }
    if (count == 1 && !zones[0].excludes && zones[0].mesh == NULL) {
        memcpy(out->within, zones[0].box, sizeof out->within);
        count = 0;
    }
    out->zones = zones;
    out->zone_count = count;
    return STARG_OK;
}

static starg_status read_obstacles(cli_session *session, const char *const *files, size_t count,
                                   starg_mesh ***out) {
    starg_status status = STARG_OK;
    starg_mesh **list = calloc(count + 1, sizeof *list);
    *out = list;
    if (list == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < count && status == STARG_OK; i++)
        status = starg_mesh_read(session->context, files[i], &list[i]);
    return status;
}

void cli_scene_free_obstacles(starg_mesh **obstacles, size_t count) {
    for (size_t i = 0; obstacles != NULL && i < count; i++)
        starg_mesh_free(obstacles[i]);
    free(obstacles);
}

/* ---- of a result ---- */

/* Ascending numbers as ranges, such as 0-11,40; NULL: out of memory. */
static char *ranges_of(const uint32_t *list, size_t count) {
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL)
        return NULL;
    for (size_t i = 0, last; i < count; i = last + 1) {
        for (last = i; last + 1 < count && list[last + 1] == list[last] + 1;)
            last++;
        fprintf(stream, "%s%u", i > 0 ? "," : "", (unsigned)list[i]);
        if (last > i)
            fprintf(stream, "-%u", (unsigned)list[last]);
    }
    if (fclose(stream) == 0)
        return text;
    free(text);
    return NULL;
}

static bool recall_faces(const uint32_t *list, size_t count, char **text, starg_texts *words) {
    if (count == 0)
        return true;
    *text = ranges_of(list, count);
    words->values = malloc(sizeof *words->values);
    if (*text == NULL || words->values == NULL)
        return false;
    words->values[words->count++] = *text;
    return true;
}

/* Are the faces to be seen alike? Then numbers tell them. */
static bool are_alike(const starg_guards *g) {
    for (size_t i = 0; i < g->target_count; i++)
        if (g->importance[i] != 1)
            return false;
    return true;
}

static bool recall_place(starg_places *places, const double *values, size_t count) {
    places->values = malloc(count * sizeof *values);
    if (places->values == NULL)
        return false;
    memcpy(places->values, values, count * sizeof *values);
    places->count = 1;
    return true;
}

static bool is_box(const double box[6]) {
    return box[0] < box[3] || box[1] < box[4] || box[2] < box[5];
}

/* Zones as words: numbers of boxes, files of meshes. */
static bool recall_zones(const starg_guards *g, cli_scene *scene) {
    char *text = NULL;
    size_t size, all = g->zone_count > 0 ? g->zone_count : is_box(g->space.within);
    scene->within.values = calloc(all + 1, sizeof *scene->within.values);
    scene->without.values = calloc(all + 1, sizeof *scene->without.values);
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL)
        return false;
    for (size_t i = 0; i < all; i++) {
        const double *box = g->zone_count > 0 ? g->zones[i].box : g->space.within;
        for (int k = 0; k < 6; k++) {
            fputs(k > 0 ? "," : "", stream);
            cli_print_real(box[k], stream);
        }
        fputc('\0', stream);
    }
    if (fclose(stream) != 0 || scene->within.values == NULL || scene->without.values == NULL) {
        free(text);
        return false;
    }
    scene->recalled[3] = text;
    for (size_t i = 0; i < all; i++, text += strlen(text) + 1) {
        const starg_guard_zone *zone = g->zone_count > 0 ? &g->zones[i] : NULL;
        starg_texts *words = zone != NULL && zone->excludes ? &scene->without : &scene->within;
        bool mesh = zone != NULL && zone->face_count > 0;
        words->values[words->count++] = !mesh ? text : zone->file != NULL ? zone->file : "ZONE";
    }
    return true;
}

static const char *const DENSITIES[] = {"monitor", "detect", "observe", "recognise", "identify"};

/* One word for each need that the result has. */
static bool recall_needs(const starg_guards *g, cli_scene *scene) {
    char *text = NULL;
    size_t size, words = 0;
    scene->require.values = calloc(g->need_count + 1, sizeof *scene->require.values);
    SCOPED uint32_t *faces = calloc(g->need_count + 1, sizeof *faces);
    FILE *stream = open_memstream(&text, &size);
    for (size_t i = 0; stream != NULL && faces != NULL && i < g->need_count; i++) {
        const starg_face_need *own = &g->needs[i];
        size_t count = 0;
        bool former = false;
        for (size_t j = 0; j < g->need_count && !former; j++) {
            bool alike = g->needs[j].times == own->times && g->needs[j].density == own->density;
            former = alike && j < i;
            if (alike)
                faces[count++] = g->needs[j].face;
        }
        char *list = former ? NULL : ranges_of(faces, count);
        if (list == NULL)
            continue;
        fprintf(stream, "%s=%u", list, (unsigned)own->times);
        if (own->density < 0) {
            fprintf(stream, ",%s", DENSITIES[(int)(STARG_DENSITY_MONITOR - own->density)]);
        } else if (own->density > 0) {
            fputc(',', stream);
            cli_print_real(own->density, stream);
        }
        fputc('\0', stream);
        words++;
        free(list);
    }
    bool done =
        stream != NULL && fclose(stream) == 0 && faces != NULL && scene->require.values != NULL;
    scene->recalled[5] = text;
    for (size_t i = 0; done && i < words; i++, text += strlen(text) + 1)
        scene->require.values[scene->require.count++] = text;
    return done;
}

starg_status cli_scene_recall(cli_session *session, const starg_guards *g, cli_scene *scene) {
    const starg_space_options *s = &g->space;
    const double standoff[2] = {s->standoff_least, s->standoff_most};
    bool done = true;
    scene->orientation = s->orientation;
    scene->outside = s->outside;
    scene->soup = s->soup;
    scene->two_sided = s->two_sided;
    scene->height = s->height;
    scene->cell = s->cell;
    if (s->cell > 0)
        done = done && recall_place(&scene->from, s->from, 3);
    if (standoff[0] > 0 || standoff[1] > 0)
        done = done && recall_place(&scene->standoff, standoff, 2);
    done = done && recall_zones(g, scene);
    done = done && recall_faces(s->over, s->over_count, &scene->recalled[0], &scene->over);
    done = done && recall_faces(s->mount, s->mount_count, &scene->recalled[1], &scene->mount);
    done = done && recall_faces(s->clear, s->clear_count, &scene->recalled[4], &scene->clear);
    if (are_alike(g))
        done = done && recall_faces(g->targets, g->target_count, &scene->recalled[2], &scene->see);
    else
        scene->weights = "WEIGHTS";
    done = done && recall_needs(g, scene);
    scene->obstacles.values = calloc(g->obstacle_count + 1, sizeof *scene->obstacles.values);
    done = done && scene->obstacles.values != NULL;
    for (size_t i = 0; i < g->obstacle_count && done; i++)
        scene->obstacles.values[scene->obstacles.count++] =
            g->obstacles[i].file != NULL ? g->obstacles[i].file : "OBSTACLE";
    return done ? STARG_OK : cli_fail_memory(session);
}

void cli_scene_forget(cli_scene *scene) {
    free(scene->from.values);
    free(scene->standoff.values);
    free((void *)scene->within.values);
    free((void *)scene->without.values);
    free((void *)scene->obstacles.values);
    free((void *)scene->over.values);
    free((void *)scene->mount.values);
    free((void *)scene->see.values);
    free((void *)scene->clear.values);
    free((void *)scene->require.values);
    for (size_t i = 0; i < sizeof scene->recalled / sizeof *scene->recalled; i++)
        free(scene->recalled[i]);
    *scene = (cli_scene){0};
}

/* ---- faces ---- */

/* Numbers and ranges on the command line, such as 0-11,40. */
static bool is_numbers(const char *word) {
    return word[strspn(word, "0123456789,-")] == '\0' && word[0] != '-' && word[0] != '\0';
}

static starg_status take_numbers(cli_session *session, const char *word, size_t faces,
                                 double **out) {
    const char *at = word;
    *out = calloc(faces + 1, sizeof **out);
    if (*out == NULL)
        return cli_fail_memory(session);
    while (*at != '\0') {
        char *end;
        unsigned long long first = strtoull(at, &end, 10), last = first;
        bool good = end != at;
        if (good && *end == '-') {
            at = end + 1;
            last = strtoull(at, &end, 10);
            good = end != at && last >= first;
        }
        if (!good || (*end != '\0' && (*end != ',' || end[1] == '\0')) || last >= faces)
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "'%.100s' is no list of faces of the model, which are 0 to %zu; write "
                            "numbers and ranges, such as 0-11,40",
                            word, faces - 1);
        for (unsigned long long f = first; f <= last; f++)
            (*out)[f] = 1;
        at = *end == ',' ? end + 1 : end;
    }
    return STARG_OK;
}

/* Values by face from the library are copied, so that all are freed alike. */
static starg_status keep_values(cli_session *session, double *values, size_t faces, double **out) {
    *out = calloc(faces + 1, sizeof **out);
    if (*out != NULL && values != NULL)
        memcpy(*out, values, faces * sizeof **out);
    starg_weights_free(session->context, values);
    return *out != NULL ? STARG_OK : cli_fail_memory(session);
}

/* The values by face that a word says: a file, numbers, or a name in the model. */
static starg_status
read_values(cli_session *session, const char *word, size_t faces,
            starg_status (*read)(starg_context *, const char *, size_t, double **), double **out) {
    starg_status status = STARG_OK;
    double *values = NULL;
    const char *model = session->operands[0];
    bool file = strcmp(word, "-") == 0 || access(word, F_OK) == 0;
    *out = NULL;
    if (!file && is_numbers(word))
        return take_numbers(session, word, faces, out);
    if (!file && strcmp(model, "-") == 0)
        return cli_fail(session, STARG_ERROR_READ,
                        "there is no file '%.100s', and names in a model need its file, not "
                        "standard input",
                        word);
    CLI_TRY(file ? read(session->context, word, faces, &values)
                 : starg_faces_named(session->context, model, word, faces, &values));
    status = keep_values(session, values, faces, out);
done:
    if (status == STARG_ERROR_ARGUMENT && !file && strpbrk(word, "/.") != NULL) /* more likely */
        status = cli_fail(session, STARG_ERROR_READ, "%s",                      /* a file */
                          starg_context_error(session->context)->message);
    return status;
}

static starg_status add_faces(cli_session *session, const char *word, size_t faces, double *sum) {
    double *values = NULL;
    starg_status status = read_values(session, word, faces, starg_faces_read, &values);
    for (size_t f = 0; status == STARG_OK && f < faces; f++)
        sum[f] = sum[f] != 0 || values[f] != 0;
    free(values);
    return status;
}

/* Words with commas between them. */
static starg_status add_each(cli_session *session, const char *words, size_t faces, double *sum) {
    starg_status status = STARG_OK;
    char *copy = strdup(words), *rest = copy, *word;
    if (copy == NULL)
        return cli_fail_memory(session);
    while (status == STARG_OK && (word = strsep(&rest, ",")) != NULL)
        status = add_faces(session, word + strspn(word, " "), faces, sum);
    free(copy);
    return status;
}

/* The faces that any of the words says, as values that are 0 elsewhere. Names may have commas. */
static starg_status read_union(cli_session *session, const starg_texts *words, size_t faces,
                               double **out) {
    starg_status status = STARG_OK;
    *out = calloc(faces + 1, sizeof **out);
    if (*out == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < words->count && status == STARG_OK; i++) {
        const char *word = words->values[i];
        status = add_faces(session, word, faces, *out);
        if ((status == STARG_ERROR_ARGUMENT || status == STARG_ERROR_READ) &&
            strchr(word, ',') != NULL && !is_numbers(word) && access(word, F_OK) != 0)
            status = add_each(session, word, faces, *out);
    }
    return status;
}

/* The weights that were asked for; NULL: none. */
static starg_status read_weights(cli_session *session, const cli_scene *s, size_t faces,
                                 double **out) {
    bool ignores = s->ignore.count > 0;
    *out = NULL;
    if (s->weights != NULL)
        return read_values(session, s->weights, faces, starg_weights_read, out);
    if (s->see.count == 0 && !ignores)
        return STARG_OK;
    starg_status status = read_union(session, ignores ? &s->ignore : &s->see, faces, out);
    for (size_t f = 0; status == STARG_OK && f < faces; f++)
        (*out)[f] = ((*out)[f] != 0) != ignores;
    return status;
}

/* The faces that words say, as an ascending list. */
static starg_status read_list(cli_session *session, const char *option, const starg_texts *words,
                              size_t faces, uint32_t **list, size_t *count) {
    SCOPED double *values = NULL;
    *list = NULL;
    *count = 0;
    if (words->count == 0)
        return STARG_OK;
    TRY(read_union(session, words, faces, &values));
    *list = calloc(faces + 1, sizeof **list);
    if (*list == NULL)
        return cli_fail_memory(session);
    for (size_t f = 0; f < faces; f++)
        if (values[f] != 0)
            (*list)[(*count)++] = (uint32_t)f;
    if (*count == 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT, "%s %.100s are no faces of the model",
                        option, words->values[0]);
    return STARG_OK;
}

/* ---- needs ---- */

/* K, or K and a density by number or name, after the last = of the word; true: it is that. */
static bool parse_need(const char *text, starg_face_need *need) {
    char *end;
    unsigned long long times = strtoull(text, &end, 10);
    *need = (starg_face_need){0};
    if (end == text || *text == '-' || *text == '+' || times < 1 || times > 1000)
        return false;
    need->times = (uint32_t)times;
    if (*end == '\0')
        return true;
    if (*end != ',')
        return false;
    for (size_t i = 0; i < sizeof DENSITIES / sizeof *DENSITIES; i++)
        if (strcmp(end + 1, DENSITIES[i]) == 0)
            need->density = STARG_DENSITY_MONITOR - (double)i;
    return need->density < 0 || (cli_number_real(end + 1, &need->density) && need->density > 0);
}

static starg_status add_need(cli_session *session, const char *word, size_t faces,
                             starg_face_need *needs) {
    SCOPED double *values = NULL;
    starg_face_need need;
    SCOPED char *copy = strdup(word);
    char *equals = copy != NULL ? strrchr(copy, '=') : NULL;
    if (copy == NULL)
        return cli_fail_memory(session);
    if (equals == NULL || equals == copy || !parse_need(equals + 1, &need))
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--require takes FACES=K or FACES=K,DENSITY, such as doors=2 or "
                        "doors=2,identify, with K from 1 to 1,000 and a density above 0 or one of "
                        "monitor, detect, observe, recognise and identify, not '%.100s'",
                        word);
    *equals = '\0';
    const char *list[] = {copy};
    const starg_texts words = {.values = list, .count = 1};
    TRY(read_union(session, &words, faces, &values));
    for (size_t f = 0, any = 0; f < faces || any == 0; f++) {
        if (f == faces)
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "--require %.100s: these are no faces of the model", word);
        if (values[f] == 0)
            continue;
        any = 1;
        needs[f] = need;
        needs[f].face = (uint32_t)f;
    }
    return STARG_OK;
}

/* Later ones beat earlier ones. */
static starg_status require(cli_session *session, const cli_scene *s, size_t faces,
                            const double *weights) {
    size_t count = 0, ignored = 0;
    SCOPED starg_face_need *needs = calloc(faces + 1, sizeof *needs);
    if (needs == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < s->require.count; i++)
        TRY(add_need(session, s->require.values[i], faces, needs));
    for (size_t f = 0; f < faces; f++)
        if (needs[f].times > 0) {
            ignored += weights != NULL && weights[f] == 0;
            needs[count++] = needs[f];
        }
    if (ignored > 0)
        return cli_fail(session, STARG_ERROR_ARGUMENT,
                        "--require names %s that --see, --ignore or --weights leave out; a face "
                        "that need not be seen has no needs",
                        cli_count_of(ignored, "face", "faces").text);
    return starg_space_require(session->solid, needs, count);
}

starg_status cli_scene_make(cli_session *session, cli_scene *s) {
    starg_status status = STARG_OK;
    starg_space_options options;
    starg_mesh **obstacles = NULL;
    double *weights = NULL;
    uint32_t *over = NULL, *mount = NULL, *clear = NULL;
    starg_zone *zones = NULL;
    size_t faces = starg_mesh_face_count(session->mesh);
    take_options(s, session->mesh, &options);
    if (is_plain(s)) {
        status = starg_solid_create(session->context, session->mesh, &session->solid);
        goto done;
    }
    CLI_TRY(read_obstacles(session, s->obstacles.values, s->obstacles.count, &obstacles));
    CLI_TRY(read_weights(session, s, faces, &weights));
    CLI_TRY(read_list(session, "--over", &s->over, faces, &over, &options.over_count));
    CLI_TRY(read_list(session, "--mount", &s->mount, faces, &mount, &options.mount_count));
    CLI_TRY(read_list(session, "--clear", &s->clear, faces, &clear, &options.clear_count));
    options.clear = clear;
    CLI_TRY(read_zones(session, s, &options, &zones));
    options.over = over;
    options.mount = mount;
    CLI_TRY(starg_space_create(session->context, session->mesh,
                               (const starg_mesh *const *)obstacles, s->obstacles.count, &options,
                               &session->solid));
    if (weights != NULL)
        CLI_TRY(starg_space_weigh(session->solid, weights));
    if (s->require.count > 0)
        CLI_TRY(require(session, s, faces, weights));
done:
    free(weights);
    free(over);
    free(mount);
    free(clear);
    free_zones(zones, s->within.count + s->without.count);
    cli_scene_free_obstacles(obstacles, s->obstacles.count);
    starg_mesh_free(session->mesh);
    session->mesh = NULL;
    return status;
}

void cli_scene_release(cli_scene *scene) {
    free((void *)scene->zone_files);
    scene->zone_files = NULL;
}

starg_status cli_scene_read_obstacles(cli_session *session, const starg_guards *guards,
                                      starg_mesh ***out) {
    starg_mesh **list = calloc(guards->obstacle_count + 1, sizeof *list);
    *out = list;
    if (list == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < guards->obstacle_count; i++) {
        const char *file = guards->obstacles[i].file;
        if (file == NULL)
            return cli_fail(session, STARG_ERROR_FORMAT,
                            "the result does not name the file of obstacle %zu", i);
        TRY(starg_mesh_read(session->context, file, &list[i]));
    }
    return STARG_OK;
}

starg_status cli_scene_read_zones(cli_session *session, const starg_guards *guards,
                                  starg_mesh ***out) {
    starg_mesh **list = calloc(guards->zone_count + 1, sizeof *list);
    *out = list;
    if (list == NULL)
        return cli_fail_memory(session);
    for (size_t i = 0; i < guards->zone_count; i++) {
        const char *file = guards->zones[i].file;
        if (guards->zones[i].face_count == 0)
            continue;
        if (file == NULL)
            return cli_fail(session, STARG_ERROR_FORMAT,
                            "the result does not name the file of zone %zu", i);
        TRY(starg_mesh_read(session->context, file, &list[i]));
    }
    return STARG_OK;
}

starg_status cli_scene_join(cli_session *session, starg_mesh *const *obstacles, size_t count,
                            starg_mesh **out) {
    size_t vertices = 0, faces = 0;
    *out = NULL;
    for (size_t i = 0; i < count; i++) {
        vertices += starg_mesh_vertex_count(obstacles[i]);
        faces += starg_mesh_face_count(obstacles[i]);
    }
    if (faces == 0)
        return STARG_OK;
    SCOPED double *points = malloc(3 * vertices * sizeof *points);
    SCOPED uint32_t *corners = malloc(3 * faces * sizeof *corners);
    if (points == NULL || corners == NULL)
        return cli_fail_memory(session);
    vertices = faces = 0;
    for (size_t i = 0; i < count; i++) {
        const starg_mesh *mesh = obstacles[i];
        size_t own = starg_mesh_vertex_count(mesh), triangles = starg_mesh_face_count(mesh);
        memcpy(points + 3 * vertices, starg_mesh_vertices(mesh), 3 * own * sizeof *points);
        for (size_t k = 0; k < 3 * triangles; k++)
            corners[3 * faces + k] = starg_mesh_faces(mesh)[k] + (uint32_t)vertices;
        vertices += own;
        faces += triangles;
    }
    return starg_mesh_create(session->context, points, vertices, corners, faces, out);
}
