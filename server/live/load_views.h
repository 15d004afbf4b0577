// Loads all views of the catalogue with their index, and describes views again.
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/cancellation.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/index/descriptor_index.h"
#include "recognition/models/taught.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// All views at one revision, with their index.
struct LoadedViews {
  std::int64_t revision = 0;
  recognition::DescriptorIndex index;
  std::vector<std::shared_ptr<const recognition::TaughtView>> views;
  std::vector<std::string> left_out = {};  // names of views that cannot be used
};

// Adds views to an index as they are read. Other threads process them in portions, which takes
// longer than reading them; no second copy of all descriptors is ever in memory. Search results do
// not depend on the threads. Not thread-safe.
class ViewCollector {
 public:
  // `size` bins per descriptor.
  explicit ViewCollector(int size);

  void Add(recognition::IndexedView view);
  // The added views, as of `revision`; Add() must not be called after it.
  LoadedViews Finish(std::int64_t revision);

 private:
  void HandOutPortion();
  void TakeOldest();

  const std::size_t max_at_work_;
  recognition::DescriptorIndex index_;
  std::deque<std::future<recognition::DescriptorIndex>> at_work_;  // the oldest in front
  std::vector<std::shared_ptr<const recognition::TaughtView>> views_;
  std::vector<recognition::IndexedView> portion_;
};

// The text of CANCELLED before an upload is committed.
inline constexpr std::string_view kCommitCancelled =
    "the upload was not committed, its views are safe; commit it again";

// The views of the records, read in one pass with the records for `others`. Names of those without
// a descriptor of these parameters are added to `undescribed`; they are left out.
absl::StatusOr<LoadedViews> ReadViews(const storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters,
                                      storage::RecordVisitor others,
                                      std::vector<std::string>* undescribed);

// Recomputes the descriptors of the named views from the clouds, and stores them; except of views
// whose records or clouds cannot be used.
//
// FAILED_PRECONDITION for a view that cannot be described with `parameters`, and the errors of the
// catalogue. CANCELLED within some milliseconds after `is_cancelled`, with the views until then
// stored.
absl::Status Redescribe(storage::Catalogue& catalogue, const std::vector<std::string>& names,
                        const recognition::DescriptorParameters& parameters,
                        const recognition::IsCancelled& is_cancelled);

// Redescribe() for those views of one object that have no descriptor of these parameters. A view
// that cannot be described gets a descriptor without bins and is left out, also at the next starts:
// it does not prevent them. Some milliseconds for each view.
absl::Status DescribeObject(storage::Catalogue& catalogue, const std::string& object,
                            const recognition::DescriptorParameters& parameters);

// The same for the staged views of an upload, which stay staged. Errors as Redescribe(), but for
// views that cannot be described, and those of an upload that ended meanwhile. After CANCELLED,
// which comes before the next view, the next call goes on there. About 5 us for a view that has
// such a descriptor, some milliseconds for another one.
absl::Status DescribeStaged(storage::Catalogue& catalogue, const storage::UploadRecord& upload,
                            const recognition::DescriptorParameters& parameters,
                            const recognition::IsCancelled& is_cancelled);

}  // namespace graspdb::server
