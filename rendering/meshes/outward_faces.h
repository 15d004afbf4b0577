// Which side of each triangle of a mesh is outside.
#pragma once

#include "rendering/meshes/mesh.h"

namespace graspdb::rendering {

// Turns triangles so that neighbours, which share an edge with each other only, turn alike, and
// then closed shells outwards. A closed shell within another one is a cavity if it turns against
// it, or if its triangles did not turn alike. An open surface stays as most of its area is; it has
// no outside. Surfaces that cannot be turned stay as they are: those with one side only, and open
// ones with much area turned each way.
//
// Deterministic, n log n in the number of triangles.
void TurnOutwards(TriangleMesh& mesh);

// Share of the pairs of neighbouring triangles that turn against each other: after TurnOutwards, of
// surfaces that cannot be turned. 0 without neighbours.
double OpposedShare(const TriangleMesh& mesh);

// Removes triangles that repeat another one. Where all are there twice, once for each side, one of
// each is left: such a surface encloses nothing.
void RemoveRepeated(TriangleMesh& mesh);

}  // namespace graspdb::rendering
