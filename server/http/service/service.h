#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "server/http/serve_options.h"

namespace parkade {

/// The whole service in one object: store, worker processes, HTTP.
class Service {
 public:
  /// Locks the data directory, recovers what an earlier service left, binds and
  /// starts working. Throws as Serve does.
  explicit Service(const ServeOptions& options);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// "http://127.0.0.1:8080", with the port that was bound.
  const std::string& address() const;
  int port() const;

  /// Answers requests until Stop.
  void Run();

  /// `listener` is called once, from any thread, when the disk fails: the service only answers
  /// readers from then on, and should be ended. Set it before Run.
  void OnDiskFailure(std::function<void()> listener);
  bool has_disk_failed() const;

  /// Lets requests under way end within `patience`, ends workers and makes Run
  /// return. From any thread.
  void Stop(std::chrono::milliseconds patience);

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace parkade
