// What a request of a browser calls.
#pragma once

#include <google/protobuf/descriptor.h>

#include "absl/status/status.h"
#include "console/connect_protocol.h"
#include "console/request_head.h"
#include "console/upstream.h"

namespace graspdb::console {

// A call without its message.
struct CallPlan {
  const google::protobuf::MethodDescriptor* method = nullptr;
  BodyFormat format;
  UpstreamRequest request;
};

// The call of a POST request. `http_status` is set where the protocol has another one for an error
// than that of its code: 404 without such a method, 415 for a wrong Content-Type. Of the request's
// fields only those go to the server that gRPC can send. Thread-safe.
absl::Status PlanCall(const RequestHead& head, CallPlan* plan, int* http_status);

}  // namespace graspdb::console
