/* SPDX-License-Identifier: Apache-2.0 */
/* Poses of guards for other programs: CSV, one line per guard, or JSON. The rotation maps a camera
 * that looks along -z with y up, as in OpenGL, glTF and Blender, to the guard's view. */
#include <math.h>

#include "core/file.h"
#include "core/json.h"
#include "geometry/vec3.h"
#include "guard/stages.h"
#include "mesh/formats/io.h"

static const char STAGE[] = "poses";

/* From a rotation matrix given by columns, by the largest of four components [Shepperd 1978]. */
static void quaternion_of(const double right[3], const double above[3], const double back[3],
                          double q[4]) {
    const double m[3][3] = {{right[0], above[0], back[0]},
                            {right[1], above[1], back[1]},
                            {right[2], above[2], back[2]}};
    double trace = m[0][0] + m[1][1] + m[2][2];
    int i = 0;
    for (int k = 1; k < 3; k++)
        i = m[k][k] > m[i][i] ? k : i;
    int j = (i + 1) % 3, k = (i + 2) % 3;
    if (trace > m[i][i]) {
        q[3] = 0.5 * sqrt(fmax(0, 1 + trace));
        for (int a = 0; a < 3; a++)
            q[a] = (m[(a + 2) % 3][(a + 1) % 3] - m[(a + 1) % 3][(a + 2) % 3]) / (4 * q[3]);
        return;
    }
    q[i] = 0.5 * sqrt(fmax(0, 1 + m[i][i] - m[j][j] - m[k][k]));
    q[j] = (m[j][i] + m[i][j]) / (4 * q[i]);
    q[k] = (m[k][i] + m[i][k]) / (4 * q[i]);
    q[3] = (m[k][j] - m[j][k]) / (4 * q[i]);
}

bool starg_guards_rotation(const starg_guards *guards, size_t index, double rotation[4]) {
    double frame[3][3], back[3];
    const double none[3] = {0, 0, 0};
    if (guards->directions == NULL)
        return false;
    sensor_frame(guards->directions + 3 * index,
                 guards->ups != NULL ? guards->ups + 3 * index : none, frame);
    vec3_subtract(none, frame[2], back);
    quaternion_of(frame[0], frame[1], back, rotation);
    return true;
}

/* Where pan is 0, and what is right of it, both level: right is along the first axis that is not
 * up, as far as that is level. With y up they are -z and x, as of a camera that is not turned; with
 * z up y and x. */
static void level_axes(const double up[3], double ahead[3], double right[3]) {
    double axis[3] = {0, 0, 0};
    axis[fabs(up[0]) > 0.9 ? 1 : 0] = 1;
    vec3_cross(up, axis, ahead);
    vec3_along(ahead, 1 / vec3_length(ahead) - 1, ahead, ahead);
    vec3_cross(ahead, up, right);
}

void starg_guards_level(const starg_guards *guards, double frame[3][3]) {
    static const double Y[3] = {0, 1, 0};
    const double *wanted = guards->options.visibility.up;
    double length = vec3_length(wanted);
    for (int k = 0; k < 3; k++)
        frame[1][k] = length > 0 ? wanted[k] / length : Y[k];
    level_axes(frame[1], frame[2], frame[0]);
}

bool starg_guards_angles(const starg_guards *guards, size_t index, double angles[3]) {
    const double DEGREES = 180 / 3.14159265358979323846, none[3] = {0, 0, 0};
    double level[3][3], own[3][3], right[3], above[3];
    if (guards->directions == NULL)
        return false;
    sensor_frame(guards->directions + 3 * index,
                 guards->ups != NULL ? guards->ups + 3 * index : none, own);
    starg_guards_level(guards, level);
    double rise = fmax(-1, fmin(1, vec3_dot(own[2], level[1])));
    bool steep = 1 - fabs(rise) < 1e-12; /* pan is then where the top of the picture is */
    const double *towards = steep ? own[1] : own[2];
    angles[0] = DEGREES * atan2(vec3_dot(towards, level[0]), vec3_dot(towards, level[2]));
    angles[1] = DEGREES * asin(rise);
    angles[2] = 0;
    if (!steep) {
        vec3_cross(own[2], level[1], right);
        vec3_cross(right, own[2], above);
        angles[2] = DEGREES * atan2(-vec3_dot(own[0], above), vec3_dot(own[0], right));
    }
    for (int k = 0; k < 3; k++)
        angles[k] = rint(angles[k] * 1e9) / 1e9 + 0.0; /* no noise, and no -0 */
    return true;
}

