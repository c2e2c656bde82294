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
 * Parts of a solid that touch each other have a skeleton each.
 *
 * Cost: O(n log n) in practice for n samples, per strategy that loses faces. */
#include "skeleton/skeleton.h"
#include "core/fields.h"

#include "geometry/vec3.h"
#include "mesh/examine.h"
#include "skeleton/edge_table.h"
#include "visibility/kernel.h"

static const char STAGE[] = "skeleton";

enum { LEAST_SAMPLES = 4000, LEAST_OF_PARTS = 500, MAX_MENDS = 600, MAX_NODES = 10000000 };

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

static starg_status find_best(starg_context *context, const starg_solid *solid, size_t wanted,
                              bool moved, attempt *best) {
    starg_status status = STARG_OK;
    attempt a = {0};
    surface_samples samples = {0};
    conformed results[CONFORM_RESULTS] = {0};
    size_t count;
    STARG_TRY(samples_create(context, solid, wanted, moved, &samples));
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

static starg_status find_graph(starg_context *context, const starg_solid *solid, size_t samples,
                               attempt *a) {
    if (solid->check->embedded)
        TRY(find_best(context, solid, samples, true, a));
    if (a->complex == NULL || count_faults(solid->check, a) > 0 ||
        a->eroded.cut_count > solid->check->cavities) { /* too thin for samples that are moved */
        attempt_free(a);
        TRY(find_best(context, solid, samples, false, a));
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
                  "the surface is too thin in places, or meets itself: the skeleton had %zu "
                  "components and loops that the solid does not have, and they were removed",
                  skeleton->mends);
    if (!is_as_expected(check, skeleton->components, skeleton->loops))
        starg_log(context, STARG_LOG_WARNING,
                  "the skeleton has %zu components and %zu loops, the solid has %zu and %lld; its "
                  "surface is too coarse or too thin, or meets itself",
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

/* The skeleton of a solid as a whole, from at least so many samples. */
static starg_status create(starg_context *context, const starg_solid *solid,
                           const starg_skeleton_options *options, size_t samples,
                           starg_skeleton **out) {
    SCOPED_BY(starg_skeleton_drop) starg_skeleton *skeleton = NULL;
    SCOPED_BY(attempt_free) attempt a = {0};
    SCOPED_BY(graph_free) curve_graph graph = {0};
    SCOPED_BY(prune_free) pruned_graph pruned = {0};
    NEW_ZERO(context, STAGE, skeleton, 1);
    TRY(find_graph(context, solid, samples, &a));
    TRY(graph_create(context, a.complex->node_count, a.complex->links, a.eroded.link_left,
                     a.complex->link_count, &graph));
    TRY(prune_graph(context, solid, a.complex, &graph, a.node_left, a.eroded.values, options->prune,
                    a.spacing, &pruned));
    TRY(curve_create(context, solid, a.complex, &graph, &pruned, options->node_count, skeleton));
    TRY(describe(context, solid, &a, skeleton));
    *out = skeleton;
    skeleton = NULL;
    return STARG_OK;
}

/* ---- parts that touch ---- */

/* Samples of a surface that touches itself coincide, so that parts grow together, or are lost: each
 * part has a skeleton of its own then. */
typedef struct skeleton_parts {
    starg_context *context;
    const starg_solid *solid;
    const starg_skeleton_options *options;
    solid_parts parts;
    STARG_ARRAY(double) positions, radii;
    STARG_ARRAY(uint32_t) edges;
    uint32_t *vertex_nodes;
    STARG_ARRAY(uint32_t) vertices; /* of a part: the solid's; its faces, x 3, in these */
    STARG_ARRAY(uint32_t) faces;
    STARG_ARRAY(double) places; /* x 3 */
    uint32_t *numbers;          /* per vertex of the solid: in a part */
} skeleton_parts;

static void free_parts(skeleton_parts *s) {
    solid_parts_free(&s->parts);
    RELEASE(s->positions.data, s->radii.data, s->edges.data, s->vertex_nodes, s->vertices.data,
            s->faces.data, s->places.data, s->numbers);
}

static starg_status make_part(skeleton_parts *s, uint32_t part, starg_solid **out) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *own = NULL;
    const starg_mesh *mesh = s->solid->mesh;
    s->vertices.count = s->faces.count = s->places.count = 0;
    memset(s->numbers, 0xff, mesh->vertex_count * sizeof *s->numbers);
    for (size_t i = 0; i < 3 * mesh->face_count; i++) {
        const uint32_t v = mesh->faces[i];
        if (s->parts.of[i / 3] != part)
            continue;
        if (s->numbers[v] == UINT32_MAX) {
            s->numbers[v] = (uint32_t)s->vertices.count;
            PUSH(s->context, STAGE, &s->vertices, v);
            for (size_t k = 0; k < 3; k++)
                PUSH(s->context, STAGE, &s->places, mesh->vertices[3 * (size_t)v + k]);
        }
        PUSH(s->context, STAGE, &s->faces, s->numbers[v]);
    }
    TRY(starg_mesh_create(s->context, s->places.data, s->vertices.count, s->faces.data,
                          s->faces.count / 3, &own));
    return solid_make(s->context, own, out);
}

static starg_status add_part(skeleton_parts *s, uint32_t part, starg_skeleton *sums) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED_BY(starg_skeleton_drop) starg_skeleton *own = NULL;
    starg_skeleton_options options = *s->options;
    const size_t count = s->parts.count, first = s->radii.count;
    TRY(make_part(s, part, &solid));
    const double share = solid->check->area / s->solid->check->area;
    options.node_count = 1 + (size_t)(share * (double)options.node_count);
    TRY(create(s->context, solid, &options, LEAST_OF_PARTS + LEAST_SAMPLES / count, &own));
    for (size_t i = 0; i < own->node_count; i++) {
        PUSH(s->context, STAGE, &s->radii, own->radii[i]);
        for (size_t k = 0; k < 3; k++)
            PUSH(s->context, STAGE, &s->positions, own->positions[3 * i + k]);
    }
    for (size_t i = 0; i < 2 * own->edge_count; i++)
        PUSH(s->context, STAGE, &s->edges, (uint32_t)first + own->edges[i]);
    for (size_t v = 0; v < s->vertices.count; v++)
        s->vertex_nodes[s->vertices.data[v]] = (uint32_t)first + own->vertex_nodes[v];
    sums->components += own->components;
    sums->loops += own->loops;
    sums->joints += own->joints;
    sums->ends += own->ends;
    sums->cuts += own->cuts;
    sums->mends += own->mends;
    sums->homotopic = sums->homotopic && own->homotopic;
    return STARG_OK;
}

static starg_status create_by_parts(skeleton_parts *s, starg_skeleton **out) {
    SCOPED_BY(starg_skeleton_drop) starg_skeleton *sums = NULL;
    const size_t vertices = s->solid->mesh->vertex_count;
    NEW_ZERO(s->context, STAGE, sums, 1);
    NEW_ZERO(s->context, STAGE, s->vertex_nodes, vertices);
    NEW(s->context, STAGE, s->numbers, vertices);
    sums->homotopic = true;
    for (uint32_t part = 0; part < s->parts.count; part++)
        TRY(add_part(s, part, sums));
    sums->node_count = s->radii.count;
    sums->edge_count = s->edges.count / 2;
    sums->vertex_count = vertices;
    sums->positions = s->positions.data;
    sums->radii = s->radii.data;
    sums->edges = s->edges.data;
    sums->vertex_nodes = s->vertex_nodes;
    s->positions.data = s->radii.data = NULL;
    s->edges.data = s->vertex_nodes = NULL;
    *out = sums;
    sums = NULL;
    return STARG_OK;
}

starg_status starg_skeleton_create(starg_context *context, const starg_solid *solid,
                                   const starg_skeleton_options *options, starg_skeleton **out) {
    starg_skeleton_options defaults;
    starg_skeleton_options_default(&defaults);
    options = options != NULL ? options : &defaults;
    SCOPED_BY(free_parts)
    skeleton_parts by = {.context = context, .solid = solid, .options = options};
    *out = NULL;
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(fields_check(context, STAGE, &OPTIONS_TABLE, options));
    if (!solid->check->embedded)
        TRY(solid_parts_find(context, solid, &by.parts));
    TRY(by.parts.count > 1 ? create_by_parts(&by, out)
                           : create(context, solid, options, LEAST_SAMPLES, out));
    tell(context, solid, *out);
    return STARG_OK;
}

void starg_skeleton_free(starg_context *context, starg_skeleton *skeleton) {
    (void)context;
    if (skeleton == NULL)
        return;
    RELEASE(skeleton->positions, skeleton->radii, skeleton->edges, skeleton->vertex_nodes,
            skeleton);
}
