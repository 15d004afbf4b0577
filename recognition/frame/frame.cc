#include "recognition/frame/frame.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "recognition/base/idle_cores.h"

namespace graspdb::recognition {
namespace {

// No depth camera measures nearer or farther, m.
constexpr float kNearestZ = 0.05F;
constexpr float kFarthestZ = 100;
// Deviation from a pinhole image up to which an organised cloud is one, pixels.
constexpr double kMaxPinholeErrorPx = 0.75;
// Rows of an image that are one piece of work.
constexpr int kBandRows = 32;

bool IsDepth(float z) { return z > kNearestZ && z < kFarthestZ; }
bool IsDepth(const Eigen::Vector3f& p) { return p.allFinite() && IsDepth(p.z()); }

// A line y = slope * x + offset, by least squares.
struct LineFit {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;

  void Add(double x, double y) {
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    syy += y * y;
  }
  bool Solve(double* slope, double* offset) const {
    const double spread = sxx - sx * sx / n;
    if (n < 100 || !(spread > 1e-9)) return false;
    *slope = (sxy - sx * sy / n) / spread;
    *offset = (sy - *slope * sx) / n;
    const double rest = syy - sy * sy / n - *slope * *slope * spread;
    return std::sqrt(std::max(0.0, rest / n)) < kMaxPinholeErrorPx;
  }
};

// The camera of an organised cloud, where it is a pinhole image.
std::optional<CameraIntrinsics> CameraOfCloud(const Points& points, int width) {
  const auto columns = static_cast<std::size_t>(width);
  if (width <= 1 || points.size() % columns != 0) return std::nullopt;
  const std::size_t rows = points.size() / columns;
  if (rows < 2) return std::nullopt;
  LineFit across;
  LineFit down;
  constexpr std::size_t kStride = 7;
  for (std::size_t i = 0; i < points.size(); i += kStride) {
    const Eigen::Vector3f& p = points[i];
    if (!IsDepth(p)) continue;
    across.Add(p.x() / p.z(), static_cast<double>(i % columns));
    const std::size_t row = i / columns;
    down.Add(p.y() / p.z(), static_cast<double>(row));
  }
  CameraIntrinsics out;
  out.width = width;
  out.height = static_cast<int>(rows);
  if (!across.Solve(&out.fx, &out.cx) || !down.Solve(&out.fy, &out.cy)) return std::nullopt;
  if (out.fx <= 0 || out.fy <= 0) return std::nullopt;
  return out;
}

// Every how many pixels are kept of a row and of a column.
int StepOf(const CameraIntrinsics& camera, const FrameParameters& parameters) {
  const double pixels = static_cast<double>(camera.width) * camera.height;
  const double step = std::max(std::round(camera.fx / parameters.max_focal_px),
                               std::ceil(std::sqrt(pixels / parameters.max_pixels)));
  return static_cast<int>(std::clamp(step, 1.0, 1e4));
}

void Thin(int step, CameraIntrinsics* camera) {
  camera->width = (camera->width + step - 1) / step;
  camera->height = (camera->height + step - 1) / step;
  for (double* value : {&camera->fx, &camera->fy, &camera->cx, &camera->cy}) *value /= step;
}

// Pixels [low, high) of an image.
struct Window {
  Eigen::Array2i low;
  Eigen::Array2i high;
};

// The pixels within `margin_m` of points; all of them without points.
Window WindowAround(const Points& points, float margin_m, const CameraIntrinsics& camera) {
  const Eigen::Array2i size(camera.width, camera.height);
  if (points.empty()) return {Eigen::Array2i::Zero(), size};
  const Eigen::Array2d focal(camera.fx, camera.fy);
  const Eigen::Array2d middle(camera.cx, camera.cy);
  const Eigen::Array2d end = size.cast<double>();
  Eigen::Array2d low = end;
  Eigen::Array2d high = Eigen::Array2d::Zero();
  for (const Eigen::Vector3f& p : points) {
    if (!IsDepth(p)) continue;
    const Eigen::Array2d at = focal * (p.head<2>().cast<double>().array() / p.z()) + middle;
    const Eigen::Array2d margin = focal * margin_m / p.z();
    low = low.min(at - margin);
    high = high.max(at + margin);
  }
  return {low.max(0).min(end).cast<int>(), high.max(0).min(end).ceil().cast<int>()};
}

// The depths of an image of `camera`, those of every few pixels around the points of interest.
template <typename DepthOf>
void TakeImage(const CameraIntrinsics& camera, const Points& of_interest,
               const FrameParameters& parameters, const DepthOf& depth_of, Frame* out) {
  const int step = StepOf(camera, parameters);
  out->camera = camera;
  Thin(step, &out->camera);
  const Window window = WindowAround(of_interest, parameters.margin_m, out->camera);
  if ((window.high <= window.low).any()) return;
  out->camera.width = window.high.x() - window.low.x();
  out->camera.height = window.high.y() - window.low.y();
  out->camera.cx -= window.low.x();
  out->camera.cy -= window.low.y();
  out->depth.resize(out->PixelAt(0, out->camera.height));
  for (int v = 0; v < out->camera.height; ++v) {
    for (int u = 0; u < out->camera.width; ++u) {
      const int row = (window.low.y() + v) * step;
      const int column = (window.low.x() + u) * step;
      const std::size_t from =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(camera.width) +
          static_cast<std::size_t>(column);
      const float z = depth_of(from);
      out->depth[out->PixelAt(u, v)] = IsDepth(z) ? z : 0;
    }
  }
}

// The nearest point of each pixel. Points more than 60 degrees off the optical axis are left out,
// so that an image has at most 3.4 focal lengths a side.
void Render(const Scan& scan, const FrameParameters& parameters, Frame* out) {
  constexpr float kWidest = 1.7F;
  Eigen::Array2f low = Eigen::Array2f::Constant(kWidest);
  Eigen::Array2f high = -low;
  const auto direction = [](const Eigen::Vector3f& p) -> Eigen::Array2f {
    return p.head<2>().array() / p.z();
  };
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f p = scan.PointAt(i);
    if (!IsDepth(p) || (direction(p).abs() > kWidest).any()) continue;
    low = low.min(direction(p));
    high = high.max(direction(p));
  }
  if ((low > high).any()) return;
  const auto focal = static_cast<float>(parameters.cloud_focal_px);
  const Eigen::Array2i size = (focal * (high - low)).ceil().cast<int>() + 1;
  out->camera = {.width = size.x(),
                 .height = size.y(),
                 .fx = focal,
                 .fy = focal,
                 .cx = -focal * low.x(),
                 .cy = -focal * low.y()};
  out->depth.assign(out->PixelAt(0, size.y()), 0);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f p = scan.PointAt(i);
    if (!IsDepth(p) || (direction(p).abs() > kWidest).any()) continue;
    const Eigen::Array2i at = (focal * (direction(p) - low)).round().cast<int>();
    if (!out->Contains(at.x(), at.y())) continue;
    float& here = out->depth[out->PixelAt(at.x(), at.y())];
    if (here == 0 || p.z() < here) here = p.z();
  }
}

