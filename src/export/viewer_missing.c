/* SPDX-License-Identifier: Apache-2.0 */
#include "export/viewer.h"

const unsigned char starg_viewer_head[1] = {0};
const size_t starg_viewer_head_size = 0;
const unsigned char starg_viewer_tail[1] = {0};
const size_t starg_viewer_tail_size = 0;
