/* SPDX-License-Identifier: Apache-2.0 */
// Curve skeletons against CGAL's mean curvature skeleton [Tagliasacchi, Alhashim, Olson, Zhang
// 2012], when CGAL was found: nodes, ends, joints, loops, seconds, one thread.
//   bench_skeleton MODEL...
#include <chrono>
#include <cstdio>
#include <cstring>
#include <vector>

#include "starguard/skeleton.h"

#ifdef HAVE_CGAL
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/extract_mean_curvature_flow_skeleton.h>
#endif

namespace {

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

void print_row(const char *program, std::size_t nodes, std::size_t ends, std::size_t joints,
               long loops, double time) {
    std::printf("  %-10s %7zu nodes %5zu ends %5zu joints %4ld loops %8.3f s\n", program, nodes,
                ends, joints, loops, time);
}

bool run_ours(starg_context *context, const starg_mesh *mesh) {
    starg_solid *solid = nullptr;
    starg_skeleton *skeleton = nullptr;
    if (starg_solid_create(context, mesh, &solid) != STARG_OK)
        return false;
    const double begin = seconds();
    const bool done = starg_skeleton_create(context, solid, nullptr, &skeleton) == STARG_OK;
    if (done)
        print_row("starguard", skeleton->node_count, skeleton->ends, skeleton->joints,
                  static_cast<long>(skeleton->loops), seconds() - begin);
    starg_skeleton_free(context, skeleton);
    starg_solid_free(solid);
    return done;
}

#ifdef HAVE_CGAL
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Contraction = CGAL::Mean_curvature_flow_skeletonization<Mesh>;

void run_cgal(const starg_mesh *mesh) {
    Mesh surface;
    std::vector<Mesh::Vertex_index> index;
    const double *p = starg_mesh_vertices(mesh);
    const std::uint32_t *f = starg_mesh_faces(mesh);
    for (std::size_t v = 0; v < starg_mesh_vertex_count(mesh); v++)
        index.push_back(surface.add_vertex({p[3 * v], p[3 * v + 1], p[3 * v + 2]}));
    for (std::size_t i = 0; i < starg_mesh_face_count(mesh); i++)
        surface.add_face(index[f[3 * i]], index[f[3 * i + 1]], index[f[3 * i + 2]]);
    Contraction::Skeleton skeleton;
    const double begin = seconds();
    CGAL::extract_mean_curvature_flow_skeleton(surface, skeleton);
    const double time = seconds() - begin;
    std::size_t ends = 0, joints = 0;
    for (const auto v : CGAL::make_range(vertices(skeleton))) {
        ends += degree(v, skeleton) == 1;
        joints += degree(v, skeleton) > 2;
    }
    // of one connected part
    const long loops = static_cast<long>(num_edges(skeleton)) -
                       static_cast<long>(num_vertices(skeleton)) + 1;
    print_row("CGAL", num_vertices(skeleton), ends, joints, loops, time);
}
#endif

} // namespace

int main(int count, char **names) {
    for (int i = 1; i < count; i++) {
        starg_context_options options;
        starg_context_options_default(&options);
        options.threads = 1;
        starg_context *context = nullptr;
        starg_mesh *mesh = nullptr;
        if (starg_context_create(&options, &context) != STARG_OK)
            return 1;
        const bool read = starg_mesh_read(context, names[i], &mesh) == STARG_OK;
        std::printf("%s\n", names[i]);
        if (!read || !run_ours(context, mesh))
            std::printf("  %s\n", starg_context_error(context)->message);
#ifdef HAVE_CGAL
        if (read)
            run_cgal(mesh);
#endif
        starg_mesh_free(mesh);
        starg_context_free(context);
    }
    return 0;
}
