/* Guarding a solid [YL11, section 3]: candidates, what they see, the fewest that see everything.
 *
 * Stages: candidate points; their visibility rows; more candidates until every face that can be
 * seen is seen by one (guard/complete.c); the cover; what the chosen guards see.
 *
 * The lower bound is that of the cover problem: it holds for guards taken from the final candidate
 * set. A coverage below 1 is meant by area: each face weighs its share of the total area in units
 * of 2^-40, at least one, so that the cover works on integers. */
#include "starguard/guard.h"

#include <math.h>

#include "core/bits.h"
#include "geometry/vec3.h"
#include "guard/candidates.h"
#include "starguard/cover.h"
#include "visibility/scene.h"

static const char STAGE[] = "guard";

/* A job in the making; everything is freed at the end, whatever happened. */
typedef struct guarding {
    starg_context *context;
    const starg_solid *solid;
    const starg_guard_options *options;
    candidate_points points;
    starg_bits *rows;    /* by candidate; columns are faces or vertices */
    uint64_t *coverable; /* bits of the columns that some row holds */
    double *areas;       /* by face */
    double area;         /* of all faces */
    uint64_t *weights;   /* by column */
    uint64_t total_weight;
    bool time_limited; /* before the cover was begun */
    starg_cover *cover;
    starg_bits *seen; /* faces by chosen guard */
} guarding;

void starg_guard_options_default(starg_guard_options *options) {
    *options = (starg_guard_options){
        .candidate_count = 1000, .coverage = 1, .redundancy = 1, .max_nodes = 100000};
    starg_visibility_options_default(&options->visibility);
}

static starg_status check_options(starg_context *context, const starg_guard_options *o) {
    if (o->method > STARG_GUARD_GREEDY || o->candidates > STARG_CANDIDATES_GIVEN)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "an option holds a number that its enum does not have");
    if (!(o->coverage > 0 && o->coverage <= 1))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the coverage is %g; it must be above 0 and at most 1", o->coverage);
    if (o->redundancy < 1 || o->redundancy > 1000)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the redundancy is %u; it must be 1 to 1000", o->redundancy);
    if (!(o->clearance >= 0 && o->clearance < 1e100))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the clearance is %g; it must be zero or more", o->clearance);
    return STARG_OK;
}

/* Given points that may not be used are left out, with a notice. */
static starg_status take_given(guarding *g) {
    starg_status status = STARG_OK;
    size_t dropped = 0;
    for (size_t i = 0; i < g->options->point_count; i++) {
        const double *p = g->options->points + 3 * i;
        uint64_t index = i;
        if (!(fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100))
            return starg_fail_at(g->context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_CANDIDATE,
                                 &index, 1, "candidate %zu has a coordinate that is not finite", i);
        bool inside = starg_solid_contains(g->solid, p);
        if (inside && g->options->clearance > 0)
            inside = starg_solid_distance(g->solid, p) >= g->options->clearance;
        if (inside)
            STARG_TRY(candidates_push(g->context, &g->points, p));
        dropped += !inside;
    }
    if (dropped > 0)
        starg_log(g->context, STARG_LOG_WARNING,
                  "%zu of %zu given candidates are left out: not inside, or too close to the wall",
                  dropped, g->options->point_count);
done:
    return status;
}

static starg_status make_candidates(guarding *g) {
    starg_status status = STARG_OK;
    double *points = NULL;
    size_t count = 0;
    if (g->options->candidates == STARG_CANDIDATES_GIVEN)
        return take_given(g);
    STARG_TRY(starg_candidate_points(g->context, g->solid, g->options->candidates,
                                     g->options->candidate_count, g->options->clearance, &points,
                                     &count));
    g->points.data.data = points;
    g->points.data.count = g->points.data.capacity = 3 * count;
done:
    return status;
}

/* Moves the finished rows and their points together; returns how many there are. */
static size_t keep_finished(guarding *g, size_t first, const uint8_t *finished, starg_bits *rows) {
    double *points = g->points.data.data + 3 * first;
    size_t kept = 0;
    for (size_t i = 0; i < rows->rows; i++) {
        if (!finished[i])
            continue;
        memmove(points + 3 * kept, points + 3 * i, 3 * sizeof *points);
        memmove(starg_bits_row_mutable(rows, kept), starg_bits_row(rows, i),
                rows->words * sizeof *rows->data);
        kept++;
    }
    g->time_limited = g->time_limited || kept < rows->rows;
    g->points.data.count = 3 * (first + kept);
    rows->rows = kept;
    return kept;
}

