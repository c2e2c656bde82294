/* SPDX-License-Identifier: Apache-2.0 */
/* Curve skeletons by erosion of the medial axis [DS06], homotopic by construction.
 *
 * Stages: samples of the surface; moves that make them conform to their Delaunay tetrahedra
 * (conform.c); labels of inside tetrahedra, exact if no face is lost; the dual complex, which is
 * the medial axis; its erosion to a graph by collapses; pruning; resampling.
 *
 * If the samples conform, every later stage preserves the homotopy type, since no coordinates are
 * involved. Conforming may fail at very thin cracks and fins; then the strategy whose components
 * and loops are closest to those of the surface is used. Excess ones are cut and counted as mended.
 *
 * Cost: O(n log n) in practice for n samples, per strategy that loses faces. */
#include "skeleton/skeleton.h"
#include "core/fields.h"

#include "geometry/vec3.h"
#include "mesh/examine.h"
#include "skeleton/edge_table.h"

static const char STAGE[] = "skeleton";

enum { LEAST_SAMPLES = 4000, MAX_MENDS = 600, MAX_NODES = 10000000 };

/* Result of one strategy of conforming. */
typedef struct attempt {
    medial_complex *complex;
    inside_labels labels;
    erosion eroded;
    size_t parts, loops; /* of the eroded graph */
    double spacing;      /* of the samples if they were even */
    bool *node_left;     /* nodes of kept components */
    size_t mends;        /* components and loops cut afterwards */
} attempt;

static void attempt_free(attempt *a) {
    complex_free(a->complex);
    labels_free(&a->labels);
    erosion_free(&a->eroded);
    RELEASE(a->node_left);
    *a = (attempt){0};
}

/* Components and loops of a graph of pairs; `marked` may be NULL for all of them. */
static starg_status count_topology(starg_context *context, size_t node_count, const uint32_t *links,
                                   const bool *marked, size_t link_count, size_t *parts,
                                   size_t *loops) {
    SCOPED uint32_t *sets = NULL;
    size_t joined = 0, used = 0;
    NEW(context, STAGE, sets, node_count);
    sets_make(sets, node_count);
    for (size_t l = 0; l < link_count; l++) {
        if (marked != NULL && !marked[l])
            continue;
        uint32_t a = sets_find(sets, links[2 * l]), b = sets_find(sets, links[2 * l + 1]);
        used++;
        joined += a != b;
        sets_join(sets, a, b);
    }
    *parts = node_count - joined;
    *loops = used - joined;
    return STARG_OK;
}

static starg_status count_attempt(starg_context *context, attempt *a) {
    return count_topology(context, a->complex->node_count, &a->complex->links[0][0],
                          a->eroded.link_left, a->complex->link_count, &a->parts, &a->loops);
}

/* Complex and erosion of labelled samples. */
static starg_status erode(starg_context *context, const starg_solid *solid, const conformed *from,
                          bool contract, attempt *a) {
    const surface_samples *samples = &from->samples;
    TRY(complex_create(context, solid, samples->points, samples->point_count, from->tetrahedra,
                       a->labels.inside, &a->complex));
    if (contract)
        TRY(contract_complex(context, a->complex));
    return erosion_run(context, a->complex, &a->eroded);
}

/* Labels, complex and erosion of conformed samples. What shrinks to a point may be stuck once parts
 * of it are contracted; then nothing is contracted. */
static starg_status make_attempt(starg_context *context, const starg_solid *solid,
                                 const conformed *from, attempt *a) {
    const surface_samples *samples = &from->samples;
    TRY(labels_create(context, solid, samples, from->tetrahedra, &a->labels));
    TRY(erode(context, solid, from, true, a));
    if (a->eroded.cut_count > solid->check->cavities) {
        complex_free(a->complex);
        a->complex = NULL;
        erosion_free(&a->eroded);
        TRY(erode(context, solid, from, false, a));
    }
    TRY(count_attempt(context, a));
    a->spacing = sqrt(1.1547 * solid->check->area / (double)samples->point_count);
    return STARG_OK;
}

/* The topology required by the surface: half its Euler characteristic is the solid's. */
static bool is_as_expected(const starg_check *check, size_t parts, size_t loops) {
    return parts == check->components - check->cavities && loops == (size_t)check->genus;
}

