/* SPDX-License-Identifier: Apache-2.0 */
#include "support.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- demands ---- */

void fuzz_require(bool condition, const char *what) {
    if (condition)
        return;
    fprintf(stderr, "violated: %s\n", what);
    abort();
}

void fuzz_require_ok(const starg_context *context, starg_status status, const char *what) {
    if (status != STARG_OK)
        fprintf(stderr, "%s: %s\n", starg_status_string(status),
                starg_context_error(context)->message);
    fuzz_require(status == STARG_OK, what);
}

void fuzz_require_explained(const starg_context *context, starg_status status) {
    const starg_error *error = starg_context_error(context);
    fuzz_require(status == STARG_ERROR_FORMAT || status == STARG_ERROR_RANGE ||
                     status == STARG_ERROR_MESH,
                 "bad input is a FORMAT, RANGE or MESH error");
    fuzz_require(error->status == status, "the detail belongs to the status");
    fuzz_require(error->message[0] != '\0', "there is a message");
}

starg_context *fuzz_context(void) {
    starg_context *context = NULL;
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = 1;
    fuzz_require(starg_context_create(&options, &context) == STARG_OK, "a context can be made");
    return context;
}

void fuzz_context_end(starg_context *context) {
    fuzz_require(starg_context_live_blocks(context) == 0, "all memory is returned");
    starg_context_free(context);
}

/* ---- choices ---- */

uint32_t fuzz_byte(fuzz_input *in) {
    if (in->left == 0)
        return 0;
    in->left--;
    return *in->at++;
}

uint32_t fuzz_below(fuzz_input *in, uint32_t bound) {
    uint32_t value = fuzz_byte(in);
    if (bound > 256)
        value = value << 8 | fuzz_byte(in);
    return value % bound;
}

double fuzz_double(fuzz_input *in) {
    unsigned char bytes[8];
    double value;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)fuzz_byte(in);
    memcpy(&value, bytes, sizeof value);
    return fabs(value) < 1e100 ? value : 0;
}

double fuzz_coordinate(fuzz_input *in) {
    uint32_t kind = fuzz_byte(in);
    if (kind < 128)
        return 0.5 * (kind % 16) - 2;
    double small = 0.5 * (kind % 8);
    switch (kind / 16) {
    case 8:
        return nextafter(small, INFINITY);
    case 9:
        return nextafter(small, -INFINITY);
    case 10:
    case 11:
        return (double)fuzz_below(in, 65536) / 8192 - 4;
    case 12:
        return small * 0x1p-30;
    case 13:
        return small * 1e6;
    default:
        return fuzz_double(in);
    }
}

/* ---- meshes ---- */

static void add_vertex(shape *s, double x, double y, double z) {
    double *p = s->vertices + 3 * s->vertex_count++;
    p[0] = x;
    p[1] = y;
    p[2] = z;
}

static void add_face(shape *s, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *f = s->faces + 3 * s->face_count++;
    f[0] = a;
    f[1] = b;
    f[2] = c;
}

static shape empty_shape(size_t vertices, size_t faces) {
    shape s = {.vertices = calloc(3 * vertices, sizeof(double)),
               .faces = calloc(3 * faces, sizeof(uint32_t))};
    fuzz_require(s.vertices != NULL && s.faces != NULL, "there is memory");
    return s;
}

/* Cells of a small block, by the bits of two bytes; none is one. */
static shape cells_shape(fuzz_input *in) {
    static const int sizes[4][3] = {{4, 1, 1}, {2, 2, 2}, {3, 2, 1}, {3, 3, 1}};
    const int *size = sizes[fuzz_below(in, 4)];
    uint32_t bits = fuzz_below(in, 512);
    char cells[9];
    for (int i = 0; i < 9; i++)
        cells[i] = bits >> i & 1 ? '#' : '.';
    shape s = shape_cells(cells, size[0], size[1], size[2]);
    return s.face_count > 0 ? s : shape_cube(1);
}

/* A prism over a polygon with a corner in each direction, at some distance from the middle; its
 * ends are fans, which fold over where the polygon is not star-shaped about the first corner. */
static shape prism_shape(fuzz_input *in) {
    uint32_t n = 3 + fuzz_below(in, 8);
    shape s = empty_shape(2 * (size_t)n, 4 * (size_t)n);
    for (uint32_t i = 0; i < n; i++) {
        double radius = (1 + fuzz_below(in, 8)) / 2.0, angle = 6.283185307179586 * i / n;
        double x = radius * cos(angle), y = radius * sin(angle);
        add_vertex(&s, x, y, 0);
        add_vertex(&s, x, y, 1);
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
        add_face(&s, a, b, b + 1);
        add_face(&s, a, b + 1, a + 1);
        if (i > 0 && i + 1 < n) {
            add_face(&s, 0, b, a);
            add_face(&s, 1, a + 1, b + 1);
        }
    }
    return s;
}

