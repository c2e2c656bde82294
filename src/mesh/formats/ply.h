/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the two halves of the PLY reader: the header's declarations. */
#pragma once

#include "mesh/formats/scan.h"

typedef enum ply_encoding { PLY_TEXT, PLY_LITTLE, PLY_BIG } ply_encoding;

typedef enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT32,
    PLY_FLOAT64,
    PLY_TYPES
} ply_type;

/* Meaning of a property. PLY_X, PLY_Y, PLY_Z are 0, 1, 2; a vertex has texture coordinates PLY_U
 * and PLY_V, a face a list of them, PLY_TEXTURE; the parts of a vertex's colour are PLY_RED,
 * PLY_RED + 1, PLY_RED + 2. */
typedef enum ply_role {
    PLY_X,
    PLY_Y,
    PLY_Z,
    PLY_CORNERS,
    PLY_OTHER,
    PLY_TEXTURE,
    PLY_U,
    PLY_V,
    PLY_RED
} ply_role;

/* What a number of a face names: "comment group 3 Floor" names faces with group 3. */
typedef enum ply_naming { PLY_NAMELESS, PLY_GROUP, PLY_MATERIAL } ply_naming;

/* A name that the builder asks for. */
typedef struct ply_name {
    ply_naming naming;
    int64_t number;
    double collected; /* its number among the groups that are collected, from 1 on; else 0 */
} ply_name;

typedef struct ply_property {
    ply_role role;
    bool list;
    bool wanted;         /* the values of faces that the builder asks for */
    ply_naming naming;   /* its values are numbers of names in comments   */
    ply_type count_type; /* for lists */
    ply_type type;
} ply_property;

typedef enum ply_kind { PLY_VERTICES, PLY_FACES, PLY_OTHERS } ply_kind;

typedef struct ply_element {
    ply_kind kind;
    bool strips; /* its lists are strips of triangles, -1 between them */
    size_t count;
    size_t first, properties; /* range in the array of all properties */
    size_t line;
} ply_element;

typedef struct ply_reader {
    starg_mesh_builder *builder;
    const starg_source *source;
    size_t dropped;   /* bytes before the scan's block that are no longer there */
    const char *base; /* where that block begins */
    starg_scan scan;  /* binary data uses only its `at` */
    ply_encoding encoding;
    bool has_encoding;
    bool by_lines; /* one item a line; extra values are ignored */
    size_t extra;  /* lines with extra values */
    size_t first_extra;
    STARG_ARRAY(ply_element) elements;
    STARG_ARRAY(ply_property) properties;
    STARG_ARRAY(ply_name) names;
} ply_reader;

/* Size of a value in a binary file. */
size_t starg_ply_type_size(ply_type type);

/* The element of this kind (not PLY_OTHERS), or NULL if the header does not declare it. */
const ply_element *starg_ply_find(const ply_reader *ply, ply_kind kind);

/* Reads and checks the header and leaves the scanner at the first byte of the data. An accepted
 * header declares vertices with x, y, z, faces with a list of indices, and no more items than the
 * rest of the source can hold. Errors: FORMAT, MEMORY. */
starg_status starg_ply_read_header(ply_reader *ply);
