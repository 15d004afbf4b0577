// graspdb_fill DATA_DIR VIEWS: makes a large database for measurements of the server.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/cli/base/progress_line.h"
#include "lab/experiment/experiment_run.h"
#include "rendering/sample_parts.h"
#include "server/live/records.h"
#include "server/requests/convert.h"
#include "server/requests/record_checks.h"
#include "storage/catalogue/catalogue.h"
#include "storage/records/packed_cloud.h"
#include "tests/bench/seen_parts.h"

namespace graspdb::bench {
namespace {

constexpr int kWorkers = 2;

// One variant of all parts in the database.
struct Variant {
  std::size_t number = 0;
  std::vector<Eigen::Vector3f> factors;  // a part
  bool object_poses = true;              // views have object poses
};

std::string ObjectId(const rendering::Workpiece& part, const Variant& variant) {
  return absl::StrFormat("%s-%d", part.object_id, variant.number);
}

std::string StablePoseName(const rendering::Workpiece& part, const Variant& variant) {
  return absl::StrFormat("objects/%s/stablePoses/%s", ObjectId(part, variant), part.stable_pose_id);
}

// Makes a view like server/catalogue/teacher.cc.
absl::StatusOr<storage::NewView> MakeView(const SeenPart& seen, const Eigen::Vector3f& factors,
                                          const std::string& name, bool object_poses) {
  const recognition::DescriptorParameters parameters;
  const Eigen::Isometry3f sensor_world = seen.world_sensor.inverse().cast<float>();
  const Stretch stretch(seen, factors);
  std::vector<storage::CloudPoint> points;
  for (const Eigen::Vector3f& measured : seen.points) {
    const Eigen::Vector3f p = sensor_world * stretch(measured);
    points.push_back({p.x(), p.y(), p.z()});
  }
  storage::NewView out;
  absl::StatusOr<std::string> packed = storage::PackCloud(points);
  if (!packed.ok()) return packed.status();
  out.packed_cloud = *std::move(packed);
  auto cloud = server::CloudFromPacked(out.packed_cloud, seen.world_sensor, parameters);
  if (!cloud.ok()) return cloud.status();
  auto descriptor = server::MakeDescriptorRecord(*cloud, seen.world_sensor, parameters);
  if (!descriptor.ok()) return descriptor.status();
  out.record.set_name(name);
  out.record.set_content_digest(server::Sha256(name + out.packed_cloud));
  *out.record.mutable_sensor_pose() = server::PoseToProto(seen.world_sensor);
  *out.record.mutable_object_pose() = server::PoseToProto(seen.world_object);
  out.record.set_object_pose_given(object_poses);
  out.record.set_point_count(static_cast<int>(points.size()));
  *out.record.add_descriptors() = *std::move(descriptor);
  return out;
}

absl::Status Declare(storage::Catalogue& catalogue, const rendering::Workpiece& part,
                     const Variant& variant) {
  v1::Object object;
  object.set_name("objects/" + ObjectId(part, variant));
  object.set_display_name(part.display_name);
  if (auto made = catalogue.CreateObject(object); !made.ok()) return made.status();
  v1::StablePose pose;
  pose.set_name(StablePoseName(part, variant));
  pose.set_symmetry_order(part.symmetry_order);
  pose.mutable_grasps()->Assign(part.grasps.begin(), part.grasps.end());
  return catalogue.CreateStablePose(pose).status();
}

// Stores at most `count` views of a variant; returns how many.
absl::StatusOr<std::size_t> Store(storage::Catalogue& catalogue,
                                  const std::vector<rendering::Workpiece>& parts,
                                  const std::vector<SeenPart>& seen, const Variant& variant,
                                  std::size_t count) {
  for (const rendering::Workpiece& part : parts) {
    if (auto declared = Declare(catalogue, part, variant); !declared.ok()) return declared;
  }
  std::vector<storage::NewView> views(std::min(count, seen.size()));
  const auto make = [&](std::size_t i) {
    const std::size_t part = seen[i].part;
    const std::string name =
        absl::StrFormat("%s/views/turn-%03d", StablePoseName(parts[part], variant), i);
    auto view = MakeView(seen[i], variant.factors[part], name, variant.object_poses);
    if (!view.ok()) return view.status();
    views[i] = *std::move(view);
    return absl::OkStatus();
  };
  lab::ExperimentRun run;
  run.workers = kWorkers;
  absl::Status status = lab::ForEach(views.size(), "", run, make);
  if (!status.ok()) return status;
  if (auto stored = catalogue.PutViews(views); !stored.ok()) return stored.status();
  return views.size();
}

absl::Status Fill(const std::string& directory, int view_count, bool object_poses) {
  auto catalogue = storage::Catalogue::Open(directory);
  if (!catalogue.ok()) return catalogue.status();
  if ((*catalogue)->revision() != 0) {
    return absl::FailedPreconditionError("there is a catalogue in " + directory +
                                         " already; choose another folder");
  }
  const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  const std::vector<SeenPart> seen = SeeParts(parts);
  if (seen.empty()) return absl::InternalError("the simulated camera shows no part");
  Stretches stretches(parts.size());
  client::ProgressLine progress;
  const auto wanted = static_cast<std::size_t>(view_count);
  std::size_t done = 0;
  for (std::size_t number = 0; done < wanted; ++number) {
    auto stored =
        Store(**catalogue, parts, seen, {number, stretches.Next(), object_poses}, wanted - done);
    if (!stored.ok()) return stored.status();
    done += *stored;
    progress.Report(static_cast<int>(done), view_count);
  }
  return absl::OkStatus();
}

}  // namespace
}  // namespace graspdb::bench

int main(int argc, char** argv) {
  CLI::App app(
      "graspdb_fill makes a database of sample parts, and of variants scaled along their axes, for "
      "measurements of graspdb-server.",
      "graspdb_fill");
  std::string directory;
  int views = 0;
  app.add_option("DATA_DIR", directory, "Folder of the new database; it must not contain one")
      ->required();
  app.add_option("VIEWS", views, "Number of views")->required()->check(CLI::Range(1, 10'000'000));
  bool no_object_poses = false;
  app.add_flag("--no-object-poses", no_object_poses,
               "Views without object poses, so that each is a separate model");
  app.footer("Example: graspdb_fill /tmp/big 100000 && graspdb-server --db /tmp/big");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = graspdb::bench::Fill(directory, views, !no_object_poses);
  if (status.ok()) return 0;
  std::fprintf(stderr, "graspdb_fill: %s\n", std::string(status.message()).c_str());
  return 1;
}
