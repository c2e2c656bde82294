/* SPDX-License-Identifier: Apache-2.0 */
/* Star decomposition: the options, the mode, and tetrahedra where they are needed. */

#include "geometry/vec3.h"
#include "mesh/examine.h"
#include "star/decomposition.h"
#include "star/piece_faces.h"
#include "tetra/generate.h"

enum { MERGES = 3 };
static const double MERGED[MERGES] = {1e-12, 1e-9, 1e-7}; /* distances, over the diagonal */
static const char STAGE[] = "pieces";

static const starg_field OPTIONS[] = {
    {.key = "mode",
     .option = "mode",
     .group = "search",
     .brief = "certified pieces, or those of the paper",
     .kind = STARG_FIELD_CHOICE,
     FIELD_MEMBER(starg_decompose_options, mode),
     .words = decompose_mode_words,
     .value = "strict|paper",
     .help = "strict: every piece is proven star-shaped. paper: region growing from guards as "
             "published by Yu and Li; nearly all vertices are visible from their guards, and the "
             "report lists the star-shaped pieces."},
    {.key = "density",
     .option = "density",
     .group = "search",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_NULLABLE,
     FIELD_MEMBER(starg_decompose_options, tetra.density),
     .high = 1e6,
     .standard = STARG_DECOMPOSE_DENSITY,
     .value = "T",
     .help =
         "Initial tetrahedra per surface vertex; 0: as few as possible. strict needs none unless "
         "the surface intersects itself.",
     .default_text = "0 for strict, 17.5 (as published) for paper"},
    {.key = "max_pieces",
     .option = "max-pieces",
     .group = "number",
     .brief = "stop at so many pieces",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_decompose_options, max_pieces),
     .most = UINT32_MAX,
     .value = "N",
     .help = "strict: stop the search at N pieces or fewer. paper: at most N pieces, at the cost "
             "of visibility.",
     .default_text = "0, as few as possible"},
    {.key = "effort",
     .option = "effort",
     .group = "search",
     .brief = "how long it searches for fewer pieces",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_decompose_options, effort),
     .most = INT64_MAX,
     .initial = STARG_EFFORT_NORMAL,
     .words = effort_words,
     .value = "quick|normal|best|N",
     .help =
         "strict: how long it searches for fewer pieces, about 2, 5 or 20 seconds of work where "
         "there is so much to try; or the number of trials.",
     .default_text = "normal; with --time-limit all of that time"},
    {.key = "fill",
     .option = "fill",
     .group = "search",
     .kind = STARG_FIELD_FLAG,
     FIELD_MEMBER(starg_decompose_options, fill),
     .help = "Fill a surface with holes even if the filled volume is farther from it than a fifth "
             "of its diagonal."},
    {.key = "quality",
     .option = "quality",
     .group = "search",
     .kind = STARG_FIELD_FLAG,
     FIELD_MEMBER(starg_decompose_options, quality),
     .help = "strict: spend more on room for the guards, which makes better tetrahedra."},
    {.key = "prove",
     .option = "prove",
     .group = "number",
     .brief = "a bound for every way to cut",
     .kind = STARG_FIELD_FLAG,
     FIELD_MEMBER(starg_decompose_options, prove),
     .help =
         "strict: prove first how few star-shaped pieces there can be, however the solid is cut; "
         "the search ends as soon as there are no more."},
    {.key = "prove_work",
     .option = "prove-work",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_decompose_options, prove_work),
     .most = UINT64_MAX >> 1,
     .initial = 90000000,
     .value = "N",
     .help = "--prove: budget, counted in tests of a vertex against a box (about a microsecond "
             "each)."},
    {.key = "balls",
     .option = "balls",
     .group = "output",
     .brief = "a certified map of each piece to a ball",
     .kind = STARG_FIELD_CHOICE,
     .flags = STARG_FIELD_ALONE,
     FIELD_MEMBER(starg_decompose_options, balls),
     .none = STARG_BALLS_RAYS,
     .words = decompose_ball_words,
     .value = "none|rays|even",
     .help = "strict: map each piece to a ball, linearly on each tetrahedron and without "
             "inversions; PIECES.vtk holds the images of the corners. rays: along the rays from "
             "the guard. even: with less distortion."},
    TETRA_FIELDS(starg_decompose_options, tetra.),
};
static const starg_fields OPTIONS_TABLE = {
    .name = "decompose options", .size = sizeof(starg_decompose_options), FIELD_ROWS(OPTIONS)};

