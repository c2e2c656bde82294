/* SPDX-License-Identifier: Apache-2.0 */
/* The claim that so many guards are needed, wherever they stand, against its certificate: it is of
 * this model and question; the result's guards see its witnesses; its cells hold the solid; each of
 * its reasons holds (verify/everywhere.h); the bound follows (verify/everywhere_bound.c).
 *
 * Cells are checked in parallel, each on its own. Cost: see verify/hidden.c for each reason. */
#include "verify/everywhere.h"

#include <math.h>
#include <stdio.h>

#include "core/checksum.h"
#include "core/parallel.h"

static const char STAGE[] = "verify";

/* ---- witnesses that are points ---- */

/* The vertex that a point is, or UINT32_MAX: it is between vertices. */
static uint32_t vertex_of(const starg_certificate *c, const verify_surface *surface,
                          size_t witness) {
    for (size_t k = 0; k < 3; k++)
        if (c->weights[witness][k] == (uint32_t)VERIFY_UNIT)
            return surface->faces[3 * (size_t)c->witnesses[witness] + k];
    return UINT32_MAX;
}

/* A guard and a point that it looks at. */
typedef struct sight_line {
    const verify_surface *surface;
    const double *p;
    const verify_spot *q;
} sight_line;

static bool leaves_free(void *data, uint32_t face) {
    const sight_line *own = data;
    const double *t[3];
    verify_corners(own->surface, face, t);
    return !verify_blocks_from(verify_side(t[0], t[1], t[2], own->p), own->p, own->q, t);
}

/* Does guard g see the point, strictly on the inner side of its face? The segment to its doubles
 * soon meets what hides it; what leaves it free is asked about all faces near the true one. */
static bool sees_point(const verify_facts *known, size_t g, uint32_t face, const verify_spot *q) {
    const double *p = known->guards->positions + 3 * g, *t[3];
    const verify_view view = verify_view_of(known->guards, g);
    sight_line line = {known->surface, p, q};
    double lower[3], upper[3];
    verify_corners(known->surface, face, t);
    if (!known->inside[g] || verify_side(t[0], t[1], t[2], p) <= 0 ||
        !verify_in_view(&view, p, q->at) ||
        !verify_faces(&view, p, t, (const double *const[]){q->at, q->at, q->at}) ||
        !verify_tree_follow(known->tree, p, q->at, leaves_free, &line))
        return false;
    for (int k = 0; k < 3; k++) {
        lower[k] = fmin(p[k], q->at[k] - 2 * q->blur);
        upper[k] = fmax(p[k], q->at[k] + 2 * q->blur);
    }
    return verify_tree_visit(known->tree, lower, upper, leaves_free, &line);
}

/* How many guards see a point, if they are no more than `enough`? */
static size_t count_at_point(const verify_facts *known, const starg_certificate *c, size_t witness,
                             double blur, size_t enough) {
    uint32_t face = c->witnesses[witness];
    const verify_mix mix = verify_mix_of(known->surface, face, c->weights[witness]);
    const verify_spot point = verify_mix_spot(known->surface, &mix, blur);
    size_t seen = 0;
    for (size_t g = 0; g < known->guards->count && seen < enough; g++)
        seen += sees_point(known, g, face, &point);
    return seen;
}

/* ---- cells ---- */

typedef struct checking {
    verify_scene scene; /* the first member, for verify_watch_make */
    const starg_certificate *certificate;
    const verify_facts *known;
    double blur;     /* of points between vertices */
    uint32_t *parts; /* by face: the part of the model that it bounds; NULL: no reason asks */
    size_t *wrong;   /* by cell: the first reason that does not hold, SIZE_MAX: the cell itself; or
                        the number of all reasons */
} checking;

/* Is all of the box closer to the surface than guards may stand? The distance of its middle and
 * half of its diagonal are rounded, by much less than the share of the clearance that is left out.
 */
