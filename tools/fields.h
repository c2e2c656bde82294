/* SPDX-License-Identifier: Apache-2.0 */
/* Outputs generated from the field tables (starguard/fields.h) at build time: JSON Schemas, the
 * page fields.md, and the types of Python's keyword arguments. */
#ifndef STARGUARD_TOOLS_FIELDS_H
#define STARGUARD_TOOLS_FIELDS_H

#include <stdbool.h>
#include <stdio.h>

#include "starguard/fields.h"

/* A JSON file, and the report that contains its keys and some others. */
typedef struct document {
    const char *name, *title; /* "guards", "GUARDS.json" */
    const char *command;      /* writes the file, and the report with --json */
    const starg_fields *fields;
    const starg_fields *report; /* the report's own keys */
} document;
extern const document documents[];
extern const size_t document_count;

/* The options of a call. */
typedef struct call {
    const char *title, *keywords; /* "guard", "GuardOptions" */
    const starg_fields *(*fields)(void);
    const char *without; /* an argument with a type that no table describes */
} call;
extern const call calls[];
extern const size_t call_count;

enum { NAME_SIZE = 64 };

/* The name of an option in Python: "max_guards". */
void keyword_name(const starg_field *field, char name[NAME_SIZE]);

/* Does every record have the member? */
bool is_required(const starg_field *field);

/* Is it a flag whose option and help describe clearing it? */
bool is_cleared(const starg_field *field);

/* False when a file cannot be written. */
bool write_schemas(const char *folder);
bool write_page(const char *path);
bool write_keywords(const char *path);

#endif
