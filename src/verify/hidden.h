/* SPDX-License-Identifier: Apache-2.0 */
/* Checks that a vertex or a face is hidden from all points of a box, for a stated reason. */
#ifndef STARG_VERIFY_HIDDEN_H
#define STARG_VERIFY_HIDDEN_H

#include "starguard/visibility.h"
#include "verify/surface.h"
#include "verify/tree.h"

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

#endif
