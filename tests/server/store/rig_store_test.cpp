#include "server/store/rig_store.h"

#include <archive.h>
#include <archive_entry.h>

#include "core/error.h"
#include "server/store/tables/rig_table.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

const RigFiles kRig = {{"camchain-imucam.yaml", "cam0: {}"},
                       {"imu0.yaml", "rostopic: /imu"},
                       {"vehicle.yaml", "wheelbase: 2.7"}};

/// A zip with entries as named, for names that PackRig would not write.
std::string ZipOf(const std::vector<std::pair<std::string, std::string>>& entries,
                  unsigned type = AE_IFREG) {
  std::string zip(1 << 20, '\0');
  size_t used = 0;
  archive* writer = archive_write_new();
  archive_write_set_format_zip(writer);
  archive_write_set_bytes_per_block(writer, 1);
  archive_write_open_memory(writer, zip.data(), zip.size(), &used);
  for (const auto& [name, content] : entries) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_filetype(entry, type);
    if (type == AE_IFLNK) archive_entry_set_symlink(entry, content.c_str());
    archive_entry_set_size(entry, type == AE_IFREG ? static_cast<la_int64_t>(content.size()) : 0);
    archive_entry_set_perm(entry, 0644);
    archive_write_header(writer, entry);
    if (type == AE_IFREG) archive_write_data(writer, content.data(), content.size());
    archive_entry_free(entry);
  }
  archive_write_close(writer);
  archive_write_free(writer);
  zip.resize(used);
  return zip;
}

using RigStore = StoreTest;

TEST(RigArchive, GivesBackWhatWasPackedByteForByte) {
  EXPECT_EQ(UnpackRig(PackRig(kRig)), kRig);
  EXPECT_EQ(PackRig(kRig), PackRig(kRig));
}

TEST(RigArchive, DropsTheFolderAroundTheFiles) {
  EXPECT_EQ(UnpackRig(ZipOf({{"my rig/imu0.yaml", "a"}})), (RigFiles{{"imu0.yaml", "a"}}));
}

TEST(RigArchive, RefusesWhatCouldLeadElsewhere) {
  for (const char* name : {"../imu0.yaml", "/imu0.yaml", "a/b/imu0.yaml", "a/../imu0.yaml",
                           ".imu0.yaml", "imu 0.yaml"})
    EXPECT_THROW(UnpackRig(ZipOf({{name, "a"}})), Error) << name;
  EXPECT_THROW(UnpackRig(ZipOf({{"imu0.yaml", "/etc/passwd"}}, AE_IFLNK)), Error);
  EXPECT_THROW(UnpackRig(ZipOf({{"imu0.yaml", "a"}, {"x/imu0.yaml", "b"}})), Error);
}

TEST(RigArchive, RefusesWhatIsNoZip) {
  EXPECT_THROW(UnpackRig("certainly not"), Error);
  EXPECT_THROW(UnpackRig(ZipOf({{"bomb.yaml", std::string(kMaxRigBytes + 1, '\0')}})), Error);
  EXPECT_THROW(UnpackRig(""), Error);
  const std::string zip = PackRig(kRig);
  EXPECT_THROW(UnpackRig(zip.substr(0, 20)), Error);
}

TEST_F(RigStore, KeepsTheNewestRevisionOfAName) {
  StoreRig(store_, "car", kRig, nullptr);
  RigFiles changed = kRig;
  changed["vehicle.yaml"] = "wheelbase: 3.1";
  const StoredRig second = StoreRig(store_, "car", changed, nullptr);
  StoreRig(store_, "van", kRig, nullptr);

  const auto found =
      store_.database.Read([](Connection& connection) { return FindRig(connection, "car"); });
  EXPECT_EQ(found->id, second.id);
  EXPECT_EQ(UnpackRig(ReadRigArchive(store_, *found)), changed);
  const auto all =
      store_.database.Read([](Connection& connection) { return ListRigs(connection, {}); });
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "van");
}

TEST_F(RigStore, WhatKalibrWroteGetsItsUsualNames) {
  const RigFiles kalibrs = {{"drive-camchain-imucam.yaml", kRig.at("camchain-imucam.yaml")},
                            {"drive-imu.yaml", kRig.at("imu0.yaml")},
                            {"vehicle.yaml", kRig.at("vehicle.yaml")}};

  const StoredRig rig = StoreRig(store_, "car", kalibrs, nullptr);

  EXPECT_EQ(UnpackRig(ReadRigArchive(store_, rig)), kRig);
}

TEST_F(RigStore, BasaltsFileStandsForTwoOfTheThree) {
  const StoredRig rig =
      StoreRig(store_, "audi",
               {{"euroc_calib.json", "{}"}, {"vehicle.yaml", kRig.at("vehicle.yaml")}}, nullptr);

  EXPECT_EQ(rig.files, (std::vector<std::string>{"calibration.json", "vehicle.yaml"}));
  EXPECT_THROW(StoreRig(store_, "bmw", {{"calibration.json", "{}"}}, nullptr), Error);
}

TEST_F(RigStore, ARefusedRigLeavesNothing) {
  RigFiles incomplete = kRig;
  incomplete.erase("imu0.yaml");
  EXPECT_THROW(StoreRig(store_, "car", incomplete, nullptr), Error);
  EXPECT_THROW(StoreRig(store_, "../car", kRig, nullptr), Error);
  const auto refuse = [](const std::filesystem::path&) {
    throw Error(ErrorCode::kInvalidInput, "no such lens");
  };
  EXPECT_THROW(StoreRig(store_, "car", kRig, refuse), Error);

  EXPECT_TRUE(ContentOf(store_.directory.RigsFolder()).empty());
  EXPECT_TRUE(ContentOf(store_.directory.root() / "tmp").empty());
}

}  // namespace
}  // namespace parkade
