#include "console/answer.h"

#include <algorithm>
#include <boost/beast/http/write.hpp>
#include <sstream>

#include "console/connect_protocol.h"
#include "console/methods.h"

namespace graspdb::console {
namespace {

namespace http = boost::beast::http;

// Scripts and styles are files of the console; nothing is loaded from elsewhere.
constexpr char kPolicy[] =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
    "data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "require-trusted-types-for 'script'; trusted-types mesh-worker";

bool TakesGzip(const RequestHead& head) {
  return Field(head, "Accept-Encoding").find("gzip") != std::string_view::npos;
}

}  // namespace

ResponseHead MakeHead(int http_status, std::string_view content_type) {
  ResponseHead head;
  head.version(11);
  head.result(static_cast<unsigned>(http_status));
  head.set(http::field::content_type, {content_type.data(), content_type.size()});
  head.set("Content-Security-Policy", kPolicy);
  head.set("X-Content-Type-Options", "nosniff");
  head.set("Referrer-Policy", "no-referrer");
  head.set("Cross-Origin-Opener-Policy", "same-origin");
  head.set("Cross-Origin-Resource-Policy", "same-origin");
  head.set(http::field::cache_control, "no-store");
  return head;
}

Answer ErrorAnswer(int http_status, const absl::Status& error) {
  return {.head = MakeHead(http_status, "application/json"), .text = ErrorJson(error)};
}

absl::Status CheckSource(const RequestHead& head, const Origins& origins) {
  if (head.version() != 11) return absl::UnimplementedError("only HTTP/1.1 is spoken here");
  if (head.count(http::field::host) != 1) {
    return absl::PermissionDeniedError("the request has not one Host");
  }
  absl::Status status = origins.CheckHost(Field(head, "Host"));
  if (!status.ok()) return status;
  const std::string_view site = Field(head, "Sec-Fetch-Site");
  const bool is_read = head.method() == http::verb::get || head.method() == http::verb::head;
  if (!is_read) return origins.CheckCall(Field(head, "Origin"), site);
  // A link from elsewhere may open the page; nothing else of it is for other sites.
  if (Field(head, "Sec-Fetch-Mode") == "navigate") return absl::OkStatus();
  return origins.CheckCall({}, site);
}

Answer FileAnswer(const RequestHead& head, std::span<const PageFile> files) {
  const std::string_view path = Path(head);
  if (FindMethod(path) != nullptr) {
    Answer out = ErrorAnswer(405, absl::UnimplementedError("call a method by POST"));
    out.head.set(http::field::allow, "POST");
    return out;
  }
  const auto file = std::ranges::find(files, path, &PageFile::path);
  if (file == files.end()) return ErrorAnswer(404, absl::NotFoundError("there is no such file"));
  const bool is_known = Field(head, "If-None-Match") == file->etag;
  Answer out{.head = MakeHead(is_known ? 304 : 200, file->content_type)};
  out.head.set(http::field::cache_control, "no-cache");
  out.head.set(http::field::etag, {file->etag.data(), file->etag.size()});
  out.head.set(http::field::vary, "Accept-Encoding");
  if (is_known) return out;
  out.bytes = file->bytes;
  if (!file->gzip.empty() && TakesGzip(head)) {
    out.bytes = file->gzip;
    out.head.set(http::field::content_encoding, "gzip");
  }
  return out;
}

std::string HeadText(const ResponseHead& head) {
  std::ostringstream out;
  out << head;
  return out.str();
}

}  // namespace graspdb::console
