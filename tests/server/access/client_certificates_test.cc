// Verification of client certificates in the TLS handshake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/access/tls.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/certificates.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ClientCertificatesTest : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("plant.pem", plant_.certificate()); }

  absl::Status Verify(const std::string& leaf, const std::string& chain = "") const {
    return VerifyClientCertificate({leaf, chain}, (folder_.path() / "plant.pem").string());
  }

  const files::TemporaryFolder folder_;
  const testing::Authority plant_{"plant"};
  const testing::Authority other_{"other"};
};

TEST_F(ClientCertificatesTest, AcceptsThoseOfTheAuthority) {
  EXPECT_TRUE(Verify(plant_.Issue("press-3", "DNS:press-3").certificate).ok());
  folder_.Write("plant.pem", other_.certificate() + plant_.certificate());
  EXPECT_TRUE(Verify(plant_.Issue("press-3", "DNS:press-3").certificate).ok());
}

TEST_F(ClientCertificatesTest, NamesWhoIsRefusedAndWhy) {
  using ::graspdb::testing::StatusIs;
  const auto unauthenticated = absl::StatusCode::kUnauthenticated;
  EXPECT_THAT(Verify(plant_.Issue("press-3", "DNS:press-3", -60).certificate),
              StatusIs(unauthenticated, AllOf(HasSubstr("/CN=press-3, serial number"),
                                              HasSubstr("certificate has expired"))));
  EXPECT_THAT(Verify(other_.Issue("press-3", "DNS:press-3").certificate),
              StatusIs(unauthenticated, HasSubstr("issuer certificate")));
  // It brings its authority along.
  EXPECT_THAT(Verify(other_.Issue("press-3", "DNS:press-3").certificate, other_.certificate()),
              StatusIs(unauthenticated, HasSubstr("self-signed certificate")));
  EXPECT_THAT(Verify(""), StatusIs(unauthenticated, HasSubstr("no certificate")));
  EXPECT_THAT(Verify("-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n"),
              StatusIs(unauthenticated, HasSubstr("no certificate")));
}

TEST_F(ClientCertificatesTest, RefusesAllWithoutTheFileOfAuthorities) {
  folder_.Write("plant.pem", "");
  EXPECT_THAT(
      Verify(plant_.Issue("press-3", "DNS:press-3").certificate),
      ::graspdb::testing::StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("plant.pem")));
}

}  // namespace
}  // namespace graspdb::server
