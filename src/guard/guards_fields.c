/* SPDX-License-Identifier: Apache-2.0 */
/* Guard options and GUARDS.json as tables (starguard/fields.h): the only place with their names,
 * ranges and descriptions. Rows are in the order of the file. */
#include "guard/prices.h"
#include "guard/stages.h"

#include "starguard/guard.h"
#include "visibility/fields.h"
#include "visibility/sensor.h"

/* ---- options ---- */

#define OPTION(NAME) FIELD_MEMBER(starg_guard_options, NAME)
#define USUALLY_NOT  .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE

static const char *const METHODS[] = {"ilp", "greedy", "pilp", NULL};
static const char *const CANDIDATES[] = {"medial", "interior", "given", "skeleton", NULL};

static bool has_levels(const void *record) {
    return ((const starg_guard_options *)record)->method == STARG_GUARD_PILP;
}

static bool has_patches(const void *record) {
    return ((const starg_guard_options *)record)->visibility.patch != STARG_PATCH_OFF;
}

static const starg_field OPTIONS[] = {
    {.key = "method",
     .option = "method",
     .group = "search",
     .kind = STARG_FIELD_CHOICE,
     OPTION(method),
     .words = METHODS,
     .initial = STARG_GUARD_PILP,
     .value = "pilp|ilp|greedy",
     .help =
         "pilp: from coarse to fine levels of detail, then refinement; ilp: the fewest candidates, "
         "proven optimal or with a bound; greedy: fastest, with more guards and the bound of a "
         "linear program."},
    {.key = "candidates",
     .kind = STARG_FIELD_CHOICE,
     OPTION(candidates),
     .words = CANDIDATES,
     .initial = STARG_CANDIDATES_SKELETON,
     .value = "skeleton|medial|interior|given",
     .help = "Candidate positions: on the curve skeleton, on the medial axis, on an interior "
             "lattice, or at given points."},
    {.key = "count",
     .option = "count",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_NULLABLE,
     OPTION(candidate_count),
     .none = STARG_DEFAULT_COUNT,
     .least = 1,
     .most = 10000000,
     .initial = STARG_DEFAULT_COUNT,
     .value = "N",
     .help = "Approximate number of candidates; more are added for faces that none of them sees.",
     .default_text =
         "1,000; 200 where a search moves them (pilp with quick or normal effort); 300 that look "
         "in directions and are to see a part"},
    VISIBILITY_ENGINE_FIELD(starg_guard_options, visibility.engine, NULL, "visibility"),
    VISIBILITY_TARGET_FIELD(starg_guard_options, visibility.target),
    VISIBILITY_FACE_RULE_FIELD(starg_guard_options, visibility.face_rule),
    {.key = "coverage",
     .option = "coverage",
     .group = "targets",
     .brief = "a part of the area is enough, such as 0.95",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_ABOVE,
     OPTION(coverage),
     .high = 1,
     .standard = 1,
     .value = "F",
     .help = "Fraction of the coverable area to cover (of the vertices with --target vertices), "
             "above 0 and at most 1."},
    {.key = "max_guards",
     .option = "max-guards",
     .group = "number",
     .brief = "the best that K guards can do",
     .kind = STARG_FIELD_COUNT,
     OPTION(max_guards),
     .most = UINT32_MAX,
     .value = "K",
     .help = "Use at most K guards and maximize the covered area.",
     .default_text = "no limit"},
    VISIBILITY_PATCH_FIELD(starg_guard_options, visibility.patch, has_patches),
    VISIBILITY_RANGE_FIELD(starg_guard_options, visibility.range),
    VISIBILITY_NEAR_FIELD(starg_guard_options, visibility.near),
    VISIBILITY_INCIDENCE_FIELD(starg_guard_options, visibility.incidence),
    VISIBILITY_CONE_FIELD(starg_guard_options, visibility.cone, "cone"),
    VISIBILITY_FOV_FIELD(starg_guard_options, visibility.fov, "fov"),
    VISIBILITY_UP_FIELD(starg_guard_options, visibility.up, "up"),
    VISIBILITY_TILT_FIELD(starg_guard_options, visibility.tilt, "tilt"),
    VISIBILITY_RESOLUTION_FIELD(starg_guard_options, visibility.resolution),
    VISIBILITY_DENSITY_FIELD(starg_guard_options, visibility.density),
    VISIBILITY_UNIT_FIELD(starg_guard_options, visibility.unit),
    {.key = "redundancy",
     .option = "redundancy",
     .group = "number",
     .brief = "each face seen by K guards",
     .kind = STARG_FIELD_COUNT,
     OPTION(redundancy),
     .least = 1,
     .most = BOUND_MOST_TIMES,
     .initial = 1,
     .value = "K",
     .help = "Cover each face by K guards, or by as many candidates as see it."},
    {.key = "baseline",
     .option = "baseline",
     .group = "number",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     OPTION(baseline),
     .high = 180,
     .value = "DEGREES",
     .help = "--redundancy: two of them at least so far apart, as seen from the middle of the "
             "face, where candidates allow."},
    {.key = "kept",
     .kind = STARG_FIELD_COUNT,
     USUALLY_NOT,
     OPTION(keep_count),
     .most = UINT32_MAX,
     .help = "Number of guards that were given to stay."},
    {.key = "clearance",
     .option = "clearance",
     .group = "places",
     .brief = "distance of guards from the boundary",
     .kind = STARG_FIELD_REAL,
     OPTION(clearance),
     .high = 1e100,
     .value = "D",
     .help = "Minimum distance of guards from the boundary, in model units."},
    {.key = "order",
     .option = "order",
     .group = "output",
     .brief = "guards in the order of a short tour",
     .kind = STARG_FIELD_FLAG,
     USUALLY_NOT,
     OPTION(order),
     .help = "Put the guards in the order of a short tour, and give the way through them, which "
             "meets no face."},
    {.key = "max_nodes",
     .option = "max-nodes",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     USUALLY_NOT,
     OPTION(max_nodes),
     .most = UINT32_MAX,
     .initial = STARG_DEFAULT_NODES,
     .value = "N",
     .help = "Limit on branch-and-bound nodes per independent part.",
     .default_text = "100,000 for ilp, 30 for each level of pilp"},
    {.key = "coarsest",
     .option = "coarsest",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     OPTION(coarsest),
     .applies = has_levels,
     .least = 4,
     .most = UINT32_MAX,
     .initial = 5000,
     .value = "N",
     .help = "pilp: number of vertices of the coarsest level."},
    {.key = "step",
     .option = "step",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_NULLABLE,
     OPTION(step),
     .applies = has_levels,
     .least = 1,
     .most = UINT32_MAX,
     .initial = STARG_DEFAULT_STEP,
     .none = STARG_QUARTERS,
     .value = "N",
     .help = "pilp: number of vertices that each finer level adds.",
     .default_text = "10,000; for models with more than 40,000 vertices above the coarsest level, "
                     "each level has a quarter of the next finer one"},
    {.key = "significance",
     .option = "significance",
     .group = "search",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     OPTION(significance),
     .applies = has_levels,
     .high = 1,
     .standard = 0.1,
     .value = "F",
     .help = "pilp: discard guards that see less than this fraction of a level's area."},
    {.key = "refine",
     .option = "no-refine",
     .group = "search",
     .kind = STARG_FIELD_FLAG,
     .flags = STARG_FIELD_OPTIONAL,
     OPTION(refine),
     .applies = has_levels,
     .initial = true,
     .help = "pilp: skip refinement, the search for fewer guards beside the candidates."},
    {.key = "effort",
     .option = "effort",
     .group = "search",
     .brief = "how long it searches",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     OPTION(effort),
     .most = INT64_MAX,
     .initial = STARG_EFFORT_NORMAL,
     .words = effort_words,
     .value = "quick|normal|best|N",
     .help =
         "How long it searches for fewer guards: at most three times as long with normal as with "
         "quick; best until more is unlikely to help, with a bound for guards anywhere; or so "
         "many units of work, about a microsecond each."},
    {.key = "refine_lines",
     .option = "refine-lines",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     USUALLY_NOT,
     OPTION(refine_lines),
     .most = UINT32_MAX,
     .initial = STARG_DEFAULT_LINES,
     .value = "N",
     .help = "pilp: budget of refinement, counted in sight lines (about a microsecond each) and "
             "what takes as long.",
     .default_text = "by effort; for best 6,000,000, and for each guard 15 for each face, at least "
                     "300,000"},
    {.key = "prove",
     .option = "prove",
     .group = "number",
     .brief = "the fewest, wherever they stand, with a proof",
     .kind = STARG_FIELD_FLAG,
     USUALLY_NOT,
     OPTION(prove),
     .help = "Search fewer guards at every point of the solid, and prove how many are needed, "
             "wherever they stand (with --max-guards: how much so many could see). With candidates "
             "from a file the fewest of these are chosen."},
    {.key = "prove_work",
     .option = "prove-work",
     .group = "search",
     .kind = STARG_FIELD_COUNT,
     USUALLY_NOT,
     OPTION(prove_work),
     .most = UINT64_MAX >> 1,
     .initial = 90000000,
     .value = "N",
     .help = "--prove: budget, counted in tests of a vertex against a box (about a microsecond "
             "each)."},
};
static const starg_fields OPTIONS_TABLE = {
    .name = "options", .size = sizeof(starg_guard_options), FIELD_ROWS(OPTIONS)};

