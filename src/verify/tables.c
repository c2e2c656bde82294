/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of what guards see, and the poses that were given to stay, held against the facts.
 *
 * Every field of a row is computed anew from the rows of patches that the guards see: names and
 * whole numbers must be the same, reals nearly. Of a curve, the result has no candidates: it must
 * rise up to its bound, and no bound may be below what so many of the guards see.
 *
 * Files are read line by line, with a reader of their own. Cost: that of the bits of all rows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "verify/facts.h"

static const char STAGE[] = "verify";

enum { MOST_FIELDS = 16, TIMES = 3 };

/* ---- reading ---- */

/* A file, one line of which is cut into fields at a time. */
typedef struct reader {
    const char *name;
    char *bytes, *at;
    char *field[MOST_FIELDS];
    size_t fields, line, wrong, first; /* lines that are not as they have to be */
} reader;

static void reader_free(reader *r) {
    RELEASE(r->bytes);
}

static starg_status open_table(starg_context *context, const char *name, reader *r) {
    size_t size;
    *r = (reader){.name = name};
    TRY(starg_file_read(context, STAGE, name, &r->bytes, &size));
    r->at = r->bytes;
    return STARG_OK;
}

/* Takes the next field, which may be in quotes; true: another one follows. */
static bool take_field(reader *r) {
    char *from = r->at, *to = r->at;
    bool quoted = *from == '"';
    from += quoted;
    if (r->fields < MOST_FIELDS)
        r->field[r->fields] = to;
    r->fields++;
    while (*from != '\0' && (quoted || (*from != ',' && *from != '\n'))) {
        if (quoted && *from == '"' && *++from != '"') {
            quoted = false;
            continue;
        }
        *to++ = *from++;
    }
    bool more = *from == ',';
    r->at = *from == '\0' ? from : from + 1;
    *to = '\0';
    return more;
}

/* False at the end of the file. */
static bool next_line(reader *r) {
    r->fields = 0;
    if (*r->at == '\0')
        return false;
    r->line++;
    while (take_field(r))
        continue;
    return true;
}

static void judge(reader *r, bool right) {
    if (!right && r->wrong++ == 0)
        r->first = r->line;
}

static bool is_text(const reader *r, size_t field, const char *text) {
    return strcmp(r->field[field], text) == 0;
}

static bool is_count(const reader *r, size_t field, size_t value) {
    char text[32];
    snprintf(text, sizeof text, "%zu", value);
    return is_text(r, field, text);
}

static bool read_real(const reader *r, size_t field, double *value) {
    char *end;
    *value = strtod(r->field[field], &end);
    return end != r->field[field] && *end == '\0' && isfinite(*value);
}

static bool is_real(const reader *r, size_t field, double value, double size) {
    double told;
    return read_real(r, field, &told) &&
           fabs(told - value) <= VERIFY_TOLERANCE * fmax(fabs(value), size);
}

static bool has_head(reader *r, const char *const *names, size_t count) {
    bool right = next_line(r) && r->fields == count;
    for (size_t i = 0; right && i < count; i++)
        right = is_text(r, i, names[i]);
    return right;
}

/* ---- what the guards see ---- */

typedef struct facts_of_tables {
    const verify_facts *known;
    const starg_face_groups *groups; /* NULL: none */
    size_t group_count;
    uint32_t *held; /* by patch: how many guards see it */
} facts_of_tables;

static double area_of(const verify_surface *s, size_t face) {
    const double *p[3];
    double a[3], b[3];
    for (size_t k = 0; k < 3; k++)
        p[k] = s->vertices + 3 * (size_t)s->faces[3 * face + k];
    for (size_t k = 0; k < 3; k++) {
        a[k] = p[1][k] - p[0][k];
        b[k] = p[2][k] - p[0][k];
    }
    return 0.5 * hypot(hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]),
                       a[0] * b[1] - a[1] * b[0]);
}

static const char *group_of(const facts_of_tables *own, size_t face) {
    const starg_face_groups *g = own->groups;
    bool any = g != NULL && face < g->face_count && g->of[face] < own->group_count;
    return any ? g->names[g->of[face]] : "";
}

/* ---- by face ---- */

