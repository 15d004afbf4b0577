#include "lab/experiment/trials/drop_poses.h"

#include <map>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/teaching/mesh/cad_part.h"
#include "rendering/mesh_part.h"
#include "rendering/random/counter_random.h"

namespace graspdb::lab {
namespace {

enum DropStream : std::uint64_t { kFalls = 200 };

struct Mesh {
  rendering::Workpiece as_it_lies;
  std::vector<client::RestingFacet> facets;
};

// Adds its taught stable poses to `out`.
absl::StatusOr<Mesh> Teach(rendering::Workpiece as_it_lies, PartSet* out) {
  ASSIGN_OR_RETURN(
      auto taught,
      client::ProposeCadPart(as_it_lies.object_id, as_it_lies.display_name, as_it_lies.mesh, {}));
  ASSIGN_OR_RETURN(const auto hull, client::HullOf(as_it_lies.mesh.vertices));
  ASSIGN_OR_RETURN(auto facets, client::RestingFacets(hull, taught.found.mass.center, 0));
  for (std::size_t i = 0; i < taught.workpieces.size(); ++i) {
    out->Add(std::move(taught.workpieces[i]), taught.found.poses[i].object_mesh);
  }
  return Mesh{std::move(as_it_lies), std::move(facets)};
}

// The facet at which the probabilities add up to `share`.
const client::RestingFacet& Drawn(const std::vector<client::RestingFacet>& facets, double share) {
  for (const client::RestingFacet& facet : facets) {
    share -= facet.probability;
    if (share < 0) return facet;
  }
  return facets.back();
}

void AddFalls(const Mesh& mesh, std::uint64_t number, const DropPoseSelection& selection,
              PartSet* out) {
  std::map<int, std::size_t> of_facet;  // position of the part
  for (int i = 0; i < selection.falls; ++i) {
    const double share = rendering::RandomUniform(
        selection.seed, rendering::RandomBits(0, kFalls, number), static_cast<std::uint64_t>(i));
    const client::RestingFacet& facet = Drawn(mesh.facets, share);
    const auto [found, is_new] = of_facet.emplace(facet.facet, out->parts.size());
    out->queried_parts.push_back(found->second);
    if (!is_new) continue;
    rendering::Workpiece part = mesh.as_it_lies;
    part.stable_pose_id = absl::StrCat("drop-", of_facet.size());
    part.grasps.clear();
    const recognition::Pose pose = client::PutDown(part.mesh, facet.down);
    part.mesh = rendering::Transformed(part.mesh, pose);
    out->Add(std::move(part), pose);
  }
}

}  // namespace

absl::StatusOr<PartSet> DropPoses(const std::vector<std::filesystem::path>& paths,
                                  double unit_scale_m, const DropPoseSelection& selection) {
  PartSet out;
  std::vector<Mesh> meshes;
  for (const std::filesystem::path& path : paths) {
    ASSIGN_OR_RETURN(auto as_it_lies, rendering::WorkpieceFromMesh(path, unit_scale_m));
    const double length = rendering::DiameterOf(as_it_lies.mesh);
    if (length < selection.min_length_m || length > selection.max_length_m) continue;
    ASSIGN_OR_RETURN(auto mesh, Teach(std::move(as_it_lies), &out));
    meshes.push_back(std::move(mesh));
  }
  if (meshes.empty()) return absl::FailedPreconditionError("no mesh is left; give some");
  out.taught_count = out.parts.size();
  for (std::size_t i = 0; i < meshes.size(); ++i) AddFalls(meshes[i], i, selection, &out);
  return out;
}

}  // namespace graspdb::lab