const starg_fields *starg_guard_options_fields(void) {
    return &OPTIONS_TABLE;
}

void starg_guard_options_default(starg_guard_options *options) {
    *options = (starg_guard_options){0};
    starg_fields_default(&OPTIONS_TABLE, options);
}

/* ---- parts of the file ---- */

#define RESULT(NAME)    FIELD_MEMBER(starg_guards, NAME)
#define LENGTH(T, NAME) .length = offsetof(T, NAME)

static const starg_guards *of(const void *record) {
    return record;
}

static bool has_directions(const void *record) {
    return sensor_is_directed(&of(record)->options.visibility);
}

static bool has_ups(const void *record) {
    return of(record)->options.visibility.fov[0] > 0;
}

static bool has_baseline(const void *record) {
    return of(record)->options.baseline > 0;
}

static bool targets_vertices(const void *record) {
    return of(record)->options.visibility.target == STARG_TARGET_VERTICES;
}

static bool sees_patches(const void *record) {
    return of(record)->options.visibility.patch > 0;
}

static bool targets_points(const void *record) {
    return of(record)->options.visibility.target == STARG_TARGET_POINTS;
}

static bool has_partial(const void *record) {
    return sees_patches(record) || targets_points(record);
}

static bool has_area_bound(const void *record) {
    return of(record)->options.max_guards > 0;
}

