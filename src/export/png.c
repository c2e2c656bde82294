/* SPDX-License-Identifier: Apache-2.0 */
/* PNG, as far as pictures need it: 8-bit RGB, one IDAT chunk, every row with the Paeth filter
 * (other filters gain little on shaded surfaces over a plain background). */
#include "export/export.h"

#include <stdlib.h>
#include <zlib.h>

#include "core/file.h"
#include "core/memory.h"

static const char STAGE[] = "png";

static const uint8_t SIGNATURE[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

enum { PAETH = 4, BYTES_PER_PIXEL = 3 };
enum { WORD = 4, HEADER = 13, CHUNK = 3 * WORD /* length, type, sum */ };

static uint8_t paeth(int left, int above, int corner) {
    int estimate = left + above - corner;
    int to_left = abs(estimate - left), to_above = abs(estimate - above);
    int to_corner = abs(estimate - corner);
    if (to_left <= to_above && to_left <= to_corner)
        return (uint8_t)left;
    return (uint8_t)(to_above <= to_corner ? above : corner);
}

/* Filter byte and filtered bytes of one row; `above` is NULL for the first. */
static void filter_row(const uint8_t *row, const uint8_t *above, size_t bytes, uint8_t *out) {
    *out++ = PAETH;
    for (size_t i = 0; i < bytes; i++) {
        int left = i < BYTES_PER_PIXEL ? 0 : row[i - BYTES_PER_PIXEL];
        int up = above == NULL ? 0 : above[i];
        int corner = above == NULL || i < BYTES_PER_PIXEL ? 0 : above[i - BYTES_PER_PIXEL];
        out[i] = (uint8_t)(row[i] - paeth(left, up, corner));
    }
}

static voidpf zlib_allocate(voidpf context, uInt count, uInt size) {
    return starg_allocate(context, count, size);
}

static void zlib_release(voidpf context, voidpf block) {
    starg_release(context, block);
}

/* Deflates `input` into a new block. */
static starg_status deflate_block(starg_context *context, uint8_t *input, size_t size,
                                  uint8_t **out, size_t *out_size) {
    starg_status status = STARG_OK;
    uint8_t *block = NULL;
    z_stream stream = {.zalloc = zlib_allocate, .zfree = zlib_release, .opaque = context};
    if (deflateInit(&stream, Z_DEFAULT_COMPRESSION) != Z_OK)
        return starg_fail_memory(context, STAGE);
    size_t bound = deflateBound(&stream, size);
    STARG_NEW(context, STAGE, block, bound);
    stream.next_in = input;
    stream.avail_in = (uInt)size;
    stream.next_out = block;
    stream.avail_out = (uInt)bound;
    if (deflate(&stream, Z_FINISH) != Z_STREAM_END) {
        status = starg_fail(context, STARG_ERROR_WRITE, STAGE, "the picture cannot be compressed");
        goto done;
    }
    *out = block;
    *out_size = stream.total_out;
done:
    deflateEnd(&stream);
    if (status != STARG_OK)
        starg_release(context, block);
    return status;
}

static void store_big_endian(uint32_t value, uint8_t out[4]) {
    for (int k = 0; k < 4; k++)
        out[k] = (uint8_t)(value >> (24 - 8 * k));
}

static uint8_t *store(uint8_t *at, const void *bytes, size_t size) {
    if (size != 0)
        memcpy(at, bytes, size);
    return at + size;
}

static uint8_t *store_chunk(uint8_t *at, const char type[4], const uint8_t *data, size_t size) {
    uint8_t *begin = at;
    store_big_endian((uint32_t)size, at);
    at = store(at + WORD, type, WORD);
    at = store(at, data, size);
    uLong sum = crc32(0, begin + WORD, (uInt)(size + WORD));
    store_big_endian((uint32_t)sum, at);
    return at + WORD;
}

static void store_file(uint8_t *at, size_t width, size_t height, const uint8_t *data, size_t size) {
    uint8_t header[HEADER] = {[8] = 8 /* bits */, [9] = 2 /* RGB */};
    store_big_endian((uint32_t)width, header);
    store_big_endian((uint32_t)height, header + 4);
    at = store(at, SIGNATURE, sizeof SIGNATURE);
    at = store_chunk(at, "IHDR", header, sizeof header);
    at = store_chunk(at, "IDAT", data, size);
    store_chunk(at, "IEND", NULL, 0);
}

starg_status starg_png_encode(starg_context *context, const uint8_t *rgb, size_t width,
                              size_t height, uint8_t **png, size_t *size) {
    SCOPED uint8_t *filtered = NULL, *packed = NULL;
    size_t packed_size = 0, row = BYTES_PER_PIXEL * width;
    *png = NULL;
    NEW(context, STAGE, filtered, height * (row + 1));
    for (size_t y = 0; y < height; y++)
        filter_row(rgb + y * row, y == 0 ? NULL : rgb + (y - 1) * row, row,
                   filtered + y * (row + 1));
    TRY(deflate_block(context, filtered, height * (row + 1), &packed, &packed_size));
    *size = sizeof SIGNATURE + 3 * CHUNK + HEADER + packed_size;
    NEW(context, STAGE, *png, *size);
    store_file(*png, width, height, packed, packed_size);
    return STARG_OK;
}

starg_status starg_png_write(starg_context *context, const char *path, const uint8_t *rgb,
                             size_t width, size_t height) {
    SCOPED uint8_t *png = NULL;
    size_t size = 0;
    starg_output output = {0};
    TRY(starg_png_encode(context, rgb, width, height, &png, &size));
    TRY(starg_output_open(context, STAGE, path, &output));
    fwrite(png, 1, size, output.stream);
    return starg_output_commit(&output);
}