// Calls `job` with the rows [first, last) of each band, on idle cores.
template <typename Job>
void ForEachBand(int height, const Job& job) {
  const int bands = (height + kBandRows - 1) / kBandRows;
  ForEachIndex(static_cast<std::size_t>(bands), [&](std::size_t band) {
    const int first = static_cast<int>(band) * kBandRows;
    job(first, std::min(height, first + kBandRows));
  });
}

// Depths without those between two surfaces.
std::vector<float> WithoutFlying(const Frame& frame, float share) {
  std::vector<float> out = frame.depth;
  const auto row = static_cast<std::size_t>(frame.camera.width);
  ForEachBand(frame.camera.height, [&](int first, int last) {
    for (int v = std::max(1, first); v < std::min(last, frame.camera.height - 1); ++v) {
      for (int u = 1; u + 1 < frame.camera.width; ++u) {
        const std::size_t i = frame.PixelAt(u, v);
        const float z = frame.depth[i];
        if (z == 0) continue;
        const float gap = share * z;
        const auto flies = [&](float a, float b) {
          return a != 0 && b != 0 && std::abs(z - a) > gap && std::abs(z - b) > gap;
        };
        if (flies(frame.depth[i - 1], frame.depth[i + 1]) ||
            flies(frame.depth[i - row], frame.depth[i + row])) {
          out[i] = 0;
        }
      }
    }
  });
  return out;
}

void AssignRoles(const Box& region, const FrameParameters& parameters, Frame* out) {
  out->role.assign(out->depth.size(), PixelRole::kNone);
  const Eigen::Isometry3f world_sensor = out->world_sensor.cast<float>();
  const Eigen::Array3f low = region.min.cast<float>();
  const Eigen::Array3f high = region.max.cast<float>();
  const Plane table = out->table.value_or(Plane());
  const Eigen::Vector3f normal = table.normal.cast<float>();
  const auto offset = static_cast<float>(table.offset);
  ForEachBand(out->camera.height, [&](int first, int last) {
    for (int v = first; v < last; ++v) {
      for (int u = 0; u < out->camera.width; ++u) {
        const std::size_t i = out->PixelAt(u, v);
        const float z = out->depth[i];
        if (z == 0) continue;
        const Eigen::Vector3f p = out->PointAt(u, v, z);
        const Eigen::Array3f world = world_sensor * p;
        PixelRole role = PixelRole::kObject;
        if ((world < low).any() || (world > high).any()) role = PixelRole::kBackground;
        if (out->table) {
          const float height = normal.dot(p) - offset;
          const float near =
              static_cast<float>(parameters.table_distance_m) * std::max(1.0F, z * z / 0.64F);
          if (height < near) {
            role = height < -std::max(near, static_cast<float>(parameters.background_below_m))
                       ? PixelRole::kBackground
                       : PixelRole::kTable;
          }
        }
        out->role[i] = role;
      }
    }
  });
}