static bool is_bounded_everywhere(const void *record) {
    return of(record)->lower_bound_everywhere > 0;
}

static bool has_needs(const void *record) {
    return of(record)->need_count > 0;
}

static bool has_kept(const void *record) {
    return of(record)->options.keep_count > 0;
}

static bool has_tour(const void *record) {
    return of(record)->options.order && of(record)->count > of(record)->options.keep_count;
}

static const starg_field MODEL[] = {
    {.key = "file",
     .kind = STARG_FIELD_TEXT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(file),
     .help = "The model's path as given; \"-\" for standard input."},
    {.key = "vertices",
     .kind = STARG_FIELD_COUNT,
     RESULT(vertex_count),
     .most = UINT32_MAX,
     .help = "Number in the model."},
    {.key = "faces",
     .kind = STARG_FIELD_COUNT,
     RESULT(face_count),
     .most = UINT32_MAX,
     .help = "Number in the model."},
};
static const starg_fields MODEL_TABLE = {.name = "model", FIELD_ROWS(MODEL)};

static const starg_field GUARDS[] = {
    {.key = "position",
     .kind = STARG_FIELD_POINT,
     RESULT(positions),
     .help = "Position, strictly inside."},
    {.key = "faces",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_guards, seen_faces),
     .size = sizeof(size_t),
     .most = UINT32_MAX,
     .help = "Number of visible faces."},
    {.key = "level",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_guards, levels),
     .size = sizeof(int),
     .most = INT32_MAX,
     .help = "Level of detail at which it was chosen; 0 is the coarsest. Guards from refinement "
             "have the last level."},
    {.key = "direction",
     .kind = STARG_FIELD_POINT,
     RESULT(directions),
     .applies = has_directions,
     .help = "With a cone or a field of view: viewing direction, a unit vector unless it was "
             "given."},
    {.key = "up",
     .kind = STARG_FIELD_POINT,
     RESULT(ups),
     .applies = has_ups,
     .help = "With a field of view: what is up in it; its vertical axis is as near to this as the "
             "direction allows."},
    {.key = "kept",
     .kind = STARG_FIELD_FLAG,
     .offset = offsetof(starg_guards, kept),
     .size = sizeof(bool),
     .applies = has_kept,
     .help = "It was given to stay (keep)."},
};
static const starg_fields GUARDS_TABLE = {.columns = true, .name = "guards", FIELD_ROWS(GUARDS)};

