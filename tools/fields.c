/* SPDX-License-Identifier: Apache-2.0 */
/* Usage: starguard_fields schemas FOLDER | page FILE.md | keywords FILE.pyi */
#include "fields.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "guard/stages.h"
#include "morph/surface_map.h"
#include "shape/measures.h"
#include "star/decomposition.h"
#include "starguard/starguard.h"

/* ---- all tables: a new table is a new row here ---- */

#define SEARCHED(KEY, HELP)                                                                        \
    {                                                                                              \
        .key = KEY, .kind = STARG_FIELD_COUNT, .flags = STARG_FIELD_OPTIONAL, .least = 1,          \
        .most = INT64_MAX, .help = HELP                                                            \
    }
static const starg_field GUARD_REPORT[] = {
    {.key = "output", .kind = STARG_FIELD_TEXT, .help = "The file that was written."},
    {.key = "unseen_faces",
     .kind = STARG_FIELD_COUNT,
     .most = INT64_MAX,
     .help = "Uncovered faces that, proven, no place sees where guards may stand."},
    {.key = "sight_lines",
     .kind = STARG_FIELD_COUNT,
     .most = INT64_MAX,
     .help = "Tests that refinement made."},
    SEARCHED("cells", "--prove: boxes of the subdivision."),
    SEARCHED("witnesses", "--prove: faces or vertices that the bound is proven for."),
    SEARCHED("work", "--prove: the part of --prove-work that was used."),
};
static const starg_fields GUARD_REPORT_TABLE = {.name = "report", FIELD_ROWS(GUARD_REPORT)};

#define DISTANCE(KEY, HELP)                                                                        \
    { .key = KEY, .kind = STARG_FIELD_REAL, .high = HUGE_VAL, .help = HELP }
static const starg_field RECONSTRUCTION[] = {
    {.key = "points",
     .kind = STARG_FIELD_COUNT,
     .most = INT64_MAX,
     .help = "Of the boundary, that the descriptor holds."},
    {.key = "samples",
     .kind = STARG_FIELD_COUNT,
     .most = INT64_MAX,
     .help = "Random points of the surface."},
    DISTANCE("to_mean", "Distance of the points from the surface, by the diagonal: mean."),
    DISTANCE("to_largest", "The same: largest."),
    DISTANCE("from_mean", "Distance of the samples to the nearest point, by the diagonal: mean."),
    DISTANCE("from_largest", "The same: largest."),
};
static const starg_fields RECONSTRUCTION_TABLE = {.name = "reconstruction",
                                                  FIELD_ROWS(RECONSTRUCTION)};
static const starg_field DECOMPOSE_REPORT[] = {
    {.key = "output", .kind = STARG_FIELD_TEXT, .help = "The file that was written."},
    {.key = "volume",
     .kind = STARG_FIELD_REAL,
     .high = HUGE_VAL,
     .help = "Of all tetrahedra, in cubic model units; rounded."},
    {.key = "single_tetrahedra",
     .kind = STARG_FIELD_COUNT,
     .most = INT64_MAX,
     .help = "Pieces of one tetrahedron."},
    {.key = "contacts",
     .kind = STARG_FIELD_COUNT,
     .most = INT64_MAX,
     .help = "Length of adjacency."},
};
static const starg_fields DECOMPOSE_REPORT_TABLE = {.name = "report", FIELD_ROWS(DECOMPOSE_REPORT)};

static const starg_field DESCRIBE_REPORT[] = {
    {.key = "output", .kind = STARG_FIELD_TEXT, .help = "The file that was written."},
    {.key = "reconstruction",
     .kind = STARG_FIELD_RECORD,
     .of = &RECONSTRUCTION_TABLE,
     .help = "How near what the descriptor holds comes to the surface."},
};
static const starg_fields DESCRIBE_REPORT_TABLE = {.name = "report", FIELD_ROWS(DESCRIBE_REPORT)};

const document documents[] = {
    {"guards", "GUARDS.json", "guard", &guards_file_fields, &GUARD_REPORT_TABLE},
    {"pieces", "PIECES.json", "decompose", &decomposition_file_fields, &DECOMPOSE_REPORT_TABLE},
    {"descriptor", "DESCRIPTOR.json", "describe", &descriptor_file_fields, &DESCRIBE_REPORT_TABLE},
    {"map", "MAP.json", "map", &map_file_fields, NULL},
};
const size_t document_count = sizeof documents / sizeof *documents;

const call calls[] = {
    {"guard", "GuardOptions", starg_guard_options_fields, "candidates"},
    {"visible", "VisibleOptions", starg_visibility_options_fields, NULL},
    {"decompose", "DecomposeOptions", starg_decompose_options_fields, NULL},
    {"tetrahedralize", "TetraOptions", starg_tetra_options_fields, NULL},
    {"skeleton", "SkeletonOptions", starg_skeleton_options_fields, NULL},
    {"repair", "RepairOptions", starg_repair_options_fields, NULL},
    {"sample", "SampleOptions", starg_sample_options_fields, NULL},
    {"describe", "DescribeOptions", starg_descriptor_options_fields, NULL},
    {"morph", "MorphOptions", starg_morph_options_fields, NULL},
    {"map", "SolidMapOptions", starg_solid_map_options_fields, NULL},
};
const size_t call_count = sizeof calls / sizeof *calls;

bool is_required(const starg_field *f) {
    /* A list is present together with the list whose length it has; any other may be missing. So
     * may a number whose default is below its range, and what is not written at its default. */
    bool part = f->kind == STARG_FIELD_LIST || f->kind == STARG_FIELD_RECORD;
    bool unset =
        (f->kind == STARG_FIELD_COUNT && f->initial < f->least) ||
        (f->kind == STARG_FIELD_REAL &&
         (f->standard < f->low || ((f->flags & STARG_FIELD_ABOVE) && f->standard == f->low)));
    bool may_lack = (part || unset || (f->flags & STARG_FIELD_RARE)) &&
                    (f->flags & STARG_FIELD_OPTIONAL) && !(f->flags & STARG_FIELD_MATCHING);
    return f->applies == NULL && !may_lack;
}

bool is_cleared(const starg_field *f) {
    return f->kind == STARG_FIELD_FLAG && f->option != NULL && strncmp(f->option, "no-", 3) == 0;
}

void keyword_name(const starg_field *field, char name[NAME_SIZE]) {
    const char *word = field->option != NULL ? field->option : field->key;
    if (is_cleared(field))
        word += strlen("no-");
    snprintf(name, NAME_SIZE, "%s", word);
    for (char *c = name; *c != '\0'; c++)
        if (*c == '-')
            *c = '_';
}

int main(int argc, char **argv) {
    static const struct {
        const char *word;
        bool (*write)(const char *path);
    } jobs[] = {{"schemas", write_schemas}, {"page", write_page}, {"keywords", write_keywords}};
    for (size_t i = 0; argc == 3 && i < sizeof jobs / sizeof *jobs; i++)
        if (strcmp(argv[1], jobs[i].word) == 0) {
            if (jobs[i].write(argv[2]))
                return EXIT_SUCCESS;
            perror(argv[2]);
            return EXIT_FAILURE;
        }
    fprintf(stderr, "usage: starguard_fields schemas FOLDER | page FILE | keywords FILE\n");
    return EXIT_FAILURE;
}
