/* SPDX-License-Identifier: Apache-2.0 */
/* Groups of compatible pieces, given up and grown anew. */
#ifndef STARG_STAR_COMPATIBLE_GROUPS_H
#define STARG_STAR_COMPATIBLE_GROUPS_H

#include "star/compatible/twin_pieces.h"

/* Never leaves more pieces than before. Errors: MEMORY, CANCELLED. */
starg_status compatible_regrow(twin_pieces *w);

#endif
