/* SPDX-License-Identifier: Apache-2.0 */
/* PIECES.json as a table (starguard/fields.h): the one place that says what its keys are called,
 * may hold and mean. Rows are in the order of the file. */
#include <float.h>

#include "star/decomposition.h"

#define RESULT(NAME)  FIELD_MEMBER(starg_decomposition, NAME)
#define LENGTH(NAME)  .length = offsetof(starg_decomposition, NAME)
#define PIECE(NAME)   FIELD_MEMBER(starg_piece, NAME)
#define CONTACT(NAME) FIELD_MEMBER(starg_piece_contact, NAME)

const char *const decompose_mode_words[] = {"strict", "paper", NULL};
const char *const decompose_ball_words[] = {"none", "rays", "even", NULL};
static const char *const SURFACES[] = {"approximated", "kept", NULL}; /* by surface_kept */

static const starg_decomposition *of(const void *record) {
    return record;
}

/* The model is a surface, or tetrahedra: what is written, and of what is read what has come. */
static bool is_surface(const void *record) {
    return of(record)->model_tetrahedra == 0;
}

static bool is_solid(const void *record) {
    return of(record)->model_faces == 0;
}

static bool is_approximated(const void *record) {
    return !of(record)->tetra.surface_kept;
}

static bool is_told(const void *record) {
    return of(record)->options_known;
}

static bool is_bounded(const void *record) {
    return of(record)->lower_bound > 0;
}

static const starg_field MODEL[] = {
    {.key = "file",
     .kind = STARG_FIELD_TEXT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(file),
     .help = "The model's path as given."},
    {.key = "vertices", .kind = STARG_FIELD_COUNT, RESULT(model_vertices), .most = UINT32_MAX},
    {.key = "faces",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(model_faces),
     .applies = is_surface,
     .least = 1,
     .most = UINT32_MAX,
     .help = "Number of faces of a surface model."},
    {.key = "tetrahedra",
     .kind = STARG_FIELD_COUNT,
     RESULT(model_tetrahedra),
     .applies = is_solid,
     .least = 1,
     .most = UINT32_MAX,
     .help = "Number of tetrahedra of a tetrahedral model."},
};
static const starg_fields MODEL_TABLE = {.name = "model", FIELD_ROWS(MODEL)};

static const starg_field PIECES[] = {
    {.key = "guard", .kind = STARG_FIELD_POINT, PIECE(guard), .help = "Sees the whole piece."},
    {.key = "tetrahedra",
     .kind = STARG_FIELD_COUNT,
     PIECE(tetrahedra),
     .least = 1,
     .most = UINT32_MAX,
     .help = "Number of tetrahedra with the label of the piece."},
    {.key = "volume",
     .kind = STARG_FIELD_REAL,
     PIECE(volume),
     .low = -DBL_MAX,
     .high = DBL_MAX,
     .help = "In cubic model units; rounded."},
    {.key = "star",
     .kind = STARG_FIELD_FLAG,
     PIECE(star),
     .help = "Proven: the guard is strictly on the inner side of each face of the piece."},
    {.key = "radius",
     .kind = STARG_FIELD_REAL,
     PIECE(radius),
     .low = -DBL_MAX,
     .high = DBL_MAX,
     .help = "Distance from the guard to the nearest face plane, negative behind it; rounded."},
    {.key = "margin",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     PIECE(margin),
     .low = -DBL_MAX,
     .high = DBL_MAX,
     .standard = -DBL_MAX,
     .help = "radius by the diagonal of the piece's bounding box."},
    {.key = "spread",
     .kind = STARG_FIELD_FLAG,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     PIECE(spread),
     .help = "The piece's map to a ball does not follow the rays from its guard."},
};
static const starg_fields PIECES_TABLE = {
    .name = "pieces", .size = sizeof(starg_piece), FIELD_ROWS(PIECES)};

static const starg_field CONTACTS[] = {
    {.key = "first", .kind = STARG_FIELD_COUNT, CONTACT(first), .most = INT32_MAX},
    {.key = "second", .kind = STARG_FIELD_COUNT, CONTACT(second), .most = INT32_MAX},
    {.key = "area", .kind = STARG_FIELD_REAL, CONTACT(area), .high = DBL_MAX},
};
static const starg_fields CONTACTS_TABLE = {.name = "adjacency",
                                            .size = sizeof(starg_piece_contact),
                                            .form = STARG_FORM_TUPLE,
                                            FIELD_ROWS(CONTACTS)};

static const starg_field BALLS[] = {
    {.key = "kind",
     .kind = STARG_FIELD_CHOICE,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     RESULT(balls),
     .words = decompose_ball_words,
     .help = "`rays`: along the rays from the guards; `even`: with less distortion."},
    {.key = "worst",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     RESULT(ball_worst),
     .high = DBL_MAX,
     .help = "Largest over smallest singular value of the map: the most of any tetrahedron."},
    {.key = "mean",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     RESULT(ball_mean),
     .high = DBL_MAX,
     .help = "Its mean, weighted by volume."},
    {.key = "above_10",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     RESULT(ball_above_10),
     .high = 1,
     .help = "Share of the volume where it is above 10."},
};
static const starg_fields BALLS_TABLE = {.name = "balls", FIELD_ROWS(BALLS)};

