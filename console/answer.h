// Responses of the console, but those of the server.
#pragma once

#include <boost/beast/http/fields.hpp>
#include <boost/beast/http/message.hpp>
#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "console/request_head.h"
#include "console/site.h"

namespace graspdb::console {

using ResponseHead = boost::beast::http::response_header<>;

// A response: `head` without Content-Length and Connection. The body is `text`, or where that is
// empty `bytes`, which outlive it.
struct Answer {
  ResponseHead head;
  std::string text = {};
  std::string_view bytes = {};
};

// A head with the fields that all responses have: what the browser may load, that other sites may
// neither embed nor read it.
ResponseHead MakeHead(int http_status, std::string_view content_type);

// An error of the gateway or of the server, as the Connect protocol has it.
Answer ErrorAnswer(int http_status, const absl::Status& error);

// Checks that a request may be answered: a version of HTTP that can be, one Host that is ours, no
// call from another site's page.
absl::Status CheckSource(const RequestHead& head, const Origins& origins);

// To a GET or HEAD: a file of the page, or 404.
Answer FileAnswer(const RequestHead& head, std::span<const PageFile> files);

// The response's head as it is sent.
std::string HeadText(const ResponseHead& head);

}  // namespace graspdb::console
