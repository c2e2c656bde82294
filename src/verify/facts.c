/* SPDX-License-Identifier: Apache-2.0 */
/* What the guards of a result see: visibility of each guard anew, in parallel (verify/sight.h).
 *
 * Invariant: each guard has its own row, so the order of threads does not matter. Cost: that of
 * verify/sight.h for each guard. */
#include "verify/facts.h"

#include <math.h>

#include "core/parallel.h"

static const char STAGE[] = "verify";

/* Of how many faces do two guards that are the baseline apart see each patch? All pairs of guards
 * of all patches. */

static bool is_paired(const verify_facts *known, size_t patch, double cosine) {
    const double *places = known->guards->positions;
    verify_spot spots[3];
    verify_patch_spots(known->surface, patch, spots);
    const double *t[3] = {spots[0].at, spots[1].at, spots[2].at};
    for (size_t g = 0; g < known->guards->count; g++)
        for (size_t h = g + 1;
             starg_bits_test(known->patches, g, patch) && h < known->guards->count; h++)
            if (starg_bits_test(known->patches, h, patch) &&
                verify_apart(t, places + 3 * g, places + 3 * h, cosine))
                return true;
    return false;
}

size_t verify_count_paired(const verify_facts *known) {
    const verify_surface *surface = known->surface;
    double cosine = starg_cone_cosine(2 * known->guards->options.baseline);
    size_t count = 0;
    for (size_t f = 0; f < surface->model_faces; f++) {
        size_t j = verify_first_patch(surface, f), end = verify_first_patch(surface, f + 1);
        while (j < end && is_paired(known, j, cosine))
            j++;
        count += j == end && verify_is_target(surface, f);
    }
    return count;
}

size_t verify_count_faces(const verify_facts *known, const uint64_t *row) {
    const verify_surface *surface = known->surface;
    size_t count = 0;
    for (size_t f = 0; f < surface->model_faces; f++) {
        size_t j = verify_first_patch(surface, f), end = verify_first_patch(surface, f + 1);
        while (j < end && starg_bit_test(row, j))
            j++;
        count += j == end && verify_is_target(surface, f);
    }
    return count;
}

bool verify_space_is_narrow(const starg_space_options *o) {
    bool narrow = o->cell > 0 || o->standoff_least > 0 || o->standoff_most > 0 ||
                  o->over_count > 0 || o->mount_count > 0;
    for (int k = 0; k < 6; k++)
        narrow = narrow || o->within[k] != 0;
    return narrow;
}

