/* SPDX-License-Identifier: Apache-2.0 */
/* The catalogue of samples and their generators. */
#include <math.h>

#include "core/fields.h"
#include "sample/solids.h"
#include "starguard/sample.h"

static const char STAGE[] = "sample";

/* Poses of solids that have no joints: all of space is bent or twisted.
 *
 * Coordinates are taken about the middle of the box, in halves of its longest side. Both maps are
 * bijections of space that keep volumes, so a solid stays one, of the same genus, as long as its
 * faces are small against the bend. Cost: O(n). */

enum { BENT = 1 }; /* SOLID_BENDS - 1 is twisted; 0 is as made */

static const double BEND = 0.35;
static const double TWIST = 0.7; /* radians at the ends of x */

/* y rises with the square of x. */
static void bend(double p[3]) {
    p[1] += BEND * p[0] * p[0];
}

/* Turns about the x axis, in proportion to x. */
static void twist(double p[3]) {
    double c = cos(TWIST * p[0]), s = sin(TWIST * p[0]), y = p[1];
    p[1] = c * y - s * p[2];
    p[2] = s * y + c * p[2];
}

static void solid_bend(starg_mesh *mesh, int pose) {
    double lower[3], upper[3], half = 0;
    if (pose == 0)
        return;
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        half = fmax(half, 0.5 * (upper[k] - lower[k]));
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double *place = mesh->vertices + 3 * v, p[3];
        for (int k = 0; k < 3; k++)
            p[k] = (place[k] - 0.5 * (lower[k] + upper[k])) / half;
        if (pose == BENT)
            bend(p);
        else
            twist(p);
        for (int k = 0; k < 3; k++)
            place[k] = 0.5 * (lower[k] + upper[k]) + half * p[k];
    }
}

enum { MIN_VERTICES = 20, MIN_SMOOTH = 500, MAX_VERTICES = 10000000 };

typedef starg_status make_solid(starg_context *context, size_t vertex_count, starg_mesh **out);

typedef enum origin { FIGURE, WARE, BLOCKS, RIGID } origin;

typedef struct entry {
    starg_sample_info info;
    origin origin;
    int kind;         /* figure_kind, ware_kind or blocks_kind */
    make_solid *make; /* if RIGID */
} entry;

static const entry CATALOGUE[] = {
    {{"horse", "a horse", FIGURE_POSES, false}, FIGURE, FIGURE_HORSE, NULL},
    {{"dog", "a dog with hanging ears", FIGURE_POSES, false}, FIGURE, FIGURE_DOG, NULL},
    {{"cat", "a cat", FIGURE_POSES, false}, FIGURE, FIGURE_CAT, NULL},
    {{"giraffe", "a giraffe", FIGURE_POSES, false}, FIGURE, FIGURE_GIRAFFE, NULL},
    {{"dinosaur", "a dinosaur on two legs", FIGURE_POSES, false}, FIGURE, FIGURE_DINOSAUR, NULL},
    {{"bird", "a bird with spread wings", FIGURE_POSES, false}, FIGURE, FIGURE_BIRD, NULL},
    {{"human", "a person", FIGURE_POSES, false}, FIGURE, FIGURE_HUMAN, NULL},
    {{"octopus", "an octopus", FIGURE_POSES, false}, FIGURE, FIGURE_OCTOPUS, NULL},
    {{"vase", "a vase, with or without handles", WARE_MEMBERS, false}, WARE, WARE_VASE, NULL},
    {{"bust", "a bust on its foot", WARE_MEMBERS, false}, WARE, WARE_BUST, NULL},
    {{"bearing", "a bearing with screw holes", WARE_MEMBERS, false}, WARE, WARE_BEARING, NULL},
    {{"table", "a table on legs or a pillar", WARE_MEMBERS, false}, WARE, WARE_TABLE, NULL},
    {{"tool", "a spanner", WARE_MEMBERS, false}, WARE, WARE_TOOL, NULL},
    {{"polycube", "cubes, grown at random", BLOCKS_MEMBERS, false}, BLOCKS, BLOCKS_POLYCUBE, NULL},
    {{"maze", "a tree of corridors", BLOCKS_MEMBERS, false}, BLOCKS, BLOCKS_MAZE, NULL},
    {{"comb", "a slab with teeth of random lengths", BLOCKS_MEMBERS, false},
     BLOCKS,
     BLOCKS_COMB,
     NULL},
    {{"spikes", "a room with spikes in its walls", BLOCKS_MEMBERS, false},
     BLOCKS,
     BLOCKS_SPIKES,
     NULL},
    {{"l-room", "an L-shaped room", 1, false}, RIGID, 0, solid_l_room},
    {{"gallery", "a hall with niches and eight round columns", 1, false}, RIGID, 0, solid_gallery},
    {{"labyrinth", "a corridor wound into a spiral", 1, false}, RIGID, 0, solid_labyrinth},
    {{"plate", "a plate with six round holes", 1, false}, RIGID, 0, solid_plate},
    {{"eight", "a plate with two round holes", SOLID_BENDS, false}, RIGID, 0, solid_eight},
    {{"knot", "a tube tied into a trefoil knot", 1, false}, RIGID, 0, solid_knot},
    {{"torus", "a torus", SOLID_BENDS, false}, RIGID, 0, solid_torus},
    {{"star", "an icosahedron with a spike on every face", 1, false}, RIGID, 0, solid_star},
    {{"shell", "a ball with a ball-shaped cavity", 1, false}, RIGID, 0, solid_shell},
    {{"sphere", "a ball", 1, false}, RIGID, 0, solid_sphere},
    {{"office", "an office building with furniture (--orientation keep)", 1, true},
     RIGID,
     0,
     solid_office},
    {{"level", "a level of a game, open triangles (--soup)", 1, true}, RIGID, 0, solid_level},
    {{"statue", "a person on a plinth, to be seen from outside", 1, true}, RIGID, 0, solid_statue},
};