/* Appends the rows of `added`, which is consumed in any case. */
static starg_status append_rows(guarding *g, starg_bits *added) {
    starg_status status = STARG_OK;
    starg_bits *all = NULL;
    if (g->rows == NULL) {
        g->rows = added;
        return STARG_OK;
    }
    STARG_TRY(starg_bits_create(g->context, g->rows->rows + added->rows, added->columns, &all));
    memcpy(all->data, g->rows->data, g->rows->rows * all->words * sizeof *all->data);
    memcpy(starg_bits_row_mutable(all, g->rows->rows), added->data,
           added->rows * all->words * sizeof *all->data);
    starg_bits_free(g->rows);
    g->rows = all;
done:
    starg_bits_free(added);
    return status;
}

/* Computes the rows of the candidates from `first` on. Those that the time limit left unfinished
 * are no candidates. */
static starg_status add_rows(guarding *g, size_t first) {
    starg_status status = STARG_OK;
    starg_bits *added = NULL;
    uint8_t *finished = NULL;
    size_t count = g->points.data.count / 3 - first;
    STARG_NEW_ZERO(g->context, STAGE, finished, count);
    STARG_TRY(visibility_rows(g->context, g->solid, g->points.data.data + 3 * first, count,
                              &g->options->visibility, finished, &added));
    count = keep_finished(g, first, finished, added);
    for (size_t i = 0; i < count; i++)
        for (size_t w = 0; w < added->words; w++)
            g->coverable[w] |= starg_bits_row(added, i)[w];
    STARG_TRY(append_rows(g, added));
done:
    starg_release(g->context, finished);
    return status;
}

/* Marks the faces that are wanted but not coverable; with vertices as the target, the faces around
 * a vertex that is not. */
static void mark_unseen(const guarding *g, uint8_t *unseen) {
    const starg_mesh *mesh = g->solid->mesh;
    bool vertices = g->options->visibility.target == STARG_TARGET_VERTICES;
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *c = mesh->faces + 3 * f;
        if (vertices)
            unseen[f] = !starg_bit_test(g->coverable, c[0]) ||
                        !starg_bit_test(g->coverable, c[1]) || !starg_bit_test(g->coverable, c[2]);
        else
            unseen[f] = !starg_bit_test(g->coverable, f);
    }
}

static starg_status complete(guarding *g) {
    starg_status status = STARG_OK;
    uint8_t *unseen = NULL;
    completion all = {g->solid, &g->options->visibility, g->options->clearance, NULL};
    bool pending = g->options->candidates != STARG_CANDIDATES_GIVEN;
    STARG_NEW_ZERO(g->context, STAGE, all.tried, g->solid->mesh->face_count);
    STARG_NEW(g->context, STAGE, unseen, g->solid->mesh->face_count);
    while (pending && !g->time_limited) {
        size_t first = g->points.data.count / 3;
        mark_unseen(g, unseen);
        status = complete_candidates(g->context, &all, unseen, &g->points, &pending);
        if (status == STARG_ERROR_TIME) {
            status = STARG_OK;
            g->time_limited = true;
            break;
        }
        STARG_TRY(status);
        if (g->points.data.count / 3 > first)
            STARG_TRY(add_rows(g, first));
    }
done:
    starg_release(g->context, all.tried);
    starg_release(g->context, unseen);
    return status;
}

static starg_status measure_areas(guarding *g) {
    starg_status status = STARG_OK;
    const starg_mesh *mesh = g->solid->mesh;
    STARG_NEW(g->context, STAGE, g->areas, mesh->face_count);
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *c = mesh->faces + 3 * f;
        g->areas[f] =
            vec3_triangle_area(mesh->vertices + 3 * (size_t)c[0], mesh->vertices + 3 * (size_t)c[1],
                               mesh->vertices + 3 * (size_t)c[2]);
        g->area += g->areas[f];
    }
done:
    return status;
}

static starg_status weigh(guarding *g) {
    starg_status status = STARG_OK;
    bool vertices = g->options->visibility.target == STARG_TARGET_VERTICES;
    STARG_NEW(g->context, STAGE, g->weights, g->rows->columns);
    for (size_t j = 0; j < g->rows->columns; j++) {
        double share = vertices || !(g->area > 0) ? 0 : g->areas[j] / g->area;
        uint64_t weight = (uint64_t)llround(share * 0x1p40);
        g->weights[j] = weight > 0 ? weight : 1;
        g->total_weight += g->weights[j];
    }
done:
    return status;
}

static uint64_t coverable_weight(const guarding *g) {
    uint64_t sum = 0;
    for (size_t j = 0; j < g->rows->columns; j++)
        if (starg_bit_test(g->coverable, j))
            sum += g->weights[j];
    return sum;
}

