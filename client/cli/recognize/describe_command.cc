#include <google/protobuf/struct.pb.h>

#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/recognize/commands.h"
#include "files/points/point_file.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/segmentation/region.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::client {
namespace {

struct DescribeOptions {
  std::string file;
  std::string descriptor = "mvfh300";
  std::vector<double> viewpoint = {0, 0, 0};
};

constexpr char kDescribeFooter[] =
    R"(FILE has the points of one object in metres. Normals are read from the file; a file
without normals is downsampled to 3 mm voxels and its normals are estimated in a radius
of 10 mm, as on the server. The viewpoint is the sensor's position in the frame of the
points: 0,0,0 for points in the sensor frame.

The bins of VFH-263, MVFH-300 and GSH-288 sum to 1, with equal shares for all parts; each part
of VFH-308 sums to 100, as in the Point Cloud Library.

Example: graspdb describe mug.pcd --descriptor vfh308 --json)";

// The measured points with their normals.
recognition::OrientedCloud OrientedCloudOf(const files::PointFile& file,
                                           const Eigen::Vector3d& viewpoint) {
  recognition::OrientedCloud out;
  for (std::size_t i = 0; i < file.points.size(); ++i) {
    if (!recognition::IsMeasurement(file.points[i])) continue;
    if (!file.normals.empty()) {
      if (!file.normals[i].allFinite() || file.normals[i].isZero()) continue;
      out.normals.push_back(file.normals[i].normalized());
    }
    out.points.push_back(file.points[i]);
  }
  if (!file.normals.empty()) return out;
  return recognition::PrepareCloud(out.points, viewpoint, recognition::DescriptorParameters());
}

absl::Status PrintDescription(const GlobalOptions& global, const DescribeOptions& options,
                              const recognition::OrientedCloud& cloud,
                              const recognition::Descriptor& bins) {
  if (!global.json) {
    for (const float bin : bins) std::printf("%.9g\n", static_cast<double>(bin));
    return absl::OkStatus();
  }
  google::protobuf::Struct out;
  auto& fields = *out.mutable_fields();
  fields["path"].set_string_value(options.file);
  fields["descriptor"].set_string_value(options.descriptor);
  fields["pointCount"].set_number_value(static_cast<double>(cloud.points.size()));
  for (const float bin : bins) {
    fields["bins"].mutable_list_value()->add_values()->set_number_value(bin);
  }
  return PrintJson(out);
}

absl::Status RunDescribe(const GlobalOptions& global, const DescribeOptions& options) {
  ASSIGN_OR_RETURN(files::PointFile file, files::ReadPointFile(options.file));
  const Eigen::Vector3d viewpoint(options.viewpoint[0], options.viewpoint[1], options.viewpoint[2]);
  const recognition::OrientedCloud cloud = OrientedCloudOf(file, viewpoint);
  absl::StatusOr<recognition::Descriptor> bins =
      recognition::Describe(cloud, viewpoint, *recognition::DescriptorFromName(options.descriptor));
  if (!bins.ok()) {
    return {bins.status().code(), absl::StrCat(options.file, ": ", bins.status().message())};
  }
  return PrintDescription(global, options, cloud, *bins);
}

}  // namespace

void AddDescribeCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(app, "describe", "Print the descriptor of a cloud");
  auto options = std::make_shared<DescribeOptions>();
  command->add_option("FILE", options->file, "Point file (.pcd, .ply)")->required();
  command->add_option("--descriptor", options->descriptor, "Descriptor to compute")
      ->check(CLI::IsMember(recognition::DescriptorNames()))
      ->capture_default_str();
  command->add_option("--viewpoint", options->viewpoint, "Position of the sensor X,Y,Z, m")
      ->delimiter(',')
      ->expected(3);
  command->footer(kDescribeFooter);
  command->callback(
      [=, &global] { *action = [=, &global] { return RunDescribe(global, *options); }; });
}

}  // namespace graspdb::client
