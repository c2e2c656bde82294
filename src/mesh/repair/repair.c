/* SPDX-License-Identifier: Apache-2.0 */
/* Repairs a mesh until it bounds a solid.
 *
 * Stages: weld, drop duplicate and dangling faces, orient each patch, split non-manifold edges and
 * vertices, remove zero-area faces, fill holes, drop components without volume, orient the shells,
 * resolve local intersections or, for a union, cut out all of them. Each stage has its own file
 * (mesh/repair/repair.h lists them) and works on the result of the stages before it. A mesh that
 * needs none of them is returned unchanged.
 *
 * Without a union, overlapping components stay and are counted in intersections_after; the winding
 * number defines one solid from them. */

#include "mesh/repair/repair.h"
#include "core/fields.h"
#include "geometry/vec3.h"
#include "mesh/examine.h"

static const starg_field OPTIONS[] = {
    {.key = "merge_distance",
     .option = "merge-distance",
     .kind = STARG_FIELD_REAL,
     FIELD_MEMBER(starg_repair_options, merge_distance),
     .high = 1,
     .value = "D",
     .help = "Merge vertices within this distance, a fraction of the model's diagonal.",
     .default_text = "0, only equal positions"},
    {.key = "max_hole_edges",
     .option = "max-hole-edges",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_repair_options, max_hole_edges),
     .most = UINT32_MAX,
     .value = "N",
     .help = "Do not fill holes with more edges than this.",
     .default_text = "0, fill all"},
    {.key = "max_rounds",
     .option = "rounds",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_repair_options, max_rounds),
     .most = 10000,
     .initial = 10,
     .value = "N",
     .help = "Number of attempts to resolve self-intersections."},
    {.key = "max_change",
     .option = "max-change",
     .kind = STARG_FIELD_REAL,
     FIELD_MEMBER(starg_repair_options, max_change),
     .high = 1e6,
     .standard = 0.01,
     .value = "F",
     .help = "Refuse a result whose volume differs by more than this fraction from that of the "
             "model, where that is closed. Unions may lose what lies within others."},
    {.key = "union",
     .option = "union",
     .kind = STARG_FIELD_FLAG,
     FIELD_MEMBER(starg_repair_options, unite),
     .help = "Cut faces that intersect and keep the boundary of what the surface encloses (winding "
             "number 1 or more). Other faces and all vertices stay."},
};
static const starg_fields OPTIONS_TABLE = {
    .name = "repair options", .size = sizeof(starg_repair_options), FIELD_ROWS(OPTIONS)};
OPTIONS_BY(OPTIONS_TABLE, starg_repair_options)

static size_t found(const starg_check *check, starg_finding_kind kind) {
    return check->findings[kind].count;
}

/* Contacts and coincident vertices are not faults of a solid: shells may touch. But surfaces may
 * cross where faces only touch, so a union inspects them. */
static bool needs_nothing(const starg_check *check, const starg_repair_options *options) {
    return check->usable && check->manifold && options->merge_distance == 0 &&
           found(check, STARG_FINDING_INWARD_COMPONENT) == 0 &&
           found(check, STARG_FINDING_DEGENERATE_FACE) == 0 &&
           found(check, STARG_FINDING_ISOLATED_VERTEX) == 0 &&
           found(check, STARG_FINDING_SELF_INTERSECTION) == 0 &&
           (!options->unite || found(check, STARG_FINDING_SELF_CONTACT) == 0);
}

/* Combinatorial stages. Coincident vertices are merged only if the surface is broken or a distance
 * is given: a valid surface may touch itself. */
static starg_status mend_surface(repair_state *state, const starg_check *before) {
    bool sound = before->closed && before->manifold;
    if (!sound || state->options.merge_distance > 0)
        TRY(repair_conform(state));
    TRY(repair_measure(state, &state->report.closed_before, &state->report.enclosed_before));
    repair_drop_repeated(state);
    TRY(repair_drop_duplicates(state));
    TRY(repair_drop_fins(state));
    TRY(repair_orient(state));
    TRY(repair_split(state));
    TRY(repair_degenerate(state));
    TRY(repair_split(state)); /* dropping faces may leave two fans at a vertex */
    return STARG_OK;
}