static const starg_field FILE_ROWS[] = {
    {.key = "format", .kind = STARG_FIELD_CONSTANT, .value = "starguard-pieces"},
    {.key = "version", .kind = STARG_FIELD_CONSTANT, .initial = 1},
    {.key = "model", .kind = STARG_FIELD_RECORD, .of = &MODEL_TABLE},
    {.key = "options",
     .kind = STARG_FIELD_RECORD,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(options),
     .of = &decompose_file_options,
     .applies = is_told,
     .help = "The options used."},
    {.key = "seed",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     RESULT(seed),
     .applies = is_told,
     .most = UINT64_MAX,
     .initial = 1,
     .help = "The seed of random numbers, absent if 1; above 2^63 - 1 its digits as a text."},
    {.key = "guards_given",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     RESULT(options.guard_count),
     .applies = is_told,
     .most = UINT32_MAX,
     .help = "Number of initial guards that were given; absent if none were."},
    {.key = "mode", .kind = STARG_FIELD_CHOICE, RESULT(mode), .words = decompose_mode_words},
    {.key = "surface",
     .kind = STARG_FIELD_CHOICE,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(tetra.surface_kept),
     .words = SURFACES,
     .initial = 1,
     .help = "Whether the boundary is the model's surface or only near it."},
    {.key = "distance",
     .kind = STARG_FIELD_REAL,
     RESULT(tetra.distance),
     .applies = is_approximated,
     .high = DBL_MAX,
     .help = "Largest distance from the boundary to the model's surface."},
    {.key = "distance_back",
     .kind = STARG_FIELD_REAL,
     RESULT(tetra.distance_back),
     .applies = is_approximated,
     .high = DBL_MAX,
     .help = "Largest distance from the model's surface to the boundary."},
    {.key = "faces_kept",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(faces_kept),
     .applies = is_approximated,
     .least = 1,
     .most = UINT32_MAX,
     .help =
         "Faces of a model that intersects itself that are in the boundary, possibly subdivided."},
    {.key = "tetrahedra",
     .kind = STARG_FIELD_COUNT,
     RESULT(tetrahedra),
     .least = 1,
     .most = UINT32_MAX,
     .help = "Number of tetrahedra in PIECES.vtk."},
    {.key = "pieces",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_LINES,
     RESULT(pieces),
     .of = &PIECES_TABLE,
     LENGTH(piece_count),
     .least = 1,
     .help = "In the order of their labels."},
    {.key = "strictly_star",
     .kind = STARG_FIELD_COUNT,
     RESULT(strictly_star),
     .most = UINT32_MAX,
     .help = "Number of pieces proven to be star-shaped."},
    {.key = "visible_vertices",
     .kind = STARG_FIELD_REAL,
     RESULT(visible_vertices),
     .high = 1,
     .help = "Fraction of the vertices visible from the guards of their pieces."},
    {.key = "flattest",
     .kind = STARG_FIELD_REAL,
     RESULT(flattest),
     .high = 1,
     .help = "Smallest ratio of height to longest edge of a tetrahedron."},
    {.key = "flattest_given",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(flattest_given),
     .high = 1,
     .standard = -1,
     .help = "The same for the initial tetrahedra, if there were any."},
    {.key = "smallest_angle",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(smallest_angle),
     .high = 180,
     .standard = -1,
     .help = "Smallest dihedral angle of a tetrahedron, in degrees."},
    {.key = "smallest_angle_made",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(smallest_angle_made),
     .high = 180,
     .standard = -1,
     .help = "The same without tetrahedra over whole faces of the model that have an angle as "
             "small; absent where the surface is not kept."},
    {.key = "median_angle",
     .kind = STARG_FIELD_REAL,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(median_angle),
     .high = 180,
     .standard = -1,
     .help = "Median of the smallest dihedral angles of the tetrahedra, in degrees."},
    {.key = "balls",
     .kind = STARG_FIELD_RECORD,
     .flags = STARG_FIELD_OPTIONAL | STARG_FIELD_RARE,
     .of = &BALLS_TABLE,
     .help = "The maps of the pieces to balls; PIECES.vtk holds the images."},
    {.key = "adjacency",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_LINES,
     RESULT(contacts),
     .of = &CONTACTS_TABLE,
     LENGTH(contact_count),
     .help = "Pairs of pieces that share faces, with the shared area; ascending."},
    {.key = "lower_bound",
     .kind = STARG_FIELD_COUNT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(lower_bound),
     .least = 1,
     .most = UINT32_MAX,
     .help = "No fewer star-shaped pieces make up the model, however it is cut; absent if this was "
             "not sought."},
    {.key = "optimal",
     .kind = STARG_FIELD_FLAG,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(optimal),
     .applies = is_bounded,
     .help = "The number of pieces equals lower_bound."},
    {.key = "time_limited",
     .kind = STARG_FIELD_FLAG,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(time_limited),
     .help = "The time limit stopped the search."},
};
const starg_fields decomposition_file_fields = {
    .name = "pieces file", .size = sizeof(starg_decomposition), FIELD_ROWS(FILE_ROWS)};
