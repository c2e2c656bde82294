/* SPDX-License-Identifier: Apache-2.0 */
/* Planes that cut a piece of a solid, and what they are worth.
 *
 * Problem: a piece is bounded by a part of the surface and walls. For sets of its walls find planes
 * that part them from the other ones, and after which as few further cuts as possible are needed
 * until all is star-shaped.
 *
 * Method: planes are drawn at notches, at random, and between the walls of a set and the others. Of
 * what hangs together above a plane the rest of the surface is below. A cut is worth the share of
 * the piece that faces towards a point on its side: points inside are drawn once for a piece, so
 * that a cut costs a sum over faces. Sharp notches along which the cut runs count, too, less those
 * that it crosses: they would remain, and walls may not meet.
 *
 * Cost: O(LIMB_VIEWS f) for a piece of f faces, and for each plane; a linear program in the faces
 * where all seems to be seen. */
#include "morph/limbs.h"

#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "visibility/kernel.h"

static const char STAGE[] = "limbs";
enum { DRAWN = 64, AIMED = 24, AIMED_MORE = 96, SEARCHED = 32 }; /* planes for a piece, for a set */
enum { TRIES = 8, PAIRED = 8, LEVELS = 8 };
static const double NOTCHES = 0.5; /* what those count that are removed, beside shares */
static const double SHARP = 0.5;   /* turns at notches that count, in radians */
static const double BESIDE = 0.1;  /* of points beside a hub, over the extent of the loop */
static const double DEEPEST = 6;   /* doublings of the depths of points inside */
static const double NEARLY = 0.9;  /* share from which stars are looked for */
static const double ROOMY = 0.02;  /* of hubs, over the extent of loops */
static const double STEEPEST = 10; /* doublings of the noise in directions of planes */
static const double MARGIN = 1e-3; /* of points that see a side, over its size */
static const double THIN = 1e-3;   /* radius of a kernel that rounding may end, over the size */

void limb_side_free(limb_side *s) {
    for (size_t i = 0; i < s->best.count; i++)
        starg_release(s->cuts->context, s->best.data[i].heights);
    cones_free_loops(&s->rim);
    RELEASE(s->walls.data, s->faces.data, s->vertices.data, s->beside.data, s->edges.data,
            s->wall.points.data, s->heights, s->own, s->part, s->flat, s->touched, s->normals,
            s->shares, s->fronts, s->notches.data, s->best.data);
}

starg_status limb_side_add_wall(limb_side *s, size_t i) {
    const limb_wall *wall = limb_side_wall(s, i);
    const number_list *loop = &wall->loops[s->end];
    const bool left = wall->pieces[0] == s->which;
    for (size_t j = 0; j < loop->count; j++) {
        uint32_t u = loop->data[j], v = loop->data[(j + 1) % loop->count];
        const uint32_t corners[3] = {left ? v : u, left ? u : v, wall->hubs[s->end]};
        for (int k = 0; k < 3; k++)
            PUSH(s->cuts->context, STAGE, &s->beside, corners[k]);
    }
    return STARG_OK;
}

const set_cut *limb_side_cut_of(const limb_side *s, uint64_t set) {
    for (size_t i = 0; i < s->best.count; i++)
        if (s->best.data[i].set == set)
            return &s->best.data[i];
    return NULL;
}

starg_status limb_side_keep(limb_side *s, uint64_t set, double score, const double *hub) {
    starg_context *context = s->cuts->context;
    const size_t size = limb_side_builder(s)->about.count;
    size_t i = 0;
    while (i < s->best.count && s->best.data[i].set != set)
        i++;
    if (i == s->best.count) {
        PUSH(context, STAGE, &s->best, ((set_cut){.set = set, .score = -1}));
        NEW(context, STAGE, s->best.data[i].heights, size);
    }
    if (score > s->best.data[i].score) {
        s->best.data[i].score = score;
        s->best.data[i].fan = hub != NULL;
        if (hub != NULL)
            vec3_copy(hub, s->best.data[i].hub);
        memcpy(s->best.data[i].heights, s->own, size * sizeof *s->own);
    }
    return STARG_OK;
}

uint64_t limb_side_set_above(const limb_side *s, bool *apart) {
    uint64_t set = 0;
    *apart = true;
    for (size_t i = 0; i < s->walls.count && *apart; i++) {
        const number_list *loop = &limb_side_wall(s, i)->loops[s->end];
        const bool above = s->own[loop->data[0]] > 0;
        for (size_t j = 0; j < loop->count && *apart; j++)
            *apart = above ? s->own[loop->data[j]] > 0 : s->own[loop->data[j]] < 0;
        set |= (uint64_t)above << i;
    }
    return set;
}

