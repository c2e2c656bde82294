/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes as commands take them (starguard/space.h), and tables of what guards see there. */
#pragma once

#include "session.h"
#include "starguard/guard.h"

/* ---- obstacles, outsides, targets (scene.c) ---- */

typedef struct cli_scene {
    starg_texts obstacles;
    starg_orientation orientation;
    bool outside, soup, two_sided;
    double cell;
    starg_places from;
    starg_places standoff;
    starg_texts within, without;          /* boxes, or files of meshes */
    const char **zone_files;              /* by zone: those of its mesh; borrowed */
    starg_texts see, ignore, over, mount; /* unions */
    starg_texts clear;                    /* union */
    starg_texts require;                  /* FACES=K[,DENSITY] */
    const char *weights;
    double height;
    double clearance;  /* of guards from where they are mounted, and what is up: from the other */
    double up[3];      /* options of `guard` */
    char *recalled[6]; /* texts above that cli_scene_recall made */
} cli_scene;

extern const char *const cli_orientation_words[];

/* Rows for a struct `values` with a member `scene`. */
#define CLI_SCENE_OPTIONS                                                                          \
    CLI_INPUTS_OPTION("obstacles", scene.obstacles, "FILE",                                        \
                      "Mesh that stands in the way. A closed one is solid: no guard stands in "    \
                      "it; an open one blocks the view. Its faces need not be seen. Repeatable.",  \
                      .group = "places", .brief = "a mesh that stands in the way"),                \
        {CLI_OPTION("orientation", STARG_FIELD_CHOICE, scene.orientation, "nested|keep",           \
                    "Shells bound matter and cavities by their nesting, or as their faces are "    \
                    "turned, also where they touch or overlap.",                                   \
                    .group = "places"),                                                            \
         .words = cli_orientation_words},                                                          \
        {CLI_OPTION("outside", STARG_FIELD_FLAG, scene.outside, NULL,                              \
                    "See the model from outside.", .group = "places",                              \
                    .brief = "look from outside (with --standoff)")},                              \
        {CLI_OPTION("soup", STARG_FIELD_FLAG, scene.soup, NULL,                                    \
                    "The model is any triangles, closed or not: each blocks the view, and is "     \
                    "seen from its front, where its corners turn counter-clockwise.",              \
                    .group = "places",                                                             \
                    .brief = "any triangles, closed or not (--from, --within)")},                  \
        {CLI_OPTION("two-sided", STARG_FIELD_FLAG, scene.two_sided, NULL,                          \
                    "--soup: faces are seen from either side.", .group = "targets")},              \
        CLI_INPUTS_OPTION(                                                                         \
            "see", scene.see, "FACES",                                                             \
            "Only these faces need to be seen: a text file of face numbers, from 0; numbers, "     \
            "such as 0-11,40; or names in the model, with commas between them: of groups, "        \
            "objects or materials (OBJ), or of properties of faces (PLY) that are not 0 there, "   \
            "or have a value: NAME=VALUE. * in a name stands for any characters, ? for one. "      \
            "Repeatable: all of them.",                                                            \
            .group = "targets", .brief = "only these faces: numbers, names of groups, a file"),    \
        CLI_INPUTS_OPTION("ignore", scene.ignore, "FACES",                                         \
                          "All faces but these need to be seen. Repeatable.", .group = "targets"), \
        CLI_INPUTS_OPTION("clear", scene.clear, "FACES",                                           \
                          "These faces block no view, as glass, water or fences, and need not be " \
                          "seen; faces as with --see. Repeatable.",                                \
                          .group = "targets"),                                                     \
        CLI_INPUT_OPTION("weights", scene.weights, "FILE|PROPERTY",                                \
                         "How much each face matters: a number for each face of the model in a "   \
                         "text file, or a property of its faces (PLY). Its area counts so many "   \
                         "times; 0: need not be seen.",                                            \
                         .group = "targets")

/* Where guards may stand. */
#define CLI_LIMIT_OPTIONS                                                                          \
    {CLI_OPTION("standoff", STARG_FIELD_PLACES, scene.standoff, "MIN,MAX",                         \
                "Guards keep these distances from the model.", .group = "places",                  \
                .brief = "distances of guards from the model"),                                    \
     .length = 2, .flags = STARG_FIELD_ONCE},                                                      \
        CLI_INPUTS_OPTION("within", scene.within, "X0,Y0,Z0,X1,Y1,Z1|MESH",                        \
                          "Guards stand in this box, or closed mesh, which blocks no view. "       \
                          "Repeatable: in one of them.",                                           \
                          .group = "places", .brief = "only in this box, or closed mesh"),         \
        CLI_INPUTS_OPTION("without", scene.without, "X0,Y0,Z0,X1,Y1,Z1|MESH",                      \
                          "Guards do not stand in this box, or closed mesh, which blocks no "      \
                          "view. Repeatable: in none of them.",                                    \
                          .group = "places"),                                                      \
        CLI_POSITIVE_OPTION("cell", scene.cell, "D", 1e100, 0, "a hundredth of the diagonal",      \
                            "--from: size of the cubes.", .group = "places")