static bool is_list(const reader *r, size_t field, const facts_of_tables *own, size_t face) {
    const verify_surface *surface = own->known->surface;
    const char *at = r->field[field];
    for (size_t g = 0; g < own->known->guards->count; g++) {
        char text[32];
        bool sees = false;
        for (size_t j = verify_first_patch(surface, face);
             j < verify_first_patch(surface, face + 1) && !sees; j++)
            sees = starg_bits_test(own->known->patches, g, j);
        size_t length =
            (size_t)snprintf(text, sizeof text, "%s%zu", at == r->field[field] ? "" : " ", g);
        if (sees && strncmp(at, text, length) != 0)
            return false;
        at += sees ? length : 0;
    }
    return *at == '\0';
}

static bool is_face(const reader *r, const facts_of_tables *own, size_t face) {
    const verify_facts *known = own->known;
    size_t first = verify_first_patch(known->surface, face),
           end = verify_first_patch(known->surface, face + 1), least = SIZE_MAX, cameras = 0;
    double share = 0, area = area_of(known->surface, face);
    for (size_t j = first; j < end; j++) {
        least = own->held[j] < least ? own->held[j] : least;
        share += own->held[j] > 0 ? verify_patch_share(known->surface, j) : 0;
    }
    for (size_t g = 0; g < known->guards->count; g++) {
        size_t j = first;
        while (j < end && !starg_bits_test(known->patches, g, j))
            j++;
        cameras += j < end;
    }
    return r->fields == 7 && is_count(r, 0, face) && is_text(r, 1, group_of(own, face)) &&
           is_real(r, 2, area, 0) && is_real(r, 3, share, 0) && is_count(r, 4, cameras) &&
           is_count(r, 5, end > first ? least : 0) && is_list(r, 6, own, face);
}

static void check_faces(reader *r, const facts_of_tables *own) {
    static const char *const head[] = {"face",    "group", "area", "share",
                                       "cameras", "least", "which"};
    judge(r, has_head(r, head, sizeof head / sizeof *head));
    for (size_t f = 0; f < own->known->surface->model_faces; f++)
        if (verify_is_target(own->known->surface, f))
            judge(r, next_line(r) && is_face(r, own, f));
    judge(r, !next_line(r));
}

/* ---- by guard and by group ---- */

typedef struct sums {
    double all, by[TIMES];
} sums;

/* Pixels for a unit of length where the middle of a patch is. */
static double density_at(const verify_facts *known, size_t guard, size_t patch) {
    const starg_visibility_options *o = &known->guards->options.visibility;
    const double *d = known->guards->directions + 3 * guard,
                 *p = known->guards->positions + 3 * guard;
    verify_spot spots[3];
    double depth = 0;
    verify_patch_spots(known->surface, patch, spots);
    for (int k = 0; k < 3; k++)
        depth += ((spots[0].at[k] + spots[1].at[k] + spots[2].at[k]) / 3 - p[k]) * d[k];
    depth /= hypot(hypot(d[0], d[1]), d[2]);
    double half = 0.5 * o->fov[0] * (3.14159265358979323846 / 180);
    return depth > 0 ? 0.5 * o->resolution[0] / tan(half) / depth : 0;
}

static bool is_guard(const reader *r, const facts_of_tables *own, size_t guard, double all) {
    const verify_facts *known = own->known;
    const verify_surface *surface = known->surface;
    const starg_visibility_options *o = &known->guards->options.visibility;
    double seen = 0, alone = 0, pixels = 0;
    bool dense = o->resolution[0] > 0 && o->fov[0] > 0;
    for (size_t j = 0; j < verify_first_patch(surface, surface->model_faces); j++) {
        double area =
            area_of(surface, verify_patch_face(surface, j)) * verify_patch_share(surface, j);
        if (!starg_bits_test(known->patches, guard, j))
            continue;
        seen += area;
        alone += own->held[j] == 1 ? area : 0;
        pixels += dense ? area * density_at(known, guard, j) : 0;
    }
    bool measured = dense && seen > 0;
    return r->fields == 10 && is_text(r, 0, "camera") && is_count(r, 1, guard) &&
           is_text(r, 2, verify_is_kept(known->guards, guard) ? "yes" : "no") &&
           is_real(r, 3, seen, 0) && is_real(r, 4, verify_fraction(seen, all), 0) &&
           is_real(r, 5, alone, seen) &&
           (measured ? is_real(r, 6, pixels / seen, 0) : is_text(r, 6, "")) && is_text(r, 7, "") &&
           is_text(r, 8, "") && is_text(r, 9, "");
}

