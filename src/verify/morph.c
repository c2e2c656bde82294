/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of a morph: its frames have the same faces, the ends are the two models, and every
 * frame has the crossings, the volume and the area that are reported.
 *
 * The first frame is A if it is equal, face by face, or (with an overlay) lies on A, within a
 * billionth of the diagonal, and covers it once (verify/boundary.c). The last one is B in the same
 * way, or has its vertices on B. Crossings are counted exactly. Cost: O(n log n) for each frame. */
#include "verify/map.h"

#include <math.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";
static const double TOLERANCE = 1e-9;
enum { CANCEL_STEP = 256 };

typedef struct verify_morph {
    starg_context *context;
    const starg_mesh *const *frames;
    size_t frame_count;
    const starg_morph_report *report;
    starg_verdict *verdict;
} verify_morph;

static bool has_faces_of(const starg_mesh *a, const starg_mesh *b) {
    size_t count = starg_mesh_face_count(a);
    return starg_mesh_vertex_count(a) == starg_mesh_vertex_count(b) &&
           starg_mesh_face_count(b) == count &&
           memcmp(starg_mesh_faces(a), starg_mesh_faces(b), 3 * count * sizeof(uint32_t)) == 0;
}

static bool is_equal(const starg_mesh *a, const starg_mesh *b) {
    return has_faces_of(a, b) && memcmp(starg_mesh_vertices(a), starg_mesh_vertices(b),
                                        3 * starg_mesh_vertex_count(a) * sizeof(double)) == 0;
}

/* ---- frames ---- */

/* Returns whether all frames have the same faces. */
static bool claim_frames(const verify_morph *own) {
    size_t different = 0, first = 0;
    for (size_t i = own->frame_count; i-- > 1;)
        if (!has_faces_of(own->frames[0], own->frames[i])) {
            different++;
            first = i;
        }
    verify_claim_all(own->verdict, different, first, "%zu frames have the same faces",
                     own->frame_count);
    if (own->report == NULL)
        return different == 0;
    bool spaced = own->report->frame_count == own->frame_count;
    for (size_t i = 0; i < own->report->frame_count && spaced; i++)
        spaced = fabs(own->report->frames[i].t - (double)i / (double)(own->frame_count - 1)) <=
                 TOLERANCE;
    verify_claim(own->verdict, spaced, "the report is of %zu frames, evenly spaced in time",
                 own->frame_count);
    return different == 0 && own->report->frame_count == own->frame_count;
}

/* ---- ends ---- */

/* Does a frame lie on a model, and cover it once? */
static starg_status claim_refined(const verify_morph *own, const starg_mesh *frame,
                                  const starg_mesh *model, const char *words) {
    SCOPED_BY(verify_surface_drop) verify_surface *outer = NULL, *inner = NULL;
    verify_match match;
    TRY(verify_surface_create(own->context, frame, &outer));
    TRY(verify_surface_create(own->context, model, &inner));
    TRY(verify_match_surfaces(outer, inner, &match));
    verify_claim_all(own->verdict, match.off, match.first_off,
                     "%s, subdivided: all faces are on it", words);
    verify_claim_all(own->verdict, match.turned, match.first_turned, "and face the same way");
    verify_claim_all(own->verdict, match.uneven, match.shell, "and cover each shell once");
    return STARG_OK;
}

/* Are the vertices of the last frame on B? */
static starg_status claim_on(const verify_morph *own, const starg_mesh *frame,
                             const starg_mesh *model) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    SCOPED_BY(verify_tree_drop) verify_tree *tree = NULL;
    size_t off = 0, first = 0;
    TRY(verify_surface_welded(own->context, model, &surface));
    TRY(verify_tree_create(surface, &tree));
    double most = TOLERANCE * verify_diagonal(surface) + verify_rounding(surface);
    int scale = verify_scale(surface);
    for (size_t v = starg_mesh_vertex_count(frame); v-- > 0;) {
        if (v % CANCEL_STEP == 0)
            TRY(starg_check_cancel(own->context, STAGE));
        if (!(verify_tree_distance(tree, starg_mesh_vertices(frame) + 3 * v, scale) <= most)) {
            off++;
            first = v;
        }
    }
    verify_claim_all(own->verdict, off, first,
                     "the last frame is B with the faces of A: its vertices are on B");
    return STARG_OK;
}

static starg_status claim_ends(const verify_morph *own, const starg_mesh *a, const starg_mesh *b) {
    const starg_mesh *first = own->frames[0], *last = own->frames[own->frame_count - 1];
    bool plain = is_equal(first, a);
    if (plain)
        verify_claim(own->verdict, true, "the first frame is A");
    else if (has_faces_of(first, a))
        verify_claim(own->verdict, false, "the first frame is A: vertices are elsewhere");
    else
        TRY(claim_refined(own, first, a, "the first frame is A"));
    if (is_equal(last, b))
        verify_claim(own->verdict, true, "the last frame is B");
    else if (plain)
        TRY(claim_on(own, last, b));
    else
        TRY(claim_refined(own, last, b, "the last frame is B"));
    return STARG_OK;
}

