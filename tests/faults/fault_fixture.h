// A server with sample views.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/faults/sample_views.h"

namespace graspdb::faults {

class FaultTest : public end_to_end::ProgramsTest {
 protected:
  client::Client Connect() const {
    return client::Client({.server = address_, .own_connection = true});
  }
  static std::string IdOf(int number) { return absl::StrCat("v", number); }
  // The view with this number, whose content follows from it.
  std::string NameOf(int number) const {
    return absl::StrCat(samples_.StablePoseOf(ContentOf(number)), "/views/", IdOf(number));
  }
  int ContentOf(int number) const { return number % samples_.count(); }
  absl::Status Teach(client::Client& client, int number) const {
    return TeachOne(client, samples_.Request(ContentOf(number), IdOf(number)));
  }
  // Objects and stable poses, and what their views look like when they are stored.
  void Prepare() {
    StartServer("reference");
    client::Client reference = Connect();
    ASSERT_EQ(samples_.Prepare(reference), absl::OkStatus());
    ASSERT_EQ(samples_.LearnStored(reference), absl::OkStatus());
  }
  void ExpectView(client::Client& client, int number) const {
    const absl::StatusOr<v1::View> view = client.GetView(NameOf(number));
    ASSERT_TRUE(view.ok()) << view.status();
    EXPECT_TRUE(samples_.IsStored(*view, ContentOf(number))) << number;
  }

  SampleViews samples_;
};

}  // namespace graspdb::faults
