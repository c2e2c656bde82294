/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts of compatible pieces: three and more become two.
 *
 * Method: a random plane, in one of the places, through a random group of pieces that hang
 * together, about across from one guard to another; it is cut through the tetrahedra in both places
 * (through.c). If both parts have kernels in both places, they take the place of the group. It ends
 * when that has long saved nothing, or after a number of tetrahedra in proportion to all. */
#include "star/compatible/twin_pieces.h"

#include "core/parallel.h"
#include "core/streams.h"
#include "geometry/vec3.h"

static const char STAGE[] = "join";

enum {
    CUT_MOST = 7,     /* pieces that become two at a time, from 3 on                     */
    CUT_TRIES = 8,    /* planes for a group                                              */
    CUT_IDLE = 250,   /* groups in a row that no plane divided: then no more             */
    CUT_WORK = 1500,  /* tetrahedra of all planes, for each that there is                */
    AT_ONCE_MOST = 16 /* groups                                                        */
};

/* A plane about across from one piece of the group to another. */
static void choose_plane(const twin_pieces *w, const uint8_t *dropped, starg_rng *rng,
                         double *levels) {
    int place = (int)starg_rng_below(rng, 2);
    const starg_tetmesh *mesh = w->meshes[place];
    const double *guards = place == 0 ? w->pieces.guards.data : w->pieces.counterparts.data;
    uint32_t pair[2];
    for (int i = 0; i < 2; i++)
        do
            pair[i] = (uint32_t)starg_rng_below(rng, w->pieces.count);
        while (!dropped[pair[i]] || (i == 1 && pair[1] == pair[0]));
    const double *from = guards + 3 * (size_t)pair[0], *to = guards + 3 * (size_t)pair[1];
    double normal[3], tilt[3], point[3], at = 1.4 * starg_rng_unit(rng) - 0.2;
    double most = 0.6 * starg_rng_unit(rng) * vec3_distance(from, to);
    vec3_subtract(to, from, normal);
    vec3_along(from, at, normal, point);
    for (int k = 0; k < 3; k++)
        tilt[k] = 2 * starg_rng_unit(rng) - 1;
    vec3_along(normal, most, tilt, normal);
    memset(levels, 0, mesh->vertex_count * sizeof *levels);
    for (size_t t = 0; t < mesh->count; t++)
        for (size_t k = 0; dropped[w->pieces.labels[t]] && k < 4; k++) {
            uint32_t v = mesh->tetrahedra[4 * t + k];
            double offset[3];
            vec3_subtract(mesh->vertices + 3 * (size_t)v, point, offset);
            levels[v] = vec3_dot(offset, normal);
        }
}

/* The pieces that are kept, and the two parts. */
static starg_status number_parts(const twin_pieces *w, const uint8_t *dropped,
                                 double guards[2][2][3], twin_pieces *out) {
    SCOPED uint32_t *numbers = NULL;
    grown_regions *pieces = &out->pieces;
    NEW(w->context, STAGE, numbers, w->pieces.count);
    for (size_t p = 0; p < w->pieces.count; p++) {
        if (dropped[p])
            continue;
        numbers[p] = (uint32_t)pieces->count++;
        for (size_t k = 3 * p; k < 3 * p + 3; k++) {
            PUSH(w->context, STAGE, &pieces->guards, w->pieces.guards.data[k]);
            PUSH(w->context, STAGE, &pieces->counterparts, w->pieces.counterparts.data[k]);
        }
    }
    for (int part = 0; part < 2; part++)
        for (int k = 0; k < 3; k++) {
            PUSH(w->context, STAGE, &pieces->guards, guards[part][0][k]);
            PUSH(w->context, STAGE, &pieces->counterparts, guards[part][1][k]);
        }
    for (size_t t = 0; t < out->meshes[0]->count; t++) {
        uint32_t label = pieces->labels[t];
        pieces->labels[t] = label >= THROUGH_PART ? (uint32_t)pieces->count + (label - THROUGH_PART)
                                                  : numbers[label];
    }
    pieces->count += 2;
    return STARG_OK;
}

