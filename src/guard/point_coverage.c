/* SPDX-License-Identifier: Apache-2.0 */
/* Every point of a face, by halving.
 *
 * Problem: which share of each face do guards see together, proven for every point of it?
 *
 * Method: what one guard sees of a closed face is open in the face, which is compact; so if guards
 * together see all of it, halving the longest edge ends after finitely many steps with parts of
 * which each is seen whole by one guard (Lebesgue's number lemma). A part is seen whole if its
 * corners are and nothing enters the tetrahedron of guard and part (visibility/whole.c). Parts are
 * halved in the order of their depth: those without a seen corner to UNSEEN_DEPTH, those of faces
 * where a part as large or larger has an unseen corner to SHADED_DEPTH, all others to MOST_DEPTH.
 * What is left then is open: unseen, or seen only in a limit, as from the plane of another face.
 * Corners that no guard sees are returned: a search takes them as further targets
 * (guard/every_point.c).
 *
 * Of the edges of a part, those whose ends no guard sees both come first. At a vertex v of the face
 * what a guard sees need not be open: faces around v may hide a sector from v on, but not v itself.
 * Where two guards see a sector each and these overlap, parts at v become thin, with edges across
 * the overlap, and are seen whole; halving the longest edges would leave a smaller one for ever.
 *
 * Which guards see a corner is asked once and handed down, as bits. Faces are independent of each
 * other. Cost: a sight line for each guard and halving, and a query of the tree for each guard that
 * sees all corners of a part. */
#include "guard/stages.h"

#include <math.h>

#include "core/bits.h"
#include "core/parallel.h"
#include "visibility/scene.h"

static const char STAGE[] = "points";

enum { MOST_DEPTH = 24, SHADED_DEPTH = 12, UNSEEN_DEPTH = 6 };

/* Unseen points of a face that are returned: more where there are few faces. */
enum { LEAST_UNSEEN = 6, MOST_UNSEEN = 64, ALL_UNSEEN = 2000 };

/* A corner of parts. */
typedef struct part_corner {
    patch_corner at;
    scene_point point;
} part_corner;

typedef struct part {
    uint32_t corner[3];
    int depth;
} part;

typedef struct coverage_job {
    const starg_solid *solid;
    visibility_scene *scene;
    const double *guards;
    size_t count;
    const starg_visibility_options *view;
    point_coverage *out;
    size_t most_unseen; /* of a face */
    face_point *unseen;
    uint8_t *unseen_count;
} coverage_job;

/* Memory of a thread. */
typedef struct coverage_worker {
    const coverage_job *job;
    sensor *sensors;   /* of the guards, aimed */
    bool *stands;      /* of the guards: inside */
    int8_t *side;      /* of the guards: 1 before the face, -1 before its back, 0 neither */
    uint32_t *blocker; /* of the guards: what hid a part last, or SCENE_NONE */
    STARG_ARRAY(part_corner) corners; /* of the face's parts */
    STARG_ARRAY(uint64_t) seen_by;    /* of the corners: `words` of guards */
    STARG_ARRAY(part) parts;
    size_t words, face, rank, back;
    int shaded; /* the depth of the largest part with an unseen corner */
} coverage_worker;

static void free_worker(starg_context *context, void *scratch) {
    (void)context;
    coverage_worker *w = scratch;
    if (w == NULL)
        return;
    RELEASE(w->sensors, w->stands, w->side, w->blocker, w->corners.data, w->seen_by.data,
            w->parts.data, w);
}

static starg_status make_worker(starg_context *context, void *shared, void **scratch) {
    const coverage_job *job = shared;
    const starg_visibility_options *o = job->view;
    coverage_worker *w = starg_allocate_zero(context, 1, sizeof *w);
    *scratch = w;
    if (w == NULL)
        return STARG_ERROR_MEMORY;
    w->job = job;
    w->words = starg_bit_words(job->count);
    w->sensors = starg_allocate(context, job->count, sizeof *w->sensors);
    w->stands = starg_allocate(context, job->count, sizeof *w->stands);
    w->side = starg_allocate(context, job->count, sizeof *w->side);
    w->blocker = starg_allocate(context, job->count, sizeof *w->blocker);
    if (w->sensors == NULL || w->stands == NULL || w->side == NULL || w->blocker == NULL) {
        free_worker(context, w);
        *scratch = NULL;
        return STARG_ERROR_MEMORY;
    }
    for (size_t g = 0; g < job->count; g++) {
        w->stands[g] = starg_solid_contains(job->solid, job->guards + 3 * g);
        w->sensors[g] = sensor_of(o);
        if (sensor_is_directed(o))
            sensor_aim(&w->sensors[g], o->directions + 3 * g,
                       o->ups != NULL ? o->ups + 3 * g : NULL);
    }
    return STARG_OK;
}

