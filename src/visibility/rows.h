/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the visibility matrix: its rows, some of which other processes can compute. */
#ifndef STARG_VISIBILITY_ROWS_H
#define STARG_VISIBILITY_ROWS_H

#include "core/parallel.h"
#include "core/private.h"
#include "mesh/mesh.h"
#include "starguard/visibility.h"
#include "visibility/scene.h"

/* The columns of visibility rows. */

static inline size_t target_columns(const starg_solid *solid, starg_target target) {
    return target == STARG_TARGET_VERTICES  ? solid->mesh->vertex_count
           : target == STARG_TARGET_CORNERS ? 3 * solid->mesh->face_count
                                            : solid_patch_count(solid);
}

/* A matrix under construction: row i is what point i sees. */
typedef struct visibility_job {
    const visibility_scene *scene;
    const starg_visibility_options *options;
    const double *points;
    size_t count;
    starg_bits *rows;
    uint8_t *finished;               /* by point; may be NULL */
    const visibility_engine *engine; /* follows from the options; visibility_fill sets it */
    const size_t *starts; /* the first point of each place, if directions of one are done in turn */
} visibility_job;

/* Makes the scene that the options' engine needs for `count` points. Errors: MEMORY. */
starg_status visibility_scene_for(starg_context *context, const starg_solid *solid,
                                  const starg_visibility_options *options, size_t count,
                                  visibility_scene **out);

/* Fills the rows, initially zero, in this process or, with `remote`, in others as well. Errors:
 * MEMORY, CANCELLED, TIME, RANK. */
starg_status visibility_fill(starg_context *context, const visibility_job *job,
                             const starg_parallel_remote *remote);

/* Is there enough work to share? */
bool visibility_is_shared(starg_context *context, const visibility_job *job);

/* Packs what points see in: the solid and the options. Errors: MEMORY. */
starg_status visibility_pack_scene(starg_context *context, const starg_solid *solid,
                                   const starg_visibility_options *options, size_t points,
                                   starg_bytes *out);

/* Reads it; *solid may be set even on failure. Errors: MEMORY, RANK. */
starg_status visibility_unpack_scene(starg_context *context, starg_bytes_reader *bytes,
                                     starg_solid **solid, starg_visibility_options *options);

/* Packs the job for helpers. Errors: MEMORY. */
starg_status visibility_pack(starg_context *context, const visibility_job *job, starg_bytes *out);

/* A starg_parallel_remote's take, with a visibility_job for `shared`. */
starg_status visibility_take(starg_context *context, void *shared, size_t first, size_t count,
                             starg_bytes_reader *reply);

/* Computes rows for another process. */
extern const ranks_work visibility_ranks_work STARG_PRIVATE(visibility_ranks_work);

#endif
