// Calls of BackupService.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "storage/backups/backups.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {

class BackupServiceTest : public ServerTest {
 protected:
  void SetUp() override {
    options_.backup_dir = (folder_.path() / "backups").string();
    std::filesystem::create_directory(options_.backup_dir);
    ServerTest::SetUp();
  }

  // Calls a method that streams; `last` gets the last message.
  template <typename Request, typename Response>
  grpc::Status Stream(std::unique_ptr<grpc::ClientReader<Response>> (BackupStub::*method)(
                          grpc::ClientContext*, const Request&),
                      const Request& request, Response* last) {
    grpc::ClientContext context;
    const auto reader = (StubOf<BackupStub>().*method)(&context, request);
    while (reader->Read(last)) continue;
    return reader->Finish();
  }

  v1::Backup Create() {
    v1::CreateBackupResponse response;
    EXPECT_THAT(Stream(&BackupStub::CreateBackup, v1::CreateBackupRequest(), &response),
                IsGrpcOk());
    return response.backup();
  }

  grpc::Status Verify(const std::string& name, v1::VerifyBackupResponse* response) {
    v1::VerifyBackupRequest request;
    request.set_name(name);
    return Stream(&BackupStub::VerifyBackup, request, response);
  }

  grpc::Status Verify(const std::string& name) {
    v1::VerifyBackupResponse ignored;
    return Verify(name, &ignored);
  }

  grpc::Status Delete(const std::string& name) {
    v1::DeleteBackupRequest request;
    request.set_name(name);
    return Call(&BackupStub::DeleteBackup, request);
  }

  grpc::Status Compare(const std::string& name, std::vector<std::string>* names) {
    v1::CompareBackupRequest request;
    request.set_name(name);
    grpc::ClientContext context;
    const auto reader = StubOf<BackupStub>().CompareBackup(&context, request);
    v1::CompareBackupResponse response;
    while (reader->Read(&response)) {
      for (const v1::BackupDifference& difference : response.differences()) {
        names->push_back(v1::BackupDifference::Kind_Name(difference.kind()) + " " +
                         difference.name());
      }
    }
    return reader->Finish();
  }

  std::vector<std::string> Listed() {
    v1::ListBackupsResponse response;
    EXPECT_THAT(Call(&BackupStub::ListBackups, v1::ListBackupsRequest(), &response), IsGrpcOk());
    std::vector<std::string> names;
    for (const v1::Backup& backup : response.backups()) names.push_back(backup.name());
    return names;
  }

  // Changes a byte in the middle of each file of a folder of the backups.
  void DamageFilesOf(const std::string& folder) const {
    const auto path = std::filesystem::path(options_.backup_dir) / folder;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
      const auto middle = static_cast<std::streamoff>(entry.file_size() / 2);
      file.seekg(middle);
      const int before = file.get();
      file.seekp(middle);
      file.put(static_cast<char>(~before));
    }
  }

  // Changes the files that only this backup has.
  void Damage(int id) const { DamageFilesOf("private/" + std::to_string(id)); }
};

}  // namespace graspdb::testing
