#include "recognition/segmentation/table_pieces.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "recognition/segmentation/region.h"

namespace graspdb::recognition {
namespace {

// The real tables in docs/adr/0040 are 0.29 m and 21 degrees wide or more; the widest faces in the
// same frames without their table 0.20 m and 18 degrees.
constexpr double kNarrowestTableM = 0.25;
constexpr double kNarrowestTableRad = 0.34;

struct Sampled {
  Eigen::Vector3f point;
  bool is_near = false;  // the plane
};

// Every n-th of the points.
std::vector<Sampled> SampleOf(const Plane& plane, const Points& points, double distance_m) {
  constexpr std::size_t kSamples = 4000;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kSamples);
  std::vector<Sampled> out;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const double height = plane.Height(points[i].cast<double>());
    out.push_back({points[i], std::abs(height) <= distance_m});
  }
  return out;
}

using Eigen::Vector3f;

// Cells of the table's plane, m: as near as the pixels of usual cameras.
constexpr float kCellM = 0.004F;
// Steps from cell to cell around a segment: to the end of its border, and of the table beyond. With
// twice the border, table that is flat again counts; twice as far beyond, other objects' flanks.
constexpr int kBorderSteps = 2;
constexpr int kBeyondSteps = 12;
// Cells of a ring that must show the table, to have a mean. Doubled, small pieces stay.
constexpr std::size_t kMinRingCells = 10;
// Share of the normals that are the table's, and their cosine (15 degrees). An object of which so
// much is level and that is that low is a plate or a shallow dome.
constexpr double kFlatShare = 0.9;
constexpr float kFlat = 0.966F;
// Heights, m, as they follow from the distortion of cameras and not from table_reach_m. Where the
// piece begins, the table has risen so high; the border of a plate has at most 2.7 mm, by mixed
// pixels, and half of that would remove plates.
constexpr double kRisenM = 0.003;
// From the border to the lowest tenth of the piece. Doubled, a plate on a risen table is removed.
constexpr double kBorderStepM = 0.0036;
// From table_reach_m to the highest tenth. Doubled, it covers domes as high as lids.
constexpr double kMaxTopM = 0.0045;
// Slope of the table from beyond to the border: the distortion of a camera changes slowly, the side
// of a dome is steeper. Doubled, domes of 10 mm are removed, of any diameter from 150 mm on.
constexpr double kMaxSlope = 0.09;

struct Cell {
  std::int32_t x;
  std::int32_t y;

  std::uint64_t key() const {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) |
           static_cast<std::uint32_t>(y);
  }
};

// The table's plane with two axes in it, for floats.
class TableGrid {
 public:
  explicit TableGrid(const Plane& table)
      : normal_(table.normal.cast<float>()),
        offset_(static_cast<float>(table.offset)),
        x_(table.normal.unitOrthogonal().cast<float>()),
        y_(normal_.cross(x_)) {}

  const Vector3f& normal() const { return normal_; }
  float Height(const Vector3f& p) const { return normal_.dot(p) - offset_; }
  Cell CellOf(const Vector3f& p) const {
    return {static_cast<std::int32_t>(std::floor(x_.dot(p) / kCellM)),
            static_cast<std::int32_t>(std::floor(y_.dot(p) / kCellM))};
  }

 private:
  Vector3f normal_;
  float offset_;
  Vector3f x_;
  Vector3f y_;
};

// Mean heights of the table's cells in rings.
class RingHeights {
 public:
  void Want(const Cell& cell) {
    sums_.try_emplace(cell.key());
    wanted_[Slot(cell)] = true;
  }
  void Add(const Cell& cell, float height) {
    if (!wanted_[Slot(cell)]) return;  // most cells, without a look-up
    const auto found = sums_.find(cell.key());
    if (found == sums_.end()) return;
    found->second.first += height;
    found->second.second += 1;
  }
  // Mean of the cells' means; absent where too few of them have points.
  std::optional<double> MeanOf(const std::vector<Cell>& ring) const {
    double sum = 0;
    std::size_t count = 0;
    for (const Cell& cell : ring) {
      const auto& [heights, points] = sums_.at(cell.key());
      if (points == 0) continue;
      sum += heights / points;
      count += 1;
    }
    if (count < kMinRingCells) return std::nullopt;
    return sum / static_cast<double>(count);
  }

