#pragma once

#include <gtest/gtest.h>
#include <httplib.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "server/http/service/service.h"
#include "tests/server/http/described_answer.h"
#include "tests/server/http/fake_worker.h"
#include "tests/server/store/temporary_store.h"

namespace parkade {

using Json = nlohmann::json;

inline const std::string kLogType = "application/octet-stream";

/// Waits for `probe` to become true; fails the test after a minute (a busy disk may take 20 s to
/// sync).
template <typename Probe>
bool Eventually(const Probe& probe) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < end) {
    if (probe()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ADD_FAILURE() << "waited for a minute in vain";
  return false;
}

/// A real service on a free port of this machine, talked to over HTTP. Options
/// may be changed before Start().
class RunningService : public testing::Test {
 protected:
  ~RunningService() override { StopService(); }

  void Start() {
    service_.emplace(options_);
    thread_ = std::thread([this] { service_->Run(); });
    client_.emplace("127.0.0.1", service_->port());
    client_->set_read_timeout(60);
    Eventually([&] { return static_cast<bool>(client_->Get("/healthz")); });
  }
  void StopService() {
    if (!service_) return;
    service_->Stop(std::chrono::milliseconds(500));
    thread_.join();
    service_.reset();
  }

  httplib::Client& client() {
    if (!client_) Start();
    return *client_;
  }

  httplib::Result Upload(const std::string& content,
                         const std::string& query = "?filename=a.bag&site=lot") {
    return client().Put("/api/v1/drives" + query, content, kLogType);
  }
  Json Get(const std::string& path) {
    const auto answer = client().Get(path);
    EXPECT_TRUE(answer) << path;
    if (!answer) return nullptr;
    EXPECT_EQ(answer->status, 200) << path << ": " << answer->body;
    return Json::parse(answer->body, nullptr, false);
  }
  /// Waits until the job of an accepted upload has one of the states.
  Json WaitForJob(const std::string& id, const std::string& states = "done failed cancelled") {
    Json job;
    Eventually([&] {
      job = Get("/api/v1/jobs/" + id);
      return states.find(job.at("state").get<std::string>()) != std::string::npos;
    });
    return job;
  }
  /// Uploads and waits for the end of its job.
  Json MapNow(const std::string& content, const std::string& query = "?filename=a.bag&site=lot") {
    const auto answer = Upload(content, query);
    EXPECT_EQ(answer->status, 201) << answer->body;
    return WaitForJob(Json::parse(answer->body).at("job").at("id"));
  }

  /// Files in the data directory, without the database.
  std::set<std::string> Files() const {
    std::set<std::string> files;
    for (const std::string& name : ContentOf(options_.data))
      if (!name.ends_with('/') && !name.starts_with("db/") && name != "LOCK") files.insert(name);
    return files;
  }

  TemporaryRoot root_;
  ServeOptions options_ = FakeServeOptions(SERVE_PROGRAM, root_.path() / "data");
  std::optional<Service> service_;
  std::thread thread_;
  std::optional<DescribedClient> client_;
};

/// An answer as RFC 9457 wants it.
inline void ExpectProblem(const httplib::Result& answer, int status, const std::string& code) {
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, status) << answer->body;
  EXPECT_EQ(answer->get_header_value("Content-Type"), "application/problem+json");
  const Json problem = Json::parse(answer->body, nullptr, false);
  ASSERT_TRUE(problem.is_object()) << answer->body;
  EXPECT_EQ(problem.at("status"), status);
  EXPECT_EQ(problem.at("code"), code);
  EXPECT_TRUE(problem.at("type").is_string());
  EXPECT_FALSE(problem.at("title").get<std::string>().empty());
  EXPECT_FALSE(problem.at("detail").get<std::string>().empty());
}

}  // namespace parkade
