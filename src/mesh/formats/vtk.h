/* SPDX-License-Identifier: Apache-2.0 */
/* VTK files: legacy ones, as readers of surfaces and of tetrahedra share them, and those in XML. */
#pragma once

#include "mesh/formats/scan.h"

/* ---- legacy files (vtk.c) ---- */
/* Errors of all: FORMAT, RANGE, MEMORY, CANCELLED. */

typedef struct vtk_file {
    starg_mesh_builder *points;
    number_scan numbers;
    STARG_ARRAY(int64_t) indices; /* of all cells of the list read last */
    STARG_ARRAY(size_t) starts;   /* one per cell, and the end */
} vtk_file;

bool vtk_matches(const starg_source *source);
vtk_file vtk_open(starg_mesh_builder *points);
void vtk_free(vtk_file *vtk);

/* Is it that keyword, in any case? */
bool vtk_is(starg_word word, const char *text);
starg_status vtk_expect(vtk_file *vtk, const char *keyword);

/* Passes over blocks of METADATA, each of which an empty line ends. */
void vtk_skip_metadata(vtk_file *vtk);

/* Up to the kind of data set. */
starg_status vtk_read_header(vtk_file *vtk, starg_word *dataset);

/* Counts in keyword lines are text, in binary files too. */
starg_status vtk_count(vtk_file *vtk, const char *what, int64_t *count);

/* Binary data begins after the line end, which is one byte. */
void vtk_begin_data(vtk_file *vtk);
starg_status vtk_tick(vtk_file *vtk);

/* POINTS, with the keyword; and a list of cells, after its keyword. */
starg_status vtk_read_points(vtk_file *vtk);
starg_status vtk_read_cells(vtk_file *vtk);

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
