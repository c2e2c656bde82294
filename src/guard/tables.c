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

static const starg_solid *scene_of(const seen_table *t) {
    return &t->patched.solid;
}

static uint32_t group_of(const seen_table *t, size_t face) {
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

static double area_of(const seen_table *t, size_t face) {
    const starg_mesh *mesh = scene_of(t)->mesh;
    const uint32_t *c = mesh->faces + 3 * face;
    return vec3_triangle_area(mesh->vertices + 3 * (size_t)c[0], mesh->vertices + 3 * (size_t)c[1],
                              mesh->vertices + 3 * (size_t)c[2]);
}

static double share_of(const seen_table *t, size_t patch) {
    const mesh_patches *patches = scene_of(t)->patches;
    return patches != NULL ? patches->share.data[patch] : 1;
}

/* How many guards see a patch; `only` is the last of them. */
static size_t count_viewers(const seen_table *t, size_t patch, size_t *only) {
    size_t count = 0;
    for (size_t i = 0; i < t->rows->rows; i++)
        if (starg_bits_test(t->rows, i, patch)) {
            count++;
            *only = i;
        }
    return count;
}

/* ---- by face ---- */

seen_face seen_table_face(const seen_table *t, size_t face, uint8_t *sees) {
    size_t first = solid_first_patch(scene_of(t), face),
           end = solid_first_patch(scene_of(t), face + 1), only;
    seen_face out = {.area = area_of(t, face), .least = end > first ? SIZE_MAX : 0};
    for (size_t j = first; j < end; j++) {
        size_t count = count_viewers(t, j, &only);
        out.least = count < out.least ? count : out.least;
        out.share += count > 0 ? share_of(t, j) : 0;
    }
    out.share = out.least > 0 ? 1 : out.share;
    for (size_t i = 0; i < t->rows->rows; i++) {
        sees[i] = 0;
        for (size_t j = first; j < end && !sees[i]; j++)
            sees[i] = starg_bits_test(t->rows, i, j);
        out.cameras += sees[i];
    }
    return out;
}

static void put_face(FILE *stream, const seen_table *t, size_t face, uint8_t *sees) {
    uint32_t group = group_of(t, face);
    const seen_face seen = seen_table_face(t, face, sees);
    fprintf(stream, "%zu,", face);
    put_text(stream, group != UINT32_MAX ? t->groups->names[group] : "");
    fprintf(stream, ",%.17g,%.17g,%zu,%zu,", seen.area, seen.share, seen.cameras, seen.least);
    for (size_t i = 0, put = 0; i < t->rows->rows; i++)
        if (sees[i])
            fprintf(stream, "%s%zu", put++ > 0 ? " " : "", i);
    fputc('\n', stream);
}

static starg_status put_faces(starg_context *context, FILE *stream, const seen_table *t) {
    SCOPED uint8_t *sees = NULL;
    NEW(context, STAGE, sees, t->rows->rows + 1);
    fputs("face,group,area,share,cameras,least,which\n", stream);
    for (size_t f = 0; f < starg_space_model_faces(scene_of(t)); f++)
        if (solid_is_target(scene_of(t), false, f))
            put_face(stream, t, f, sees);
    return STARG_OK;
}

/* ---- by guard and by group ---- */

/* Pixels for each unit of length at the middle of a patch; 0: not known. */
static double density_at(const seen_table *t, size_t guard, size_t patch) {
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

void seen_table_measure(const seen_table *t, seen_area *guards, group_area *groups) {
    const starg_solid *solid = scene_of(t);
    size_t last = t->groups != NULL ? t->groups->count : 0;
    for (size_t f = 0; f < starg_space_model_faces(solid); f++) {
        uint32_t group = group_of(t, f);
        double face = area_of(t, f);
        group_area *places[2] = {&groups[last], group != UINT32_MAX ? &groups[group] : NULL};
        if (!solid_is_target(solid, false, f))
            continue;
        for (size_t j = solid_first_patch(solid, f); j < solid_first_patch(solid, f + 1); j++) {
            double area = face * share_of(t, j);
            size_t only = 0, count = count_viewers(t, j, &only);
            for (int p = 0; p < 2 && places[p] != NULL; p++) {
                places[p]->all += area;
                for (size_t k = 0; k < SEEN_TIMES && k < count; k++)
                    places[p]->by[k] += area;
            }
            for (size_t i = 0; i < t->rows->rows && count > 0; i++)
                if (starg_bits_test(t->rows, i, j)) {
                    guards[i].all += area;
                    guards[i].density += area * density_at(t, i, j);
                }
            if (count == 1)
                guards[only].alone += area;
        }
    }
    for (size_t i = 0; i < t->rows->rows; i++)
        guards[i].density = guards[i].all > 0 ? guards[i].density / guards[i].all : 0;
}

double seen_ratio(double part, double all) {
    return all > 0 ? fmin(part / all, 1) : 0;
}

static void put_guards(FILE *stream, const seen_table *t, const seen_area *seen, double all) {
    for (size_t i = 0; i < t->rows->rows; i++) {
        fprintf(stream, "camera,%zu,%s,%.17g,%.17g,%.17g,", i,
                t->guards->kept != NULL && t->guards->kept[i] ? "yes" : "no", seen[i].all,
                seen_ratio(seen[i].all, all), seen[i].alone);
        if (seen[i].density > 0)
            fprintf(stream, "%.17g", seen[i].density);
        fputs(",,,\n", stream);
    }
}

static void put_group(FILE *stream, const char *kind, const char *name, const group_area *area) {
    fprintf(stream, "%s,", kind);
    put_text(stream, name);
    fprintf(stream, ",,%.17g,%.17g,,", area->all, seen_ratio(area->by[0], area->all));
    for (int k = 0; k < SEEN_TIMES; k++)
        fprintf(stream, ",%.17g", seen_ratio(area->by[k], area->all));
    fputc('\n', stream);
}

static starg_status put_summary(starg_context *context, FILE *stream, const seen_table *t) {
    size_t count = t->groups != NULL ? t->groups->count : 0;
    SCOPED seen_area *guards = NULL;
    SCOPED group_area *groups = NULL;
    NEW_ZERO(context, STAGE, guards, t->rows->rows + 1);
    NEW_ZERO(context, STAGE, groups, count + 1);
    seen_table_measure(t, guards, groups);
    fputs("kind,name,kept,area,share,alone,density,by_1,by_2,by_3\n", stream);
    put_guards(stream, t, guards, groups[count].all);
    for (size_t g = 0; g < count; g++)
        if (groups[g].all > 0)
            put_group(stream, "group", t->groups->names[g], &groups[g]);
    put_group(stream, "all", "", &groups[count]);
    return STARG_OK;
}

/* ---- the calls ---- */

starg_status seen_table_open(starg_context *context, const starg_solid *scene,
                             const starg_guards *guards, const starg_face_groups *groups,
                             seen_table *out) {
    *out = (seen_table){.guards = guards, .groups = groups};
    return guards_look(context, scene, guards, &out->patched, &out->rows);
}

void seen_table_close(seen_table *table) {
    starg_bits_free(table->rows);
    patched_solid_free(&table->patched);
    *table = (seen_table){0};
}

static starg_status write(starg_context *context, const starg_solid *scene,
                          const starg_guards *guards, const starg_face_groups *groups,
                          starg_status (*put)(starg_context *, FILE *, const seen_table *),
                          const char *path) {
    SCOPED_BY(seen_table_close) seen_table t = {0};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    starg_output output = {0};
    TRY(starg_c_locale_enter(context, &locale));
    TRY(seen_table_open(context, scene, guards, groups, &t));
    TRY(starg_output_open(context, STAGE, path, &output));
    starg_status status = put(context, output.stream, &t);
    if (status == STARG_OK)
        return starg_output_commit(&output);
    starg_output_discard(&output);
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
