#include "console/methods.h"

#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include <map>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graspdb/v1/backup_service.pb.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/cell_service.pb.h"
#include "graspdb/v1/change_service.pb.h"
#include "graspdb/v1/object_history_service.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "graspdb/v1/upload_service.pb.h"

namespace graspdb::console {
namespace {

using google::protobuf::FileDescriptor;
using google::protobuf::Message;
using google::protobuf::MethodDescriptor;
using MethodMap = std::map<std::string, const MethodDescriptor*, std::less<>>;

// One message of each file of a service, whose code is then linked.
std::vector<const FileDescriptor*> ServiceFiles() {
  return {v1::ListBackupsRequest::descriptor()->file(),
          v1::ListObjectsRequest::descriptor()->file(),
          v1::ListCellsRequest::descriptor()->file(),
          v1::WatchCatalogRequest::descriptor()->file(),
          v1::ListDeletedObjectsRequest::descriptor()->file(),
          v1::RecognizeRequest::descriptor()->file(),
          v1::ListUploadsRequest::descriptor()->file()};
}

const MethodMap& Methods() {
  static const auto* const methods = [] {
    auto* out = new MethodMap();
    for (const FileDescriptor* file : ServiceFiles()) {
      for (int s = 0; s < file->service_count(); ++s) {
        const google::protobuf::ServiceDescriptor* service = file->service(s);
        for (int m = 0; m < service->method_count(); ++m) {
          const MethodDescriptor* method = service->method(m);
          out->emplace(absl::StrCat("/", service->full_name(), "/", method->name()), method);
        }
      }
    }
    return out;
  }();
  return *methods;
}

std::unique_ptr<Message> NewMessage(const google::protobuf::Descriptor* type) {
  return std::unique_ptr<Message>(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
}

}  // namespace

const MethodDescriptor* FindMethod(std::string_view path) {
  const auto found = Methods().find(path);
  return found == Methods().end() ? nullptr : found->second;
}

std::vector<std::string> MethodPaths() {
  std::vector<std::string> out;
  out.reserve(Methods().size());
  for (const auto& [path, method] : Methods()) out.push_back(path);
  return out;
}

absl::StatusOr<std::string> RequestBytes(const MethodDescriptor& method, Encoding encoding,
                                         std::string message) {
  if (encoding == Encoding::kBinary) return message;
  const std::unique_ptr<Message> request = NewMessage(method.input_type());
  const auto status =
      google::protobuf::util::JsonStringToMessage(message.empty() ? "{}" : message, request.get());
  if (!status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("the body is not a ",
                                                   method.input_type()->full_name(),
                                                   " in JSON: ", std::string(status.message())));
  }
  return request->SerializeAsString();
}

absl::StatusOr<std::string> ResponseText(const MethodDescriptor& method, Encoding encoding,
                                         std::string message) {
  if (encoding == Encoding::kBinary) return message;
  const std::unique_ptr<Message> response = NewMessage(method.output_type());
  std::string out;
  if (!response->ParseFromString(message) ||
      !google::protobuf::util::MessageToJsonString(*response, &out).ok()) {
    return absl::InternalError(absl::StrCat("the server's ", method.output_type()->full_name(),
                                            " has no JSON; take application/proto"));
  }
  return out;
}

}  // namespace graspdb::console
