/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures: the file is a PNG of the right size, and its pixels show the scene. The test decodes
 * the PNG itself (zlib inflates). */
#include "support.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "starguard/picture.h"
#include "starguard/sample.h"

/* ---- reading a PNG ---- */

typedef struct image {
    size_t width, height;
    uint8_t *rgb;
} image;

static uint8_t *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static uint32_t big_endian(const uint8_t *b) {
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static int predict(int left, int up, int corner) {
    int p = left + up - corner, a = abs(p - left), b = abs(p - up), c = abs(p - corner);
    return a <= b && a <= c ? left : b <= c ? up : corner;
}

static void unfilter(uint8_t *rows, const image *i) {
    size_t row = 3 * i->width;
    for (size_t y = 0; y < i->height; y++)
        for (size_t x = 0; x < row; x++) {
            const uint8_t *in = rows + y * (row + 1);
            uint8_t *out = i->rgb + y * row;
            int left = x < 3 ? 0 : out[x - 3], up = y == 0 ? 0 : out[x - row];
            int corner = x < 3 || y == 0 ? 0 : (out - row)[x - 3], guess = 0;
            switch (in[0]) {
            case 0:
                break;
            case 1:
                guess = left;
                break;
            case 2:
                guess = up;
                break;
            case 3:
                guess = (left + up) / 2;
                break;
            default:
                assert_int_equal(in[0], 4);
                guess = predict(left, up, corner);
            }
            out[x] = (uint8_t)(in[1 + x] + guess);
        }
}

static image read_png(const char *path) {
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10};
    size_t size = 0, at = 8;
    uint8_t *bytes = read_file(path, &size), *packed = malloc(size);
    assert_non_null(packed);
    uLong packed_size = 0;
    image i = {0};
    assert_memory_equal(bytes, signature, 8);
    bool ended = false;
    while (at < size) {
        assert_true(at + 12 <= size);
        size_t length = big_endian(bytes + at);
        const uint8_t *type = bytes + at + 4, *data = type + 4;
        assert_true(length <= size - at - 12);
        assert_int_equal(crc32(0, type, (uInt)length + 4), big_endian(data + length));
        if (memcmp(type, "IHDR", 4) == 0) {
            i.width = big_endian(data);
            i.height = big_endian(data + 4);
            assert_memory_equal(data + 8, "\x08\x02\0\0\0", 5);
        } else if (memcmp(type, "IDAT", 4) == 0) {
            memcpy(packed + packed_size, data, length);
            packed_size += length;
        } else {
            assert_memory_equal(type, "IEND", 4);
            ended = true;
        }
        at += length + 12;
    }
    assert_true(ended);
    uLongf raw_size = (uLongf)(i.height * (3 * i.width + 1));
    uLongf expected = raw_size;
    uint8_t *rows = malloc(raw_size);
    i.rgb = malloc(3 * i.width * i.height);
    assert_non_null(rows);
    assert_non_null(i.rgb);
    assert_int_equal(uncompress(rows, &raw_size, packed, packed_size), Z_OK);
    assert_int_equal(raw_size, expected);
    unfilter(rows, &i);
    free(rows);
    free(packed);
    free(bytes);
    return i;
}

static const uint8_t *pixel(const image *i, double across, double down) {
    size_t x = (size_t)(across * (double)i->width), y = (size_t)(down * (double)i->height);
    return i->rgb + 3 * (y * i->width + x);
}

static bool is_white(const uint8_t *p) {
    return p[0] == 255 && p[1] == 255 && p[2] == 255;
}

/* ---- scenes ---- */

static char folder[64];

