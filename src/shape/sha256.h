/* SPDX-License-Identifier: Apache-2.0 */
/* SHA-256 (FIPS 180-4) of a block of memory: identifies equal files. */
#ifndef STARG_SHAPE_SHA256_H
#define STARG_SHAPE_SHA256_H

#include <stddef.h>
#include <stdint.h>

enum { STARG_SHA256_BYTES = 32 };

void starg_sha256(const void *bytes, size_t size, uint8_t digest[STARG_SHA256_BYTES]);

#endif
