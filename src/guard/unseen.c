/* SPDX-License-Identifier: Apache-2.0 */
/* Faces that are invisible from everywhere in the free space, as a whole: what a scanner misses,
 * and what a renderer can drop.
 *
 * Stages:
 *   1. A face within matter, or with matter before it, is invisible (mesh/buried.c).
 *   2. Candidates, and points above other faces that these do not see (guard/augment.c): what one
 *      of them sees is seen.
 *   3. For the rest, the free space is cut into boxes. A test finds what is certainly hidden
 *      from a box (visibility/box.h); a child is tested only for what its parent leaves open, and a
 *      box with nothing open is not cut. The open faces are also tested from the centre of each
 *      child.
 *   4. A face that no box leaves open is invisible: the boxes cover all places where guards may
 *      stand. Faces still open when the budget is used up are undecided.
 * Boxes are cut in the middle of their longest sides, those with most open faces first, in batches:
 * the result depends on the budget alone, not on threads.
 *
 * Cost: work is counted in tests of a vertex against a box, as in a search. */
#include <stdlib.h>

#include "core/fields.h"
#include "core/parallel.h"
#include "guard/candidates.h"
#include "guard/stages.h"
#include "mesh/solid.h"
#include "visibility/box.h"
#include "visibility/scene.h"

static const char STAGE[] = "unseen";

enum { BATCH = 256, CANDIDATES = 300 };
enum { ABOVE = 1500 }; /* work of a face that is looked at from points above it */

typedef struct unseen_box {
    bvh_box box;
    uint64_t *open; /* bits of the list: superset of what points of the box see */
    uint32_t count; /* number of open faces at the last count; 0: not counted yet */
} unseen_box;

typedef struct unseen_search {
    starg_context *context;
    const starg_solid *solid;
    starg_visibility_options view;
    double clearance;
    visibility_scene *points;
    box_scene *boxes;
    STARG_ARRAY(uint32_t) list;   /* faces that no candidate sees */
    STARG_ARRAY(uint32_t) buried; /* those within matter, which are not in the list */
    uint64_t *open;               /* bits of the list: not seen yet */
    bool changed;                 /* some were seen since the last count */
    STARG_ARRAY(unseen_box) leaves;
    unseen_box *parts;        /* of a batch: two for each leaf that is cut */
    uint32_t *cut;            /* the leaves being cut */
    uint64_t *looks;          /* of each part: what its centre sees */
    uint64_t *work;           /* of each part */
    candidate_points *places; /* receives centres that see what nothing saw before; or NULL */
    uint64_t spent;
} unseen_search;

static size_t words_of(const unseen_search *s) {
    return starg_bit_words(s->list.count);
}

/* ---- looking from points ---- */

/* Looks for points above the faces that neither the pool sees nor matter hides, as long as half of
 * the budget lasts; at least once. */
static starg_status look_from_above(unseen_search *s, uint64_t budget, uint8_t *tried,
                                    guard_pool *pool) {
    size_t faces = starg_space_model_faces(s->solid);
    SCOPED uint8_t *unseen = NULL;
    SCOPED_BY(candidates_free) candidate_points found = {0};
    const augmentation all = {s->solid, &s->view, s->clearance, tried};
    bool pending = true;
    NEW_ZERO(s->context, STAGE, unseen, s->solid->mesh->face_count);
    while (pending && !pool->time_limited) {
        size_t before = 0, after = 0;
        for (size_t f = 0; f < faces; f++) {
            unseen[f] = solid_is_target(s->solid, false, f) && !starg_bit_test(pool->coverable, f);
            before += tried[f];
        }
        found.data.count = 0;
        starg_status status = augment_candidates(s->context, &all, unseen, &found, &pending);
        if (status == STARG_ERROR_TIME)
            return STARG_OK;
        TRY(status);
        if (found.data.count > 0)
            TRY(pool_add(pool, &found));
        for (size_t f = 0; f < faces; f++)
            after += tried[f];
        s->spent += (after - before) * ABOVE;
        pending = pending && s->spent < budget / 2;
    }
    return STARG_OK;
}

