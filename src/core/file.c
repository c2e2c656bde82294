/* SPDX-License-Identifier: Apache-2.0 */
#include "core/file.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"

static starg_status fail_errno(starg_context *context, starg_status status, const char *stage,
                               const char *action, const char *path, int error) {
    if (error == ENOMEM)
        return starg_fail_memory(context, stage);
    return starg_fail(context, status, stage, "cannot %s '%s': %s", action, path, strerror(error));
}

static bool is_standard(const char *path) {
    return strcmp(path, "-") == 0;
}

/* Reads a stream to its end into a growing block; typical files take one read. */
static starg_status read_stream(starg_context *context, const char *stage, const char *path,
                                FILE *file, size_t expected, char **bytes, size_t *size) {
    starg_status status = STARG_OK;
    char *block = NULL;
    size_t count = 0, capacity = expected + 2;
    STARG_NEW(context, stage, block, capacity);
    for (;;) {
        count += fread(block + count, 1, capacity - 1 - count, file);
        if (ferror(file)) {
            status = fail_errno(context, STARG_ERROR_READ, stage, "read", path, errno);
            goto done;
        }
        if (feof(file))
            break;
        STARG_TRY(starg_check_cancel(context, stage));
        if (capacity > STARG_FILE_LIMIT) {
            status = starg_fail(context, STARG_ERROR_READ, stage,
                                "'%s' is larger than 2 GiB, the limit for input files", path);
            goto done;
        }
        char *grown = starg_reallocate(context, block, count, 2 * capacity, 1);
        if (grown == NULL) {
            status = starg_fail_memory(context, stage);
            goto done;
        }
        block = grown;
        capacity *= 2;
    }
    block[count] = '\0';
    *bytes = block;
    *size = count;
done:
    if (status != STARG_OK)
        starg_release(context, block);
    return status;
}

starg_status starg_file_read(starg_context *context, const char *stage, const char *path,
                             char **bytes, size_t *size) {
    *bytes = NULL;
    *size = 0;
    if (is_standard(path))
        return read_stream(context, stage, "standard input", stdin, 1 << 16, bytes, size);

    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return fail_errno(context, STARG_ERROR_READ, stage, "open", path, errno);
    starg_status status = STARG_OK;
    struct stat info;
    size_t expected = 1 << 16;
    if (fstat(fileno(file), &info) != 0) {
        status = fail_errno(context, STARG_ERROR_READ, stage, "open", path, errno);
    } else if (S_ISDIR(info.st_mode)) {
        status = starg_fail(context, STARG_ERROR_READ, stage,
                            "'%s' is a directory; choose a file in it", path);
    } else if (S_ISREG(info.st_mode)) {
        expected = (size_t)info.st_size;
        if (expected > STARG_FILE_LIMIT)
            status = starg_fail(context, STARG_ERROR_READ, stage,
                                "'%s' is larger than 2 GiB, the limit for input files", path);
    }
    if (status == STARG_OK)
        status = read_stream(context, stage, path, file, expected, bytes, size);
    fclose(file);
    return status;
}

int starg_file_temporary(const char *path, char *name) {
    for (int attempt = 0; attempt < 1000; attempt++) {
        snprintf(name, strlen(path) + STARG_FILE_SUFFIX, "%s.%ld.%d.tmp", path, (long)getpid(),
                 attempt);
        int file = open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0 || errno != EEXIST)
            return file;
    }
    return -1;
}

starg_status starg_output_open(starg_context *context, const char *stage, const char *path,
                               starg_output *output) {
    starg_status status = STARG_OK;
    *output = (starg_output){.context = context, .stage = stage};
    if (is_standard(path)) {
        output->stream = stdout;
        return STARG_OK;
    }
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return starg_fail(context, STARG_ERROR_WRITE, stage,
                          "cannot write '%s': it exists and is not a regular file", path);

    size_t length = strlen(path);
    STARG_NEW(context, stage, output->path, length + 1);
    STARG_NEW(context, stage, output->temporary, length + STARG_FILE_SUFFIX);
    memcpy(output->path, path, length + 1);
    int file = starg_file_temporary(path, output->temporary);
    if (file < 0) {
        status = fail_errno(context, STARG_ERROR_WRITE, stage, "write", path, errno);
        goto done;
    }
    output->stream = fdopen(file, "wb");
    if (output->stream == NULL) {
        close(file);
        unlink(output->temporary);
        status = starg_fail_memory(context, stage);
    }
done:
    if (status != STARG_OK) {
        RELEASE(output->path, output->temporary);
        *output = (starg_output){.context = context, .stage = stage};
    }
    return status;
}

static void reset_output(starg_output *output) {
    RELEASE(output->path, output->temporary);
    *output = (starg_output){.context = output->context, .stage = output->stage};
}

/* The errno of an earlier failed write is lost; writing once more sets it again. */
static int recover_errno(FILE *stream) {
    static const char block[1 << 14];
    clearerr(stream);
    errno = 0;
    fwrite(block, 1, sizeof block, stream);
    fflush(stream);
    return errno;
}

starg_status starg_output_commit(starg_output *output) {
    starg_status status = STARG_OK;
    const char *shown = output->path ? output->path : "standard output";
    bool failed = ferror(output->stream) != 0;
    errno = failed && output->path != NULL ? recover_errno(output->stream) : 0;
    if (fflush(output->stream) != 0)
        failed = true;
    if (output->path != NULL && !failed && fsync(fileno(output->stream)) != 0)
        failed = true;
    int error = errno;
    if (output->path != NULL && fclose(output->stream) != 0 && !failed) {
        failed = true;
        error = errno;
    }
    if (!failed && output->path != NULL && rename(output->temporary, output->path) != 0) {
        failed = true;
        error = errno;
    }
    if (failed) {
        status = fail_errno(output->context, STARG_ERROR_WRITE, output->stage, "write", shown,
                            error ? error : EIO);
        if (output->temporary != NULL)
            unlink(output->temporary);
    }
    reset_output(output);
    return status;
}

void starg_output_discard(starg_output *output) {
    if (output->stream == NULL)
        return;
    if (output->path != NULL) {
        fclose(output->stream);
        unlink(output->temporary);
    }
    reset_output(output);
}

starg_status starg_c_locale_enter(starg_context *context, starg_c_locale *locale) {
    locale->own = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (locale->own == (locale_t)0)
        return starg_fail_memory(context, "locale");
    locale->before = uselocale(locale->own);
    return STARG_OK;
}

void starg_c_locale_leave(starg_c_locale *locale) {
    if (locale->own == (locale_t)0)
        return;
    uselocale(locale->before);
    freelocale(locale->own);
    *locale = (starg_c_locale){0};
}