 private:
  static std::size_t Slot(const Cell& cell) {
    return static_cast<std::size_t>((cell.key() * 0x9E3779B97F4A7C15U) >> 48U);
  }

  std::unordered_map<std::uint64_t, std::pair<double, int>> sums_;
  std::vector<bool> wanted_ = std::vector<bool>(1U << 16U);
};

// A segment that may be a piece of the table.
struct Candidate {
  std::size_t segment = 0;
  double lowest_m = 0;  // height of its lowest tenth
  std::vector<Cell> border = {};
  std::vector<Cell> beyond = {};
};

// Heights of the lowest and the highest tenth of the segment.
std::pair<double, double> TenthsOf(const Segment& segment, const TableGrid& grid) {
  std::vector<float> heights;
  heights.reserve(segment.cloud.points.size());
  for (const Vector3f& p : segment.cloud.points) heights.push_back(grid.Height(p));
  const auto tenth = static_cast<std::ptrdiff_t>(heights.size() / 10);
  std::nth_element(heights.begin(), heights.begin() + tenth, heights.end());
  const double lowest_m = heights[static_cast<std::size_t>(tenth)];
  std::nth_element(heights.begin(), heights.end() - 1 - tenth, heights.end());
  return {lowest_m, *(heights.end() - 1 - tenth)};
}

bool IsFlat(const Segment& segment, const TableGrid& grid) {
  const auto is_flat = [&](const Vector3f& n) { return n.dot(grid.normal()) > kFlat; };
  const auto flat = std::ranges::count_if(segment.cloud.normals, is_flat);
  return static_cast<double>(flat) >= kFlatShare * static_cast<double>(segment.cloud.points.size());
}

// Fills in the cells around those of the segment: each step adds the neighbours of the one before.
void FindRings(const Segment& segment, const TableGrid& grid, Candidate* candidate) {
  std::unordered_set<std::uint64_t> known;
  std::vector<Cell> last;
  for (const Vector3f& p : segment.cloud.points) {
    const Cell cell = grid.CellOf(p);
    if (known.insert(cell.key()).second) last.push_back(cell);
  }
  for (int step = 1; step <= kBeyondSteps; ++step) {
    std::vector<Cell> next;
    for (const Cell& c : last) {
      const std::array<Cell, 4> near = {
          {{c.x - 1, c.y}, {c.x + 1, c.y}, {c.x, c.y - 1}, {c.x, c.y + 1}}};
      std::ranges::copy_if(near, std::back_inserter(next),
                           [&](const Cell& n) { return known.insert(n.key()).second; });
    }
    std::vector<Cell>& ring = step <= kBorderSteps ? candidate->border : candidate->beyond;
    ring.insert(ring.end(), next.begin(), next.end());
    last = std::move(next);
  }
}

std::vector<Candidate> FindCandidates(const Segmentation& segmentation, const TableGrid& grid,
                                      const IsCancelled& is_cancelled) {
  std::vector<Candidate> out;
  CancellationPoll poll(is_cancelled);
  for (std::size_t i = 0; i < segmentation.segments.size(); ++i) {
    const Segment& segment = segmentation.segments[i];
    if (poll.AfterPoints(segment.cloud.points.size())) return out;
    if (segment.too_large) continue;  // rejected without a search
    const auto [lowest_m, highest_m] = TenthsOf(segment, grid);
    if (highest_m > segmentation.table_reach_m + kMaxTopM || !IsFlat(segment, grid)) continue;
    FindRings(segment, grid, &out.emplace_back(Candidate{i, lowest_m}));
  }
  return out;
}

bool IsPiece(const Candidate& candidate, const RingHeights& table) {
  const std::optional<double> border_m = table.MeanOf(candidate.border);
  const std::optional<double> beyond_m = table.MeanOf(candidate.beyond);
  if (!border_m || !beyond_m) return false;
  // Between the middles of the rings.
  constexpr double kDistanceM = 0.5 * kBeyondSteps * static_cast<double>(kCellM);
  return *border_m > kRisenM && candidate.lowest_m < *border_m + kBorderStepM &&
         *border_m - *beyond_m < kMaxSlope * kDistanceM;
}

