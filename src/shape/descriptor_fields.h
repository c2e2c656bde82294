/* SPDX-License-Identifier: Apache-2.0 */
/* Field table of DESCRIPTOR.json. */
#ifndef STARG_SHAPE_DESCRIPTOR_FIELDS_H
#define STARG_SHAPE_DESCRIPTOR_FIELDS_H

#include "core/fields.h"

/* Changes with what the numbers mean, even if the keys stay. */
enum { DESCRIPTOR_VERSION = 5 };

/* The file as a starg_descriptor. */
extern const starg_fields descriptor_file_fields;

#endif
