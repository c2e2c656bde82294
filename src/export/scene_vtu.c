/* SPDX-License-Identifier: Apache-2.0 */
/* A scene as a VTK XML unstructured grid: one grid of cells of all kinds, which data of the cells
 * tell apart. The numbers are appended raw behind the XML, as VTK's own writer does by default:
 * each array is 8 bytes of length and its numbers, little endian.
 *
 * Points: vertices of the model, of the tetrahedra, guards, nodes, corners of views, vertices of
 * obstacles. Cells: faces of the model (5), tetrahedra (10), guards (1), edges of the skeleton (3),
 * sides of views (5), faces of obstacles (5), in this order. */
#include "core/file.h"
#include "core/memory.h"
#include "export/export.h"

static const char STAGE[] = "scene";

enum { VTK_POINT = 1, VTK_SEGMENT = 3, VTK_TRIANGLE = 5, VTK_TETRAHEDRON = 10 };

/* What is the same for all cells of a part. */
typedef struct vtu_part {
    scene_part part;
    uint8_t type;
    size_t corners;       /* of a cell */
    size_t count;         /* of cells  */
    size_t base;          /* the first point */
    const uint32_t *ends; /* corners of the cells from there; NULL: cell i is point i, or views */
} vtu_part;

typedef struct vtu_scene {
    const scene_job *job;
    vtu_part parts[SCENE_PARTS];
    size_t points, cells, corners;
    size_t view_sides; /* of a guard */
} vtu_scene;

/* A skeleton without edges is shown by its nodes. */
static vtu_part skeleton_part(const scene_job *job, size_t base) {
    if (job->edges == 0)
        return (vtu_part){SCENE_SKELETON, VTK_POINT, 1, job->nodes, base, NULL};
    return (vtu_part){SCENE_SKELETON, VTK_SEGMENT, 2,
                      job->edges,     base,        job->scene->skeleton->edges};
}

static vtu_scene lay_out(const scene_job *job) {
    const starg_mesh *model = job->scene->model;
    const starg_pieces_mesh *pieces = job->scene->pieces;
    vtu_scene s = {.job = job};
    size_t base = job->model_vertices;
    if (model != NULL)
        s.parts[0] =
            (vtu_part){SCENE_MODEL, VTK_TRIANGLE, 3, job->model_faces, 0, starg_mesh_faces(model)};
    if (pieces != NULL) {
        s.parts[1] =
            (vtu_part){SCENE_PIECE, VTK_TETRAHEDRON, 4, pieces->count, base, pieces->tetrahedra};
        base += pieces->vertex_count;
    }
    s.parts[2] = (vtu_part){SCENE_GUARD, VTK_POINT, 1, job->guards, base, NULL};
    base += job->guards;
    s.parts[3] = skeleton_part(job, base);
    base += job->nodes;
    s.view_sides = scene_view_sides(job);
    s.parts[4] = (vtu_part){SCENE_VIEW, VTK_TRIANGLE, 3, s.view_sides * job->guards, base, NULL};
    base += s.view_sides > 0 ? (s.view_sides + 1) * job->guards : 0;
    s.parts[5] =
        (vtu_part){SCENE_OBSTACLE,
                   VTK_TRIANGLE,
                   3,
                   job->obstacle_faces,
                   base,
                   job->obstacle_faces > 0 ? starg_mesh_faces(job->scene->obstacles) : NULL};
    s.points = base + job->obstacle_vertices;
    for (int p = 0; p < SCENE_PARTS; p++) {
        s.cells += s.parts[p].count;
        s.corners += s.parts[p].count * s.parts[p].corners;
    }
    return s;
}

/* ---- arrays ---- */

/* Puts the numbers of an array. */
typedef void vtu_numbers(FILE *stream, const vtu_scene *s);

static void put_doubles(FILE *stream, const double *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        little_put_double(stream, values[i]);
}

static void put_points(FILE *stream, const vtu_scene *s) {
    const starg_scene *scene = s->job->scene;
    if (scene->model != NULL)
        put_doubles(stream, starg_mesh_vertices(scene->model), 3 * s->job->model_vertices);
    if (scene->pieces != NULL)
        put_doubles(stream, scene->pieces->vertices, 3 * scene->pieces->vertex_count);
    if (scene->guards != NULL)
        put_doubles(stream, scene->guards->positions, 3 * s->job->guards);
    if (scene->skeleton != NULL)
        put_doubles(stream, scene->skeleton->positions, 3 * s->job->nodes);
    for (size_t g = 0; s->view_sides > 0 && g < s->job->guards; g++)
        for (size_t k = 0; k <= s->view_sides; k++) {
            double p[3];
            scene_view_corner(s->job, g, k, p);
            put_doubles(stream, p, 3);
        }
    if (scene->obstacles != NULL)
        put_doubles(stream, starg_mesh_vertices(scene->obstacles), 3 * s->job->obstacle_vertices);
}

static void put_radii(FILE *stream, const vtu_scene *s) {
    const starg_skeleton *skeleton = s->job->scene->skeleton;
    size_t nodes = s->parts[SCENE_VIEW].base; /* where they end */
    for (size_t i = 0; i < s->points; i++) {
        bool node = i >= nodes - s->job->nodes && i < nodes;
        little_put_double(stream, node && skeleton->radii != NULL
                                      ? skeleton->radii[i - (nodes - s->job->nodes)]
                                      : 0);
    }
}

