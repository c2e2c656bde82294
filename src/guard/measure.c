/* What a set of guards sees, counted anew from its positions. */
#include "guard/job.h"

static const char STAGE[] = "guard";

/* By the fastest engine, whichever chose the guards: all give the same bits, and what was found is
 * measured in full after a time limit has struck. */
static starg_visibility_options view_of(const guard_job *job, starg_target target,
                                        const double *directions) {
    starg_visibility_options view = job->options->visibility;
    view.engine = STARG_VISIBILITY_FASTEST;
    view.target = target;
    view.directions = directions;
    return view;
}

/* Lists the columns that are not in `joined`; `skip` (may be NULL) leaves some out. */
static starg_status list_missing(guard_job *job, const uint64_t *joined, size_t columns,
                                 const uint64_t *skip, uint32_t **missing, size_t *count) {
    starg_status status = STARG_OK;
    STARG_NEW(job->context, STAGE, *missing, columns);
    for (size_t j = 0; j < columns; j++)
        if (!starg_bit_test(joined, j) && (skip == NULL || !starg_bit_test(skip, j)))
            (*missing)[(*count)++] = (uint32_t)j;
done:
    return status;
}

/* What the first guards see together, for each number of them; `joined` ends as what all see. */
static starg_status measure_curve(guard_job *job, const starg_bits *seen, uint64_t *joined,
                                  starg_guards *result) {
    starg_status status = STARG_OK;
    size_t faces = 0;
    double area = 0;
    STARG_NEW(job->context, STAGE, result->curve_faces, result->count);
    STARG_NEW(job->context, STAGE, result->curve_area, result->count);
    for (size_t i = 0; i < result->count; i++) {
        for (size_t w = 0; w < seen->words; w++) {
            uint64_t fresh = starg_bits_row(seen, i)[w] & ~joined[w];
            joined[w] |= fresh;
            STARG_FOR_BITS (bit, fresh) {
                faces++;
                area += job->weights.areas[64 * w + bit];
            }
        }
        bool all = faces == result->face_count;
        result->curve_faces[i] = (double)faces / (double)result->face_count;
        result->curve_area[i] = all || !(job->weights.area > 0) ? 1 : area / job->weights.area;
    }
done:
    return status;
}

static starg_status measure_faces(guard_job *job, starg_guards *result) {
    starg_status status = STARG_OK;
    const starg_visibility_options options = view_of(job, STARG_TARGET_FACES, result->directions);
    starg_bits *seen = NULL;
    uint64_t *joined = NULL;
    STARG_TRY(starg_visibility(job->context, job->solid, result->positions, result->count, &options,
                               &seen));
    for (size_t i = 0; i < result->count; i++)
        result->seen_faces[i] = starg_bits_count(seen, i);
    STARG_NEW_ZERO(job->context, STAGE, joined, seen->words);
    STARG_TRY(measure_curve(job, seen, joined, result));
    STARG_TRY(list_missing(job, joined, result->face_count, NULL, &result->uncovered,
                           &result->uncovered_count));
    result->coverage_faces = result->count > 0 ? result->curve_faces[result->count - 1] : 0;
    result->coverage_area = result->count > 0 ? result->curve_area[result->count - 1] : 0;
done:
    starg_bits_free(seen);
    starg_release(job->context, joined);
    return status;
}

/* Bits of the vertices that no face uses: they are nobody's target. */
static starg_status find_unused(guard_job *job, uint64_t **unused, size_t *used_count) {
    starg_status status = STARG_OK;
    const starg_mesh *mesh = job->solid->mesh;
    size_t words = starg_bit_words(mesh->vertex_count);
    STARG_NEW(job->context, STAGE, *unused, words);
    memset(*unused, 0xff, words * sizeof **unused);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        starg_bit_clear(*unused, mesh->faces[i]);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        *used_count += !starg_bit_test(*unused, v);
done:
    return status;
}

static starg_status measure_vertices(guard_job *job, starg_guards *result) {
    starg_status status = STARG_OK;
    starg_bits *seen = NULL;
    uint64_t *joined = NULL, *unused = NULL;
    size_t used = 0;
    const starg_visibility_options options =
        view_of(job, STARG_TARGET_VERTICES, result->directions);
    STARG_TRY(find_unused(job, &unused, &used));
    STARG_TRY(starg_visibility(job->context, job->solid, result->positions, result->count, &options,
                               &seen));
    STARG_TRY(pool_join_rows(job->context, seen, &joined));
    STARG_TRY(list_missing(job, joined, seen->columns, unused, &result->uncovered_vertices,
                           &result->uncovered_vertex_count));
    result->coverage_vertices = (double)(used - result->uncovered_vertex_count) / (double)used;
    result->coverable_vertices = starg_bit_count(job->pool.coverable, job->pool.rows->words);
done:
    starg_bits_free(seen);
    starg_release(job->context, joined);
    starg_release(job->context, unused);
    return status;
}

/* Faces that some candidate sees; with vertices as the target the rows do not tell. */
static starg_status count_coverable_faces(guard_job *job, starg_guards *result) {
    starg_status status = STARG_OK;
    starg_bits *rows = NULL;
    uint64_t *joined = NULL;
    const guard_pool *pool = &job->pool;
    if (job->options->visibility.target == STARG_TARGET_FACES) {
        result->coverable_faces = starg_bit_count(pool->coverable, pool->rows->words);
        return STARG_OK;
    }
    const starg_visibility_options options =
        view_of(job, STARG_TARGET_FACES, pool->points.directions.data);
    STARG_TRY(starg_visibility(job->context, job->solid, pool->points.data.data, pool_count(pool),
                               &options, &rows));
    STARG_TRY(pool_join_rows(job->context, rows, &joined));
    result->coverable_faces = starg_bit_count(joined, rows->words);
done:
    starg_bits_free(rows);
    starg_release(job->context, joined);
    return status;
}

starg_status measure_guards(guard_job *job, starg_guards *result) {
    starg_status status = STARG_OK;
    STARG_TRY(measure_faces(job, result));
    STARG_TRY(count_coverable_faces(job, result));
    if (job->options->visibility.target == STARG_TARGET_VERTICES)
        STARG_TRY(measure_vertices(job, result));
done:
    return status;
}
