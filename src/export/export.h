/* SPDX-License-Identifier: Apache-2.0 */
/* What the writers of pictures, scenes and pages share. */
#pragma once

#include "core/context.h"
#include "core/memory.h"
#include "starguard/scene.h"
#include "starguard/verify.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* ---- little-endian numbers in binary files, on any machine ---- */

static inline void little_put_word(FILE *stream, uint32_t x) {
    uint8_t bytes[4];
    for (int k = 0; k < 4; k++)
        bytes[k] = (uint8_t)(x >> (8 * k));
    fwrite(bytes, 1, sizeof bytes, stream);
}

static inline void little_put_long(FILE *stream, uint64_t x) {
    little_put_word(stream, (uint32_t)x);
    little_put_word(stream, (uint32_t)(x >> 32));
}

static inline void little_put_float(FILE *stream, float x) {
    uint32_t word;
    memcpy(&word, &x, sizeof word);
    little_put_word(stream, word);
}

static inline void little_put_double(FILE *stream, double x) {
    uint64_t word;
    memcpy(&word, &x, sizeof word);
    little_put_long(stream, word);
}

/* ---- an image as a PNG file (png.c) ---- */

/* `rgb` holds height rows of width x 3 bytes, top row first; width and height are 1 to 2^20.
 * Errors: WRITE, MEMORY. */
starg_status starg_png_write(starg_context *context, const char *path, const uint8_t *rgb,
                             size_t width, size_t height);

/* Same into a new block. Errors: MEMORY. */
starg_status starg_png_encode(starg_context *context, const uint8_t *rgb, size_t width,
                              size_t height, uint8_t **png, size_t *size);

/* ---- text in pictures, drawn with strokes of its own (lettering.c) ---- */

typedef struct starg_canvas {
    uint8_t *rgb; /* height rows of width x 3 bytes */
    size_t width, height;
} starg_canvas;

typedef struct starg_lettering {
    double height; /* of capitals, in pixels */
    bool rising;   /* from the bottom to the top instead of from left to right */
    uint8_t ink[3];
    double halo; /* width of a white rim in pixels, or 0 */
} starg_lettering;

/* Length of a text in pixels. Bytes of UTF-8 beyond ASCII make one box per character. */
double starg_lettering_length(const starg_lettering *style, const char *text);

/* Draws a text whose first character begins at (x, y), the middle of its capitals' height at the
 * start. What is outside of the canvas is left out. */
void starg_lettering_draw(const starg_canvas *canvas, const starg_lettering *style,
                          const char *text, double x, double y);

/* ---- corner normals and feature lines of a mesh, for its picture (features.c) ---- */
/* Decoration only: any mesh is accepted. */

typedef STARG_ARRAY(uint32_t) starg_index_array;

typedef struct starg_features {
    float *normals;          /* face_count x 3 corners x 3, unit length */
    starg_index_array lines; /* pairs of vertex indices */
} starg_features;

/* Finds both for `vertices`, of any orthonormal frame. Errors: MEMORY. */
starg_status starg_features_create(starg_context *context, const double *vertices,
                                   size_t vertex_count, const uint32_t *faces, size_t face_count,
                                   starg_features *out);
void starg_features_free(starg_features *features);

/* ---- a projected scene as pixels (raster.c) ---- */

/* Samples per pixel and axis. */
enum { STARG_RASTER_SAMPLES = 3 };

typedef struct starg_raster_ball {
    double center[3];
    uint8_t rgb[3];
} starg_raster_ball;

/* Positions are in samples: x to the right, y down from the upper left corner, z towards the
 * viewer. Directions have y up, so that (x, y, z) is a right-handed frame. */
typedef struct starg_raster_scene {
    size_t width, height; /* pixels */
    const double *positions;
    const uint32_t *faces;
    size_t face_count;
    const float *normals;       /* face_count x 3 corners x 3 */
    const uint8_t *face_colors; /* face_count x 3, or NULL for the neutral colour */
    double opacity;
    const uint32_t *lines; /* line_count x 2 indices into positions */
    size_t line_count;
    double line_radius;
    const starg_raster_ball *balls;
    size_t ball_count;
    double ball_radius;
} starg_raster_scene;