/* From which side, if any, does each guard see the face? */
static void find_sides(coverage_worker *w) {
    const coverage_job *job = w->job;
    w->back = scene_back(job->scene, w->rank);
    for (size_t g = 0; g < job->count; g++) {
        int side = w->stands[g] ? scene_side(job->scene, w->rank, job->guards + 3 * g) : 0;
        w->side[g] = side > 0 ? 1 : side < 0 && w->back != SCENE_NONE ? -1 : 0;
        w->blocker[g] = SCENE_NONE;
    }
}

static const uint64_t *seen_by(const coverage_worker *w, uint32_t corner) {
    return w->seen_by.data + w->words * corner;
}

static bool is_unseen(const coverage_worker *w, uint32_t corner) {
    for (size_t i = 0; i < w->words; i++)
        if (seen_by(w, corner)[i] != 0)
            return false;
    return true;
}

/* Which guards see the corner? */
static void look(const coverage_worker *w, const scene_point *corner, uint64_t *by) {
    const coverage_job *job = w->job;
    const double *face[3] = {scene_corner(job->scene, w->rank, 0),
                             scene_corner(job->scene, w->rank, 1),
                             scene_corner(job->scene, w->rank, 2)};
    const double *turned[3] = {face[0], face[2], face[1]};
    for (size_t g = 0; g < job->count; g++) {
        const double *p = job->guards + 3 * g;
        if (w->side[g] != 0 &&
            sensor_faces(&w->sensors[g], p, w->side[g] > 0 ? face : turned, corner->place.at) &&
            scene_sees_point(job->scene, p, corner, &w->sensors[g]))
            starg_bit_set(by, g);
    }
}

/* Halves of neighbours have the same corner. */
static void note_unseen(const coverage_worker *w, const patch_corner *at) {
    const coverage_job *job = w->job;
    const face_point point = {(uint32_t)w->face, *at};
    face_point *list = job->unseen + job->most_unseen * w->face;
    uint8_t *count = &job->unseen_count[w->face];
    for (size_t i = 0; i < *count; i++)
        if (memcmp(&list[i], &point, sizeof point) == 0)
            return;
    if (*count < job->most_unseen)
        list[(*count)++] = point;
}

/* Of parts of this depth. */
static starg_status add_corner(starg_context *context, coverage_worker *w, const patch_corner *at,
                               int depth) {
    uint32_t index = (uint32_t)w->corners.count;
    const part_corner corner = {*at, scene_point_of(w->job->scene, w->rank, at)};
    PUSH(context, STAGE, &w->corners, corner);
    for (size_t i = 0; i < w->words; i++)
        PUSH(context, STAGE, &w->seen_by, 0);
    look(w, &corner.point, w->seen_by.data + w->words * index);
    if (is_unseen(w, index)) {
        note_unseen(w, at);
        w->shaded = depth < w->shaded ? depth : w->shaded;
    }
    return STARG_OK;
}

/* The first guard that sees all of the part, or `count`. */
static size_t first_whole(const coverage_worker *w, const part *p) {
    const coverage_job *job = w->job;
    const uint64_t *by[3] = {seen_by(w, p->corner[0]), seen_by(w, p->corner[1]),
                             seen_by(w, p->corner[2])};
    const scene_point *at[3];
    for (size_t k = 0; k < 3; k++)
        at[k] = &w->corners.data[p->corner[k]].point;
    const scene_point front[3] = {*at[0], *at[1], *at[2]}, turned[3] = {*at[0], *at[2], *at[1]};
    for (size_t i = 0; i < w->words; i++)
        STARG_FOR_BITS (bit, by[0][i] & by[1][i] & by[2][i]) {
            size_t g = 64 * i + bit;
            bool before = w->side[g] > 0;
            if (triangle_is_wholly_visible(job->scene, job->guards + 3 * g, NULL,
                                           before ? w->rank : w->back, before ? front : turned,
                                           &w->blocker[g]))
                return g;
        }
    return job->count;
}

/* Edges with ends that no guard sees both; all if there are none. */
static unsigned edges_to_halve(const coverage_worker *w, const part *p) {
    unsigned among = ALL_EDGES;
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < w->words; i++)
            if ((seen_by(w, p->corner[k])[i] & seen_by(w, p->corner[(k + 1) % 3])[i]) != 0)
                among &= ~(1U << k);
    return among != 0 ? among : ALL_EDGES;
}

static bool is_worth_halving(const coverage_worker *w, const part *p) {
    bool dark =
        is_unseen(w, p->corner[0]) && is_unseen(w, p->corner[1]) && is_unseen(w, p->corner[2]);
    bool shaded = w->shaded <= p->depth;
    return p->depth < (dark ? UNSEEN_DEPTH : shaded ? SHADED_DEPTH : MOST_DEPTH);
}