/* Distance of an attempt from the required topology; missing parts weigh more than excess ones,
 * since they cannot be repaired. */
static size_t count_faults(const starg_check *check, const attempt *a) {
    enum { MISSING = 1000 };
    size_t parts = check->components - check->cavities, loops = (size_t)check->genus;
    return (a->parts < parts ? MISSING * (parts - a->parts) : a->parts - parts) +
           (a->loops < loops ? MISSING * (loops - a->loops) : a->loops - loops);
}

static starg_status find_best(starg_context *context, const starg_solid *solid, bool moved,
                              attempt *best) {
    starg_status status = STARG_OK;
    attempt a = {0};
    surface_samples samples = {0};
    conformed results[CONFORM_RESULTS] = {0};
    size_t count;
    STARG_TRY(samples_create(context, solid, LEAST_SAMPLES, moved, &samples));
    STARG_TRY(conform_samples(context, &samples, results, &count));
    if (moved && results[0].lost > 0)
        goto done;
    /* Counts decide between strategies that lose faces. If the surface intersects itself, none is
     * right. */
    size_t judged = results[0].lost > 0 && solid->check->embedded ? count : 1;
    for (size_t i = 0; i < judged; i++) {
        STARG_TRY(make_attempt(context, solid, &results[i], &a));
        if (best->complex == NULL ||
            count_faults(solid->check, &a) < count_faults(solid->check, best)) {
            attempt_free(best);
            *best = a;
            a = (attempt){0};
        }
        attempt_free(&a);
        if (count_faults(solid->check, best) == 0)
            break;
    }
done:
    attempt_free(&a);
    samples_free(&samples);
    for (size_t i = 0; i < CONFORM_RESULTS; i++)
        conformed_free(&results[i]);
    return status;
}

/* Removes components and loops that the solid does not have. */
static starg_status repair_topology(starg_context *context, const starg_solid *solid, attempt *a) {
    const starg_check *check = solid->check;
    size_t parts = check->components - check->cavities, loops = (size_t)check->genus;
    NEW(context, STAGE, a->node_left, a->complex->node_count);
    memset(a->node_left, true, a->complex->node_count * sizeof *a->node_left);
    if (a->parts > parts) {
        a->mends += a->parts - parts;
        TRY(graph_repair_parts(context, a->complex, a->eroded.link_left, a->node_left, parts));
        TRY(count_attempt(context, a));
    }
    if (a->loops > loops && a->loops - loops <= MAX_MENDS) {
        a->mends += a->loops - loops;
        TRY(graph_repair_loops(context, a->complex, a->eroded.link_left, a->loops - loops));
    }
    return STARG_OK;
}

static starg_status find_graph(starg_context *context, const starg_solid *solid, attempt *a) {
    if (solid->check->embedded)
        TRY(find_best(context, solid, true, a));
    if (a->complex == NULL || count_faults(solid->check, a) > 0 ||
        a->eroded.cut_count > solid->check->cavities) { /* too thin for samples that are moved */
        attempt_free(a);
        TRY(find_best(context, solid, false, a));
    }
    if (a->complex->node_count == 0)
        TRY(starg_fail(context, STARG_ERROR_MESH, STAGE,
                       "the solid is too flat for interior tetrahedra"));
    return repair_topology(context, solid, a);
}

static void count_degrees(const starg_skeleton *skeleton, uint32_t *degrees, size_t *joints,
                          size_t *ends) {
    for (size_t e = 0; e < 2 * skeleton->edge_count; e++)
        degrees[skeleton->edges[e]]++;
    for (size_t v = 0; v < skeleton->node_count; v++) {
        *joints += degrees[v] > 2;
        *ends += degrees[v] == 1;
    }
}

static starg_status describe(starg_context *context, const starg_solid *solid, const attempt *a,
                             starg_skeleton *skeleton) {
    SCOPED uint32_t *degrees = NULL;
    NEW_ZERO(context, STAGE, degrees, skeleton->node_count);
    count_degrees(skeleton, degrees, &skeleton->joints, &skeleton->ends);
    TRY(count_topology(context, skeleton->node_count, skeleton->edges, NULL, skeleton->edge_count,
                       &skeleton->components, &skeleton->loops));
    skeleton->cuts = a->eroded.cut_count;
    skeleton->mends = a->mends;
    /* what collapses to a graph is a handlebody; what was cut or mended need not be one */
    skeleton->homotopic = solid->check->cavities == 0 && skeleton->cuts == 0 &&
                          skeleton->mends == 0 &&
                          is_as_expected(solid->check, skeleton->components, skeleton->loops);
    return STARG_OK;
}