/* Draws into height x width x 3 bytes. Errors: MEMORY, CANCELLED. */
starg_status starg_raster_draw(starg_context *context, const starg_raster_scene *scene,
                               uint8_t *rgb);

/* ---- pictures of a sheet: the plan, what is seen through each lens (sheet_pictures.c) ---- */

struct seen_table; /* guard/stages.h */

/* What is drawn. Faces of `shown` are the patches, columns of the table's rows. */
typedef struct sheet_scene {
    const struct seen_table *table;
    const starg_mesh *shown, *obstacles; /* the latter may be NULL */
    double level[3][3];                  /* right, up, ahead: of the plan, and of pan 0 */
} sheet_scene;

typedef struct sheet_picture {
    uint8_t *png; /* free with starg_release */
    size_t size, width, height;
} sheet_picture;

/* From above: x = origin + scale * (right . p), y likewise downwards, in pixels. */
typedef struct sheet_plan {
    sheet_picture picture;
    double x, y, scale;
} sheet_plan;

/* Faces that look up, below the highest guard, in the colours of how many guards see them. Errors:
 * MEMORY, CANCELLED. */
starg_status sheet_draw_plan(starg_context *context, const sheet_scene *scene, sheet_plan *out);

/* The view of a guard that looks in one direction, as wide as its field of view, or as its cone,
 * but no wider than SHEET_WIDEST degrees. What it sees has its colour. Errors: MEMORY, CANCELLED.
 */
#define SHEET_WIDEST 140.0
starg_status sheet_draw_lens(starg_context *context, const sheet_scene *scene, size_t guard,
                             sheet_picture *out);

/* ---- surfaces of pieces of tetrahedra, for drawing (piece_surfaces.c) ---- */

typedef struct starg_piece_surfaces {
    size_t piece_count;
    size_t *first_face; /* piece_count + 1: the faces of each piece are contiguous */
    uint32_t *faces;    /* three each, outward from the piece; indices into `vertices` */
    size_t vertex_count;
    uint32_t *vertices; /* vertices in use, ascending; indices into those of the tetrahedra */
} starg_piece_surfaces;

/* Errors: ARGUMENT (an index or a label out of range), MEMORY, CANCELLED. */
starg_status starg_piece_surfaces_create(starg_context *context, const starg_pieces_mesh *mesh,
                                         starg_piece_surfaces *out);
void starg_piece_surfaces_free(starg_piece_surfaces *surfaces);

/* ---- scenes: the parts, checked, and what is made of them once (scene.c) ---- */

typedef struct scene_job {
    const starg_scene *scene;
    starg_piece_surfaces surfaces; /* empty without pieces                                      */
    int32_t *viewer;  /* per face of the model: the first guard that sees it, or -1; NULL
                         unless it is known what guards see                          */
    uint8_t *times;   /* per face: how many guards see it, at most SCENE_MOST_TIMES, or
                         SCENE_NOT_WANTED: none has to; NULL like `viewer` */
    double center[3]; /* of the box of all that is shown                                   */
    double size;      /* its largest side; above 0                                          */
    size_t model_vertices, model_faces, guards, nodes, edges; /* 0 where the part is not shown */
    size_t obstacle_vertices, obstacle_faces;
} scene_job;

enum { SCENE_MOST_TIMES = 3, SCENE_NOT_WANTED, SCENE_TIMES }; /* the last: how many values */

enum { SCENE_PARTS = 6 };
typedef enum scene_part {
    SCENE_MODEL,
    SCENE_PIECE,
    SCENE_GUARD,
    SCENE_SKELETON,
    SCENE_VIEW,
    SCENE_OBSTACLE
} scene_part;

extern const uint8_t SCENE_NEUTRAL[3], SCENE_UNSEEN[3], SCENE_CURVE[3], SCENE_IN_THE_WAY[3];

