// A file system that becomes read-only while its files are open, as ext4 does after an error of its
// disk. Remounting cannot do that: it fails with EBUSY while a file is open for writing.
#pragma once

#include <sys/mount.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/end_to_end/fixtures/process.h"
#include "tests/faults/own_mounts.h"

namespace graspdb::faults {

// An ext4 in a file, on a loop device.
class Ext4Disk {
 public:
  // At `name` in `folder`, which is made. Needs root, a free loop device, mkfs.ext4 and /sys;
  // usable() says whether it worked.
  Ext4Disk(const std::filesystem::path& folder, const std::string& name)
      : folder_(folder), path_((folder / name).string()), image_(path_ + ".img") {
    std::filesystem::create_directory(path_);
    std::ofstream(image_).close();
    std::filesystem::resize_file(image_, kBytes);
    usable_ = EnterOwnMounts() && Runs({"/sbin/mkfs.ext4", "-q", "-F", image_}) && Mount() &&
              access(ErrorFile().c_str(), W_OK) == 0;
  }
  ~Ext4Disk() {
    if (mounted_) umount2(path_.c_str(), MNT_DETACH);
  }
  Ext4Disk(const Ext4Disk&) = delete;
  Ext4Disk& operator=(const Ext4Disk&) = delete;

  bool usable() const { return usable_; }
  // Causes an error of the file system, after which it is read-only (errors=remount-ro), also for
  // open files.
  bool Fail() const {
    std::ofstream file(ErrorFile());
    file << "caused by a test" << std::flush;
    return file.good();
  }
  // Mounts it again, writable; no process may use it.
  bool MountAgain() {
    mounted_ = umount2(path_.c_str(), 0) != 0;
    return !mounted_ && Mount();
  }

 private:
  // Most of it is never written. RocksDB reserves 18 MiB for a log.
  static constexpr std::uintmax_t kBytes = std::uintmax_t{64} << 20;

  bool Runs(const std::vector<std::string>& command) const {
    return end_to_end::RunProgram(folder_, command).exit_status == 0;
  }
  bool Mount() {
    mounted_ = Runs({"/bin/mount", "-t", "ext4", "-o", "loop,errors=remount-ro", image_, path_});
    return mounted_;
  }
  // The kernel's file that causes an error when it is written.
  std::string ErrorFile() const {
    const std::string mounted_at = std::filesystem::canonical(path_).string();
    std::ifstream mounts("/proc/self/mounts");
    std::string device;
    std::string path;
    for (std::string rest; mounts >> device >> path && std::getline(mounts, rest);) {
      if (path != mounted_at) continue;
      return "/sys/fs/ext4/" + std::filesystem::path(device).filename().string() +
             "/trigger_fs_error";
    }
    return "";
  }

  const std::filesystem::path folder_;
  const std::string path_;
  const std::string image_;
  bool mounted_ = false;
  bool usable_ = false;
};

}  // namespace graspdb::faults
