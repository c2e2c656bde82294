/* SPDX-License-Identifier: Apache-2.0 */
/* Checks levels of detail for consistency with one another, the model and the guards. Their meshes
 * are not in the file, so what their guards see of them cannot be checked. Their guards are
 * candidates of the model, and so inside it. A guard belongs to the first level that chose it, as
 * long as all later ones choose it; refinement may add guards of the last level. */
#include "verify/facts.h"

static bool is_among(const double p[3], const starg_guard_level *level) {
    for (size_t i = 0; i < level->count; i++) {
        const double *q = level->positions + 3 * i;
        if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
            return true;
    }
    return false;
}

static bool is_inside(const verify_facts *known, const double p[3]) {
    bool on_surface;
    for (int k = 0; k < 3; k++)
        if (known->surface->ambient == 0 &&
            !(p[k] >= known->surface->lower[k] && p[k] <= known->surface->upper[k]))
            return false;
    int winding = verify_tree_winding(known->tree, p, &on_surface);
    return !on_surface && winding + known->surface->ambient >= 1;
}

/* Is the guard listed in its level and in the finer ones? */
static bool is_named(const starg_guards *guards, size_t guard) {
    int level = guards->levels[guard];
    if (level < 0 || (size_t)level >= guards->level_count)
        return false;
    bool last = (size_t)level + 1 == guards->level_count;
    for (size_t i = (size_t)level; i < guards->level_count && !(last && guards->options.refine);
         i++)
        if (!is_among(guards->positions + 3 * guard, &guards->level_list[i]))
            return false;
    return true;
}

static bool are_kept(const starg_guard_level *level, const starg_guard_level *before) {
    if (level->kept > level->count || level->kept > (before == NULL ? 0 : before->count))
        return false;
    for (size_t i = 0; i < level->kept; i++)
        if (!is_among(level->positions + 3 * i, before))
            return false;
    return true;
}

verify_levels verify_check_levels(const verify_facts *known) {
    const starg_guards *guards = known->guards;
    verify_levels all = {true, true, true, true};
    for (size_t i = 0; i < guards->level_count; i++) {
        const starg_guard_level *level = &guards->level_list[i];
        const starg_guard_level *before = i > 0 ? level - 1 : NULL;
        all.grow = all.grow && (before == NULL || before->vertex_count < level->vertex_count);
        all.kept = all.kept && are_kept(level, before);
        for (size_t j = 0; j < level->count; j++)
            all.inside = all.inside && is_inside(known, level->positions + 3 * j);
    }
    if (guards->level_count > 0) {
        const starg_guard_level *last = &guards->level_list[guards->level_count - 1];
        all.grow = all.grow && last->vertex_count == guards->vertex_count &&
                   last->face_count == guards->face_count;
    }
    for (size_t g = 0; g < guards->count && guards->levels != NULL; g++)
        all.named =
            all.named && (guards->level_count > 0 ? is_named(guards, g) : guards->levels[g] == 0);
    return all;
}
