#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <stdexcept>

#include "geometry/mesh_readers.h"

namespace geometry::detail {
namespace {

void append_mesh(const aiMesh& source, const aiMatrix4x4& to_world, const std::string& group, LoadedMesh& out) {
  const auto first_vertex = std::int32_t(out.mesh.vertices.size());
  const auto group_index = std::int32_t(out.group_names.size());
  const std::size_t triangles_before = out.mesh.triangles.size();
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines: not a surface
    std::array<std::int32_t, 3> corners;
    for (int c = 0; c < 3; ++c) {
      if (face.mIndices[c] >= source.mNumVertices)
        throw std::runtime_error("a face names a vertex that does not exist; export the mesh again");
      corners[c] = first_vertex + std::int32_t(face.mIndices[c]);
    }
    out.mesh.triangles.push_back(corners);
    out.group_of_triangle.push_back(group_index);
  }
  if (out.mesh.triangles.size() == triangles_before) return;
  for (unsigned v = 0; v < source.mNumVertices; ++v) {
    const aiVector3D at = to_world * source.mVertices[v];
    out.mesh.vertices.emplace_back(at.x, at.y, at.z);
  }
  out.group_names.push_back(group);
}

void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, int depth, LoadedMesh& out) {
  if (depth > 200) throw std::runtime_error("its nodes are nested more than 200 deep; flatten the scene");
  const aiMatrix4x4 to_world = parent * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    std::string name = node.mName.length > 0 ? node.mName.C_Str() : "";
    if (node.mNumMeshes > 1 || name.empty()) name = mesh.mName.length > 0 ? mesh.mName.C_Str() : name;
    append_mesh(mesh, to_world, name.empty() ? "mesh" : name, out);
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) append_node(scene, *node.mChildren[c], to_world, depth + 1, out);
}

}  // namespace

LoadedMesh read_with_assimp(const std::string& path, const std::string& format) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string why = importer.GetErrorString();
    why = why.substr(0, why.find('\n'));
    throw std::runtime_error("cannot be read as " + format + " (" + (why.empty() ? "no scene" : why) + "); export the mesh again");
  }
  LoadedMesh out;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), 0, out);
  return out;
}

}  // namespace geometry::detail
