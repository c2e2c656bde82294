/* SPDX-License-Identifier: Apache-2.0 */
/* Classes of models, from their file names or from a text. */
#include <stdlib.h>

#include "core/file.h"
#include "shape/database.h"

STARG_DROP_RESULT(starg_classes)

static const char STAGE[] = "classes";
static const char BLANKS[] = " \t\r";

/* ---- from file names ---- */

/* A model and its class word, a part of a longer text. */
typedef struct naming {
    const char *word;
    size_t size;
    size_t model;
} naming;

static int by_word(const void *a, const void *b) {
    const naming *x = a, *y = b;
    int order = memcmp(x->word, y->word, x->size < y->size ? x->size : y->size);
    if (order != 0)
        return order;
    return x->size != y->size ? (x->size > y->size) - (x->size < y->size)
                              : (x->model > y->model) - (x->model < y->model);
}

static bool same_word(const naming *a, const naming *b) {
    return a->size == b->size && memcmp(a->word, b->word, a->size) == 0;
}

static starg_status add_class(starg_context *context, starg_classes *classes, const naming *n) {
    char *name = NULL;
    NEW(context, STAGE, name, n->size + 1);
    memcpy(name, n->word, n->size);
    name[n->size] = '\0';
    classes->names[classes->count++] = name;
    return STARG_OK;
}

/* Sorts the entries and numbers the distinct words. */
static starg_status make_classes(starg_context *context, naming *namings, size_t count,
                                 size_t model_count, starg_classes **out) {
    SCOPED_BY(starg_classes_drop) starg_classes *classes = NULL;
    NEW_ZERO(context, STAGE, classes, 1);
    classes->model_count = model_count;
    NEW(context, STAGE, classes->names, count);
    NEW(context, STAGE, classes->class_of, model_count);
    for (size_t i = 0; i < model_count; i++)
        classes->class_of[i] = STARG_NO_CLASS;
    if (count > 0)
        qsort(namings, count, sizeof *namings, by_word);
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || !same_word(&namings[i - 1], &namings[i]))
            TRY(add_class(context, classes, &namings[i]));
        classes->class_of[namings[i].model] = (uint32_t)classes->count - 1;
    }
    *out = classes;
    classes = NULL;
    return STARG_OK;
}

starg_status starg_classes_by_prefix(starg_context *context, const starg_database_models *models,
                                     starg_classes **out) {
    SCOPED naming *namings = NULL;
    *out = NULL;
    NEW(context, STAGE, namings, models->count);
    for (size_t i = 0; i < models->count; i++) {
        const char *name = models->items[i].name, *end = strrchr(name, '_');
        namings[i] = (naming){name, end != NULL ? (size_t)(end - name) : strlen(name), i};
    }
    return make_classes(context, namings, models->count, models->count, out);
}

void starg_classes_free(starg_context *context, starg_classes *classes) {
    (void)context;
    if (classes == NULL)
        return;
    for (size_t i = 0; i < classes->count; i++)
        RELEASE(classes->names[i]);
    RELEASE(classes->names, classes->class_of, classes);
}

/* ---- from a text ---- */

typedef struct reading {
    starg_context *context;
    const char *path;
    const starg_database_models *models;
    size_t line;
    bool *named; /* by model */
    STARG_ARRAY(naming) namings;
} reading;

static starg_status fail_line(const reading *r, const char *what, const char *word) {
    uint64_t line = r->line;
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_LINE, &line, 1,
                         "'%s', line %zu: %s '%.200s'", r->path, r->line, what, word);
}

static starg_status assign_class(reading *r, const char *model, const char *class) {
    size_t found = 0;
    for (size_t i = 0; i < r->models->count; i++) {
        const starg_database_model *item = &r->models->items[i];
        if (strcmp(item->path, model) != 0 && strcmp(item->name, model) != 0)
            continue;
        if (r->named[i])
            return fail_line(r, "a second class for", model);
        r->named[i] = true;
        PUSH(r->context, STAGE, &r->namings, ((naming){class, strlen(class), i}));
        found++;
    }
    if (found == 0)
        return fail_line(r, "the database has no model", model);
    return STARG_OK;
}

/* The class is the last word, the model everything before it. */
static starg_status read_line(reading *r, char *line) {
    line += strspn(line, BLANKS);
    size_t size = strlen(line);
    while (size > 0 && strchr(BLANKS, line[size - 1]) != NULL)
        line[--size] = '\0';
    if (size == 0 || *line == '#')
        return STARG_OK;
    char *class = line + size;
    while (class > line && strchr(BLANKS, class[-1]) == NULL)
        class --;
    char *end = class;
    while (end > line && strchr(BLANKS, end[-1]) != NULL)
        end--;
    if (end == line)
        return fail_line(r, "no class behind", line);
    *end = '\0';
    return assign_class(r, line, class);
}

starg_status starg_classes_read(starg_context *context, const char *path,
                                const starg_database_models *models, starg_classes **out) {
    starg_status status = STARG_OK;
    char *text = NULL;
    size_t size;
    reading r = {.context = context, .path = path, .models = models};
    *out = NULL;
    STARG_TRY(starg_file_read(context, STAGE, path, &text, &size));
    STARG_NEW_ZERO(context, STAGE, r.named, models->count);
    for (char *line = text; line < text + size;) {
        char *next = line + strcspn(line, "\n");
        r.line++;
        *next = '\0';
        STARG_TRY(read_line(&r, line));
        line = next + 1;
    }
    STARG_TRY(make_classes(context, r.namings.data, r.namings.count, models->count, out));
done:
    RELEASE(text, r.named, r.namings.data);
    return status;
}
