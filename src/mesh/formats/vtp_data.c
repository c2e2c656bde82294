/* SPDX-License-Identifier: Apache-2.0 */
/* Arrays of VTK XML files: numbers as text, as base64 in the element, or appended behind all
 * elements as they are or as base64. Binary data begin with their size in bytes, or where they are
 * compressed with the number of blocks, the size of a block, that of a last shorter one or 0, and
 * the compressed size of each; headers and data may be base64 by themselves or together. Sizes are
 * compared with what the file has before memory is taken: zlib saves no more than a factor of
 * ZLIB_MOST. */
#define ZLIB_CONST
#include <zlib.h>

#include "mesh/formats/vtk.h"

static const char STAGE[] = STARG_MESH_FILE;

enum { ZLIB_MOST = 1032 };

static starg_status fail(const vtp_file *file, const vtp_array *array, const char *what) {
    return starg_source_fail(file->builder->source, starg_at_line(array->line), "the array '%s' %s",
                             starg_word_excerpt(array->name).text, what);
}

/* ---- base64 ---- */

static int digit_of(char c) {
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+'             ? 62
           : c == '/'             ? 63
                                  : -1;
}

/* Groups of four characters, of which padding shortens the last one of each text. Decodes `wanted`
 * bytes; false if there are not so many. */