static const starg_field LEVEL_POINTS[] = {
    {.key = "guards", .kind = STARG_FIELD_POINT, FIELD_MEMBER(starg_guard_level, positions)}};
static const starg_fields LEVEL_POINTS_TABLE = {
    .columns = true, .name = "positions", .form = STARG_FORM_BARE, FIELD_ROWS(LEVEL_POINTS)};

static const starg_field LEVELS[] = {
    {.key = "vertices",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_guard_level, vertex_count),
     .most = UINT32_MAX,
     .help = "Number in the level."},
    {.key = "faces",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_guard_level, face_count),
     .most = UINT32_MAX,
     .help = "Number in the level."},
    {.key = "kept",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_guard_level, kept),
     .most = UINT32_MAX,
     .help = "Number of guards kept from the coarser level."},
    {.key = "guards",
     .kind = STARG_FIELD_LIST,
     .of = &LEVEL_POINTS_TABLE,
     LENGTH(starg_guard_level, count),
     .help = "Guards that cover the level as required; those kept come first."},
};
static const starg_fields LEVELS_TABLE = {
    .name = "levels", .size = sizeof(starg_guard_level), FIELD_ROWS(LEVELS)};

static const starg_field CURVE[] = {
    {.key = "faces",
     .kind = STARG_FIELD_REAL,
     .offset = offsetof(starg_guards, curve_faces),
     .size = sizeof(double),
     .high = 1},
    {.key = "area",
     .kind = STARG_FIELD_REAL,
     .offset = offsetof(starg_guards, curve_area),
     .size = sizeof(double),
     .high = 1},
};
static const starg_fields CURVE_TABLE = {
    .columns = true, .name = "curve", .form = STARG_FORM_TUPLE, FIELD_ROWS(CURVE)};

static const starg_field STEPS[] = {
    {.key = "work",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_guards, step_work),
     .size = sizeof(uint64_t),
     .most = UINT64_MAX >> 1},
    {.key = "guards",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_guards, step_guards),
     .size = sizeof(size_t),
     .most = UINT32_MAX},
};
static const starg_fields STEPS_TABLE = {
    .columns = true, .name = "search", .form = STARG_FORM_TUPLE, FIELD_ROWS(STEPS)};

static const starg_field REDUNDANT[] = {
    {.key = "faces",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_guards, redundant_faces),
     .size = sizeof(size_t),
     .most = UINT32_MAX},
};
static const starg_fields REDUNDANT_TABLE = {
    .columns = true, .name = "redundant_faces", .form = STARG_FORM_BARE, FIELD_ROWS(REDUNDANT)};

static const starg_field PARTIAL[] = {
    {.key = "face",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_guards, partial),
     .size = sizeof(uint32_t),
     .most = UINT32_MAX},
    {.key = "share",
     .kind = STARG_FIELD_REAL,
     .offset = offsetof(starg_guards, partial_share),
     .size = sizeof(double),
     .high = 1},
};
static const starg_fields PARTIAL_TABLE = {
    .columns = true, .name = "partial", .form = STARG_FORM_TUPLE, FIELD_ROWS(PARTIAL)};

static const starg_field POINTS[] = {
    {.key = "seen",
     .kind = STARG_FIELD_REAL,
     RESULT(points_seen),
     .high = 1,
     .help = "Share of the area of which every point is proven to be seen."},
    {.key = "open",
     .kind = STARG_FIELD_REAL,
     RESULT(points_open),
     .high = 1,
     .help = "Share that is not decided."},
    {.key = "complete",
     .kind = STARG_FIELD_FLAG,
     RESULT(points_complete),
     .help = "Every point of the targets is proven to be seen."},
};
static const starg_fields POINTS_TABLE = {.name = "points", FIELD_ROWS(POINTS)};

static const starg_field TOUR_POINTS[] = {
    {.key = "points", .kind = STARG_FIELD_POINT, RESULT(tour.points)}};
