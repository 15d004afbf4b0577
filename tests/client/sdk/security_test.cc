// TLS, client certificates and tokens between the client library and a server.
#include <gmock/gmock.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/sdk/client.h"
#include "server/access/identities.h"
#include "server/server.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/certificates.h"
#include "tests/testing/scoped_variable.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::Authority;
using graspdb::testing::IsOk;
using graspdb::testing::KeyPair;
using graspdb::testing::NoProxy;
using graspdb::testing::ScopedVariable;
using graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr auto kUnavailable = absl::StatusCode::kUnavailable;

class SecurityTest : public ::testing::Test {
 protected:
  void SetUp() override {
    spdlog::set_level(spdlog::level::off);
    options_.database = (folder_.path() / "db").string();
    options_.listen = "127.0.0.1:0";
    WritePair("server", plant_.IssueForLoopback());
    options_.tls = {.cert = Path("server.pem"),
                    .key = Path("server.key"),
                    .client_ca = folder_.Write("plant.pem", plant_.certificate()).string()};
  }

  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }
  void WritePair(const std::string& name, const KeyPair& pair) const {
    folder_.Write(name + ".pem", pair.certificate);
    folder_.Write(name + ".key", pair.key);
  }
  void WriteIdentities(const std::string& text) {
    options_.identities = folder_.Write("identities.jsonl", text).string();
  }

  void Start() {
    auto server = server::Server::Start(options_);
    ASSERT_THAT(server, IsOk());
    server_ = *std::move(server);
  }

  // Trusts the authority of the server.
  SecurityOptions Trusting() const { return {.ca = Path("plant.pem")}; }
  // With a new certificate that identifies the client.
  SecurityOptions Certified(const std::string& name, const KeyPair& pair) const {
    WritePair(name, pair);
    return {.ca = Path("plant.pem"), .cert = Path(name + ".pem"), .key = Path(name + ".key")};
  }
  // With a connection of its own.
  Client Connect(const SecurityOptions& security, std::string server = "") const {
    if (server.empty()) server = server_->address();
    return Client({.server = std::move(server), .own_connection = true, .security = security});
  }
  absl::Status Status(const SecurityOptions& security) const {
    return Connect(security).GetCatalogStatus().status();
  }
  // Waits until a new connection gives this code.
  void Await(const SecurityOptions& security, absl::StatusCode code) const {
    while (Status(security).code() != code) absl::SleepFor(absl::Milliseconds(50));
  }

  const files::TemporaryFolder folder_;
  const Authority plant_{"plant"};
  const Authority other_{"other"};
  server::ServerOptions options_;
  std::unique_ptr<server::Server> server_;
};

TEST_F(SecurityTest, ACertificateIdentifiesTheClient) {
  WriteIdentities(
      R"({"name":"by-uri","roles":["ROLE_READ"],"certificates":["uri:spiffe://plant/cell/3"]})"
      "\n"
      R"({"name":"by-dns","roles":["ROLE_TEACH"],"certificates":["dns:press-3.plant"]})"
      "\n"
      R"({"name":"by-cn","roles":["ROLE_ADMIN"],"certificates":["cn:press-3"]})");
  options_.tls.require_client_cert = true;
  Start();
  v1::CreateObjectRequest object;
  object.set_object_id("mug");
  const auto connect = [&](const std::string& common_name, const std::string& names) {
    return Connect(Certified("client", plant_.Issue(common_name, names)));
  };
  Client by_uri = connect("press-3", "URI:spiffe://plant/cell/3,DNS:press-3.plant");
  EXPECT_THAT(by_uri.GetCatalogStatus(), IsOk());
  EXPECT_THAT(by_uri.CreateObject(object),
              StatusIs(absl::StatusCode::kPermissionDenied,
                       HasSubstr("identity by-uri lacks the role teach")));
  Client by_dns = connect("press-3", "DNS:press-3.plant");
  EXPECT_THAT(by_dns.CreateObject(object), IsOk());
  EXPECT_THAT(by_dns.GetCatalogStatus(), StatusIs(absl::StatusCode::kPermissionDenied));
  Client by_cn = connect("press-3", "");
  EXPECT_THAT(by_cn.GetCatalogStatus(), IsOk());
  EXPECT_THAT(connect("press-4", "DNS:press-4.plant").GetCatalogStatus(),
              StatusIs(absl::StatusCode::kUnauthenticated,
                       HasSubstr("(dns:press-4.plant, cn:press-4) has no identity")));
}

TEST_F(SecurityTest, ANameThatIsTooLongIdentifiesNoOtherClient) {
  const std::string name = "spiffe://plant/" + std::string(300, 'x');
  const std::string in_errors = "uri:" + name.substr(0, 249) + "...";
  WriteIdentities(absl::StrCat(R"({"name":"other","roles":["ROLE_READ"],"certificates":[")",
                               in_errors, "\"]}\n"));
  options_.tls.require_client_cert = true;
  Start();
  EXPECT_THAT(Status(Certified("client", plant_.Issue("press-3", "URI:" + name))),
              StatusIs(absl::StatusCode::kUnauthenticated,
                       HasSubstr("(" + in_errors + ", cn:press-3) has no identity")));
}

