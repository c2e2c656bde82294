/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of what guards see, as CSV.
 *
 * A face may be seen in parts (patches). Of each face the table tells how many guards see some of
 * it and which they are, how many see every part of it at least, and the share of its area that any
 * of them sees. The summary tells areas, of patches: for a guard what it sees, and what it alone
 * sees; for a group of faces the shares of its area that at least one, two and three guards see.
 * The density of a guard's picture is the mean, by area, of that at the depth of each patch's
 * middle.
 *
 * Rows are written as they are found. Cost: the bits of all rows. */
#include <math.h>

#include "core/file.h"
#include "geometry/vec3.h"
#include "guard/stages.h"
#include "visibility/sensor.h"

static const char STAGE[] = "table";

enum { MOST_TIMES = 3 };

typedef struct table {
    const starg_guards *guards;
    const starg_face_groups *groups;
    patched_solid patched;
    starg_bits *rows;
    FILE *stream;
} table;

static const starg_solid *scene_of(const table *t) {
    return &t->patched.solid;
}

static uint32_t group_of(const table *t, size_t face) {
    return t->groups != NULL && face < t->groups->face_count ? t->groups->of[face] : UINT32_MAX;
}

static void put_text(FILE *stream, const char *text) {
    if (strpbrk(text, ",\"\r\n") == NULL) {
        fputs(text, stream);
        return;
    }
    fputc('"', stream);
    for (; *text != '\0'; text++)
        fprintf(stream, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', stream);
}

static double area_of(const table *t, size_t face) {
    const starg_mesh *mesh = scene_of(t)->mesh;
    const uint32_t *c = mesh->faces + 3 * face;
    return vec3_triangle_area(mesh->vertices + 3 * (size_t)c[0], mesh->vertices + 3 * (size_t)c[1],
                              mesh->vertices + 3 * (size_t)c[2]);
}

static double share_of(const table *t, size_t patch) {
    const mesh_patches *patches = scene_of(t)->patches;
    return patches != NULL ? patches->share.data[patch] : 1;
}

/* How many guards see a patch; `only` is the last of them. */
static size_t count_viewers(const table *t, size_t patch, size_t *only) {
    size_t count = 0;
    for (size_t i = 0; i < t->rows->rows; i++)
        if (starg_bits_test(t->rows, i, patch)) {
            count++;
            *only = i;
        }
    return count;
}

/* ---- by face ---- */

static void put_face(const table *t, size_t face, uint8_t *sees) {
    size_t first = solid_first_patch(scene_of(t), face),
           end = solid_first_patch(scene_of(t), face + 1);
    size_t least = SIZE_MAX, viewers = 0, only;
    double share = 0;
    bool all = true;
    for (size_t j = first; j < end; j++) {
        size_t count = count_viewers(t, j, &only);
        least = count < least ? count : least;
        share += count > 0 ? share_of(t, j) : 0;
        all = all && count > 0;
    }
    for (size_t i = 0; i < t->rows->rows; i++) {
        sees[i] = 0;
        for (size_t j = first; j < end && !sees[i]; j++)
            sees[i] = starg_bits_test(t->rows, i, j);
        viewers += sees[i];
    }
    uint32_t group = group_of(t, face);
    fprintf(t->stream, "%zu,", face);
    put_text(t->stream, group != UINT32_MAX ? t->groups->names[group] : "");
    fprintf(t->stream, ",%.17g,%.17g,%zu,%zu,", area_of(t, face), all ? 1 : share, viewers,
            least == SIZE_MAX ? 0 : least);
    for (size_t i = 0, put = 0; i < t->rows->rows; i++)
        if (sees[i])
            fprintf(t->stream, "%s%zu", put++ > 0 ? " " : "", i);
    fputc('\n', t->stream);
}

static starg_status put_faces(starg_context *context, const table *t) {
    SCOPED uint8_t *sees = NULL;
    NEW(context, STAGE, sees, t->rows->rows + 1);
    fputs("face,group,area,share,cameras,least,which\n", t->stream);
    for (size_t f = 0; f < starg_space_model_faces(scene_of(t)); f++)
        if (solid_is_target(scene_of(t), false, f))
            put_face(t, f, sees);
    return STARG_OK;
}

/* ---- by guard and by group ---- */

typedef struct seen_area {
    double all, alone, pixels; /* the last: times the density */
} seen_area;

typedef struct group_area {
    double all, by[MOST_TIMES];
} group_area;

/* Pixels for each unit of length at the middle of a patch; 0: not known. */
static double density_at(const table *t, size_t guard, size_t patch) {
    const starg_visibility_options *o = &t->guards->options.visibility;
    const starg_solid *solid = scene_of(t);
    double middle[3] = {0, 0, 0}, line[3];
    size_t corners = solid->patches != NULL ? solid->patches->corners : 3;
    if (!(o->resolution[0] > 0 && o->fov[0] > 0))
        return 0;
    for (size_t k = 0; k < corners; k++)
        vec3_along(middle, 1.0 / (double)corners, solid_patch_corner(solid, patch, k), middle);
    const double *ahead = t->guards->directions + 3 * guard;
    vec3_subtract(middle, t->guards->positions + 3 * guard, line);
    double depth = vec3_dot(line, ahead) / vec3_length(ahead);
    return depth > 0 ? starg_density_depth(o, 1) / depth : 0;
}

static void measure(const table *t, seen_area *guards, group_area *groups, size_t group_count) {
    const starg_solid *solid = scene_of(t);
    for (size_t f = 0; f < starg_space_model_faces(solid); f++) {
        uint32_t group = group_of(t, f);
        double face = area_of(t, f);
        group_area *places[2] = {&groups[group_count], group != UINT32_MAX ? &groups[group] : NULL};
        if (!solid_is_target(solid, false, f))
            continue;
        for (size_t j = solid_first_patch(solid, f); j < solid_first_patch(solid, f + 1); j++) {
            double area = face * share_of(t, j);
            size_t only = 0, count = count_viewers(t, j, &only);
            for (int p = 0; p < 2 && places[p] != NULL; p++) {
                places[p]->all += area;
                for (size_t k = 0; k < MOST_TIMES && k < count; k++)
                    places[p]->by[k] += area;
            }
            for (size_t i = 0; i < t->rows->rows && count > 0; i++)
                if (starg_bits_test(t->rows, i, j)) {
                    guards[i].all += area;
                    guards[i].pixels += area * density_at(t, i, j);
                }
            if (count == 1)
                guards[only].alone += area;
        }
    }
}

static double ratio(double part, double all) {
    return all > 0 ? fmin(part / all, 1) : 0;
}

static void put_guards(const table *t, const seen_area *seen, double all) {
    const starg_visibility_options *o = &t->guards->options.visibility;
    bool resolved = o->resolution[0] > 0 && o->fov[0] > 0;
    for (size_t i = 0; i < t->rows->rows; i++) {
        fprintf(t->stream, "camera,%zu,%s,%.17g,%.17g,%.17g,", i,
                t->guards->kept != NULL && t->guards->kept[i] ? "yes" : "no", seen[i].all,
                ratio(seen[i].all, all), seen[i].alone);
        if (resolved && seen[i].all > 0)
            fprintf(t->stream, "%.17g", seen[i].pixels / seen[i].all);
        fputs(",,,\n", t->stream);
    }
}

static void put_group(const table *t, const char *kind, const char *name, const group_area *area) {
    fprintf(t->stream, "%s,", kind);
    put_text(t->stream, name);
    fprintf(t->stream, ",,%.17g,%.17g,,", area->all, ratio(area->by[0], area->all));
    for (int k = 0; k < MOST_TIMES; k++)
        fprintf(t->stream, ",%.17g", ratio(area->by[k], area->all));
    fputc('\n', t->stream);
}

static starg_status put_summary(starg_context *context, const table *t) {
    size_t count = t->groups != NULL ? t->groups->count : 0;
    SCOPED seen_area *guards = NULL;
    SCOPED group_area *groups = NULL;
    NEW_ZERO(context, STAGE, guards, t->rows->rows + 1);
    NEW_ZERO(context, STAGE, groups, count + 1);
    measure(t, guards, groups, count);
    fputs("kind,name,kept,area,share,alone,density,by_1,by_2,by_3\n", t->stream);
    put_guards(t, guards, groups[count].all);
    for (size_t g = 0; g < count; g++)
        if (groups[g].all > 0)
            put_group(t, "group", t->groups->names[g], &groups[g]);
    put_group(t, "all", "", &groups[count]);
    return STARG_OK;
}

/* ---- the calls ---- */

static starg_status write(starg_context *context, const starg_solid *scene,
                          const starg_guards *guards, const starg_face_groups *groups,
                          starg_status (*put)(starg_context *, const table *), const char *path) {
    starg_status status = STARG_OK;
    table t = {.guards = guards, .groups = groups};
    starg_output output = {0};
    starg_c_locale locale = {0};
    STARG_TRY(starg_c_locale_enter(context, &locale));
    STARG_TRY(guards_look(context, scene, guards, &t.patched, &t.rows));
    STARG_TRY(starg_output_open(context, STAGE, path, &output));
    t.stream = output.stream;
    status = put(context, &t);
    if (status == STARG_OK)
        status = starg_output_commit(&output);
    else
        starg_output_discard(&output);
done:
    starg_c_locale_leave(&locale);
    starg_bits_free(t.rows);
    patched_solid_free(&t.patched);
    return status;
}

starg_status starg_guards_write_table(starg_context *context, const starg_solid *scene,
                                      const starg_guards *guards, const starg_face_groups *groups,
                                      const char *path) {
    return write(context, scene, guards, groups, put_faces, path);
}

starg_status starg_guards_write_summary(starg_context *context, const starg_solid *scene,
                                        const starg_guards *guards, const starg_face_groups *groups,
                                        const char *path) {
    return write(context, scene, guards, groups, put_summary, path);
}
