// Files for readers that need a path.
#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

namespace graspdb::fuzz {

// A folder of this process, in memory if the machine has such a file system, since every execution
// writes a file. libFuzzer ends the process without destructors; fuzz.sh removes remaining folders.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::error_code error;
    static std::atomic<int> made = 0;
    const std::filesystem::path memory = "/dev/shm";
    const bool has_memory = std::filesystem::is_directory(memory, error);
    path_ = (has_memory ? memory : std::filesystem::temp_directory_path()) /
            ("graspdb_fuzz." + std::to_string(getpid()) + "." + std::to_string(made++));
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Writes a file in place of the previous one and returns its path.
  std::filesystem::path Write(const std::string& name, std::string_view bytes) const {
    std::filesystem::path path = path_ / name;
    std::ofstream(path, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace graspdb::fuzz
