#include "tests/bench/peer/peer_pcl.h"

#include <pcl/common/centroid.h>
#include <pcl/common/transforms.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/extract_indices.h>
#include <pcl/filters/passthrough.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <flann/flann.hpp>
#include <limits>

namespace graspdb::peer {
namespace {

using pcl::Normal;
using pcl::PointXYZ;
using Search = pcl::search::KdTree<PointXYZ>;

constexpr int kIcpIterations = 100;
constexpr int kTrees = 4;
constexpr int kChecks = 128;
constexpr int kPlaneIterations = 1000;

Cloud::Ptr PassThrough(const Cloud::ConstPtr& in, const char* axis, double low, double high) {
  pcl::PassThrough<PointXYZ> filter;
  filter.setInputCloud(in);
  filter.setFilterFieldName(axis);
  filter.setFilterLimits(static_cast<float>(low), static_cast<float>(high));
  Cloud::Ptr out(new Cloud);
  filter.filter(*out);
  return out;
}

Cloud::Ptr Crop(const Cloud::ConstPtr& world, const recognition::Box& region) {
  const Cloud::Ptr x = PassThrough(world, "x", region.min.x(), region.max.x());
  const Cloud::Ptr y = PassThrough(x, "y", region.min.y(), region.max.y());
  return PassThrough(y, "z", region.min.z(), region.max.z());
}

Cloud::Ptr RemovePlane(const Cloud::ConstPtr& in,
                       const recognition::SegmentationParameters& parameters) {
  pcl::SACSegmentation<PointXYZ> plane;
  plane.setOptimizeCoefficients(true);
  plane.setModelType(pcl::SACMODEL_PLANE);
  plane.setMethodType(pcl::SAC_RANSAC);
  plane.setMaxIterations(kPlaneIterations);
  plane.setDistanceThreshold(parameters.plane_distance_m);
  plane.setInputCloud(in);
  pcl::ModelCoefficients coefficients;
  const pcl::PointIndices::Ptr inliers(new pcl::PointIndices);
  plane.segment(*inliers, coefficients);
  pcl::ExtractIndices<PointXYZ> extract;
  extract.setInputCloud(in);
  extract.setIndices(inliers);
  extract.setNegative(true);
  Cloud::Ptr out(new Cloud);
  extract.filter(*out);
  return out;
}

Cloud::Ptr RemoveOutliers(const Cloud::ConstPtr& in,
                          const recognition::SegmentationParameters& parameters) {
  pcl::StatisticalOutlierRemoval<PointXYZ> filter;
  filter.setInputCloud(in);
  filter.setMeanK(parameters.outlier_neighbor_count);
  filter.setStddevMulThresh(parameters.outlier_deviation_factor);
  Cloud::Ptr out(new Cloud);
  filter.filter(*out);
  return out;
}

Cloud::Ptr Voxels(const Cloud::ConstPtr& in, double size_m) {
  pcl::VoxelGrid<PointXYZ> grid;
  grid.setInputCloud(in);
  const auto leaf = static_cast<float>(size_m);
  grid.setLeafSize(leaf, leaf, leaf);
  Cloud::Ptr out(new Cloud);
  grid.filter(*out);
  return out;
}

std::vector<pcl::PointIndices> Clusters(const Cloud::ConstPtr& in,
                                        const recognition::SegmentationParameters& parameters) {
  if (in->empty()) return {};
  const auto search = pcl::make_shared<Search>();
  search->setInputCloud(in);
  pcl::EuclideanClusterExtraction<PointXYZ> clusters;
  clusters.setClusterTolerance(parameters.cluster_tolerance_m);
  clusters.setMinClusterSize(static_cast<pcl::uindex_t>(parameters.min_cluster_point_count));
  clusters.setMaxClusterSize(std::numeric_limits<int>::max());
  clusters.setSearchMethod(search);
  clusters.setInputCloud(in);
  std::vector<pcl::PointIndices> out;
  clusters.extract(out);
  return out;
}

pcl::PointCloud<Normal>::Ptr Normals(const Cloud::ConstPtr& in, const Eigen::Vector3f& viewpoint,
                                     double radius_m) {
  pcl::NormalEstimation<PointXYZ, Normal> normals;
  normals.setInputCloud(in);
  normals.setSearchMethod(pcl::make_shared<Search>());
  normals.setRadiusSearch(radius_m);
  normals.setViewPoint(viewpoint.x(), viewpoint.y(), viewpoint.z());
  pcl::PointCloud<Normal>::Ptr out(new pcl::PointCloud<Normal>);
  normals.compute(*out);
  return out;
}

Signature Vfh(const Cloud::ConstPtr& cloud, const pcl::PointCloud<Normal>::ConstPtr& normals,
              const Eigen::Vector3f& viewpoint) {
  pcl::VFHEstimation<PointXYZ, Normal, Signature> vfh;
  vfh.setInputCloud(cloud);
  vfh.setInputNormals(normals);
  vfh.setSearchMethod(pcl::make_shared<Search>());
  vfh.setViewPoint(viewpoint.x(), viewpoint.y(), viewpoint.z());
  pcl::PointCloud<Signature> out;
  vfh.compute(out);
  return out.front();
}

template <typename Icp, typename Ptr>
Alignment Run(const Ptr& source, const Ptr& target, const Eigen::Matrix4f& guess,
              double max_correspondence_m) {
  Icp icp;
  icp.setInputSource(source);
  icp.setInputTarget(target);
  icp.setMaximumIterations(kIcpIterations);
  icp.setMaxCorrespondenceDistance(max_correspondence_m);
  icp.setTransformationEpsilon(1e-9);
  icp.setEuclideanFitnessEpsilon(1e-9);
  std::remove_const_t<typename Ptr::element_type> aligned;
  icp.align(aligned, guess);
  return {icp.getFinalTransformation(), icp.getFitnessScore()};
}

OrientedCloud::Ptr Join(const Cloud& points, const pcl::PointCloud<Normal>& normals) {
  OrientedCloud::Ptr out(new OrientedCloud);
  pcl::concatenateFields(points, normals, *out);
  return out;
}

}  // namespace

Cloud::Ptr Unproject(std::span<const std::uint16_t> depth,
                     const recognition::CameraIntrinsics& camera, double unit_m) {
  Cloud::Ptr out(new Cloud(static_cast<std::uint32_t>(camera.width),
                           static_cast<std::uint32_t>(camera.height)));
  out->is_dense = false;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::size_t i = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u, ++i) {
      const double z = depth[i] * unit_m;
      (*out)[i] = depth[i] == 0 ? PointXYZ(nan, nan, nan)
                                : PointXYZ(static_cast<float>((u - camera.cx) * z / camera.fx),
                                           static_cast<float>((v - camera.cy) * z / camera.fy),
                                           static_cast<float>(z));
    }
  }
  return out;
}

