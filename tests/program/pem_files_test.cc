#include "program/tls/pem_files.h"

#include <gmock/gmock.h>

#include <cstddef>

#include "tests/files/temporary_folder.h"
#include "tests/testing/certificates.h"
#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kFailed = absl::StatusCode::kFailedPrecondition;

class PemFilesTest : public ::testing::Test {
 protected:
  PemFile File(const std::string& flag, const std::string& text) {
    return {flag, folder_.Write(flag, text)};
  }
  absl::Status Check(const testing::KeyPair& pair) {
    return CheckKeyPair(File("--cert", pair.certificate), File("--key", pair.key));
  }

  const files::TemporaryFolder folder_;
  const testing::Authority authority_{"plant"};
};

TEST_F(PemFilesTest, AValidPairIsAccepted) {
  EXPECT_THAT(Check(authority_.IssueForLoopback()), IsOk());
  EXPECT_THAT(CheckCertificates(File("--ca", authority_.certificate())), IsOk());
}

TEST_F(PemFilesTest, CertificateAndKeyMayBeInOneFile) {
  const testing::KeyPair pair = authority_.IssueForLoopback();
  EXPECT_THAT(Check({pair.key + pair.certificate, pair.key + pair.certificate}), IsOk());
}

// OpenSSL looks for lines that begin with dashes, and would skip the first certificate.
TEST_F(PemFilesTest, AByteOrderMarkHidesNoCertificate) {
  const testing::KeyPair pair = authority_.IssueForLoopback();
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_THAT(Check({mark + pair.certificate, mark + pair.key}), IsOk());
  const std::string both = pair.certificate + authority_.certificate();
  EXPECT_EQ(*ReadCertificates(File("--ca", mark + both)), *ReadCertificates(File("--cert", both)));
}

TEST_F(PemFilesTest, AnExpiredCertificateIsRejectedWithItsDate) {
  EXPECT_THAT(Check(authority_.IssueForLoopback(-60)),
              StatusIs(kFailed, ::testing::ContainsRegex("--cert .* expired on 20.* UTC; renew")));
}

TEST_F(PemFilesTest, AnotherKeyIsRejected) {
  EXPECT_THAT(Check({authority_.IssueForLoopback().certificate, authority_.IssueForLoopback().key}),
              StatusIs(kFailed, HasSubstr("is not the key of --cert")));
}

TEST_F(PemFilesTest, AnIncompleteChainIsRejected) {
  const testing::KeyPair pair = authority_.IssueForLoopback();
  const std::string chain = pair.certificate + authority_.certificate();
  EXPECT_THAT(Check({chain, pair.key}), IsOk());
  for (const std::size_t missing : {30U, 200U}) {
    EXPECT_THAT(Check({chain.substr(0, chain.size() - missing), pair.key}),
                StatusIs(kFailed, HasSubstr("--cert")));
  }
}

TEST_F(PemFilesTest, ThePairIsReadWithTheKeyFirstAndNothingElse) {
  const testing::KeyPair pair = authority_.IssueForLoopback();
  const std::string both = "notes\n" + pair.certificate + pair.key + authority_.certificate();
  const absl::StatusOr<std::string> read = ReadKeyPair(File("--cert", both), File("--key", both));
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(*read, ::testing::StartsWith("-----BEGIN PRIVATE KEY-----\n"));
  EXPECT_THAT(*read, ::testing::EndsWith("\n" + pair.certificate + authority_.certificate()));
  const absl::StatusOr<std::string> certificates = ReadCertificates(File("--ca", both));
  ASSERT_THAT(certificates, IsOk());
  EXPECT_EQ(*certificates, pair.certificate + authority_.certificate());
  EXPECT_THAT(ReadKeyPair(File("--cert", both), File("--key", authority_.IssueForLoopback().key)),
              StatusIs(kFailed, HasSubstr("is not the key of --cert")));
}

TEST_F(PemFilesTest, FilesWithoutCertificateOrKeyAreRejected) {
  const testing::KeyPair pair = authority_.IssueForLoopback();
  EXPECT_THAT(Check({"", pair.key}), StatusIs(kFailed, HasSubstr("has no certificate")));
  EXPECT_THAT(Check({pair.certificate, pair.certificate}), StatusIs(kFailed, HasSubstr("--key")));
  EXPECT_THAT(
      CheckCertificates({"--ca", "/nonexistent"}),
      StatusIs(kFailed, HasSubstr("--ca /nonexistent cannot be read (No such file or directory)")));
}

}  // namespace
}  // namespace graspdb
