// A straightforward pipeline from public classes of the Point Cloud Library: the same steps with
// the same parameters as ours, only for comparison.
#pragma once

#include <pcl/features/vfh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <memory>
#include <span>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/segmentation/segmentation_parameters.h"

namespace graspdb::peer {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using OrientedCloud = pcl::PointCloud<pcl::PointNormal>;
using Signature = pcl::VFHSignature308;

// One object on the table, world frame.
struct Object {
  Cloud::Ptr cloud;
  pcl::PointCloud<pcl::Normal>::Ptr normals;
  Signature signature;
};

// As organised as the frame, sensor frame; NaN without measurement.
Cloud::Ptr Unproject(std::span<const std::uint16_t> depth,
                     const recognition::CameraIntrinsics& camera, double unit_m);

Cloud::Ptr ToPcl(const recognition::Points& points);
OrientedCloud::Ptr ToPcl(const recognition::OrientedCloud& cloud);

// PassThrough three times, SACSegmentation and ExtractIndices, StatisticalOutlierRemoval,
// VoxelGrid, EuclideanClusterExtraction, NormalEstimation, VFHEstimation.
std::vector<Object> Describe(const Cloud::ConstPtr& frame, const Eigen::Isometry3d& world_sensor,
                             const recognition::Box& region,
                             const recognition::SegmentationParameters& segmentation,
                             const recognition::DescriptorParameters& descriptor);

// The signature of given points and normals.
Signature DescribeCloud(const recognition::OrientedCloud& cloud, const Eigen::Vector3d& viewpoint);

// Result of a registration.
struct Alignment {
  Eigen::Matrix4f target_source = Eigen::Matrix4f::Identity();
  double mean_squared_m2 = 0;  // getFitnessScore
};
// IterativeClosestPoint, 100 iterations.
Alignment Align(const Cloud::ConstPtr& source, const Cloud::ConstPtr& target,
                const Eigen::Matrix4f& guess, double max_correspondence_m);
// IterativeClosestPointWithNormals, 100 iterations.
Alignment AlignWithNormals(const OrientedCloud::ConstPtr& source,
                           const OrientedCloud::ConstPtr& target, const Eigen::Matrix4f& guess,
                           double max_correspondence_m);

// FLANN's kd-forest over signatures: 4 trees, 128 checks.
class Forest {
 public:
  explicit Forest(const std::vector<Signature>& signatures);
  ~Forest();
  std::vector<int> Nearest(const Signature& signature, int count) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

// A taught view.
struct View {
  OrientedCloud::Ptr cloud;  // world frame of its capture
  Eigen::Vector4f centroid = Eigen::Vector4f::Zero();
  Eigen::Matrix4f world_grasp = Eigen::Matrix4f::Identity();  // T_world_tcp of its capture
};

// The answer for one object.
struct Answer {
  int view = -1;
  Eigen::Matrix4f moved = Eigen::Matrix4f::Identity();  // from the view's capture to the scene
  Eigen::Matrix4f world_grasp = Eigen::Matrix4f::Identity();
};
// The `count` nearest views, each moved to the object's centroid and aligned with normals; returns
// the best fit.
Answer Recognize(const Object& object, const Forest& forest, const std::vector<View>& views,
                 int count, double max_correspondence_m);

}  // namespace graspdb::peer
