// An upload that is not committed, in memory. Internal to storage/.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "storage/records.pb.h"
#include "storage/uploads/uploads.h"

namespace graspdb::storage {

// FAILED_PRECONDITION of what needs an open upload.
absl::Status CommittedUpload(std::string_view name);
// ABORTED of what was begun with an upload that does not exist any more.
absl::Status DeletedUpload(std::string_view name);

// `names` is for the state of each view; `in_use` is shared by those who write, and exclusive for
// the end of the upload.
struct Uploads::Open {
  struct View {
    std::string digest;      // empty: an error
    bool is_stored = false;  // else another thread writes it
  };

  UploadRecord record;
  absl::Mutex in_use;
  absl::Status end ABSL_GUARDED_BY(in_use);  // why nothing can be staged any more; OK: it can
  absl::Mutex names;
  std::map<std::string, View, std::less<>> views ABSL_GUARDED_BY(names);
  StagedCounts stored ABSL_GUARDED_BY(names);

  // Waits while another thread writes the view.
  void AwaitStored(std::string_view view_name) ABSL_EXCLUSIVE_LOCKS_REQUIRED(names) {
    const auto is_stored = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(names) {
      const View* view = Find(view_name);
      return view == nullptr || view->is_stored;
    };
    names.Await(absl::Condition(&is_stored));
  }

  // Null without that view.
  View* Find(std::string_view view_name) ABSL_EXCLUSIVE_LOCKS_REQUIRED(names) {
    const auto found = views.find(view_name);
    return found == views.end() ? nullptr : &found->second;
  }
};

}  // namespace graspdb::storage
