#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Inspection : public RunningService {
 protected:
  Json Uploaded(const std::string& content) { return Json::parse(Upload(content)->body); }
  std::string Address(const Json& uploaded) {
    return "/api/v1/drives/" + uploaded.at("drive").at("id").get<std::string>();
  }
  Json WaitForInspection(const std::string& address) {
    Eventually([&] { return client().Get(address + "/inspect")->status != 202; });
    return Get(address + "/inspect");
  }
};

TEST_F(Inspection, SaysWhatTheLogHolds) {
  const Json uploaded = Uploaded("log ok\nlossy\n");
  const Json found = WaitForInspection(Address(uploaded));

  EXPECT_EQ(found.at("state"), "lossy");
  EXPECT_EQ(found.at("name"), "a.bag");
  EXPECT_EQ(Get(Address(uploaded)).at("inspection"), "lossy");
  EXPECT_EQ(WaitForJob(uploaded.at("job").at("id")).at("state"), "done");
}

TEST_F(Inspection, ALogThatCannotBeMappedFailsItsJobBeforeItStarts) {
  const Json uploaded = Uploaded("log ok\nclean no rig: upload one\n");
  const Json job = WaitForJob(uploaded.at("job").at("id"));

  EXPECT_EQ(job.at("state"), "failed");
  EXPECT_EQ(job.at("attempts"), 0) << "no worker was started";
  EXPECT_EQ(job.at("error"), "no rig: upload one");
  EXPECT_EQ(job.at("error_code"), "invalid_input");
  const Json drive = Get(Address(uploaded));
  EXPECT_EQ(drive.at("state"), "failed");
  EXPECT_EQ(drive.at("inspection"), "unusable");
  EXPECT_EQ(Get(Address(uploaded) + "/inspect").at("missing").at(0), "no rig: upload one");
}

TEST_F(Inspection, WhatIsNoLogAtAllSaysSo) {
  const Json uploaded = Uploaded("log ok\nno-log\n");
  const Json job = WaitForJob(uploaded.at("job").at("id"));

  EXPECT_EQ(job.at("state"), "failed");
  EXPECT_TRUE(job.at("error").get<std::string>().ends_with(" is not a drive log"));
  EXPECT_EQ(client().Get(Address(uploaded) + "/inspect")->status, 404);
}

TEST_F(Inspection, ThatCrashesOrTalksNonsenseStopsNothing) {
  for (const std::string todo : {"crash", "nonsense"}) {
    const Json uploaded = Uploaded("log ok\n" + todo + "\n");

    EXPECT_EQ(WaitForJob(uploaded.at("job").at("id")).at("state"), "done");
    EXPECT_EQ(Get(Address(uploaded)).at("inspection"), "failed");
  }
}

TEST_F(Inspection, IsWaitedFor) {
  const Json uploaded = Uploaded("log ok\nslow\n");
  const auto answer = client().Get(Address(uploaded) + "/inspect");

  EXPECT_EQ(answer->status, 202);
  EXPECT_EQ(answer->get_header_value("Retry-After"), "1");
  EXPECT_EQ(Get("/api/v1/jobs/" + uploaded.at("job").at("id").get<std::string>()).at("state"),
            "queued");
  EXPECT_EQ(WaitForJob(uploaded.at("job").at("id")).at("state"), "done");
}

TEST_F(Inspection, GoesOnAfterARestart) {
  const Json uploaded = Uploaded("log ok\nslow\n");
  StopService();
  client_.reset();

  Start();

  EXPECT_EQ(WaitForInspection(Address(uploaded)).at("state"), "clean");
  EXPECT_EQ(WaitForJob(uploaded.at("job").at("id")).at("state"), "done");
}

TEST_F(Inspection, OfADriveThatNobodyLookedAtIsMadeWhenAskedFor) {
  const InspectCommand command = options_.inspect_command;
  options_.inspect_command = nullptr;
  const Json uploaded = Uploaded("log ok\n");
  WaitForJob(uploaded.at("job").at("id"));
  EXPECT_EQ(Get(Address(uploaded)).at("inspection"), nullptr);
  StopService();
  client_.reset();
  options_.inspect_command = command;
  Start();

  EXPECT_EQ(WaitForInspection(Address(uploaded)).at("state"), "clean");
  EXPECT_EQ(Get(Address(uploaded)).at("state"), "ready");
}

}  // namespace
}  // namespace parkade
