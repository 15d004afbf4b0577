// Seeds of the fuzzers: tests/fuzz/corpus, made by graspdb_fuzz_seeds.
#pragma once

#include <filesystem>
#include <string>

namespace graspdb::fuzz {

// Writes files DIR/TARGET/NAME. Ends the process if one cannot be made or written.
class SeedWriter {
 public:
  explicit SeedWriter(std::filesystem::path directory) : directory_(std::move(directory)) {}

  void Write(const std::string& target, const std::string& name, const std::string& bytes) const;

 private:
  std::filesystem::path directory_;
};

// The bytes of a file; none if it cannot be read.
std::string BytesOf(const std::filesystem::path& path);

// Point files, depth images, meshes, capture sets, archives.
void WriteFileSeeds(const SeedWriter& out);
// Messages of robots, arguments of programs, and small files.
void WriteTextSeeds(const SeedWriter& out);
// Requests with scans of sample parts.
void WriteRequestSeeds(const SeedWriter& out);
// Packed clouds, logs, records.
void WriteStorageSeeds(const SeedWriter& out);

}  // namespace graspdb::fuzz