Cloud::Ptr ToPcl(const recognition::Points& points) {
  Cloud::Ptr out(new Cloud);
  for (const auto& p : points) out->push_back({p.x(), p.y(), p.z()});
  out->is_dense = false;
  return out;
}

OrientedCloud::Ptr ToPcl(const recognition::OrientedCloud& cloud) {
  OrientedCloud::Ptr out(new OrientedCloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    pcl::PointNormal p;
    p.getVector3fMap() = cloud.points[i];
    p.getNormalVector3fMap() = cloud.normals[i];
    out->push_back(p);
  }
  return out;
}

std::vector<Object> Describe(const Cloud::ConstPtr& frame, const Eigen::Isometry3d& world_sensor,
                             const recognition::Box& region,
                             const recognition::SegmentationParameters& segmentation,
                             const recognition::DescriptorParameters& descriptor) {
  const Cloud::Ptr world(new Cloud);
  pcl::transformPointCloud(*frame, *world, world_sensor.cast<float>().matrix());
  const Cloud::Ptr above = RemovePlane(Crop(world, region), segmentation);
  const Cloud::Ptr voxels = Voxels(RemoveOutliers(above, segmentation), descriptor.voxel_size_m);
  const Eigen::Vector3f viewpoint = world_sensor.translation().cast<float>();
  std::vector<Object> out;
  for (const pcl::PointIndices& cluster : Clusters(voxels, segmentation)) {
    Object object;
    object.cloud.reset(new Cloud(*voxels, cluster.indices));
    object.normals = Normals(object.cloud, viewpoint, descriptor.normal_radius_m);
    object.signature = Vfh(object.cloud, object.normals, viewpoint);
    out.push_back(std::move(object));
  }
  return out;
}