static bool is_barred(const checking *own, const verify_box *box) {
    double middle[3], squared = 0, largest = 0, clearance = own->certificate->clearance;
    for (int k = 0; k < 3; k++) {
        double half = (0.5 * box->upper[k] - 0.5 * box->lower[k]) / clearance;
        middle[k] = 0.5 * box->lower[k] + 0.5 * box->upper[k];
        squared += half * half;
        largest = fmax(largest, fmax(fabs(box->lower[k]), fabs(box->upper[k])));
    }
    return clearance > 0 && largest < 1e10 * clearance && squared < 1 &&
           verify_tree_distance(own->known->tree, middle, own->known->scale) <
               clearance * (0.9995 - sqrt(squared));
}

/* Is the witness of a part that the cell is not for? */
static bool is_apart(const checking *own, const everywhere_cell *cell, uint32_t witness) {
    const starg_certificate *c = own->certificate;
    const verify_surface *surface = own->known->surface;
    uint32_t face = c->witnesses[witness];
    if (c->target == STARG_TARGET_VERTICES) {
        size_t corner = 0;
        while (corner < 3 * surface->face_count && surface->faces[corner] != c->witnesses[witness])
            corner++;
        if (corner == 3 * surface->face_count)
            return true; /* a vertex of no face */
        face = (uint32_t)(corner / 3);
    }
    return own->parts[face] < cell->parts[0] || own->parts[face] >= cell->parts[1];
}

static bool is_point_hidden(const checking *own, verify_watch *watch, const verify_reason *reason) {
    const starg_certificate *c = own->certificate;
    const verify_surface *surface = own->known->surface;
    uint32_t face = c->witnesses[reason->witness];
    const verify_mix mix = verify_mix_of(surface, face, c->weights[reason->witness]);
    const verify_spot point = verify_mix_spot(surface, &mix, own->blur);
    return verify_box_hides_point(watch, face, &point, c->range, reason);
}

/* A corner is seen from the inner side of its face, past what hides its vertex: as a face is, but
 * for the other two vertices. A point that is a vertex is such a corner. */
static bool is_hidden(const checking *own, const everywhere_cell *cell, verify_watch *watch,
                      const verify_reason *reason) {
    const starg_certificate *c = own->certificate;
    starg_target target = c->target;
    if (reason->kind == 'd')
        return is_apart(own, cell, reason->witness);
    if (verify_is_between(c, reason->witness))
        return is_point_hidden(own, watch, reason);
    if (target == STARG_TARGET_CORNERS || target == STARG_TARGET_POINTS) {
        uint32_t vertex = target == STARG_TARGET_CORNERS
                              ? c->corners[reason->witness]
                              : vertex_of(c, own->known->surface, reason->witness);
        target = STARG_TARGET_FACES;
        if (reason->kind != 'n' && reason->vertex != vertex)
            return false;
    }
    return verify_box_hides(watch, target, c->witnesses[reason->witness], c->range, reason);
}

static starg_status check_cell(starg_context *context, void *shared, void *scratch, size_t item) {
    const checking *own = shared;
    const starg_certificate *c = own->certificate;
    const everywhere_cell *cell = &c->cells[item];
    (void)context;
    own->wrong[item] = c->reasons.count;
    verify_watch_box(scratch, &cell->box);
    if ((cell->kind == EVERYWHERE_OUTSIDE && !verify_box_outside(scratch)) ||
        (cell->kind == EVERYWHERE_BARRED && !is_barred(own, &cell->box)))
        own->wrong[item] = SIZE_MAX;
    for (size_t k = cell->first; k < cell->first + cell->count; k++)
        if (!is_hidden(own, cell, scratch, &c->reasons.data[k])) {
            own->wrong[item] = k;
            break;
        }
    return verify_watch_failed(scratch) ? STARG_ERROR_MEMORY : STARG_OK;
}

static bool has_reason(const starg_certificate *c, const char *kinds) {
    for (size_t i = 0; i < c->reasons.count; i++)
        if (strchr(kinds, c->reasons.data[i].kind) != NULL)
            return true;
    return false;
}

