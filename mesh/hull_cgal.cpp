/* mesh/hull_cgal.cpp: the convex hull by CGAL (quickhull, exact predicates). The contract is in hull_cgal.h. */
#include "mesh/hull_cgal.h"

#include "cloud/guard.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <vector>

namespace
{

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

/* CGAL's faces are triangles. Those of a flat hull come a second time, turned over. */
plm_status to_mesh(const Surface &surface, bool flat, plm_mesh *hull, plm_error *error)
{
    std::vector<uint32_t> triangle;
    for (const auto face : surface.faces()) {
        uint32_t corner[3];
        auto next = corner;
        for (const auto vertex : vertices_around_face(surface.halfedge(face), surface)) *next++ = vertex.idx();
        triangle.insert(triangle.end(), {corner[0], corner[1], corner[2]});
        if (flat) triangle.insert(triangle.end(), {corner[0], corner[2], corner[1]});
    }
    const plm_status status = plm_mesh_create(surface.number_of_vertices(), triangle.size() / 3, hull, error);
    if (status != PLM_OK) return status;
    for (const auto vertex : surface.vertices())
        for (int axis = 0; axis < 3; axis++) hull->vertex[vertex.idx()][axis] = surface.point(vertex)[axis];
    std::copy(triangle.begin(), triangle.end(), &hull->triangle[0][0]);
    return PLM_OK;
}

} // namespace

extern "C" plm_status plm_hull_cgal(const double (*point)[3], size_t count, plm_mesh *hull, int *dimension,
                                    plm_error *error)
{
    return plm_guard(error, "CGAL convex hull", [&] {
        std::vector<Point> points;
        points.reserve(count);
        for (size_t i = 0; i < count; i++) points.emplace_back(point[i][0], point[i][1], point[i][2]);
        Surface surface;
        CGAL::convex_hull_3(points.begin(), points.end(), surface);
        if (surface.number_of_faces() == 0) {
            *dimension = static_cast<int>(surface.number_of_vertices()) - 1;
            return PLM_OK;
        }
        const bool flat = !CGAL::is_closed(surface);
        const plm_status status = to_mesh(surface, flat, hull, error);
        if (status == PLM_OK) *dimension = flat ? 2 : 3;
        return status;
    });
}
