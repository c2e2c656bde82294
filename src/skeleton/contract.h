/* SPDX-License-Identifier: Apache-2.0 */
/* Makes one node of those whose centres coincide. */
#pragma once

#include "skeleton/complex.h"

/* Keeps the homotopy type. Nodes may be joined by several links afterwards. Errors: MEMORY. */
starg_status contract_complex(starg_context *context, medial_complex *complex);
