/* SPDX-License-Identifier: Apache-2.0 */
/* Centres of maximal balls [YL11, section 3; Dey and Zhao 2004]: where the surface vertices are a
 * dense sample, the Voronoi vertices inside the solid lie near its medial axis (or near the
 * surface, between almost cospherical neighbouring vertices).
 *
 * Stages: Delaunay tetrahedra of the vertices, their circumcentres, the exact inside test. Cost:
 * that of the Delaunay tetrahedra, plus O(log n) each.
 *
 * Thinning is farthest-point sampling with distances in radii: the next ball is the one whose
 * centre is most radii away from the chosen ones. Large balls then represent a wide neighbourhood,
 * and thin parts keep their samples. O(count x wanted). */
#include "skeleton/skeleton.h"

#include "core/parallel.h"
#include "geometry/delaunay.h"
#include "geometry/vec3.h"

static const char STAGE[] = "medial axis";

/* Solves |x - a| = |x - b| = |x - c| = |x - d| by Cramer's rule about a. */
bool medial_circumscribe(const double *const v[4], medial_ball *ball) {
    double u[3][3], square[3], normal[3][3];
    for (int k = 0; k < 3; k++) {
        vec3_subtract(v[k + 1], v[0], u[k]);
        square[k] = vec3_dot(u[k], u[k]);
    }
    for (int k = 0; k < 3; k++)
        vec3_cross(u[(k + 1) % 3], u[(k + 2) % 3], normal[k]);
    double scale = 0.5 / vec3_dot(u[0], normal[0]);
    double offset[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        vec3_along(offset, scale * square[k], normal[k], offset);
    ball->radius = vec3_length(offset);
    for (int k = 0; k < 3; k++)
        ball->centre[k] = v[0][k] + offset[k];
    return isfinite(ball->radius);
}

typedef struct ball_job {
    const starg_solid *solid;
    const delaunay *tetrahedra;
    double clearance, lower[3], upper[3];
    medial_ball *balls;
    bool *inside;
} ball_job;

enum { BLOCK = 256 };

static bool examine(const ball_job *job, size_t t) {
    const double *v[4];
    for (int k = 0; k < 4; k++)
        v[k] = job->solid->mesh->vertices + 3 * (size_t)job->tetrahedra->tetrahedra[t][k];
    medial_ball *ball = &job->balls[t];
    if (!medial_circumscribe(v, ball))
        return false;
    for (int k = 0; k < 3; k++)
        if (!(job->lower[k] < ball->centre[k] && ball->centre[k] < job->upper[k]))
            return false;
    return starg_solid_contains(job->solid, ball->centre) &&
           (job->clearance <= 0 ||
            starg_solid_distance(job->solid, ball->centre) >= job->clearance);
}

static starg_status examine_block(starg_context *context, void *shared, void *scratch,
                                  size_t item) {
    const ball_job *job = shared;
    (void)context;
    (void)scratch;
    for (size_t t = item * BLOCK; t < (item + 1) * BLOCK && t < job->tetrahedra->count; t++)
        job->inside[t] = examine(job, t);
    return STARG_OK;
}

starg_status medial_balls(starg_context *context, const starg_solid *solid, double clearance,
                          medial_ball **balls, size_t *count) {
    starg_status status = STARG_OK;
    ball_job job = {.solid = solid, .clearance = clearance};
    delaunay *tetrahedra = NULL;
    *balls = NULL;
    *count = 0;
    STARG_TRY(
        delaunay_create(context, solid->mesh->vertices, solid->mesh->vertex_count, &tetrahedra));
    job.tetrahedra = tetrahedra;
    starg_mesh_bounds(solid->mesh, job.lower, job.upper);
    STARG_NEW(context, STAGE, job.balls, tetrahedra->count);
    STARG_NEW(context, STAGE, job.inside, tetrahedra->count);
    starg_parallel_loop loop = {.stage = STAGE,
                                .count = (tetrahedra->count + BLOCK - 1) / BLOCK,
                                .shared = &job,
                                .item = examine_block};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t t = 0; t < tetrahedra->count; t++)
        if (job.inside[t])
            job.balls[(*count)++] = job.balls[t];
    *balls = job.balls;
    job.balls = NULL;
done:
    delaunay_free(tetrahedra);
    RELEASE(job.balls, job.inside);
    return status;
}

static void swap_balls(medial_ball *a, medial_ball *b) {
    medial_ball swap = *a;
    *a = *b;
    *b = swap;
}

/* The ball after `last` that is farthest from the chosen ones. */
static size_t farthest(const double *scratch, size_t last, size_t count) {
    size_t best = last;
    for (size_t i = last + 1; i < count; i++)
        if (scratch[i] > scratch[best])
            best = i;
    return best;
}

starg_status medial_thin(starg_context *context, medial_ball *balls, size_t count, size_t wanted,
                         double *scratch, size_t *chosen) {
    size_t done = 0;
    for (size_t i = 0; i < count; i++)
        scratch[i] = balls[i].radius; /* start with the largest */
    *chosen = 0;
    while (done < wanted && done < count) {
        size_t best = farthest(scratch, done, count);
        TRY(starg_check_cancel(context, STAGE));
        if (!(scratch[best] > 0))
            break; /* only copies of chosen centres are left */
        swap_balls(&balls[done], &balls[best]);
        scratch[best] = scratch[done];
        const medial_ball *last = &balls[done++];
        double weight = 1 / (last->radius * last->radius);
        for (size_t i = done; i < count; i++) {
            double d = vec3_distance_squared(balls[i].centre, last->centre) * weight;
            if (done == 1 || d < scratch[i])
                scratch[i] = d;
        }
    }
    *chosen = done;
    return STARG_OK;
}
