// graspdb_fuzz_seeds DIR: writes the seeds of the fuzzers. Deterministic, except for the times in
// records.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>

#include "tests/fuzz/requirement.h"
#include "tests/fuzz/seeds/seed_writer.h"

namespace graspdb::fuzz {

void SeedWriter::Write(const std::string& target, const std::string& name,
                       const std::string& bytes) const {
  std::error_code error;
  std::filesystem::create_directories(directory_ / target, error);
  std::ofstream file(directory_ / target / name, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  Require(file.good(), "a seed can be written");
}

std::string BytesOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace graspdb::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "graspdb_fuzz_seeds: give the folder to write to\n");
    return 2;
  }
  const graspdb::fuzz::SeedWriter out{std::filesystem::path(argv[1])};
  graspdb::fuzz::WriteFileSeeds(out);
  graspdb::fuzz::WriteTextSeeds(out);
  graspdb::fuzz::WriteRequestSeeds(out);
  graspdb::fuzz::WriteStorageSeeds(out);
  return 0;
}