static bool decode_base64(const char *at, const char *end, size_t wanted, char *out) {
    uint32_t group = 0;
    int filled = 0, padding = 0;
    for (size_t count = 0; count < wanted; at++) {
        while (at < end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r'))
            at++;
        if (at == end || (digit_of(*at) < 0 && *at != '='))
            return false;
        padding += *at == '=';
        group = group << 6 | (uint32_t)(*at == '=' ? 0 : digit_of(*at));
        if (++filled < 4)
            continue;
        for (int i = 0; i < 3 - padding && count < wanted; i++)
            out[count++] = (char)(group >> (16 - 8 * i) & 0xFF);
        if (padding > 2)
            return false;
        group = 0;
        filled = padding = 0;
    }
    return true;
}

/* ---- bytes of an array ---- */

typedef struct byte_range {
    const char *begin, *end;
    bool text; /* base64 */
} byte_range;

static starg_status locate(const vtp_file *file, const vtp_array *array, byte_range *range) {
    const starg_source *source = file->builder->source;
    const char *end = source->bytes + source->size;
    if (array->storage == VTP_INLINE) {
        *range = (byte_range){array->text.text, array->text.text + array->text.length, true};
        return STARG_OK;
    }
    if (file->appended == NULL || array->offset < 0 || array->offset > end - file->appended)
        return fail(file, array, "lies outside the appended data; the file seems to be truncated");
    *range = (byte_range){file->appended + array->offset, end, file->appended_text};
    return STARG_OK;
}

/* The first `wanted` bytes: `block` if they had to be decoded. */
static starg_status take(const vtp_file *file, const vtp_array *array, byte_range range,
                         uint64_t wanted, char **block, const char **bytes) {
    size_t there = (size_t)(range.end - range.begin);
    RELEASE(*block);
    *block = NULL;
    *bytes = range.begin;
    if (wanted > (range.text ? there / 4 * 3 : there))
        return fail(file, array, "is longer than what follows; the file seems to be truncated");
    if (!range.text)
        return STARG_OK;
    NEW(file->builder->source->context, STAGE, *block, (size_t)wanted);
    *bytes = *block;
    if (!decode_base64(range.begin, range.end, (size_t)wanted, *block))
        return fail(file, array, "is no base64 of its length");
    return STARG_OK;
}

static uint64_t header_at(const vtp_file *file, const char *bytes, size_t index) {
    uint64_t value = 0;
    for (size_t i = 0; i < file->header; i++) {
        size_t from = file->encoding == NUMBERS_LITTLE ? file->header - 1 - i : i;
        value = value << 8 | (unsigned char)bytes[index * file->header + from];
    }
    return value;
}

static starg_status take_plain(const vtp_file *file, const vtp_array *array, char **block,
                               const char **bytes, size_t *size) {
    byte_range range;
    TRY(locate(file, array, &range));
    TRY(take(file, array, range, file->header, block, bytes));
    uint64_t length = header_at(file, *bytes, 0);
    if (length > STARG_FILE_LIMIT)
        return fail(file, array, "is longer than files may be");
    TRY(take(file, array, range, file->header + length, block, bytes));
    *bytes += file->header;
    *size = (size_t)length;
    return STARG_OK;
}

/* ---- zlib ---- */

static voidpf zlib_allocate(voidpf context, uInt count, uInt size) {
    return starg_allocate(context, count, size);
}

static void zlib_release(voidpf context, voidpf block) {
    starg_release(context, block);
}

/* One block, which must have this size; Z_OK if it does. */
static int inflate_block(starg_context *context, const char *from, size_t size, char *to,
                         size_t wanted) {
    z_stream stream = {.zalloc = zlib_allocate, .zfree = zlib_release, .opaque = context};
    int result = inflateInit(&stream);
    if (result != Z_OK)
        return result;
    stream.next_in = (const Bytef *)from;
    stream.avail_in = (uInt)size;
    stream.next_out = (Bytef *)to;
    stream.avail_out = (uInt)wanted;
    result = inflate(&stream, Z_FINISH);
    bool whole = result == Z_STREAM_END && stream.avail_out == 0;
    inflateEnd(&stream);
    return whole ? Z_OK : result == Z_MEM_ERROR ? result : Z_DATA_ERROR;
}

/* The sizes that a header states, in bytes. */
typedef struct zlib_sizes {
    uint64_t blocks, block, last; /* last: of the last block */
    uint64_t packed, whole;       /* of all blocks */
} zlib_sizes;

static bool add_up(const vtp_file *file, const char *header, zlib_sizes *sizes) {
    sizes->block = header_at(file, header, 1);
    sizes->last = header_at(file, header, 2);
    sizes->packed = 0;
    if (sizes->last == 0)
        sizes->last = sizes->block;
    if (sizes->block > STARG_FILE_LIMIT || sizes->last > STARG_FILE_LIMIT ||
        (sizes->block > 0 && sizes->blocks > STARG_FILE_LIMIT / sizes->block))
        return false;
    for (uint64_t b = 0; b < sizes->blocks; b++) {
        uint64_t size = header_at(file, header, 3 + (size_t)b);
        if (size > STARG_FILE_LIMIT || sizes->packed > STARG_FILE_LIMIT)
            return false;
        sizes->packed += size;
    }
    sizes->whole = sizes->blocks == 0 ? 0 : (sizes->blocks - 1) * sizes->block + sizes->last;
    return sizes->whole / ZLIB_MOST <= sizes->packed;
}

static starg_status inflate_all(const vtp_file *file, const vtp_array *array,
                                const zlib_sizes *sizes, const char *bytes, char *out) {
    starg_context *context = file->builder->source->context;
    const char *from = bytes + (3 + sizes->blocks) * file->header;
    for (uint64_t b = 0; b < sizes->blocks; b++) {
        size_t packed = (size_t)header_at(file, bytes, 3 + (size_t)b);
        size_t size = (size_t)(b + 1 < sizes->blocks ? sizes->block : sizes->last);
        int result = inflate_block(context, from, packed, out, size);
        if (result == Z_MEM_ERROR)
            return starg_fail_memory(context, STAGE);
        if (result != Z_OK)
            return fail(file, array, "has a block that zlib cannot decompress to its size");
        from += packed;
        out += size;
        TRY(starg_check_cancel(context, STAGE));
    }
    return STARG_OK;
}

static starg_status take_compressed(const vtp_file *file, const vtp_array *array, char **block,
                                    size_t *size) {
    SCOPED char *packed = NULL;
    const char *bytes = NULL;
    byte_range range;
    zlib_sizes sizes = {0};
    TRY(locate(file, array, &range));
    TRY(take(file, array, range, file->header, &packed, &bytes));
    sizes.blocks = header_at(file, bytes, 0);
    if (sizes.blocks == 0)
        return STARG_OK;
    if (sizes.blocks > STARG_FILE_LIMIT)
        return fail(file, array, "has more blocks than files may have bytes");
    uint64_t header = (3 + sizes.blocks) * file->header;
    TRY(take(file, array, range, header, &packed, &bytes));
    if (!add_up(file, bytes, &sizes))
        return fail(file, array, "has a header of compressed data with impossible sizes");
    TRY(take(file, array, range, header + sizes.packed, &packed, &bytes));
    NEW(file->builder->source->context, STAGE, *block, (size_t)sizes.whole);
    *size = (size_t)sizes.whole;
    return inflate_all(file, array, &sizes, bytes, *block);
}

/* ---- numbers ---- */

static size_t count_words(starg_scan scan) {
    starg_word word;
    size_t count = 0;
    while (starg_scan_word(&scan, &word))
        count++;
    return count;
}

starg_status vtp_numbers_open(const vtp_file *file, const vtp_array *array, vtp_numbers *numbers) {
    const char *bytes = array->text.text;
    size_t size = array->text.length;
    *numbers = (vtp_numbers){.array = array, .type = array->type};
    numbers->scan.scan = starg_scan_make(file->builder->source);
    numbers->scan.scan.comments = false;
    if (array->storage != VTP_TEXT) {
        numbers->scan.encoding = file->encoding;
        size = 0;
        if (file->compressed) {
            TRY(take_compressed(file, array, &numbers->block, &size));
            bytes = numbers->block;
        } else {
            TRY(take_plain(file, array, &numbers->block, &bytes, &size));
        }
    }
    numbers->scan.scan.at = bytes;
    numbers->scan.scan.end = size == 0 ? bytes : bytes + size;
    numbers->scan.scan.line = array->text.line;
    numbers->count = array->storage == VTP_TEXT ? count_words(numbers->scan.scan)
                                                : size / numbers_bytes(array->type);
    return STARG_OK;
}

void vtp_numbers_close(vtp_numbers *numbers) {
    RELEASE(numbers->block);
}
