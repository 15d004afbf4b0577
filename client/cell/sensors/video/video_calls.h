// The calls of the kernel for a video device, behind an interface for tests.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace graspdb::client {

// An open video device. Thread-safe as the kernel's calls are.
class VideoCalls {
 public:
  virtual ~VideoCalls() = default;

  // ioctl(2), repeated after a signal: 0, or the error number.
  virtual int Control(unsigned long request, void* argument) = 0;
  // mmap(2) of a buffer to read, which ends with this object; null on errors.
  virtual const void* Map(std::size_t length, std::size_t offset) = 0;
  // The USB product's name, empty if there is none. The card of VIDIOC_QUERYCAP is cut to 31
  // characters, with which "Intel(R) RealSense(TM) Depth Ca" has no model any more.
  virtual std::string Product() = 0;
  // Waits for a filled buffer, at most for `timeout_ms`; false without one.
  virtual bool Wait(int timeout_ms) = 0;
};

// UNAVAILABLE when the device cannot be opened; FAILED_PRECONDITION when `path` is no device.
absl::StatusOr<std::unique_ptr<VideoCalls>> OpenVideo(const std::string& path);

}  // namespace graspdb::client