static starg_status look_from_candidates(unseen_search *s, const starg_guard_options *options,
                                         uint64_t budget) {
    SCOPED_BY(pool_free) guard_pool pool = {0};
    SCOPED_BY(candidates_free) candidate_points points = {0};
    SCOPED uint8_t *tried = NULL;
    const candidate_shape shape = {s->solid, s->solid, s->clearance};
    NEW_ZERO(s->context, STAGE, tried, s->solid->mesh->face_count);
    for (uint32_t f = 0; f < starg_space_model_faces(s->solid); f++) {
        tried[f] = solid_is_target(s->solid, false, f) && solid_hides(s->solid, f);
        if (tried[f])
            PUSH(s->context, STAGE, &s->buried, f);
    }
    TRY(pool_create(s->context, s->solid, options, &pool));
    TRY(candidates_find(s->context, &shape, STARG_CANDIDATES_INTERIOR, CANDIDATES, &points));
    TRY(pool_add(&pool, &points));
    TRY(look_from_above(s, budget, tried, &pool));
    if (candidates_count(&points) == 0 && pool_count(&pool) == 0)
        return starg_fail(s->context, STARG_ERROR_MESH, STAGE,
                          "no place was found where anybody may stand; try wider limits (box, "
                          "distances, clearance)");
    for (uint32_t f = 0, k = 0; f < starg_space_model_faces(s->solid); f++) {
        bool buried = k < s->buried.count && s->buried.data[k] == f;
        k += buried;
        if (!buried && solid_is_target(s->solid, false, f) && !starg_bit_test(pool.coverable, f))
            PUSH(s->context, STAGE, &s->list, f);
    }
    return STARG_OK;
}

static void middle_of(const bvh_box *box, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = 0.5 * box->lower[k] + 0.5 * box->upper[k];
}

static void look_from_middle(const unseen_search *s, const unseen_box *part, uint64_t *seen) {
    double p[3];
    middle_of(&part->box, p);
    if (!candidates_allowed(s->solid, p, s->clearance))
        return;
    for (size_t w = 0; w < words_of(s); w++)
        STARG_FOR_BITS (bit, part->open[w] & s->open[w])
            if (scene_sees_patch(s->points, p, s->list.data[64 * w + bit], &s->view))
                starg_bit_set(seen, 64 * w + bit);
}

/* ---- looking from boxes ---- */

static uint64_t look_from_box(const unseen_search *s, box_worker *worker, const uint64_t *among,
                              unseen_box *part) {
    const box_question question = {.box = part->box,
                                   .target = STARG_TARGET_FACES,
                                   .targets = s->list.data,
                                   .count = s->list.count,
                                   .range = s->view.range,
                                   .among = among};
    if (!solid_bars(s->solid, &part->box))
        box_look(worker, &question, part->open, NULL);
    return box_worker_take_work(worker) + 1;
}

static starg_status make_worker(starg_context *context, void *shared, void **scratch) {
    const unseen_search *s = shared;
    box_worker *worker = NULL;
    (void)context;
    starg_status status = box_worker_create(s->boxes, &worker);
    *scratch = worker;
    return status;
}

static void free_worker(starg_context *context, void *scratch) {
    (void)context;
    box_worker_free(scratch);
}

static starg_status look_from_part(starg_context *context, void *shared, void *scratch,
                                   size_t item) {
    unseen_search *s = shared;
    unseen_box *part = &s->parts[item];
    (void)context;
    s->work[item] = look_from_box(s, scratch, s->leaves.data[s->cut[item / 2]].open, part);
    look_from_middle(s, part, s->looks + item * words_of(s));
    return STARG_OK;
}

/* ---- cutting ---- */

static int longest_side(const bvh_box *box) {
    int longest = 0;
    for (int k = 1; k < 3; k++)
        if (box->upper[k] - box->lower[k] > box->upper[longest] - box->lower[longest])
            longest = k;
    return longest;
}

