/* SPDX-License-Identifier: Apache-2.0 */
/* The certificate of a bound for guards anywhere (docs/formats.md), as read, and the check of
 * reasons why something is hidden from a box. */
#pragma once

#include "core/compiler.h"
#include "verify/facts.h"

/* ---- is something hidden from all points of a box, for a stated reason? (hidden.c) ---- */

typedef struct verify_box {
    double lower[3], upper[3];
} verify_box;

/* Why a witness is hidden from a box. */
typedef struct verify_reason {
    uint32_t witness;
    uint32_t vertex, seed; /* UINT32_MAX: none */
    char kind;             /* n, r, s, p, f, e, d (docs/formats.md) */
    bool clipped;          /* only from the part of the box on the inner side of the face */
} verify_reason;

/* A surface with adjacency. */
typedef struct verify_scene {
    const verify_surface *surface;
    const verify_tree *tree;
    uint32_t *twin;     /* by directed edge 3 f + k: the same edge in the adjacent face */
    uint32_t *outgoing; /* by vertex: a directed edge that starts there, or UINT32_MAX */
    bool embedded; /* faces meet only in shared corners and edges, the faces at each vertex form one
                      fan, and all have area */
    uint8_t *sound;       /* by face: is it so there, and outside of the solid right beyond it? */
    uint8_t *sound_about; /* by vertex: are all of its faces sound? */
} verify_scene;

/* `embedding`: check where it is embedded; otherwise it counts as not embedded anywhere. Errors:
 * MEMORY, CANCELLED. */
starg_status verify_scene_create(const verify_surface *surface, const verify_tree *tree,
                                 bool embedding, verify_scene *out);
void verify_scene_free(verify_scene *scene);

/* Memory of one thread. Errors: MEMORY (without detail). */
typedef struct verify_watch verify_watch;
starg_status verify_watch_create(const verify_scene *scene, verify_watch **out);
void verify_watch_free(verify_watch *watch);

/* The same for a parallel loop whose shared data begin with a scene. */
starg_status verify_watch_make(starg_context *context, void *shared, void **scratch);
void verify_watch_drop(starg_context *context, void *scratch);

/* Starts with another box. */
void verify_watch_box(verify_watch *watch, const verify_box *box);

/* Has memory run out? Then nothing that needed it was found to be outside or hidden. */
bool verify_watch_failed(const verify_watch *watch);

/* Is no point of the box in the solid? */
bool verify_box_outside(verify_watch *watch);

/* Is it certain that no point of the box in the solid sees the target, a vertex or a face, within
 * the range? Only the stated reason is tried. */
bool verify_box_hides(verify_watch *watch, starg_target kind, uint32_t target, double range,
                      const verify_reason *reason);

/* The same of a point between the vertices of a face, from the inner side of this. */
bool verify_box_hides_point(verify_watch *watch, uint32_t face, const verify_spot *point,
                            double range, const verify_reason *reason);

/* Do two faces have more in common than corners and edges at the same places (verify/embedded.c)?
 * Have they such a corner? Exact. */
bool verify_faces_touch(const verify_surface *surface, uint32_t f, uint32_t g);
bool verify_faces_share(const verify_surface *surface, uint32_t f, uint32_t g);

/* Which faces are sound, and is the surface embedded (verify/embedded.c)? `sound` is by face.
 * Errors: MEMORY, CANCELLED. */
starg_status verify_find_sound(const verify_scene *scene, uint8_t *sound, bool *embedded);

/* Do faces meet only in corners and edges at equal positions, and is the outside surely just before
 * each? Errors: MEMORY, CANCELLED. */
starg_status verify_find_bounding(const verify_scene *scene, bool *bounding);

/* ---- the certificate of a bound for guards anywhere, as read (everywhere_read.c) ---- */
/* docs/formats.md describes it. Nothing in it is known to hold but that numbers of witnesses, rows,
 * vertices and faces are within their ranges and that the tree of cells is complete. */

enum { EVERYWHERE_WITNESSES = 4096, EVERYWHERE_WORDS = EVERYWHERE_WITNESSES / 64 };
/* Cells within cells, and branches within branches. */
enum { EVERYWHERE_DEPTH = 1024 };

/* Prices are at most this, so that their sums fit. */
#define EVERYWHERE_PRICE (UINT64_C(1) << 48)