const starg_face_need *verify_need_of(const starg_guards *guards, size_t face) {
    size_t low = 0, high = guards->need_count; /* ascending */
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (guards->needs[middle].face == face)
            return &guards->needs[middle];
        if (guards->needs[middle].face < face)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

uint32_t verify_times(const verify_facts *known, size_t column) {
    const starg_guards *guards = known->guards;
    uint32_t all = guards->options.redundancy > 0 ? guards->options.redundancy : 1;
    if (guards->need_count == 0 || verify_targets_vertices(known))
        return all;
    const starg_face_need *need = verify_need_of(guards, verify_patch_face(known->surface, column));
    return need != NULL && need->times > 0 ? need->times : all;
}

verify_target verify_target_of(const verify_facts *known) {
    const starg_guards *guards = known->guards;
    if (guards->options.visibility.target == STARG_TARGET_VERTICES)
        return (verify_target){"vertices", known->used_vertices, known->covered_vertices,
                               guards->coverable_vertices};
    return (verify_target){"faces", known->wanted_faces, known->covered_faces,
                           guards->coverable_faces};
}

static bool is_finite_point(const double p[3]) {
    return fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100;
}

static starg_status make_sight(starg_context *context, void *shared, void **scratch) {
    (void)context;
    const verify_facts *known = shared;
    verify_sight *sight;
    starg_status status = verify_sight_create(known->surface, &sight);
    *scratch = sight;
    return status;
}

static void free_sight(starg_context *context, void *scratch) {
    (void)context;
    verify_sight_free(scratch);
}

/* Stores the wanted ones; NULL: all. */
static void note_row(starg_bits *rows, size_t row, const uint8_t *seen, const uint8_t *wanted) {
    uint64_t *bits = starg_bits_row_mutable(rows, row);
    for (size_t j = 0; j < rows->columns; j++)
        if (seen[j] && (wanted == NULL || wanted[j]))
            starg_bit_set(bits, j);
}

verify_view verify_view_around(const starg_guards *guards) {
    const starg_visibility_options *o = &guards->options.visibility;
    return (verify_view){.range = o->range,
                         .near = o->near,
                         .rule = o->face_rule,
                         .steepest = starg_incidence_cosine(o->incidence)};
}

/* The view of a guard; a file without directions is wrong, which is told elsewhere. */
verify_view verify_view_of(const starg_guards *guards, size_t guard) {
    const starg_visibility_options *o = &guards->options.visibility;
    verify_view view = verify_view_around(guards);
    if (o->cone < 360 && guards->directions != NULL) {
        view.direction = guards->directions + 3 * guard;
        view.cosine = starg_cone_cosine(o->cone);
    }
    view.depth = starg_density_depth(o, 0);
    view.framed = o->fov[0] > 0 && guards->directions != NULL && guards->ups != NULL;
    if (guards->need_count > 0 && o->target == STARG_TARGET_FACES) {
        view.needs = guards;
        view.depth = INFINITY;
    }
    view.ahead = guards->directions != NULL ? guards->directions + 3 * guard : NULL;
    if (view.framed)
        starg_frustum(guards->directions + 3 * guard, guards->ups + 3 * guard, o->fov, view.planes);
    return view;
}

/* Where does a guard stand? */
static starg_status place_guard(starg_context *context, void *shared, void *scratch, size_t g) {
    (void)context;
    (void)scratch;
    verify_facts *known = shared;
    const verify_surface *surface = known->surface;
    const starg_guard_options *options = &known->guards->options;
    const double *p = known->guards->positions + 3 * g;
    if (!is_finite_point(p))
        return STARG_OK;
    if (options->clearance > 0)
        known->distance[g] = verify_distance(surface, p, surface->face_count, known->scale);
    if (verify_space_is_narrow(&known->guards->space))
        known->standoff[g] = verify_distance(surface, p, surface->model_faces, known->scale);
    bool on_surface;
    int winding = verify_tree_winding(known->tree, p, &on_surface);
    known->inside[g] = !on_surface && winding + surface->ambient >= 1;
    return STARG_OK;
}

/* What does it see? One that is not inside sees nothing. */
static starg_status examine_guard(starg_context *context, void *shared, void *scratch, size_t g) {
    (void)context;
    verify_facts *known = shared;
    const uint8_t *vertices, *patches;
    verify_view view = verify_view_of(known->guards, g);
    if (!known->inside[g])
        return STARG_OK;
    if (verify_targets_points(known))
        view.rule = STARG_FACES_WHOLE;
    starg_status status =
        verify_look(scratch, known->guards->positions + 3 * g, &view, &vertices, &patches);
    if (status != STARG_OK)
        return status;
    note_row(known->patches, g, patches, known->wanted);
    if (known->vertices != NULL)
        note_row(known->vertices, g, vertices, known->used);
    return STARG_OK;
}

static void unite(const starg_bits *rows, uint8_t *all) {
    for (size_t g = 0; g < rows->rows; g++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, g)[w]) {
                all[64 * w + bit] = 1;
            }
}

starg_status verify_count_held(const verify_facts *known, const starg_bits *rows, uint32_t **held) {
    NEW_ZERO(known->surface->context, STAGE, *held, rows->columns);
    for (size_t g = 0; g < rows->rows; g++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, g)[w]) {
                (*held)[64 * w + bit]++;
            }
    return STARG_OK;
}

