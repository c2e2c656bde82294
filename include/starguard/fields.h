/* SPDX-License-Identifier: Apache-2.0 */
/* Tables that describe the members of a struct: names, ranges, defaults, help.
 *
 * One table describes each options struct and each result. Defaults, range checks, JSON keys,
 * command-line options, JSON Schemas, Python keyword arguments and tables in the documentation are
 * derived from it; bindings and graphical interfaces can use it in the same way. */
#ifndef STARGUARD_FIELDS_H
#define STARGUARD_FIELDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The type of a member. Types up to CHOICE and NUMBERS occur in options and results, PLACES and
 * TEXTS only in options, the others only in results. */
typedef enum starg_field_kind {
    STARG_FIELD_FLAG = 0,    /* bool                                                           */
    STARG_FIELD_COUNT = 1,   /* size_t, uint64_t, uint32_t or int */
    STARG_FIELD_REAL = 2,    /* double                                                         */
    STARG_FIELD_CHOICE = 3,  /* an enum; its numbers are indices of `words`                    */
    STARG_FIELD_TEXT = 4,    /* const char *, or NULL                                          */
    STARG_FIELD_PLACES = 5,  /* starg_places: each occurrence of the option adds a row         */
    STARG_FIELD_POINT = 6,   /* double[3], each below 1e100 in magnitude                       */
    STARG_FIELD_NUMBERS = 7, /* double[length], each in the range of a REAL                    */
    STARG_FIELD_INDICES =
        8, /* uint32_t *, count in the member at `length`: ascending, below the member at `limit` */
    STARG_FIELD_RECORD = 9, /* a nested struct, or (at offset 0) more members of the same struct, as
                               `of` says: a JSON object */
    STARG_FIELD_LIST = 10,  /* an array of `of`, count in the member at `length` */
    STARG_FIELD_TEXTS = 12, /* starg_texts, only in options: each occurrence adds one */
    STARG_FIELD_CONSTANT = 11 /* no member: the word `value`, or the number `initial`; readers also
                                 accept numbers from `least` on if that is not 0 */
} starg_field_kind;

/* Rows of numbers from a command line. */
typedef struct starg_places {
    double *values; /* count rows */
    size_t count;
} starg_places;

/* Words from a command line. */
typedef struct starg_texts {
    const char **values; /* borrowed */
    size_t count;
} starg_texts;

/* Flags of a member; combined by |. */
enum {
    STARG_FIELD_OPTIONAL = 1, /* may be missing in files: then the default */
    STARG_FIELD_NULLABLE = 2, /* null in files means `none` of a count, the default of a real */
    STARG_FIELD_LINES = 4,    /* a list with one line per item */
    STARG_FIELD_MATCHING = 8, /* a list as long as the member at `length`, read before */
    STARG_FIELD_ABOVE = 16,   /* a real above `low`, not `low` itself                            */
    STARG_FIELD_INPUT = 32,   /* an input file name, or a word of `value` */
    STARG_FIELD_COUNTED = 64, /* numbers of a column: count in the member at `length` */
    STARG_FIELD_RARE = 128,   /* with OPTIONAL: not in files where it is the default, of NUMBERS
                                 `standard` for each; a RECORD, where all of it is */
    STARG_FIELD_ALONE = 256,  /* a CHOICE whose option needs no word: alone it stands for `none` */
    STARG_FIELD_ONCE = 512    /* PLACES, TEXTS: the option occurs at most once */
};

typedef struct starg_fields starg_fields;

