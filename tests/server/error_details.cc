#include "tests/server/error_details.h"

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

template <typename Detail>
std::vector<Detail> DetailsOf(const grpc::Status& status) {
  google::rpc::Status all;
  std::vector<Detail> out;
  if (!all.ParseFromString(status.error_details())) return out;
  for (const auto& any : all.details()) {
    Detail detail;
    if (any.Is<Detail>() && any.UnpackTo(&detail)) out.push_back(detail);
  }
  return out;
}

}  // namespace

std::string ReasonOf(const grpc::Status& status) {
  const auto infos = DetailsOf<google::rpc::ErrorInfo>(status);
  if (infos.size() != 1 || infos[0].domain() != "graspdb") return "";
  return infos[0].reason();
}

bool HasRetryInfo(const grpc::Status& status) {
  return !DetailsOf<google::rpc::RetryInfo>(status).empty();
}

std::vector<std::string> FieldsOf(const grpc::Status& status) {
  std::vector<std::string> out;
  for (const auto& request : DetailsOf<google::rpc::BadRequest>(status)) {
    for (const auto& violation : request.field_violations()) out.push_back(violation.field());
  }
  return out;
}

void ExpectError(const grpc::Status& status, grpc::StatusCode code, const std::string& words) {
  EXPECT_EQ(status.error_code(), code) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr(words));
  EXPECT_THAT(status.error_message(), Not(HasSubstr("\n")));
  EXPECT_GE(status.error_message().size(), 20U) << "no sentence: " << status.error_message();
  google::rpc::Status details;
  ASSERT_TRUE(details.ParseFromString(status.error_details()));
  EXPECT_EQ(details.code(), code);
  EXPECT_EQ(details.message(), status.error_message());
  EXPECT_NE(ReasonOf(status), "") << "no google.rpc.ErrorInfo: " << status.error_message();
  if (code == grpc::StatusCode::INVALID_ARGUMENT) {
    EXPECT_EQ(FieldsOf(status).size(), 1U) << "no field: " << status.error_message();
  }
}

void ExpectBadField(const grpc::Status& status, const std::string& field,
                    const std::string& words) {
  ExpectError(status, grpc::StatusCode::INVALID_ARGUMENT, words);
  EXPECT_THAT(FieldsOf(status), ElementsAre(field));
}

}  // namespace graspdb::testing
