/* SPDX-License-Identifier: Apache-2.0 */
/* Data blocks of a page: elements that a browser keeps and does not run. */
#pragma once

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A block of numbers or bytes in base64, written as they come. Numbers are little endian. */
typedef struct starg_page_block {
    FILE *stream;
    uint8_t waiting[3];
    int count;
} starg_page_block;

/* Begins a block of that name, which is a plain word; `index` is added to it unless it is
 * STARG_PAGE_SINGLE. */
#define STARG_PAGE_SINGLE SIZE_MAX
starg_page_block starg_page_block_open(FILE *stream, const char *name, size_t index);
void starg_page_block_byte(starg_page_block *block, uint8_t byte);
void starg_page_block_bytes(starg_page_block *block, const void *bytes, size_t size);
void starg_page_block_uint32(starg_page_block *block, uint32_t value);
void starg_page_block_float(starg_page_block *block, double value); /* in single precision */
void starg_page_block_double(starg_page_block *block, double value);
void starg_page_block_end(starg_page_block *block); /* of base64 that stands elsewhere */
void starg_page_block_close(starg_page_block *block);

/* A block of JSON: ASCII, with whatever HTML could take for markup as escapes. Consumes `value`;
 * false when it could not be made (memory is out). */
bool starg_page_json(FILE *stream, const char *name, json_t *value);
