/* SPDX-License-Identifier: Apache-2.0 */
#include "session.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SUFFIX = 64 };

static bool fail(cli_outputs *outputs, const char *name, const char *reason) {
    snprintf(outputs->message, sizeof outputs->message, "cannot write '%.300s': %s", name, reason);
    return false;
}

/* Length of the folder part of a path, including the last slash. */
static size_t folder_size(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash != NULL ? (size_t)(slash - path) + 1 : 0;
}

/* A short new name: extending the old one could exceed the system's limit. */
static char *staged_name(const char *folder, size_t size, size_t index) {
    char *name = malloc(size + SUFFIX);
    if (name != NULL) {
        memcpy(name, folder, size);
        snprintf(name + size, SUFFIX, ".starguard-%ld-%zu", (long)getpid(), index);
    }
    return name;
}

/* Do two known files coincide? */
static bool is_same(cli_file_id a, cli_file_id b) {
    return a.known && b.known && a.device == b.device && a.inode == b.inode;
}

static cli_file_id id_of(const struct stat *info) {
    return (cli_file_id){info->st_dev, info->st_ino, S_ISREG(info->st_mode)};
}

static bool fail_clash(cli_outputs *outputs, const char *name) {
    outputs->clash = true;
    return fail(outputs, name, "it is also an input; choose another file");
}

/* What a link to nothing names, however many links lead there: written through, as a link to a file
 * is. NULL with errno set on failure. */
static char *follow(const char *name) {
    enum { LINKS = 40 };
    char *path = strdup(name);
    for (int i = 0; path != NULL; i++) {
        char text[PATH_MAX];
        ssize_t size = readlink(path, text, sizeof text - 1);
        if (size < 0)
            return path; /* no link */
        text[size] = '\0';
        size_t folder = text[0] == '/' ? 0 : folder_size(path), room = folder + (size_t)size + 1;
        char *next = i < LINKS ? malloc(room) : NULL;
        if (next != NULL)
            snprintf(next, room, "%.*s%s", (int)folder, path, text);
        else if (i == LINKS)
            errno = ELOOP;
        free(path);
        path = next;
    }
    return NULL;
}

/* Name of a new file with the links in its folder's name resolved. */
static char *new_target(const char *name) {
    size_t size = folder_size(name);
    char *folder = size > 0 ? strndup(name, size) : strdup(".");
    char *real = folder != NULL ? realpath(folder, NULL) : NULL;
    size_t room = real != NULL ? strlen(real) + strlen(name + size) + 2 : 0;
    char *target = real != NULL ? malloc(room) : NULL;
    if (target != NULL)
        snprintf(target, room, "%s/%s", real, name + size);
    free(real);
    free(folder);
    return target;
}

static bool is_writable(const char *path, size_t size) {
    char *folder = strndup(path, size);
    bool writable = folder != NULL && access(size > 0 ? folder : ".", W_OK | X_OK) == 0;
    int error = errno;
    free(folder);
    errno = error;
    return writable;
}

/* Resolves links and records what exists there. */
static bool inspect(cli_outputs *outputs, cli_output *output) {
    struct stat info;
    bool exists = stat(output->name, &info) == 0;
    if (!exists && errno != ENOENT)
        return fail(outputs, output->name, strerror(errno));
    if (exists && S_ISDIR(info.st_mode))
        return fail(outputs, output->name, "it is a directory; choose a file in it");
    if (exists && access(output->name, W_OK) != 0)
        return fail(outputs, output->name, strerror(errno));
    char *named = exists ? strdup(output->name) : follow(output->name);
    if (named == NULL)
        return fail(outputs, output->name, strerror(errno));
    output->device = exists && !S_ISREG(info.st_mode);
    output->id = exists ? id_of(&info) : (cli_file_id){0};
    if (!output->device)
        output->target = exists ? realpath(output->name, NULL) : new_target(named);
    if (output->target == NULL)
        output->target = strdup(named);
    free(named);
    if (output->target == NULL)
        return fail(outputs, output->name, "out of memory");
    return true;
}

static bool is_taken(const cli_outputs *outputs, const cli_output *output) {
    for (size_t i = 0; i < outputs->count; i++)
        if (!output->device && (strcmp(outputs->items[i].target, output->target) == 0 ||
                                is_same(outputs->items[i].id, output->id)))
            return true;
    return false;
}

static bool is_input(const cli_outputs *outputs, cli_file_id id) {
    for (size_t i = 0; i < outputs->input_count; i++)
        if (is_same(outputs->inputs[i], id))
            return true;
    return false;
}

/* Appends an output; copies its name. */
static cli_output *append(cli_outputs *outputs, const char *name) {
    if (outputs->count == outputs->capacity) {
        size_t capacity = outputs->capacity > 0 ? 2 * outputs->capacity : 4;
        cli_output *items = realloc(outputs->items, capacity * sizeof *items);
        if (items == NULL)
            return NULL;
        outputs->items = items;
        outputs->capacity = capacity;
    }
    cli_output *output = &outputs->items[outputs->count];
    *output = (cli_output){.name = strdup(name)};
    return output->name != NULL ? output : NULL;
}