static void tell(starg_context *context, const starg_solid *solid, const starg_skeleton *skeleton) {
    const starg_check *check = solid->check;
    if (mesh_is_rounded(check))
        return;
    if (skeleton->mends > 0)
        starg_log(context, STARG_LOG_WARNING,
                  "the surface is too thin in places or intersects itself: the skeleton had %zu "
                  "components and loops that the solid does not have, and they were removed",
                  skeleton->mends);
    if (!is_as_expected(check, skeleton->components, skeleton->loops))
        starg_log(context, STARG_LOG_WARNING,
                  "the skeleton has %zu components and %zu loops, the solid has %zu and %lld; its "
                  "surface is too coarse, too thin or intersects itself",
                  skeleton->components, skeleton->loops, check->components - check->cavities,
                  (long long)check->genus);
    else if (check->cavities > 0)
        starg_log(context, STARG_LOG_WARNING,
                  "the solid has %zu %s, which no curve can represent; the skeleton is that of the "
                  "solid with cut walls",
                  check->cavities, check->cavities == 1 ? "cavity" : "cavities");
    else if (skeleton->cuts > 0)
        starg_log(context, STARG_LOG_WARNING,
                  "%zu %s cut that do not shrink to a curve: tiny voids or knotted tunnels",
                  skeleton->cuts, skeleton->cuts == 1 ? "wall was" : "walls were");
}

static const starg_field OPTIONS[] = {
    {.key = "node_count",
     .option = "nodes",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_skeleton_options, node_count),
     .least = 1,
     .most = MAX_NODES,
     .initial = 1000,
     .value = "N",
     .help = "Approximate number of nodes; joints, ends and loops are always kept."},
    {.key = "prune",
     .option = "prune",
     .kind = STARG_FIELD_REAL,
     FIELD_MEMBER(starg_skeleton_options, prune),
     .low = 1,
     .high = 1e6,
     .standard = 1.5,
     .value = "X",
     .help = "Remove branches shorter than X times the local half-width of the solid at their "
             "joint; 1 keeps the most branches."},
};
static const starg_fields OPTIONS_TABLE = {
    .name = "skeleton options", .size = sizeof(starg_skeleton_options), FIELD_ROWS(OPTIONS)};
OPTIONS_BY(OPTIONS_TABLE, starg_skeleton_options)

starg_status starg_skeleton_create(starg_context *context, const starg_solid *solid,
                                   const starg_skeleton_options *options, starg_skeleton **out) {
    starg_skeleton_options defaults;
    SCOPED_BY(starg_skeleton_drop) starg_skeleton *skeleton = NULL;
    SCOPED_BY(attempt_free) attempt a = {0};
    SCOPED_BY(graph_free) curve_graph graph = {0};
    SCOPED_BY(prune_free) pruned_graph pruned = {0};
    *out = NULL;
    starg_skeleton_options_default(&defaults);
    options = options != NULL ? options : &defaults;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(fields_check(context, STAGE, &OPTIONS_TABLE, options));
    NEW_ZERO(context, STAGE, skeleton, 1);
    TRY(find_graph(context, solid, &a));
    TRY(graph_create(context, a.complex->node_count, a.complex->links, a.eroded.link_left,
                     a.complex->link_count, &graph));
    TRY(prune_graph(context, solid, a.complex, &graph, a.node_left, a.eroded.values, options->prune,
                    a.spacing, &pruned));
    TRY(curve_create(context, solid, a.complex, &graph, &pruned, options->node_count, skeleton));
    TRY(describe(context, solid, &a, skeleton));
    tell(context, solid, skeleton);
    *out = skeleton;
    skeleton = NULL;
    return STARG_OK;
}

void starg_skeleton_free(starg_context *context, starg_skeleton *skeleton) {
    (void)context;
    if (skeleton == NULL)
        return;
    RELEASE(skeleton->positions, skeleton->radii, skeleton->edges, skeleton->vertex_nodes,
            skeleton);
}