/* False: the box is as small as doubles allow. */
static bool halve(const bvh_box *box, bvh_box parts[2]) {
    int k = longest_side(box);
    double at = 0.5 * box->lower[k] + 0.5 * box->upper[k];
    parts[0] = parts[1] = *box;
    parts[0].upper[k] = parts[1].lower[k] = at;
    return at > box->lower[k] && at < box->upper[k];
}

/* The number of faces neither seen nor hidden from the box. */
static uint32_t count_open(const unseen_search *s, const unseen_box *leaf) {
    size_t count = 0;
    for (size_t w = 0; w < words_of(s); w++)
        count += starg_bits_in(leaf->open[w] & s->open[w]);
    return (uint32_t)count;
}

/* Counts what has changed, and removes the leaves with nothing open. */
static void drop_leaves(unseen_search *s) {
    size_t kept = 0;
    for (size_t i = 0; i < s->leaves.count; i++) {
        unseen_box *leaf = &s->leaves.data[i];
        if (s->changed || leaf->count == 0)
            leaf->count = count_open(s, leaf);
        if (leaf->count > 0)
            s->leaves.data[kept++] = *leaf;
        else
            starg_release(s->context, leaf->open);
    }
    s->leaves.count = kept;
    s->changed = false;
}

static double volume_of(const bvh_box *box) {
    return (box->upper[0] - box->lower[0]) * (box->upper[1] - box->lower[1]) *
           (box->upper[2] - box->lower[2]);
}

/* By faces times volume, descending, so that only small boxes stay undecided. */
static int by_size(const void *a, const void *b) {
    const unseen_box *x = a, *y = b;
    double first = x->count * volume_of(&x->box), second = y->count * volume_of(&y->box);
    if (first != second)
        return first > second ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (x->box.lower[k] != y->box.lower[k])
            return x->box.lower[k] < y->box.lower[k] ? -1 : 1;
    return 0;
}

/* Chooses the leaves to cut, and makes room for their parts. */
static starg_status choose_cut(unseen_search *s, size_t *count) {
    *count = 0;
    qsort(s->leaves.data, s->leaves.count, sizeof *s->leaves.data, by_size);
    for (size_t i = 0; i < s->leaves.count && *count < BATCH; i++) {
        bvh_box halves[2];
        if (!halve(&s->leaves.data[i].box, halves))
            continue;
        for (size_t k = 0; k < 2; k++) {
            unseen_box *part = &s->parts[2 * *count + k];
            *part = (unseen_box){.box = halves[k]};
            NEW_ZERO(s->context, STAGE, part->open, words_of(s));
        }
        s->cut[(*count)++] = (uint32_t)i;
    }
    return STARG_OK;
}

/* The parts replace the leaves that were cut. */
static starg_status take_parts(unseen_search *s, size_t count) {
    for (size_t i = 0; i < 2 * count; i++) {
        const uint64_t *seen = s->looks + i * words_of(s);
        bool is_new = false;
        double p[3];
        s->spent += s->work[i];
        for (size_t w = 0; w < words_of(s); w++) {
            is_new |= (s->open[w] & seen[w]) != 0;
            s->open[w] &= ~seen[w];
        }
        s->changed = s->changed || is_new;
        middle_of(&s->parts[i].box, p);
        if (is_new && s->places != NULL)
            TRY(candidates_push(s->context, s->places, p, NULL));
    }
    for (size_t i = 0; i < 2 * count; i++) {
        unseen_box *leaf = &s->leaves.data[s->cut[i / 2]];
        if (i % 2 == 0) {
            starg_release(s->context, leaf->open);
            *leaf = s->parts[i];
        } else
            PUSH(s->context, STAGE, &s->leaves, s->parts[i]);
        s->parts[i].open = NULL;
    }
    return STARG_OK;
}