typedef struct starg_field {
    const char *key; /* in files and reports; NULL: none */
    const char
        *option; /* on the command line, without dashes; NULL: none. "no-X" clears the flag X */
    char letter; /* short form of the option, or 0                                       */
    starg_field_kind kind;
    unsigned flags;
    size_t offset, size; /* of the member, in bytes                                             */

    uint64_t least, most, initial, none; /* COUNT: range, default, meaning of null. CHOICE and FLAG:
                                            `initial` is the default. LIST: `least` items */
    double low, high, standard;          /* REAL, NUMBERS: range, default                       */
    const char *const *words;            /* NULL-terminated. CHOICE: by number. COUNT: names of the
                                            numbers from `most` + 1 on; REAL: of -1, -2, ...;
                                            NULL: none */

    size_t length, limit;  /* LIST, INDICES: offsets of size_t members. NUMBERS: `length` is their
                              number; PLACES: numbers per row */
    size_t stride, within; /* of a column of structs: their size, and the offset in them; stride 0:
                              contiguous values */
    const starg_fields *of;
    bool (*applies)(const void *record); /* whether this record has the member; NULL: always */

    const char *value;        /* name of the option's value in help */
    const char *help;         /* description in sentences; the default is appended */
    const char *default_text; /* the default in words; "": nothing is appended */
    const char *group;        /* of options, a word of starg_field_group; NULL: none */
    const char *brief;        /* of an option that most users need: its help in a line */
} starg_field;

/* How a record is written. */
typedef enum starg_form {
    STARG_FORM_OBJECT = 0, /* {"key": value, ...}                                               */
    STARG_FORM_TUPLE = 1,  /* [value, ...]                                                      */
    STARG_FORM_BARE = 2    /* the value of the only field                                       */
} starg_form;

/* The table of a struct, or of the items of a list: an array of structs, or columns, whose offsets
 * are those of pointers in the struct that has the list. */
struct starg_fields {
    const char *name; /* name of the record in messages: "guards file" */
    size_t size;      /* of the struct in bytes; 0 for columns, and for a part of a struct */
    bool columns;
    const starg_field *fields;
    size_t count;
    starg_form form;
};

/* How long searches go on: words of options that are otherwise numbers. Quick: what is there at
 * once, and a short search; normal: at most some three times as long; best: until more is unlikely
 * to help. */
#define STARG_EFFORT_QUICK  ((uint64_t)INT64_MAX + 1)
#define STARG_EFFORT_NORMAL ((uint64_t)INT64_MAX + 2)
#define STARG_EFFORT_BEST   ((uint64_t)INT64_MAX + 3)

/* The groups of options in the order of the help: the word and title of a group by its index; NULL
 * after the last. */
STARG_API const char *starg_field_group(size_t index, const char **title);

/* Sets every member of a table to its default; other members are not changed. */
STARG_API void starg_fields_default(const starg_fields *fields, void *record);

/* The default of an option as a sentence ("Default 1,000.") in `text`, truncated to `size` bytes;
 * may be empty. */
STARG_API void starg_field_default_text(const starg_field *field, char *text, size_t size);

/* The range of a FLAG, COUNT, REAL or CHOICE for messages ("above 0 and at most 1") in `text`,
 * truncated to `size` bytes. */
STARG_API void starg_field_expectation(const starg_field *field, char *text, size_t size);

/* Sets a CHOICE, or a COUNT or REAL that has words, to a word; false, without a change, if it has
 * no such word. */
STARG_API bool starg_field_set_word(const starg_field *field, void *record, const char *word);

/* The word for a number of a CHOICE or COUNT; NULL if there is none. */
STARG_API const char *starg_field_word(const starg_field *field, uint64_t number);

/* The word for a number of a REAL; NULL if there is none. */
STARG_API const char *starg_field_real_word(const starg_field *field, double value);

/* The word for a number of the CHOICE with a given key; NULL if there is none. */
STARG_API const char *starg_fields_word(const starg_fields *fields, const char *key,
                                        uint64_t number);

/* The value of a COUNT, CHOICE or FLAG. */
STARG_API uint64_t starg_field_count(const starg_field *field, const void *record);

/* Sets it; false, without a change, if out of range. */
STARG_API bool starg_field_set_count(const starg_field *field, void *record, uint64_t value);

/* Sets a REAL; false, without a change, if out of range. */
STARG_API bool starg_field_set_real(const starg_field *field, void *record, double value);

/* A record as JSON: its members with keys. Free with starg_text_free. Errors: MEMORY. */
STARG_API starg_status starg_fields_json(starg_context *context, const starg_fields *fields,
                                         const void *record, char **text, size_t *size);

#ifdef __cplusplus
}
#endif

#endif
