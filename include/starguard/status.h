/* SPDX-License-Identifier: Apache-2.0 */
/* Status codes of all calls that can fail. New codes are only added at the end. */
#ifndef STARGUARD_STATUS_H
#define STARGUARD_STATUS_H

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum starg_status {
    STARG_OK = 0,
    STARG_ERROR_ARGUMENT = 1,   /* a parameter is out of its stated range                       */
    STARG_ERROR_MEMORY = 2,     /* the allocator returned NULL, or a size does not fit          */
    STARG_ERROR_READ = 3,       /* a file is missing, unreadable or a directory                 */
    STARG_ERROR_WRITE = 4,      /* an output cannot be written: permission, full disk           */
    STARG_ERROR_FORMAT = 5,     /* the content of a file violates its format */
    STARG_ERROR_MESH = 6,       /* a mesh is not usable for the call: open, non-manifold, empty */
    STARG_ERROR_RANGE = 7,      /* a coordinate is not finite or not below 1e100 in magnitude,
                                   or a solid is narrower than 1e-90                           */
    STARG_ERROR_SOLVER = 8,     /* the solver library failed without a usable result */
    STARG_ERROR_TIME = 9,       /* time limit reached without a result */
    STARG_ERROR_CANCELLED = 10, /* cancelled by the progress callback or starg_context_cancel */
    STARG_ERROR_RANK = 11       /* the connection to another process is broken */
} starg_status;

/* A short English phrase for a status; "unknown status" for any other number. Static; any thread.
 */
STARG_API const char *starg_status_string(starg_status status);

#ifdef __cplusplus
}
#endif

#endif
