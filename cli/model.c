/* SPDX-License-Identifier: Apache-2.0 */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "starguard/picture.h"

static const uint8_t NEUTRAL[3] = {190, 195, 200};

enum { HEAD = 1 << 16 };                    /* bytes used to recognize a file */
static const size_t MOST = (size_t)2 << 30; /* largest input in bytes, as in the library */

starg_status cli_input_read(cli_session *session) {
    const cli_command *command = session->command;
    starg_status status = STARG_OK;
    char format[64];
    if (command->input == CLI_INPUT_NONE)
        return STARG_OK;
    TRY(starg_mesh_read(session->context, session->operands[0], &session->mesh));
    snprintf(format, sizeof format, "starguard-%s", command->name);
    cli_report_head(session, format, session->operands[0], session->mesh);
    if (command->input == CLI_INPUT_SOLID) {
        status = starg_solid_create(session->context, session->mesh, &session->solid);
        starg_mesh_free(session->mesh);
        session->mesh = NULL;
    }
    return status;
}

static bool is_standard(const char *name) {
    return strcmp(name, "-") == 0;
}

static const char *shown_name(const char *name) {
    return is_standard(name) ? "standard input" : name;
}

/* Standard input and pipes can be read only once. */
static bool is_read_once(const char *name) {
    struct stat info;
    return is_standard(name) || (stat(name, &info) == 0 && S_ISFIFO(info.st_mode));
}

/* The beginning of a file; all of it if it can be read only once. */
typedef struct input_head {
    char *bytes;
    size_t size;
    bool whole;
} input_head;

static starg_status grow_head(cli_session *session, const char *name, size_t *capacity,
                              input_head *head) {
    if (*capacity > MOST)
        return cli_fail(session, STARG_ERROR_READ,
                        "'%.200s' is larger than 2 GiB, the limit for input files", name);
    char *more = realloc(head->bytes, 2 * *capacity);
    if (more == NULL)
        return cli_fail_memory(session);
    head->bytes = more;
    *capacity *= 2;
    return STARG_OK;
}

static starg_status fill_head(cli_session *session, const char *name, FILE *file,
                              input_head *head) {
    size_t capacity = HEAD, got = 1;
    head->bytes = malloc(capacity);
    if (head->bytes == NULL)
        return cli_fail_memory(session);
    while (got > 0 && (head->whole || head->size < HEAD)) {
        if (head->size == capacity)
            TRY(grow_head(session, name, &capacity, head));
        got = fread(head->bytes + head->size, 1, capacity - head->size, file);
        head->size += got;
    }
    if (head->whole && ferror(file))
        return cli_fail(session, STARG_ERROR_READ, "cannot read '%.200s': %s", name,
                        strerror(errno));
    return STARG_OK;
}

/* A file that cannot be opened has an empty head: the reader reports why. */
static starg_status read_head(cli_session *session, const char *name, input_head *head) {
    starg_status status = STARG_OK;
    FILE *file = is_standard(name) ? stdin : fopen(name, "rb");
    *head = (input_head){.whole = file != NULL && is_read_once(name)};
    if (file != NULL)
        status = fill_head(session, shown_name(name), file, head);
    if (file != NULL && file != stdin)
        fclose(file);
    return status;
}

static starg_status read_mesh(cli_session *session, const char *file, const input_head *head,
                              starg_mesh **mesh) {
    return head->whole ? starg_mesh_read_memory(session->context, head->bytes, head->size,
                                                shown_name(file), mesh)
                       : starg_mesh_read(session->context, file, mesh);
}

static starg_status read_tetmesh(cli_session *session, const char *file, const input_head *head,
                                 starg_tetmesh **tetmesh) {
    return head->whole ? starg_tetmesh_read_memory(session->context, head->bytes, head->size,
                                                   shown_name(file), tetmesh)
                       : starg_tetmesh_read(session->context, file, tetmesh);
}

static starg_status read_descriptor(cli_session *session, const char *file, const input_head *head,
                                    starg_descriptor **descriptor) {
    return head->whole ? starg_descriptor_read_memory(session->context, head->bytes, head->size,
                                                      shown_name(file), descriptor)
                       : starg_descriptor_read(session->context, file, descriptor);
}

starg_status cli_shape_read(cli_session *session, const char *file, starg_mesh **mesh,
                            starg_tetmesh **tetmesh) {
    starg_status status = STARG_OK;
    input_head head;
    *mesh = NULL;
    *tetmesh = NULL;
    CLI_TRY(read_head(session, file, &head));
    if (head.bytes != NULL && starg_tetmesh_recognized(head.bytes, head.size, file))
        status = read_tetmesh(session, file, &head, tetmesh);
    else
        status = read_mesh(session, file, &head, mesh);
done:
    free(head.bytes);
    return status;
}

starg_status cli_described_read(cli_session *session, const char *file, starg_mesh **mesh,
                                starg_descriptor **descriptor) {
    starg_status status = STARG_OK;
    input_head head;
    *mesh = NULL;
    *descriptor = NULL;
    CLI_TRY(read_head(session, file, &head));
    if (head.bytes != NULL && starg_descriptor_recognized(head.bytes, head.size))
        status = read_descriptor(session, file, &head, descriptor);
    else
        status = read_mesh(session, file, &head, mesh);
done:
    free(head.bytes);
    return status;
}

