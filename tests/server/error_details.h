// Matchers for errors: code, one sentence, and google.rpc.Status details.
#pragma once

#include <gmock/gmock.h>
#include <grpcpp/support/status.h>

#include <ostream>
#include <string>
#include <vector>

namespace graspdb::testing {

// Reason of the google.rpc.ErrorInfo; empty without one of the domain "graspdb".
std::string ReasonOf(const grpc::Status& status);

// Whether there is a google.rpc.RetryInfo.
bool HasRetryInfo(const grpc::Status& status);

// Field paths of the google.rpc.BadRequest.
std::vector<std::string> FieldsOf(const grpc::Status& status);

// Expects an error with this code, whose message is one line that contains `words`,
// and whose details repeat it, have a reason, and for INVALID_ARGUMENT name a field.
void ExpectError(const grpc::Status& status, grpc::StatusCode code, const std::string& words);

// The same, with the field of INVALID_ARGUMENT.
void ExpectBadField(const grpc::Status& status, const std::string& field, const std::string& words);

MATCHER(IsGrpcOk, "is OK") {
  *result_listener << "whose code is " << arg.error_code() << ": " << arg.error_message();
  return arg.ok();
}

}  // namespace graspdb::testing