enum { COUNT = sizeof CATALOGUE / sizeof *CATALOGUE };

size_t starg_sample_count(void) {
    return COUNT;
}

const starg_sample_info *starg_sample_at(size_t index) {
    return index < COUNT ? &CATALOGUE[index].info : NULL;
}

static const starg_field OPTIONS[] = {
    {.key = "pose",
     .option = "pose",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_sample_options, pose),
     .most = 1000,
     .value = "K",
     .help = "Pose of an animal (all have the same faces), or member of a family such as vases or "
             "mazes."},
    {.key = "vertex_count",
     .option = "vertices",
     .kind = STARG_FIELD_COUNT,
     FIELD_MEMBER(starg_sample_options, vertex_count),
     .least = MIN_VERTICES,
     .most = MAX_VERTICES,
     .initial = 5000,
     .value = "N",
     .help = "Approximate number of vertices."},
};
static const starg_fields OPTIONS_TABLE = {
    .name = "sample options", .size = sizeof(starg_sample_options), FIELD_ROWS(OPTIONS)};
OPTIONS_BY(OPTIONS_TABLE, starg_sample_options)

static const entry *find_entry(const char *name) {
    for (size_t i = 0; i < COUNT; i++)
        if (strcmp(CATALOGUE[i].info.name, name) == 0)
            return &CATALOGUE[i];
    return NULL;
}

starg_status starg_sample_create(starg_context *context, const char *name,
                                 const starg_sample_options *options, starg_mesh **out) {
    *out = NULL;
    starg_sample_options defaults;
    starg_sample_options_default(&defaults);
    const starg_sample_options *o = options ? options : &defaults;
    const entry *e = find_entry(name);
    if (e == NULL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "unknown sample '%s'; see the list of samples", name);
    if (o->pose < 0 || o->pose >= e->info.poses)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "'%s' has no pose %d; its poses are 0 to %d", name, o->pose,
                          e->info.poses - 1);
    starg_status status = fields_check(context, STAGE, &OPTIONS_TABLE, o);
    if (status == STARG_OK && e->origin != BLOCKS && o->vertex_count < MIN_SMOOTH)
        status =
            starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                       "'%s' has at least %d vertices, not %zu; solids of cubes may have fewer",
                       name, MIN_SMOOTH, o->vertex_count);
    if (status == STARG_OK)
        status = starg_check_cancel(context, STAGE);
    if (status != STARG_OK)
        return status;
    if (e->origin == FIGURE)
        return solid_figure(context, (figure_kind)e->kind, o->pose, o->vertex_count, out);
    if (e->origin == WARE)
        return solid_ware(context, (ware_kind)e->kind, o->pose, o->vertex_count, out);
    if (e->origin == BLOCKS)
        return solid_blocks(context, (blocks_kind)e->kind, o->pose, o->vertex_count, out);
    status = e->make(context, o->vertex_count, out);
    if (status == STARG_OK)
        solid_bend(*out, o->pose);
    return status;
}
