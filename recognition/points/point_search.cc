#include "recognition/points/point_search.h"

#include <cstddef>
#include <flann/flann.hpp>

namespace graspdb::recognition {
namespace {

constexpr int kLeafSize = 12;

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

  Neighbor Nearest(const Eigen::Vector3f& query) const {
    if (!index_) return {};
    flann::KNNSimpleResultSet<float> result(1);
    index_->findNeighbors(result, query.data(), exact_);
    std::size_t index = 0;
    float distance = 0;
    result.copy(&index, &distance, 1, false);
    return {static_cast<int>(index), distance};
  }

 private:
  using Index = flann::KDTreeSingleIndex<flann::L2_3D<float>>;

  Points points_;
  flann::SearchParams exact_{flann::FLANN_CHECKS_UNLIMITED, 0.0F, true};
  std::unique_ptr<Index> index_;
};

PointSearch::PointSearch(const Points& points) : tree_(std::make_unique<Tree>(points)) {}
PointSearch::~PointSearch() = default;
PointSearch::PointSearch(PointSearch&&) noexcept = default;

Neighbor PointSearch::Nearest(const Eigen::Vector3f& query) const { return tree_->Nearest(query); }

}  // namespace graspdb::recognition
