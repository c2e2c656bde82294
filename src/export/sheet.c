/* SPDX-License-Identifier: Apache-2.0 */
/* A sheet to hand over: one HTML file that prints well, without scripts and network.
 *
 * Stages: what guards see, once; the plan and the pictures through lenses, as PNG in base64; then
 * the page from top to bottom, each picture being drawn where it stands. All numbers are computed
 * from the poses anew. Names are text: what HTML could take for markup is escaped. Cost: that of
 * the pictures, and of the bits of all rows. */
#include "export/export.h"

#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "core/memory.h"
#include "geometry/vec3.h"
#include "guard/stages.h"
#include "mesh/formats/io.h"
#include "starguard/page.h"
#include "starguard/picture.h"

static const char STAGE[] = "sheet";

enum { ALL_FACES = 60 }; /* of a model with more, only the worst are listed, as many at most */

typedef struct sheet {
    starg_context *context;
    const starg_sheet *told;
    const starg_guards *guards;
    sheet_scene scene;
    FILE *stream;
    seen_area *areas;   /* by guard */
    group_area *groups; /* and of all targets */
    size_t group_count;
} sheet;

static const char HEAD[] =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
    "style-src 'unsafe-inline'\">\n"
    "<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n"
    "@page{size:A4;margin:14mm 13mm}\n"
    "body{font:10.5pt/1.4 system-ui,sans-serif;color:#1c2430;max-width:60rem;margin:2rem auto;"
    "padding:0 1rem}\n"
    "h1{font-size:1.6em;margin:0 0 .2em}\nh2{font-size:1.15em;margin:1.5em 0 .4em;"
    "break-after:avoid}\np{margin:.3em 0}\n"
    "table{border-collapse:collapse;width:100%;font-size:.86em;"
    "font-variant-numeric:tabular-nums}\n"
    "th,td{padding:.2em .45em;border-bottom:1px solid #d5d9df;text-align:right;"
    "white-space:nowrap}\n"
    "th{font-weight:600;border-bottom-color:#6b7685;vertical-align:bottom}\n"
    "td.t,th.t{text-align:left}\ntd.w{white-space:normal;overflow-wrap:anywhere}\n"
    "tr{break-inside:avoid}\nthead{display:table-header-group}\n"
    "svg{display:block;width:100%;height:auto;max-height:21cm}\n"
    ".lenses{display:grid;grid-template-columns:repeat(3,1fr);gap:.9em .8em}\n"
    "figure{margin:0;break-inside:avoid}\nfigcaption{font-size:.82em}\n"
    ".lenses svg{border:1px solid #8a93a0;max-height:7.5cm}\n"
    ".key span{display:inline-block;margin-right:1.2em}\n"
    ".key i{display:inline-block;width:1.1em;height:.8em;margin-right:.35em;"
    "border:1px solid #8a93a0}\n"
    ".small{font-size:.82em;color:#4c5665}\ncode{overflow-wrap:anywhere}\n"
    "@media print{body{margin:0;max-width:none;padding:0;font-size:9.5pt;"
    "print-color-adjust:exact;-webkit-print-color-adjust:exact}}\n</style>\n";

/* ---- text ---- */

static void put_text(FILE *stream, const char *text) {
    for (; *text != '\0'; text++) {
        const char *escaped = *text == '<'   ? "&lt;"
                              : *text == '>' ? "&gt;"
                              : *text == '&' ? "&amp;"
                              : *text == '"' ? "&quot;"
                                             : NULL;
        if (escaped != NULL)
            fputs(escaped, stream);
        else
            fputc((unsigned char)*text < 32 ? ' ' : *text, stream);
    }
}

static void put_percent(FILE *stream, double part, double all) {
    double share = 100 * seen_ratio(part, all);
    if (share > 99.95 && share < 100) /* not all */
        share = 99.9;
    fprintf(stream, "<td>%.1f %%</td>", share);
}

static void put_real(FILE *stream, double value) {
    fprintf(stream, "<td>%.6g</td>", value + 0.0);
}

static void put_heads(FILE *stream, const char *const *heads, size_t count) {
    fputs("<table>\n<thead><tr>", stream);
    for (size_t i = 0; i < count; i++) /* a leading < is for text */
        fprintf(stream, "<th%s>%s</th>", heads[i][0] == '<' ? " class=\"t\"" : "",
                heads[i] + (heads[i][0] == '<'));
    fputs("</tr></thead>\n<tbody>\n", stream);
}