static void sum_up_face(verify_facts *known, size_t face) {
    const verify_surface *surface = known->surface;
    double area = verify_area(surface, face, known->scale);
    if (surface->importance != NULL)
        area *= surface->importance[face];
    known->total_area += area;
    known->face[face] = 1;
    for (size_t j = verify_first_patch(surface, face); j < verify_first_patch(surface, face + 1);
         j++) {
        known->area[j] = area * verify_patch_share(surface, j);
        known->covered_area += known->patch[j] ? known->area[j] : 0;
        known->patch[j] = known->patch[j] || !known->wanted[j];
        known->face[face] = known->face[face] && known->patch[j];
    }
    known->covered_faces += known->face[face] && verify_is_target(surface, face);
}

static void sum_up(verify_facts *known) {
    const verify_surface *surface = known->surface;
    unite(known->patches, known->patch);
    if (known->vertices != NULL)
        unite(known->vertices, known->vertex);
    for (size_t v = 0; v < surface->vertex_count; v++) {
        known->used_vertices += known->used[v];
        known->covered_vertices += known->vertex[v];
        known->vertex[v] = known->vertex[v] || !known->used[v];
    }
    for (size_t f = 0; f < surface->face_count; f++)
        sum_up_face(known, f);
}

/* Marks the target faces and their vertices. */
static void mark_wanted(verify_facts *known) {
    const verify_surface *surface = known->surface;
    for (size_t j = 0; j < verify_patch_count(surface); j++)
        known->wanted[j] = verify_is_target(surface, verify_patch_face(surface, j));
    for (size_t f = 0; f < surface->face_count; f++) {
        bool target = verify_is_target(surface, f);
        known->wanted_faces += target;
        for (size_t k = 0; target && k < 3; k++)
            known->used[surface->faces[3 * f + k]] = 1;
    }
}

static starg_status divide(verify_facts *known, verify_surface *surface) {
    double longest = known->guards->options.visibility.patch;
    if (verify_targets_points(known))
        return verify_divide_by_points(known, surface);
    return longest > 0 ? verify_patches_create(surface, longest) : STARG_OK;
}

static starg_status look_around(starg_context *context, verify_facts *known) {
    size_t guards = known->guards->count, patches = verify_patch_count(known->surface);
    TRY(starg_bits_create(context, guards, patches, &known->patches));
    if (verify_targets_vertices(known))
        TRY(starg_bits_create(context, guards, known->surface->vertex_count, &known->vertices));
    NEW_ZERO(context, STAGE, known->vertex, known->surface->vertex_count);
    NEW_ZERO(context, STAGE, known->used, known->surface->vertex_count);
    NEW_ZERO(context, STAGE, known->face, known->surface->face_count);
    NEW_ZERO(context, STAGE, known->patch, patches);
    NEW_ZERO(context, STAGE, known->wanted, patches);
    NEW(context, STAGE, known->area, patches);
    mark_wanted(known);
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = guards,
                                      .shared = known,
                                      .item = examine_guard,
                                      .make_scratch = make_sight,
                                      .free_scratch = free_sight};
    TRY(starg_parallel_for(context, &loop));
    for (size_t g = 0; g < guards && !verify_targets_points(known); g++)
        known->seen_faces[g] = verify_count_faces(known, starg_bits_row(known->patches, g));
    return STARG_OK;
}

starg_status verify_facts_find(verify_surface *surface, verify_facts *known) {
    starg_context *context = surface->context;
    size_t guards = known->guards->count;
    known->surface = surface;
    known->scale = verify_scale(surface);
    NEW_ZERO(context, STAGE, known->inside, guards);
    NEW_ZERO(context, STAGE, known->distance, guards);
    NEW_ZERO(context, STAGE, known->standoff, guards);
    NEW_ZERO(context, STAGE, known->seen_faces, guards);
    TRY(verify_tree_create(known->surface, &known->tree));
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = guards, .shared = known, .item = place_guard};
    TRY(starg_parallel_for(context, &loop));
    TRY(divide(known, surface));
    TRY(look_around(context, known));
    sum_up(known);
    return STARG_OK;
}

void verify_facts_free(verify_facts *known) {
    RELEASE(known->inside, known->distance, known->standoff, known->seen_faces);
    starg_bits_free(known->patches);
    starg_bits_free(known->vertices);
    RELEASE(known->vertex, known->used, known->patch, known->face, known->wanted, known->area);
    verify_tree_free(known->tree);
}
