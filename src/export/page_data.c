/* SPDX-License-Identifier: Apache-2.0 */
/* Data blocks of a page, as <script> elements of a type that no browser runs.
 *
 * Nothing in a name can end such an element or begin a comment in it: the JSON is ASCII, and <, >
 * and &, which stand only inside its strings, are written as escapes. Base64 has none of them. */
#include "export/export.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- numbers ---- */

static void put_group(starg_page_block *block) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const uint8_t *b = block->waiting;
    uint32_t bits = (uint32_t)b[0] << 16 | (uint32_t)b[1] << 8 | b[2];
    char text[4];
    for (int k = 0; k < 4; k++)
        text[k] = k <= block->count ? digits[bits >> (18 - 6 * k) & 63] : '=';
    fwrite(text, 1, sizeof text, block->stream);
    memset(block->waiting, 0, sizeof block->waiting);
    block->count = 0;
}

starg_page_block starg_page_block_open(FILE *stream, const char *name, size_t index) {
    fprintf(stream, "<script type=\"text/plain\" id=\"%s", name);
    if (index != STARG_PAGE_SINGLE)
        fprintf(stream, "-%zu", index);
    fputs("\">", stream);
    return (starg_page_block){.stream = stream};
}

void starg_page_block_byte(starg_page_block *block, uint8_t byte) {
    block->waiting[block->count++] = byte;
    if (block->count == 3)
        put_group(block);
}

void starg_page_block_bytes(starg_page_block *block, const void *bytes, size_t size) {
    for (size_t i = 0; i < size; i++)
        starg_page_block_byte(block, ((const uint8_t *)bytes)[i]);
}

void starg_page_block_uint32(starg_page_block *block, uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8)
        starg_page_block_byte(block, (uint8_t)(value >> shift));
}

void starg_page_block_float(starg_page_block *block, double value) {
    float single = (float)fmin(fmax(value, (double)-FLT_MAX), (double)FLT_MAX);
    uint32_t word;
    memcpy(&word, &single, sizeof word);
    starg_page_block_uint32(block, word);
}

void starg_page_block_double(starg_page_block *block, double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    starg_page_block_uint32(block, (uint32_t)word);
    starg_page_block_uint32(block, (uint32_t)(word >> 32));
}

void starg_page_block_end(starg_page_block *block) {
    if (block->count > 0)
        put_group(block);
}

void starg_page_block_close(starg_page_block *block) {
    starg_page_block_end(block);
    fputs("</script>\n", block->stream);
}

/* ---- JSON ---- */

static int put_escaped(const char *text, size_t size, void *stream) {
    for (size_t i = 0; i < size; i++) {
        if (strchr("<>&", text[i]) != NULL && text[i] != '\0')
            fprintf(stream, "\\u%04x", (unsigned)text[i]);
        else
            fputc(text[i], stream);
    }
    return 0;
}

bool starg_page_json(FILE *stream, const char *name, json_t *value) {
    if (value == NULL)
        return false;
    fprintf(stream, "<script type=\"application/json\" id=\"%s\">", name);
    int failed = json_dump_callback(value, put_escaped, stream,
                                    JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(17));
    fputs("</script>\n", stream);
    json_decref(value);
    return failed == 0;
}
