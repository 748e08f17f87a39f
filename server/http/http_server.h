#pragma once

#include <httplib.h>

#include <functional>

#include "server/http/lobby.h"
#include "server/http/metrics.h"
#include "server/http/request_pools.h"
#include "server/http/shutdown_signal.h"

namespace parkade {

/// cpp-httplib's routes behind our own reading of requests: connections wait in the Lobby, and a
/// thread of RequestPools is taken by requests whose heads are short, complete and checked.
class HttpServer : public httplib::Server {
 public:
  /// `num_threads` as RequestPools has it.
  HttpServer(const ShutdownSignal& shutdown_signal, Metrics& metrics, int num_threads,
             EntryRules rules);
  ~HttpServer() override;

  /// Binds and listens; port 0 takes a free one. Returns the port. Throws Error{kUsage} when
  /// the address is taken or not ours.
  int Bind(const std::string& host, int port);

  /// Answers until the shutdown signal, and then those who are here.
  void Run();

  /// Makes Run look at the shutdown signal. From any thread.
  void Wake() { lobby_.Wake(); }

 private:
  void Answer(HttpConnection& connection);

  const ShutdownSignal& shutdown_signal_;
  Metrics& metrics_;
  RequestPools pools_;
  Lobby lobby_;
};

}  // namespace parkade