/* Two halves of the part join the others; *halved is false where it is too small. */
static starg_status halve(starg_context *context, coverage_worker *w, const part *p, bool *halved) {
    const starg_mesh *mesh = w->job->solid->mesh;
    patch_triangle t, child[2];
    const double *corner[3];
    double square;
    for (size_t k = 0; k < 3; k++) {
        corner[k] = mesh->vertices + 3 * (size_t)mesh->faces[3 * w->face + k];
        t.corner[k] = w->corners.data[p->corner[k]].at;
    }
    int k = patch_longest_edge(&t, corner, edges_to_halve(w, p), &square), next = (k + 1) % 3;
    *halved = patch_halve(&t, k, child);
    if (!*halved)
        return STARG_OK;
    part first = *p, second = *p;
    first.depth = second.depth = p->depth + 1;
    first.corner[next] = second.corner[k] = (uint32_t)w->corners.count;
    TRY(add_corner(context, w, &child[0].corner[next], first.depth));
    PUSH(context, STAGE, &w->parts, first);
    PUSH(context, STAGE, &w->parts, second);
    return STARG_OK;
}

static starg_status cover_part(starg_context *context, coverage_worker *w, size_t index) {
    const coverage_job *job = w->job;
    const part p = w->parts.data[index];
    size_t g = first_whole(w, &p);
    bool halved = false;
    if (g == job->count && is_worth_halving(w, &p))
        TRY(halve(context, w, &p, &halved));
    if (g < job->count)
        job->out->share[g * job->solid->mesh->face_count + w->face] += ldexp(1, -p.depth);
    else if (!halved)
        job->out->open[w->face] += ldexp(1, -p.depth);
    return STARG_OK;
}

static starg_status cover_face(starg_context *context, void *shared, void *scratch, size_t face) {
    const coverage_job *job = shared;
    coverage_worker *w = scratch;
    const patch_triangle whole = patch_whole();
    const part all = {{0, 1, 2}, 0};
    if (!solid_is_target(job->solid, false, face))
        return STARG_OK;
    w->face = face;
    w->rank = job->scene->rank_of[face];
    w->corners.count = w->seen_by.count = w->parts.count = 0;
    w->shaded = MOST_DEPTH;
    find_sides(w);
    for (size_t k = 0; k < 3; k++)
        TRY(add_corner(context, w, &whole.corner[k], 0));
    PUSH(context, STAGE, &w->parts, all);
    for (size_t i = 0; i < w->parts.count; i++)
        TRY(cover_part(context, w, i));
    return STARG_OK;
}

starg_status point_coverage_find(starg_context *context, const starg_solid *solid,
                                 const double *guards, size_t count,
                                 const starg_visibility_options *view, point_coverage *out) {
    starg_status status = STARG_OK;
    size_t faces = solid->mesh->face_count, targets = starg_space_model_faces(solid);
    coverage_job job = {.solid = solid, .guards = guards, .count = count, .view = view, .out = out};
    *out = (point_coverage){0};
    STARG_NEW_ZERO(context, STAGE, out->share, count * faces);
    STARG_NEW_ZERO(context, STAGE, out->open, faces);
    job.most_unseen = targets > 0 ? ALL_UNSEEN / targets : 0;
    job.most_unseen = job.most_unseen < LEAST_UNSEEN  ? LEAST_UNSEEN
                      : job.most_unseen > MOST_UNSEEN ? MOST_UNSEEN
                                                      : job.most_unseen;
    STARG_NEW(context, STAGE, job.unseen, job.most_unseen * targets);
    STARG_NEW_ZERO(context, STAGE, job.unseen_count, targets);
    STARG_TRY(scene_create(context, solid, &job.scene));
    STARG_TRY(scene_add_sights(job.scene));
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = targets,
                                      .shared = &job,
                                      .item = cover_face,
                                      .make_scratch = make_worker,
                                      .free_scratch = free_worker};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t f = 0; f < targets; f++)
        for (size_t i = 0; i < job.unseen_count[f]; i++)
            STARG_PUSH(context, STAGE, &out->unseen, job.unseen[job.most_unseen * f + i]);
done:
    scene_free(job.scene);
    RELEASE(job.unseen, job.unseen_count);
    if (status != STARG_OK)
        point_coverage_free(out);
    return status;
}

void point_coverage_free(point_coverage *coverage) {
    RELEASE(coverage->share);
    RELEASE(coverage->open);
    RELEASE(coverage->unseen.data);
    *coverage = (point_coverage){0};
}
