/* SPDX-License-Identifier: Apache-2.0 */
/* The frames of a morph in a folder written by 'starguard morph'. */
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "show.h"
#include "starguard/animation.h"

/* frame_0000.off and so on, or .ply. */
static bool is_frame(const char *name) {
    static const char begin[] = "frame_";
    size_t size = strlen(name), head = sizeof begin - 1, tail = 4;
    return size > head + tail && strncmp(name, begin, head) == 0 &&
           (strcmp(name + size - tail, ".off") == 0 || strcmp(name + size - tail, ".ply") == 0) &&
           strspn(name + head, "0123456789") == size - head - tail;
}

/* Longer numbers come later. */
static int compare_names(const void *a, const void *b) {
    const char *left = *(char *const *)a, *right = *(char *const *)b;
    size_t m = strlen(left), n = strlen(right);
    return m != n ? (m < n ? -1 : 1) : strcmp(left, right);
}

typedef struct name_list {
    char **items;
    size_t count, capacity;
} name_list;

static bool append(name_list *list, const char *folder, const char *name) {
    if (list->count == list->capacity) {
        size_t capacity = list->capacity > 0 ? 2 * list->capacity : 32;
        char **items = realloc(list->items, capacity * sizeof *items);
        if (items == NULL)
            return false;
        list->items = items;
        list->capacity = capacity;
    }
    size_t size = strlen(folder) + strlen(name) + 2;
    char *path = malloc(size);
    if (path == NULL)
        return false;
    snprintf(path, size, "%s/%s", folder, name);
    list->items[list->count++] = path;
    return true;
}

static starg_status list_frames(cli_session *session, const char *folder, name_list *list) {
    DIR *directory = opendir(folder);
    bool complete = true;
    if (directory == NULL)
        return cli_fail(session, STARG_ERROR_READ, "cannot open '%.300s': %s", folder,
                        strerror(errno));
    for (const struct dirent *entry; complete && (entry = readdir(directory)) != NULL;)
        if (is_frame(entry->d_name))
            complete = append(list, folder, entry->d_name);
    closedir(directory);
    if (!complete)
        return cli_fail_memory(session);
    if (list->count < 2 || list->count > STARG_ANIMATION_FRAMES)
        return cli_fail(session, STARG_ERROR_FORMAT,
                        "'%.300s' has %zu frames (frame_0000.off and so on); a morph has 2 to %d",
                        folder, list->count, STARG_ANIMATION_FRAMES);
    qsort(list->items, list->count, sizeof *list->items, compare_names);
    for (size_t i = 1; i < list->count; i++)
        if (strcmp(strrchr(list->items[i], '.'), strrchr(list->items[0], '.')) != 0)
            return cli_fail(session, STARG_ERROR_FORMAT,
                            "'%.300s' has frames of two morphs, as OFF and as PLY: remove one's",
                            folder);
    return STARG_OK;
}

/* ---- title ---- */

static const char *base_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

/* "A to B", as morph.json names them; without it none. Returns whether there was memory. */
static bool title_morph(const char *folder, cli_show *show) {
    size_t size = strlen(folder) + sizeof "/morph.json";
    char *path = malloc(size);
    if (path == NULL)
        return false;
    snprintf(path, size, "%s/morph.json", folder);
    json_t *root = json_load_file(path, 0, NULL);
    free(path);
    const char *a = json_string_value(json_object_get(json_object_get(root, "model"), "file"));
    const char *b = json_string_value(json_object_get(root, "target"));
    bool known = a != NULL && b != NULL;
    if (known) {
        size = strlen(base_of(a)) + strlen(base_of(b)) + sizeof " to ";
        show->title = malloc(size);
        if (show->title != NULL)
            snprintf(show->title, size, "%s to %s", base_of(a), base_of(b));
    }
    json_decref(root);
    return !known || show->title != NULL;
}

/* The guards of both ends, if the folder has them (morph --guards). */
static starg_status read_ends(cli_session *session, const char *folder, cli_show *show) {
    starg_status status = STARG_OK;
    for (int end = 0; end < 2 && status == STARG_OK; end++) {
        char path[4096];
        int size = snprintf(path, sizeof path, "%s/guards_%c.json", folder, "ab"[end]);
        if (size >= (int)sizeof path || access(path, F_OK) != 0)
            break;
        status = starg_guards_read(session->context, path, &show->ends[end]);
    }
    for (int end = 0; end < 2 && show->ends[1] != NULL; end++)
        show->page.ends[end] = show->ends[end];
    return status;
}

starg_status cli_show_frames(cli_session *session, const char *folder, cli_show *show) {
    starg_status status = STARG_OK;
    name_list list = {0};
    CLI_TRY(list_frames(session, folder, &list));
    show->frames = calloc(list.count + 1, sizeof(starg_mesh *));
    if (show->frames == NULL) {
        status = cli_fail_memory(session);
        goto done;
    }
    for (size_t i = 0; i < list.count; i++) {
        CLI_TRY(cli_name_input(session, list.items[i]));
        CLI_TRY(starg_mesh_read(session->context, list.items[i], &show->frames[i]));
        show->frame_count++;
    }
    CLI_TRY(read_ends(session, folder, show));
    if (!title_morph(folder, show))
        status = cli_fail_memory(session);
done:
    for (size_t i = 0; i < list.count; i++)
        free(list.items[i]);
    free(list.items);
    return status;
}