static const char *picture_path(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/starguard-picture-XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int remove_folder(void **state) {
    (void)state;
    return rmdir(folder);
}

/* The cube [-1, 1]^3 times `size`, moved by `shift` along x. */
static starg_mesh *make_cube(starg_context *context, double size, double shift) {
    static const uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    double vertices[24];
    uint32_t faces[36];
    for (int v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++)
            vertices[3 * v + k] = (v >> k & 1 ? size : -size) + (k == 0 ? shift : 0);
    for (int q = 0; q < 6; q++) {
        const uint32_t *c = quads[q];
        const uint32_t two[6] = {c[0], c[1], c[2], c[0], c[2], c[3]};
        memcpy(faces + 6 * q, two, sizeof two);
    }
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, vertices, 8, faces, 12, &mesh));
    return mesh;
}

static starg_picture_options small_options(void) {
    starg_picture_options options;
    starg_picture_options_default(&options);
    options.width = 160;
    options.height = 120;
    options.azimuth = 0;
    options.elevation = 0;
    return options;
}

static image draw(starg_context *context, const starg_mesh *mesh,
                  const starg_picture_options *options) {
    const char *path = picture_path("scene.png");
    test_ok(context, starg_picture_write(context, mesh, options, path));
    image i = read_png(path);
    assert_int_equal(i.width, options->width);
    assert_int_equal(i.height, options->height);
    assert_int_equal(unlink(path), 0);
    return i;
}

