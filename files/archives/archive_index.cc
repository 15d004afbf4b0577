#include "files/archives/archive_index.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "base/status_macros.h"
#include "files/messages/scan_message.h"

namespace graspdb::files {
namespace {

constexpr std::size_t kMaxIdBytes = 63;
constexpr std::size_t kDigestBytes = 8;

bool IsResourceId(std::string_view id) {
  return !id.empty() && id.size() <= kMaxIdBytes &&
         absl::ascii_isalnum(static_cast<unsigned char>(id.front())) &&
         std::ranges::all_of(id, [](char c) {
           return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' ||
                  c == '-';
         });
}

// Whether `name` is `prefix` and an id.
bool IsChild(std::string_view name, const std::string& prefix) {
  return name.starts_with(prefix) && IsResourceId(name.substr(prefix.size()));
}

class Indexer {
 public:
  explicit Indexer(const ArchiveFile& file) : file_(file) {
    EVP_DigestInit_ex(digest_.get(), EVP_sha256(), nullptr);
  }

  absl::StatusOr<ArchiveIndex> Run(const OnArchiveBytes& on_bytes) {
    for (offset_ = ArchiveFile::kFirstRecord; !ended_; offset_ = next_) {
      ASSIGN_OR_RETURN(const ArchiveItem item, file_.ReadAt(offset_));
      next_ = item.next;
      out_.has_unknown_fields |= item.has_unknown_fields;
      RETURN_IF_ERROR(Take(item.record));
      RETURN_IF_ERROR(on_bytes ? on_bytes(next_) : absl::OkStatus());
    }
    if (next_ != file_.size()) return file_.Damaged(next_, "bytes follow its end");
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    EVP_DigestFinal_ex(digest_.get(), digest.data(), nullptr);
    out_.digest = absl::BytesToHexString(
        absl::string_view(reinterpret_cast<const char*>(digest.data()), kDigestBytes));
    return std::move(out_);
  }

 private:
  absl::Status Take(const v1::ArchiveRecord& record) {
    const bool is_header = record.has_header();
    if (is_header != (offset_ == ArchiveFile::kFirstRecord)) {
      return file_.Damaged(offset_, "its header is not at its beginning");
    }
    switch (record.record_case()) {
      case v1::ArchiveRecord::kHeader:
        return absl::OkStatus();  // its place is checked above
      case v1::ArchiveRecord::kObject:
        return TakeObject(record);
      case v1::ArchiveRecord::kStablePose:
        return TakeStablePose(record);
      case v1::ArchiveRecord::kView:
        return TakeView(record);
      case v1::ArchiveRecord::kEnd:
        return TakeEnd(record.end());
      default:
        return file_.Damaged(offset_, "a record is of an unknown kind");
    }
  }

  absl::Status TakeObject(const v1::ArchiveRecord& record) {
    const std::string& name = record.object().name();
    if (!IsChild(name, "objects/") || name <= object_) return Misnamed("object");
    object_ = name;
    pose_.clear();
    view_.clear();
    found_.set_object_count(found_.object_count() + 1);
    return Add(ArchiveKind::kObject, name, record);
  }

  absl::Status TakeStablePose(const v1::ArchiveRecord& record) {
    const std::string& name = record.stable_pose().name();
    if (object_.empty() || !IsChild(name, object_ + "/stablePoses/") || name <= pose_) {
      return Misnamed("stable pose");
    }
    pose_ = name;
    view_.clear();
    found_.set_stable_pose_count(found_.stable_pose_count() + 1);
    return Add(ArchiveKind::kStablePose, name, record);
  }

  absl::Status TakeView(const v1::ArchiveRecord& record) {
    const v1::View& view = record.view();
    if (pose_.empty() || !IsChild(view.name(), pose_ + "/views/") || view.name() <= view_) {
      return Misnamed("view");
    }
    if (!view.has_object_pose() || !view.has_sensor_pose() || view.has_depth_image() ||
        view.cloud().data().empty() || !PointsFromMessage(view.cloud()).ok()) {
      return file_.Damaged(offset_, "a view has no poses or no cloud");
    }
    view_ = view.name();
    found_.set_view_count(found_.view_count() + 1);
    return Add(ArchiveKind::kView, view_, record);
  }

  absl::Status TakeEnd(const v1::ArchiveEnd& end) {
    if (end.object_count() != found_.object_count() ||
        end.stable_pose_count() != found_.stable_pose_count() ||
        end.view_count() != found_.view_count()) {
      return file_.Damaged(offset_, "records are missing");
    }
    ended_ = true;
    return absl::OkStatus();
  }

  absl::Status Misnamed(const char* kind) const {
    return file_.Damaged(offset_, std::string("the name of a ") + kind +
                                      " is not valid, or not the next in its order");
  }

  absl::Status Add(ArchiveKind kind, const std::string& name, const v1::ArchiveRecord& record) {
    out_.entries.push_back({kind, offset_, name});
    const std::string bytes = record.SerializeAsString();
    EVP_DigestUpdate(digest_.get(), bytes.data(), bytes.size());
    return absl::OkStatus();
  }

  const ArchiveFile& file_;
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> digest_{EVP_MD_CTX_new(),
                                                                  &EVP_MD_CTX_free};
  std::int64_t offset_ = 0;
  std::int64_t next_ = 0;
  bool ended_ = false;
  // Names of the last records; empty: none in its parent.
  std::string object_;
  std::string pose_;
  std::string view_;
  v1::ArchiveEnd found_;
  ArchiveIndex out_;
};

}  // namespace

absl::StatusOr<ArchiveIndex> IndexArchive(const ArchiveFile& file, const OnArchiveBytes& on_bytes) {
  return Indexer(file).Run(on_bytes);
}

}  // namespace graspdb::files
