/* SPDX-License-Identifier: Apache-2.0 */
/* Field table of DESCRIPTOR.json. */
#ifndef STARG_SHAPE_DESCRIPTOR_FIELDS_H
#define STARG_SHAPE_DESCRIPTOR_FIELDS_H

#include "core/fields.h"

/* The file as a starg_descriptor. */
extern const starg_fields descriptor_file_fields;

#endif
