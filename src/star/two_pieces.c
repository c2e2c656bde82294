/* SPDX-License-Identifier: Apache-2.0 */
/* Can a solid be cut into two star-shaped pieces?
 *
 * Problem: two points may see all corners (star/lower_bound.h), and yet no two star-shaped pieces
 * fill the solid, wherever their guards stand and however their border runs. Prove it.
 *
 * Theorem. Let g and h be guards of two star-shaped pieces, or one, that fill a solid with an
 * embedded surface. A face *belongs* to g if h is not strictly on its inner side. Then
 * 1. no face belongs to both;
 * 2. no point x lies strictly between g and a point of a face that belongs to g, and strictly
 *    between h and a point of one that belongs to h.
 * Proof. Some guard of a piece that holds a point y inside face f is strictly on the inner side of
 * f, and all points between the guard and y are inner points of this piece (star/lower_bound.c,
 * steps 1 and 3). So all of a face that belongs to g is in the piece P of g, as P is closed. With
 * y on such a face, x is an inner point of P, and likewise of the other piece; but these have no
 * inner point in common. With one piece only, g = h: every face has its guard on the inner side,
 * and belongs to nobody.
 *
 * Method: branch and bound over pairs of boxes, from one that holds the solid, twice. A pair is
 * closed if no point of one box is in the solid; if a face has no point of either box strictly on
 * its inner side (1); or if for some point x all rays from x away from either box end on patches of
 * faces that belong to its guard (2, star/shadow.c). Else the longer box is halved. Points that
 * have closed a pair are tried first, the latest successes ahead; where boxes are small, random
 * points are tried, on segments from the middle of a box to faces that belong to it.
 *
 * The certificate is the tree of pairs with the reasons at its leaves. The result does not depend
 * on the number of threads: there is one. Cost: 46,000 pairs and 9 seconds for a solid of 7,300
 * faces (retinal); pairs close slowly where two pieces nearly fill the solid. */
#include "star/two_pieces.h"

#include <math.h>
#include <string.h>

#include "core/bits.h"
#include "core/rng.h"
#include "guard/certificate_text.h"
#include "star/shadow.h"

static const char STAGE[] = "pieces";

enum { TRIES = 200 /* random points of a pair */, RNG_STREAM = 92, DIGITS = 22, VERSION = 3 };

/* Boxes are small below this share of the solid's size. */
static const double SMALL = 0.12;

typedef enum step_kind {
    STEP_HALVE_FIRST,
    STEP_HALVE_SECOND,
    STEP_HALVE_BOTH, /* the same box twice */
    STEP_OUTSIDE,
    STEP_FACE,
    STEP_POINT
} step_kind;

typedef struct step {
    step_kind kind;
    uint32_t number;   /* of the axis; of the box outside (0 or 1); of the face; of the point */
    uint32_t seeds[2]; /* STEP_POINT: a face of each patch */
} step;

typedef struct pair {
    uint32_t places[2];
    double share; /* of all pairs of points */
} pair;

typedef struct search {
    starg_context *context;
    const starg_solid *solid;
    shadow_tables tables;
    STARG_ARRAY(uint32_t) points; /* that closed a pair: those to be tried first come first */
    STARG_ARRAY(pair) open;       /* the next one comes last */
    STARG_ARRAY(step) steps;      /* of the certificate */
    bool certified;
    double closed; /* share */
} search;

/* ---- reasons ---- */

static const shadow_place *place_of(const search *s, const pair *of, int i) {
    return &s->tables.places.data[of->places[i]];
}

static bool is_outside(const search *s, const pair *of, step *how) {
    for (uint32_t i = 0; i < 2; i++)
        if (place_of(s, of, (int)i)->outside) {
            *how = (step){.kind = STEP_OUTSIDE, .number = i};
            return true;
        }
    return false;
}

static uint32_t face_of(const search *s, uint32_t rank) {
    return s->tables.scene->tree->order[rank];
}

static bool some_face_is_lost(const search *s, const pair *of, step *how) {
    const uint64_t *a = place_of(s, of, 0)->blind, *b = place_of(s, of, 1)->blind;
    for (size_t w = 0; w < s->tables.words; w++) {
        const uint64_t lost = a[w] & b[w];
        if (lost == 0)
            continue;
        uint32_t rank = (uint32_t)(64 * w) + (uint32_t)starg_bit_lowest(lost);
        *how = (step){.kind = STEP_FACE, .number = face_of(s, rank)};
        return true;
    }
    return false;
}

static starg_status is_crossing(search *s, const pair *of, uint32_t point, bool *done, step *how) {
    starg_status status = STARG_OK;
    *how = (step){.kind = STEP_POINT, .number = point};
    *done = true;
    for (int i = 0; i < 2 && *done; i++) {
        uint32_t patch;
        STARG_TRY(shadow_of(&s->tables, of->places[i], point, &patch));
        *done = patch != SHADOW_NONE && shadow_is_blind(&s->tables, of->places[1 - i], patch);
        if (*done)
            how->seeds[i] = face_of(s, s->tables.patches.data[patch + 1]);
    }
done:
    return status;
}

