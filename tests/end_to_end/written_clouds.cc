#include "tests/end_to_end/written_clouds.h"

#include <cmath>
#include <sstream>

namespace graspdb::end_to_end {
namespace {

std::string Header(std::size_t count, const std::string& more_fields, int fields) {
  std::ostringstream out;
  const auto repeat = [&](const char* line, const char* word) {
    out << line;
    for (int i = 0; i < fields; ++i) out << " " << word;
    out << "\n";
  };
  out << "VERSION 0.7\nFIELDS x y z" << more_fields << "\n";
  repeat("SIZE", "4");
  repeat("TYPE", "F");
  repeat("COUNT", "1");
  out << "WIDTH " << count << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count
      << "\nDATA ascii\n";
  return out.str();
}

}  // namespace

recognition::Points CurvedPatch(int count) {
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  recognition::Points points;
  for (int i = 0; i < count; ++i) {
    const int row = i / side;
    const float x = 0.004F * static_cast<float>(i % side);
    const float y = 0.004F * static_cast<float>(row);
    points.emplace_back(x, y, 0.6F + 3 * x * x + x * y - 2 * y * y);
  }
  return points;
}

std::string AsciiPcd(const recognition::Points& points) {
  std::ostringstream out;
  out << Header(points.size(), "", 3);
  for (const auto& p : points) out << p.x() << " " << p.y() << " " << p.z() << "\n";
  return out.str();
}

std::string AsciiPcdWithNormals(const recognition::Points& points, const Eigen::Vector3f& normal) {
  std::ostringstream out;
  out << Header(points.size(), " normal_x normal_y normal_z", 6);
  for (const auto& p : points) out << p.transpose() << " " << normal.transpose() << "\n";
  return out.str();
}

std::string CaptureSetJson(const std::string& capture_fields) {
  return R"({"objects": [{"objectId": "o", "stablePoses": [{"stablePoseId": "p"}]}],
             "captures": [{"path": "cloud.pcd", )" +
         capture_fields + "}]}";
}

}  // namespace graspdb::end_to_end