static starg_status choose(guarding *g) {
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = g->rows;
    problem.redundancy = g->options->redundancy;
    problem.max_rows = g->options->max_guards;
    if (g->options->coverage < 1 || g->options->max_guards > 0)
        problem.weights = g->weights;
    if (g->options->coverage < 1)
        problem.target = (uint64_t)ceil(g->options->coverage * (double)coverable_weight(g));
    options.method =
        g->options->method == STARG_GUARD_GREEDY ? STARG_COVER_GREEDY : STARG_COVER_ILP;
    options.max_nodes = g->options->max_nodes;
    return starg_cover_solve(g->context, &problem, &options, &g->cover);
}

static starg_status copy_positions(guarding *g, starg_guards *result) {
    starg_status status = STARG_OK;
    STARG_NEW(g->context, STAGE, result->positions, 3 * g->cover->count);
    STARG_NEW_ZERO(g->context, STAGE, result->levels, g->cover->count);
    STARG_NEW_ZERO(g->context, STAGE, result->seen_faces, g->cover->count);
    result->count = g->cover->count;
    for (size_t i = 0; i < result->count; i++)
        vec3_copy(g->points.data.data + 3 * (size_t)g->cover->rows[i], result->positions + 3 * i);
done:
    return status;
}

/* Joins the rows of a matrix that stand for what was chosen. */
static starg_status join_rows(guarding *g, const starg_bits *rows, uint64_t **joined) {
    starg_status status = STARG_OK;
    STARG_NEW_ZERO(g->context, STAGE, *joined, rows->words);
    for (size_t i = 0; i < rows->rows; i++)
        for (size_t w = 0; w < rows->words; w++)
            (*joined)[w] |= starg_bits_row(rows, i)[w];
done:
    return status;
}

/* Lists the columns that are not in `joined`; `skip` (may be NULL) leaves some out. */
static starg_status list_missing(guarding *g, const uint64_t *joined, size_t columns,
                                 const uint64_t *skip, uint32_t **missing, size_t *count) {
    starg_status status = STARG_OK;
    STARG_NEW(g->context, STAGE, *missing, columns);
    for (size_t j = 0; j < columns; j++)
        if (!starg_bit_test(joined, j) && (skip == NULL || !starg_bit_test(skip, j)))
            (*missing)[(*count)++] = (uint32_t)j;
done:
    return status;
}

static starg_status measure_faces(guarding *g, starg_guards *result) {
    starg_status status = STARG_OK;
    starg_visibility_options options = g->options->visibility;
    const size_t faces = g->solid->mesh->face_count;
    uint64_t *joined = NULL;
    options.target = STARG_TARGET_FACES;
    STARG_TRY(starg_visibility(g->context, g->solid, result->positions, result->count, &options,
                               &g->seen));
    for (size_t i = 0; i < result->count; i++)
        result->seen_faces[i] = starg_bits_count(g->seen, i);
    STARG_TRY(join_rows(g, g->seen, &joined));
    STARG_TRY(list_missing(g, joined, faces, NULL, &result->uncovered, &result->uncovered_count));
    double missing = 0;
    for (size_t i = 0; i < result->uncovered_count; i++)
        missing += g->areas[result->uncovered[i]];
    result->coverage_faces = (double)(faces - result->uncovered_count) / (double)faces;
    result->coverage_area = result->uncovered_count == 0 ? 1 : (g->area - missing) / g->area;
done:
    starg_release(g->context, joined);
    return status;
}

/* Bits of the vertices that no face uses: they are nobody's target. */
static starg_status find_unused(guarding *g, uint64_t **unused, size_t *used_count) {
    starg_status status = STARG_OK;
    const starg_mesh *mesh = g->solid->mesh;
    size_t words = starg_bit_words(mesh->vertex_count);
    STARG_NEW(g->context, STAGE, *unused, words);
    memset(*unused, 0xff, words * sizeof **unused);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        starg_bit_clear(*unused, mesh->faces[i]);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        *used_count += !starg_bit_test(*unused, v);
done:
    return status;
}

