/* SPDX-License-Identifier: Apache-2.0 */
/* Do guards together see every point? Faces are halved as docs/visibility.md says: a part that one
 * guard sees whole stays; of the edges of another one whose ends no guard sees both, or if there
 * are none, of all, the longest is halved. It ends after MOST_HALVINGS, or UNSEEN_HALVINGS if no
 * guard sees a corner.
 *
 * All parts of one age are asked about at once: they are patches of the surface, which every guard
 * looks at anew (verify/sight.h). In the end all parts are. Cost: a view of each guard for each
 * age, in which there are few parts after the first ones. */
#include "core/bits.h"
#include "core/parallel.h"
#include "verify/facts.h"

static const char STAGE[] = "verify";

enum { MOST_HALVINGS = 24, SHADED_HALVINGS = 12, UNSEEN_HALVINGS = 6 };

typedef struct division {
    verify_facts *known;
    verify_surface *surface; /* that of the facts */
    verify_parts young, old; /* points are those of the young ones */
    starg_bits *corners;     /* by guard: those of young parts that it sees, three each */
    starg_bits *whole;       /* likewise the parts */
    bool *shaded;            /* by face: has a part had an unseen corner? */
} division;

/* ---- what guards see of the young parts ---- */

static starg_status make_sight(starg_context *context, void *shared, void **scratch) {
    (void)context;
    const division *own = shared;
    verify_sight *sight;
    starg_status status = verify_sight_create(own->known->surface, &sight);
    *scratch = sight;
    return status;
}

static void free_sight(starg_context *context, void *scratch) {
    (void)context;
    verify_sight_free(scratch);
}

/* Does p see a corner from the inner side of the face of a patch, with what it sees of spots? */
static bool sees_corner(const verify_surface *surface, const verify_view *view, const double p[3],
                        size_t patch, uint32_t corner, const uint8_t *spots) {
    const double *t[3], *at = verify_spot_of(surface, corner).at;
    verify_corners(surface, verify_patch_face(surface, patch), t);
    return spots[corner] && verify_side(t[0], t[1], t[2], p) > 0 &&
           verify_faces(view, p, t, (const double *const[]){at, at, at});
}

static starg_status look(starg_context *context, void *shared, void *scratch, size_t g) {
    (void)context;
    division *own = shared;
    const verify_surface *surface = own->known->surface;
    const double *p = own->known->guards->positions + 3 * g;
    verify_view view = verify_view_of(own->known->guards, g);
    const uint8_t *spots, *whole;
    size_t count = own->young.list.count;
    view.rule = STARG_FACES_WHOLE;
    if (!own->known->inside[g])
        return STARG_OK;
    TRY(verify_look(scratch, p, &view, &spots, &whole));
    uint64_t *rows[2] = {starg_bits_row_mutable(own->corners, g),
                         starg_bits_row_mutable(own->whole, g)};
    for (size_t j = 0; j < count; j++) {
        for (size_t k = 0; k < 3; k++) {
            uint32_t corner = own->young.list.data[j].index[k];
            if (sees_corner(surface, &view, p, j, corner, spots) ||
                (surface->backs > 0 && sees_corner(surface, &view, p, count + j, corner, spots)))
                starg_bit_set(rows[0], 3 * j + k);
        }
        if (whole[j])
            starg_bit_set(rows[1], j);
    }
    return STARG_OK;
}

static starg_status look_around(division *own) {
    starg_context *context = own->known->surface->context;
    size_t guards = own->known->guards->count, count = own->young.list.count;
    starg_bits_free(own->corners);
    starg_bits_free(own->whole);
    own->corners = own->whole = NULL;
    TRY(verify_patches_set(&own->young, own->surface));
    TRY(starg_bits_create(context, guards, 3 * count, &own->corners));
    TRY(starg_bits_create(context, guards, count, &own->whole));
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = guards,
                                      .shared = own,
                                      .item = look,
                                      .make_scratch = make_sight,
                                      .free_scratch = free_sight};
    return starg_parallel_for(context, &loop);
}

/* ---- halving ---- */

/* Does a guard see corner i of young part j, and corner k as well? */
static bool are_seen(const division *own, size_t j, size_t i, size_t k) {
    for (size_t g = 0; g < own->corners->rows; g++)
        if (starg_bits_test(own->corners, g, 3 * j + i) &&
            starg_bits_test(own->corners, g, 3 * j + k))
            return true;
    return false;
}

static bool is_whole(const division *own, size_t j) {
    for (size_t g = 0; g < own->whole->rows; g++)
        if (starg_bits_test(own->whole, g, j))
            return true;
    return false;
}

/* The edge to be halved. */
static int find_edge(const division *own, size_t j) {
    double length[3];
    bool together[3];
    int best = 0;
    for (int k = 0; k < 3; k++) {
        length[k] = verify_edge_square(own->known->surface, &own->young.list.data[j], k);
        together[k] = are_seen(own, j, (size_t)k, (size_t)(k + 1) % 3);
        bool better = together[k] != together[best] ? !together[k] : length[k] > length[best];
        best = better ? k : best;
    }
    return best;
}