#define PUT_HEADS(STREAM, ...)                                                                     \
    put_heads(STREAM, (const char *const[]){__VA_ARGS__},                                          \
              sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *))

static const char END[] = "</tbody>\n</table>\n";

static void put_color(FILE *stream, const uint8_t rgb[3]) {
    fprintf(stream, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
}

static void put_image(FILE *stream, const sheet_picture *picture) {
    starg_page_block block = {.stream = stream};
    fprintf(stream, "<image width=\"%zu\" height=\"%zu\" href=\"data:image/png;base64,",
            picture->width, picture->height);
    starg_page_block_bytes(&block, picture->png, picture->size);
    starg_page_block_end(&block);
    fputs("\"/>\n", stream);
}

static bool is_kept(const sheet *s, size_t guard) {
    return s->guards->kept != NULL && s->guards->kept[guard];
}

static size_t count_kept(const sheet *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->guards->count; i++)
        count += is_kept(s, i);
    return count;
}

/* ---- summary ---- */

static void put_sensor(const sheet *s) {
    const starg_visibility_options *o = &s->guards->options.visibility;
    FILE *f = s->stream;
    if (o->fov[0] > 0)
        fprintf(f, "field of view %g by %g degrees; ", o->fov[0], o->fov[1]);
    else if (o->cone < 360)
        fprintf(f, "cone of %g degrees; ", o->cone);
    else
        fputs("all directions; ", f);
    if (o->resolution[0] > 0)
        fprintf(f, "%g by %g pixels; ", o->resolution[0], o->resolution[1]);
    if (o->density > 0)
        fprintf(f, "seen within a depth of %.6g by the density of pixels; ",
                starg_density_depth(o, 0));
    if (o->near > 0)
        fprintf(f, "from a distance of %g; ", o->near);
    if (o->range < 1e100)
        fprintf(f, "range %g; ", o->range);
    if (o->incidence > 0)
        fprintf(f, "up to %g degrees from the normal; ", o->incidence);
    if (o->tilt[0] != STARG_TILT_ANY)
        fprintf(f, "tilt %g to %g degrees; ", o->tilt[0], o->tilt[1]);
    fputs("lengths in units of the model", f);
}

static void put_row(FILE *f, const char *name) {
    fprintf(f, "<tr><td class=\"t\">%s</td><td class=\"t w\">", name);
}

static void put_bound(const sheet *s) {
    const starg_guards *g = s->guards;
    size_t added = g->count - count_kept(s);
    if (g->lower_bound_everywhere > 0)
        fprintf(s->stream, "; wherever they stand, at least %zu%s", g->lower_bound_everywhere,
                count_kept(s) > 0 ? " more" : "");
    else if (g->lower_bound > 0)
        fprintf(s->stream, "; of the places tried, at least %zu%s", g->lower_bound,
                count_kept(s) > 0 ? " more" : "");
    if (added > 0 && (g->optimal_everywhere || g->optimal))
        fputs(": no fewer do", s->stream);
}

static void put_summary(const sheet *s) {
    const starg_guards *g = s->guards;
    const group_area *all = &s->groups[s->group_count];
    size_t kept = count_kept(s);
    FILE *f = s->stream;
    fputs("<h2>Summary</h2>\n<table><tbody>\n", f);
    put_row(f, "Model");
    put_text(f, g->file != NULL ? g->file : "-");
    fprintf(f, ", %zu faces</td></tr>\n", g->face_count);
    put_row(f, "Cameras");
    fprintf(f, "%zu", g->count);
    if (kept > 0)
        fprintf(f, ": %zu stay, %zu are new", kept, g->count - kept);
    put_bound(s);
    fputs("</td></tr>\n", f);
    put_row(f, "Each");
    put_sensor(s);
    fputs("</td></tr>\n", f);
    put_row(f, "Area to be seen");
    fprintf(f, "%.6g; by one camera or more %.1f %%, by two %.1f %%, by three %.1f %%</td></tr>\n",
            all->all, 100 * seen_ratio(all->by[0], all->all),
            100 * seen_ratio(all->by[1], all->all), 100 * seen_ratio(all->by[2], all->all));
    if (g->need_count > 0) {
        put_row(f, "Needs");
        fprintf(f, "%zu of %zu faces with needs of their own have them</td></tr>\n", g->met_needs,
                g->need_count);
    }
    if (g->zone_count > 0) {
        put_row(f, "Zones");
        size_t without = 0;
        for (size_t i = 0; i < g->zone_count; i++)
            without += g->zones[i].excludes;
        fprintf(f, "%zu where cameras may stand, %zu where none may</td></tr>\n",
                g->zone_count - without, without);
    }
    if (s->told->command != NULL) {
        put_row(f, "Made by");
        fputs("<code>", f);
        put_text(f, s->told->command);
        fputs("</code></td></tr>\n", f);
    }
    fputs(END, f);
}