static starg_status measure_vertices(guarding *g, starg_guards *result) {
    starg_status status = STARG_OK;
    starg_bits *seen = NULL;
    uint64_t *joined = NULL, *unused = NULL;
    size_t used = 0;
    STARG_TRY(find_unused(g, &unused, &used));
    STARG_TRY(starg_visibility(g->context, g->solid, result->positions, result->count,
                               &g->options->visibility, &seen));
    STARG_TRY(join_rows(g, seen, &joined));
    STARG_TRY(list_missing(g, joined, seen->columns, unused, &result->uncovered_vertices,
                           &result->uncovered_vertex_count));
    result->coverage_vertices = (double)(used - result->uncovered_vertex_count) / (double)used;
    result->coverable_vertices = starg_bit_count(g->coverable, g->rows->words);
done:
    starg_bits_free(seen);
    starg_release(g->context, joined);
    starg_release(g->context, unused);
    return status;
}

/* Faces that some candidate sees; with vertices as the target the rows do not tell. */
static starg_status count_coverable_faces(guarding *g, starg_guards *result) {
    starg_status status = STARG_OK;
    starg_bits *rows = NULL;
    uint64_t *joined = NULL;
    if (g->options->visibility.target == STARG_TARGET_FACES) {
        result->coverable_faces = starg_bit_count(g->coverable, g->rows->words);
        return STARG_OK;
    }
    starg_visibility_options options = g->options->visibility;
    options.target = STARG_TARGET_FACES;
    STARG_TRY(starg_visibility(g->context, g->solid, g->points.data.data, g->points.data.count / 3,
                               &options, &rows));
    STARG_TRY(join_rows(g, rows, &joined));
    result->coverable_faces = starg_bit_count(joined, rows->words);
done:
    starg_bits_free(rows);
    starg_release(g->context, joined);
    return status;
}

static starg_status report(guarding *g, starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guards *result = NULL;
    double deadline = g->context->deadline;
    STARG_NEW_ZERO(g->context, STAGE, result, 1);
    result->vertex_count = g->solid->mesh->vertex_count;
    result->face_count = g->solid->mesh->face_count;
    result->options = *g->options;
    result->options.points = NULL;
    result->candidate_count = g->points.data.count / 3;
    result->lower_bound = g->cover->lower_bound;
    result->optimal = g->cover->optimal;
    result->time_limited = g->time_limited || g->cover->time_limited;
    result->area_bound = 1;
    if (g->options->max_guards > 0)
        result->area_bound = (double)g->cover->weight_bound / (double)g->total_weight;
    g->context->deadline = 0; /* what was found is measured in full */
    STARG_TRY(copy_positions(g, result));
    STARG_TRY(measure_faces(g, result));
    STARG_TRY(count_coverable_faces(g, result));
    if (g->options->visibility.target == STARG_TARGET_VERTICES)
        STARG_TRY(measure_vertices(g, result));
    *out = result;
done:
    g->context->deadline = deadline;
    if (status != STARG_OK)
        starg_guards_free(g->context, result);
    return status;
}

starg_status starg_guard(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options, starg_guards **out) {
    starg_status status = STARG_OK;
    starg_guard_options defaults;
    starg_guard_options_default(&defaults);
    guarding g = {.context = context, .solid = solid, .options = options ? options : &defaults};
    *out = NULL;
    STARG_TRY(check_options(context, g.options));
    STARG_NEW_ZERO(context, STAGE, g.coverable,
                   starg_bit_words(solid->mesh->face_count + solid->mesh->vertex_count));
    STARG_TRY(measure_areas(&g));
    STARG_TRY(make_candidates(&g));
    STARG_TRY(add_rows(&g, 0));
    STARG_TRY(complete(&g));
    if (g.points.data.count == 0 && g.time_limited) {
        status = starg_fail(context, STARG_ERROR_TIME, STAGE,
                            "the time limit struck before any candidate was looked at");
        goto done;
    }
    if (g.points.data.count == 0) {
        status = starg_fail(context, STARG_ERROR_MESH, STAGE,
                            "there is no point inside the solid from which anything is seen; a "
                            "smaller clearance, a larger range or other candidates may help");
        goto done;
    }
    STARG_TRY(weigh(&g));
    STARG_TRY(choose(&g));
    STARG_TRY(report(&g, out));
done:
    STARG_ARRAY_FREE(context, &g.points.data);
    starg_bits_free(g.rows);
    starg_bits_free(g.seen);
    starg_release(context, g.coverable);
    starg_release(context, g.areas);
    starg_release(context, g.weights);
    starg_cover_free(g.cover);
    return status;
}

void starg_guards_free(starg_context *context, starg_guards *guards) {
    if (guards == NULL)
        return;
    starg_release(context, guards->file);
    starg_release(context, guards->positions);
    starg_release(context, guards->seen_faces);
    starg_release(context, guards->levels);
    starg_release(context, guards->uncovered);
    starg_release(context, guards->uncovered_vertices);
    starg_release(context, guards);
}
