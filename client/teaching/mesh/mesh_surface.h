// The surface of a mesh as recognition models it, to compare its stable poses.
#pragma once

#include "recognition/models/surface_model.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::client {

// Points all over the surface of a mesh with their outward normals, mesh frame, m: about as dense
// as recognition's models, 60,000 at the most. Deterministic.
recognition::OrientedCloud SurfaceOf(const rendering::TriangleMesh& mesh);

// `surface` transformed by `object_mesh` (T_object_mesh) into the object's frame.
recognition::SurfaceModel Posed(const recognition::OrientedCloud& surface,
                                const recognition::Pose& object_mesh);

}  // namespace graspdb::client