const starg_fields decompose_file_options = {.name = "options",
                                             .size = sizeof(starg_decompose_options),
                                             .fields = OPTIONS,
                                             .count = sizeof OPTIONS / sizeof *OPTIONS -
                                                      TETRA_MACHINE_FIELDS};
OPTIONS_BY(OPTIONS_TABLE, starg_decompose_options)

/* Strict pieces are made of their surfaces: where tetrahedra are needed, they may be few. */
static starg_tetra_options tetra_options(const starg_decompose_options *o) {
    starg_tetra_options tetra = o->tetra, usual;
    starg_tetra_options_default(&usual);
    if (tetra.density < 0)
        tetra.density = o->mode == STARG_DECOMPOSE_STRICT ? 0 : usual.density;
    return tetra;
}

static starg_status check_options(starg_context *context, const starg_decompose_options *o) {
    TRY(fields_check(context, STAGE, &OPTIONS_TABLE, o));
    if (o->balls != STARG_BALLS_NONE && o->mode != STARG_DECOMPOSE_STRICT)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "only the pieces of --mode strict can be mapped to balls: those of the "
                          "paper need not be star-shaped");
    for (size_t i = 0; o->guards != NULL && i < 3 * o->guard_count; i++)
        if (!(fabs(o->guards[i]) < STARG_COORDINATE_LIMIT)) {
            uint64_t guard = i / 3;
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_GUARD, &guard,
                                 1,
                                 "guard %zu has the coordinate %g; it must be finite and below "
                                 "1e100 in magnitude",
                                 i / 3, o->guards[i]);
        }
    if (o->prove && o->mode == STARG_DECOMPOSE_PAPER)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a bound for star-shaped pieces is proven in strict mode only");
    return STARG_OK;
}

static starg_status run_mode(starg_context *context, const starg_tetmesh *mesh,
                             const starg_decompose_options *options, starg_decomposition **out) {
    bool paper = options->mode == STARG_DECOMPOSE_PAPER;
    starg_status status = paper ? paper_decompose(context, mesh, options, out)
                                : certified_decompose_tetmesh(context, mesh, options, out);
    if (status == STARG_OK)
        (*out)->flattest_given = tetmesh_flattest(mesh);
    return status;
}

/* What made a result. A strict search has noted its effort. */
static void remember(const starg_context *context, const starg_decompose_options *options,
                     starg_decomposition *d) {
    bool strict = options->mode == STARG_DECOMPOSE_STRICT;
    uint64_t effort = strict ? d->options.effort : options->effort;
    d->options_known = true;
    d->options = *options;
    d->options.effort = effort;
    d->options.guards = NULL;
    d->options.tetra.tetgen = NULL;
    d->seed = context->seed;
}

/* Fills a solid, or an open surface: one of the two is NULL. */
static starg_status fill(starg_context *context, const starg_solid *solid,
                         const starg_mesh *surface, const starg_decompose_options *options,
                         starg_tetra_report *report, starg_tetmesh **out) {
    const starg_tetra_options tetra = tetra_options(options);
    TIME_RULE(context, STARG_TIME_FAILS);
    return solid != NULL ? starg_tetmesh_from_solid(context, solid, &tetra, report, out)
                         : starg_tetmesh_from_open_mesh(context, surface, &tetra, report, out);
}

/* Where a surface is more hole than surface, or turns to and fro, what it winds around has little
 * to do with it. */
static starg_status check_filling(starg_context *context, const starg_mesh *surface,
                                  const starg_tetra_report *report) {
    SCOPED_BY(starg_check_drop) starg_check *check = NULL;
    double lower[3], upper[3], off = fmax(report->to_surface, report->from_surface) + report->step;
    starg_mesh_bounds(surface, lower, upper);
    double share = off / vec3_distance(lower, upper);
    if (share <= STARG_DECOMPOSE_FILL_MOST)
        return STARG_OK;
    TRY(starg_mesh_check(context, surface, &check));
    bool holes = check->findings[STARG_FINDING_OPEN_EDGE].count > 0;
    return starg_fail(
        context, STARG_ERROR_MESH, STAGE,
        "the volume that fills the surface is up to %.2g of its diagonal away from it, more than "
        "%g: %s with 'starguard repair', or set --fill",
        share, STARG_DECOMPOSE_FILL_MOST,
        holes ? "its holes are too large; close them"
              : "edges with more than two faces, or faces that are turned differently, leave open "
                "what is inside; mend them");
}

