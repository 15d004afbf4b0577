#include "pictures/shaded_picture.h"

#include <cairo.h>

#include <algorithm>
#include <memory>

#include "absl/strings/str_cat.h"

namespace graspdb::pictures {
namespace {

constexpr int kHeaderHeight = 30;  // pixels

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Painter = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void DrawPixels(cairo_surface_t* surface, const ShadedPicture& picture) {
  cairo_surface_flush(surface);
  unsigned char* const data = cairo_image_surface_get_data(surface);
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(surface);
  std::size_t pixel = 0;
  for (int row = 0; row < picture.height; ++row) {
    auto* line = reinterpret_cast<std::uint32_t*>(data + (row + kHeaderHeight) * stride);
    for (int column = 0; column < picture.width; ++column) {
      const std::uint32_t grey = picture.brightness[pixel++];
      line[column] = grey << 16U | grey << 8U | grey;
    }
  }
  for (const ColoredPixel& mark : picture.marks) {
    const auto row = static_cast<std::ptrdiff_t>(mark.pixel) / picture.width + kHeaderHeight;
    auto* line = reinterpret_cast<std::uint32_t*>(data + row * stride);
    line[static_cast<std::ptrdiff_t>(mark.pixel) % picture.width] = mark.rgb;
  }
  cairo_surface_mark_dirty(surface);
}

}  // namespace

absl::Status WriteShadedPicture(const std::filesystem::path& path, const ShadedPicture& picture) {
  if (picture.width < 1 || picture.height < 1 ||
      picture.brightness.size() !=
          static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height)) {
    return absl::InvalidArgumentError(
        "the number of pixels does not match the size of the picture");
  }
  if (std::ranges::any_of(picture.marks, [&](const ColoredPixel& mark) {
        return mark.pixel >= picture.brightness.size();
      })) {
    return absl::InvalidArgumentError("a mark lies outside of the picture");
  }
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width, picture.height + kHeaderHeight),
      cairo_surface_destroy);
  const Painter cr(cairo_create(surface.get()), cairo_destroy);
  cairo_set_source_rgb(cr.get(), 0.05, 0.06, 0.08);
  cairo_paint(cr.get());
  cairo_set_source_rgb(cr.get(), 0.92, 0.92, 0.92);
  cairo_select_font_face(cr.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr.get(), 14);
  cairo_move_to(cr.get(), 8, 20);
  cairo_show_text(cr.get(), picture.caption.c_str());
  if (cairo_surface_status(surface.get()) == CAIRO_STATUS_SUCCESS) {
    DrawPixels(surface.get(), picture);
  }
  const cairo_status_t status = cairo_surface_write_to_png(surface.get(), path.c_str());
  if (status == CAIRO_STATUS_SUCCESS) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("cannot write ", path.string(), ": ",
                                                    cairo_status_to_string(status),
                                                    "; choose another folder"));
}

}  // namespace graspdb::pictures