/* The same for `guard`, which does not look from points. */
#define CLI_PLACE_OPTIONS                                                                          \
    CLI_LIMIT_OPTIONS,                                                                             \
        CLI_INPUTS_OPTION("over", scene.over, "FACES",                                             \
                          "Guards stand straight above one of these faces, as floors, at most "    \
                          "--height high; faces as with --see. What is up says --up.",             \
                          .group = "places"),                                                      \
        CLI_POSITIVE_OPTION("height", scene.height, "H", 1e100, 0, NULL,                           \
                            "--over: how high above them guards may stand.", .group = "places"),   \
        CLI_INPUTS_OPTION("mount", scene.mount, "FACES",                                           \
                          "Guards hang at the distance --clearance from these faces only, as "     \
                          "ceilings and masts; faces as with --see.",                              \
                          .group = "places",                                                       \
                          .brief = "hung from these faces, --clearance D below"),                  \
    {                                                                                              \
        CLI_OPTION("from", STARG_FIELD_PLACES, scene.from, "X,Y,Z",                                \
                   "Guards stand where one gets from this point through cubes that no face "       \
                   "meets; their size is that of --cell.",                                         \
                   .group = "places"),                                                             \
            .length = 3, .flags = STARG_FIELD_ONCE                                                 \
    }

/* Names the files that it reads. */
starg_status cli_scene_prepare(cli_session *session, const cli_scene *scene);

/* The options that ask for the scene of a result. Files that it does not tell become words in
 * capitals. Free with cli_scene_forget. Errors: MEMORY. */
starg_status cli_scene_recall(cli_session *session, const starg_guards *guards, cli_scene *scene);
void cli_scene_forget(cli_scene *scene);

/* Makes session->solid of session->mesh, which is given back. */
starg_status cli_scene_make(cli_session *session, cli_scene *scene);
void cli_scene_release(cli_scene *scene);

/* Reads the obstacles of a result, which names their files. */
starg_status cli_scene_read_obstacles(cli_session *session, const starg_guards *guards,
                                      starg_mesh ***obstacles);

/* The same of zones; NULL for those that are boxes. */
starg_status cli_scene_read_zones(cli_session *session, const starg_guards *guards,
                                  starg_mesh ***zones);

/* All obstacles in one mesh; NULL: there are none. */
starg_status cli_scene_join(cli_session *session, starg_mesh *const *obstacles, size_t count,
                            starg_mesh **out);
void cli_scene_free_obstacles(starg_mesh **obstacles, size_t count);

/* ---- tables of what guards see, of the commands that have guards (tables.c) ---- */

typedef struct cli_tables {
    const char *table, *summary;
} cli_tables;

/* Rows for a struct `values` with a member `tables`. */
#define CLI_TABLE_OPTIONS                                                                          \
    CLI_TEXT_OPTION("table", tables.table, "FILE.csv",                                             \
                    "A row for each face: its group, area, seen share, how many cameras see some " \
                    "of it and each part of it at least, and which.",                              \
                    .group = "output"),                                                            \
        CLI_TEXT_OPTION("summary", tables.summary, "FILE.csv",                                     \
                        "A row for each camera: the area that it sees, and that it alone sees, "   \
                        "and its mean density of pixels; and for each group of faces: the shares " \
                        "of its area that at least 1, 2 and 3 cameras see.",                       \
                        .group = "output")

static inline bool cli_tables_wanted(const cli_tables *tables) {
    return tables->table != NULL || tables->summary != NULL;
}

/* Announces them. */
starg_status cli_tables_announce(cli_session *session, const cli_tables *tables);

/* The groups of faces of a model by its file; none of standard input, or of another number of
 * faces. Free with cli_groups_free. */
starg_status cli_groups_read(cli_session *session, const char *model, size_t faces,
                             starg_face_groups *groups, bool *any);
static inline void cli_groups_free(starg_face_groups *groups) {
    starg_face_groups_free(NULL, groups);
}

/* Writes them, of the session's solid; groups of faces are those of the first operand. */
starg_status cli_tables_write(cli_session *session, const cli_tables *tables,
                              const starg_guards *guards);
