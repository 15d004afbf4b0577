#include "recognition/points/point_search.h"

#include <cmath>
#include <flann/flann.hpp>

namespace graspdb::recognition {
namespace {

constexpr int kLeafSize = 12;

// Collects matches into a vector of neighbours; FLANN's interface of a result set.
class RadiusResult : public flann::ResultSet<float> {
 public:
  RadiusResult(float squared_radius, std::vector<Neighbor>* out)
      : squared_radius_(squared_radius), out_(out) {}
  bool full() const override { return true; }
  void addPoint(float distance, std::size_t index) override {
    if (distance <= squared_radius_) out_->push_back({static_cast<int>(index), distance});
  }
  // FLANN leaves out points at the worst distance; the radius itself shall be within.
  float worstDist() const override {
    return std::nextafter(squared_radius_, std::numeric_limits<float>::infinity());
  }

 private:
  float squared_radius_;
  std::vector<Neighbor>* out_;
};

}  // namespace

// FLANN searches bounded sets of points deterministically with its single kd-tree.
class PointSearch::Tree {
 public:
  explicit Tree(const Points& points) : points_(points) {
    if (points_.empty()) return;
    index_ =
        std::make_unique<Index>(flann::Matrix<float>(points_.front().data(), points_.size(), 3),
                                flann::KDTreeSingleIndexParams(kLeafSize, /*reorder=*/true));
    index_->buildIndex();
  }

  template <typename Result>
  void Search(const Eigen::Vector3f& query, Result* result) const {
    if (index_) index_->findNeighbors(*result, query.data(), exact_);
  }

  std::size_t size() const { return points_.size(); }

 private:
  using Index = flann::KDTreeSingleIndex<flann::L2_3D<float>>;

  Points points_;
  flann::SearchParams exact_{flann::FLANN_CHECKS_UNLIMITED, 0.0F, true};
  std::unique_ptr<Index> index_;
};

PointSearch::PointSearch(const Points& points) : tree_(std::make_unique<Tree>(points)) {}
PointSearch::~PointSearch() = default;
PointSearch::PointSearch(PointSearch&&) noexcept = default;
PointSearch& PointSearch::operator=(PointSearch&&) noexcept = default;

Neighbor PointSearch::Nearest(const Eigen::Vector3f& query) const {
  if (tree_->size() == 0) return {};
  flann::KNNSimpleResultSet<float> result(1);
  tree_->Search(query, &result);
  std::size_t index = 0;
  float distance = 0;
  result.copy(&index, &distance, 1, false);
  return {static_cast<int>(index), distance};
}

void PointSearch::Nearest(const Eigen::Vector3f& query, int count,
                          std::vector<Neighbor>* out) const {
  out->clear();
  const std::size_t wanted = std::min(static_cast<std::size_t>(count), tree_->size());
  if (wanted == 0) return;
  flann::KNNSimpleResultSet<float> result(wanted);
  tree_->Search(query, &result);
  std::vector<std::size_t> indices(wanted);
  std::vector<float> distances(wanted);
  result.copy(indices.data(), distances.data(), wanted, true);
  for (std::size_t i = 0; i < wanted; ++i) {
    out->push_back({static_cast<int>(indices[i]), distances[i]});
  }
}

void PointSearch::Within(const Eigen::Vector3f& query, float radius,
                         std::vector<Neighbor>* out) const {
  out->clear();
  RadiusResult result(radius * radius, out);
  tree_->Search(query, &result);
}

}  // namespace graspdb::recognition
