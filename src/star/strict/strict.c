/* Strict star decomposition: few pieces, each proven to be star-shaped.
 *
 * Stages: the tetrahedra are claimed by guards, set after set (claim.c): a valid start; only the
 * surfaces of the sets go on (partition.c); pieces are joined, and unions of neighbours cut again
 * by planes into fewer pieces, every step with an exact certificate (improve.c); at the end each
 * piece is made of tetrahedra about its guard (cone.c).
 *
 * The start decides only how long the search takes; measured against others in
 * docs/decomposition.md. */
#include "star/strict/strict.h"

#include "star/decomposition.h"
#include "star/strict/claim.h"
#include "star/strict/cone.h"
#include "star/strict/improve.h"

static starg_status collect_guards(const partition *p, double **guards) {
    starg_status status = STARG_OK;
    STARG_NEW(p->context, PARTITION_STAGE, *guards, 3 * p->pieces.count);
    for (size_t i = 0; i < p->pieces.count; i++)
        for (int k = 0; k < 3; k++)
            (*guards)[3 * i + (size_t)k] = p->pieces.data[i].guard[k];
done:
    return status;
}

static starg_status finish(const partition *p, starg_decomposition **out) {
    starg_status status = STARG_OK;
    starg_tetmesh *mesh = NULL;
    int32_t *labels = NULL;
    double *guards = NULL;
    STARG_TRY(cone_all(p, &mesh, &labels));
    STARG_TRY(collect_guards(p, &guards));
    status = decomposition_finish(p->context, STARG_DECOMPOSE_STRICT, mesh, labels, guards,
                                  p->pieces.count, out);
    mesh = NULL;
    labels = NULL;
done:
    starg_tetmesh_free(mesh);
    starg_release(p->context, labels);
    starg_release(p->context, guards);
    return status;
}

starg_status strict_decompose(starg_context *context, const starg_tetmesh *mesh,
                              const starg_decompose_options *options, starg_decomposition **out) {
    starg_status status = STARG_OK;
    claims start = {.count = 0};
    partition p = {.context = context};
    improve_report report;
    const improve_options wanted = {.trials = options->effort > 0 ? options->effort : UINT64_MAX,
                                    .enough = options->max_pieces > 0 ? options->max_pieces : 1};
    *out = NULL;
    STARG_TRY(claim_all(context, mesh, options->guards, options->guard_count, &start));
    STARG_TRY(partition_create(context, mesh, start.labels, start.guards.data, start.count, &p));
    STARG_TRY(improve(&p, &wanted, &report));
    STARG_TRY(finish(&p, out));
    (*out)->time_limited = report.time_limited;
done:
    partition_free(&p);
    claims_free(context, &start);
    return status;
}
