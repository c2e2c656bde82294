/* SPDX-License-Identifier: Apache-2.0 */
/* Contents of a page, read from result files of any kind, which are recognized by content. */
#pragma once

#include "database.h"
#include "starguard/page.h"

typedef struct cli_show {
    starg_page page; /* refers to the members below */
    const char *guards_file, *pieces_file, *report_file;
    char *model_file; /* as it was opened */
    starg_tetmesh *tetmesh;
    starg_mesh *model, *obstacles, **frames;
    starg_solid *solid;
    starg_bits *seen;
    starg_mesh *patches; /* in which guards see the model; NULL: its faces */
    starg_guards shown;  /* the guards, with patches for faces */
    uint32_t *uncovered;
    starg_certificate_outline *proof;
    starg_result **results;             /* one per operand, or NULL */
    starg_skeleton *skeleton, measured; /* as read; with radii */
    double *radii;
    starg_guards *ends[2]; /* of a morph */
    bool from_animation;   /* frames come from starg_animation_read */
    size_t frame_count;
    char *command, *pieces_command, *table_command; /* that make the results again */
    char *title;     /* of a morph that tells its shapes; else NULL */
    cli_table table; /* of a database */
    double *distances;
    starg_page_shape *shapes;
    uint8_t **pictures; /* of shapes, where available */
    char **names;       /* of shapes, as in a table of text */
    size_t shape_count;
} cli_show;

/* Reads all operands and the model: `model`, the operand that is one, or the one that results name.
 * `distance` is an index of cli_distance_words, for databases. Must be freed on failure too. */
starg_status cli_show_read(cli_session *session, const char *model, int distance, cli_show *show);
void cli_show_free(cli_session *session, cli_show *show);

/* Parts of cli_show_read. */
starg_status cli_show_frames(cli_session *session, const char *folder, cli_show *show);
starg_status cli_show_table(cli_session *session, const char *file, cli_show *show);
starg_status cli_show_database(cli_session *session, const char *file, int distance,
                               cli_show *show);
void cli_show_free_shapes(cli_session *session, cli_show *show);