static starg_status decompose_filled(starg_context *context, const starg_solid *solid,
                                     const starg_mesh *surface,
                                     const starg_decompose_options *options,
                                     starg_decomposition **out) {
    starg_tetra_report report;
    SCOPED_BY(starg_tetmesh_drop) starg_tetmesh *mesh = NULL;
    TRY(fill(context, solid, surface, options, &report, &mesh));
    if (solid == NULL && !options->fill)
        TRY(check_filling(context, surface, &report));
    TRY(run_mode(context, mesh, options, out));
    (*out)->tetra = report;
    return STARG_OK;
}

/* Nothing but the surface is needed where that bounds the solid as it is; else *out stays NULL.
 * Each part of the solid needs a piece, and two if its kernel has no interior. */
static starg_status decompose_surface(starg_context *context, const starg_solid *solid,
                                      const starg_decompose_options *options,
                                      starg_decomposition **out) {
    SCOPED uint32_t *faces = NULL;
    SCOPED_BY(solid_parts_free) solid_parts parts = {0};
    TRY(touching_weld(context, solid, &faces));
    if (faces == NULL)
        return STARG_OK;
    const kernel_faces surface = {solid->mesh->vertices, faces, solid->mesh->face_count};
    TRY(solid_parts_find(context, solid, &parts));
    TRY(certified_decompose_surface(context, &surface, &parts, options, out));
    if (*out == NULL)
        return STARG_OK;
    starg_decomposition *d = *out;
    d->flattest_given = -1;
    TRY(solid_parts_bound(context, solid, &parts, NULL, 1, true, &d->lower_bound));
    d->optimal = d->lower_bound == d->piece_count;
    return STARG_OK;
}

/* Where the details of a surface are too small for planes between them, their vertices are merged:
 * as few as will do. *out stays NULL where none will. `model`: what is told is how far that is. */
static starg_status decompose_merged(starg_context *context, const starg_mesh *surface,
                                     const starg_mesh *model,
                                     const starg_decompose_options *options,
                                     starg_decomposition **out) {
    for (int i = 0; i < MERGES && *out == NULL; i++) {
        SCOPED_BY(starg_solid_drop) starg_solid *merged = NULL;
        TRY(united_merge(context, surface, MERGED[i], &merged));
        if (merged != NULL)
            TRY(decompose_surface(context, merged, options, out));
        if (*out == NULL)
            continue;
        (*out)->lower_bound = 0;
        (*out)->optimal = false;
        starg_log(context, STARG_LOG_NOTICE,
                  "vertices nearer to each other than %g of the diagonal were merged: no planes "
                  "fit between them",
                  MERGED[i]);
        return united_report(context, model, merged, *out);
    }
    return STARG_OK;
}

/* A surface that intersects itself is cut where it does; *out stays NULL where that cannot be. The
 * bound is that of the union. */
static starg_status decompose_union(starg_context *context, const starg_solid *solid,
                                    const starg_decompose_options *options,
                                    starg_decomposition **out) {
    SCOPED_BY(starg_solid_drop) starg_solid *united = NULL;
    TRY(united_make(context, solid, &united));
    if (united == NULL)
        return STARG_OK;
    TRY(decompose_surface(context, united, options, out));
    if (*out == NULL)
        return decompose_merged(context, united->mesh, solid->mesh, options, out);
    (*out)->lower_bound = 0;
    (*out)->optimal = false;
    return united_report(context, solid->mesh, united, *out);
}

/* A surface that is closed once its faces share what they touch; *out stays NULL where it is not.
 */
static starg_status decompose_joined(starg_context *context, const starg_mesh *surface,
                                     const starg_decompose_options *options,
                                     starg_decomposition **out) {
    SCOPED_BY(starg_solid_drop) starg_solid *joined = NULL;
    bool exact = false;
    TRY(united_join(context, surface, &joined, &exact));
    if (joined == NULL)
        return STARG_OK;
    TRY(decompose_surface(context, joined, options, out));
    if (*out == NULL)
        TRY(decompose_union(context, joined, options, out));
    if (*out == NULL)
        return STARG_OK;
    (*out)->joined = true;
    (*out)->lower_bound = exact ? (*out)->lower_bound : 0;
    (*out)->optimal = exact && (*out)->optimal;
    return united_report(context, surface, joined, *out);
}

/* What is asked for: one of the three models is given. */
typedef struct request {
    starg_context *context;
    const starg_solid *solid;
    const starg_mesh *surface; /* open */
    const starg_tetmesh *tetmesh;
    const starg_decompose_options *options; /* NULL: the usual ones */
    bool certified;                         /* `bound` is to have a certificate */
    corner_guards bound;                    /* found where it is to be proven */
} request;

