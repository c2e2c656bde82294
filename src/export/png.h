/* SPDX-License-Identifier: Apache-2.0 */
/* Writes an image as a PNG file. */
#pragma once

#include "core/context.h"

/* `rgb` holds height rows of width x 3 bytes, top row first; width and height are 1 to 2^20.
 * Errors: WRITE, MEMORY. */
starg_status starg_png_write(starg_context *context, const char *path, const uint8_t *rgb,
                             size_t width, size_t height);

/* Same into a new block. Errors: MEMORY. */
starg_status starg_png_encode(starg_context *context, const uint8_t *rgb, size_t width,
                              size_t height, uint8_t **png, size_t *size);