/* The point at distance 1 in the guard's direction. */
static void look_at_point(const starg_guards *g, size_t i, double at[3]) {
    double length = vec3_length(g->directions + 3 * i);
    vec3_along(g->positions + 3 * i, 1 / length, g->directions + 3 * i, at);
}

static bool put_csv(FILE *stream, const void *what, const char *unused) {
    const starg_guards *g = what;
    (void)unused;
    fputs(g->directions != NULL
              ? "guard,x,y,z,qx,qy,qz,qw,look_x,look_y,look_z,faces,pan,tilt,roll\n"
              : "guard,x,y,z,faces\n",
          stream);
    for (size_t i = 0; i < g->count; i++) {
        const double *p = g->positions + 3 * i;
        double q[4], at[3], angles[3];
        fprintf(stream, "%zu,%.17g,%.17g,%.17g", i, p[0], p[1], p[2]);
        if (starg_guards_rotation(g, i, q)) {
            look_at_point(g, i, at);
            fprintf(stream, ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", q[0], q[1], q[2], q[3],
                    at[0], at[1], at[2]);
        }
        fprintf(stream, ",%zu", g->seen_faces[i]);
        if (starg_guards_angles(g, i, angles))
            fprintf(stream, ",%.9g,%.9g,%.9g", angles[0], angles[1], angles[2]);
        fputc('\n', stream);
    }
    return !ferror(stream);
}

static json_t *triple(const double x[3]) {
    return json_pack("[f, f, f]", x[0], x[1], x[2]);
}

static json_t *pose_json(const starg_guards *g, size_t i) {
    double q[4], at[3], angles[3];
    if (!starg_guards_rotation(g, i, q) || !starg_guards_angles(g, i, angles))
        return json_pack("{s:o}", "position", triple(g->positions + 3 * i));
    look_at_point(g, i, at);
    return json_pack("{s:o, s:[f, f, f, f], s:o, s:f, s:f, s:f}", "position",
                     triple(g->positions + 3 * i), "rotation", q[0], q[1], q[2], q[3], "look_at",
                     triple(at), "pan", angles[0], "tilt", angles[1], "roll", angles[2]);
}

static bool put_json(FILE *stream, const void *what, const char *unused) {
    const starg_guards *g = what;
    bool done = true;
    (void)unused;
    fputs("{\n\"format\": \"starguard-poses\",\n\"version\": 1,\n", stream);
    if (g->options.visibility.fov[0] > 0)
        fprintf(stream, "\"fov\": [%.17g, %.17g],\n", g->options.visibility.fov[0],
                g->options.visibility.fov[1]);
    else if (g->options.visibility.cone < 360)
        fprintf(stream, "\"cone\": %.17g,\n", g->options.visibility.cone);
    fputs("\"poses\": [\n", stream);
    for (size_t i = 0; i < g->count && done; i++)
        done = starg_json_put(stream, "", pose_json(g, i), i + 1 < g->count ? ",\n" : "\n");
    fputs("]\n}\n", stream);
    return done && !ferror(stream);
}

starg_status starg_guards_write_poses(starg_context *context, const starg_guards *guards, bool csv,
                                      const char *path) {
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    TRY(starg_c_locale_enter(context, &locale));
    return starg_json_write(context, STAGE, path, csv ? put_csv : put_json, guards, NULL);
}