// The median deviation of the table's pixels from its plane, at 1 m.
float NoiseOfTable(const Frame& frame) {
  constexpr std::size_t kStride = 5;
  constexpr std::size_t kFewest = 200;
  const Eigen::Vector3f normal = frame.table->normal.cast<float>();
  const auto offset = static_cast<float>(frame.table->offset);
  std::vector<float> off;
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = v % static_cast<int>(kStride); u < frame.camera.width; u += kStride) {
      const std::size_t i = frame.PixelAt(u, v);
      if (frame.role[i] != PixelRole::kTable) continue;
      const float z = frame.depth[i];
      off.push_back(std::abs(normal.dot(frame.PointAt(u, v, z)) - offset) / (z * z));
    }
  }
  if (off.size() < kFewest) return Frame().noise_at_1m;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::ranges::nth_element(off, middle);
  constexpr float kDeviationPerMedian = 1.4826F;
  return std::clamp(kDeviationPerMedian * *middle, 0.001F, 0.006F);
}

// The plane z = a x + b y + c through the measurements around a pixel, as a normal. Samples a grid
// of five by five pixels within the radius.
Eigen::Vector3f NormalAt(const Frame& frame, int u, int v, float radius_m) {
  const std::size_t centre = frame.PixelAt(u, v);
  const float z0 = frame.depth[centre];
  const float radius_px = radius_m * static_cast<float>(frame.camera.fx) / z0;
  const auto step = static_cast<int>(std::clamp(std::round(radius_px / 2), 1.0F, 5.0F));
  const float gate = 2.5F * radius_m;
  const Eigen::Vector3f middle = frame.PointAt(u, v, z0);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  float count = 0;
  for (int dv = -2; dv <= 2; ++dv) {
    for (int du = -2; du <= 2; ++du) {
      const int x = u + du * step;
      const int y = v + dv * step;
      if (!frame.Contains(x, y)) continue;
      const float z = frame.depth[frame.PixelAt(x, y)];
      if (z == 0 || std::abs(z - z0) > gate) continue;
      const Eigen::Vector3f d = frame.PointAt(x, y, z) - middle;
      sum += d;
      squares += d * d.transpose();
      count += 1;
    }
  }
  if (count < 6) return Eigen::Vector3f::Zero();
  const Eigen::Matrix3f covariance = squares / count - (sum / count) * (sum / count).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  Eigen::Vector3f normal = solver.eigenvectors().col(0);
  if (normal.dot(middle) > 0) normal = -normal;
  return normal;
}

void AddNormals(const FrameParameters& parameters, const IsCancelled& is_cancelled, Frame* out) {
  out->normals.assign(out->depth.size(), Eigen::Vector3f::Zero());
  ForEachBand(out->camera.height, [&](int first, int last) {
    if (is_cancelled()) return;
    for (int v = first; v < last; ++v) {
      for (int u = 0; u < out->camera.width; ++u) {
        const std::size_t i = out->PixelAt(u, v);
        if (out->role[i] != PixelRole::kObject) continue;
        out->normals[i] = NormalAt(*out, u, v, parameters.normal_radius_m);
      }
    }
  });
}

// A plane of the world frame in the sensor frame.
Plane InSensor(const Plane& plane, const Pose& world_sensor) {
  return {world_sensor.linear().transpose() * plane.normal,
          plane.offset - plane.normal.dot(world_sensor.translation())};
}

}  // namespace

Frame MakeFrame(const Scan& scan, const Pose& world_sensor, const std::optional<Plane>& table,
                const Box& region, const FrameParameters& parameters,
                const IsCancelled& is_cancelled, const Points& of_interest) {
  Frame out;
  out.world_sensor = world_sensor;
  if (table) out.table = InSensor(*table, world_sensor);
  if (scan.is_image()) {
    const auto unit = static_cast<float>(scan.depth_image.unit_m);
    const auto depth_of = [&](std::size_t i) {
      return static_cast<float>(scan.depth_image.depth[i]) * unit;
    };
    TakeImage(scan.depth_image.camera, of_interest, parameters, depth_of, &out);
  } else if (const auto camera = CameraOfCloud(scan.points, scan.width)) {
    TakeImage(
        *camera, of_interest, parameters,
        [&](std::size_t i) { return IsDepth(scan.points[i]) ? scan.points[i].z() : 0; }, &out);
  } else {
    Render(scan, parameters, &out);
  }
  if (out.depth.empty() || is_cancelled()) return out;
  out.depth = WithoutFlying(out, parameters.flying_share);
  AssignRoles(region, parameters, &out);
  if (out.table) out.noise_at_1m = NoiseOfTable(out);
  AddNormals(parameters, is_cancelled, &out);
  return out;
}

}  // namespace graspdb::recognition
