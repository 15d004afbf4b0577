// graspdb_bench [--table FILE] [Google Benchmark's flags]
#include <benchmark/benchmark.h>

#include <cstring>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "tests/bench/ratio_table.h"
#include "tests/bench/suite.h"

int main(int argc, char** argv) {
  // The repetitions of all programs are interleaved, so that other load affects them equally.
  std::vector<std::string> words = {argv[0], "--benchmark_repetitions=5",
                                    "--benchmark_enable_random_interleaving=true",
                                    "--benchmark_min_time=0.2"};
  std::string table;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--table") == 0 && i + 1 < argc) {
      table = argv[++i];
    } else {
      words.emplace_back(argv[i]);
    }
  }
  std::vector<char*> arguments;
  arguments.reserve(words.size());
  for (std::string& word : words) arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  graspdb::bench::AddSegmentation();
  graspdb::bench::AddFusion();
  graspdb::bench::AddRegistration();
  graspdb::bench::AddIndex();
  graspdb::bench::AddWhole();
  graspdb::bench::RatioTable reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  if (table.empty()) {
    std::cout << '\n';
    reporter.Write(std::cout);
    return 0;
  }
  std::ofstream file(table);
  reporter.Write(file);
  file.close();
  if (!file) {
    std::cerr << "graspdb_bench: cannot write " << table << "\n";
    return 1;
  }
  return 0;
}