/* ---- what a cut is worth ---- */

static starg_status find_notches(limb_side *s) {
    cone_builder *b = limb_side_builder(s);
    for (size_t i = 0; i < s->faces.count; i++) {
        const uint32_t *corner = s->faces.data + i - i % 3, u = s->faces.data[i];
        const uint32_t v = corner[(i + 1) % 3], beyond = cones_across(&s->edges, u, v);
        uint32_t other[3];
        double normals[2][3], cross[3], way[3];
        if (beyond == NOWHERE || u > v)
            continue;
        cones_corners_of(b, beyond, s->which, other);
        cones_find_normal(b, 0, corner, normals[0]);
        cones_find_normal(b, 0, other, normals[1]);
        vec3_cross(normals[0], normals[1], cross);
        vec3_subtract(limb_side_at(s, v), limb_side_at(s, u), way);
        const double turn = atan2(vec3_length(cross), vec3_dot(normals[0], normals[1]));
        if (vec3_dot(cross, way) < 0 && turn > SHARP) {
            PUSH(b->context, STAGE, &s->notches,
                 ((notch){.ends = {u, v}, .weight = turn * vec3_length(way)}));
            s->notched += s->notches.data[s->notches.count - 1].weight;
        }
    }
    return STARG_OK;
}

/* The share of notches along which the cut runs, less that of those that it crosses or touches:
 * they stay, and later walls may not meet this one. */
static double share_removed(const limb_side *s) {
    double sum = 0;
    for (size_t i = 0; i < s->notches.count; i++) {
        const double p = s->own[s->notches.data[i].ends[0]];
        const double q = s->own[s->notches.data[i].ends[1]];
        if (p == 0 && q == 0)
            sum += s->notches.data[i].weight;
        else if (p == 0 || q == 0 || cones_are_opposite(p, q))
            sum -= s->notches.data[i].weight;
    }
    return s->notched > 0 ? sum / s->notched : 0;
}

/* Points inside, behind faces at random depths. */
static void draw_views(limb_side *s) {
    cone_builder *b = limb_side_builder(s);
    for (int n = 0; n < LIMB_VIEWS && s->faces.count > 0; n++)
        for (int i = 0; i < TRIES; i++) {
            const size_t f = starg_rng_below(&b->rng, s->faces.count / 3);
            const uint32_t *corner = s->faces.data + 3 * f;
            const double depth = s->size * exp2(-DEEPEST * starg_rng_unit(&b->rng));
            double normal[3];
            bool on;
            cones_find_normal(b, 0, corner, normal);
            vec3_normalize(normal);
            for (int k = 0; k < 3; k++)
                s->views[n][k] = (limb_side_at(s, corner[0])[k] + limb_side_at(s, corner[1])[k] +
                                  limb_side_at(s, corner[2])[k]) /
                                     3 -
                                 depth * normal[k];
            if (bvh_winding(s->surface, s->views[n], &on) == 1 && !on)
                break;
        }
}

/* What each face counts for each of the points. */
static starg_status find_fronts(limb_side *s) {
    const size_t faces = s->faces.count / 3;
    double sum = 0;
    NEW(s->cuts->context, STAGE, s->normals, 3 * faces);
    NEW(s->cuts->context, STAGE, s->shares, faces);
    NEW(s->cuts->context, STAGE, s->fronts, faces * LIMB_VIEWS);
    for (size_t f = 0; f < faces; f++) {
        cones_find_normal(limb_side_builder(s), 0, s->faces.data + 3 * f, s->normals + 3 * f);
        sum += vec3_length(s->normals + 3 * f);
    }
    s->size = sqrt(sum);
    draw_views(s);
    for (size_t f = 0; f < faces; f++) {
        const double *normal = s->normals + 3 * f;
        const uint32_t *corner = s->faces.data + 3 * f;
        s->shares[f] = (float)(vec3_length(normal) / sum);
        for (size_t n = 0; n < LIMB_VIEWS; n++) {
            double way[3];
            vec3_subtract(limb_side_at(s, corner[0]), s->views[n], way);
            s->fronts[f * LIMB_VIEWS + n] = vec3_dot(way, normal) > 0 ? s->shares[f] : 0;
            s->fronts_sum[n] += s->fronts[f * LIMB_VIEWS + n];
        }
    }
    return STARG_OK;
}