/* A number below: the axis across which the cell is cut. */
typedef enum everywhere_kind {
    EVERYWHERE_LEAF = 3,
    EVERYWHERE_OUTSIDE,
    EVERYWHERE_BARRED, /* closer to the surface than guards may stand */
    EVERYWHERE_PARTED  /* cut by parts of the model: both halves have the same box */
} everywhere_kind;

typedef struct everywhere_cell {
    verify_box box;
    size_t first, count; /* of the reasons                          */
    uint32_t row;        /* a leaf's row, or UINT32_MAX             */
    uint32_t parts[2];   /* of the model: it is for guards in those from the first up to the second,
                            without that */
    uint8_t kind;        /* 0, 1, 2: the axis; an everywhere_kind   */
} everywhere_cell;

/* What a proof by branching says of one node. */
typedef struct everywhere_node {
    uint32_t witness;    /* UINT32_MAX: prices                                           */
    size_t first, count; /* of the numbers: rows; or for each price the number of its witnesses,
                            these, and the price */
} everywhere_node;

struct starg_certificate {
    starg_context *context;
    size_t vertex_count, face_count;
    uint64_t checksum;
    starg_target target;
    double range, clearance;
    size_t redundancy, bound;
    uint32_t *witnesses;    /* faces or vertices; of corners and points the faces */
    uint32_t *corners;      /* by witness: the vertex of a corner; NULL where none are the target */
    uint32_t (*weights)[3]; /* by witness: of a point, by the vertices of its face, VERIFY_UNIT in
                               sum; NULL where none are the target */
    size_t witness_count, words; /* words of a row of bits over the witnesses */
    uint64_t *rows;
    size_t row_count;
    everywhere_cell *cells; /* each before its two halves */
    size_t cell_count;
    STARG_ARRAY(verify_reason) reasons;
    everywhere_node *nodes;
    size_t node_count;
    STARG_ARRAY(uint64_t) numbers;
    size_t cell_line; /* of the file: where the first cell stands */
};

/* Is a witness a point between vertices? */
bool verify_is_between(const starg_certificate *certificate, size_t witness);

/* Finds the first reason that does not hold, in the order of the file; *cell is the number of its
 * cell (or cell_count: all hold), *reason that of the reason (or SIZE_MAX: the cell is not
 * outside). Errors: MEMORY, CANCELLED. */
starg_status verify_check_cells(const starg_certificate *certificate, const verify_facts *known,
                                size_t *cell, size_t *reason);

/* Called with a leaf of the tree and the witnesses that it may see (none where no guard may stand);
 * false ends the visit. */
typedef bool everywhere_visit(void *user, size_t cell, const uint64_t *open);

/* Visits the leaves in the order of the file; *all: none of them ended it. Errors: MEMORY,
 * CANCELLED. */
starg_status verify_visit_leaves(const starg_certificate *certificate, everywhere_visit *visit,
                                 void *user, bool *all);

/* By the prices of a node: what guards pay at least who see each witness `times` times, and what
 * one pays who sees the witnesses of the row. A price of several witnesses is paid for each half of
 * what one sees of them. */
starg_uint128 verify_least_paid(const starg_certificate *certificate, const everywhere_node *node,
                                size_t times);
starg_uint128 verify_paid(const starg_certificate *certificate, const everywhere_node *node,
                          const uint64_t *row);

/* Does the bound follow if all reasons hold? `why` says what is wrong if it does not. Errors:
 * MEMORY, CANCELLED. */
typedef struct everywhere_words {
    char text[160];
} everywhere_words;
starg_status verify_check_bound(const starg_certificate *certificate, bool *follows,
                                everywhere_words *why);

/* Is it of the surface with these faces? */
bool verify_certificate_is_of(const starg_certificate *certificate, const verify_surface *surface);

/* Claims that the cells hold all of the model and that all reasons are right. Of `known` surface,
 * tree and scale are needed. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_cells(starg_verdict *verdict, const verify_facts *known,
                                const starg_certificate *certificate);

/* Claims that `claimed` follows as the bound, in these words. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_follows(starg_verdict *verdict, const starg_certificate *certificate,
                                  const char *claim, size_t claimed);

/* Adds the claims about lower_bound_everywhere to the verdict. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_everywhere(starg_verdict *verdict, const verify_facts *known,
                                     const starg_certificate *certificate);
