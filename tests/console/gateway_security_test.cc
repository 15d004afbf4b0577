// Identities of browsers and of the console, and TLS on both sides.
#include <gmock/gmock.h>

#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "tests/console/gateway_fixture.h"
#include "tests/server/access_fixture.h"
#include "tests/testing/certificates.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;

class GatewayIdentityTest : public ConsoleTest<AccessTest> {
 protected:
  int CreateBox(const HttpFields& fields) {
    return Call("CatalogService/CreateObject", kJson, R"({"objectId":"box"})", fields).status;
  }
};

TEST_F(GatewayIdentityTest, TheBrowsersTokenHasItsRoles) {
  StartGateway();
  const std::string reader = "Bearer " + Add("reader", {v1::ROLE_READ});
  const std::string teacher = "Bearer " + Add("teacher", {v1::ROLE_TEACH});
  EXPECT_EQ(CreateBox({}), 401);
  EXPECT_EQ(CreateBox({{"Authorization", "Bearer wrong"}}), 401);
  EXPECT_EQ(CreateBox({{"Authorization", reader}}), 403);
  EXPECT_EQ(CreateBox({{"Authorization", teacher}}), 200);
}

TEST_F(GatewayIdentityTest, TheConsolesTokenIsForCallsWithoutOne) {
  const std::string file = folder_.Write("token", Add("console", {v1::ROLE_READ}) + "\n").string();
  const std::string teacher = "Bearer " + Add("teacher", {v1::ROLE_TEACH});
  StartGateway({.token_file = file});
  EXPECT_EQ(Call("CatalogService/ListObjects", kJson, "{}").status, 200);
  EXPECT_EQ(CreateBox({}), 403);
  EXPECT_EQ(CreateBox({{"Authorization", teacher}}), 200) << "its own replaces that of the console";
}

class GatewayTlsTest : public ConsoleTest<ServerTest> {
 protected:
  std::string Write(const std::string& name, const std::string& text) const {
    return folder_.Write(name, text).string();
  }
  const Authority plant_{"plant"};
};

TEST_F(GatewayTlsTest, TheServersCertificateIsChecked) {
  const KeyPair pair = plant_.IssueForLoopback();
  options_.tls = {.cert = Write("server.pem", pair.certificate),
                  .key = Write("server.key", pair.key)};
  Restart();
  StartGateway({.ca = Write("plant.pem", plant_.certificate())});
  EXPECT_EQ(Call("CatalogService/ListObjects", kJson, "{}").status, 200);
  StartGateway({.ca = Write("other.pem", Authority("other").certificate())});
  const HttpResponse refused = Call("CatalogService/ListObjects", kJson, "{}");
  EXPECT_EQ(refused.status, 503);
  EXPECT_THAT(refused.body, HasSubstr("--ca"));
}

TEST_F(GatewayTlsTest, BrowsersCanUseTls) {
  namespace net = boost::asio;
  namespace http = boost::beast::http;
  const KeyPair pair = plant_.IssueForLoopback();
  gateway_options_.tls_cert = Write("console.pem", pair.certificate);
  gateway_options_.tls_key = Write("console.key", pair.key);
  StartGateway();
  EXPECT_EQ(gateway_->url(), absl::StrCat("https://127.0.0.1:", gateway_->port(), "/"));
  net::io_context context;
  net::ssl::context tls(net::ssl::context::tls_client);
  tls.add_certificate_authority(net::buffer(plant_.certificate()));
  tls.set_verify_mode(net::ssl::verify_peer);
  net::ssl::stream<net::ip::tcp::socket> stream(context, tls);
  stream.next_layer().connect({net::ip::address_v4::loopback(), gateway_->port()});
  stream.handshake(net::ssl::stream_base::client);
  boost::beast::flat_buffer buffer;
  for (const char* host : {"localhost:", "evil.example:"}) {
    http::request<http::string_body> request(http::verb::post,
                                             "/graspdb.v1.CatalogService/ListObjects", 11, "{}");
    request.set(http::field::host, absl::StrCat(host, gateway_->port()));
    request.set(http::field::origin, absl::StrCat("https://localhost:", gateway_->port()));
    request.set(http::field::content_type, kJson);
    request.prepare_payload();
    http::write(stream, request);
    http::response<http::string_body> response;
    http::read(stream, buffer, response);
    EXPECT_EQ(response.result_int(), std::string(host) == "localhost:" ? 200U : 403U);
  }
  HttpClient plain = Connect();
  plain.SendBytes("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(plain.Receive().status, 0) << "no answer without TLS";
}

TEST_F(GatewayTlsTest, RenewedFilesAreUsed) {
  namespace net = boost::asio;
  KeyPair pair = plant_.IssueForLoopback();
  gateway_options_.tls_cert = Write("console.pem", pair.certificate);
  gateway_options_.tls_key = Write("console.key", pair.key);
  StartGateway();
  const Authority other("other");
  const auto is_trusted = [&] {
    net::io_context context;
    net::ssl::context tls(net::ssl::context::tls_client);
    tls.add_certificate_authority(net::buffer(other.certificate()));
    tls.set_verify_mode(net::ssl::verify_peer);
    net::ssl::stream<net::ip::tcp::socket> stream(context, tls);
    stream.next_layer().connect({net::ip::address_v4::loopback(), gateway_->port()});
    boost::system::error_code error;
    stream.handshake(net::ssl::stream_base::client, error);
    return !error;
  };
  EXPECT_FALSE(is_trusted());
  pair = other.IssueForLoopback();
  Write("console.pem", pair.certificate);
  Write("console.key", pair.key);
  while (!is_trusted()) absl::SleepFor(absl::Milliseconds(50));
}

}  // namespace
}  // namespace graspdb::testing
