#include <fstream>

#include "tests/server/http/running_service.h"

namespace parkade {
namespace {

class Pictures : public RunningService {
 protected:
  /// A drive whose log tells the process that reads it what to do.
  std::string Drive(const std::string& todo = "", const std::string& job = "ok") {
    const Json done = MapNow("log " + job + "\nclean\n" + todo + "\n");
    id_ = done.at("drives").at(0);
    return "/api/v1/drives/" + id_;
  }
  /// What processes that read pictures were asked: "open" or the picture's time.
  std::vector<std::string> Asked() const {
    std::ifstream stream(options_.data / "pictures" / id_ / "log" / "asked");
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }

  std::string id_;
};

TEST_F(Pictures, TheNearestImageIsSent) {
  const std::string drive = Drive();
  const auto answer = client().Get(drive + "/images/cam0?time=12.34&width=64");

  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->status, 200) << answer->body;
  EXPECT_EQ(answer->body, "JPEG 64");
  EXPECT_EQ(answer->get_header_value("Content-Type"), "image/jpeg");
  EXPECT_EQ(answer->get_header_value("Picture-Time"), "12.300000000");
  EXPECT_EQ(answer->get_header_value("Picture-Size"), "64x40");
  EXPECT_EQ(answer->get_header_value("Picture-Full-Size"), "640x400");
  EXPECT_EQ(answer->get_header_value("Cache-Control"), "private, no-store");
}

TEST_F(Pictures, OneProcessReadsThemAndEachOnlyOnce) {
  const std::string drive = Drive();
  for (const char* time : {"12.34", "12.3", "15", "12.26"})
    EXPECT_EQ(client().Get(drive + "/images/cam0?time=" + time)->status, 200);

  EXPECT_EQ(Asked(), (std::vector<std::string>{"open", "12300000000", "15000000000"}));
}

TEST_F(Pictures, AreKeptOverARestart) {
  const std::string address = Drive() + "/images/cam0?time=12.34";
  EXPECT_EQ(client().Get(address)->status, 200);
  StopService();
  client_.reset();

  Start();

  EXPECT_EQ(client().Get(address)->body, "JPEG 0");
  EXPECT_EQ(Asked(), (std::vector<std::string>{"open", "12300000000"}));
}

TEST_F(Pictures, AreDeletedWithTheirDrive) {
  const std::string drive = Drive();
  EXPECT_EQ(client().Get(drive + "/images/cam0?time=12")->status, 200);
  EXPECT_TRUE(std::filesystem::exists(options_.data / "pictures" / id_));

  EXPECT_EQ(client().Delete(drive)->status, 204);

  EXPECT_FALSE(std::filesystem::exists(options_.data / "pictures" / id_));
  ExpectProblem(client().Get(drive + "/images/cam0?time=12"), 404, "not_found");
}

TEST_F(Pictures, OutsideOfTheDriveAreThereForASecond) {
  const std::string drive = Drive();

  EXPECT_EQ(client().Get(drive + "/images/cam0?time=20.9")->get_header_value("Picture-Time"),
            "20.000000000");
  EXPECT_EQ(client().Get(drive + "/images/cam0?time=9.1")->status, 200);
  ExpectProblem(client().Get(drive + "/images/cam0?time=21.1"), 404, "not_found");
  ExpectProblem(client().Get(drive + "/images/cam0?time=0"), 404, "not_found");
}

TEST_F(Pictures, SayWhatIsWrong) {
  const std::string drive = Drive();

  ExpectProblem(client().Get("/api/v1/drives/0123456789abcdef/images/cam0?time=1"), 404,
                "not_found");
  ExpectProblem(client().Get(drive + "/images/cam7?time=12"), 404, "not_found");
  ExpectProblem(client().Get(drive + "/images/cam0"), 400, "invalid_input");
  ExpectProblem(client().Get(drive + "/images/cam0?time=noon"), 400, "invalid_input");
  for (const char* width : {"0", "15", "8193", "-64", "x"})
    ExpectProblem(client().Get(drive + "/images/cam0?time=12&width=" + width), 400,
                  "invalid_input");
  for (const char* point : {"", "1,2", "1,2,3,4", "1,2,nan", "a,b,c", "1, 2,3"})
    ExpectProblem(client().Get(drive + "/images?point=" + point), 400, "invalid_input");
  ExpectProblem(client().Get(drive + "/images?point=1,2,3&limit=0"), 400, "invalid_input");
}

TEST_F(Pictures, ALogWithoutImagesSaysSo) {
  const auto answer = client().Get(Drive("no-images") + "/images/cam0?time=12");

  ExpectProblem(answer, 404, "not_found");
  EXPECT_EQ(Json::parse(answer->body).at("detail"), "the log has no image of any camera");
}

TEST_F(Pictures, ADamagedImageSaysSoAndTheNextOneIsRead) {
  const std::string drive = Drive("dark");
  for (const char* time : {"12", "13"})
    ExpectProblem(client().Get(drive + "/images/cam0?time=" + time), 404, "not_found");

  EXPECT_EQ(Asked().size(), 3u) << "one process for both";
}

TEST_F(Pictures, ACrashHurtsNobodyElse) {
  const std::string bad = Drive("crash"), good = Drive();
  ExpectProblem(client().Get(bad + "/images/cam0?time=12"), 500, "internal");

  EXPECT_EQ(client().Get(good + "/images/cam0?time=12")->status, 200);
  ExpectProblem(client().Get(bad + "/images/cam0?time=13"), 500, "internal");
}

TEST_F(Pictures, WhoLooksIsWrittenDownOnceAnHour) {
  const std::string drive = Drive();
  for (const char* time : {"12", "13", "14"})
    EXPECT_EQ(client().Get(drive + "/images/cam0?time=" + time)->status, 200);

  int looks = 0;
  const Json audit = Get("/api/v1/audit");
  for (const Json& entry : audit.at("items"))
    if (entry.at("action") == "pictures.see" && entry.at("subject") == id_) ++looks;
  EXPECT_GE(looks, 1);
  EXPECT_LE(looks, 2) << "two where the hour struck in between";
}

TEST_F(Pictures, OfADriveWithoutAMapAreThere) {
  EXPECT_EQ(client().Get(Drive("", "bad-input") + "/images/cam0?time=12")->status, 200);
}

TEST_F(Pictures, ViewsOfAPointNeedAMap) {
  const Json found = Get(Drive() + "/images?point=1,-2.5,0");
  EXPECT_EQ(found.at("version"), 1);
  EXPECT_EQ(found.at("views").at(0).at("camera"), "cam0");
  const std::string url = found.at("views").at(0).at("url");
  EXPECT_EQ(client().Get(url)->get_header_value("Picture-Time"), "12.300000000");

  ExpectProblem(client().Get(Drive("", "bad-input") + "/images?point=1,2,3"), 409, "conflict");
}

TEST_F(Pictures, ThatNobodyWaitsForAreNotReadAndLeaveRoom) {
  options_.pictures.answer_limit = std::chrono::seconds(3);
  const std::string hangs = Drive("hang"), other = Drive("hang"), good = Drive();
  // Two processes hang; whoever comes then gives up.
  std::vector<std::thread> clients;
  for (int i = 0; i < 12; ++i)
    clients.emplace_back([this, address = (i % 2 == 0 ? hangs : other) +
                                          "/images/cam0?time=" + std::to_string(10 + i / 2)] {
      DescribedClient impatient("127.0.0.1", service_->port());
      impatient.set_read_timeout(1);
      EXPECT_FALSE(impatient.Get(address));
    });
  for (std::thread& thread : clients) thread.join();

  const std::vector<std::string> asked = Asked();
  EXPECT_LE(std::count(asked.begin(), asked.end(), "open"), 2);
  // The hanging ones end in time, and those who gave up hold no place before this one.
  Eventually([&] { return client().Get(good + "/images/cam0?time=12")->status == 200; });
  EXPECT_LE(Asked().size(), 6u) << "those that gave up while they waited were not begun";
}

TEST_F(Pictures, AreRefusedWhereNobodyReadsThem) {
  options_.pictures.command = nullptr;

  ExpectProblem(client().Get(Drive() + "/images/cam0?time=12"), 404, "not_found");
}

}  // namespace
}  // namespace parkade
