/* SPDX-License-Identifier: Apache-2.0 */
/* What the members of a struct are called, may hold and mean.
 *
 * Each struct of options and each result is described once, by a table. Defaults, range checks, the
 * keys of result files and reports, the options of the command line, JSON Schemas, Python's keyword
 * arguments and the tables of the documentation all come from it; a binding or a graphical front
 * can use it in the same way. */
#ifndef STARGUARD_FIELDS_H
#define STARGUARD_FIELDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The type of a member. Those above CHOICE are members of options and results alike, PLACES of
 * options only, those below of results only. */
typedef enum starg_field_kind {
    STARG_FIELD_FLAG = 0,    /* bool                                                           */
    STARG_FIELD_COUNT = 1,   /* size_t, uint64_t, uint32_t or int: a whole number              */
    STARG_FIELD_REAL = 2,    /* double                                                         */
    STARG_FIELD_CHOICE = 3,  /* an enum; its numbers are indices of `words`                    */
    STARG_FIELD_TEXT = 4,    /* const char *, or NULL                                          */
    STARG_FIELD_PLACES = 5,  /* starg_places: each occurrence of the option adds a row         */
    STARG_FIELD_POINT = 6,   /* double[3], each below 1e100 in magnitude                       */
    STARG_FIELD_NUMBERS = 7, /* double[length], each in the range of a REAL                    */
    STARG_FIELD_INDICES = 8, /* uint32_t *, as many as the member at `length` says: ascending, below
                                the member at `limit`                                          */
    STARG_FIELD_RECORD = 9, /* a struct within the struct, or (at offset 0) more members of the same
                               struct, as `of` says: an object of their own                   */
    STARG_FIELD_LIST = 10, /* an array, as many as the member at `length` says, of what `of` says */
    STARG_FIELD_CONSTANT = 11 /* no member: the word `value`, or the number `initial`; files with
                                  one from `least` on are read, if that is not 0 */
} starg_field_kind;

/* Rows of numbers from a command line. */
typedef struct starg_places {
    double *values; /* count rows */
    size_t count;
} starg_places;

/* How a member behaves; joined by |. */
enum {
    STARG_FIELD_OPTIONAL = 1, /* files may lack it: then it has its default                      */
    STARG_FIELD_NULLABLE = 2, /* null in files stands for `none` of a count, for the default of a
                                 real                                                            */
    STARG_FIELD_LINES = 4,    /* a list with a line for each item                                */
    STARG_FIELD_MATCHING = 8, /* a list as long as the member at `length`, which was read before */
    STARG_FIELD_ABOVE = 16,   /* a real above `low`, not `low` itself                            */
    STARG_FIELD_INPUT = 32,   /* a text that names a file to be read, or is a word of `value`    */
    STARG_FIELD_COUNTED = 64  /* numbers of a column: as many as the member at `length` says     */
};

typedef struct starg_fields starg_fields;

typedef struct starg_field {
    const char *key;    /* in files and reports; NULL: in none                                  */
    const char *option; /* on the command line, without dashes; NULL: not there. "no-X" clears the
                           flag X                                                               */
    char letter;        /* short form of the option, or 0                                       */
    starg_field_kind kind;
    unsigned flags;
    size_t offset, size; /* of the member, in bytes                                             */

    uint64_t least, most, initial, none; /* COUNT: range, default, what null stands for. CHOICE and
                                            FLAG: `initial` is the default. LIST: `least` items */
    double low, high, standard;          /* REAL, NUMBERS: range, default                       */
    const char *const *words;            /* CHOICE: by number, NULL behind the last             */

    size_t length, limit; /* LIST, INDICES: offsets of size_t members. NUMBERS: `length` is how many
                             PLACES: numbers in a row */
    size_t stride, within; /* of a column that is a member of structs: their size, and where in them
                              it is; stride 0: the values follow one another                    */
    const starg_fields *of;
    bool (*applies)(const void *record); /* does this record have the member? NULL: always      */

    const char *value;        /* what help calls the value of an option                         */
    const char *help;         /* what it means: sentences; the default is added to them         */
    const char *default_text; /* what the default means, in words; "": nothing is added         */
} starg_field;

/* How a record is written in files. */
typedef enum starg_form {
    STARG_FORM_OBJECT = 0, /* {"key": value, ...}                                               */
    STARG_FORM_TUPLE = 1,  /* [value, ...]                                                      */
    STARG_FORM_BARE = 2    /* the value of the only field                                       */
} starg_form;

/* The table of a struct, or of the items of a list: structs in one array, or columns, whose offsets
 * are those of pointers in the struct that has the list. */
struct starg_fields {
    const char *name; /* of what the record is, for people: "guards file" */
    size_t size;      /* of the struct in bytes; 0 for columns, and for a part of a struct */
    bool columns;
    const starg_field *fields;
    size_t count;
    starg_form form;
};

/* Sets every member of a table to its default; other members are left alone. */
STARG_API void starg_fields_default(const starg_fields *fields, void *record);

/* The sentence about the default of an option ("Default 1,000.") in `text`, which is cut off at
 * `size` bytes; empty where there is nothing to say. */
STARG_API void starg_field_default_text(const starg_field *field, char *text, size_t size);

/* What a FLAG, COUNT, REAL or CHOICE must be, for messages ("above 0 and at most 1") in `text`,
 * which is cut off at `size` bytes. */
STARG_API void starg_field_expectation(const starg_field *field, char *text, size_t size);

/* The word for a number of the CHOICE that a table has under a key; NULL if there is none. */
STARG_API const char *starg_fields_word(const starg_fields *fields, const char *key,
                                        uint64_t number);

/* The whole number that a COUNT, CHOICE or FLAG holds. */
STARG_API uint64_t starg_field_count(const starg_field *field, const void *record);

/* Sets it. False, with nothing changed, where it is out of range. */
STARG_API bool starg_field_set_count(const starg_field *field, void *record, uint64_t value);

/* Sets a REAL. False, with nothing changed, where it is out of range. */
STARG_API bool starg_field_set_real(const starg_field *field, void *record, double value);

/* A record as the text of a JSON object: its members that have keys. Free with starg_text_free.
 * Errors: MEMORY. */
STARG_API starg_status starg_fields_json(starg_context *context, const starg_fields *fields,
                                         const void *record, char **text, size_t *size);

#ifdef __cplusplus
}
#endif

#endif