/* The colour of a face of the model: that of the guard that sees it first. */
void scene_face_color(const scene_job *job, size_t face, uint8_t rgb[3]);

/* The colour of what so many guards see, or, of SCENE_NOT_WANTED, of what need not be seen. */
void scene_count_color(size_t times, uint8_t rgb[3]);

/* The vertex of the tetrahedra that is vertex `index` of the surfaces of pieces. */
const double *scene_piece_vertex(const scene_job *job, size_t index);

/* A ball, to be put where a guard is: of radius 1, closed and outward. */
enum { BALL_VERTICES = 38, BALL_FACES = 72 };
typedef struct scene_ball {
    double vertices[3 * BALL_VERTICES];
    uint32_t faces[3 * BALL_FACES];
} scene_ball;
void scene_ball_make(scene_ball *ball);
/* The radius that balls are given. */
double scene_ball_radius(const scene_job *job);

/* Views of guards that look one way (export/scene_view.c): triangles from the guard to a rim. The
 * number of sides of each, 0 where guards look all around; corner 0 is the guard, the others follow
 * around the rim; the corners of a face, counted over all guards, with `sides` + 1 corners each. */
enum { VIEW_FRAME = 4, VIEW_SIDES = 24 };
size_t scene_view_sides(const scene_job *job);
void scene_view_corner(const scene_job *job, size_t guard, size_t corner, double p[3]);
void scene_view_face(const scene_job *job, size_t face, uint32_t corners[3]);

/* One writer for each format. */
starg_status scene_write_glb(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_vtu(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_ply(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_obj(starg_context *context, const scene_job *job, const char *path);
starg_status scene_write_3mf(starg_context *context, const scene_job *job, const char *path);

/* ---- the container of binary glTF 2.0: a header, JSON, numbers (glb.c) ---- */

/* Component types of accessors and targets of views. */
enum {
    GLB_UNSIGNED_INT = 5125,
    GLB_FLOAT = 5126,
    GLB_ARRAY_BUFFER = 34962,
    GLB_ELEMENT_ARRAY_BUFFER = 34963
};

/* Single precision holds coordinates below this. */
#define GLB_LIMIT 1e38

/* Writes the numbers: the announced number of bytes, a multiple of four. */
typedef void glb_numbers(FILE *stream, const void *user);

/* Writes a file; path "-" is standard output. `json` is NULL if creating it ran out of memory.
 * Errors: MESH (over 4 GiB), WRITE, MEMORY. */
starg_status glb_write(starg_context *context, const char *stage, const char *path,
                       const json_t *json, size_t bytes, glb_numbers *put, const void *user);

/* ---- data blocks of a page, which a browser keeps and does not run (page_data.c) ---- */

/* A block of numbers or bytes in base64, written as they come. Numbers are little endian. */
typedef struct starg_page_block {
    FILE *stream;
    uint8_t waiting[3];
    int count;
} starg_page_block;

/* Begins a block of that name, which is a plain word; `index` is added to it unless it is
 * STARG_PAGE_SINGLE. */
#define STARG_PAGE_SINGLE SIZE_MAX
starg_page_block starg_page_block_open(FILE *stream, const char *name, size_t index);
void starg_page_block_byte(starg_page_block *block, uint8_t byte);
void starg_page_block_bytes(starg_page_block *block, const void *bytes, size_t size);
void starg_page_block_uint32(starg_page_block *block, uint32_t value);
void starg_page_block_float(starg_page_block *block, double value); /* in single precision */
void starg_page_block_double(starg_page_block *block, double value);
void starg_page_block_end(starg_page_block *block); /* of base64 that stands elsewhere */
void starg_page_block_close(starg_page_block *block);

/* A block of JSON: ASCII, with whatever HTML could take for markup as escapes. Consumes `value`;
 * false when it could not be made (memory is out). */
bool starg_page_json(FILE *stream, const char *name, json_t *value);