Signature DescribeCloud(const recognition::OrientedCloud& cloud, const Eigen::Vector3d& viewpoint) {
  const Cloud::Ptr points = ToPcl(cloud.points);
  const pcl::PointCloud<Normal>::Ptr normals(new pcl::PointCloud<Normal>);
  for (const auto& n : cloud.normals) normals->push_back({n.x(), n.y(), n.z()});
  return Vfh(points, normals, viewpoint.cast<float>());
}

Alignment Align(const Cloud::ConstPtr& source, const Cloud::ConstPtr& target,
                const Eigen::Matrix4f& guess, double max_correspondence_m) {
  return Run<pcl::IterativeClosestPoint<PointXYZ, PointXYZ>>(source, target, guess,
                                                             max_correspondence_m);
}

Alignment AlignWithNormals(const OrientedCloud::ConstPtr& source,
                           const OrientedCloud::ConstPtr& target, const Eigen::Matrix4f& guess,
                           double max_correspondence_m) {
  return Run<pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal>>(
      source, target, guess, max_correspondence_m);
}

struct Forest::Index {
  std::vector<float> rows;
  std::unique_ptr<flann::Index<flann::ChiSquareDistance<float>>> forest;
};

Forest::Forest(const std::vector<Signature>& signatures) : index_(std::make_unique<Index>()) {
  constexpr std::size_t kBins = 308;
  index_->rows.reserve(signatures.size() * kBins);
  for (const Signature& s : signatures) {
    index_->rows.insert(index_->rows.end(), s.histogram, s.histogram + kBins);
  }
  index_->forest = std::make_unique<flann::Index<flann::ChiSquareDistance<float>>>(
      flann::Matrix<float>(index_->rows.data(), signatures.size(), kBins),
      flann::KDTreeIndexParams(kTrees));
  index_->forest->buildIndex();
}

Forest::~Forest() = default;

std::vector<int> Forest::Nearest(const Signature& signature, int count) const {
  Signature query = signature;
  std::vector<std::vector<int>> found;
  std::vector<std::vector<float>> distances;
  index_->forest->knnSearch(flann::Matrix<float>(query.histogram, 1, 308), found, distances,
                            static_cast<std::size_t>(count), flann::SearchParams(kChecks));
  return found.front();
}

Answer Recognize(const Object& object, const Forest& forest, const std::vector<View>& views,
                 int count, double max_correspondence_m) {
  const OrientedCloud::Ptr scene = Join(*object.cloud, *object.normals);
  Eigen::Vector4f centroid;
  pcl::compute3DCentroid(*scene, centroid);
  Answer best;
  double least = std::numeric_limits<double>::infinity();
  for (const int i : forest.Nearest(object.signature, count)) {
    const View& view = views[static_cast<std::size_t>(i)];
    Eigen::Matrix4f guess = Eigen::Matrix4f::Identity();
    guess.topRightCorner<3, 1>() = (centroid - view.centroid).head<3>();
    const Alignment alignment = AlignWithNormals(view.cloud, scene, guess, max_correspondence_m);
    if (alignment.mean_squared_m2 >= least) continue;
    least = alignment.mean_squared_m2;
    best = {i, alignment.target_source, alignment.target_source * view.world_grasp};
  }
  return best;
}

}  // namespace graspdb::peer