/* How much of a face is above the cut, or below: all, half or nothing. */
static float part_of_face(const limb_side *s, size_t f, bool below) {
    bool on[2] = {false, false};
    for (int k = 0; k < 3; k++) {
        const double height = s->own[s->faces.data[3 * f + (size_t)k]];
        on[0] = on[0] || height > 0;
        on[1] = on[1] || height < 0;
    }
    return !on[below] ? 0 : on[!below] ? 0.5F : 1;
}

/* What faces towards each of the views, on both sides of the cut. Only one side is added up, that
 * with fewer vertices: the other one is the rest. */
static void add_up_fronts(const limb_side *s, float out[2][LIMB_VIEWS]) {
    size_t above = 0;
    for (size_t i = 0; i < s->vertices.count; i++)
        above += s->own[s->vertices.data[i]] > 0;
    const bool fewer = 2 * above > s->vertices.count;
    for (int n = 0; n < LIMB_VIEWS; n++) {
        out[fewer][n] = 0;
        out[!fewer][n] = s->fronts_sum[n];
    }
    for (size_t f = 0; f < s->faces.count / 3; f++) {
        const float *front = s->fronts + f * LIMB_VIEWS;
        const float part = part_of_face(s, f, fewer), rest = part_of_face(s, f, !fewer);
        if (rest == 1)
            continue;
        for (int n = 0; n < LIMB_VIEWS; n++) {
            out[fewer][n] += part * front[n];
            out[!fewer][n] -= (1 - rest) * front[n];
        }
    }
}

/* What faces towards a point on each side of the cut, as a share of the piece: one of the views, or
 * one just beside the wall's hub. */
static double share_seen(const limb_side *s, const double hub[3]) {
    float seen[2][LIMB_VIEWS], most[2] = {0, 0};
    add_up_fronts(s, seen);
    for (int side = 0; side < 2; side++) {
        double beside[3];
        vec3_along(hub, (side == 0 ? BESIDE : -BESIDE) * s->wall.extent, s->wall.normal, beside);
        for (size_t f = 0; f < s->faces.count / 3; f++) {
            double way[3];
            vec3_subtract(limb_side_at(s, s->faces.data[3 * f]), beside, way);
            if (vec3_dot(way, s->normals + 3 * f) > 0)
                most[side] += part_of_face(s, f, side) * s->shares[f];
        }
    }
    for (int n = 0; n < LIMB_VIEWS; n++) {
        double way[3];
        vec3_subtract(s->views[n], hub, way);
        const int side = vec3_dot(way, s->wall.normal) < 0;
        most[side] = fmaxf(most[side], seen[side][n]);
    }
    return most[0] + most[1];
}

/* Of how many sides all is seen from a point. */
static starg_status count_stars(limb_side *s, uint64_t set, int *star) {
    *star = 0;
    for (int below = 0; below < 2; below++) {
        side_view view;
        double down[3], row[5];
        for (int k = 0; k < 3; k++)
            down[k] = below ? s->wall.normal[k] : -s->wall.normal[k];
        cones_put_row(down, s->wall.mean, row);
        TRY(cones_list_side(limb_side_builder(s), &s->faces, s->own, below, &s->beside));
        for (size_t i = 0; i < s->walls.count; i++)
            if ((set >> i & 1) == !below)
                TRY(limb_side_add_wall(s, i));
        TRY(cones_see(limb_side_builder(s), 0, &s->beside, row, 1, s->wall.mean, s->wall.extent,
                      &view));
        *star += view.room > MARGIN;
    }
    return STARG_OK;
}

/* Vertices in the plane that have no neighbour above it come to be below it. */
static void lower_others(limb_side *s) {
    bool any = false;
    for (size_t i = 0; i < s->vertices.count; i++) {
        s->touched[s->vertices.data[i]] = 0;
        any = any || s->own[s->vertices.data[i]] == 0;
    }
    if (!any)
        return;
    for (size_t i = 0; i < s->faces.count; i++) {
        const uint32_t u = s->faces.data[i], v = s->faces.data[i % 3 == 2 ? i - 2 : i + 1];
        s->touched[u] |= s->own[v] > 0;
        s->touched[v] |= s->own[u] > 0;
    }
    for (size_t i = 0; i < s->vertices.count; i++) {
        const uint32_t v = s->vertices.data[i];
        if (s->own[v] == 0 && !s->touched[v])
            s->own[v] = -1;
    }
}

