#include "rendering/sample_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "rendering/meshes/solid.h"

namespace graspdb::rendering {
namespace {

using Vec3 = Eigen::Vector3f;

// Top grasp of a part, in the millimetres of its drawing.
struct GraspSpec {
  const char* grasp_id;
  Eigen::Vector3d at_mm;
  double closing_deg;
  double width_mm;  // of the part between the fingers
  bool any_turn = false;
};

// Drawings are in millimetres, at any position on z = 0.
struct Drawing {
  const char* object_id;
  const char* display_name;
  const char* stable_pose_id;
  int symmetry_order;
  std::vector<GraspSpec> grasp_specs;
  TriangleMesh solid_mm;
};

constexpr double kClearanceMm = 20;  // of the open fingers around a part

Drawing LBracket() {
  return {"l-bracket",
          "L-bracket with a rib",
          "on-base",
          1,
          {{"wall", {5, 25, 55}, 0, 10}, {"base", {80, 25, 5}, 90, 50}},
          Union({BoxSolid({0, 0, 0}, {100, 50, 10}), BoxSolid({0, 0, 0}, {10, 50, 70}),
                 ExtrudeAlongY({{8, 8}, {50, 8}, {8, 50}}, 19, 31)})};
}

Drawing UBracket() {
  return {"u-bracket",
          "U-bracket with unequal legs",
          "legs-up",
          1,
          {{"long-leg", {5, 20, 65}, 0, 10}, {"base", {60, 20, 4}, 90, 40}},
          Union({BoxSolid({0, 0, 0}, {120, 40, 8}), BoxSolid({0, 0, 0}, {10, 40, 80}),
                 BoxSolid({108, 0, 0}, {120, 40, 35})})};
}

Drawing Flange() {
  Drawing part = {"flange",
                  "Flange with four bosses",
                  "hub-up",
                  4,
                  {{"hub", {0, 0, 40}, 0, 44, true}},
                  Union({CylinderSolid({0, 0}, 58, 0, 12), CylinderSolid({0, 0}, 22, 0, 52)})};
  for (const Eigen::Vector2f& at : RegularPolygon({0, 0}, 44, 4, 0)) {
    Append(part.solid_mm, CylinderSolid(at, 11, 0, 30));
  }
  return part;
}

Drawing SteppedBlock() {
  return {"stepped-block",
          "Block with three steps",
          "on-base",
          1,
          {{"top", {92, 15, 58}, 0, 35}, {"middle", {57, 30, 35}, 90, 60}},
          Union({BoxSolid({0, 0, 0}, {110, 60, 22}), BoxSolid({40, 0, 0}, {110, 60, 45}),
                 BoxSolid({75, 0, 0}, {110, 30, 72})})};
}

Drawing Handle() {
  // The bar: half an ellipse outside, a smaller one inside.
  Polygon arch;
  constexpr int kSteps = 24;
  for (int k = 0; k <= 2 * kSteps + 1; ++k) {
    const bool outside = k <= kSteps;
    const int step = outside ? k : 2 * kSteps + 1 - k;
    const double turn = std::numbers::pi * step / kSteps;
    const double x = 76 + (outside ? 64 : 48) * std::cos(turn);
    const double z = 6 + (outside ? 62 : 46) * std::sin(turn);
    arch.push_back(Eigen::Vector2d(x, z).cast<float>());
  }
  return {"handle",
          "Arched handle",
          "on-feet",
          1,
          {{"bar", {76, 0, 58}, 90, 20}},
          Union({BoxSolid({0, -27, 0}, {42, 27, 14}), BoxSolid({120, -15, 0}, {148, 15, 14}),
                 ExtrudeAlongY(arch, -10, 10)})};
}

Drawing BracketLeft() {
  return {"bracket-left",
          "Bracket, left hand",
          "on-base",
          1,
          {{"wall", {25, 55, 50}, 90, 10}, {"block", {75, 14, 28}, 0, 28}},
          Union({BoxSolid({0, 0, 0}, {90, 60, 10}), BoxSolid({0, 50, 0}, {55, 60, 65}),
                 BoxSolid({62, 0, 0}, {90, 28, 38})})};
}

Drawing BracketRight() {
  Drawing part = BracketLeft();
  part.object_id = "bracket-right";
  part.display_name = "Bracket, right hand";
  part.solid_mm = MirroredX(part.solid_mm);
  for (GraspSpec& spec : part.grasp_specs) {
    spec.at_mm.x() = -spec.at_mm.x();
    spec.closing_deg = -spec.closing_deg;
  }
  return part;
}

Drawing Wedge() {
  return {"wedge",
          "Wedge",
          "on-base",
          1,
          {{"thick-end", {98, 30, 40}, 90, 60}},
          ExtrudeAlongY({{0, 0}, {112, 0}, {112, 58}, {88, 58}, {0, 8}}, 0, 60)};
}

Drawing TPiece() {
  // Sixteen sides, the first corner half a side up: it lies on a flat.
  const double half_side = std::numbers::pi / 16;
  const auto tube = [&](float radius) {
    const auto height = static_cast<float>(radius * std::cos(half_side));
    return RegularPolygon({0, height}, radius, 16, static_cast<float>(half_side));
  };
  return {"t-piece",
          "T-piece of pipe",
          "lying",
          1,
          {{"run", {-40, 0, 20}, 90, 40}, {"branch", {0, 55, 20}, 0, 40}},
          Union({ExtrudeAlongX(tube(20), -60, 60), ExtrudeAlongY(tube(20), 0, 80)})};
}

Drawing SteppedShaft() {
  return {"stepped-shaft",
          "Stepped shaft, standing",
          "standing",
          0,
          {{"neck", {0, 0, 60}, 0, 40, true}},
          Union({CylinderSolid({0, 0}, 32, 0, 30), CylinderSolid({0, 0}, 20, 0, 78),
                 CylinderSolid({0, 0}, 11, 0, 118)})};
}

Drawing HexNut() {
  // A hexagon of 70 mm across flats, with as many corners as its hole.
  constexpr int kSides = 48;
  Polygon hexagon;
  for (const Eigen::Vector2f& d : RegularPolygon({0, 0}, 1, kSides, 0)) {
    float along = 0;  // distance to the flat that the direction meets first
    for (const Eigen::Vector2f& n : RegularPolygon({0, 0}, 1, 6, std::numbers::pi_v<float> / 6)) {
      along = std::max(along, d.dot(n));
    }
    hexagon.push_back(d * (35 / along));
  }
  const Polygon hole = RegularPolygon({0, 0}, 20, kSides, 0);
  return {"hex-nut",
          "Hexagonal nut with a collar",
          "collar-down",
          6,
          {{"flats", {0, 0, 28}, 30, 70}},
          Union({RingSolid(hexagon, hole, 42),
                 RingSolid(RegularPolygon({0, 0}, 50, kSides, 0), hole, 9)})};
}

Drawing PostPlate() {
  return {"post-plate",
          "L-plate with two posts",
          "posts-up",
          1,
          {{"tall-post", {94, 18, 58}, 0, 22}, {"thick-post", {18, 66, 32}, 0, 32}},
          Union({ExtrudeUp({{0, 0}, {112, 0}, {112, 36}, {36, 36}, {36, 86}, {0, 86}}, 0, 12),
                 CylinderSolid({94, 18}, 11, 0, 72), CylinderSolid({18, 66}, 16, 0, 44)})};
}

Drawing ZBar() {
  return {"z-bar",
          "Z-bar with two posts",
          "posts-up",
          2,
          {{"web", {0, 0, 20}, 0, 24}},
          Union({BoxSolid({-12, -42, 0}, {12, 42, 28}), BoxSolid({-12, 20, 0}, {62, 42, 28}),
                 BoxSolid({-62, -42, 0}, {12, -20, 28}), CylinderSolid({50, 31}, 11, 0, 56),
                 CylinderSolid({-50, -31}, 11, 0, 56)})};
}

// Into metres, the origin on the table below the centre of mass.
Workpiece Finish(Drawing drawing) {
  TriangleMesh& mesh = drawing.solid_mm;
  const recognition::Box box = BoundsOf(mesh);
  const Eigen::Vector3d center = CenterOfMass(mesh).value_or((box.min + box.max) / 2);
  const Eigen::Vector3d origin(center.x(), center.y(), box.min.z());
  for (Vec3& v : mesh.vertices) v = ((v.cast<double>() - origin) / 1000).cast<float>();
  Workpiece part = {.object_id = drawing.object_id,
                    .display_name = drawing.display_name,
                    .stable_pose_id = drawing.stable_pose_id,
                    .symmetry_order = drawing.symmetry_order,
                    .grasps = {},
                    .mesh = std::move(mesh)};
  auto priority = static_cast<int>(drawing.grasp_specs.size());
  for (const GraspSpec& spec : drawing.grasp_specs) {
    v1::Grasp grasp =
        TopGrasp(spec.grasp_id, (spec.at_mm - origin) / 1000,
                 spec.closing_deg * std::numbers::pi / 180, (spec.width_mm + kClearanceMm) / 1000);
    grasp.set_priority(priority--);
    if (spec.any_turn) {
      grasp.mutable_free_turn()->set_min_deg(-180);
      grasp.mutable_free_turn()->set_max_deg(180);
    }
    part.grasps.push_back(std::move(grasp));
  }
  return part;
}

}  // namespace

std::vector<Workpiece> SampleParts() {
  std::vector<Workpiece> parts;
  for (const auto draw : {LBracket, UBracket, Flange, SteppedBlock, Handle, BracketLeft,
                          BracketRight, Wedge, TPiece, SteppedShaft, HexNut, PostPlate, ZBar}) {
    parts.push_back(Finish(draw()));
  }
  return parts;
}

std::vector<std::string> SamplePartIds() {
  std::vector<std::string> ids;
  for (const Workpiece& part : SampleParts()) ids.push_back(part.object_id);
  return ids;
}

absl::StatusOr<std::vector<Workpiece>> SampleParts(const std::vector<std::string>& ids) {
  const std::vector<std::string> known = SamplePartIds();
  for (const std::string& id : ids) {
    if (std::ranges::find(known, id) != known.end()) continue;
    return absl::InvalidArgumentError(absl::StrCat("there is no sample part \"", id,
                                                   "\"; there are ", absl::StrJoin(known, ", ")));
  }
  std::vector<Workpiece> parts = SampleParts();
  if (ids.empty()) return parts;
  std::erase_if(parts, [&](const Workpiece& part) {
    return std::ranges::find(ids, part.object_id) == ids.end();
  });
  return parts;
}

}  // namespace graspdb::rendering