static void a_face_on_cube_is_a_square(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = make_cube(context, 1, 0);
    starg_picture_options options = small_options();
    options.opacity = 1;
    image i = draw(context, mesh, &options);
    size_t covered = 0;
    for (size_t p = 0; p < i.width * i.height; p++)
        covered += !is_white(i.rgb + 3 * p);
    /* it fills 94 % of the height */
    double side = sqrt((double)covered);
    assert_true(side > 0.92 * 120 && side < 0.97 * 120);
    assert_true(is_white(pixel(&i, 0.02, 0.5)));
    assert_false(is_white(pixel(&i, 0.5, 0.5)));
    /* one face, one normal, one colour */
    assert_memory_equal(pixel(&i, 0.5, 0.5), pixel(&i, 0.4, 0.7), 3);
    free(i.rgb);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* With the default up axis, azimuth 0 looks along -z and azimuth 90 along -x; elevation 90 looks
 * down. Coloured faces identify the visible side. */
static void the_camera_stands_where_it_should(void **state) {
    (void)state;
    static const struct {
        double azimuth, elevation;
        int up, seen; /* quad of make_cube */
    } views[] = {{0, 0, 1, 5},   {90, 0, 1, 1}, {180, 0, 1, 4}, {270, 0, 1, 0}, {0, 90, 1, 3},
                 {0, -90, 1, 2}, {0, 0, 2, 1},  {90, 0, 2, 3},  {0, 90, 2, 5},  {0, 0, 0, 3}};
    starg_context *context = test_context(2);
    starg_mesh *mesh = make_cube(context, 1, 0);
    uint8_t colors[36];
    starg_picture_options options = small_options();
    options.opacity = 1;
    options.face_colors = colors;
    for (size_t v = 0; v < sizeof views / sizeof *views; v++) {
        options.azimuth = views[v].azimuth;
        options.elevation = views[v].elevation;
        options.up = views[v].up;
        for (int f = 0; f < 12; f++) {
            bool seen = f / 2 == views[v].seen;
            colors[3 * f] = seen ? 20 : 220;
            colors[3 * f + 1] = 0;
            colors[3 * f + 2] = seen ? 220 : 20;
        }
        image i = draw(context, mesh, &options);
        const uint8_t *p = pixel(&i, 0.5, 0.45);
        assert_true(p[2] > 3 * p[0]);
        free(i.rgb);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void balls_inside_show_through_but_not_through_opaque_walls(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = make_cube(context, 1, 0);
    const double points[6] = {0, 0, 0, 0, 0, -0.5}; /* the second is behind the first */
    const uint8_t colors[6] = {230, 20, 20, 20, 230, 20};
    starg_picture_options options = small_options();
    options.points = points;
    options.point_colors = colors;
    options.point_count = 2;
    options.point_radius = 0.05;
    image through = draw(context, mesh, &options);
    const uint8_t *p = pixel(&through, 0.5, 0.5);
    assert_true(p[0] > p[1] + 40 && p[0] > p[2] + 40);
    options.opacity = 1;
    image hidden = draw(context, mesh, &options);
    p = pixel(&hidden, 0.5, 0.5);
    assert_true(p[2] >= p[0]);
    free(through.rgb);
    free(hidden.rgb);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Numbers change nothing but a place at the upper right of each point, and of two points in one
 * direction only the nearer one has its number. */
static void numbers_stand_beside_points(void **state) {
    (void)state;
    enum { BALL = 7, LETTERS = 24 }; /* pixels, with room */
    starg_context *context = test_context(2);
    starg_mesh *mesh = make_cube(context, 1, 0);
    const double points[9] = {-0.6, 0.5, 0, 0.5, -0.5, -0.5, 0.5, -0.5, 0.5}; /* x, y, z */
    starg_picture_options options = small_options();
    options.width = options.height = 400;
    options.points = points;
    options.point_count = 3;
    image without = draw(context, mesh, &options);
    options.point_numbers = true;
    image with = draw(context, mesh, &options);
    options.points = points + 6; /* the nearest alone, as number 0 */
    options.point_count = 1;
    image other = draw(context, mesh, &options);
    size_t changed[2] = {0}, unlike = 0;
    for (size_t p = 0; p < with.width * with.height; p++) {
        if (memcmp(with.rgb + 3 * p, without.rgb + 3 * p, 3) == 0)
            continue;
        double x = (double)(p % 400), y = (double)(p / 400);
        bool found = false;
        for (int i = 0; i < 2; i++) { /* a cube of side 2 with balls takes 0.94 of 400 pixels */
            double right = x - 200 - 180.5 * points[3 * i],
                   up = 200 - 180.5 * points[3 * i + 1] - y;
            bool here = right > 0 && right < BALL + LETTERS && up > 0 && up < BALL + LETTERS;
            changed[i] += here;
            found |= here;
        }
        assert_true(found);
        unlike += memcmp(with.rgb + 3 * p, other.rgb + 3 * p, 3) != 0 && x > 200;
    }
    assert_true(changed[0] > 20 && changed[1] > 20);
    assert_true(unlike > 5); /* a 2, not a 0 */
    free(with.rgb);
    free(without.rgb);
    free(other.rgb);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* The outline of a camera's view changes pixels on the side to which it looks, and nothing on the
 * other; who looks all around has none. */
static void views_lie_where_cameras_look(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = make_cube(context, 1, 0);
    double position[3] = {0, 0, 0}, direction[3] = {0, 0, 0};
    starg_guards guards = {.count = 1, .positions = position};
    starg_visibility_options_default(&guards.options.visibility);
    starg_picture_options options = small_options();
    image plain = draw(context, mesh, &options);
    options.views = &guards;
    image around = draw(context, mesh, &options);
    size_t pixels = plain.width * plain.height;
    assert_memory_equal(plain.rgb, around.rgb, 3 * pixels);
    guards.directions = direction;
    for (int look = 0; look < 4; look++) {
        double way = look % 2 == 0 ? 1 : -1; /* right, left */
        direction[0] = way;
        guards.options.visibility.fov[0] = look < 2 ? 60 : 0;
        guards.options.visibility.fov[1] = look < 2 ? 40 : 0;
        guards.options.visibility.cone = look < 2 ? 360 : 60;
        image with = draw(context, mesh, &options);
        size_t changed = 0;
        for (size_t p = 0; p < pixels; p++) {
            if (memcmp(with.rgb + 3 * p, plain.rgb + 3 * p, 3) == 0)
                continue;
            double x = (double)(p % with.width) - 0.5 * (double)with.width;
            assert_true(way * x > -4); /* lines are a few pixels wide */
            changed++;
        }
        assert_true(changed > 20);
        free(with.rgb);
    }
    free(plain.rgb);
    free(around.rgb);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void the_more_opaque_the_darker(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = make_cube(context, 1, 0);
    starg_picture_options options = small_options();
    int last = 256;
    for (int step = 0; step <= 4; step++) {
        options.opacity = 0.25 * step;
        image i = draw(context, mesh, &options);
        int green = pixel(&i, 0.5, 0.45)[1];
        assert_true(green < last || (step == 0 && green <= 255));
        last = green;
        free(i.rgb);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Seams between triangles would show as darker or lighter samples on a flat face. */
static void flat_faces_have_no_seams(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_sample_options size = {.pose = 0, .vertex_count = 2000};
    starg_mesh *mesh = NULL;
    test_ok(context, starg_sample_create(context, "l-room", &size, &mesh));
    starg_picture_options options = small_options();
    options.width = 480;
    options.height = 360;
    options.elevation = 90; /* floor and ceiling, one behind the other */
    options.opacity = 0.5;
    options.azimuth = 0;
    image i = draw(context, mesh, &options);
    /* the commonest colour covers nearly all that is neither white nor an outline */
    size_t counts[256] = {0}, covered = 0, best = 0;
    for (size_t p = 0; p < i.width * i.height; p++)
        if (!is_white(i.rgb + 3 * p)) {
            covered++;
            counts[i.rgb[3 * p + 1]]++;
        }
    for (int c = 0; c < 256; c++)
        best = counts[c] > best ? counts[c] : best;
    assert_true(covered > 40000);
    assert_true((double)best > 0.9 * (double)covered);
    free(i.rgb);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void same_bytes_for_any_thread_count(void **state) {
    (void)state;
    size_t sizes[2];
    uint8_t *bytes[2];
    for (int turn = 0; turn < 2; turn++) {
        starg_context *context = test_context(turn == 0 ? 1 : 4);
        starg_sample_options size = {.pose = 1, .vertex_count = 1500};
        starg_mesh *mesh = NULL;
        test_ok(context, starg_sample_create(context, "dog", &size, &mesh));
        starg_picture_options options = small_options();
        options.azimuth = 35;
        options.points = starg_mesh_vertices(mesh);
        options.point_count = 40;
        const char *path = picture_path("threads.png");
        test_ok(context, starg_picture_write(context, mesh, &options, path));
        bytes[turn] = read_file(path, &sizes[turn]);
        assert_int_equal(unlink(path), 0);
        starg_mesh_free(mesh);
        test_context_free(context);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    free(bytes[0]);
    free(bytes[1]);
}

/* Each row's name changes pixels at the left of that row, and of no other. */
static void rows_of_a_sheet_have_names(void **state) {
    (void)state;
    static const char *const names[2][2] = {{"first", " "}, {" ", "second"}};
    starg_context *context = test_context(1);
    starg_mesh *cube = make_cube(context, 1, 0);
    const starg_mesh *meshes[4] = {cube, cube, cube, cube};
    starg_picture_options options = small_options();
    const char *path = picture_path("sheet.png");
    test_ok(context, starg_picture_sheet_write(context, meshes, 2, 2, &options, path));
    image plain = read_png(path);
    assert_int_equal(plain.width, 2 * options.width);
    assert_int_equal(plain.height, 2 * options.height);
    for (size_t row = 0; row < 2; row++) {
        options.row_names = names[row];
        test_ok(context, starg_picture_sheet_write(context, meshes, 2, 2, &options, path));
        image named = read_png(path);
        size_t inside = 0, outside = 0;
        for (size_t p = 0; p < 3 * plain.width * plain.height; p++) {
            size_t x = p / 3 % plain.width, y = p / 3 / plain.width;
            bool here = x < options.width && y / options.height == row;
            inside += here && named.rgb[p] != plain.rgb[p];
            outside += !here && named.rgb[p] != plain.rgb[p];
        }
        assert_true(inside > 20);
        assert_int_equal(outside, 0);
        free(named.rgb);
    }
    assert_int_equal(unlink(path), 0);
    free(plain.rgb);
    starg_mesh_free(cube);
    test_context_free(context);
}

/* Sizes from subnormal to huge give the same picture; so do places far from the origin. */
static void scale_does_not_matter(void **state) {
    (void)state;
    static const double scales[] = {1e-300, 1e-3, 1e90};
    starg_context *context = test_context(2);
    starg_picture_options options = small_options();
    options.azimuth = 30;
    starg_mesh *unit = make_cube(context, 1, 0);
    image expected = draw(context, unit, &options);
    for (size_t s = 0; s < sizeof scales / sizeof *scales; s++) {
        starg_mesh *mesh = make_cube(context, scales[s], 0);
        image i = draw(context, mesh, &options);
        size_t different = 0;
        for (size_t p = 0; p < 3 * i.width * i.height; p++)
            different += abs(i.rgb[p] - expected.rgb[p]) > 8;
        assert_true(different < i.width);
        free(i.rgb);
        starg_mesh_free(mesh);
    }
    free(expected.rgb);
    starg_mesh_free(unit);
    test_context_free(context);
}

/* Any mesh can be drawn: empty, points only, zero-area triangles, shared or open edges. */
static void odd_meshes_are_drawn(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_picture_options options = small_options();
    const double same[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    const double fan[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, -1, 0};
    const uint32_t repeated[15] = {0, 0, 0, 0, 1, 2, 0, 1, 2, 0, 1, 1, 2, 1, 0};
    const uint32_t book[12] = {0, 1, 2, 0, 1, 3, 0, 1, 4, 1, 0, 2};
    const struct {
        const double *vertices;
        size_t vertex_count;
        const uint32_t *faces;
        size_t face_count;
    } scenes[] = {{NULL, 0, NULL, 0}, {fan, 5, NULL, 0}, {same, 3, repeated, 5}, {fan, 5, book, 4}};
    for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++) {
        starg_mesh *mesh = NULL;
        test_ok(context, starg_mesh_create(context, scenes[s].vertices, scenes[s].vertex_count,
                                           scenes[s].faces, scenes[s].face_count, &mesh));
        options.points = fan;
        options.point_count = s % 2;
        image i = draw(context, mesh, &options);
        free(i.rgb);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* A fan with thousands of layers on one spot is truncated to the nearest, without error. */
static void many_layers_are_cut_off(void **state) {
    (void)state;
    enum { LAYERS = 3000 };
    starg_context *context = test_context(2);
    double *vertices = malloc(9 * LAYERS * sizeof *vertices);
    uint32_t *faces = malloc(3 * LAYERS * sizeof *faces);
    assert_non_null(vertices);
    assert_non_null(faces);
    for (uint32_t f = 0; f < LAYERS; f++) {
        const double corners[9] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
        memcpy(vertices + 9 * f, corners, sizeof corners);
        for (uint32_t k = 0; k < 3; k++) {
            vertices[9 * f + 3 * k + 2] = f * 1e-4;
            faces[3 * f + k] = 3 * f + k;
        }
    }
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, vertices, 3 * LAYERS, faces, LAYERS, &mesh));
    starg_picture_options options = small_options();
    options.width = 48;
    options.height = 48;
    image i = draw(context, mesh, &options);
    assert_false(is_white(pixel(&i, 0.5, 0.6)));
    assert_true(is_white(pixel(&i, 0.1, 0.1)));
    free(i.rgb);
    free(vertices);
    free(faces);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void bad_options_are_refused(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = make_cube(context, 1, 0);
    const double bad_point[3] = {0, NAN, 0};
    const char *path = picture_path("bad.png");
    for (int wrong = 0; wrong < 10; wrong++) {
        starg_picture_options options = small_options();
        switch (wrong) {
        case 0:
            options.width = 15;
            break;
        case 1:
            options.height = 8193;
            break;
        case 2:
            options.azimuth = NAN;
            break;
        case 3:
            options.elevation = INFINITY;
            break;
        case 4:
            options.up = 3;
            break;
        case 5:
            options.up = -1;
            break;
        case 6:
            options.opacity = 1.5;
            break;
        case 7:
            options.opacity = NAN;
            break;
        case 8:
            options.point_radius = 0;
            break;
        default:
            options.points = bad_point;
            options.point_count = 1;
        }
        assert_int_equal(starg_picture_write(context, mesh, &options, path), STARG_ERROR_ARGUMENT);
        assert_true(strlen(starg_context_error(context)->message) > 10);
        assert_int_not_equal(access(path, F_OK), 0);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void unwritable_places_leave_nothing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = make_cube(context, 1, 0);
    starg_picture_options options = small_options();
    assert_int_equal(starg_picture_write(context, mesh, &options, picture_path("no/such/x.png")),
                     STARG_ERROR_WRITE);
    starg_context_cancel(context);
    assert_int_equal(starg_picture_write(context, mesh, &options, picture_path("x.png")),
                     STARG_ERROR_CANCELLED);
    assert_int_not_equal(access(picture_path("x.png"), F_OK), 0);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void memory_failures_leak_nothing(void **state) {
    (void)state;
    starg_status status = STARG_ERROR_MEMORY;
    size_t failures = 0;
    const char *path = picture_path("scarce.png");
    for (size_t allowed = 4; status != STARG_OK; allowed++) {
        size_t left = 1000;
        starg_context *context = test_scarce_context(1, &left);
        starg_mesh *mesh = make_cube(context, 1, 0);
        starg_picture_options options = small_options();
        left = allowed;
        status = starg_picture_write(context, mesh, &options, path);
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        assert_true((access(path, F_OK) == 0) == (status == STARG_OK));
        failures += status != STARG_OK;
        starg_mesh_free(mesh);
        test_context_free(context);
    }
    assert_true(failures > 5);
    assert_int_equal(unlink(path), 0);
}

/* RGB distance between the first colours, and to white. */
static void colors_are_distinct(void **state) {
    (void)state;
    enum { COUNT = 24 };
    uint8_t colors[COUNT][3];
    for (size_t i = 0; i < COUNT; i++) {
        starg_distinct_color(i, colors[i]);
        int from_white = 0;
        for (int k = 0; k < 3; k++)
            from_white += (255 - colors[i][k]) * (255 - colors[i][k]);
        assert_true(from_white > 80 * 80);
        for (size_t j = 0; j < i; j++) {
            int square = 0;
            for (int k = 0; k < 3; k++)
                square += (colors[i][k] - colors[j][k]) * (colors[i][k] - colors[j][k]);
            assert_true(square > 20 * 20);
        }
    }
    uint8_t last[3], again[3];
    starg_distinct_color(SIZE_MAX, last);
    starg_distinct_color(SIZE_MAX, again);
    assert_memory_equal(last, again, 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_face_on_cube_is_a_square),
        cmocka_unit_test(the_camera_stands_where_it_should),
        cmocka_unit_test(balls_inside_show_through_but_not_through_opaque_walls),
        cmocka_unit_test(numbers_stand_beside_points),
        cmocka_unit_test(views_lie_where_cameras_look),
        cmocka_unit_test(the_more_opaque_the_darker),
        cmocka_unit_test(flat_faces_have_no_seams),
        cmocka_unit_test(same_bytes_for_any_thread_count),
        cmocka_unit_test(scale_does_not_matter),
        cmocka_unit_test(odd_meshes_are_drawn),
        cmocka_unit_test(many_layers_are_cut_off),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(unwritable_places_leave_nothing),
        cmocka_unit_test(memory_failures_leak_nothing),
        cmocka_unit_test(rows_of_a_sheet_have_names),
        cmocka_unit_test(colors_are_distinct),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