RingHeights MeasureRings(const Scan& scan, const Segmentation& segmentation,
                         const std::vector<Candidate>& candidates, const TableGrid& grid,
                         const IsCancelled& is_cancelled) {
  RingHeights out;
  for (const Candidate& candidate : candidates) {
    for (const Cell& cell : candidate.border) out.Want(cell);
    for (const Cell& cell : candidate.beyond) out.Want(cell);
  }
  CancellationPoll poll(is_cancelled);
  const Eigen::Isometry3f world_sensor = segmentation.world_sensor.cast<float>();
  const auto reach_m = static_cast<float>(segmentation.table_reach_m);
  for (std::size_t i = 0; i < scan.size() && !poll.AfterPoints(); ++i) {
    const Vector3f measured = scan.PointAt(i);
    if (!IsMeasurement(measured)) continue;
    const Vector3f p = world_sensor * measured;
    const float height = grid.Height(p);
    if (std::abs(height) <= reach_m) out.Add(grid.CellOf(p), height);
  }
  return out;
}

}  // namespace

bool IsSurface(const Plane& plane, const Points& points, double distance_m) {
  constexpr std::size_t kCentres = 200;
  constexpr float kAroundM = 0.03F;
  constexpr double kNearlyAll = 0.8;
  const std::vector<Sampled> sample = SampleOf(plane, points, distance_m);
  std::vector<Sampled> centres;
  std::ranges::copy_if(sample, std::back_inserter(centres), &Sampled::is_near);
  const std::size_t stride = std::max<std::size_t>(1, centres.size() / kCentres);
  int votes = 0;
  for (std::size_t c = 0; c < centres.size(); c += stride) {
    double around = 0;
    double near = 0;
    for (const Sampled& s : sample) {
      if ((s.point - centres[c].point).squaredNorm() > kAroundM * kAroundM) continue;
      around += 1;
      near += s.is_near ? 1 : 0;
    }
    votes += near >= kNearlyAll * around ? 1 : -1;
  }
  return votes > 0;
}

bool IsWideEnough(const Plane& plane, const Points& points, double distance_m) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double count = 0;
  for (const Sampled& s : SampleOf(plane, points, distance_m)) {
    if (!s.is_near) continue;
    const Eigen::Vector3d p = s.point.cast<double>();
    sum += p;
    products += p * p.transpose();
    ++count;
  }
  if (count < 3) return false;
  const Eigen::Vector3d mean = sum / count;
  const Eigen::Matrix3d covariance = products / count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  // The sides of a rectangle with these second moments.
  const double narrow_m = std::sqrt(12 * std::max(0.0, solver.eigenvalues()[1]));
  return narrow_m >= kNarrowestTableM || narrow_m >= kNarrowestTableRad * mean.norm();
}

void RemoveTablePieces(const Scan& scan, const IsCancelled& is_cancelled, StageLog* log,
                       Segmentation* segmentation) {
  if (!segmentation->table || segmentation->segments.empty()) return;
  const TableGrid grid(*segmentation->table);
  const std::vector<Candidate> candidates = FindCandidates(*segmentation, grid, is_cancelled);
  if (candidates.empty()) return;
  std::vector<Segment> kept;
  std::size_t voxels = 0;
  std::size_t kept_voxels = 0;
  StageLog step;
  const auto remove = [&] {
    const RingHeights table = MeasureRings(scan, *segmentation, candidates, grid, is_cancelled);
    auto candidate = candidates.begin();
    for (std::size_t i = 0; i < segmentation->segments.size(); ++i) {
      Segment& segment = segmentation->segments[i];
      voxels += segment.cloud.points.size();
      const bool is_candidate = candidate != candidates.end() && candidate->segment == i;
      if (is_candidate && IsPiece(*candidate++, table)) continue;
      kept_voxels += segment.cloud.points.size();
      kept.push_back(std::move(segment));
    }
    return kept_voxels;
  };
  step.Measure("table_pieces", 0, remove);
  segmentation->segments = std::move(kept);
  if (kept_voxels == voxels) return;
  step.Measure("table_pieces", voxels, [] { return std::size_t{0}; });
  log->Add(step);
  if (segmentation->segments.empty()) segmentation->outcome = SegmentationOutcome::kNoCluster;
}

}  // namespace graspdb::recognition