/* Tries planes for a group; *out has no pieces if none will do. */
static starg_status divide_group(const twin_pieces *w, const uint8_t *dropped, starg_rng *rng,
                                 through_cut *cut, twin_pieces *out) {
    double guards[2][2][3];
    bool found = false;
    for (int i = 0; i < CUT_TRIES && !found; i++) {
        choose_plane(w, dropped, rng, cut->levels);
        TRY(through_find(cut, guards, &found));
    }
    if (found)
        TRY(through_divide(cut, w->pieces.labels, out->own, &out->pieces.labels, &found));
    if (!found)
        return STARG_OK;
    for (int i = 0; i < 2; i++)
        out->meshes[i] = out->own[i];
    TRY(number_parts(w, dropped, guards, out));
    TRY(twin_pieces_list(out));
    TRY(twin_pieces_prove(out, &found));
    if (!found)
        out->pieces.count = 0;
    return STARG_OK;
}

/* A group: *next has no pieces if it has not become two. */
static starg_status cut_group(const twin_pieces *w, uint64_t round, size_t *work,
                              twin_pieces *next) {
    starg_context *context = w->context;
    starg_rng rng = starg_rng_make(context->seed, STREAM_TWIN_CUTS, round);
    SCOPED_BY(through_free)
    through_cut cut = {.context = context, .meshes = {w->meshes[0], w->meshes[1]}};
    SCOPED uint8_t *dropped = NULL, *inside = NULL;
    SCOPED double *levels = NULL;
    size_t tetrahedra = 0, group = 0;
    NEW(context, STAGE, dropped, w->pieces.count);
    NEW(context, STAGE, inside, w->meshes[0]->count);
    NEW(context, STAGE, levels, w->meshes[0]->vertex_count);
    TRY(twin_pieces_drop(w, 3 + starg_rng_below(&rng, CUT_MOST - 2), &rng, dropped, &tetrahedra));
    for (size_t p = 0; p < w->pieces.count; p++)
        group += dropped[p];
    for (size_t t = 0; t < w->meshes[0]->count; t++)
        inside[t] = dropped[w->pieces.labels[t]];
    cut.inside = inside;
    cut.levels = levels;
    *work = CUT_TRIES * tetrahedra + w->meshes[0]->count / 10;
    return group > 2 ? divide_group(w, dropped, &rng, &cut, next) : STARG_OK;
}

/* Groups that threads try at once, each for the pieces as they are: few become two, so that most
 * are what they would be one after the other. */
typedef struct cut_trials {
    const twin_pieces *w;
    uint64_t first;
    size_t work[AT_ONCE_MOST];
    twin_pieces next[AT_ONCE_MOST];
} cut_trials;

static starg_status try_group(starg_context *context, void *shared, void *scratch, size_t item) {
    cut_trials *all = shared;
    (void)scratch;
    all->next[item] = (twin_pieces){.context = context};
    return cut_group(all->w, all->first + item, &all->work[item], &all->next[item]);
}

static void free_trials(cut_trials *all) {
    for (size_t i = 0; i < AT_ONCE_MOST; i++) {
        twin_pieces_free(&all->next[i]);
        all->next[i] = (twin_pieces){.context = all->w->context};
    }
}

starg_status compatible_cut(twin_pieces *w) {
    const size_t threads = (size_t)w->context->threads, most = CUT_WORK * w->meshes[0]->count;
    SCOPED_BY(free_trials) cut_trials all = {.w = w, .first = 1};
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = threads < AT_ONCE_MOST ? threads : AT_ONCE_MOST,
                                      .shared = &all,
                                      .item = try_group,
                                      .silent = true};
    size_t idle = 0, work = 0;
    IN_STAGE(w->context, STAGE);
    free_trials(&all);
    while (idle < CUT_IDLE && work < most && w->pieces.count > 2) {
        bool saved = false;
        TRY(starg_parallel_for(w->context, &loop));
        for (size_t i = 0; i < loop.count && !saved && idle < CUT_IDLE && work < most; i++) {
            all.first++;
            work += all.work[i];
            saved = all.next[i].pieces.count > 0;
            idle = saved ? 0 : idle + 1;
            if (saved)
                twin_pieces_swap(w, &all.next[i]);
        }
        free_trials(&all);
        starg_progress_step(w->context, work, most);
    }
    return STARG_OK;
}
