// The service as a process of its own: killed, started again, started twice.

#include <sys/un.h>

#include <atomic>
#include <optional>

#include "core/files/file.h"
#include "tests/server/http/raw_client.h"
#include "tests/server/http/service_process.h"

namespace parkade {
namespace {

class Restart : public testing::Test {
 protected:
  static Json Parsed(const httplib::Result& answer) {
    EXPECT_TRUE(answer);
    return answer ? Json::parse(answer->body) : Json();
  }
  static std::string StateOf(httplib::Client& client, const std::string& job) {
    return Parsed(client.Get("/api/v1/jobs/" + job)).at("state");
  }
  static std::string Upload(httplib::Client& client, const std::string& content) {
    const auto answer = client.Put("/api/v1/drives?site=lot&filename=a.bag", content, kLogType);
    EXPECT_EQ(answer->status, 201) << answer->body;
    return Parsed(answer).at("job").at("id");
  }

  TemporaryRoot root_;
  /// Words before the service's, so that its data lie on a filesystem of its own; nothing where
  /// there is no right to mount one.
  std::optional<std::vector<std::string>> OnASmallDisk(const std::string& mount) {
    std::filesystem::create_directories(data_);
    const std::string probe =
        "unshare --map-root-user --mount mount -t tmpfs tmpfs " + data_.string() + " 2>/dev/null";
    if (std::system(probe.c_str()) != 0) return std::nullopt;
    return std::vector<std::string>{
        "unshare", "--map-root-user", "--mount", "sh", "-c", mount + " \"$3\" && exec \"$@\" 2>&1",
        "sh"};
  }
  /// The data directory as the service sees it.
  std::filesystem::path Inside(const ServiceProcess& service) const {
    return std::filesystem::path("/proc") / std::to_string(service.pid()) / "root" /
           data_.relative_path();
  }

  std::filesystem::path data_ = root_.path() / "data";
};

TEST_F(Restart, AfterAKillMidUploadFindsNothingHalfWritten) {
  {
    ServiceProcess service(data_);
    RawClient raw(service.Port());
    raw.Send(
        "PUT /api/v1/drives?site=lot HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
        "90000000\r\n\r\nlog ok\n" +
        std::string(5'000'000, 'x'));
    Eventually([&] { return !std::filesystem::is_empty(data_ / "tmp"); });
    service.End(SIGKILL);
  }
  ServiceProcess service(data_);
  DescribedClient client("127.0.0.1", service.Port());

  EXPECT_TRUE(Parsed(client.Get("/api/v1/drives")).at("items").empty());
  for (const char* folder : {"tmp", "logs", "maps", "quarantine"})
    EXPECT_TRUE(std::filesystem::is_empty(data_ / folder)) << folder;
}

TEST_F(Restart, AfterAKillMidJobDoesTheJobAgain) {
  std::string job;
  {
    ServiceProcess service(data_);
    DescribedClient client("127.0.0.1", service.Port());
    job = Upload(client, "log slow\n");
    Eventually([&] { return StateOf(client, job) == "running"; });
    Eventually([&] {
      return std::filesystem::exists(data_ / "jobs" / job / "worker/attempt-1/progress.ndjson");
    });
    service.End(SIGKILL);
  }
  ServiceProcess service(data_);
  DescribedClient client("127.0.0.1", service.Port());

  Eventually([&] { return StateOf(client, job) == "done"; });
  const Json found = Parsed(client.Get("/api/v1/jobs/" + job));
  EXPECT_EQ(found.at("attempts"), 2);
  EXPECT_EQ(found.at("map_version"), 1);
  EXPECT_EQ(client.Get("/api/v1/sites/lot/maps/1/map.glb")->status, 200);
  // A job is done before its folder is tidied up.
  Eventually([&] { return !std::filesystem::exists(data_ / "jobs" / job / "worker"); });
}

TEST_F(Restart, ACrashedJobWaitsOnAfterAKill) {
  std::string job, not_before;
  {
    ::setenv("CRASH_PAUSE", "3600", 1);
    ServiceProcess service(data_);
    DescribedClient client("127.0.0.1", service.Port());
    job = Upload(client, "log crash\n");
    Eventually([&] {
      const Json found = Parsed(client.Get("/api/v1/jobs/" + job));
      const bool waits = found.at("state") == "queued" && found.at("not_before").is_string();
      if (waits) not_before = found.at("not_before");
      return waits;
    });
    service.End(SIGKILL);
  }
  ServiceProcess service(data_);
  ::unsetenv("CRASH_PAUSE");
  DescribedClient client("127.0.0.1", service.Port());
  EXPECT_EQ(Parsed(client.Get("/api/v1/jobs/" + job)).at("not_before"), not_before);
  EXPECT_EQ(Parsed(client.Get("/api/v1/jobs/" + job)).at("attempts"), 1);

  EXPECT_EQ(client.Post("/api/v1/jobs/" + job + "/retry", "", "application/json")->status, 202);
  Eventually(
      [&] { return Parsed(client.Get("/api/v1/jobs/" + job)).at("attempts").get<int>() == 2; });
}

TEST_F(Restart, LosesNoJobHoweverOftenTheServiceIsKilled) {
  std::string job;
  for (int life = 1; life <= 4; ++life) {
    ServiceProcess service(data_);
    DescribedClient client("127.0.0.1", service.Port());
    if (life == 1) job = Upload(client, "log hang\n");
    Eventually([&] { return StateOf(client, job) == "running"; });
    service.End(SIGKILL);
  }
  ServiceProcess service(data_);
  DescribedClient client("127.0.0.1", service.Port());

  Eventually([&] { return StateOf(client, job) == "running"; });
  const std::string drive = Parsed(client.Get("/api/v1/jobs/" + job)).at("drives").at(0);
  EXPECT_EQ(Parsed(client.Get("/api/v1/drives/" + drive)).at("state"), "processing");
}

TEST_F(Restart, KeepsEveryAcknowledgedUploadThroughManyKills) {
  std::set<std::string> acknowledged;
  for (int life = 0; life < 10; ++life) {
    ServiceProcess service(data_);
    const int port = service.Port();
    std::atomic<int> answers{0};
    std::thread killer([&] {
      Eventually([&] { return answers >= 2; });
      std::this_thread::sleep_for(std::chrono::milliseconds(7 * life));
      ::kill(service.pid(), SIGKILL);
    });
    DescribedClient client("127.0.0.1", port);
    for (int i = 0; i < 1000; ++i) {
      const auto answer =
          client.Put("/api/v1/drives?site=lot", "log ok " + std::to_string(i % 7) + "\n", kLogType);
      if (!answer) break;
      if (answer->status == 201)
        acknowledged.insert(Json::parse(answer->body).at("drive").at("id"));
      ++answers;
    }
    killer.join();
    service.Wait();
  }
  ServiceProcess service(data_);
  DescribedClient client("127.0.0.1", service.Port());

  EXPECT_GT(acknowledged.size(), 10u);
  for (const std::string& id : acknowledged)
    EXPECT_EQ(client.Get("/api/v1/drives/" + id)->status, 200) << id;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_ / "logs"))
    if (entry.is_regular_file()) {
      EXPECT_EQ(Sha256Of(ReadFile(entry.path())), entry.path().filename().string());
    }
}