starg_status cli_mesh_format(cli_session *session, const char *name, starg_mesh_format *format) {
    static const cli_extension known[] = {{".off", STARG_MESH_OFF},
                                          {".obj", STARG_MESH_OBJ},
                                          {".ply", STARG_MESH_PLY_BINARY},
                                          {".stl", STARG_MESH_STL_BINARY},
                                          {".vtp", STARG_MESH_VTP}};
    int found;
    starg_status status = cli_format_by_extension(
        session, name, known, sizeof known / sizeof *known, STARG_MESH_OFF, &found);
    *format = (starg_mesh_format)found;
    return status;
}

starg_status cli_announce_marks(cli_session *session, const char *option, const char *name) {
    bool grid = name != NULL && cli_has_extension(name, ".vtp");
    return cli_announce_with_extension(session, option, name, grid ? ".vtp" : ".ply");
}

/* Of each face the first row that contains it, else -1. */
static void number_by_viewer(const starg_bits *seen, size_t faces, int32_t *numbers) {
    for (size_t f = 0; f < faces; f++)
        numbers[f] = -1;
    for (size_t row = starg_bits_rows(seen); row-- > 0;)
        for (size_t f = 0; f < faces && f < starg_bits_columns(seen); f++)
            if (starg_bits_test(seen, row, f))
                numbers[f] = (int32_t)row;
}

starg_status cli_marks_write(cli_session *session, const starg_mesh *mesh, const uint8_t *colors,
                             const int32_t *marks, const starg_bits *seen, const char *name) {
    starg_mesh_write_options options;
    int32_t *numbers = NULL;
    size_t faces = starg_mesh_face_count(mesh);
    starg_mesh_write_options_default(&options);
    options.format = cli_has_extension(name, ".vtp") ? STARG_MESH_VTP : STARG_MESH_PLY_BINARY;
    options.face_colors = colors;
    options.face_marks = marks;
    if (seen != NULL && options.format == STARG_MESH_VTP) {
        numbers = malloc((faces + 1) * sizeof *numbers);
        if (numbers == NULL)
            return cli_fail_memory(session);
        number_by_viewer(seen, faces, numbers);
        options.face_marks = numbers;
    }
    starg_status status = cli_mesh_write_with(session, mesh, &options, name);
    free(numbers);
    return status;
}

starg_status cli_mesh_write(cli_session *session, const starg_mesh *mesh, starg_mesh_format format,
                            const char *name) {
    starg_mesh_write_options options;
    starg_mesh_write_options_default(&options);
    options.format = format;
    return cli_mesh_write_with(session, mesh, &options, name);
}

starg_status cli_mesh_write_with(cli_session *session, const starg_mesh *mesh,
                                 const starg_mesh_write_options *options, const char *name) {
    return starg_mesh_write(session->context, mesh, cli_outputs_place(&session->outputs, name),
                            options);
}

uint8_t *cli_colors_create(const starg_mesh *mesh) {
    size_t count = starg_mesh_face_count(mesh);
    uint8_t *colors = malloc(3 * count + 1);
    for (size_t i = 0; colors != NULL && i < count; i++)
        memcpy(colors + 3 * i, NEUTRAL, sizeof NEUTRAL);
    return colors;
}

void cli_colors_by_viewer(uint8_t *colors, const starg_bits *seen) {
    for (size_t row = starg_bits_rows(seen); row-- > 0;) {
        uint8_t rgb[3];
        starg_distinct_color(row, rgb);
        for (size_t face = 0; face < starg_bits_columns(seen); face++)
            if (starg_bits_test(seen, row, face))
                memcpy(colors + 3 * face, rgb, sizeof rgb);
    }
}

/* Twice the area, in units of `unit` so that squares neither overflow nor underflow. */
static double doubled_area(const double *vertices, const uint32_t *corners, double unit) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        double base = vertices[3 * corners[0] + k] / unit;
        u[k] = vertices[3 * corners[1] + k] / unit - base;
        v[k] = vertices[3 * corners[2] + k] / unit - base;
    }
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
           z = u[0] * v[1] - u[1] * v[0];
    return sqrt(x * x + y * y + z * z);
}

double *cli_area_fractions(const starg_mesh *mesh, size_t count) {
    double *areas = malloc((count + 1) * sizeof *areas);
    double lower[3], upper[3], unit = 0, sum = 0;
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        unit = fmax(unit, upper[k] - lower[k]);
    for (size_t i = 0; areas != NULL && i < count; i++) {
        areas[i] = doubled_area(starg_mesh_vertices(mesh), starg_mesh_faces(mesh) + 3 * i, unit);
        sum += areas[i];
    }
    for (size_t i = 0; areas != NULL && i < count; i++)
        areas[i] /= sum;
    return areas;
}

json_t *cli_json_row(cli_session *session, const starg_bits *bits, size_t row) {
    json_t *list = json_array();
    for (size_t i = 0; i < starg_bits_columns(bits); i++)
        if (starg_bits_test(bits, row, i))
            cli_append(session, list, json_integer((json_int_t)i));
    return list;
}

json_t *cli_json_indices(cli_session *session, const uint32_t *indices, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        cli_append(session, list, json_integer((json_int_t)indices[i]));
    return list;
}

cli_amount cli_count_of(size_t count, const char *singular, const char *plural) {
    cli_amount amount;
    snprintf(amount.text, sizeof amount.text, "%zu %s", count, count == 1 ? singular : plural);
    return amount;
}