static starg_status decompose_model(const request *r, const starg_decompose_options *options,
                                    starg_decomposition **out) {
    starg_context *context = r->context;
    const starg_solid *solid = r->solid;
    const bool strict = solid != NULL && options->mode == STARG_DECOMPOSE_STRICT;
    if (r->tetmesh != NULL)
        TRY(run_mode(context, r->tetmesh, options, out));
    if (strict)
        TRY(decompose_surface(context, solid, options, out));
    if (strict && *out == NULL)
        TRY(decompose_union(context, solid, options, out));
    if (strict && *out == NULL)
        TRY(decompose_merged(context, solid->mesh, solid->mesh, options, out));
    if (r->surface != NULL && options->mode == STARG_DECOMPOSE_STRICT)
        TRY(decompose_joined(context, r->surface, options, out));
    if (*out == NULL)
        TRY(decompose_filled(context, solid, r->surface, options, out));
    starg_decomposition *d = *out;
    const starg_mesh *model = solid != NULL ? solid->mesh : r->surface;
    d->model_vertices = solid != NULL   ? solid->model_vertices
                        : model != NULL ? model->vertex_count
                                        : r->tetmesh->vertex_count;
    d->model_faces = model != NULL ? model->face_count : 0;
    d->model_tetrahedra = model != NULL ? 0 : r->tetmesh->count;
    d->flattest = tetmesh_flattest(d->mesh);
    TRY(balls_make(context, d, options->balls));
    if (solid != NULL && d->tetra.surface_kept)
        TRY(angles_tell_apart(context, model, d));
    remember(context, options, d);
    return STARG_OK;
}

/* A lower bound for star decompositions.
 *
 * Problem: into how few star-shaped pieces can a solid be cut, wherever its cuts run? A piece is
 * star-shaped if its guard is strictly on the inner side of all faces of its boundary, which winds
 * around it once.
 *
 * Theorem: let a surface bound the solid that has the outside just before every point of its faces,
 * as embedded ones do, and others that touch themselves in vertices and edges
 * (star/decomposition.h). Let f be a face of it and v a corner of f. Some guard g of a piece is
 * strictly on the inner side of f, and the segment from g to v meets the surface in v only. So
 * there are at least as many pieces as points are needed that see all such corners, wherever the
 * points stand.
 *
 * Proof: let points x1, x2, ... inside f converge to v. The pieces are closed, finitely many, and
 * fill the solid: some piece P, with guard g, holds infinitely many of them, and v.
 * 1. Let x be a point of P. Every point y of the half-open segment [g, x) is an inner point of P,
 *    for some ball about g is on the inner side of all faces of P, and so P holds all segments from
 *    x to that ball, which fill a neighbourhood of y. An inner point of P is one of the solid, and
 *    no inner point of the solid lies on its surface, since outer ones are as near as you like. So
 *    [g, x) does not meet the surface.
 * 2. With x = v: the segment from g to v meets the surface in v only.
 * 3. With x = xi inside f: the segment ends in xi coming from the inside of the solid, which is on
 *    the inner side of f there, and it does not run along f. So g is strictly on the inner side.
 *
 * Stages: the search over every point of the solid with corners as targets (guard/search.c) gives
 * the bound, its certificate, and points that see all corners, from which guards of pieces can be
 * tried.
 *
 * Cost: that of starg_guard with `prove`. */

/* The bound of the guards holds for star-shaped pieces that make up the solid; 0: the time was over
 * before there was any. `work` is that of starg_guard_options.prove_work. Errors: those of
 * starg_guard but TIME, and MESH (the surface intersects itself, or touches otherwise than in
 * vertices and edges). */
static starg_status piece_bound_find(starg_context *context, const starg_solid *solid,
                                     uint64_t work, bool certified, corner_guards *out) {
    bool bounds;
    *out = (corner_guards){0};
    starg_status status = touching_bounds(context, solid, &bounds);
    if (status == STARG_OK && !bounds)
        return starg_fail(context, STARG_ERROR_MESH, STAGE,
                          "how few pieces there can be is proven for surfaces only that do not "
                          "intersect themselves, and touch themselves in common vertices and edges "
                          "alone; make one with 'starguard repair --union', or leave out the "
                          "proof");
    if (status == STARG_OK)
        status = corner_guards_find(context, solid, work, certified, out);
    return status == STARG_ERROR_TIME ? STARG_OK : status;
}