static starg_status cut_batch(unseen_search *s, size_t *count) {
    TRY(choose_cut(s, count));
    memset(s->looks, 0, 2 * BATCH * words_of(s) * sizeof *s->looks);
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = 2 * *count,
                                      .shared = s,
                                      .item = look_from_part,
                                      .make_scratch = make_worker,
                                      .free_scratch = free_worker,
                                      .silent = true};
    TRY(starg_parallel_for(s->context, &loop));
    return take_parts(s, *count);
}

static starg_status begin_leaves(unseen_search *s) {
    starg_status status = STARG_OK;
    unseen_box root = {0};
    solid_reach(s->solid, &root.box);
    STARG_NEW_ZERO(s->context, STAGE, s->open, words_of(s));
    STARG_NEW_ZERO(s->context, STAGE, s->parts, 2 * BATCH);
    STARG_NEW_ZERO(s->context, STAGE, s->cut, BATCH);
    STARG_NEW_ZERO(s->context, STAGE, s->work, 2 * BATCH);
    STARG_NEW_ZERO(s->context, STAGE, s->looks, 2 * BATCH * words_of(s));
    STARG_NEW_ZERO(s->context, STAGE, root.open, words_of(s));
    for (size_t i = 0; i < s->list.count; i++) {
        starg_bit_set(s->open, i);
        starg_bit_set(root.open, i);
    }
    STARG_PUSH(s->context, STAGE, &s->leaves, root);
    root.open = NULL;
done:
    starg_release(s->context, root.open);
    return status;
}

static starg_status cut_boxes(unseen_search *s, uint64_t budget) {
    size_t count = 1;
    TRY(begin_leaves(s));
    while (s->leaves.count > 0 && count > 0 && s->spent < budget &&
           !starg_time_is_over(s->context)) {
        TRY(starg_check_cancel(s->context, STAGE));
        TRY(cut_batch(s, &count));
        drop_leaves(s);
    }
    return STARG_OK;
}

/* ---- the call ---- */

static starg_status begin(unseen_search *s) {
    TRY(scene_create(s->context, s->solid, &s->points));
    TRY(scene_add_sights(s->points));
    return box_scene_create(s->context, s->solid, &s->boxes);
}

static void end(unseen_search *s) {
    s->context->work += s->spent;
    scene_free(s->points);
    box_scene_free(s->boxes);
    for (size_t i = 0; i < s->leaves.count; i++)
        RELEASE(s->leaves.data[i].open);
    for (size_t i = 0; s->parts != NULL && i < 2 * BATCH; i++)
        RELEASE(s->parts[i].open);
    RELEASE(s->leaves.data, s->list.data, s->buried.data, s->open, s->parts, s->cut, s->work,
            s->looks);
}

/* *unseen: bits of the list, of faces that no place was found for and that no leaf leaves open. */
static starg_status conclude(const unseen_search *s, uint64_t **unseen) {
    NEW_ZERO(s->context, STAGE, *unseen, words_of(s) + 1);
    for (size_t w = 0; s->open != NULL && w < words_of(s); w++) {
        uint64_t left = 0;
        for (size_t k = 0; k < s->leaves.count; k++)
            left |= s->leaves.data[k].open[w];
        (*unseen)[w] = s->open[w] & ~left;
    }
    return STARG_OK;
}

/* Reports the faces that some leaf leaves open. */
static starg_status report(const unseen_search *s, uint8_t **out) {
    size_t faces = starg_space_model_faces(s->solid);
    SCOPED uint64_t *unseen = NULL;
    TRY(conclude(s, &unseen));
    NEW_ZERO(s->context, STAGE, *out, faces);
    for (size_t f = 0; f < faces; f++)
        (*out)[f] = solid_is_target(s->solid, false, f) ? STARG_FACE_SEEN : STARG_FACE_IGNORED;
    for (size_t i = 0; i < s->buried.count; i++)
        (*out)[s->buried.data[i]] = STARG_FACE_UNSEEN;
    for (size_t i = 0; i < s->list.count; i++)
        if (starg_bit_test(s->open, i))
            (*out)[s->list.data[i]] =
                starg_bit_test(unseen, i) ? STARG_FACE_UNSEEN : STARG_FACE_UNDECIDED;
    return STARG_OK;
}