static const starg_fields TOUR_POINTS_TABLE = {
    .columns = true, .name = "points", .form = STARG_FORM_BARE, FIELD_ROWS(TOUR_POINTS)};

static const starg_field TOUR[] = {
    {.key = "length",
     .kind = STARG_FIELD_REAL,
     RESULT(tour.length),
     .high = 1e101,
     .help = "Length of the way from the first guard that does not stay to the last one."},
    {.key = "points",
     .kind = STARG_FIELD_LIST,
     .of = &TOUR_POINTS_TABLE,
     LENGTH(starg_guards, tour.point_count),
     .help = "The way: positions of guards, and where it bends between them. Its segments meet no "
             "face, but for blocked legs."},
    {.key = "stops",
     .kind = STARG_FIELD_INDICES,
     RESULT(tour.stops),
     LENGTH(starg_guards, tour.stop_count),
     .limit = offsetof(starg_guards, tour.point_count),
     .help = "Which of the points are guards, in their order."},
    {.key = "blocked",
     .kind = STARG_FIELD_INDICES,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(tour.blocked),
     LENGTH(starg_guards, tour.blocked_count),
     .limit = offsetof(starg_guards, tour.stop_count),
     .help = "Legs, from a stop to the next one, for which no free way was found; they are "
             "straight."},
};
static const starg_fields TOUR_TABLE = {.name = "tour", FIELD_ROWS(TOUR)};

static const starg_field COVERAGE[] = {
    {.key = "faces",
     .kind = STARG_FIELD_REAL,
     RESULT(coverage_faces),
     .high = 1,
     .help = "Covered fraction of all faces."},
    {.key = "area",
     .kind = STARG_FIELD_REAL,
     RESULT(coverage_area),
     .high = 1,
     .help = "Covered fraction of the total area."},
    {.key = "coverable_faces",
     .kind = STARG_FIELD_COUNT,
     RESULT(coverable_faces),
     .most = UINT32_MAX,
     .help = "Number of faces that some candidate sees."},
    {.key = "uncovered_faces",
     .kind = STARG_FIELD_INDICES,
     RESULT(uncovered),
     LENGTH(starg_guards, uncovered_count),
     .limit = offsetof(starg_guards, face_count),
     .help = "Faces of which no guard sees some part or all, ascending."},
    {.key = "partial",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     .of = &PARTIAL_TABLE,
     .applies = has_partial,
     LENGTH(starg_guards, partial_count),
     .help = "With patches: those of them of which guards see a part, and the seen share of the "
             "area of each."},
    {.key = "points",
     .kind = STARG_FIELD_RECORD,
     .flags = STARG_FIELD_OPTIONAL,
     .of = &POINTS_TABLE,
     .applies = targets_points,
     .help = "With target points: what is proven of every point."},
    {.key = "baseline_faces",
     .kind = STARG_FIELD_COUNT,
     RESULT(baseline_faces),
     .most = UINT32_MAX,
     .applies = has_baseline,
     .help = "With baseline: number of faces that two guards see from places so far apart."},
    {.key = "redundant_faces",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     .of = &REDUNDANT_TABLE,
     LENGTH(starg_guards, redundant_count),
     .help = "With redundancy above 1: numbers of faces that at least 1, 2, ... and redundancy "
             "guards see."},
    {.key = "met_needs",
     .kind = STARG_FIELD_COUNT,
     RESULT(met_needs),
     .most = UINT32_MAX,
     .applies = has_needs,
     .help = "With needs: number of those faces that as many guards see as they need."},
    {.key = "curve",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_MATCHING,
     .of = &CURVE_TABLE,
     LENGTH(starg_guards, count),
     .help = "Fractions of faces and of area covered by the first 1, 2, ... guards."},
    {.key = "vertices",
     .kind = STARG_FIELD_REAL,
     RESULT(coverage_vertices),
     .high = 1,
     .applies = targets_vertices,
     .help = "With target vertices: covered fraction of the vertices used by faces."},
    {.key = "coverable_vertices",
     .kind = STARG_FIELD_COUNT,
     RESULT(coverable_vertices),
     .most = UINT32_MAX,
     .applies = targets_vertices,
     .help = "With target vertices: number of vertices that some candidate sees."},
    {.key = "uncovered_vertices",
     .kind = STARG_FIELD_INDICES,
     RESULT(uncovered_vertices),
     LENGTH(starg_guards, uncovered_vertex_count),
     .limit = offsetof(starg_guards, vertex_count),
     .applies = targets_vertices,
     .help = "With target vertices: vertices that no guard sees, ascending."},
    {.key = "area_bound",
     .kind = STARG_FIELD_REAL,
     RESULT(area_bound),
     .high = 1,
     .standard = 1,
     .applies = has_area_bound,
     .help = "With max_guards: upper bound on the area fraction that any choice of that many "
             "candidates covers; trivially 1 with redundancy above 1 or target vertices."},
    {.key = "area_bound_everywhere",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_ABOVE,
     RESULT(area_bound_everywhere),
     .high = 1,
     .help = "With max_guards and prove: upper bound on the area fraction that so many guards "
             "cover, wherever they stand."},
};
static const starg_fields COVERAGE_TABLE = {.name = "coverage", FIELD_ROWS(COVERAGE)};

