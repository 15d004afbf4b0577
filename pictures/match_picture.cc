#include "pictures/match_picture.h"

#include <cairo.h>

#include <array>
#include <memory>

#include "absl/strings/str_cat.h"

namespace graspdb::pictures {
namespace {

constexpr int kPanel = 420;         // pixels
constexpr int kCaptionHeight = 44;  // for the captions
constexpr double kView = 0.26;      // metres across a panel, at the object
constexpr double kAxis = 0.05;      // metres

struct Color {
  double r, g, b;
};
constexpr Color kWhite = {0.92, 0.92, 0.92};
constexpr Color kGreen = {0.15, 0.85, 0.25};
constexpr Color kGrey = {0.65, 0.65, 0.65};
constexpr Color kDark = {0.22, 0.24, 0.28};
// The virtual camera is turned from the sensor by this angle, so that depth is visible, rad.
constexpr double kAside = 0.6;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Painter = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

// Perspective projection of world points to a panel, from beside the sensor, with the
// object in the middle.
class Camera {
 public:
  explicit Camera(const MatchPicture& picture)
      : sensor_world_(Aside(picture).inverse()),
        center_(sensor_world_ * picture.center),
        scale_(kPanel / kView) {
    if (center_.z() < 0.05) center_.z() = 0.05;  // behind or at the sensor: no picture, no crash
  }

  // False for a point behind the sensor.
  bool Project(const Eigen::Vector3d& world, double* x, double* y) const {
    const Eigen::Vector3d p = sensor_world_ * world;
    if (p.z() < 0.01) return false;
    const double magnify = center_.z() / p.z() * scale_;
    *x = kPanel / 2.0 + p.x() * magnify - center_.x() * scale_;
    *y = kPanel / 2.0 + p.y() * magnify - center_.y() * scale_;
    return true;
  }

 private:
  // The sensor's pose turned about the vertical through the object.
  static recognition::Pose Aside(const MatchPicture& picture) {
    return Eigen::Translation3d(picture.center) *
           Eigen::AngleAxisd(kAside, Eigen::Vector3d::UnitZ()) *
           Eigen::Translation3d(-picture.center) * picture.world_sensor;
  }

  recognition::Pose sensor_world_;
  Eigen::Vector3d center_;
  double scale_;
};

void Use(cairo_t* cr, const Color& c, double alpha = 1) {
  cairo_set_source_rgba(cr, c.r, c.g, c.b, alpha);
}

void DrawPoints(cairo_t* cr, const Camera& camera, const recognition::Points& points,
                const Color& color, double size) {
  Use(cr, color, 0.8);
  for (const auto& p : points) {
    double x = 0;
    double y = 0;
    if (!camera.Project(p.cast<double>(), &x, &y)) continue;
    cairo_rectangle(cr, x - size / 2, y - size / 2, size, size);
    cairo_fill(cr);
  }
}

void DrawAxes(cairo_t* cr, const Camera& camera, const recognition::Pose& frame) {
  constexpr std::array<Color, 3> kColors = {{{1, 0.25, 0.2}, {0.3, 1, 0.3}, {0.35, 0.55, 1}}};
  double x0 = 0;
  double y0 = 0;
  if (!camera.Project(frame.translation(), &x0, &y0)) return;
  cairo_set_line_width(cr, 3);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    double x = 0;
    double y = 0;
    const Eigen::Vector3d tip = frame.translation() + kAxis * frame.linear().col(axis);
    if (!camera.Project(tip, &x, &y)) continue;
    Use(cr, kColors[static_cast<std::size_t>(axis)]);
    cairo_move_to(cr, x0, y0);
    cairo_line_to(cr, x, y);
    cairo_stroke(cr);
  }
}

void DrawText(cairo_t* cr, double x, double y, double size, const std::string& text) {
  cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size);
  cairo_move_to(cr, x, y);
  cairo_show_text(cr, text.c_str());
}

void DrawPanel(cairo_t* cr, int column, const std::string& title, const MatchPicture& picture,
               const recognition::Points& view, bool with_grasp) {
  const Camera camera(picture);
  cairo_save(cr);
  cairo_translate(cr, column * kPanel, kCaptionHeight);
  cairo_rectangle(cr, 0, 0, kPanel - 2, kPanel);
  cairo_clip(cr);
  DrawPoints(cr, camera, picture.table, kDark, 1.5);
  DrawPoints(cr, camera, picture.scan, kWhite, 2.5);
  DrawPoints(cr, camera, view, kGreen, 2);
  if (with_grasp && picture.world_tcp) DrawAxes(cr, camera, *picture.world_tcp);
  Use(cr, kGrey);
  DrawText(cr, 10, kPanel - 12, 15, title);
  cairo_restore(cr);
}

}  // namespace

absl::Status WriteMatchPicture(const std::filesystem::path& path, const MatchPicture& picture) {
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, 3 * kPanel, kPanel + kCaptionHeight),
      cairo_surface_destroy);
  const Painter cr(cairo_create(surface.get()), cairo_destroy);
  cairo_set_source_rgb(cr.get(), 0.05, 0.06, 0.08);
  cairo_paint(cr.get());
  Use(cr.get(), kWhite);
  DrawText(cr.get(), 10, 28, 16, picture.caption);
  DrawPanel(cr.get(), 0, "as found", picture, picture.found, false);
  DrawPanel(cr.get(), 1, "shifted to the centroid", picture, picture.shifted, false);
  DrawPanel(cr.get(), 2, "refined, with the grasp", picture, picture.refined, true);
  const cairo_status_t status = cairo_surface_write_to_png(surface.get(), path.c_str());
  if (status == CAIRO_STATUS_SUCCESS) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("cannot write ", path.string(), ": ",
                                                    cairo_status_to_string(status),
                                                    "; choose another folder"));
}

}  // namespace graspdb::pictures
