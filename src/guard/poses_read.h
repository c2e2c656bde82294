/* SPDX-License-Identifier: Apache-2.0 */
/* Readers of poses in the files of other programs, which append them. Errors: FORMAT (line and
 * reason), MEMORY. */
#ifndef STARG_GUARD_POSES_READ_H
#define STARG_GUARD_POSES_READ_H

#include "core/json.h"
#include "guard/candidates.h"
#include "mesh/formats/io.h"

/* A table with columns x, y, z, and for directions qx, qy, qz, qw or look_x, look_y, look_z. */
bool poses_are_table(const starg_source *source);
starg_status poses_read_table(const starg_source *source, candidate_points *points);

/* The JSON of starg_guards_write_poses. */
bool poses_are_json(const json_t *root);
starg_status poses_read_json(const starg_source *source, const json_t *root,
                             candidate_points *points);

/* The cameras of a binary glTF. */
bool poses_are_glb(const starg_source *source);
starg_status poses_read_glb(const starg_source *source, candidate_points *points);

#endif
