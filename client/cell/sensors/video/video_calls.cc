#include "client/cell/sensors/video/video_calls.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "program/connections/file_descriptor.h"

namespace graspdb::client {
namespace {

// Characters of a product's name.
constexpr std::size_t kMaxName = 128;

class KernelVideo : public VideoCalls {
 public:
  explicit KernelVideo(FileDescriptor file) : file_(std::move(file)) {}
  ~KernelVideo() override {
    for (const auto& [address, length] : maps_) munmap(address, length);
  }
  KernelVideo(const KernelVideo&) = delete;
  KernelVideo& operator=(const KernelVideo&) = delete;

  int Control(unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ioctl(file_.number(), request, argument);
    } while (result == -1 && errno == EINTR);
    return result == -1 ? errno : 0;
  }

  const void* Map(std::size_t length, std::size_t offset) override {
    void* address =
        mmap(nullptr, length, PROT_READ, MAP_SHARED, file_.number(), static_cast<off_t>(offset));
    if (address == MAP_FAILED) return nullptr;
    maps_.emplace_back(address, length);
    return address;
  }

  std::string Product() override {
    struct stat what = {};
    if (fstat(file_.number(), &what) != 0) return "";
    std::error_code error;
    const std::filesystem::path interface = std::filesystem::canonical(
        absl::StrCat("/sys/dev/char/", major(what.st_rdev), ":", minor(what.st_rdev), "/device"),
        error);
    if (error) return "";
    std::string line;
    std::ifstream file(interface.parent_path() / "product");
    std::getline(file, line);
    return line.substr(0, kMaxName);
  }

  bool Wait(int timeout_ms) override {
    pollfd wait = {.fd = file_.number(), .events = POLLIN, .revents = 0};
    // Also on errors, which the next call reports.
    return poll(&wait, 1, timeout_ms) > 0;
  }

 private:
  const FileDescriptor file_;
  std::vector<std::pair<void*, std::size_t>> maps_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<VideoCalls>> OpenVideo(const std::string& path) {
  FileDescriptor file(open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (!file.is_open()) {
    return absl::UnavailableError(
        absl::StrCat(path, " cannot be opened (", std::strerror(errno),
                     "); is the camera connected, and is the user in the group \"video\"?"));
  }
  struct stat what = {};
  if (fstat(file.number(), &what) != 0 || !S_ISCHR(what.st_mode)) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, " is no device; give one such as /dev/video2"));
  }
  return std::make_unique<KernelVideo>(std::move(file));
}

}  // namespace graspdb::client
