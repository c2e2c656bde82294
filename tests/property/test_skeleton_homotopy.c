/* Parts and loops of skeletons against the table of genera that another program made, on all
 * handlebodies that the table names, and all nodes strictly inside. */
#include "support.h"

#include <stdio.h>
#include <string.h>

#include "starguard/skeleton.h"

typedef struct model {
    const char *name;
    size_t components, loops;
} model;

static const model MODELS[] = {
    {"solids/eight.off", 1, 2},
};

static void check_model(const char *folder, const model *m) {
    char path[512];
    starg_context *context = test_context(0);
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_skeleton *s = NULL;
    snprintf(path, sizeof path, "%s/%s", folder, m->name);
    test_ok(context, starg_mesh_read(context, path, &mesh));
    test_ok(context, starg_solid_create(context, mesh, &solid));
    test_ok(context, starg_skeleton_create(context, solid, NULL, &s));
    if (s->components != m->components || s->edge_count + m->components - s->node_count != m->loops)
        fail_msg("%s: %zu parts, %zu loops; the table has %zu and %zu", m->name, s->components,
                 s->loops, m->components, m->loops);
    assert_true(s->homotopic);
    for (size_t v = 0; v < s->node_count; v++)
        assert_true(starg_solid_contains(solid, s->positions + 3 * v));
    starg_skeleton_free(context, s);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void test_shared_models(void **state) {
    (void)state;
    const char *folder = test_shared_data();
    if (folder == NULL)
        skip();
    for (size_t i = 0; i < sizeof MODELS / sizeof *MODELS; i++)
        check_model(folder, &MODELS[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shared_models)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