/* Half of the time that is left is for the proof; did it end that? */
static starg_status find_bound(request *r, bool *time_limited) {
    starg_context *context = r->context;
    const starg_deadline all = context->deadline;
    if (all.at > 0)
        context->deadline.at -= fmax(starg_seconds_left(context), 0) / 2;
    starg_status status =
        piece_bound_find(context, r->solid, r->options->prove_work, r->certified, &r->bound);
    *time_limited = starg_time_is_over(context);
    context->deadline.at = all.at;
    return status;
}

/* The search ends at the proven bound; the points that see all corners are its first guards. */
static starg_status decompose_proven(request *r, starg_decomposition **out) {
    starg_decompose_options own = *r->options;
    const corner_guards *bound = &r->bound;
    bool time_limited;
    if (r->tetmesh != NULL)
        return starg_fail(r->context, STARG_ERROR_ARGUMENT, STAGE,
                          "a bound for pieces is proven for surfaces only; give the boundary of "
                          "the tetrahedra as a surface");
    if (r->surface != NULL)
        return starg_fail(r->context, STARG_ERROR_MESH, STAGE,
                          "a bound for pieces is proven for closed surfaces only; close it with "
                          "'starguard repair', or leave out the proof");
    TRY(find_bound(r, &time_limited));
    if (own.max_pieces < bound->bound)
        own.max_pieces = bound->bound;
    if (own.guards == NULL) {
        own.guards = bound->positions;
        own.guard_count = bound->count;
    }
    TRY(decompose_model(r, &own, out));
    if (!(*out)->tetra.surface_kept)
        return starg_fail(r->context, STARG_ERROR_MESH, STAGE,
                          "the model has details too small for cuts, so that pieces only "
                          "approximate it, of which nothing can be proven; merge them with "
                          "'starguard repair --merge-distance 1e-9', or leave out the proof");
    if (r->certified || (*out)->lower_bound < bound->bound)
        (*out)->lower_bound = bound->bound;
    (*out)->optimal = (*out)->lower_bound == (*out)->piece_count;
    (*out)->time_limited = (*out)->time_limited || time_limited;
    remember(r->context, r->options, *out);
    if (r->certified && bound->certificate == NULL)
        return starg_fail_time(r->context, STAGE);
    return STARG_OK;
}

static starg_status decompose(request *r, starg_decomposition **out) {
    starg_status status = STARG_OK;
    starg_decompose_options usual;
    starg_decompose_options_default(&usual);
    if (r->options == NULL)
        r->options = &usual;
    *out = NULL;
    STARG_TRY(check_options(r->context, r->options));
    STARG_TRY(r->options->prove ? decompose_proven(r, out) : decompose_model(r, r->options, out));
done:
    if (status != STARG_OK) {
        starg_decomposition_free(r->context, *out);
        *out = NULL;
    }
    return status;
}

starg_status starg_decompose(starg_context *context, const starg_solid *solid,
                             const starg_decompose_options *options, starg_decomposition **out) {
    request r = {.context = context, .solid = solid, .options = options};
    starg_status status = decompose(&r, out);
    corner_guards_free(&r.bound);
    return status;
}

starg_status starg_decompose_certified(starg_context *context, const starg_solid *solid,
                                       const starg_decompose_options *options,
                                       starg_decomposition **out, char **text, size_t *size) {
    request r = {.context = context, .solid = solid, .options = options, .certified = true};
    *out = NULL;
    *text = NULL;
    *size = 0;
    if (options == NULL || !options->prove)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a certificate says why a bound for pieces holds, which is not asked "
                          "for; ask for a proof (prove)");
    starg_status status = decompose(&r, out);
    if (status == STARG_OK) {
        *text = r.bound.certificate;
        *size = r.bound.size;
        r.bound.certificate = NULL;
    }
    corner_guards_free(&r.bound);
    return status;
}

starg_status starg_decompose_tetmesh(starg_context *context, const starg_tetmesh *mesh,
                                     const starg_decompose_options *options,
                                     starg_decomposition **out) {
    request r = {.context = context, .tetmesh = mesh, .options = options};
    return decompose(&r, out);
}

starg_status starg_decompose_open_mesh(starg_context *context, const starg_mesh *surface,
                                       const starg_decompose_options *options,
                                       starg_decomposition **out) {
    request r = {.context = context, .surface = surface, .options = options};
    return decompose(&r, out);
}
