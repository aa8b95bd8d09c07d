/* mesh/delaunay_cgal.cpp: Delaunay triangulation by CGAL. The contract is in delaunay_cgal.h. */
#include "mesh/delaunay_cgal.h"

#include "cloud/guard.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, Kernel>;
using Face = CGAL::Triangulation_face_base_with_info_2<uint32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex, Face>>;

plm_status from_faces(const Delaunay &delaunay, plm_triangulation *out, plm_error *error)
{
    plm_triangulation made = {};
    made.corner = static_cast<uint32_t(*)[3]>(plm_alloc(delaunay.number_of_faces(), sizeof *made.corner, error));
    made.across = static_cast<uint32_t(*)[3]>(plm_alloc(delaunay.number_of_faces(), sizeof *made.across, error));
    if (!made.corner || !made.across) {
        plm_triangulation_free(&made);
        return PLM_E_MEMORY;
    }
    for (const auto face : delaunay.finite_face_handles()) face->info() = static_cast<uint32_t>(made.count++);
    size_t t = 0;
    for (const auto face : delaunay.finite_face_handles()) {
        for (int i = 0; i < 3; i++) {
            made.corner[t][i] = face->vertex(i)->info();
            made.across[t][i] = delaunay.is_infinite(face->neighbor(i)) ? PLM_NO_TRIANGLE : face->neighbor(i)->info();
        }
        t++;
    }
    *out = made;
    return PLM_OK;
}

} // namespace

extern "C" plm_status plm_delaunay_cgal(const double *uv, size_t stride, size_t count, plm_triangulation *triangulation,
                                        plm_error *error)
{
    return plm_guard(error, "CGAL Delaunay triangulation", [&] {
        Delaunay delaunay;
        Delaunay::Face_handle hint;
        for (size_t i = 0; i < count; i++) {
            const size_t before = delaunay.number_of_vertices();
            const auto vertex = delaunay.insert(Kernel::Point_2(uv[i * stride], uv[i * stride + 1]), hint);
            if (delaunay.number_of_vertices() > before) vertex->info() = static_cast<uint32_t>(i);
            hint = vertex->face();
        }
        return from_faces(delaunay, triangulation, error);
    });
}

extern "C" void plm_triangulation_free(plm_triangulation *triangulation)
{
    if (!triangulation) return;
    plm_free(triangulation->corner);
    plm_free(triangulation->across);
    *triangulation = {};
}
