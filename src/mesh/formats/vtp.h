/* SPDX-License-Identifier: Apache-2.0 */
/* What the reader of VTK XML files is made of: tags, and arrays as they are stored. */
#pragma once

#include "mesh/formats/numbers.h"

/* ---- tags of an XML text (xml.c) ----
 *
 * Comments, declarations and processing instructions are passed over; entities are not resolved,
 * and nothing else is ever opened. */

typedef struct xml_scan {
    const starg_source *source;
    const char *at, *end;
    size_t line;
} xml_scan;

typedef enum xml_kind { XML_END, XML_OPEN, XML_CLOSE } xml_kind;

typedef struct xml_tag {
    xml_kind kind; /* XML_END: the text has no more of them */
    bool empty;    /* <name/>, which opens and closes */
    starg_word name;
    starg_word attributes; /* all of them */
    starg_word before;     /* the text since the tag before it */
} xml_tag;

xml_scan xml_scan_make(const starg_source *source);

/* Is that the first element of the text? */
bool xml_root_is(const starg_source *source, const char *name);

/* The next tag. Errors: FORMAT (it does not end). */
starg_status xml_next(xml_scan *scan, xml_tag *tag);

/* The value of an attribute; false if there is none of that name. */
bool xml_attribute(const xml_tag *tag, const char *name, starg_word *value);

/* ---- arrays (vtp_data.c) ---- */

typedef enum vtp_section {
    VTP_VERTS,
    VTP_LINES,
    VTP_POLYS,
    VTP_STRIPS,
    VTP_POINTS,
    VTP_DATA
} vtp_section;

typedef enum vtp_storage { VTP_TEXT, VTP_INLINE, VTP_APPENDED } vtp_storage;

typedef struct vtp_array {
    vtp_section section;
    vtp_storage storage;
    number_type type;
    bool strings; /* characters, and a zero behind each string */
    bool several; /* numbers for each cell, of which none is read */
    starg_word name, text;
    size_t line;
    int64_t offset; /* in the appended data */
} vtp_array;

typedef struct vtp_file {
    starg_mesh_builder *builder;
    number_encoding encoding; /* of binary data */
    size_t header;            /* bytes of a number of their headers */
    bool compressed;          /* by zlib */
    const char *appended;     /* the data behind the elements, or NULL */
    bool appended_text;       /* they are base64 */
} vtp_file;

/* The numbers of an array, one by one. */
typedef struct vtp_numbers {
    number_scan scan;
    number_type type;
    size_t count;
    char *block; /* decoded */
    const vtp_array *array;
} vtp_numbers;

/* Errors: FORMAT, MEMORY. */
starg_status vtp_numbers_open(const vtp_file *file, const vtp_array *array, vtp_numbers *numbers);
void vtp_numbers_close(vtp_numbers *numbers);