static bool is_sum(const reader *r, const char *kind, const char *name, const sums *own) {
    bool right = r->fields == 10 && is_text(r, 0, kind) && is_text(r, 1, name) &&
                 is_text(r, 2, "") && is_real(r, 3, own->all, 0) && is_text(r, 5, "") &&
                 is_text(r, 6, "") && is_real(r, 4, verify_fraction(own->by[0], own->all), 0);
    for (size_t k = 0; k < TIMES && right; k++)
        right = is_real(r, 7 + k, verify_fraction(own->by[k], own->all), 0);
    return right;
}

static void add_up(const facts_of_tables *own, sums *groups) {
    const verify_surface *surface = own->known->surface;
    for (size_t f = 0; f < surface->model_faces; f++) {
        bool any = *group_of(own, f) != '\0';
        sums *to[2] = {&groups[own->group_count], any ? &groups[own->groups->of[f]] : NULL};
        for (size_t j = verify_first_patch(surface, f);
             verify_is_target(surface, f) && j < verify_first_patch(surface, f + 1); j++)
            for (int i = 0; i < 2 && to[i] != NULL; i++) {
                double area = area_of(surface, f) * verify_patch_share(surface, j);
                to[i]->all += area;
                for (size_t k = 0; k < TIMES && k < own->held[j]; k++)
                    to[i]->by[k] += area;
            }
    }
}

static starg_status check_summary(starg_context *context, reader *r, const facts_of_tables *own) {
    static const char *const head[] = {"kind",  "name",    "kept", "area", "share",
                                       "alone", "density", "by_1", "by_2", "by_3"};
    SCOPED sums *groups = NULL;
    NEW_ZERO(context, STAGE, groups, own->group_count + 1);
    add_up(own, groups);
    judge(r, has_head(r, head, sizeof head / sizeof *head));
    for (size_t g = 0; g < own->known->guards->count; g++)
        judge(r, next_line(r) && is_guard(r, own, g, groups[own->group_count].all));
    for (size_t i = 0; i < own->group_count; i++)
        if (groups[i].all > 0)
            judge(r, next_line(r) && is_sum(r, "group", own->groups->names[i], &groups[i]));
    judge(r, next_line(r) && is_sum(r, "all", "", &groups[own->group_count]));
    judge(r, !next_line(r));
    return STARG_OK;
}

/* ---- how many are worth it ---- */

/* The bound of k guards, beside those that stay: not below what the first ones see. */
static void check_curve(reader *r, const verify_facts *known) {
    static const char *const head[] = {"guards", "coverage", "bound"};
    const starg_guards *g = known->guards;
    size_t kept = verify_count_kept(g);
    double last[2] = {0, 0};
    bool once = g->options.redundancy <= 1 && g->need_count == 0 && g->curve_area != NULL &&
                g->target_count == 0 && !verify_targets_vertices(known);
    judge(r, has_head(r, head, sizeof head / sizeof *head));
    for (size_t k = 1; k <= g->count - kept; k++) {
        double coverage, bound;
        bool right = next_line(r) && r->fields == 3 && is_count(r, 0, k) &&
                     read_real(r, 1, &coverage) && read_real(r, 2, &bound);
        right = right && coverage >= last[0] && bound >= last[1] &&
                coverage <= bound + VERIFY_TOLERANCE && coverage >= 0 &&
                bound <= 1 + VERIFY_TOLERANCE &&
                (!once || bound >= g->curve_area[kept + k - 1] - VERIFY_TOLERANCE);
        judge(r, right);
        last[0] = right ? coverage : last[0];
        last[1] = right ? bound : last[1];
    }
    judge(r, !next_line(r));
}

/* ---- what stays ---- */