/* ---- every frame ---- */

/* What was found of a frame, and where it differs from the report. */
typedef struct found {
    size_t wrong, first, told, count; /* frames; crossings of the first */
    size_t uneven, first_uneven;      /* volume or area */
    double ends[2][2];                /* volume and area of both ends */
    size_t drifting, first_drifting;
} found;

/* Measures volume and area; returns whether they are as told. */
static bool compare_sizes(const starg_mesh *mesh, const verify_surface *surface,
                          const verify_frame *told, double sizes[2]) {
    int scale = verify_scale(surface);
    verify_volume volume = {0};
    const double *origin = starg_mesh_vertices(mesh);
    sizes[1] = 0;
    for (size_t f = 0; f < surface->face_count; f++) {
        const double *t[3];
        verify_corners(surface, f, t);
        const double *corners[4] = {t[0], t[2], t[1], origin};
        verify_add_volume(&volume, corners, scale);
        sizes[1] += verify_area(surface, f, scale);
    }
    sizes[0] = ldexp(verify_volume_value(&volume), -3 * scale);
    sizes[1] = ldexp(sizes[1], -2 * scale);
    return verify_same_volume(&volume, ldexp(told->volume, 3 * scale), 0) &&
           fabs(told->area - sizes[1]) <= TOLERANCE * sizes[1];
}

static starg_status examine(const verify_morph *own, size_t i, found *f, double sizes[2]) {
    SCOPED_BY(verify_surface_drop) verify_surface *surface = NULL;
    SCOPED_BY(verify_tree_drop) verify_tree *tree = NULL;
    const verify_frame *told = &own->report->frames[i];
    size_t count, pair[2];
    TRY(verify_surface_welded(own->context, own->frames[i], &surface));
    TRY(verify_tree_create(surface, &tree));
    TRY(verify_find_crossings(surface, tree, &count, pair));
    bool even = compare_sizes(own->frames[i], surface, told, sizes);
    if (count != told->intersections && f->wrong++ == 0) {
        f->first = i;
        f->told = told->intersections;
        f->count = count;
    }
    if (!even && f->uneven++ == 0)
        f->first_uneven = i;
    return STARG_OK;
}

/* Deviation from what is linear in t. */
static double drift_of(double value, double first, double last, double t) {
    double wanted = first + t * (last - first);
    return wanted != 0 ? (value - wanted) / fabs(wanted) : 0;
}

static void compare_drifts(const verify_morph *own, const double *sizes, found *f) {
    const double *last = sizes + 2 * (own->frame_count - 1);
    for (size_t i = own->frame_count; i-- > 0;) {
        const verify_frame *told = &own->report->frames[i];
        double volume = drift_of(sizes[2 * i], sizes[0], last[0], told->t);
        double area = drift_of(sizes[2 * i + 1], sizes[1], last[1], told->t);
        if (fabs(volume - told->volume_drift) > TOLERANCE * (1 + fabs(volume)) ||
            fabs(area - told->area_drift) > TOLERANCE * (1 + fabs(area))) {
            f->drifting++;
            f->first_drifting = i;
        }
    }
}

static starg_status claim_measures(const verify_morph *own) {
    found f = {0};
    SCOPED double *sizes = NULL;
    NEW(own->context, STAGE, sizes, 2 * own->frame_count);
    for (size_t i = 0; i < own->frame_count; i++)
        TRY(examine(own, i, &f, sizes + 2 * i));
    compare_drifts(own, sizes, &f);
    if (f.wrong == 0)
        verify_claim(own->verdict, true, "each frame has as many crossings as reported");
    else
        verify_claim(own->verdict, false,
                     "each frame has as many crossings as reported: %zu have not, frame %zu has "
                     "%zu and not %zu",
                     f.wrong, f.first, f.count, f.told);
    verify_claim_all(own->verdict, f.uneven, f.first_uneven, "its volume and area are as reported");
    verify_claim_all(own->verdict, f.drifting, f.first_drifting, "and so are their drifts");
    verify_leave(own->verdict, "numbers of flipped and collapsed faces");
    return STARG_OK;
}

starg_status starg_verify_morph(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                const starg_mesh *const *frames, size_t frame_count,
                                const starg_morph_report *report, starg_verdict **out) {
    SCOPED_BY(starg_verdict_drop) starg_verdict *verdict = NULL;
    *out = NULL;
    if (frame_count < 2)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "a morph has at least two frames");
    TIME_RULE(context, STARG_TIME_FAILS);
    TRY(verify_verdict_create(context, &verdict));
    const verify_morph own = {context, frames, frame_count, report, verdict};
    bool whole = claim_frames(&own);
    TRY(claim_ends(&own, a, b));
    if (whole && report != NULL)
        TRY(claim_measures(&own));
    if (report == NULL)
        verify_leave(verdict, "what frames between the ends are like: there is no report");
    *out = verdict;
    verdict = NULL;
    return STARG_OK;
}
