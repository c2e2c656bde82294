/* SPDX-License-Identifier: Apache-2.0 */
/* Field tables of guard options and of GUARDS.json. */
#ifndef STARG_GUARD_GUARDS_FIELDS_H
#define STARG_GUARD_GUARDS_FIELDS_H

#include "core/fields.h"

/* The whole file as a starg_guards. */
extern const starg_fields guards_file_fields;

#endif
