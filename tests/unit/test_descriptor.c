/* SPDX-License-Identifier: Apache-2.0 */
/* Descriptors: distances in closed form, files read back and broken, reconstruction. */
#include "starguard/descriptor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "models.h"

static starg_descriptor *describe(starg_context *context, const starg_mesh *mesh,
                                  size_t directions) {
    starg_descriptor_options options;
    starg_descriptor *d = NULL;
    starg_descriptor_options_default(&options);
    options.direction_count = directions;
    options.effort = 1;
    options.detail = 0;
    test_ok(context, starg_descriptor_create(context, mesh, &options, &d));
    assert_int_equal(d->direction_count, directions);
    assert_int_equal(d->detail, 0);
    return d;
}

static double length(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Unit vectors whose sum and second moments are those of the whole sphere. */
static void directions_cover_the_sphere(void **state) {
    (void)state;
    const size_t counts[] = {12, 100, 256, 4096};
    for (size_t c = 0; c < 4; c++) {
        double sum[3] = {0, 0, 0}, products[6] = {0}, n = (double)counts[c];
        for (size_t i = 0; i < counts[c]; i++) {
            double d[3];
            starg_descriptor_direction(counts[c], i, d);
            assert_true(fabs(length(d) - 1) < 1e-14);
            for (size_t k = 0; k < 3; k++) {
                sum[k] += d[k] / n;
                products[k] += d[k] * d[k] / n;
                products[3 + k] += d[k] * d[(k + 1) % 3] / n;
            }
        }
        for (size_t k = 0; k < 3; k++) {
            assert_true(fabs(sum[k]) < 1 / n);
            assert_true(fabs(products[k] - 1.0 / 3) < 2 / n);
            assert_true(fabs(products[3 + k]) < 2 / n);
        }
    }
}

/* Inside a box the boundary is where the ray meets the first of the six planes. */
static void distances_in_a_box(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape s = shape_cube(2);
    starg_mesh *mesh = test_mesh_of(context, &s);
    starg_descriptor *d = describe(context, mesh, 500);
    assert_int_equal(d->guard_count, 1);
    assert_int_equal(d->edge_count, 0);
    assert_true(fabs(d->guards[0].volume - 8) < 1e-12);
    assert_true(fabs(d->diagonal - sqrt(12)) < 1e-12);
    for (size_t i = 0; i < 500; i++) {
        double u[3], expected = INFINITY;
        starg_descriptor_direction(500, i, u);
        for (int k = 0; k < 3; k++) {
            double p = d->guards[0].position[k];
            expected = fmin(expected, u[k] > 0 ? (2 - p) / u[k] : u[k] < 0 ? -p / u[k] : INFINITY);
        }
        assert_true(fabs(d->distances[i] - expected) < 1e-12);
    }
    starg_descriptor_free(context, d);
    starg_mesh_free(mesh);
    shape_free(&s);
    test_context_free(context);
}

/* Volumes sum to that of the model, every distance ends at the first surface point along the ray,
 * and gates lie in the box of the model. */
static void pieces_of_figures(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const char *names[] = {"l-room", "torus", "octopus"};
    for (size_t n = 0; n < 3; n++) {
        starg_mesh *mesh = test_sample_mesh(context, names[n], 600);
        starg_descriptor *d = describe(context, mesh, 64);
        starg_reconstruction r;
        double volume = 0, lower[3], upper[3];
        starg_mesh_bounds(mesh, lower, upper);
        for (size_t g = 0; g < d->guard_count; g++)
            volume += d->guards[g].volume;
        assert_true(fabs(volume / starg_mesh_volume(mesh) - 1) < 0.05);
        for (size_t e = 0; e < d->edge_count; e++) {
            assert_true(d->edges[e].first < d->edges[e].second);
            assert_true(d->edges[e].second < d->guard_count);
            assert_true(d->edges[e].area > 0);
            for (int k = 0; k < 3; k++)
                assert_true(d->edges[e].gate[k] > lower[k] && d->edges[e].gate[k] < upper[k]);
        }
        assert_true(d->edge_count + 1 >= d->guard_count); /* connected */
        test_ok(context, starg_descriptor_reconstruct(context, d, mesh, &r));
        assert_true(r.to_largest < 0.05);
        starg_descriptor_free(context, d);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* More directions sample the surface more densely: gaps between points fall with the square root of
 * their number. */
static void reconstruction_gets_closer(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = test_sample_mesh(context, "sphere", 520);
    starg_reconstruction coarse, fine;
    starg_descriptor *a = describe(context, mesh, 100), *b = describe(context, mesh, 6400);
    test_ok(context, starg_descriptor_reconstruct(context, a, mesh, &coarse));
    test_ok(context, starg_descriptor_reconstruct(context, b, mesh, &fine));
    assert_int_equal(coarse.points, 100 * a->guard_count);
    assert_true(coarse.to_largest < 0.02 && fine.to_largest < 0.02);
    assert_true(coarse.from_mean > 0 && coarse.from_largest > coarse.from_mean);
    assert_true(fine.from_mean < coarse.from_mean / 4);
    assert_true(fine.from_largest < coarse.from_largest / 4);
    starg_descriptor_free(context, a);
    starg_descriptor_free(context, b);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* ---- parts that do not depend on guards ---- */

/* From points uniform in a unit ball, the boundary is 3/4 away on average. The shell has the
 * spectrum of the sphere: l (l + 1) times 4 pi, 2 l + 1 times each. */
static void views_and_spectra_of_a_ball(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_mesh *mesh = test_sample_mesh(context, "sphere", 3000);
    starg_descriptor *d = describe(context, mesh, 12);
    double radius = d->diagonal / sqrt(12), mean = 0;
    for (size_t k = 0; k < STARG_DESCRIPTOR_VIEW; k++)
        for (size_t i = 0; i < STARG_DESCRIPTOR_SPREAD; i++) {
            double length = d->views[k][i];
            mean += length / radius / (STARG_DESCRIPTOR_VIEW * STARG_DESCRIPTOR_SPREAD);
            assert_true(length > 0 && length < 2 * radius);
            assert_true(i == 0 || length >= d->views[k][i - 1]);
            assert_true(k == 0 || length >= d->views[k - 1][i]);
        }
    assert_true(fabs(mean - 0.75) < 0.02);
    for (size_t l = 1, i = 0; l <= 4; l++)
        for (size_t k = 0; k < 2 * l + 1; k++, i++) {
            double expected = 4 * 3.14159265358979323846 * (double)(l * (l + 1));
            assert_true(fabs(d->surface_spectrum[i] / expected - 1) < 0.01);
        }
    /* By the addition theorem, modes of any degree are equally strong everywhere; anything above
     * the energies of the fifth one is cut off within the sixth. */
    for (size_t e = 0; e < STARG_DESCRIPTOR_ENERGIES - 4; e++)
        for (size_t i = 0; i < STARG_DESCRIPTOR_SPREAD; i++)
            assert_true(fabs(d->wave_kernel[e][i] - 1) < 0.05);
    starg_descriptor_free(context, d);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* A square bar of length 4 QUARTER, twice as thick in its outer quarters, with pointed ends. */
static shape dumbbell(void) {
    enum { QUARTER = 24, RINGS = 4 * QUARTER + 1, RING = 4 };
    shape s = {.vertex_count = RING * RINGS + 2, .face_count = 2 * RING * RINGS};
    s.vertices = calloc(3 * s.vertex_count, sizeof *s.vertices);
    s.faces = calloc(3 * s.face_count, sizeof *s.faces);
    assert_true(s.vertices != NULL && s.faces != NULL);
    for (size_t i = 0; i < RINGS; i++)
        for (size_t k = 0; k < RING; k++) {
            double *p = s.vertices + 3 * (RING * i + k);
            double half = i > QUARTER && i < 3 * QUARTER ? 0.5 : 1;
            p[0] = (double)i;
            p[1] = k == 0 || k == 3 ? -half : half;
            p[2] = k < 2 ? -half : half;
        }
    s.vertices[3 * (s.vertex_count - 2)] = -1;
    s.vertices[3 * (s.vertex_count - 1)] = 4 * QUARTER + 1;
    uint32_t *f = s.faces, first = (uint32_t)s.vertex_count - 2, far = RING * (RINGS - 1);
    for (uint32_t i = 0; i < RINGS - 1; i++)
        for (uint32_t k = 0; k < RING; k++, f += 6) {
            uint32_t one = RING * i + k, two = RING * i + (k + 1) % RING;
            const uint32_t both[6] = {one, one + RING, two, two, one + RING, two + RING};
            memcpy(f, both, sizeof both);
        }
    for (uint32_t k = 0; k < RING; k++, f += 6) {
        uint32_t next = (k + 1) % RING;
        const uint32_t both[6] = {first, k, next, first + 1, far + next, far + k};
        memcpy(f, both, sizeof both);
    }
    return s;
}

/* Slow modes of a bar are those of a one-dimensional one with mass and stiffness in proportion to
 * the perimeter. With thick quarters at the ends, and q the ratio of the perimeters of middle to
 * ends, the first mode has wave number 2 atan(sqrt q), the second one pi, in units of half the
 * length. */
static void spectra_of_a_dumbbell(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = dumbbell();
    starg_mesh *mesh = test_mesh_of(context, &s);
    starg_descriptor *d = describe(context, mesh, 12);
    const double pi = 3.14159265358979323846;
    double of_surface = pow(2 * atan(sqrt(1.0 / 2)) / pi, 2);
    assert_true(fabs(d->surface_spectrum[0] / d->surface_spectrum[1] / of_surface - 1) < 0.05);
    starg_descriptor_free(context, d);
    starg_mesh_free(mesh);
    shape_free(&s);
    test_context_free(context);
}

/* ---- files ---- */

static const char *scratch_path(void) {
    static char path[64];
    snprintf(path, sizeof path, "test_descriptor_%ld.json", (long)getpid());
    return path;
}

/* The file's text; the caller frees it. */
static char *text_of(starg_context *context, const starg_descriptor *d, size_t *size) {
    test_ok(context, starg_descriptor_write(context, d, "models/a.off", scratch_path()));
    FILE *file = fopen(scratch_path(), "rb");
    assert_non_null(file);
    char *text = malloc(1 << 20);
    assert_non_null(text);
    *size = fread(text, 1, (1 << 20) - 1, file);
    text[*size] = '\0';
    fclose(file);
    unlink(scratch_path());
    return text;
}

static starg_descriptor *figure(starg_context *context) {
    starg_mesh *mesh = test_sample_mesh(context, "torus", 500);
    starg_descriptor *d = describe(context, mesh, 12);
    assert_true(d->guard_count > 1 && d->edge_count > 0);
    starg_mesh_free(mesh);
    return d;
}

static void there_and_back(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_descriptor *d = figure(context), *back = NULL;
    size_t size, again;
    char *text = text_of(context, d, &size);
    assert_true(starg_descriptor_recognized(text, size));
    assert_false(starg_descriptor_recognized("OFF\n{", 5));
    assert_false(starg_descriptor_recognized("  ", 2));
    test_ok(context, starg_descriptor_read_memory(context, text, size, "a", &back));
    assert_string_equal(back->file, "models/a.off");
    assert_int_equal(back->guard_count, d->guard_count);
    assert_int_equal(back->edge_count, d->edge_count);
    assert_int_equal(back->effort, 1);
    assert_memory_equal(back->views, d->views, sizeof d->views);
    assert_memory_equal(back->surface_spectrum, d->surface_spectrum, sizeof d->surface_spectrum);
    assert_memory_equal(back->wave_kernel, d->wave_kernel, sizeof d->wave_kernel);
    assert_memory_equal(back->guards, d->guards, d->guard_count * sizeof *d->guards);
    assert_memory_equal(back->distances, d->distances,
                        d->guard_count * d->direction_count * sizeof *d->distances);
    char *second = text_of(context, back, &again);
    assert_string_equal(text, second);
    free(text);
    free(second);
    starg_descriptor_free(context, d);
    starg_descriptor_free(context, back);
    test_context_free(context);
}

/* Replaces the first occurrence of a text. */
static char *replaced(const char *text, const char *old, const char *new) {
    const char *place = strstr(text, old);
    assert_non_null(place);
    char *out = malloc(strlen(text) + strlen(new) + 1);
    assert_non_null(out);
    memcpy(out, text, (size_t)(place - text));
    strcpy(out + (place - text), new);
    strcat(out, place + strlen(old));
    return out;
}

/* Files of version 3 had one more spectrum. */
static void older_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_descriptor *d = figure(context), *back = NULL;
    size_t size, again;
    char *text = text_of(context, d, &size);
    char *third = replaced(text, "\"version\": 5,", "\"version\": 3,\n\"solid_spectrum\": [1, 2],");
    test_ok(context,
            starg_descriptor_read_memory(context, third, strlen(third), "old.json", &back));
    assert_memory_equal(back->surface_spectrum, d->surface_spectrum, sizeof d->surface_spectrum);
    assert_memory_equal(back->wave_kernel, d->wave_kernel, sizeof d->wave_kernel);
    starg_descriptor_free(context, back);
    test_ok(context, starg_descriptor_read_memory(context, text, size, "new.json", &back));
    char *second = text_of(context, back, &again);
    assert_null(strstr(second, "solid_spectrum"));
    free(second);
    free(third);
    free(text);
    starg_descriptor_free(context, back);
    starg_descriptor_free(context, d);
    test_context_free(context);
}

static void refuse(starg_context *context, const char *text, size_t size) {
    starg_descriptor *d = NULL;
    assert_int_equal(starg_descriptor_read_memory(context, text, size, "broken.json", &d),
                     STARG_ERROR_FORMAT);
    assert_null(d);
    assert_non_null(strstr(starg_context_error(context)->message, "broken.json"));
}

static void broken_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_descriptor *d = figure(context);
    size_t size;
    char *text = text_of(context, d, &size);
    for (size_t cut = 0; cut + 2 < size; cut += 1 + size / 400)
        refuse(context, text, cut);
    const char *changes[][2] = {
        {"\"version\": 5", "\"version\": 2"},
        {"\"version\": 5", "\"version\": 6"},
        {"\"version\": 5", "\"version\": \"5\""},
        {"starguard-descriptor", "starguard-guards"},
        {"\"directions\": 12", "\"directions\": 13"},
        {"\"directions\": 12", "\"directions\": 0"},
        {"\"directions\": 12", "\"directions\": 1e99"},
        {"\"directions\": 12", "\"directions\": 4294967295"},
        {"\"detail\": 0", "\"detail\": -1"},
        {"\"effort\": 1", "\"effort\": -1"},
        {"\"views\": [", "\"views\": [1, "},
        {"\"views\": [", "\"views\": [-"},
        {"\"views\": [", "\"others\": ["},
        {"\"surface_spectrum\": [", "\"surface_spectrum\": [null, "},
        {"\"waves\": [", "\"waves\": [1, "},
        {"\"waves\": [", "\"waves\": [-"},
        {"\"diagonal\":", "\"diagonal\":-"},
        {"\"position\":[", "\"position\":[1,"},
        {"\"position\":[", "\"position\":[1e101,"},
        {"\"volume\":", "\"volume\":-"},
        {"\"distances\":[", "\"distances\":[-"},
        {"\"distances\":[", "\"distances\":[null,"},
        {"\"guards\": [", "\"guards\": [3,"},
        {"\"guards\": [", "\"guards\": [], \"others\": ["},
        {"\"edges\": [", "\"edges\": {}, \"others\": ["},
        {"\"guards\":[0,", "\"guards\":[-1,"},
        {"\"guards\":[0,", "\"guards\":[7777,"},
        {"\"guards\":[0,", "\"guards\":[0,0,"},
        {"\"area\":", "\"area\":-"},
        {"\"gate\":[", "\"gate\":[true,"},
    };
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        char *changed = replaced(text, changes[i][0], changes[i][1]);
        refuse(context, changed, strlen(changed));
        free(changed);
    }
    starg_descriptor *none = NULL;
    assert_int_equal(starg_descriptor_read(context, "no/such/file", &none), STARG_ERROR_READ);
    assert_null(none);
    free(text);
    starg_descriptor_free(context, d);
    test_context_free(context);
}

/* ---- failures ---- */

static void refused(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_tetrahedron();
    starg_mesh *mesh = test_mesh_of(context, &s), *flat = NULL;
    const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t face[] = {0, 1, 2};
    starg_descriptor_options options;
    starg_descriptor *d = NULL;
    starg_signature *signature = NULL;
    starg_descriptor_options_default(&options);
    const size_t counts[] = {0, 11, 65537};
    for (size_t i = 0; i < 3; i++) {
        options.direction_count = counts[i];
        assert_int_equal(starg_descriptor_create(context, mesh, &options, &d),
                         STARG_ERROR_ARGUMENT);
    }
    options.direction_count = 12;
    options.effort = 0;
    assert_int_equal(starg_descriptor_create(context, mesh, &options, &d), STARG_ERROR_ARGUMENT);
    options.effort = 1;
    options.detail = 99;
    assert_int_equal(starg_descriptor_create(context, mesh, &options, &d), STARG_ERROR_ARGUMENT);
    test_ok(context, starg_mesh_create(context, points, 3, face, 1, &flat));
    assert_int_equal(starg_descriptor_create(context, flat, NULL, &d), STARG_ERROR_MESH);
    assert_null(d);
    d = describe(context, mesh, 12);
    assert_int_equal(starg_signature_of_descriptor(context, d, STARG_SIGNATURE_D2, &signature),
                     STARG_ERROR_ARGUMENT);
    assert_null(signature);
    starg_descriptor_free(context, d);
    starg_mesh_free(mesh);
    starg_mesh_free(flat);
    shape_free(&s);
    test_context_free(context);
}

static void same_on_any_threads(void **state) {
    (void)state;
    starg_context *one = test_context(1), *four = test_context(4);
    starg_mesh *mesh = test_sample_mesh(one, "torus", 500);
    starg_descriptor *a = describe(one, mesh, 40), *b = describe(four, mesh, 40);
    size_t a_size, b_size;
    char *a_text = text_of(one, a, &a_size), *b_text = text_of(four, b, &b_size);
    assert_string_equal(a_text, b_text);
    free(a_text);
    free(b_text);
    starg_descriptor_free(one, a);
    starg_descriptor_free(four, b);
    starg_mesh_free(mesh);
    test_context_free(one);
    test_context_free(four);
}

/* Everything after the decomposition, which has its own memory tests. */
static void memory_may_give_out(void **state) {
    (void)state;
    size_t left = SIZE_MAX, size, failures = 0;
    starg_context *context = test_scarce_context(1, &left);
    starg_mesh *mesh = test_sample_mesh(context, "l-room", 520);
    starg_descriptor *d = describe(context, mesh, 12), *back = NULL;
    char *text = text_of(context, d, &size);
    size_t before = starg_context_live_blocks(context);
    starg_status status = STARG_ERROR_MEMORY;
    for (; status != STARG_OK; failures++) {
        left = failures;
        status = starg_descriptor_read_memory(context, text, size, "a", &back);
        left = SIZE_MAX;
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        assert_true(status == STARG_OK || starg_context_live_blocks(context) == before);
    }
    assert_true(failures > 4);
    before = starg_context_live_blocks(context);
    status = STARG_ERROR_MEMORY;
    for (failures = 0; status != STARG_OK; failures++) {
        starg_reconstruction r;
        left = failures;
        status = starg_descriptor_reconstruct(context, d, mesh, &r);
        left = SIZE_MAX;
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
    assert_true(failures > 4);
    free(text);
    starg_descriptor_free(context, d);
    starg_descriptor_free(context, back);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(directions_cover_the_sphere),
        cmocka_unit_test(distances_in_a_box),
        cmocka_unit_test(pieces_of_figures),
        cmocka_unit_test(reconstruction_gets_closer),
        cmocka_unit_test(views_and_spectra_of_a_ball),
        cmocka_unit_test(spectra_of_a_dumbbell),
        cmocka_unit_test(there_and_back),
        cmocka_unit_test(older_files),
        cmocka_unit_test(broken_files),
        cmocka_unit_test(refused),
        cmocka_unit_test(same_on_any_threads),
        cmocka_unit_test(memory_may_give_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