/* ---- the scene ---- */

static const char *const ORIENTATIONS[] = {"nested", "keep", NULL};

static const starg_field OBSTACLES[] = {
    {.key = "file",
     .kind = STARG_FIELD_TEXT,
     .flags = STARG_FIELD_OPTIONAL,
     FIELD_MEMBER(starg_guard_obstacle, file),
     .help = "Its path as given."},
    {.key = "vertices",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_guard_obstacle, vertex_count),
     .most = UINT32_MAX,
     .help = "Number in the obstacle."},
    {.key = "faces",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_guard_obstacle, face_count),
     .most = UINT32_MAX,
     .help = "Number in the obstacle."},
};
static const starg_fields OBSTACLES_TABLE = {
    .name = "obstacles", .size = sizeof(starg_guard_obstacle), FIELD_ROWS(OBSTACLES)};

static bool is_mesh(const void *record) {
    return ((const starg_guard_zone *)record)->face_count > 0;
}

static const starg_field ZONES[] = {
    {.key = "excludes",
     .kind = STARG_FIELD_FLAG,
     FIELD_MEMBER(starg_guard_zone, excludes),
     .help = "Guards may not stand in it."},
    {.key = "box",
     .kind = STARG_FIELD_NUMBERS,
     FIELD_MEMBER(starg_guard_zone, box),
     .length = 6,
     .low = -1e100,
     .high = 1e100,
     .help = "Lower and upper corner; of a mesh, those of a box that holds it."},
    {.key = "vertices",
     .kind = STARG_FIELD_COUNT,
     USUALLY_NOT,
     FIELD_MEMBER(starg_guard_zone, vertex_count),
     .most = UINT32_MAX,
     .help = "Of a mesh, their number."},
    {.key = "faces",
     .kind = STARG_FIELD_COUNT,
     USUALLY_NOT,
     FIELD_MEMBER(starg_guard_zone, face_count),
     .most = UINT32_MAX,
     .help = "Of a mesh, their number."},
    {.key = "file",
     .kind = STARG_FIELD_TEXT,
     .flags = STARG_FIELD_OPTIONAL,
     FIELD_MEMBER(starg_guard_zone, file),
     .applies = is_mesh,
     .help = "Of a mesh its path as given."},
};
static const starg_fields ZONES_TABLE = {
    .name = "zones", .size = sizeof(starg_guard_zone), FIELD_ROWS(ZONES)};

static const starg_field NEEDS[] = {
    {.key = "face",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_face_need, face),
     .most = UINT32_MAX},
    {.key = "times",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_face_need, times),
     .most = BOUND_MOST_TIMES},
    {.key = "density",
     .kind = STARG_FIELD_REAL,
     FIELD_MEMBER(starg_face_need, density),
     .words = visibility_density_words,
     .high = 1e100},
};
static const starg_fields NEEDS_TABLE = {
    .name = "needs", .size = sizeof(starg_face_need), .form = STARG_FORM_TUPLE, FIELD_ROWS(NEEDS)};

