/* PIECES.vtk and PIECES.json: a decomposition as text (docs/formats.md). */
#include "core/json.h"
#include "star/decomposition.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "pieces file";
static const char FORMAT[] = "starguard-pieces";
enum { VERSION = 1 };

const char *const decompose_mode_words[] = {"strict", "paper", NULL};

starg_status starg_decomposition_write(starg_context *context,
                                       const starg_decomposition *decomposition, const char *path,
                                       bool binary) {
    starg_tetmesh_write_options options;
    starg_tetmesh_write_options_default(&options);
    options.binary = binary;
    options.labels = decomposition->labels;
    return starg_tetmesh_write(context, decomposition->mesh, path, &options);
}

static json_t *model_json(const starg_decomposition *d, const char *file) {
    bool surface = d->model_tetrahedra == 0;
    return json_pack("{s:s?, s:I, s:I}", "file", file, "vertices", (json_int_t)d->model_vertices,
                     surface ? "faces" : "tetrahedra",
                     (json_int_t)(surface ? d->model_faces : d->model_tetrahedra));
}

static json_t *piece_json(const starg_piece *p) {
    return json_pack("{s:[f, f, f], s:I, s:f, s:b, s:f}", "guard", p->guard[0], p->guard[1],
                     p->guard[2], "tetrahedra", (json_int_t)p->tetrahedra, "volume", p->volume,
                     "star", p->star, "radius", p->radius);
}

static json_t *contact_json(const starg_piece_contact *c) {
    return json_pack("[I, I, f]", (json_int_t)c->first, (json_int_t)c->second, c->area);
}

static bool put_head(FILE *stream, const starg_decomposition *d, const char *model_file) {
    const char *surface = d->tetra.surface_kept ? "kept" : "approximated";
    return starg_json_put(stream, "{\n\"format\": ", json_string(FORMAT), ",\n") &&
           starg_json_put(stream, "\"version\": ", json_integer(VERSION), ",\n") &&
           starg_json_put(stream, "\"model\": ", model_json(d, model_file), ",\n") &&
           starg_json_put(stream, "\"mode\": ", json_string(decompose_mode_words[d->mode]),
                          ",\n") &&
           starg_json_put(stream, "\"surface\": ", json_string(surface), ",\n") &&
           (d->tetra.surface_kept ||
            (starg_json_put(
                 stream, "\"distance\": ", json_real(d->tetra.to_surface + d->tetra.step), ",\n") &&
             starg_json_put(stream, "\"distance_back\": ",
                            json_real(d->tetra.from_surface + d->tetra.step), ",\n"))) &&
           starg_json_put(stream, "\"tetrahedra\": ", json_integer((json_int_t)d->mesh->count),
                          ",\n");
}

/* "key": [ one item a line ] */
static bool put_pieces(FILE *stream, const starg_decomposition *d) {
    bool done = true;
    fputs("\"pieces\": [\n", stream);
    for (size_t p = 0; p < d->piece_count && done; p++)
        done = starg_json_put(stream, "", piece_json(&d->pieces[p]),
                              p + 1 < d->piece_count ? ",\n" : "\n");
    fputs("],\n", stream);
    return done;
}

static bool put_contacts(FILE *stream, const starg_decomposition *d) {
    bool done = true;
    fputs("\"adjacency\": [\n", stream);
    for (size_t i = 0; i < d->contact_count && done; i++)
        done = starg_json_put(stream, "", contact_json(&d->contacts[i]),
                              i + 1 < d->contact_count ? ",\n" : "\n");
    fputs("],\n", stream);
    return done;
}

static bool put_all(FILE *stream, const void *result, const char *model_file) {
    const starg_decomposition *d = result;
    return put_head(stream, d, model_file) && put_pieces(stream, d) &&
           starg_json_put(stream, "\"strictly_star\": ", json_integer((json_int_t)d->strictly_star),
                          ",\n") &&
           starg_json_put(stream, "\"visible_vertices\": ", json_real(d->visible_vertices),
                          ",\n") &&
           starg_json_put(stream, "\"flattest\": ", json_real(d->flattest), ",\n") &&
           starg_json_put(stream, "\"flattest_given\": ", json_real(d->flattest_given), ",\n") &&
           put_contacts(stream, d) &&
           starg_json_put(stream, "\"time_limited\": ", json_boolean(d->time_limited), "\n}\n");
}

starg_status starg_decomposition_write_report(starg_context *context,
                                              const starg_decomposition *decomposition,
                                              const char *model_file, const char *path) {
    return starg_json_write(context, STAGE, path, put_all, decomposition, model_file);
}
