// A 3D camera of GigE Vision on this machine: Aravis' fake camera with range_camera.xml.
#pragma once

#include <memory>
#include <string>

#include "client/cell/sensors/genicam/range_image.h"
#include "graspdb/v1/geometry.pb.h"

namespace graspdb::client {

// Answers on 127.0.0.1, where only one can be at a time. Thread-safe once it is open.
class FakeGenicamCamera {
 public:
  FakeGenicamCamera();
  ~FakeGenicamCamera();
  FakeGenicamCamera(const FakeGenicamCamera&) = delete;
  FakeGenicamCamera& operator=(const FakeGenicamCamera&) = delete;

  // Whether it answers; it does not where another one does.
  bool IsRunning() const;

  // Values of its features; to be called before it is opened.
  void Describe(const RangeGeometry& geometry);
  // The size and format of its images, and the image that it sends from now on.
  void Show(RangeFormat format, int width, int height, std::string bytes);
  // A depth image with its camera and unit, as Coord3D_C16 in millimetres.
  void Show(const v1::DepthImage& image);
  // Sends images of 8 bits, which range_image.h does not read.
  void ShowMono8();

  // Its id.
  static constexpr char kId[] = "Aravis-Fake-GD01";

 private:
  struct Parts;
  const std::unique_ptr<Parts> parts_;
};

}  // namespace graspdb::client
