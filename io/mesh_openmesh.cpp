/* io/mesh_openmesh.cpp: mesh files by OpenMesh. The contract is in mesh_openmesh.h.
 *
 * The triangles are handed to OpenMesh's writers by an exporter of our own and not as a half-edge mesh, which would
 * refuse edges with more than two triangles. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized" /* OpenMesh's PropertyT::push_back copies unset vectors */
#endif
#include "io/mesh_openmesh.h"

#include "cloud/guard.hpp"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/IO/exporter/ExporterT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/vector_cast.hh>

#include <cstring>
#include <sstream>

namespace
{
typedef OpenMesh::TriMesh_ArrayKernelT<> property_mesh; /* has no vertices or faces, only their properties */
typedef const uint8_t (*colours)[3];

class exporter : public OpenMesh::IO::ExporterT<property_mesh>
{
  public:
    exporter(const property_mesh &properties, const plm_mesh &mesh, const double origin[3], colours colour)
        : ExporterT(properties), mesh_(mesh), origin_(origin), colour_(colour)
    {
    }
    size_t n_vertices() const override
    {
        return mesh_.vertex_count;
    }
    OpenMesh::Vec3d pointd(OpenMesh::VertexHandle vertex) const override
    {
        const double *v = mesh_.vertex[vertex.idx()];
        return OpenMesh::Vec3d(origin_[0] + v[0], origin_[1] + v[1], origin_[2] + v[2]);
    }
    OpenMesh::Vec3f point(OpenMesh::VertexHandle vertex) const override
    {
        return OpenMesh::vector_cast<OpenMesh::Vec3f>(pointd(vertex));
    }
    size_t n_faces() const override
    {
        return mesh_.triangle_count;
    }
    bool has_face_colors() const override
    {
        return colour_ != nullptr;
    }
    unsigned int get_vhandles(OpenMesh::FaceHandle face, std::vector<OpenMesh::VertexHandle> &corners) const override
    {
        const uint32_t *triangle = mesh_.triangle[face.idx()];
        corners.clear();
        for (int i = 0; i < 3; i++) corners.push_back(OpenMesh::VertexHandle(static_cast<int>(triangle[i])));
        return 3;
    }
    OpenMesh::Vec3uc color(OpenMesh::FaceHandle face) const override
    {
        const uint8_t *rgb = colour_[face.idx()];
        return OpenMesh::Vec3uc(rgb[0], rgb[1], rgb[2]);
    }

  private:
    const plm_mesh &mesh_;
    const double *origin_;
    colours colour_;
};

/* OpenMesh prints to stderr; a library does not. */
void silence()
{
    static const bool done = (omlog().disable(), omerr().disable(), true);
    (void)done;
}

void add_organs(property_mesh &properties, const plm_mesh &mesh)
{
    OpenMesh::FPropHandleT<int> organ;
    properties.add_property(organ, "organ");
    properties.property(organ).set_persistent(true);
    properties.property(organ).data_vector().assign(mesh.face_organ, mesh.face_organ + mesh.triangle_count);
}
} // namespace

extern "C" plm_status plm_mesh_openmesh_write(const plm_mesh *mesh, const double origin[3],
                                              const uint8_t (*face_colour)[3], const char *format, plm_output *output,
                                              plm_error *error)
{
    return plm_guard(error, "OpenMesh's writer", [&] {
        using OpenMesh::IO::Options;
        silence();
        property_mesh properties;
        const bool is_ply = !std::strcmp(format, "PLY"), is_text = !std::strcmp(format, "OBJ");
        if (is_ply && mesh->face_organ) add_organs(properties, *mesh);
        Options options = is_text ? Options::Default : Options::Binary;
        if (is_ply && mesh->face_organ) options += Options::Custom;
        if (is_ply && face_colour) options += Options::FaceColor;
        exporter source(properties, *mesh, origin, is_ply ? face_colour : nullptr);
        std::ostringstream text;
        text.exceptions(std::ios::badbit); /* a stream keeps bad_alloc to itself else */
        const int digits = 9;              /* of a float: enough to find it again */
        if (!OpenMesh::IO::IOManager().write(text, format, source, options, digits))
            return plm_fail(error, PLM_E_LIBRARY, "OpenMesh cannot write %s", format);
        const std::string bytes = text.str();
        return plm_output_write(output, bytes.data(), bytes.size(), error);
    });
}