TEST_F(SecurityTest, WithoutIdentitiesEveryTrustedClientMayDoAll) {
  options_.tls.require_client_cert = true;
  Start();
  v1::CreateObjectRequest object;
  object.set_object_id("mug");
  EXPECT_THAT(Connect(Certified("client", plant_.Issue("any", ""))).CreateObject(object), IsOk());
}

TEST_F(SecurityTest, CertificatesThatTheServerDoesNotTrustAreRejected) {
  Start();
  EXPECT_THAT(Status(Trusting()), IsOk());
  EXPECT_THAT(Status(Certified("alien", other_.Issue("press-3", ""))),
              StatusIs(kUnavailable, HasSubstr("does not accept --cert " + Path("alien.pem"))));
  EXPECT_THAT(Status(Certified("expired", plant_.Issue("press-3", "", -60))),
              StatusIs(kUnavailable, HasSubstr("does not accept --cert " + Path("expired.pem"))));
  WritePair("mixed", {plant_.Issue("a", "").certificate, plant_.Issue("a", "").key});
  EXPECT_THAT(
      Status({.ca = Path("plant.pem"), .cert = Path("mixed.pem"), .key = Path("mixed.key")}),
      StatusIs(kUnavailable, HasSubstr("--cert and --key cannot be used")));
}

TEST_F(SecurityTest, AConnectionWithoutCertificateIsRejectedIfRequired) {
  options_.tls.require_client_cert = true;
  Start();
  EXPECT_THAT(Status(Trusting()), StatusIs(kUnavailable, HasSubstr("give --cert and --key")));
}

TEST_F(SecurityTest, AServerThatTheClientDoesNotTrustIsRejected) {
  Start();
  const std::string other = folder_.Write("other.pem", other_.certificate());
  EXPECT_THAT(Status({.ca = other}),
              StatusIs(kUnavailable, HasSubstr("authority of --ca " + other)));
  EXPECT_THAT(Status({.cert = Path("server.pem"), .key = Path("server.key")}),
              StatusIs(kUnavailable, HasSubstr("give --ca")));
  const std::string port = server_->address().substr(server_->address().rfind(':'));
  EXPECT_THAT(Connect(Trusting(), "127.0.0.2" + port).GetCatalogStatus(), StatusIs(kUnavailable));
  WritePair("server", plant_.Issue("elsewhere", "DNS:elsewhere"));
  server_.reset();
  Start();
  EXPECT_THAT(Status(Trusting()), StatusIs(kUnavailable, HasSubstr("other host names")));
}

TEST_F(SecurityTest, AnAddressInTheCommonNameAloneIsExplained) {
  WritePair("server", plant_.Issue("127.0.0.1", ""));
  Start();
  EXPECT_THAT(Status(Trusting()),
              StatusIs(kUnavailable, AllOf(HasSubstr("subjectAltName"), HasSubstr("CN"))));
}

TEST_F(SecurityTest, NoProxyIsUsedForALoopbackAddress) {
  const NoProxy no_proxy;
  const ScopedVariable proxy("http_proxy", "http://127.0.0.1:9");
  Start();
  EXPECT_THAT(Status(Trusting()), IsOk());
  options_.tls = {};
  server_.reset();
  Start();
  EXPECT_THAT(Status({}), IsOk());
}

TEST_F(SecurityTest, AProxyThatDoesNotLeadToTheServerIsNamed) {
  const NoProxy no_proxy;
  const ScopedVariable proxy("http_proxy", "http://127.0.0.1:9");
  EXPECT_THAT(Connect({}, "server.invalid:50051").GetCatalogStatus(),
              StatusIs(kUnavailable, AllOf(HasSubstr("http_proxy"), HasSubstr("no_proxy"))));
}

TEST_F(SecurityTest, TlsOnOneSideOnlyIsReported) {
  Start();
  EXPECT_THAT(Status({}), StatusIs(kUnavailable, HasSubstr("give --ca if it uses TLS")));
  options_.tls = {};
  server_.reset();
  Start();
  EXPECT_THAT(Status(Trusting()), StatusIs(kUnavailable, HasSubstr("does not use TLS")));
}

TEST_F(SecurityTest, ARenewedServerCertificateIsUsedWithoutARestart) {
  Start();
  Client before = Connect(Trusting());
  ASSERT_THAT(before.GetCatalogStatus(), IsOk());
  const std::string address = server_->address();
  const SecurityOptions next = {.ca = folder_.Write("other.pem", other_.certificate())};
  EXPECT_THAT(Status(next), StatusIs(kUnavailable));
  WritePair("server", other_.IssueForLoopback());
  Await(next, absl::StatusCode::kOk);
  EXPECT_THAT(Status(Trusting()), StatusIs(kUnavailable));
  EXPECT_THAT(before.GetCatalogStatus(), IsOk());  // its connection stays
  EXPECT_EQ(server_->address(), address);
}