/* By a point that is known; it moves half of the way to the front. */
static starg_status find_known(search *s, const pair *of, bool *done, step *how) {
    starg_status status = STARG_OK;
    uint32_t *points = s->points.data;
    for (size_t i = 0; i < s->points.count && !*done; i++) {
        const uint32_t point = points[i];
        STARG_TRY(is_crossing(s, of, point, done, how));
        if (*done) {
            memmove(points + i / 2 + 1, points + i / 2, (i - i / 2) * sizeof point);
            points[i / 2] = point;
        }
    }
done:
    return status;
}

/* ---- new points ---- */

/* A face that belongs to the guard in one place, that in the other one being in `other`; or NONE.
 */
static uint32_t random_face(const search *s, const shadow_place *own, const shadow_place *other,
                            starg_rng *rng) {
    const size_t words = s->tables.words, first = starg_rng_below(rng, words);
    for (size_t i = 0; i < words; i++) {
        const size_t w = (first + i) % words;
        uint64_t bits = other->blind[w] & ~own->blind[w];
        if (bits == 0)
            continue;
        for (uint64_t n = starg_rng_below(rng, starg_bit_count(&bits, 1)); n > 0; n--)
            bits &= bits - 1;
        return (uint32_t)(64 * w) + (uint32_t)starg_bit_lowest(bits);
    }
    return SHADOW_NONE;
}

/* A point with few digits between the middle of one place and a face that belongs to it, more often
 * near the face; rays from it, away from the middles, end where they should. */
static bool propose(const search *s, const pair *of, starg_rng *rng, double x[3]) {
    const int side = (int)starg_rng_below(rng, 2);
    const shadow_place *own = place_of(s, of, side), *other = place_of(s, of, 1 - side);
    const uint32_t rank = random_face(s, own, other, rng);
    const double share = 1 - 0.9 * pow(starg_rng_unit(rng), 1.5);
    const double grid = ldexp(1, ilogb(s->tables.size) - DIGITS);
    if (rank == SHADOW_NONE)
        return false;
    const box_triangle *f = &s->tables.scene->triangles[rank];
    for (int k = 0; k < 3; k++) {
        double centre = 0;
        for (int i = 0; i < 3; i++)
            centre += box_corner(s->tables.scene, f, i)[k] / 3;
        x[k] = rint((own->middle[k] + share * (centre - own->middle[k])) / grid) * grid;
    }
    return shadow_may_be_blind(&s->tables, of->places[1 - side], x, of->places[side]) &&
           shadow_may_be_blind(&s->tables, of->places[side], x, of->places[1 - side]);
}

static void forget_last_point(search *s, const pair *of, size_t patches) {
    shadow_tables *t = &s->tables;
    t->points.count -= 3;
    t->patches.count = patches;
    for (int i = 0; i < 2; i++) {
        shadow_place *place = &t->places.data[of->places[i]];
        if (place->shadows.count > t->points.count / 3)
            place->shadows.count = t->points.count / 3;
    }
}

static starg_status try_point(search *s, const pair *of, const double x[3], bool *done, step *how) {
    starg_status status = STARG_OK;
    const size_t patches = s->tables.patches.count;
    const uint32_t point = (uint32_t)(s->tables.points.count / 3);
    for (int k = 0; k < 3; k++)
        STARG_PUSH(s->context, STAGE, &s->tables.points, x[k]);
    STARG_TRY(is_crossing(s, of, point, done, how));
    if (!*done) {
        forget_last_point(s, of, patches);
        return STARG_OK;
    }
    STARG_PUSH(s->context, STAGE, &s->points, point);
    memmove(s->points.data + 1, s->points.data, (s->points.count - 1) * sizeof point);
    s->points.data[0] = point;
done:
    return status;
}

static starg_status find_new(search *s, const pair *of, bool *done, step *how) {
    starg_status status = STARG_OK;
    starg_rng rng = starg_rng_make(s->context->seed, RNG_STREAM, s->tables.looks);
    for (int i = 0; i < TRIES && !*done; i++) {
        double x[3];
        s->tables.looks += 2;
        if (propose(s, of, &rng, x))
            STARG_TRY(try_point(s, of, x, done, how));
    }
done:
    return status;
}

/* ---- pairs ---- */

static double length_of(const shadow_place *place) {
    const int k = shadow_axis(&place->box);
    return place->box.upper[k] - place->box.lower[k];
}

