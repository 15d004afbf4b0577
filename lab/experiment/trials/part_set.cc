#include "lab/experiment/trials/part_set.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/teaching/mesh/cad_part.h"
#include "client/teaching/mesh/stable_poses.h"
#include "rendering/mesh_part.h"
#include "rendering/random/counter_random.h"
#include "rendering/sample_parts.h"

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

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

absl::Status CheckNames(const PartSet& all, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (std::ranges::find(all.parts, name, &rendering::Workpiece::object_id) == all.parts.end()) {
      return absl::InvalidArgumentError(absl::StrCat("none of the meshes is called ", name,
                                                     "; give a file name without extension"));
    }
  }
  return absl::OkStatus();
}

// Of meshes with one id only the first would be used.
absl::Status CheckFileNames(const std::vector<std::filesystem::path>& paths) {
  std::map<std::string, std::filesystem::path> known;
  for (const std::filesystem::path& path : paths) {
    const auto [first, is_new] = known.try_emplace(rendering::ObjectIdOf(path), path);
    if (is_new) continue;
    return absl::InvalidArgumentError(absl::StrCat(first->second.string(), " and ", path.string(),
                                                   " would both be the object ", first->first,
                                                   "; rename one of the files"));
  }
  return absl::OkStatus();
}

}  // namespace

void PartSet::Add(const PartSet& other, std::size_t position) {
  parts.push_back(other.parts[position]);
  shapes.push_back(other.shapes[position]);
  object_mesh.push_back(other.object_mesh[position]);
}

void PartSet::Add(rendering::Workpiece part, const recognition::Pose& mesh_pose) {
  shapes.push_back(part.mesh.triangles.empty() ? nullptr
                                               : std::make_shared<const rendering::MeasuredShape>(
                                                     rendering::Measure(part)));
  parts.push_back(std::move(part));
  object_mesh.push_back(mesh_pose);
}

bool PartSet::IsTaught(std::size_t position) const {
  const auto taught = parts.begin() + static_cast<std::ptrdiff_t>(taught_count);
  return std::find_if(parts.begin(), taught, [&](const rendering::Workpiece& part) {
           return part.object_id == parts[position].object_id;
         }) != taught;
}

absl::StatusOr<PartSet> RestingParts(const std::vector<std::filesystem::path>& paths,
                                     double unit_scale_m, const MeshSelection& selection) {
  RETURN_IF_ERROR(CheckFileNames(paths));
  PartSet out;
  for (const std::filesystem::path& path : paths) {
    ASSIGN_OR_RETURN(const rendering::Workpiece as_it_lies,
                     rendering::WorkpieceFromMesh(path, unit_scale_m));
    ASSIGN_OR_RETURN(
        const auto found,
        client::FindStablePoses(as_it_lies.mesh, {.min_probability = selection.min_probability}));
    const auto count =
        std::min(found.poses.size(), static_cast<std::size_t>(selection.orientations));
    for (std::size_t i = 0; i < count; ++i) {
      rendering::Workpiece part = as_it_lies;
      part.stable_pose_id = absl::StrCat("resting-", i + 1);
      part.mesh = rendering::Transformed(as_it_lies.mesh, found.poses[i].object_mesh);
      part.grasps.clear();
      out.Add(std::move(part), found.poses[i].object_mesh);
    }
  }
  out.taught_count = out.parts.size();
  return out;
}

PartSet TwinParts() {
  PartSet out;
  for (rendering::Workpiece& part : rendering::SampleParts()) {
    out.Add(std::move(part), recognition::Pose::Identity());
  }
  out.taught_count = out.parts.size();
  return out;
}

absl::StatusOr<PartSet> Choose(const PartSet& all, PartChoice choice, const Choices& choices) {
  RETURN_IF_ERROR(CheckNames(all, choices.main));
  if (choice == PartChoice::kTwins) return TwinParts();
  PartSet out;
  PartSet others;
  for (std::size_t i = 0; i < all.parts.size(); ++i) {
    const bool is_first = i == 0 || all.parts[i].object_id != all.parts[i - 1].object_id;
    const bool is_round = all.shapes[i]->is_round;
    const bool is_main =
        choices.main.empty() ? !is_round : Contains(choices.main, all.parts[i].object_id);
    const double length = all.shapes[i]->diameter_m;
    if (choice == PartChoice::kEverything) {
      if (length >= choices.min_length_m && length <= choices.max_length_m) out.Add(all, i);
      continue;
    }
    if ((choice == PartChoice::kRound && is_round) ||
        (choice != PartChoice::kRound && is_first && is_main)) {
      out.Add(all, i);
    } else if (choice == PartChoice::kStrangers && is_first) {
      others.Add(all, i);
    }
  }
  if (out.parts.empty()) {
    return absl::FailedPreconditionError(choice == PartChoice::kRound
                                             ? "none of the meshes is round; leave this case out"
                                             : "no mesh is left; give some");
  }
  out.taught_count = out.parts.size();
  for (std::size_t i = 0; i < others.parts.size(); ++i) out.Add(others, i);
  return out;
}

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