/* Weighs one part above a plane; all else is below. */
static starg_status weigh_part(limb_side *s, uint32_t root, bool through) {
    cone_builder *b = limb_side_builder(s);
    double hub[3], room, share;
    int star = 0;
    bool good;
    cones_keep_part(&s->vertices, s->heights, s->part, root, s->own);
    if (!through)
        cones_drop_flat(&s->faces, s->flat, s->own);
    lower_others(s);
    uint64_t set = limb_side_set_above(s, &good);
    if (set & 1) { /* the other side is the one without the first wall */
        set = limb_side_all_walls(s) & ~set;
        limb_side_turn(s, s->own);
    }
    if (good)
        TRY(cones_find_loops(b, s->which, &s->edges, s->own, &s->rim, &good));
    if (!good || s->rim.lengths.count != 1)
        return STARG_OK;
    TRY(cones_place_loop(b, 0, s->rim.nodes.data, s->rim.nodes.count, &s->wall));
    TRY(cones_find_hub(b, &s->wall, hub, &room));
    if (!(room > ROOMY) || !cones_is_inside(s->surface, &s->wall, hub))
        return STARG_OK;
    share = share_seen(s, hub);
    const double removed = NOTCHES * share_removed(s);
    if (!s->loose || share > NEARLY)
        TRY(count_stars(s, set, &star));
    return s->loose || star == 2
               ? limb_side_keep(s, set, share + removed + (star == 2 ? s->bonus : 0), NULL)
               : STARG_OK;
}

/* Weighs all parts on both sides of a plane. */
static starg_status weigh_plane(limb_side *s) {
    cones_snap(&s->faces, s->heights);
    for (int side = 0; side < 2; side++) {
        cones_find_parts(&s->faces, s->heights, side == 0, s->part, s->flat);
        for (size_t i = 0; i < s->vertices.count; i++) {
            const uint32_t v = s->vertices.data[i];
            if (s->heights[v] > 0 && s->part[v] == v)
                TRY(weigh_part(s, v, side == 0));
        }
        limb_side_turn(s, s->heights);
    }
    return STARG_OK;
}

/* ---- planes ---- */

/* Planes at notches, by what two points see, and random ones. */
starg_status limb_side_draw_planes(limb_side *s) {
    cone_builder *b = limb_side_builder(s);
    for (int i = 0; i < DRAWN; i++) {
        bool drawn = true;
        if (i % 2 == 1)
            cones_draw_notch(b, s->which, 0, &s->faces, &s->edges, s->heights, &drawn);
        else if (i % SEARCHED == 0)
            TRY(cones_search_plane(b, s->which, 0, &s->faces, s->heights, &drawn));
        else
            cones_draw_plane(b, 0, &s->faces, s->heights);
        if (drawn)
            TRY(weigh_plane(s));
    }
    return STARG_OK;
}

/* From the middle of the other walls to that of a set's, or across one of the walls, upward; of
 * length 0 if there is none. */
static void draw_way(limb_side *s, uint64_t set, bool across, double out[3]) {
    double sums[2][3] = {{0}}, counts[2] = {0, 0};
    const size_t chosen =
        s->walls.count > 0 ? starg_rng_below(&limb_side_builder(s)->rng, s->walls.count) : 0;
    for (size_t i = 0; i < s->walls.count; i++) {
        const size_t above = set >> i & 1;
        vec3_along(sums[above], 1, limb_side_at(s, limb_side_wall(s, i)->hubs[s->end]),
                   sums[above]);
        counts[above]++;
    }
    for (int k = 0; k < 3; k++)
        out[k] =
            counts[0] > 0 && counts[1] > 0 ? sums[1][k] / counts[1] - sums[0][k] / counts[0] : 0;
    if (across && s->walls.count > 0) {
        const limb_wall *wall = limb_side_wall(s, chosen);
        double normal[3];
        limbs_find_normal(s->cuts, wall, s->end, normal);
        const bool left = wall->pieces[0] == s->which, above = set >> chosen & 1;
        for (int k = 0; k < 3; k++) /* outward if it is above */
            out[k] = left == above ? -normal[k] : normal[k];
    }
    vec3_normalize(out);
}

/* From the lowest to the highest height of vertices. */
static void find_span(const double *heights, const uint32_t *vertices, size_t count,
                      double out[2]) {
    out[0] = INFINITY;
    out[1] = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        out[0] = fmin(out[0], heights[vertices[i]]);
        out[1] = fmax(out[1], heights[vertices[i]]);
    }
}

/* A level that meets no wall: a random one below those of a set, or one above all others, too.
 * *found: it is one. */