static starg_status close_pair(search *s, const pair *of, bool *done, step *how) {
    starg_status status = STARG_OK;
    *done = is_outside(s, of, how) || some_face_is_lost(s, of, how);
    if (!*done)
        STARG_TRY(find_known(s, of, done, how));
    if (!*done &&
        fmax(length_of(place_of(s, of, 0)), length_of(place_of(s, of, 1))) < SMALL * s->tables.size)
        STARG_TRY(find_new(s, of, done, how));
done:
    return status;
}

static starg_status open_pair(search *s, uint32_t a, uint32_t b, double share) {
    starg_status status = STARG_OK;
    const pair fresh = {{a, b}, share};
    STARG_PUSH(s->context, STAGE, &s->open, fresh);
done:
    return status;
}

/* The last of the new pairs is the first of the certificate. */
static starg_status halve(search *s, const pair *of, step *how) {
    starg_status status = STARG_OK;
    uint32_t h[2];
    const int k = length_of(place_of(s, of, 1)) > length_of(place_of(s, of, 0));
    const uint32_t axis = (uint32_t)shadow_axis(&place_of(s, of, k)->box);
    STARG_TRY(shadow_halve(&s->tables, of->places[k], h));
    if (of->places[0] == of->places[1]) {
        *how = (step){.kind = STEP_HALVE_BOTH, .number = axis};
        STARG_TRY(open_pair(s, h[1], h[1], of->share / 4));
        STARG_TRY(open_pair(s, h[0], h[1], of->share / 2));
        STARG_TRY(open_pair(s, h[0], h[0], of->share / 4));
        return STARG_OK;
    }
    *how = (step){.kind = k ? STEP_HALVE_SECOND : STEP_HALVE_FIRST, .number = axis};
    for (int i = 1; i >= 0; i--)
        STARG_TRY(open_pair(s, k ? of->places[0] : h[i], k ? h[i] : of->places[1], of->share / 2));
done:
    return status;
}

static starg_status visit_next(search *s) {
    starg_status status = STARG_OK;
    const pair next = s->open.data[--s->open.count];
    bool done;
    step how;
    STARG_TRY(starg_check_cancel(s->context, STAGE));
    STARG_TRY(close_pair(s, &next, &done, &how));
    if (done)
        s->closed += next.share;
    else
        STARG_TRY(halve(s, &next, &how));
    if (s->certified)
        STARG_PUSH(s->context, STAGE, &s->steps, how);
    starg_progress_step(s->context, (size_t)(1e6 * s->closed), 1000000);
done:
    return status;
}

/* ---- the certificate ---- */

static void put_step(FILE *stream, const step *how) {
    switch (how->kind) {
    case STEP_HALVE_FIRST:
    case STEP_HALVE_SECOND:
    case STEP_HALVE_BOTH:
        fprintf(stream, "%c%c\n", "01="[how->kind], "xyz"[how->number]);
        return;
    case STEP_OUTSIDE:
        fprintf(stream, "o%u\n", how->number);
        return;
    case STEP_FACE:
        fprintf(stream, "f%u\n", how->number);
        return;
    case STEP_POINT:
        fprintf(stream, "p%u:%u:%u\n", how->number, how->seeds[0], how->seeds[1]);
    }
}

static void put_proof(FILE *stream, const void *what) {
    const search *s = what;
    certificate_put_model(stream, VERSION, s->solid);
    fprintf(stream, "target pairs\n");
    certificate_put_root(stream, &s->tables.places.data[0].box);
    fprintf(stream, "points %zu\n", s->tables.points.count / 3);
    for (size_t i = 0; i < s->tables.points.count; i += 3) {
        fprintf(stream, "point");
        for (size_t k = 0; k < 3; k++)
            certificate_put_double(stream, ' ', s->tables.points.data[i + k]);
        fprintf(stream, "\n");
    }
    fprintf(stream, "pairs %zu\n", s->steps.count);
    for (size_t i = 0; i < s->steps.count; i++)
        put_step(stream, &s->steps.data[i]);
}

starg_status two_pieces_exclude(starg_context *context, const starg_solid *solid, uint64_t work,
                                bool certified, two_pieces *out) {
    starg_status status = STARG_OK;
    search s = {.context = context, .solid = solid, .certified = certified};
    *out = (two_pieces){.excluded = false};
    starg_progress_begin(context, "pairs");
    STARG_TRY(shadow_tables_make(context, solid, &s.tables));
    STARG_TRY(open_pair(&s, 0, 0, 1));
    while (s.open.count > 0 && s.tables.looks < work && !starg_time_is_over(context))
        STARG_TRY(visit_next(&s));
    context->work += s.tables.looks;
    out->excluded = s.open.count == 0;
    if (out->excluded && certified)
        STARG_TRY(certificate_write(context, put_proof, &s, &out->certificate, &out->size));
done:
    starg_progress_end(context);
    STARG_ARRAY_FREE(context, &s.points);
    STARG_ARRAY_FREE(context, &s.open);
    STARG_ARRAY_FREE(context, &s.steps);
    shadow_tables_free(&s.tables);
    return status;
}