static const starg_field TARGETS[] = {
    {.key = "face",
     .kind = STARG_FIELD_COUNT,
     .offset = offsetof(starg_guards, targets),
     .size = sizeof(uint32_t),
     .most = UINT32_MAX},
    {.key = "weight",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_ABOVE,
     .offset = offsetof(starg_guards, importance),
     .size = sizeof(double),
     .high = 1},
};
static const starg_fields TARGETS_TABLE = {
    .columns = true, .name = "targets", .form = STARG_FORM_TUPLE, FIELD_ROWS(TARGETS)};

static const starg_field SCENE[] = {
    {.key = "orientation",
     .kind = STARG_FIELD_CHOICE,
     USUALLY_NOT,
     RESULT(space.orientation),
     .words = ORIENTATIONS,
     .help = "Shells by their nesting, or as given."},
    {.key = "outside",
     .kind = STARG_FIELD_FLAG,
     USUALLY_NOT,
     RESULT(space.outside),
     .help = "Guards stand outside of the model."},
    {.key = "soup",
     .kind = STARG_FIELD_FLAG,
     USUALLY_NOT,
     RESULT(space.soup),
     .help = "The model is any triangles, closed or not."},
    {.key = "two_sided",
     .kind = STARG_FIELD_FLAG,
     USUALLY_NOT,
     RESULT(space.two_sided),
     .help = "Its faces are seen from either side."},
    {.key = "standoff_least",
     .kind = STARG_FIELD_REAL,
     USUALLY_NOT,
     RESULT(space.standoff_least),
     .high = 1e100,
     .help = "Smallest distance of guards from the model."},
    {.key = "standoff_most",
     .kind = STARG_FIELD_REAL,
     USUALLY_NOT,
     RESULT(space.standoff_most),
     .high = 1e100,
     .help = "Largest distance of guards from the model; 0: no limit."},
    {.key = "within",
     .kind = STARG_FIELD_NUMBERS,
     USUALLY_NOT,
     RESULT(space.within),
     .length = 6,
     .low = -1e100,
     .high = 1e100,
     .help = "Guards stand in this box: lower corner, upper corner."},
    {.key = "cell",
     .kind = STARG_FIELD_REAL,
     USUALLY_NOT,
     RESULT(space.cell),
     .high = 1e100,
     .help = "Guards stand where one gets from a point through cubes of that size that no face "
             "meets."},
    {.key = "from",
     .kind = STARG_FIELD_NUMBERS,
     USUALLY_NOT,
     RESULT(space.from),
     .length = 3,
     .low = -1e100,
     .high = 1e100,
     .help = "That point."},
    {.key = "over",
     .kind = STARG_FIELD_INDICES,
     USUALLY_NOT,
     RESULT(space.over),
     LENGTH(starg_guards, space.over_count),
     .limit = offsetof(starg_guards, face_count),
     .help = "Guards stand straight above one of these faces of the model, ascending."},
    {.key = "height",
     .kind = STARG_FIELD_REAL,
     USUALLY_NOT,
     RESULT(space.height),
     .high = 1e100,
     .help = "At most so high above them."},
    {.key = "up",
     .kind = STARG_FIELD_NUMBERS,
     USUALLY_NOT,
     RESULT(space.up),
     .length = 3,
     .low = -1e100,
     .high = 1e100,
     .help = "What is up there; along y if absent."},
    {.key = "mount",
     .kind = STARG_FIELD_INDICES,
     USUALLY_NOT,
     RESULT(space.mount),
     LENGTH(starg_guards, space.mount_count),
     .limit = offsetof(starg_guards, face_count),
     .help = "Guards stand near one of these faces of the model, ascending."},
    {.key = "mount_distance",
     .kind = STARG_FIELD_REAL,
     USUALLY_NOT,
     RESULT(space.mount_distance),
     .high = 1e100,
     .help = "At most so far from them."},
    {.key = "clear",
     .kind = STARG_FIELD_INDICES,
     USUALLY_NOT,
     RESULT(space.clear),
     LENGTH(starg_guards, space.clear_count),
     .limit = offsetof(starg_guards, face_count),
     .help = "Faces of the model that block no view and need not be seen, ascending."},
    {.key = "obstacles",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(obstacles),
     .of = &OBSTACLES_TABLE,
     LENGTH(starg_guards, obstacle_count),
     .help = "What stands in the way and need not be seen."},
    {.key = "zones",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(zones),
     .of = &ZONES_TABLE,
     LENGTH(starg_guards, zone_count),
     .help = "Guards stand in one of those that do not exclude, if there are any, and in none of "
             "the others; within is then a box that holds the first."},
    {.key = "needs",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(needs),
     .of = &NEEDS_TABLE,
     LENGTH(starg_guards, need_count),
     .help =
         "Faces that need more or less than others, ascending: by how many guards each must be "
         "seen (0: as others), and with how many pixels for each unit of length, or the name of "
         "such a density (0: as others)."},
    {.key = "targets",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     .of = &TARGETS_TABLE,
     LENGTH(starg_guards, target_count),
     .help = "The faces to be seen, ascending, each with how much its area counts; absent if all "
             "count alike. Fractions of faces are of these, those of the area of their weighted "
             "area."},
};
static const starg_fields SCENE_TABLE = {.name = "scene", FIELD_ROWS(SCENE)};

