// Calls of the server, as bytes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace graspdb::console {

struct UpstreamRequest {
  std::string path;        // "/graspdb.v1.CatalogService/GetObject"
  bool is_stream = false;  // responses or requests are streams; a stream of requests has one here
  std::string message = {};
  std::optional<absl::Duration> timeout = std::nullopt;  // absent: none
  std::string authorization = {};  // of the caller; empty: that of the console, if it has one
  std::string request_id = {};     // as IsRequestId(); empty: the server chooses one
};

// What came from the server: a message, or the end, or both at once. After the end comes nothing.
struct UpstreamEvent {
  struct End {
    absl::Status status;  // with client::kErrorDetails
    std::string request_id;
  };
  std::optional<std::string> message = std::nullopt;
  std::optional<End> end = std::nullopt;
};

// A call in progress. Thread-safe.
class UpstreamCall {
 public:
  virtual ~UpstreamCall() = default;
  // Reads the next message of a stream. To be called once after each message without end.
  virtual void Next() = 0;
  // Ends the call soon, with CANCELLED unless it has ended; does not wait for it.
  virtual void Cancel() = 0;
};

// The server. Thread-safe.
class Upstream {
 public:
  virtual ~Upstream() = default;
  // `on_event` is called on another thread, or on this one before the return; one event at a time.
  // It is kept until the end.
  using OnEvent = std::function<void(UpstreamEvent)>;
  virtual std::shared_ptr<UpstreamCall> Start(UpstreamRequest request, OnEvent on_event) = 0;
};

}  // namespace graspdb::console
