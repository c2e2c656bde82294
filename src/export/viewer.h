/* SPDX-License-Identifier: Apache-2.0 */
/* The viewer: the text of a page before and after its data. viewer/build.mjs builds it from the
 * sources in viewer/; without Node.js and npm at build time, viewer_missing.c replaces it. */
#pragma once

#include <stddef.h>

extern const unsigned char starg_viewer_head[];
extern const size_t starg_viewer_head_size; /* 0: there is no viewer */
extern const unsigned char starg_viewer_tail[];
extern const size_t starg_viewer_tail_size;