starg_status verify_check_cells(const starg_certificate *certificate, const verify_facts *known,
                                size_t *cell, size_t *reason) {
    starg_status status = STARG_OK;
    starg_context *context = known->surface->context;
    checking own = {
        .certificate = certificate, .known = known, .blur = verify_blur(known->surface)};
    *cell = certificate->cell_count;
    /* some reasons hold only where the surface is embedded */
    STARG_TRY(verify_scene_create(known->surface, known->tree, has_reason(certificate, "sfe"),
                                  &own.scene));
    if (has_reason(certificate, "d"))
        STARG_TRY(verify_find_parts(known->surface, known->tree, &own.parts));
    STARG_NEW(context, STAGE, own.wrong, certificate->cell_count);
    const starg_parallel_loop loop = {.stage = STAGE,
                                      .count = certificate->cell_count,
                                      .shared = &own,
                                      .item = check_cell,
                                      .make_scratch = verify_watch_make,
                                      .free_scratch = verify_watch_drop};
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t i = certificate->cell_count; i-- > 0;)
        if (own.wrong[i] != certificate->reasons.count) {
            *cell = i;
            *reason = own.wrong[i];
        }
done:
    verify_scene_free(&own.scene);
    RELEASE(own.parts, own.wrong);
    return status;
}

/* ---- claims ---- */

bool verify_certificate_is_of(const starg_certificate *c, const verify_surface *surface) {
    uint64_t sum = STARG_CHECKSUM_BEGIN;
    for (size_t f = 0; f < surface->face_count; f++)
        sum = starg_checksum_face(sum, surface->vertices, surface->faces + 3 * f);
    return c->vertex_count == surface->vertex_count && c->face_count == surface->face_count &&
           c->checksum == sum;
}

static bool is_of_this(const starg_certificate *c, const verify_facts *known,
                       const char **difference) {
    const verify_surface *surface = known->surface;
    const starg_visibility_options *view = &known->guards->options.visibility;
    *difference = NULL;
    if (surface->ambient != 0 || surface->importance != NULL ||
        surface->model_faces != surface->face_count ||
        known->guards->space.orientation != STARG_ORIENTATION_NESTED)
        *difference = ": such are of plain solids alone";
    else if (known->guards->options.coverage < 1 || known->guards->options.max_guards > 0)
        *difference = ": guards that see a part need not see what it speaks of";
    else if (!verify_certificate_is_of(c, surface))
        *difference = ": it is of another model";
    else if (c->target != view->target)
        *difference = ": its targets are others";
    else if (c->range != view->range)
        *difference = ": its range is another one";
    else if (c->clearance != known->guards->options.clearance)
        *difference = ": its clearance is another one";
    else if (c->redundancy != known->guards->options.redundancy)
        *difference = ": its redundancy is another one";
    return *difference == NULL;
}

/* By as many guards as each face is to be seen by; one is needed as soon as there is anything to
 * see. */
static bool is_seen(const verify_facts *known, const starg_certificate *c, size_t witness,
                    double blur) {
    const starg_bits *rows = verify_rows(known);
    size_t seen = 0, enough = c->bound > 1 ? c->redundancy : 1;
    if (c->weights != NULL)
        return count_at_point(known, c, witness, blur, enough) >= enough;
    for (size_t g = 0; g < rows->rows; g++)
        seen += starg_bits_test(rows, g, c->witnesses[witness]);
    return seen >= enough;
}

static void claim_witnesses(starg_verdict *verdict, const verify_facts *known,
                            const starg_certificate *c) {
    const char *name = c->target == STARG_TARGET_VERTICES ? "vertices"
                       : c->weights != NULL               ? "points"
                                                          : "faces";
    const double blur = verify_blur(known->surface);
    size_t unseen = 0, first = 0;
    for (size_t i = c->witness_count; i-- > 0;)
        if (!is_seen(known, c, i, blur)) {
            unseen++;
            first = c->witnesses[i];
        }
    if (unseen == 0)
        verify_claim(verdict, true, "the guards see all %zu %s that the certificate speaks of",
                     c->witness_count, name);
    else
        verify_claim(verdict, false,
                     "the guards see all %zu %s that the certificate speaks of: not %zu of them, "
                     "one is %zu",
                     c->witness_count, name, unseen, first);
}

