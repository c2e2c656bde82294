/* SPDX-License-Identifier: Apache-2.0 */
/* Version of the library and of this header. */
#ifndef STARGUARD_VERSION_H
#define STARGUARD_VERSION_H

#include "export.h"

#define STARG_VERSION_MAJOR 0
#define STARG_VERSION_MINOR 2
#define STARG_VERSION_PATCH 0

#ifdef __cplusplus
extern "C" {
#endif

/* "major.minor.patch" of the linked library. Static; any thread. */
STARG_API const char *starg_version(void);

#ifdef __cplusplus
}
#endif

#endif
