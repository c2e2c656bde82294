/* SPDX-License-Identifier: Apache-2.0 */
/* Field table of DESCRIPTOR.json (starguard/fields.h): names, ranges and meaning of its keys, in
 * the order of the file. */
#include "shape/measures.h"

#include <float.h>

#define RESULT(NAME) FIELD_MEMBER(starg_descriptor, NAME)
#define LENGTH(NAME) .length = offsetof(starg_descriptor, NAME)
#define EDGE(NAME)   FIELD_MEMBER(starg_descriptor_edge, NAME)
/* A member of the guard structs. */
#define GUARD(NAME)                                                                                \
    .offset = offsetof(starg_descriptor, guards), .stride = sizeof(starg_descriptor_guard),        \
    .within = offsetof(starg_descriptor_guard, NAME),                                              \
    .size = sizeof(((starg_descriptor_guard *)0)->NAME)

/* Above any distance in a model. */
#define FARTHEST 4e100

static const starg_field MODEL[] = {
    {.key = "file",
     .kind = STARG_FIELD_TEXT,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(file),
     .help = "The model's path as given."},
    {.key = "vertices",
     .kind = STARG_FIELD_COUNT,
     RESULT(model_vertices),
     .most = STARG_MESH_LIMIT},
    {.key = "faces", .kind = STARG_FIELD_COUNT, RESULT(model_faces), .most = STARG_MESH_LIMIT},
    {.key = "diagonal",
     .kind = STARG_FIELD_REAL,
     RESULT(diagonal),
     .high = DBL_MAX,
     .help = "Of the model's bounding box."},
};
static const starg_fields MODEL_TABLE = {.name = "model", FIELD_ROWS(MODEL)};

static const starg_field GUARDS[] = {
    {.key = "position", .kind = STARG_FIELD_POINT, GUARD(position)},
    {.key = "volume",
     .kind = STARG_FIELD_REAL,
     GUARD(volume),
     .high = DBL_MAX,
     .help = "Volume of its piece."},
    {.key = "distances",
     .kind = STARG_FIELD_NUMBERS,
     .flags = STARG_FIELD_COUNTED,
     RESULT(distances),
     LENGTH(direction_count),
     .high = FARTHEST,
     .help = "Distances to the boundary, one per direction."},
};
static const starg_fields GUARDS_TABLE = {.columns = true, .name = "guards", FIELD_ROWS(GUARDS)};

static const starg_field ENDS[] = {
    {.key = "first", .kind = STARG_FIELD_COUNT, EDGE(first), .most = UINT32_MAX},
    {.key = "second", .kind = STARG_FIELD_COUNT, EDGE(second), .most = UINT32_MAX},
};
static const starg_fields ENDS_TABLE = {
    .name = "guards", .form = STARG_FORM_TUPLE, FIELD_ROWS(ENDS)};

static const starg_field EDGES[] = {
    {.key = "guards", .kind = STARG_FIELD_RECORD, .of = &ENDS_TABLE, .help = "Ascending."},
    {.key = "area",
     .kind = STARG_FIELD_REAL,
     EDGE(area),
     .high = DBL_MAX,
     .help = "Area of the faces that their pieces share."},
    {.key = "gate", .kind = STARG_FIELD_POINT, EDGE(gate), .help = "Centroid of these faces."},
};
static const starg_fields EDGES_TABLE = {
    .name = "edges", .size = sizeof(starg_descriptor_edge), FIELD_ROWS(EDGES)};

static const starg_field FILE_ROWS[] = {
    {.key = "format", .kind = STARG_FIELD_CONSTANT, .value = "starguard-descriptor"},
    {.key = "version",
     .kind = STARG_FIELD_CONSTANT,
     .initial = DESCRIPTOR_VERSION,
     .least = 3,
     .help = "3 and 4 are read with a warning: their numbers are of another level of detail. Files "
             "of version 3 also have the unused key solid_spectrum."},
    {.key = "model", .kind = STARG_FIELD_RECORD, .of = &MODEL_TABLE},
    {.key = "detail",
     .kind = STARG_FIELD_COUNT,
     RESULT(detail),
     .most = STARG_MESH_LIMIT,
     .help = "Number of vertices after simplification; 0: not simplified."},
    {.key = "effort",
     .kind = STARG_FIELD_COUNT,
     RESULT(effort),
     .most = INT64_MAX,
     .help = "Trials of the decomposition."},
    {.key = "time_limited",
     .kind = STARG_FIELD_FLAG,
     .flags = STARG_FIELD_OPTIONAL,
     RESULT(time_limited),
     .help = "The time limit stopped the search."},
    {.key = "directions",
     .kind = STARG_FIELD_COUNT,
     RESULT(direction_count),
     .most = UINT32_MAX,
     .help = "Ray directions of each guard (docs/formats.md)."},
    {.key = "views",
     .kind = STARG_FIELD_NUMBERS,
     RESULT(views),
     .length = STARG_DESCRIPTOR_VIEW * STARG_DESCRIPTOR_SPREAD,
     .high = DBL_MAX,
     .help = "Row by row: quantiles, over points of the solid, of quantiles of a point's distances "
             "to the boundary."},
    {.key = "surface_spectrum",
     .kind = STARG_FIELD_NUMBERS,
     RESULT(surface_spectrum),
     .length = STARG_DESCRIPTOR_EIGENVALUES,
     .high = DBL_MAX,
     .help = "Smallest nonzero eigenvalues of the Laplace-Beltrami operator of the boundary, times "
             "its area."},
    {.key = "waves",
     .kind = STARG_FIELD_NUMBERS,
     RESULT(wave_kernel),
     .length = STARG_DESCRIPTOR_ENERGIES * STARG_DESCRIPTOR_SPREAD,
     .high = DBL_MAX,
     .help = "Row by row: quantiles of the wave kernel signature over the surface."},
    {.key = "guards",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_LINES,
     .of = &GUARDS_TABLE,
     LENGTH(guard_count),
     .least = 1},
    {.key = "edges",
     .kind = STARG_FIELD_LIST,
     .flags = STARG_FIELD_LINES,
     RESULT(edges),
     .of = &EDGES_TABLE,
     LENGTH(edge_count),
     .help = "Pairs of guards whose pieces share faces, ascending."},
};
const starg_fields descriptor_file_fields = {
    .name = "descriptor file", .size = sizeof(starg_descriptor), FIELD_ROWS(FILE_ROWS)};
