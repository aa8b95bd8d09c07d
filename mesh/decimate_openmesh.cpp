/* mesh/decimate_openmesh.cpp: fewer triangles by OpenMesh. The contract is plm_mesh_decimate in mesh.h. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized" /* OpenMesh's PropertyT::push_back copies unset vectors */
#endif
#include "mesh/mesh.h"

#include "cloud/guard.hpp"
#include "mesh/mesh_cluster.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace
{

struct double_traits : OpenMesh::DefaultTraits {
    typedef OpenMesh::Vec3d Point;
    typedef OpenMesh::Vec3d Normal;
};
typedef OpenMesh::TriMesh_ArrayKernelT<double_traits> surface;
typedef OpenMesh::FPropHandleT<int32_t> organ_property;

/* A triangle that would make an edge of three triangles gets corners of its own: nothing is lost to the eye. */
void add_triangle(surface &made, const plm_mesh *mesh, size_t i, organ_property organ)
{
    const uint32_t *corner = mesh->triangle[i];
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) return;
    surface::VertexHandle vertex[3];
    for (int k = 0; k < 3; k++) vertex[k] = surface::VertexHandle(static_cast<int>(corner[k]));
    bool fits = true;
    for (int k = 0; k < 3 && fits; k++) {
        const auto edge = made.find_halfedge(vertex[k], vertex[(k + 1) % 3]);
        fits = made.is_boundary(vertex[k]) && (!edge.is_valid() || made.is_boundary(edge));
    }
    surface::FaceHandle face;
    if (fits) face = made.add_face(vertex[0], vertex[1], vertex[2]);
    if (!face.is_valid()) {
        for (auto &k : vertex) k = made.add_vertex(made.point(k));
        face = made.add_face(vertex[0], vertex[1], vertex[2]);
    }
    made.property(organ, face) = mesh->face_organ ? mesh->face_organ[i] : -1;
}

plm_status from_surface(const surface &made, const plm_mesh *like, organ_property organ, plm_mesh *out,
                        plm_error *error)
{
    std::vector<uint32_t> number(made.n_vertices());
    std::vector<OpenMesh::Vec3d> point;
    for (const auto face : made.faces()) /* corners in use, in the order of the faces */
        for (const auto vertex : made.fv_range(face)) {
            uint32_t &place = number[static_cast<size_t>(vertex.idx())];
            if (place) continue;
            point.push_back(made.point(vertex));
            place = static_cast<uint32_t>(point.size());
        }
    plm_status status = plm_mesh_create(point.size(), made.n_faces(), out, error);
    if (status != PLM_OK) return status;
    if (like->face_organ) {
        out->face_organ = static_cast<int32_t *>(plm_alloc(made.n_faces(), sizeof(int32_t), error));
        if (!out->face_organ) {
            plm_mesh_free(out);
            return PLM_E_MEMORY;
        }
    }
    for (int axis = 0; axis < 3; axis++) out->origin[axis] = like->origin[axis];
    for (size_t i = 0; i < point.size(); i++)
        for (int axis = 0; axis < 3; axis++) out->vertex[i][axis] = point[i][static_cast<size_t>(axis)];
    size_t at = 0;
    for (const auto face : made.faces()) {
        int k = 0;
        for (const auto vertex : made.fv_range(face))
            out->triangle[at][k++] = number[static_cast<size_t>(vertex.idx())] - 1;
        if (like->face_organ) out->face_organ[at] = made.property(organ, face);
        at++;
    }
    return PLM_OK;
}

plm_status collapse(const plm_mesh *mesh, size_t triangles, plm_mesh *out, plm_error *error)
{
    return plm_guard(error, "OpenMesh decimation", [&] {
        surface made;
        organ_property organ;
        made.add_property(organ);
        made.request_vertex_status();
        made.request_edge_status();
        made.request_halfedge_status();
        made.request_face_status();
        made.request_face_normals();
        for (size_t i = 0; i < mesh->vertex_count; i++)
            made.add_vertex(OpenMesh::Vec3d(mesh->vertex[i][0], mesh->vertex[i][1], mesh->vertex[i][2]));
        for (size_t i = 0; i < mesh->triangle_count; i++) add_triangle(made, mesh, i, organ);
        made.update_face_normals();
        OpenMesh::Decimater::DecimaterT<surface> decimater(made);
        OpenMesh::Decimater::ModQuadricT<surface>::Handle quadric;
        OpenMesh::Decimater::ModNormalFlippingT<surface>::Handle flipping;
        decimater.add(quadric);
        decimater.add(flipping);
        decimater.module(quadric).unset_max_err();
        /* In a flat leaf every collapse is free, those that eat its rim too: the rim stays where that leaves few enough. */
        for (const auto vertex : made.vertices()) made.status(vertex).set_locked(made.is_boundary(vertex));
        if (decimater.initialize() && made.n_faces() > triangles) {
            const size_t collapses = decimater.decimate_to_faces(0, triangles);
            const size_t left = made.n_faces() - 2 * collapses; /* inside a surface each takes two */
            for (const auto vertex : made.vertices()) made.status(vertex).set_locked(false);
            if (left > triangles) decimater.decimate_to_faces(0, triangles);
        }
        made.garbage_collection();
        return from_surface(made, mesh, organ, out, error);
    });
}

} // namespace

extern "C" plm_status plm_mesh_decimate(const plm_mesh *mesh, size_t triangles, plm_mesh *out, plm_error *error)
{
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            if (mesh->triangle[i][k] >= mesh->vertex_count)
                return plm_fail(error, PLM_E_ARGUMENT, "triangle %zu names vertex %u of a mesh of %zu vertices", i,
                                mesh->triangle[i][k], mesh->vertex_count);
    /* A collapse takes some ten microseconds: large meshes that are far too fine are made coarser in linear time first. */
    const size_t quick = 20000;
    if (mesh->triangle_count <= quick || mesh->triangle_count <= 2 * triangles)
        return collapse(mesh, triangles, out, error);
    plm_mesh coarse = {};
    plm_status status = plm_mesh_cluster(mesh, 2 * triangles, &coarse, error);
    if (status == PLM_OK) status = collapse(&coarse, triangles, out, error);
    plm_mesh_free(&coarse);
    return status;
}