starg_status starg_unseen(starg_context *context, const starg_solid *scene,
                          const starg_visibility_options *view, double clearance, uint64_t work,
                          uint8_t **out) {
    starg_guard_options options;
    *out = NULL;
    starg_guard_options_default(&options);
    if (view != NULL)
        options.visibility = *view;
    options.visibility.target = STARG_TARGET_FACES;
    options.clearance = clearance;
    SCOPED_BY(end)
    unseen_search s = {
        .context = context, .solid = scene, .view = options.visibility, .clearance = clearance};
    TRY(fields_check(context, STAGE, starg_guard_options_fields(), &options));
    if (sensor_is_directed(&options.visibility))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "what nobody sees is hidden in all directions; leave out cone and "
                          "field of view");
    TRY(sensor_check(context, STAGE, 0, &options.visibility));
    TRY(begin(&s));
    TRY(look_from_candidates(&s, &options, work));
    if (s.list.count > 0)
        TRY(cut_boxes(&s, work));
    return report(&s, out);
}

/* Proves matter that no place sees the patch? A hidden face may have visible parts. */
static bool is_hidden(const starg_solid *solid, uint32_t patch) {
    const mesh_patches *patches = solid->patches;
    bool buried = false;
    if (patches == NULL)
        return solid_hides(solid, patch);
    for (size_t k = 0; k < patches->corners && !buried; k++) {
        uint32_t corner = patches_corner(patches, patch, k);
        buried = corner < patches->vertex_count && solid_buries(solid, corner);
    }
    return buried;
}

/* Patches that are asked about, and which of them matter hides. */
typedef struct hidden_job {
    const starg_solid *solid;
    const uint32_t *patches;
    uint8_t *hidden;
} hidden_job;

static starg_status test_hidden(starg_context *context, void *shared, void *scratch, size_t item) {
    const hidden_job *job = shared;
    (void)context;
    (void)scratch;
    job->hidden[item] = is_hidden(job->solid, job->patches[item]);
    return STARG_OK;
}

/* The number of faces all of whose listed patches, which are ascending, are proven to be unseen. */
static size_t count_faces(const starg_solid *solid, const uint32_t *patches, const uint8_t *proven,
                          size_t count) {
    size_t faces = 0;
    for (size_t i = 0, next; i < count; i = next) {
        bool all = true;
        for (next = i; next < count && solid_patch_face(solid, patches[next]) ==
                                           solid_patch_face(solid, patches[i]);
             next++)
            all = all && proven[next];
        faces += all;
    }
    return faces;
}

starg_status unseen_prove(starg_context *context, const starg_solid *solid,
                          const starg_guard_options *options, const uint32_t *patches, size_t count,
                          uint64_t work, size_t *faces, candidate_points *places) {
    SCOPED uint8_t *proven = NULL;
    SCOPED uint64_t *unseen = NULL;
    SCOPED_BY(end)
    unseen_search s = {.context = context,
                       .solid = solid,
                       .view = sensor_around(&options->visibility),
                       .clearance = options->clearance,
                       .places = places};
    NEW(context, STAGE, proven, count);
    hidden_job job = {solid, patches, proven};
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = count, .shared = &job, .item = test_hidden, .silent = true};
    TRY(starg_parallel_for(context, &loop));
    for (size_t i = 0; i < count; i++)
        if (!proven[i])
            PUSH(context, STAGE, &s.list, patches[i]);
    TRY(begin(&s));
    if (s.list.count > 0)
        TRY(cut_boxes(&s, work));
    TRY(conclude(&s, &unseen));
    for (size_t i = 0, k = 0; i < count && k < s.list.count; i++)
        if (s.list.data[k] == patches[i])
            proven[i] = starg_bit_test(unseen, k++);
    *faces = count_faces(solid, patches, proven, count);
    return STARG_OK;
}

void starg_unseen_free(starg_context *context, uint8_t *faces) {
    (void)context;
    RELEASE(faces);
}
