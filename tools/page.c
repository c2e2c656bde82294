/* SPDX-License-Identifier: Apache-2.0 */
/* fields.md: a table for each record of a file and for the options of each call. */
#include <string.h>

#include "fields.h"

/* Escapes text for a table cell. */
static void put_cell(FILE *page, const char *text) {
    for (; *text != '\0'; text++)
        fprintf(page, *text == '|' ? "\\|" : "%c", *text);
}

static const char *type_of(const starg_field *f, char *text, size_t size) {
    static const char *const names[] = {
        "boolean", "integer",           "real",   "string", "string", "points", "3 reals",
        NULL,      "array of integers", "object", "array",  NULL};
    char item[64];
    const char *name = names[f->kind];
    bool nullable = f->kind == STARG_FIELD_TEXT || (f->flags & STARG_FIELD_NULLABLE);
    if (f->kind == STARG_FIELD_CONSTANT)
        name = f->value != NULL ? "string" : "integer";
    if (f->kind == STARG_FIELD_NUMBERS)
        snprintf(text, size, (f->flags & STARG_FIELD_COUNTED) ? "reals" : "%zu reals", f->length);
    else if (f->kind == STARG_FIELD_LIST && f->of->form == STARG_FORM_BARE)
        snprintf(text, size, "array of %s", type_of(&f->of->fields[0], item, sizeof item));
    else
        snprintf(text, size, "%s%s", name, nullable ? " or null" : "");
    return text;
}

static void put_range(FILE *page, const starg_field *f) {
    char text[256] = "";
    if (f->value != NULL && (f->kind == STARG_FIELD_COUNT || f->kind == STARG_FIELD_REAL))
        fprintf(page, "%s: ", f->value);
    if (f->kind <= STARG_FIELD_CHOICE)
        starg_field_expectation(f, text, sizeof text);
    else if (f->kind == STARG_FIELD_CONSTANT && f->value != NULL)
        snprintf(text, sizeof text, "\"%s\"", f->value);
    else if (f->kind == STARG_FIELD_CONSTANT)
        snprintf(text, sizeof text, "%llu", (unsigned long long)f->initial);
    else if (f->kind == STARG_FIELD_INDICES)
        snprintf(text, sizeof text, "ascending");
    put_cell(page, text);
}

/* Without "Default: " and the full stop. */
static void put_default(FILE *page, const starg_field *f) {
    char text[512];
    starg_field_default_text(f, text, sizeof text);
    const char *begin = strchr(text, ' ');
    if (f->kind == STARG_FIELD_FLAG)
        fputs(f->initial != 0 ? "true" : "false", page);
    else if (begin != NULL)
        fprintf(page, "%.*s", (int)strlen(begin) - 2, begin + 1);
}

static void put_meaning(FILE *page, const starg_field *f, bool of_file) {
    if (is_cleared(f))
        fputs("If false: ", page);
    put_cell(page, f->help != NULL ? f->help : "");
    if (of_file && !is_required(f))
        fputs(" Not in every file.", page);
    fputs(" |\n", page);
}

/* ---- files ---- */

static void put_row(FILE *page, const starg_field *f) {
    char type[64];
    fprintf(page, "| `%s` | %s | ", f->key, type_of(f, type, sizeof type));
    put_range(page, f);
    fputs(" | ", page);
    if (f->kind <= STARG_FIELD_CHOICE && (f->flags & STARG_FIELD_OPTIONAL))
        put_default(page, f);
    fputs(" | ", page);
    put_meaning(page, f, true);
}

static void put_record(FILE *page, const char *title, const starg_fields *fields) {
    fprintf(page, "\n### %s\n\n", title);
    if (fields->form == STARG_FORM_TUPLE)
        fputs("Each an array of these values.\n\n", page);
    fputs("| key | type | range | if missing | meaning |\n|---|---|---|---|---|\n", page);
    for (size_t i = 0; i < fields->count; i++)
        if (fields->fields[i].key != NULL)
            put_row(page, &fields->fields[i]);
    for (size_t i = 0; i < fields->count; i++) {
        const starg_field *f = &fields->fields[i];
        char below[256];
        if (f->key == NULL || f->of == NULL || f->of->form == STARG_FORM_BARE)
            continue;
        snprintf(below, sizeof below, "%s: %s%s", title, f->key,
                 f->kind == STARG_FIELD_LIST ? " (each)" : "");
        put_record(page, below, f->of);
    }
}

/* ---- options ---- */

static void put_option(FILE *page, const starg_field *f) {
    char name[NAME_SIZE], type[64];
    keyword_name(f, name);
    fprintf(page, f->option != NULL ? "| `--%s` " : "| ", f->option);
    fprintf(page, "| `%s` | %s | ", name, type_of(f, type, sizeof type));
    put_range(page, f);
    fputs(" | ", page);
    put_default(page, f);
    fprintf(page, " | %s | ", f->group != NULL ? f->group : "");
    put_meaning(page, f, false);
}

static void put_options(FILE *page, const call *c) {
    fprintf(page, "\n### %s\n\n", c->title);
    fputs("| option | in Python | type | range | default | group | meaning |\n"
          "|---|---|---|---|---|---|---|\n",
          page);
    for (size_t i = 0; i < c->fields()->count; i++)
        put_option(page, &c->fields()->fields[i]);
}

bool write_page(const char *path) {
    FILE *page = fopen(path, "w");
    if (page == NULL)
        return false;
    fputs("# Fields\n\n"
          "Keys of files and options, made from the library's field tables when it is built "
          "(`starguard/fields.h`).\n"
          "What files are for, and how results are reported, is in [formats](formats.md).\n\n"
          "## Files\n",
          page);
    for (size_t i = 0; i < document_count; i++) {
        const document *d = &documents[i];
        char title[NAME_SIZE];
        put_record(page, d->title, d->fields);
        snprintf(title, sizeof title, "Report of %s", d->command);
        if (d->report != NULL) {
            put_record(page, title, d->report);
            fprintf(page, "\nBesides these it has the keys of %s and those of every report.\n",
                    d->title);
        }
    }
    fputs("\n## Options\n\n"
          "Options without a name on the command line are of the C library and of Python only.\n",
          page);
    for (size_t i = 0; i < call_count; i++)
        put_options(page, &calls[i]);
    bool written = !ferror(page);
    return fclose(page) == 0 && written;
}
