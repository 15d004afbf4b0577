// A small file system in memory, which only this process and its children see.
#pragma once

#include <sys/mount.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/faults/own_mounts.h"

namespace graspdb::faults {

class SmallDisk {
 public:
  // `megabytes` at `path`, which is made. Needs root; usable() says whether it worked.
  SmallDisk(const std::string& path, int megabytes) : path_(path) {
    std::filesystem::create_directory(path);
    const std::string size = "size=" + std::to_string(megabytes) + "m";
    usable_ = EnterOwnMounts() && mount("tmpfs", path.c_str(), "tmpfs", 0, size.c_str()) == 0;
  }
  ~SmallDisk() {
    if (usable_) umount2(path_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool usable() const { return usable_; }
  // For a page, of which the file system gives whole ones.
  bool HasRoom() const { return std::filesystem::space(path_).available >= kPageBytes; }
  // Writes a file until no byte is left.
  void Fill() const {
    std::ofstream file(Ballast(), std::ios::binary | std::ios::app);
    const std::string block(kPageBytes, 'x');
    while (file << block << std::flush) {
    }
  }
  void MakeRoom() const { std::filesystem::remove(Ballast()); }
  bool SetReadOnly(bool read_only) const {
    return mount("", path_.c_str(), "",
                 MS_REMOUNT | (read_only ? static_cast<unsigned long>(MS_RDONLY) : 0),
                 nullptr) == 0;
  }

 private:
  static constexpr std::size_t kPageBytes = 4096;

  std::string Ballast() const { return path_ + "/ballast"; }

  const std::string path_;
  bool usable_ = false;
};

}  // namespace graspdb::faults