/* A surface that is closed once what touches is joined has its volume; stages up to
 * here are not to change it, unless asked. Those that follow resolve intersections, where it means
 * little. */
static starg_status compare_volumes(repair_state *state) {
    starg_repair_report *r = &state->report;
    bool closed;
    TRY(repair_measure(state, &closed, &r->enclosed_after));
    /* of a surface whose faces all stand twice, front and back, nothing can be said */
    r->closed_before = r->closed_before && r->enclosed_before > 1e-9 * r->enclosed_after;
    if (!r->closed_before || state->options.unite)
        return STARG_OK;
    double change = fabs(r->enclosed_after - r->enclosed_before);
    if (!(change > state->options.max_change * r->enclosed_before) || !closed)
        return STARG_OK;
    return starg_fail(state->context, STARG_ERROR_MESH, REPAIR_STAGE,
                      "the shells enclosed a volume of %.6g before, and %.6g after repair; "
                      "--max-change %.2g accepts that",
                      r->enclosed_before, r->enclosed_after,
                      fmin(1e6, 1.01 * change / r->enclosed_before));
    return STARG_OK;
}

/* From an oriented manifold to the boundary of a solid. */
static starg_status close_surface(repair_state *state) {
    TRY(repair_fill_holes(state));
    TRY(repair_degenerate(
        state)); /* filling loops with collinear corners can make zero-area faces */
    TRY(repair_drop_flat(state));
    TRY(compare_volumes(state));
    if (!state->options.unite) {
        TRY(repair_untangle(state));
        TRY(repair_drop_flat(state)); /* cutting out may have closed a pocket */
    }
    TRY(repair_drop_isolated(state));
    TRY(repair_turn_shells(state));
    if (state->options.unite) {
        TRY(repair_unite(state));
        TRY(repair_split(state));
        TRY(repair_drop_isolated(state));
    }
    return STARG_OK;
}

static starg_status describe_vertices(repair_state *state) {
    starg_repair_report *report = &state->report;
    size_t different = 0;
    SCOPED uint8_t *seen = NULL;
    NEW_ZERO(state->context, REPAIR_STAGE, seen, state->input->vertex_count);
    for (size_t v = 0; v < repair_vertex_count(state); v++) {
        uint32_t origin = state->origin.data[v];
        if (origin == REPAIR_NEW) {
            report->vertices_added++;
            continue;
        }
        double move = vec3_distance(repair_position(state, (uint32_t)v),
                                    state->input->vertices + 3 * (size_t)origin);
        report->vertices_split += seen[origin];
        report->vertices_moved += move > 0;
        report->largest_move = fmax(report->largest_move, move);
        different += !seen[origin];
        seen[origin] = 1;
    }
    report->vertices_dropped = state->input->vertex_count - different - report->vertices_merged;
    return STARG_OK;
}

static void describe_faces(repair_state *state) {
    starg_repair_report *report = &state->report;
    for (size_t f = 0; f < repair_face_count(state); f++) {
        bool added = state->flags.data[f] & REPAIR_ADDED;
        report->faces_added += added;
        report->faces_turned += !added && (state->flags.data[f] & REPAIR_TURNED);
    }
    report->faces_dropped =
        state->input->face_count - (repair_face_count(state) - report->faces_added);
}

static starg_status fail_empty(repair_state *state) {
    const starg_repair_report *report = &state->report;
    if (state->input->face_count == 0)
        return starg_fail(state->context, STARG_ERROR_MESH, REPAIR_STAGE,
                          "the mesh has no faces: there is nothing to repair");
    double distance = state->options.merge_distance;
    if (distance > 0)
        return starg_fail(state->context, STARG_ERROR_MESH, REPAIR_STAGE,
                          "nothing is left that encloses volume once vertices nearer than %g of "
                          "the diagonal are merged; give a smaller --merge-distance, or none",
                          distance);
    TRY(repair_suggest(state, &distance));
    if (distance > 0)
        return starg_fail(state->context, STARG_ERROR_MESH, REPAIR_STAGE,
                          "nothing is left that encloses volume, since faces do not meet; "
                          "--merge-distance %.0e closes the surface",
                          distance);
    return starg_fail(state->context, STARG_ERROR_MESH, REPAIR_STAGE,
                      "nothing is left that encloses volume: of %zu faces, %zu belong to one-sided "
                      "surfaces (such as a Moebius strip), and %zu components are flat",
                      state->input->face_count, state->one_sided_faces, report->components_dropped);
}