/* ---- plan ---- */

static void project(const sheet *s, const sheet_plan *plan, const double p[3], double out[2]) {
    out[0] = plan->x + plan->scale * vec3_dot(p, s->scene.level[0]);
    out[1] = plan->y - plan->scale * vec3_dot(p, s->scene.level[2]);
}

static int by_place(const void *a, const void *b) {
    const double *p = a, *q = b;
    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

static double turn(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* The convex hull of a few points, which are sorted (monotone chain). */
static size_t find_hull(double (*points)[2], size_t count, double (*hull)[2]) {
    size_t size = 0;
    qsort(points, count, sizeof *points, by_place);
    for (size_t pass = 0; pass < 2; pass++) {
        size_t first = size;
        for (size_t i = 0; i < count; i++) {
            const double *p = points[pass == 0 ? i : count - 1 - i];
            while (size >= first + 2 && turn(hull[size - 2], hull[size - 1], p) <= 0)
                size--;
            hull[size][0] = p[0];
            hull[size++][1] = p[1];
        }
        size--; /* the last is the first of the other side */
    }
    return size;
}

/* What its view covers of the plan, as far as it reaches, or a tenth of the model. */
static void put_view(const sheet *s, const sheet_plan *plan, const scene_job *job, size_t guard) {
    double points[VIEW_SIDES + 1][2], hull[2 * VIEW_SIDES + 4][2], corner[3];
    size_t sides = scene_view_sides(job);
    for (size_t k = 0; k <= sides; k++) {
        scene_view_corner(job, guard, k, corner);
        project(s, plan, corner, points[k]);
    }
    size_t count = sides > 0 ? find_hull(points, sides + 1, hull) : 0;
    uint8_t rgb[3];
    starg_distinct_color(guard, rgb);
    fputs("<polygon points=\"", s->stream);
    for (size_t i = 0; i < count; i++)
        fprintf(s->stream, "%.1f,%.1f ", hull[i][0], hull[i][1]);
    fputs("\" fill=\"", s->stream);
    put_color(s->stream, rgb);
    fputs("\" fill-opacity=\".3\" stroke=\"", s->stream);
    put_color(s->stream, rgb);
    fputs("\" stroke-width=\"2\"/>\n", s->stream);
}

/* A square for a camera that stays. */
static void put_camera(const sheet *s, const sheet_plan *plan, size_t guard) {
    double p[2];
    uint8_t rgb[3];
    project(s, plan, s->guards->positions + 3 * guard, p);
    starg_distinct_color(guard, rgb);
    fprintf(s->stream,
            "<rect x=\"%.1f\" y=\"%.1f\" width=\"34\" height=\"34\" rx=\"%d\" stroke=\"#111\" "
            "stroke-width=\"2\" fill=\"",
            p[0] - 17, p[1] - 17, is_kept(s, guard) ? 2 : 17);
    put_color(s->stream, rgb);
    fprintf(s->stream,
            "\"/><text x=\"%.1f\" y=\"%.1f\" font-size=\"21\" font-weight=\"700\" fill=\"#fff\" "
            "stroke=\"#111\" stroke-width=\"4\" paint-order=\"stroke\" "
            "text-anchor=\"middle\">%zu</text>\n",
            p[0], p[1] + 7.5, guard);
}

/* A bar of a round length, and where pan is 0. */
static void put_marks(const sheet *s, const sheet_plan *plan) {
    double wanted = 240 / plan->scale, unit = pow(10, floor(log10(wanted)));
    double length = unit * (wanted >= 5 * unit ? 5 : wanted >= 2 * unit ? 2 : 1);
    double y = (double)plan->picture.height - 12, end = 40 + length * plan->scale;
    fprintf(s->stream,
            "<path d=\"M40 %.1fv-8m0 4H%.1fm0 -4v8\" stroke=\"#111\" stroke-width=\"3\" "
            "fill=\"none\"/><text x=\"%.1f\" y=\"%.1f\" font-size=\"20\">%g</text>\n",
            y, end, end + 8, y + 3, length);
    double x = (double)plan->picture.width - 150;
    fprintf(s->stream,
            "<path d=\"M%.1f 30V6m-6 9l6 -9 6 9\" stroke=\"#111\" stroke-width=\"3\" "
            "fill=\"none\"/><text x=\"%.1f\" y=\"26\" font-size=\"20\">pan 0</text>\n",
            x, x + 14);
}

static void put_key(const sheet *s) {
    static const char *const names[SCENE_TIMES] = {"seen by none", "by one", "by two",
                                                   "by three or more", "need not be seen"};
    fputs("<p class=\"key small\">", s->stream);
    for (size_t i = 0; i < SCENE_TIMES; i++) {
        uint8_t rgb[3];
        scene_count_color(i, rgb);
        fputs("<span><i style=\"background:", s->stream);
        put_color(s->stream, rgb);
        fprintf(s->stream, "\"></i>%s</span>", names[i]);
    }
    fputs("<span>Squares: cameras that stay</span></p>\n", s->stream);
}

static starg_status put_plan(const sheet *s) {
    sheet_plan plan;
    const starg_scene parts = {.guards = s->guards};
    TRY(sheet_draw_plan(s->context, &s->scene, &plan));
    const scene_job job = {.scene = &parts,
                           .guards = s->guards->count,
                           .size = (double)plan.picture.width / plan.scale};
    fprintf(s->stream,
            "<h2>Plan from above</h2>\n<svg viewBox=\"0 0 %zu %zu\" "
            "font-family=\"system-ui,sans-serif\">\n",
            plan.picture.width, plan.picture.height);
    put_image(s->stream, &plan.picture);
    for (size_t i = 0; i < s->guards->count && s->guards->directions != NULL; i++)
        put_view(s, &plan, &job, i);
    for (size_t i = s->guards->count; i-- > 0;)
        put_camera(s, &plan, i);
    put_marks(s, &plan);
    fputs("</svg>\n", s->stream);
    put_key(s);
    starg_release(s->context, plan.picture.png);
    return STARG_OK;
}

/* ---- lenses ---- */

/* The edge of a cone is a circle in the picture. */
static starg_status put_lens(const sheet *s, size_t guard) {
    const starg_visibility_options *o = &s->guards->options.visibility;
    sheet_picture picture;
    TRY(sheet_draw_lens(s->context, &s->scene, guard, &picture));
    fprintf(s->stream, "<figure><svg viewBox=\"0 0 %zu %zu\">\n", picture.width, picture.height);
    put_image(s->stream, &picture);
    if (!(o->fov[0] > 0) && o->cone <= SHEET_WIDEST)
        fprintf(s->stream,
                "<circle cx=\"%zu\" cy=\"%zu\" r=\"%zu\" fill=\"none\" stroke=\"#111\"/>\n",
                picture.width / 2, picture.height / 2, picture.width / 2);
    fprintf(s->stream, "</svg>\n<figcaption>Camera %zu%s</figcaption></figure>\n", guard,
            is_kept(s, guard) ? ", stays" : "");
    starg_release(s->context, picture.png);
    return STARG_OK;
}

static starg_status put_lenses(const sheet *s) {
    const starg_visibility_options *o = &s->guards->options.visibility;
    fputs("<h2>Through each lens</h2>\n", s->stream);
    if (s->guards->directions == NULL) {
        fputs("<p>The cameras look all around.</p>\n", s->stream);
        return STARG_OK;
    }
    fputs("<p class=\"small\">In colour: what counts as seen by that camera.", s->stream);
    if (fmax(o->fov[0] > 0 ? o->fov[0] : o->cone, o->fov[1]) > SHEET_WIDEST)
        fprintf(s->stream, " Views are wider than shown, which is %g degrees.", SHEET_WIDEST);
    fputs("</p>\n<div class=\"lenses\">\n", s->stream);
    for (size_t i = 0; i < s->guards->count; i++)
        TRY(put_lens(s, i));
    fputs("</div>\n", s->stream);
    return STARG_OK;
}

/* ---- tables ---- */

static void put_number(const sheet *s, size_t guard) {
    fprintf(s->stream, "<tr><td>%zu</td><td class=\"t\">%s</td>", guard,
            is_kept(s, guard) ? "stays" : "");
}

static void put_poses(const sheet *s) {
    const starg_guards *g = s->guards;
    bool looks = g->directions != NULL;
    FILE *f = s->stream;
    fputs("<h2>Poses</h2>\n", f);
    if (looks)
        PUT_HEADS(f, "Camera", "<", "x", "y", "z", "Pan", "Tilt", "Roll", "qx", "qy", "qz", "qw");
    else
        PUT_HEADS(f, "Camera", "<", "x", "y", "z");
    for (size_t i = 0; i < g->count; i++) {
        double angles[3], q[4];
        put_number(s, i);
        for (size_t k = 0; k < 3; k++)
            put_real(f, g->positions[3 * i + k]);
        if (starg_guards_angles(g, i, angles) && starg_guards_rotation(g, i, q)) {
            for (int k = 0; k < 3; k++)
                fprintf(f, "<td>%.2f&deg;</td>", angles[k] + 0.0);
            for (int k = 0; k < 4; k++)
                fprintf(f, "<td>%.6f</td>", q[k] + 0.0);
        }
        fputs("</tr>\n", f);
    }
    fputs(END, f);
    if (looks)
        fputs("<p class=\"small\">Pan: clockwise from the top of the plan. Tilt: above the "
              "horizon. Roll: clockwise about the viewing direction. The quaternion turns a camera "
              "that looks along &minus;z with y up.</p>\n",
              f);
}

static void put_seen(const sheet *s) {
    FILE *f = s->stream;
    double all = s->groups[s->group_count].all;
    bool dense = false;
    for (size_t i = 0; i < s->guards->count; i++)
        dense = dense || s->areas[i].density > 0;
    fputs("<h2>What each camera sees</h2>\n", f);
    if (dense)
        PUT_HEADS(f, "Camera", "<", "Area", "Share", "By it alone", "Pixels per unit, mean");
    else
        PUT_HEADS(f, "Camera", "<", "Area", "Share", "By it alone");
    for (size_t i = 0; i < s->guards->count; i++) {
        put_number(s, i);
        put_real(f, s->areas[i].all);
        put_percent(f, s->areas[i].all, all);
        put_real(f, s->areas[i].alone);
        if (dense)
            put_real(f, s->areas[i].density);
        fputs("</tr>\n", f);
    }
    fputs(END, f);
}

static void put_groups(const sheet *s) {
    FILE *f = s->stream;
    if (s->group_count == 0)
        return;
    fputs("<h2>Groups of faces</h2>\n", f);
    PUT_HEADS(f, "<Group", "Area", "Seen by one or more", "by two", "by three");
    for (size_t i = 0; i <= s->group_count; i++) {
        const group_area *area = &s->groups[i];
        if (!(area->all > 0))
            continue;
        fputs("<tr><td class=\"t w\">", f);
        put_text(f, i < s->group_count ? s->told->groups->names[i] : "all");
        fputs("</td>", f);
        put_real(f, area->all);
        for (int k = 0; k < SEEN_TIMES; k++)
            put_percent(f, area->by[k], area->all);
        fputs("</tr>\n", f);
    }
    fputs(END, f);
}

/* A face in the list. */
typedef struct listed {
    uint32_t face;
    seen_face seen;
} listed;

static int by_missing(const void *a, const void *b) {
    const listed *p = a, *q = b;
    double missing = p->seen.area * (1 - p->seen.share), other = q->seen.area * (1 - q->seen.share);
    if (missing != other)
        return missing > other ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

static void put_face(const sheet *s, const listed *face, uint8_t *sees) {
    const starg_face_groups *groups = s->told->groups;
    FILE *f = s->stream;
    fprintf(f, "<tr><td>%u</td><td class=\"t w\">", (unsigned)face->face);
    if (groups != NULL && face->face < groups->face_count && groups->of[face->face] != UINT32_MAX)
        put_text(f, groups->names[groups->of[face->face]]);
    fputs("</td>", f);
    put_real(f, face->seen.area);
    put_percent(f, face->seen.share, 1);
    fputs("<td class=\"t w\">", f);
    (void)seen_table_face(s->scene.table, face->face, sees);
    for (size_t i = 0, put = 0; i < s->guards->count; i++)
        if (sees[i])
            fprintf(f, "%s%zu", put++ > 0 ? ", " : "", i);
    fprintf(f, "</td><td>%zu</td></tr>\n", face->seen.least);
}

/* All faces of a small model; else those of which most is missing. */
static starg_status put_faces(const sheet *s) {
    const starg_solid *solid = &s->scene.table->patched.solid;
    size_t targets = 0;
    SCOPED uint8_t *sees = NULL;
    SCOPED STARG_ARRAY(listed) list = {0};
    NEW(s->context, STAGE, sees, s->guards->count + 1);
    for (size_t f = 0; f < starg_space_model_faces(solid); f++)
        targets += solid_is_target(solid, false, f);
    for (size_t f = 0; f < starg_space_model_faces(solid); f++) {
        if (!solid_is_target(solid, false, f))
            continue;
        const listed face = {(uint32_t)f, seen_table_face(s->scene.table, f, sees)};
        if (targets <= ALL_FACES || face.seen.share < 1)
            PUSH(s->context, STAGE, &list, face);
    }
    if (targets > ALL_FACES && list.count > 0)
        qsort(list.data, list.count, sizeof *list.data, by_missing);
    fprintf(s->stream, "<h2>Faces%s</h2>\n", targets > ALL_FACES ? " not seen whole" : "");
    if (list.count == 0) {
        fputs("<p>All of every face is seen.</p>\n", s->stream);
        return STARG_OK;
    }
    PUT_HEADS(s->stream, "Face", "<Group", "Area", "Seen", "<Cameras", "Least");
    for (size_t i = 0; i < list.count && i < ALL_FACES; i++)
        put_face(s, &list.data[i], sees);
    fputs(END, s->stream);
    fputs("<p class=\"small\">Cameras that see some of the face; least: how many see every part of "
          "it.",
          s->stream);
    if (list.count > ALL_FACES)
        fprintf(s->stream, " Of %zu faces those of which most is missing.", list.count);
    fputs("</p>\n", s->stream);
    return STARG_OK;
}

/* ---- the sheet ---- */

static starg_status put_page(const sheet *s) {
    const char *title = s->told->title != NULL ? s->told->title : "starguard";
    fputs(HEAD, s->stream);
    fputs("<title>", s->stream);
    put_text(s->stream, title);
    fputs("</title>\n</head>\n<body>\n<h1>", s->stream);
    put_text(s->stream, title);
    fprintf(s->stream, "</h1>\n<p>%zu camera%s</p>\n", s->guards->count,
            s->guards->count == 1 ? "" : "s");
    put_summary(s);
    TRY(put_plan(s));
    TRY(put_lenses(s));
    put_poses(s);
    put_seen(s);
    put_groups(s);
    TRY(put_faces(s));
    fputs("<p class=\"small\">Numbers are those of the poses in this model; the command "
          "&lsquo;starguard verify&rsquo; checks the file that they came from.</p>\n"
          "</body>\n</html>\n",
          s->stream);
    return STARG_OK;
}

static starg_status check(starg_context *context, const starg_sheet *told) {
    if (told->scene == NULL || told->guards == NULL)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a sheet needs guards and the scene in which they stand");
    if (told->guards->face_count == starg_space_model_faces(told->scene))
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                      "the guards belong to a model with %zu faces, but this one has %zu; give the "
                      "right model",
                      told->guards->face_count, starg_space_model_faces(told->scene));
}

starg_status starg_sheet_write(starg_context *context, const starg_sheet *told, const char *path) {
    SCOPED_BY(seen_table_close) seen_table table = {0};
    SCOPED_BY(starg_mesh_drop) starg_mesh *shown = NULL;
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    SCOPED seen_area *areas = NULL;
    SCOPED group_area *groups = NULL;
    starg_output output;
    TRY(check(context, told));
    TRY(starg_c_locale_enter(context, &locale));
    TRY(seen_table_open(context, told->scene, told->guards, told->groups, &table));
    TRY(guards_draw(context, &table.patched, &shown));
    size_t group_count = told->groups != NULL ? told->groups->count : 0;
    NEW_ZERO(context, STAGE, areas, told->guards->count + 1);
    NEW_ZERO(context, STAGE, groups, group_count + 1);
    seen_table_measure(&table, areas, groups);
    TRY(starg_output_open(context, STAGE, path, &output));
    sheet s = {.context = context,
               .told = told,
               .guards = told->guards,
               .scene = {.table = &table, .shown = shown, .obstacles = told->obstacles},
               .stream = output.stream,
               .areas = areas,
               .groups = groups,
               .group_count = group_count};
    starg_guards_level(told->guards, s.scene.level);
    starg_status status = put_page(&s);
    if (status == STARG_OK)
        return starg_output_commit(&output);
    starg_output_discard(&output);
    return status;
}