/* ---- the file ---- */

static const starg_field FILE_ROWS[] = {
    {.key = "format", .kind = STARG_FIELD_CONSTANT, .value = "starguard-guards"},
    {.key = "version", .kind = STARG_FIELD_CONSTANT, .initial = 1},
    {.key = "model", .kind = STARG_FIELD_RECORD, .of = &MODEL_TABLE, .help = "The model."},
    {.key = "options",
     .kind = STARG_FIELD_RECORD,
     .offset = offsetof(starg_guards, options),
     .of = &OPTIONS_TABLE,
     .help = "The options used."},
    {.key = "seed",
     .kind = STARG_FIELD_COUNT,
     USUALLY_NOT,
     RESULT(seed),
     .most = UINT64_MAX,
     .initial = 1,
     .help = "The seed of random numbers, absent if 1; above 2^63 - 1 its digits as a text."},
    {.key = "scene",
     .kind = STARG_FIELD_RECORD,
     USUALLY_NOT,
     .of = &SCENE_TABLE,
     .help =
         "Where guards may stand, what is in the way and what is to be seen, if that is not all "
         "as usual."},
    {.key = "guards",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_LINES,
     .of = &GUARDS_TABLE,
     LENGTH(starg_guards, count),
     .help = "The guards."},
    {.key = "levels",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(level_list),
     .of = &LEVELS_TABLE,
     LENGTH(starg_guards, level_count),
     .help = "With method pilp: the levels of detail before refinement, coarsest first."},
    {.key = "tour",
     .kind = STARG_FIELD_RECORD,
     .of = &TOUR_TABLE,
     .applies = has_tour,
     .help = "With order: a short way through the guards."},
    {.key = "coverage", .kind = STARG_FIELD_RECORD, .of = &COVERAGE_TABLE, .help = "The coverage."},
    {.key = "search",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_OPTIONAL,
     .of = &STEPS_TABLE,
     LENGTH(starg_guards, step_count),
     .help = "Numbers of guards that the search had found after so much work, in about "
             "microseconds; it began with the first of them."},
    {.key = "candidates",
     .kind = STARG_FIELD_COUNT,
     RESULT(candidate_count),
     .most = UINT32_MAX,
     .help = "Number of candidates, including those added for uncovered faces."},
    {.key = "lower_bound",
     .kind = STARG_FIELD_COUNT,
     RESULT(lower_bound),
     .most = UINT32_MAX,
     .help = "Proven lower bound of these candidates: no fewer of them cover as much. In files of "
             "morph --guards: "
             "no fewer pairs of candidates cover what some pair sees in both shapes."},
    {.key = "optimal",
     .kind = STARG_FIELD_FLAG,
     RESULT(optimal),
     .help = "The number of guards equals lower_bound: no fewer of these candidates do."},
    {.key = "lower_bound_everywhere",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(lower_bound_everywhere),
     .least = 1,
     .most = UINT32_MAX,
     .help = "No fewer guards cover as much, wherever they stand; absent if this was not sought."},
    {.key = "optimal_everywhere",
     .kind = STARG_FIELD_FLAG,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(optimal_everywhere),
     .applies = is_bounded_everywhere,
     .help = "The number of guards equals lower_bound_everywhere."},
    {.key = "time_limited",
     .kind = STARG_FIELD_FLAG,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(time_limited),
     .help = "The time limit stopped the search."},
};
const starg_fields guards_file_fields = {
    .name = "guards file", .size = sizeof(starg_guards), FIELD_ROWS(FILE_ROWS)};
