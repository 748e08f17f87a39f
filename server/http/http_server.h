#pragma once

#include <httplib.h>

#include "server/http/metrics.h"
#include "server/http/shutdown_signal.h"

namespace parkade {

/// cpp-httplib's server behind our own reading of requests (HttpConnection): it gets
/// to see only heads that are short, complete and checked.
class HttpServer : public httplib::Server {
 public:
  /// Requests have to name this machine as their Host, unless `any_host`.
  HttpServer(const ShutdownSignal& shutdown_signal, Metrics& metrics, int num_threads,
             bool any_host);
  ~HttpServer() override;

  /// Binds; port 0 takes a free one. Returns the port. Throws Error{kUsage} when
  /// the address is taken or not ours.
  int Bind(const std::string& host, int port);

 private:
  bool process_and_close_socket(socket_t socket) override;
  void Serve(socket_t socket);

  const ShutdownSignal& shutdown_signal_;
  Metrics& metrics_;
  const bool any_host_;
};

}  // namespace parkade