bool cli_outputs_add(cli_outputs *outputs, const char *name) {
    static const char temporary[] = "/tmp/"; /* a device has no folder of its own */
    if (strcmp(name, "-") == 0)
        return true;
    cli_output *output = append(outputs, name);
    if (output == NULL)
        return fail(outputs, name, "out of memory");
    if (!inspect(outputs, output)) {
        free(output->name);
        free(output->target);
        return false;
    }
    bool taken = is_taken(outputs, output);
    const char *base = output->device ? temporary : output->target;
    size_t size = folder_size(base);
    output->staged = staged_name(base, size, outputs->count);
    outputs->count++;
    if (taken)
        return fail(outputs, name, "two outputs have this name");
    if (output->staged == NULL)
        return fail(outputs, name, "out of memory");
    if (name[folder_size(name)] == '\0')
        return fail(outputs, name, "it is a directory; choose a file in it");
    if (!is_writable(base, size))
        return fail(outputs, name, strerror(errno));
    return !is_input(outputs, output->id) || fail_clash(outputs, name);
}

bool cli_outputs_reads(const cli_outputs *outputs, const char *name) {
    struct stat info;
    return stat(name, &info) == 0 && is_input(outputs, id_of(&info));
}

bool cli_outputs_add_input(cli_outputs *outputs, const char *name) {
    struct stat info;
    bool exists = (strcmp(name, "-") == 0 ? fstat(STDIN_FILENO, &info) : stat(name, &info)) == 0;
    cli_file_id id = exists ? id_of(&info) : (cli_file_id){0};
    if (!id.known)
        return true;
    for (size_t i = 0; i < outputs->count; i++)
        if (is_same(outputs->items[i].id, id))
            return fail_clash(outputs, outputs->items[i].name);
    cli_file_id *inputs =
        realloc(outputs->inputs, (outputs->input_count + 1) * sizeof *outputs->inputs);
    if (inputs == NULL) {
        snprintf(outputs->message, sizeof outputs->message, "out of memory");
        return false;
    }
    outputs->inputs = inputs;
    inputs[outputs->input_count++] = id;
    return true;
}

bool cli_outputs_add_folder(cli_outputs *outputs, const char *name) {
    struct stat info;
    bool made = mkdir(name, 0777) == 0;
    if (!made && errno != EEXIST)
        return fail(outputs, name, strerror(errno));
    if (stat(name, &info) != 0 || !S_ISDIR(info.st_mode))
        return fail(outputs, name, "it is not a directory");
    if (access(name, W_OK | X_OK) != 0)
        return fail(outputs, name, strerror(errno));
    outputs->folder = made ? strdup(name) : NULL;
    return !made || outputs->folder != NULL || fail(outputs, name, "out of memory");
}

const char *cli_outputs_place(const cli_outputs *outputs, const char *name) {
    for (size_t i = 0; i < outputs->count; i++)
        if (strcmp(outputs->items[i].name, name) == 0)
            return outputs->items[i].staged;
    return name;
}

void cli_outputs_translate(const cli_outputs *outputs, char *message, size_t size) {
    for (size_t i = 0; i < outputs->count; i++) {
        const cli_output *output = &outputs->items[i];
        char *found = output->staged != NULL ? strstr(message, output->staged) : NULL;
        char *text = found != NULL ? strdup(message) : NULL;
        if (text == NULL)
            continue;
        size_t head = (size_t)(found - message);
        snprintf(message, size, "%.*s%s%s", (int)head, text, output->name,
                 text + head + strlen(output->staged));
        free(text);
    }
}

/* Copies the staged file into a device or a pipe. */
static bool copy_to_device(const cli_output *output) {
    char block[1 << 13];
    FILE *from = fopen(output->staged, "rb");
    if (from == NULL)
        return false;
    int to = open(output->target, O_WRONLY | O_NOCTTY);
    bool copied = to >= 0;
    size_t size;
    while (copied && (size = fread(block, 1, sizeof block, from)) > 0) {
        for (size_t done = 0; copied && done < size;) {
            ssize_t written = write(to, block + done, size - done);
            copied = written >= 0;
            done += copied ? (size_t)written : 0;
        }
    }
    int error = errno;
    copied = copied && ferror(from) == 0;
    if (to >= 0 && close(to) != 0 && copied) {
        error = errno;
        copied = false;
    }
    fclose(from);
    errno = error;
    return copied;
}

/* Commits those outputs that are devices, or those that are not. */
static bool commit_kind(cli_outputs *outputs, bool device) {
    for (size_t i = 0; i < outputs->count; i++) {
        cli_output *output = &outputs->items[i];
        if (output->device != device)
            continue;
        bool moved = device ? copy_to_device(output) : rename(output->staged, output->target) == 0;
        if (!moved)
            return fail(outputs, output->name, strerror(errno));
    }
    return true;
}

/* Devices first: if they are full, no file has changed yet. */
bool cli_outputs_commit(cli_outputs *outputs) {
    if (!commit_kind(outputs, true) || !commit_kind(outputs, false))
        return false;
    free(outputs->folder);
    outputs->folder = NULL;
    return true;
}

void cli_outputs_discard(cli_outputs *outputs) {
    for (size_t i = 0; i < outputs->count; i++) {
        if (outputs->items[i].staged != NULL)
            unlink(outputs->items[i].staged);
        free(outputs->items[i].staged);
        free(outputs->items[i].target);
        free(outputs->items[i].name);
    }
    if (outputs->folder != NULL)
        rmdir(outputs->folder);
    free(outputs->folder);
    free(outputs->items);
    free(outputs->inputs);
    *outputs = (cli_outputs){0};
}