/* Splitting may insert a rounded vertex into an edge, which can make faces cross. */
static starg_status fail_crossed(starg_context *context, const starg_finding *finding) {
    return starg_fail_at(context, STARG_ERROR_MESH, REPAIR_STAGE, finding->element, finding->first,
                         finding->shown,
                         "%zu pairs of faces of the union intersect after rounding; merge near "
                         "vertices first",
                         finding->count);
}

static starg_status fail_unusable(starg_context *context, const starg_check *check) {
    for (int kind = 0; kind < STARG_FINDING_INWARD_COMPONENT; kind++) {
        const starg_finding *finding = &check->findings[kind];
        if (finding->count > 0)
            return starg_fail_at(
                context, STARG_ERROR_MESH, REPAIR_STAGE, finding->element, finding->first,
                finding->shown, "the mesh could not be made a solid: %zu %s are left%s",
                finding->count, starg_finding_name((starg_finding_kind)kind),
                kind == STARG_FINDING_OPEN_EDGE ? "; a larger limit on hole edges may close them"
                                                : "");
    }
    return starg_fail(context, STARG_ERROR_MESH, REPAIR_STAGE,
                      check->underflows
                          ? "the area or volume underflows; scale the coordinates, by a power of "
                            "two to keep them exact"
                          : "the mesh could not be made a solid: the remainder encloses no volume");
}

/* Checks the result and returns it if it bounds a solid. */
static starg_status finish(repair_state *state, const starg_check *before, starg_mesh **out) {
    SCOPED_BY(starg_check_drop) starg_check *check = NULL;
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    if (repair_face_count(state) == 0)
        return fail_empty(state);
    starg_mesh view = repair_view(state);
    TRY(starg_mesh_create(state->context, view.vertices, view.vertex_count, view.faces,
                          view.face_count, &mesh));
    TRY(starg_mesh_check(state->context, mesh, &check));
    state->report.intersections_after = found(check, STARG_FINDING_SELF_INTERSECTION);
    if (!check->usable)
        TRY(fail_unusable(state->context, check));
    if (state->options.unite && state->report.intersections_after > 0)
        TRY(fail_crossed(state->context, &check->findings[STARG_FINDING_SELF_INTERSECTION]));
    state->report.in_vain = before->usable && state->report.intersections_after > 0 &&
                            state->report.intersections_after >= state->report.intersections_before;
    TRY(describe_vertices(state));
    describe_faces(state);
    starg_check_describe_grid(check, state->report.grid, sizeof state->report.grid);
    *out = mesh;
    mesh = NULL;
    return STARG_OK;
}

starg_status starg_mesh_repair(starg_context *context, const starg_mesh *mesh,
                               const starg_repair_options *options, starg_mesh **out,
                               starg_repair_report *report) {
    starg_repair_options defaults;
    SCOPED_BY(repair_end) repair_state state = {.context = context};
    SCOPED_BY(starg_check_drop) starg_check *before = NULL;
    *out = NULL;
    *report = (starg_repair_report){0};
    starg_repair_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(fields_check(context, REPAIR_STAGE, &OPTIONS_TABLE, options));
    TRY(starg_mesh_check(context, mesh, &before));
    TRY(repair_begin(&state, context, mesh, options));
    state.report.intersections_before = found(before, STARG_FINDING_SELF_INTERSECTION);
    if (!needs_nothing(before, options)) {
        TRY(mend_surface(&state, before));
        TRY(close_surface(&state));
    } else
        TRY(repair_measure(&state, &state.report.closed_before, &state.report.enclosed_before));
    bool closed;
    TRY(repair_measure(&state, &closed, &state.report.enclosed_after));
    TRY(finish(&state, before, out));
    *report = state.report;
    return STARG_OK;
}