double limb_side_draw_level(limb_side *s, uint64_t set, bool above, bool *found) {
    double level = 0, span[2], all[2];
    find_span(s->heights, s->vertices.data, s->vertices.count, all);
    for (size_t i = 0; i < s->walls.count; i++) {
        const number_list *loop = &limb_side_wall(s, i)->loops[s->end];
        find_span(s->heights, loop->data, loop->count, span);
        if (set >> i & 1)
            all[1] = fmin(all[1], span[0]);
        else if (above)
            all[0] = fmax(all[0], span[1]);
    }
    *found = false;
    for (int n = 0; n < LEVELS && !*found && all[0] < all[1]; n++) {
        level = all[0] + starg_rng_unit(&limb_side_builder(s)->rng) * (all[1] - all[0]);
        *found = true;
        for (size_t i = 0; i < s->walls.count && *found; i++) {
            const number_list *loop = &limb_side_wall(s, i)->loops[s->end];
            find_span(s->heights, loop->data, loop->count, span);
            *found = level < span[0] || level > span[1];
        }
    }
    return level;
}

/* Planes below the walls of a set, in directions about that from the other ones. */
starg_status limb_side_aim_planes(limb_side *s, uint64_t set) {
    cone_builder *b = limb_side_builder(s);
    const double origin[3] = {0, 0, 0};
    const int planes = s->loose ? AIMED : AIMED_MORE;
    for (int n = 0; n < planes && (s->loose || limb_side_cut_of(s, set) == NULL); n++) {
        double normal[3], noise[3];
        bool found;
        starg_rng_direction(&b->rng, noise);
        draw_way(s, set, n / 2 % 2 == 1, normal);
        double most = vec3_length(normal) > 0 ? exp2(-STEEPEST * starg_rng_unit(&b->rng)) : 1;
        vec3_along(normal, 2 * most, noise, normal);
        cones_find_heights(b, 0, &s->faces, normal, origin, s->heights);
        const double level = limb_side_draw_level(s, set, n % 2 == 0, &found);
        for (size_t i = 0; i < s->vertices.count; i++)
            s->heights[s->vertices.data[i]] -= level;
        if (found)
            TRY(weigh_plane(s));
    }
    return STARG_OK;
}

/* Planes that part one wall, or two, from the other ones. */
starg_status limb_side_aim_at_few(limb_side *s) {
    const size_t count = s->walls.count;
    const uint64_t all = limb_side_all_walls(s);
    for (size_t i = 0; i < count; i++)
        for (size_t j = i; j < count && (j == i || count <= PAIRED); j++) {
            uint64_t set = (uint64_t)1 << i | (uint64_t)1 << j;
            set = i == 0 ? all & ~set : set;
            if (set > 0)
                TRY(limb_side_aim_planes(s, set));
        }
    return STARG_OK;
}

/* ---- a side ---- */

starg_status limb_side_open(limb_cuts *cuts, const bvh *surface, int end, uint32_t which,
                            limb_side *s) {
    starg_kernel_result kernel;
    *s = (limb_side){.cuts = cuts, .surface = surface, .which = which, .end = end};
    cone_builder *b = limb_side_builder(s);
    for (uint32_t i = 0; i < cuts->walls.count; i++)
        if (cuts->walls.data[i].pieces[0] == which || cuts->walls.data[i].pieces[1] == which)
            PUSH(cuts->context, STAGE, &s->walls, i);
    TRY(cones_list_faces(b, which, &s->faces));
    TRY(cones_list_faces(b, which, &s->beside));
    for (size_t i = 0; i < s->walls.count; i++)
        TRY(limb_side_add_wall(s, i));
    TRY(find_fronts(s));
    const kernel_faces all = {b->places[0].data, s->beside.data, s->beside.count / 3};
    TRY(kernel_find(cuts->context, &all, &kernel));
    s->blind = kernel.verdict != STARG_KERNEL_INTERIOR || kernel.radius < THIN * s->size;
    vec3_copy(kernel.guard, s->guard);
    TRY(cones_list_edges(b, which, &s->edges));
    TRY(find_notches(s));
    NEW(cuts->context, STAGE, s->heights, b->about.count);
    NEW(cuts->context, STAGE, s->own, b->about.count);
    NEW(cuts->context, STAGE, s->part, b->about.count);
    NEW_ZERO(cuts->context, STAGE, s->flat, b->about.count);
    NEW(cuts->context, STAGE, s->touched, b->about.count);
    for (size_t i = 0; i < s->faces.count; i++)
        if (s->flat[s->faces.data[i]] == 0) {
            s->flat[s->faces.data[i]] = 1;
            PUSH(cuts->context, STAGE, &s->vertices, s->faces.data[i]);
        }
    return STARG_OK;
}