/* Is all of the surface in the box? */
static bool box_holds(const verify_box *box, const verify_surface *surface) {
    for (int k = 0; k < 3; k++)
        if (!(box->lower[k] <= surface->lower[k] && surface->upper[k] <= box->upper[k]))
            return false;
    return true;
}

static const char *word_of(char kind) {
    switch (kind) {
    case 'n':
        return "plane";
    case 'r':
        return "range";
    case 's':
        return "start";
    case 'p':
        return "patch";
    case 'f':
        return "fold";
    case 'd':
        return "part";
    default:
        return "entry";
    }
}

starg_status verify_claim_cells(starg_verdict *verdict, const verify_facts *known,
                                const starg_certificate *c) {
    size_t cell, reason;
    if (!box_holds(&c->cells[0].box, known->surface)) {
        verify_claim(verdict, false, "the cells of the certificate hold all of the model");
        return STARG_OK;
    }
    TRY(verify_check_cells(c, known, &cell, &reason));
    if (cell == c->cell_count) {
        verify_claim(verdict, true,
                     "%zu cells hold all of the model, and %zu reasons why they do not see "
                     "something are right",
                     c->cell_count, c->reasons.count);
        return STARG_OK;
    }
    if (reason == SIZE_MAX)
        verify_claim(verdict, false,
                     "no guard may stand in the cell on line %zu of the certificate: one may, or "
                     "that is not certain",
                     c->cell_line + cell);
    else {
        const verify_reason *r = &c->reasons.data[reason];
        verify_claim(verdict, false,
                     "reasons of the certificate are right: the cell on line %zu may see %s %u in "
                     "spite of reason %zu there (%s)",
                     c->cell_line + cell,
                     c->target == STARG_TARGET_VERTICES  ? "vertex"
                     : c->target == STARG_TARGET_CORNERS ? "a corner of face"
                     : c->target == STARG_TARGET_POINTS  ? "a point of face"
                                                         : "face",
                     c->witnesses[r->witness], reason - c->cells[cell].first + 1, word_of(r->kind));
    }
    return STARG_OK;
}

starg_status verify_claim_follows(starg_verdict *verdict, const starg_certificate *c,
                                  const char *claim, size_t claimed) {
    bool follows;
    everywhere_words why = {""};
    TRY(verify_check_bound(c, &follows, &why));
    if (follows && claimed <= c->bound)
        verify_claim(verdict, true, "%s: the certificate's bound of %zu follows", claim, c->bound);
    else if (follows)
        verify_claim(verdict, false, "%s: the certificate says no more than %zu", claim, c->bound);
    else
        verify_claim(verdict, false, "%s: the certificate's bound of %zu does not follow (%s)",
                     claim, c->bound, why.text);
    return STARG_OK;
}

starg_status verify_claim_everywhere(starg_verdict *verdict, const verify_facts *known,
                                     const starg_certificate *c) {
    size_t claimed = known->guards->lower_bound_everywhere;
    const char *difference;
    char claim[128];
    bool same = is_of_this(c, known, &difference);
    verify_claim(verdict, same, "the certificate is of this model and question%s",
                 same ? "" : difference);
    if (!same)
        return STARG_OK;
    claim_witnesses(verdict, known, c);
    TRY(verify_claim_cells(verdict, known, c));
    snprintf(claim, sizeof claim, "at least %zu guards are needed%s, wherever they stand", claimed,
             verify_targets_points(known) ? " to see every point of the boundary" : "");
    return verify_claim_follows(verdict, c, claim, claimed);
}
