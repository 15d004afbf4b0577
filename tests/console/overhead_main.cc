// console_overhead SERVER CONSOLE_PORT [COUNT]: the time of small calls directly and through a
// console, in turn: one line of medians, in ms. Both use one connection.
#include <grpcpp/create_channel.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "tests/console/http_client.h"

namespace graspdb::testing {
namespace {

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

template <typename Call>
double Time(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  if (!call()) {
    std::fprintf(stderr, "console_overhead: a call failed\n");
    std::exit(1);
  }
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

int Measure(const char* server, int port, int count) {
  const auto stub =
      v1::CatalogService::NewStub(grpc::CreateChannel(server, grpc::InsecureChannelCredentials()));
  HttpClient browser(static_cast<std::uint16_t>(port));
  const auto direct_call = [&] {
    grpc::ClientContext context;
    v1::ListObjectsResponse response;
    return stub->ListObjects(&context, v1::ListObjectsRequest(), &response).ok();
  };
  const auto call = [&](const char* type) {
    return browser.Call("/graspdb.v1.CatalogService/ListObjects", type, "").status == 200;
  };
  std::vector<double> direct;
  std::vector<double> binary;
  std::vector<double> json;
  for (int i = 0; i < count; ++i) {
    direct.push_back(Time(direct_call));
    binary.push_back(Time([&] { return call("application/proto"); }));
    json.push_back(Time([&] { return call("application/json"); }));
  }
  std::printf("direct %.3f ms, by the console %.3f ms (binary), %.3f ms (JSON)\n", Median(direct),
              Median(binary), Median(json));
  return 0;
}

}  // namespace
}  // namespace graspdb::testing

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "console_overhead: give SERVER and CONSOLE_PORT\n");
    return 2;
  }
  const int count = argc > 3 ? std::atoi(argv[3]) : 2000;
  return graspdb::testing::Measure(argv[1], std::atoi(argv[2]), std::max(count, 1));
}
