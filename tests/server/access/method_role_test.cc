// Roles of the methods, and their table in the documentation.
#include "server/access/method_role.h"

#include <gmock/gmock.h>

#include <map>

#include "absl/strings/str_cat.h"
#include "tests/files/temporary_folder.h"

namespace graspdb::server {
namespace {

// "| `read` | `CatalogService`: `GetObject`, ... |" for each role.
std::vector<std::string> RowsOfRoles() {
  std::map<v1::Role, std::map<std::string, std::string>> methods;
  const auto* pool = google::protobuf::DescriptorPool::generated_pool();
  for (const auto& file : std::filesystem::directory_iterator(
           std::filesystem::path(GRASPDB_SOURCE_DIR) / "proto/graspdb/v1")) {
    const std::string name = file.path().filename();
    if (!name.ends_with("_service.proto")) continue;
    const auto* descriptor = pool->FindFileByName("graspdb/v1/" + name);
    for (int i = 0; descriptor != nullptr && i < descriptor->service_count(); ++i) {
      const auto* service = descriptor->service(i);
      for (int j = 0; j < service->method_count(); ++j) {
        std::string& row = methods[RoleOf(*service->method(j))][service->name()];
        absl::StrAppend(&row, row.empty() ? " `" : ", `", service->method(j)->name(), "`");
      }
    }
  }
  std::vector<std::string> out;
  for (const auto& [role, services] : methods) {
    std::string calls;
    for (const auto& [service, names] : services) {
      absl::StrAppend(&calls, calls.empty() ? "" : "; ", service, ":", names);
    }
    out.push_back(absl::StrCat("| `", RoleName(role), "` | ", calls, " |"));
  }
  return out;
}

TEST(MethodRole, TheTableOfTheDocumentationIsThatOfTheContract) {
  const std::string page =
      files::BytesOf(std::filesystem::path(GRASPDB_SOURCE_DIR) / "docs/security.md");
  const std::vector<std::string> rows = RowsOfRoles();
  EXPECT_EQ(rows.size(), 4U);
  for (const std::string& row : rows) EXPECT_THAT(page, ::testing::HasSubstr("\n" + row + "\n"));
}

TEST(MethodRole, AReadingMethodIsAuditedWhereItsOptionIsSet) {
  google::protobuf::FileDescriptorProto file;
  file.set_name("audited_test.proto");
  file.add_message_type()->set_name("Nothing");
  auto* service = file.add_service();
  service->set_name("Service");
  for (const bool audited : {false, true}) {
    auto* method = service->add_method();
    method->set_name(audited ? "Audited" : "Plain");
    method->set_input_type("Nothing");
    method->set_output_type("Nothing");
    method->mutable_options()->SetExtension(v1::role, v1::ROLE_READ);
    if (audited) method->mutable_options()->SetExtension(v1::audited, true);
  }
  google::protobuf::DescriptorPool pool(google::protobuf::DescriptorPool::generated_pool());
  const auto* built = pool.BuildFile(file);
  ASSERT_NE(built, nullptr);
  EXPECT_FALSE(IsAudited(*built->service(0)->method(0)));
  EXPECT_TRUE(IsAudited(*built->service(0)->method(1)));
}

TEST(MethodRole, AMethodWithoutRoleIsAllowedToNoIdentity) {
  v1::Identity admin;
  admin.add_roles(v1::ROLE_ADMIN);
  EXPECT_TRUE(HasRole(admin, v1::ROLE_TEACH));
  EXPECT_FALSE(HasRole(admin, v1::ROLE_UNSPECIFIED));
}

}  // namespace
}  // namespace graspdb::server