TEST_F(SecurityTest, AnotherAuthorityOfClientsIsUsedWithoutARestart) {
  Start();
  const SecurityOptions client = Certified("client", other_.Issue("press-3", ""));
  EXPECT_THAT(Status(client), StatusIs(kUnavailable));
  folder_.Write("plant.pem", plant_.certificate() + other_.certificate());
  Await(client, absl::StatusCode::kOk);
}

TEST_F(SecurityTest, AClientUsesItsRenewedCertificate) {
  options_.tls.require_client_cert = true;
  Start();
  Client client = Connect(Certified("client", plant_.Issue("press-3", "", -60)));
  EXPECT_THAT(client.GetCatalogStatus(), StatusIs(kUnavailable));
  WritePair("client", plant_.Issue("press-3", ""));
  while (!client.GetCatalogStatus().ok()) absl::SleepFor(absl::Milliseconds(50));
}

TEST_F(SecurityTest, AClientKeepsItsCertificateWhileTheFilesAreEmptied) {
  options_.tls.require_client_cert = true;
  Start();
  Client client = Connect(Certified("client", plant_.Issue("press-3", "")));
  ASSERT_THAT(client.GetCatalogStatus(), IsOk());
  std::filesystem::resize_file(Path("client.pem"), 0);
  std::filesystem::resize_file(Path("client.key"), 0);
  absl::SleepFor(absl::Seconds(3));  // both are read each second
  options_.listen = server_->address();
  server_.reset();
  Start();
  // Over a new connection.
  while (!client.GetCatalogStatus().ok()) absl::SleepFor(absl::Milliseconds(50));
}

class TokenTest : public SecurityTest {
 protected:
  void SetUp() override {
    SecurityTest::SetUp();
    WriteToken("one");
    WriteIdentity("one");
  }

  void WriteToken(const std::string& token) { folder_.Write("token", token + "\n"); }
  void WriteIdentity(const std::string& token) {
    WriteIdentities(absl::StrCat(R"({"name":"reader","roles":["ROLE_READ"],"tokenSha256":[")",
                                 absl::Base64Escape(server::HashToken(token)), "\"]}\n"));
  }
};

TEST_F(TokenTest, IsSentWithAndWithoutTls) {
  Start();
  SecurityOptions security = Trusting();
  EXPECT_THAT(Status(security), StatusIs(absl::StatusCode::kUnauthenticated));
  security.token_file = Path("token");
  EXPECT_THAT(Status(security), IsOk());
  options_.tls = {};
  server_.reset();
  Start();
  EXPECT_THAT(Status({.token_file = Path("token")}), IsOk());
}

TEST_F(TokenTest, TakesPrecedenceOverTheCertificate) {
  WriteIdentities(
      absl::StrCat(R"({"name":"reader","roles":["ROLE_READ"],"tokenSha256":[")",
                   absl::Base64Escape(server::HashToken("one")), "\"]}\n",
                   R"({"name":"robot","roles":["ROLE_RECOGNISE"],"certificates":["cn:robot"]})"));
  Start();
  SecurityOptions security = Certified("robot", plant_.Issue("robot", ""));
  EXPECT_THAT(Status(security), StatusIs(absl::StatusCode::kPermissionDenied));
  security.token_file = Path("token");
  EXPECT_THAT(Status(security), IsOk());
}

TEST_F(TokenTest, IsReadAgainWhenItIsReplaced) {
  Start();
  SecurityOptions security = Trusting();
  security.token_file = Path("token");
  Client client = Connect(security);
  ASSERT_THAT(client.GetCatalogStatus(), IsOk());
  WriteIdentity("two");
  while (client.GetCatalogStatus().ok()) absl::SleepFor(absl::Milliseconds(50));
  WriteToken("two");
  EXPECT_THAT(client.GetCatalogStatus(), IsOk());
}

TEST_F(TokenTest, AFileWithoutTokenIsReported) {
  Start();
  SecurityOptions security = Trusting();
  security.token_file = Path("missing");
  EXPECT_THAT(Status(security), StatusIs(absl::StatusCode::kFailedPrecondition,
                                         HasSubstr("cannot read --token-file")));
  security.token_file = folder_.Write("empty", "\ntoken\n").string();
  EXPECT_THAT(Status(security),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("no token")));
}

TEST_F(TokenTest, IsNotSentUnencryptedToAnotherMachine) {
  options_.tls = {};
  Start();
  // An address of this machine that does not look like one.
  const std::string port = server_->address().substr(server_->address().rfind(':'));
  EXPECT_THAT(Connect({.token_file = Path("token")}, "0.0.0.0" + port).GetCatalogStatus(),
              StatusIs(absl::StatusCode::kUnauthenticated,
                       AllOf(HasSubstr("not sent to 0.0.0.0"), HasSubstr("give --ca"))));
}

}  // namespace
}  // namespace graspdb::client