/* Faces between any vertices. */
static shape loose_shape(fuzz_input *in) {
    uint32_t vertices = 4 + fuzz_below(in, 12), faces = 4 + fuzz_below(in, 20);
    shape s = empty_shape(vertices, faces);
    for (uint32_t i = 0; i < vertices; i++) {
        double x = fuzz_coordinate(in), y = fuzz_coordinate(in);
        add_vertex(&s, x, y, fuzz_coordinate(in));
    }
    for (uint32_t i = 0; i < faces; i++) {
        uint32_t a = fuzz_below(in, vertices), b = fuzz_below(in, vertices);
        add_face(&s, a, b, fuzz_below(in, vertices));
    }
    return s;
}

static shape first_shape(fuzz_input *in) {
    switch (fuzz_below(in, 8)) {
    case 0:
        return shape_tetrahedron();
    case 1:
    case 2:
        return cells_shape(in);
    case 3:
    case 4:
        return prism_shape(in);
    case 5:
        return loose_shape(in);
    default:
        return shape_blob((int)fuzz_below(in, 2), fuzz_byte(in));
    }
}

/* Doubles the shape: a copy moved by some lattice vector, turned or not. */
static void double_shape(shape *s, fuzz_input *in) {
    double offset[3];
    shape copy = {0};
    const double nothing[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        offset[k] = 0.25 * fuzz_below(in, 16) - 2;
    bool turned = fuzz_below(in, 2) == 1;
    if (2 * s->face_count > FUZZ_FACES || 2 * s->vertex_count > FUZZ_VERTICES)
        return;
    shape_append(&copy, s, nothing, 0);
    shape_append(s, &copy, offset, turned);
    shape_free(&copy);
}

static void edit_shape(shape *s, fuzz_input *in) {
    uint32_t action = fuzz_below(in, 8);
    uint32_t *face = s->faces + 3 * (size_t)fuzz_below(in, (uint32_t)s->face_count);
    uint32_t vertex = fuzz_below(in, (uint32_t)s->vertex_count), swap = face[0];
    double *p = s->vertices + 3 * (size_t)vertex;
    switch (action) {
    case 0:
        face[fuzz_below(in, 3)] = vertex;
        break;
    case 1:
        face[0] = face[1];
        face[1] = swap;
        break;
    case 2: /* the last face in its place */
        if (s->face_count > 1)
            memmove(face, s->faces + 3 * --s->face_count, 3 * sizeof *face);
        break;
    case 3: /* twice */
        memmove(face, s->faces + 3 * (size_t)fuzz_below(in, (uint32_t)s->face_count),
                3 * sizeof *face);
        break;
    case 4:
        double_shape(s, in);
        break;
    default:
        p[fuzz_below(in, 3)] = fuzz_coordinate(in);
    }
}

static void place_shape(shape *s, uint32_t kind) {
    static const struct {
        double scale, offset;
    } places[] = {{1, 1e6}, {0.1, 0}, {1e90, 0}, {1e-300, 0}, {5e-324, 0}, {1e-160, 0}};
    if (kind >= 250)
        shape_place(s, places[kind - 250].scale, places[kind - 250].offset);
    for (size_t i = 0; i < 3 * s->vertex_count; i++)
        if (!(fabs(s->vertices[i]) < 1e100))
            s->vertices[i] = 0;
}

shape fuzz_shape(fuzz_input *in) {
    uint32_t place = fuzz_byte(in), edits = fuzz_below(in, 8);
    shape s = first_shape(in);
    for (uint32_t i = 0; i < edits; i++)
        edit_shape(&s, in);
    place_shape(&s, place);
    return s;
}

starg_mesh *fuzz_mesh(starg_context *context, const shape *s) {
    starg_mesh *mesh = NULL;
    fuzz_require_ok(
        context,
        starg_mesh_create(context, s->vertices, s->vertex_count, s->faces, s->face_count, &mesh),
        "a mesh can be made of valid arrays");
    return mesh;
}

/* ---- files ---- */

enum { EXTENSIONS = 8 };

static char folder[64];
static struct {
    const char *extension;
    char path[96];
} paths[EXTENSIONS];
static int path_count;

static void remove_folder(void) {
    for (int i = 0; i < path_count; i++)
        unlink(paths[i].path);
    rmdir(folder);
}

const char *fuzz_path(const char *extension) {
    if (path_count == 0) {
        bool in_memory = access("/dev/shm", W_OK) == 0;
        snprintf(folder, sizeof folder, "%s/starguard-fuzz-XXXXXX",
                 in_memory ? "/dev/shm" : "/tmp");
        fuzz_require(mkdtemp(folder) != NULL && atexit(remove_folder) == 0, "a folder can be made");
    }
    for (int i = 0; i < path_count; i++)
        if (strcmp(paths[i].extension, extension) == 0)
            return paths[i].path;
    fuzz_require(path_count < EXTENSIONS, "there are few endings");
    paths[path_count].extension = extension;
    snprintf(paths[path_count].path, sizeof paths[0].path, "%s/input%s", folder, extension);
    return paths[path_count++].path;
}

const char *fuzz_file(const char *extension, const void *bytes, size_t size) {
    const char *path = fuzz_path(extension);
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    fuzz_require(file >= 0 && (size == 0 || write(file, bytes, size) == (ssize_t)size),
                 "a file can be written");
    close(file);
    return path;
}
