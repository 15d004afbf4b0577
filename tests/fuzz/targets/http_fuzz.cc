// Bytes of a browser: one connection to the console, before a server that answers at once.
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/connect_pair.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/strings/ascii.h"
#include "console/http_connection.h"
#include "console/methods.h"
#include "tests/console/sample_page.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

using Socket = boost::asio::local::stream_protocol::socket;

constexpr std::size_t kMaxBodyBytes = 1024;

class NoCall : public console::UpstreamCall {
 public:
  void Next() override {}
  void Cancel() override {}
};

// Answers every other call with an error.
class InstantServer : public console::Upstream {
 public:
  std::shared_ptr<console::UpstreamCall> Start(console::UpstreamRequest request,
                                               OnEvent on_event) override {
    const google::protobuf::MethodDescriptor* method = console::FindMethod(request.path);
    Require(method != nullptr, "a method that browsers may call");
    const bool is_stream = method->server_streaming() || method->client_streaming();
    Require(is_stream == request.is_stream, "the kind of call of the method");
    Require(std::ranges::all_of(request.authorization, absl::ascii_isprint),
            "an authorization that gRPC can send");
    Require(request.message.size() <= kMaxBodyBytes, "a message within the limit");
    ++count_;
    absl::Status status;
    if (count_ % 2 == 0) status = absl::NotFoundError("none");
    on_event({.message = status.ok() ? std::optional<std::string>("") : std::nullopt,
              .end = console::UpstreamEvent::End{.status = status, .request_id = {}}});
    return std::make_shared<NoCall>();
  }

 private:
  int count_ = 0;
};

// What the peer has sent.
std::string Received(Socket& socket) {
  std::string out;
  std::array<char, 4096> bytes = {};
  boost::system::error_code error;
  while (const std::size_t size = socket.read_some(boost::asio::buffer(bytes), error)) {
    out.append(bytes.data(), size);
  }
  return out;
}

void Connect(std::string_view sent) {
  InstantServer server;
  console::Site site{.origins = console::Origins("127.0.0.1", 8080, {}, false),
                     .files = testing::kSamplePage,
                     .upstream = server,
                     .limits = {.max_head_bytes = 2048, .max_body_bytes = kMaxBodyBytes}};
  std::string received;
  {
    boost::asio::io_context context;
    Socket browser(context);
    Socket accepted(context);
    boost::asio::local::connect_pair(browser, accepted);
    browser.non_blocking(true);
    auto connection = std::make_shared<console::HttpConnection<Socket>>(std::move(accepted), site);
    boost::asio::post(context, [connection] { connection->Start(); });
    connection.reset();
    // As much as the kernel keeps; the rest after what was read of it.
    boost::system::error_code error;
    while (!sent.empty() && site.connection_count > 0) {
      sent.remove_prefix(browser.write_some(boost::asio::buffer(sent.data(), sent.size()), error));
      if (error && error != boost::asio::error::would_block) break;
      context.poll();
      received += Received(browser);
    }
    context.poll();
    received += Received(browser);
    browser.shutdown(Socket::shutdown_send, error);
    context.run();  // until the connection has ended
    received += Received(browser);
  }
  Require(site.connection_count == 0, "a connection that has ended");
  Require(site.body_byte_count == 0, "no body in memory");
  Require(received.empty() || received.starts_with("HTTP/1.1 "), "a response of HTTP");
  Require(received.find("\r\nSet-Cookie:") == std::string::npos, "no cookie");
  Require(received.find("\r\nAccess-Control-") == std::string::npos, "nothing for other sites");
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Connect({reinterpret_cast<const char*>(data), size});
  return 0;
}
