#include "tests/end_to_end/view_names.h"

#include <gtest/gtest.h>

#include "client/sdk/client.h"

namespace graspdb::end_to_end {

std::set<std::string> ViewNames(const std::string& address) {
  client::Client client({address, absl::Minutes(2)});
  std::set<std::string> names;
  const auto objects = client.ListObjects();
  for (const v1::Object& object : *objects) {
    const auto poses = client.ListStablePoses(object.name());
    for (const v1::StablePose& pose : *poses) {
      const auto views = client.ListViews(pose.name());
      for (const v1::View& view : *views) EXPECT_TRUE(names.insert(view.name()).second);
    }
  }
  return names;
}

}  // namespace graspdb::end_to_end