static void put_view_corners(FILE *stream, const vtu_scene *s, const vtu_part *part) {
    for (size_t i = 0; i < part->count; i++) {
        uint32_t corners[3];
        scene_view_face(s->job, i, corners);
        for (int k = 0; k < 3; k++)
            little_put_long(stream, part->base + corners[k]);
    }
}

static void put_connectivity(FILE *stream, const vtu_scene *s) {
    for (const vtu_part *part = s->parts; part < s->parts + SCENE_PARTS; part++) {
        if (part->part == SCENE_VIEW) {
            put_view_corners(stream, s, part);
            continue;
        }
        for (size_t i = 0; i < part->count * part->corners; i++)
            little_put_long(stream, part->base + (part->ends != NULL ? part->ends[i] : i));
    }
}

static void put_offsets(FILE *stream, const vtu_scene *s) {
    uint64_t end = 0;
    for (const vtu_part *part = s->parts; part < s->parts + SCENE_PARTS; part++)
        for (size_t i = 0; i < part->count; i++)
            little_put_long(stream, end += part->corners);
}

static void put_types(FILE *stream, const vtu_scene *s) {
    for (const vtu_part *part = s->parts; part < s->parts + SCENE_PARTS; part++)
        for (size_t i = 0; i < part->count; i++)
            fputc(part->type, stream);
}

static void put_parts(FILE *stream, const vtu_scene *s) {
    for (const vtu_part *part = s->parts; part < s->parts + SCENE_PARTS; part++)
        for (size_t i = 0; i < part->count; i++)
            fputc(part->part, stream);
}

/* The label of a tetrahedron, else -1. */
static void put_pieces(FILE *stream, const vtu_scene *s) {
    for (const vtu_part *part = s->parts; part < s->parts + SCENE_PARTS; part++)
        for (size_t i = 0; i < part->count; i++)
            little_put_word(stream, part->part == SCENE_PIECE
                                        ? (uint32_t)s->job->scene->pieces->labels[i]
                                        : UINT32_MAX);
}

/* Of a face the first guard that sees it, of a guard and its view its number, else -1. */
static void put_guards(FILE *stream, const vtu_scene *s) {
    for (const vtu_part *part = s->parts; part < s->parts + SCENE_PARTS; part++)
        for (size_t i = 0; i < part->count; i++) {
            uint32_t guard = UINT32_MAX;
            if (part->part == SCENE_GUARD)
                guard = (uint32_t)i;
            else if (part->part == SCENE_VIEW)
                guard = (uint32_t)(i / s->view_sides);
            else if (part->part == SCENE_MODEL && s->job->viewer != NULL)
                guard = (uint32_t)s->job->viewer[i];
            little_put_word(stream, guard);
        }
}

/* ---- the file ---- */

typedef struct vtu_array {
    const char *section; /* the element around it, named at its first array */
    const char *type, *name;
    size_t components, size; /* of a number */
    vtu_numbers *put;
} vtu_array;

static const vtu_array ARRAYS[] = {
    {"PointData", "Float64", "radius", 1, 8, put_radii},
    {"CellData", "UInt8", "part", 1, 1, put_parts},
    {"CellData", "Int32", "piece", 1, 4, put_pieces},
    {"CellData", "Int32", "guard", 1, 4, put_guards},
    {"Points", "Float64", "Points", 3, 8, put_points},
    {"Cells", "Int64", "connectivity", 1, 8, put_connectivity},
    {"Cells", "Int64", "offsets", 1, 8, put_offsets},
    {"Cells", "UInt8", "types", 1, 1, put_types},
};
enum { ARRAY_COUNT = sizeof ARRAYS / sizeof *ARRAYS };

static size_t array_bytes(const vtu_scene *s, const vtu_array *array) {
    size_t count = s->cells;
    if (array->put == put_points || array->put == put_radii)
        count = s->points;
    if (array->put == put_connectivity)
        count = s->corners;
    return count * array->components * array->size;
}

static void put_xml(FILE *stream, const vtu_scene *s) {
    size_t offset = 0;
    const char *section = "";
    fprintf(stream,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
            "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n",
            s->points, s->cells);
    for (const vtu_array *array = ARRAYS; array < ARRAYS + ARRAY_COUNT; array++) {
        if (strcmp(section, array->section) != 0)
            fprintf(stream, "%s%s%s<%s>\n", *section != '\0' ? "</" : "", section,
                    *section != '\0' ? ">\n" : "", array->section);
        section = array->section;
        fprintf(stream,
                "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%zu\" "
                "format=\"appended\" offset=\"%zu\"/>\n",
                array->type, array->name, array->components, offset);
        offset += 8 + array_bytes(s, array);
    }
    fprintf(stream, "</%s>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
            section);
}

starg_status scene_write_vtu(starg_context *context, const scene_job *job, const char *path) {
    starg_output output;
    const vtu_scene s = lay_out(job);
    TRY(starg_output_open(context, STAGE, path, &output));
    put_xml(output.stream, &s);
    for (const vtu_array *array = ARRAYS; array < ARRAYS + ARRAY_COUNT; array++) {
        little_put_long(output.stream, array_bytes(&s, array));
        array->put(output.stream, &s);
    }
    fputs("\n</AppendedData>\n</VTKFile>\n", output.stream);
    return starg_output_commit(&output);
}
