// Features of a GenICam camera that may be missing, and GLib's types as values.
#pragma once

#include <arv.h>

#include <memory>
#include <optional>
#include <string>

#include "client/cell/sensors/genicam/range_image.h"

namespace graspdb::client {

struct UnrefObject {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <typename T>
using ObjectPtr = std::unique_ptr<T, UnrefObject>;

// Where a function of GLib writes its error.
class GlibError {
 public:
  GlibError() = default;
  ~GlibError() { g_clear_error(&error_); }
  GlibError(const GlibError&) = delete;
  GlibError& operator=(const GlibError&) = delete;

  GError** out() { return &error_; }
  bool ok() const { return error_ == nullptr; }
  std::string message() const { return error_ == nullptr ? "" : error_->message; }

 private:
  GError* error_ = nullptr;
};

// Reads and writes features. Not thread-safe; `camera` is not owned.
class CameraFeatures {
 public:
  explicit CameraFeatures(ArvCamera* camera) : camera_(camera) {}

  // nullopt for a feature that is missing or cannot be read.
  std::optional<double> Number(const char* name) const;
  std::optional<std::string> Text(const char* name) const;
  bool IsTrue(const char* name) const;
  // Whether it could be set.
  bool Set(const char* name, const char* value) const;

 private:
  bool IsAvailable(const char* name) const;

  ArvCamera* camera_;
};

// The features that range_image.h names. Those of each coordinate are read by setting
// Scan3dCoordinateSelector.
RangeGeometry ReadRangeGeometry(const CameraFeatures& features);

}  // namespace graspdb::client