static int count_seen(const division *own, size_t j) {
    int seen = 0;
    for (size_t k = 0; k < 3; k++)
        seen += are_seen(own, j, k, k);
    return seen;
}

static void find_shaded(division *own) {
    for (size_t j = 0; j < own->young.list.count; j++)
        if (count_seen(own, j) < 3)
            own->shaded[own->young.list.data[j].face] = true;
}

/* Parts that stay become old, halves of the others are the next young ones. */
static starg_status grow_up(division *own, int halvings, verify_parts *next) {
    for (size_t j = 0; j < own->young.list.count; j++) {
        const verify_part part = own->young.list.data[j];
        int most = count_seen(own, j) == 0  ? UNSEEN_HALVINGS
                   : own->shaded[part.face] ? SHADED_HALVINGS
                                            : MOST_HALVINGS;
        bool halved = !is_whole(own, j) && halvings < most;
        verify_part half[2];
        if (halved)
            TRY(verify_halve(next, &part, find_edge(own, j), half, &halved));
        if (!halved)
            TRY(verify_parts_add(&own->old, &part));
        for (int i = 0; halved && i < 2; i++)
            TRY(verify_parts_add(next, &half[i]));
    }
    return STARG_OK;
}

/* One more age. */
static starg_status halve(division *own, int halvings) {
    starg_status status = STARG_OK;
    verify_parts next = {.surface = own->known->surface};
    next.mixes.data = own->young.mixes.data;
    next.mixes.count = own->young.mixes.count;
    next.mixes.capacity = own->young.mixes.capacity;
    own->young.mixes.data = NULL;
    own->young.mixes.count = own->young.mixes.capacity = 0;
    status = grow_up(own, halvings, &next);
    verify_parts_free(&own->young);
    own->young = next;
    return status;
}

/* ---- the whole ---- */

/* The faces that each guard sees, by the rule of the question. */
static void count_faces(division *own) {
    verify_facts *known = own->known;
    bool by_corners = known->guards->options.visibility.face_rule == STARG_FACES_VERTICES;
    for (size_t g = 0; g < known->guards->count; g++)
        for (size_t j = 0; j < own->young.list.count; j++)
            known->seen_faces[g] += by_corners ? starg_bits_test(own->corners, g, 3 * j) &&
                                                     starg_bits_test(own->corners, g, 3 * j + 1) &&
                                                     starg_bits_test(own->corners, g, 3 * j + 2)
                                               : starg_bits_test(own->whole, g, j);
}

/* Old parts by face, in the order in which they were added. */
static starg_status sort_old(division *own) {
    const verify_surface *surface = own->known->surface;
    size_t count = own->old.list.count;
    SCOPED size_t *start = NULL;
    SCOPED verify_part *sorted = NULL;
    NEW_ZERO(surface->context, STAGE, start, surface->face_count + 1);
    NEW(surface->context, STAGE, sorted, count);
    for (size_t j = 0; j < count; j++)
        start[own->old.list.data[j].face + 1]++;
    for (size_t f = 0; f < surface->face_count; f++)
        start[f + 1] += start[f];
    for (size_t j = 0; j < count; j++)
        sorted[start[own->old.list.data[j].face]++] = own->old.list.data[j];
    starg_release(surface->context, own->old.list.data);
    own->old.list.data = sorted;
    own->old.list.capacity = count;
    sorted = NULL;
    return STARG_OK;
}

starg_status verify_divide_by_points(verify_facts *known, verify_surface *surface) {
    starg_status status = STARG_OK;
    division own = {.known = known,
                    .surface = surface,
                    .young = {.surface = surface},
                    .old = {.surface = surface}};
    STARG_NEW_ZERO(surface->context, STAGE, own.shaded, surface->model_faces);
    for (uint32_t f = 0; f < surface->model_faces; f++) {
        const verify_part whole = verify_part_of(surface, f);
        if (verify_is_target(surface, f))
            STARG_TRY(verify_parts_add(&own.young, &whole));
    }
    for (int halvings = 0; own.young.list.count > 0; halvings++) {
        STARG_TRY(look_around(&own));
        if (halvings == 0)
            count_faces(&own);
        find_shaded(&own);
        STARG_TRY(halve(&own, halvings));
    }
    STARG_TRY(sort_old(&own));
    own.old.mixes.data = own.young.mixes.data;
    own.old.mixes.count = own.young.mixes.count;
    own.young.mixes.data = NULL;
    STARG_TRY(verify_patches_set(&own.old, surface));
done:
    verify_parts_free(&own.young);
    verify_parts_free(&own.old);
    starg_bits_free(own.corners);
    starg_bits_free(own.whole);
    starg_release(surface->context, own.shaded);
    return status;
}
