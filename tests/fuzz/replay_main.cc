// fuzz_NAME_replay COUNT FOLDER: replaces libFuzzer for compilers other than clang. Runs each file
// of FOLDER through the fuzzer, then COUNT inputs mutated from them. It does not use coverage: a
// program always runs the same inputs, as the checks of every change require. The current input is
// in the file fuzz_NAME_replay.input of the working directory.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/requirement.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* argc, char*** argv);
extern "C" __attribute__((weak)) std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                                                     std::size_t size,
                                                                     std::size_t max_size,
                                                                     unsigned int seed);

namespace graspdb::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;

// The largest of fuzz.sh: bytes of an input, s for a case, bytes of memory.
constexpr std::size_t kLongest = 65536;
constexpr unsigned int kSlowest = 30;
constexpr std::int64_t kMaxMemory = std::int64_t{2048} << 20U;
// Maximum number of successive mutations of a kept input; with more the input becomes noise.
constexpr int kDeepest = 8;

std::mt19937& Random() {
  static std::mt19937 random(1);  // NOLINT(bugprone-random-generator-seed): repeatable
  return random;
}

std::size_t Below(std::size_t count) { return count == 0 ? 0 : Random()() % count; }

std::vector<Bytes> Kept(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Bytes> kept;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    kept.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    Require(!file.bad(), "a kept input can be read");
  }
  return kept;
}

void Mutate(Bytes& input) {
  const std::size_t size = std::min(input.size(), kLongest);
  input.resize(kLongest);
  input.resize(LLVMFuzzerCustomMutator != nullptr
                   ? LLVMFuzzerCustomMutator(input.data(), size, kLongest,
                                             static_cast<unsigned int>(Random()()))
                   : LLVMFuzzerMutate(input.data(), size, kLongest));
}

void Execute(const std::string& name, const Bytes& input) {
  std::ofstream file(name, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(input.data()),
             static_cast<std::streamsize>(input.size()));
  file.close();
  alarm(kSlowest);
  LLVMFuzzerTestOneInput(input.data(), input.size());
  alarm(0);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  Require(std::int64_t{usage.ru_maxrss} * 1024 < kMaxMemory, "memory within the limit of a case");
}

int Replay(const char* program, int count, const char* folder) {
  std::signal(SIGALRM, [](int) {
    constexpr char kLate[] = "violated: a case ends in time\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kLate, sizeof(kLate) - 1);
    std::abort();
  });
  const std::string name = std::filesystem::path(program).filename().string() + ".input";
  const std::vector<Bytes> kept = Kept(folder);
  Require(!kept.empty(), "there are kept inputs");
  for (const Bytes& input : kept) Execute(name, input);
  Bytes input;
  for (int i = 0; i < count; ++i) {
    if (i % kDeepest == 0 || input.empty()) input = kept[Below(kept.size())];
    Mutate(input);
    Execute(name, input);
  }
  std::printf("%zu kept inputs, %d mutated ones\n", kept.size(), count);
  std::filesystem::remove(name);
  return 0;
}

}  // namespace
}  // namespace graspdb::fuzz

// A minimal version of libFuzzer's function for mutators.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size,
                                        std::size_t max_size) {
  using graspdb::fuzz::Below;
  const std::size_t at = Below(size + 1);
  switch (Below(5)) {
    case 0:  // a bit
      if (at < size) data[at] ^= static_cast<std::uint8_t>(1U << Below(8));
      return size;
    case 1:  // a byte
      if (at < size) data[at] = static_cast<std::uint8_t>(Below(256));
      return size;
    case 2: {  // some bytes less
      const std::size_t less = std::min(size - at, Below(16) + 1);
      std::memmove(data + at, data + at + less, size - at - less);
      return size - less;
    }
    case 3: {  // some bytes twice
      const std::size_t more = std::min({size - at, max_size - size, Below(16) + 1});
      std::memmove(data + at + more, data + at, size - at);
      return size + more;
    }
    default:  // a byte more
      if (size == max_size) return size;
      std::memmove(data + at + 1, data + at, size - at);
      data[at] = static_cast<std::uint8_t>(Below(256));
      return size + 1;
  }
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "%s: give COUNT FOLDER\n", argv[0]);
    return 2;
  }
  if (LLVMFuzzerInitialize != nullptr) LLVMFuzzerInitialize(&argc, &argv);
  return graspdb::fuzz::Replay(argv[0], std::atoi(argv[1]), argv[2]);
}