static bool same(const double *a, const double *b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Is the guard as it was given? What is up, where that was not said, is as the options say. */
static bool is_unchanged(const starg_guards *g, size_t guard, const starg_poses *keep) {
    static const double none[3] = {0, 0, 0}, y[3] = {0, 1, 0};
    const double *up = keep->ups != NULL && !same(keep->ups + 3 * guard, none)
                           ? keep->ups + 3 * guard
                       : !same(g->options.visibility.up, none) ? g->options.visibility.up
                                                               : y;
    return verify_is_kept(g, guard) && same(g->positions + 3 * guard, keep->points + 3 * guard) &&
           (g->directions == NULL ||
            (keep->directions != NULL &&
             same(g->directions + 3 * guard, keep->directions + 3 * guard))) &&
           (g->ups == NULL || same(g->ups + 3 * guard, up));
}

static void claim_stay(starg_verdict *verdict, const starg_guards *guards,
                       const starg_poses *keep) {
    size_t kept = verify_count_kept(guards), bad = 0, first = 0;
    if (keep == NULL) {
        if (kept > 0)
            verify_leave(verdict, "that the guards that stay are those that were given: give them "
                                  "(--keep FILE)");
        return;
    }
    for (size_t i = 0; i < keep->count && i < guards->count; i++)
        if (!is_unchanged(guards, i, keep) && bad++ == 0)
            first = i;
    verify_claim(verdict, kept == keep->count && guards->options.keep_count == keep->count,
                 "%zu guards stay that were given (found: %zu)", kept, keep->count);
    verify_claim_all(verdict, bad, first,
                     "guards that stay are where they were, and look as they did");
}

/* ---- all of them ---- */

static void tell(starg_verdict *verdict, const reader *r, const char *what) {
    if (r->wrong == 0)
        verify_claim(verdict, true, "%s: all %zu lines are as computed anew", what, r->line);
    else
        verify_claim(verdict, false, "%s: lines are as computed anew (not: %zu, the first is %zu)",
                     what, r->wrong, r->first);
}

static starg_status claim_table(starg_verdict *verdict, const facts_of_tables *own,
                                const char *file, bool summary) {
    SCOPED_BY(reader_free) reader r = {0};
    starg_context *context = own->known->surface->context;
    const char *what = summary ? "the summary" : "the table of faces";
    if (file == NULL)
        return STARG_OK;
    TRY(open_table(context, file, &r));
    if (summary)
        TRY(check_summary(context, &r, own));
    else
        check_faces(&r, own);
    tell(verdict, &r, what);
    return STARG_OK;
}

static starg_status claim_tables(starg_verdict *verdict, const verify_facts *known,
                                 const starg_guards_evidence *evidence) {
    SCOPED uint32_t *held = NULL;
    const starg_face_groups *groups = evidence->groups;
    facts_of_tables own = {
        .known = known, .groups = groups, .group_count = groups != NULL ? groups->count : 0};
    if (evidence->table == NULL && evidence->summary == NULL)
        return STARG_OK;
    if (verify_targets_points(known)) {
        verify_leave_asked(verdict, "the tables: they are of faces in parts, and the result is "
                                    "about every point");
        return STARG_OK;
    }
    TRY(verify_count_held(known, known->patches, &held));
    own.held = held;
    TRY(claim_table(verdict, &own, evidence->table, false));
    return claim_table(verdict, &own, evidence->summary, true);
}

static starg_status claim_curve(starg_verdict *verdict, const verify_facts *known,
                                const char *file) {
    SCOPED_BY(reader_free) reader r = {0};
    if (file == NULL)
        return STARG_OK;
    TRY(open_table(known->surface->context, file, &r));
    check_curve(&r, known);
    tell(verdict, &r, "the curve");
    verify_leave(verdict,
                 "that so many candidates see as much as the curve says, and that no others "
                 "see more than its bound");
    return STARG_OK;
}

starg_status verify_claim_tables(starg_verdict *verdict, const verify_facts *known,
                                 const starg_guards_evidence *evidence) {
    starg_c_locale locale = {0};
    claim_stay(verdict, known->guards, evidence->keep);
    TRY(starg_c_locale_enter(known->surface->context, &locale));
    starg_status status = claim_tables(verdict, known, evidence);
    if (status == STARG_OK)
        status = claim_curve(verdict, known, evidence->curve);
    starg_c_locale_leave(&locale);
    return status;
}