TEST_F(Restart, ASecondServiceOnTheSameDataEndsAtOnceWithASentence) {
  ServiceProcess first(data_);
  first.Port();
  const auto began = std::chrono::steady_clock::now();

  ServiceProcess second(data_);
  const int status = second.Wait();

  EXPECT_LT(std::chrono::steady_clock::now() - began,
            std::chrono::seconds(10));  // and does not wait for the first
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(second.Said().find("another service already uses the data directory"),
            std::string::npos);
}

TEST_F(Restart, SigtermLetsAnUploadEndAndPutsTheJobBack) {
  ServiceProcess service(data_);
  DescribedClient client("127.0.0.1", service.Port());
  const std::string job = Upload(client, "log stubborn\n");
  Eventually([&] { return StateOf(client, job) == "running"; });
  RawClient raw(service.Port());
  raw.Send(
      "PUT /api/v1/drives?site=lot HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100007\r\n\r\n"
      "log ok\n" +
      std::string(99'990, 'x'));
  Eventually([&] { return !std::filesystem::is_empty(data_ / "tmp"); });

  ::kill(service.pid(), SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  raw.Send("the rest.\n");

  EXPECT_EQ(StatusOf(raw.ReceiveUntil("\"job\"")), 201);
  EXPECT_EQ(service.Wait(), 0) << service.Said();
  ServiceProcess again(data_);
  DescribedClient other("127.0.0.1", again.Port());
  EXPECT_EQ(Parsed(other.Get("/api/v1/drives")).at("items").size(), 2u);
  EXPECT_EQ(Parsed(other.Get("/api/v1/jobs/" + job)).at("error_code"), nullptr);
  other.Post("/api/v1/jobs/" + job + "/cancel", "", "application/json");
}

TEST_F(Restart, AnAddressThatIsNotLoopbackIsRefused) {
  ServeOptions options = FakeServeOptions(SERVE_PROGRAM, data_);
  options.listen = "0.0.0.0:0";
  try {
    Service service(options);
    FAIL() << "listens to everybody";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_NE(std::string(error.what()).find("--allow-public"), std::string::npos);
  }
  EXPECT_FALSE(std::filesystem::exists(data_)) << "refused before anything is made";
}

TEST_F(Restart, ATakenPortIsRefused) {
  ServeOptions options = FakeServeOptions(SERVE_PROGRAM, data_);
  const Service first(options);
  options.data = root_.path() / "other";
  options.listen = "127.0.0.1:" + std::to_string(first.port());

  EXPECT_THROW(Service{options}, Error);
}

// What systemd is told (sd_notify(3)), and how it hears that a service hangs.
TEST_F(Restart, TheSupervisorHearsHowTheServiceIs) {
  const std::string name = (root_.path() / "notify").string();
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  const auto heard = [&](int milliseconds) {
    pollfd wanted{fd, POLLIN, 0};
    std::string text(4096, '\0');
    if (::poll(&wanted, 1, milliseconds) <= 0) return std::string();
    text.resize(static_cast<size_t>(std::max<ssize_t>(::recv(fd, text.data(), text.size(), 0), 0)));
    return text;
  };
  ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  ::setenv("WATCHDOG_USEC", "300000", 1);
  ServiceProcess service(data_);
  ::unsetenv("NOTIFY_SOCKET");
  ::unsetenv("WATCHDOG_USEC");

  EXPECT_TRUE(heard(60'000).starts_with("READY=1\n"));
  EXPECT_EQ(heard(60'000), "WATCHDOG=1");
  ::kill(service.pid(), SIGSTOP);
  while (!heard(1000).empty()) {
  }
  EXPECT_EQ(heard(1000), "") << "a service that hangs says nothing";
  ::kill(service.pid(), SIGCONT);
  ::kill(service.pid(), SIGTERM);
  std::string last;
  while (last != "STOPPING=1" && !(last = heard(60'000)).empty()) {
  }
  EXPECT_EQ(last, "STOPPING=1");
  service.Wait();
  ::close(fd);
}

// A filesystem of 12 MiB in a namespace of its own. Needs the right to make one.
TEST_F(Restart, AFullDiskIsSaidAndLeavesNothingHalfWritten) {
  const auto wrapper = OnASmallDisk("mount -t tmpfs -o size=12m tmpfs");
  if (!wrapper) GTEST_SKIP() << "no right to mount a small filesystem here";

  // Without the look at the free space beforehand: the disk itself is to say no.
  ::setenv("RESERVE", "-1000000000", 1);
  ServiceProcess service(data_, *wrapper);
  ::unsetenv("RESERVE");
  DescribedClient client("127.0.0.1", service.Port());
  client.set_read_timeout(60);
  const std::string large = "log ok\n" + std::string(20'000'000, 'x');
  const auto refused = client.Put("/api/v1/drives?site=lot", large, kLogType);
  ExpectProblem(refused, 507, "disk_full");

  // It goes on, without a restart.
  EXPECT_EQ(client.Put("/api/v1/drives?site=lot", "log ok\n", kLogType)->status, 201);
  EXPECT_EQ(Parsed(client.Get("/api/v1/drives")).at("items").size(), 1u);
  Eventually([&] { return std::filesystem::is_empty(Inside(service) / "tmp"); });
  service.End(SIGTERM);
}

// The disk of a service that was killed is filled to the last byte before the next one starts.
TEST_F(Restart, AServiceStartsOnAFullDiskAndDeletes) {
  const auto wrapper = OnASmallDisk(
      "fill() { dd if=/dev/zero of=\"$1/filling\" bs=64k 2>/dev/null; "
      "dd if=/dev/zero of=\"$1/crumbs\" bs=1 2>/dev/null; :; }; "
      "mount -t tmpfs -o size=320m tmpfs \"$3\" && ( timeout -s KILL 12 \"$@\"; fill \"$3\" ); :");
  if (!wrapper) GTEST_SKIP() << "no right to mount a small filesystem here";
  ::setenv("RESERVE", "100000000", 1);
  ServiceProcess service(data_, *wrapper);
  ::unsetenv("RESERVE");
  std::string drive;
  {
    DescribedClient client("127.0.0.1", service.Port());
    const Json answer = Parsed(
        client.Put("/api/v1/drives?site=lot", "log ok\n" + std::string(5'000'000, 'x'), kLogType));
    drive = answer.at("drive").at("id");
  }
  // The second start says its own address.
  std::string said;
  Eventually([&] {
    said = service.Said();
    return said.find("listening") != said.rfind("listening") || service.HasEnded();
  });
  ASSERT_NE(said.find("listening"), said.rfind("listening")) << said;
  DescribedClient client("127.0.0.1", std::stoi(said.substr(said.rfind(':') + 1)));
  EXPECT_EQ(client.Get("/readyz")->status, 503);
  ExpectProblem(client.Put("/api/v1/drives?site=lot", "log ok\n", kLogType), 507, "disk_full");

  Eventually(
      [&] { return Parsed(client.Get("/api/v1/drives/" + drive)).at("state") != "processing"; });
  EXPECT_EQ(client.Delete("/api/v1/drives/" + drive)->status, 204)
      << client.Get("/api/v1/jobs")->body << service.Said();
  EXPECT_EQ(client.Get("/api/v1/drives/" + drive)->status, 404);
}

}  // namespace
}  // namespace parkade
