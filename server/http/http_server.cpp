#include "server/http/http_server.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "core/error.h"
#include "core/log.h"
#include "server/http/current_socket.h"

namespace parkade {
namespace {

constexpr int kMaxRequestsPerConnection = 1000;
constexpr int kBacklog = 512;

/// What this thread answers, while it does.
thread_local HttpConnection* current = nullptr;

/// Half of the file descriptors are left to those who answer.
LobbyLimits LimitsHere() {
  LobbyLimits limits;
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) == 0)
    limits.max_connections =
        std::min<size_t>(limits.max_connections, std::max<size_t>(files.rlim_cur / 2, 16));
  return limits;
}

}  // namespace

HttpServer::HttpServer(const ShutdownSignal& shutdown_signal, Metrics& metrics, int num_threads,
                       EntryRules rules)
    : shutdown_signal_(shutdown_signal),
      metrics_(metrics),
      pools_(num_threads,
             {[this](HttpConnection& connection) { Answer(connection); },
              [this](std::unique_ptr<HttpConnection> connection) {
                lobby_.Return(std::move(connection));
              }},
             metrics),
      lobby_(LimitsHere(), std::move(rules), pools_, shutdown_signal, metrics) {
  // Not SO_REUSEPORT, the library's default: two services would share a port.
  set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  set_post_routing_handler([](const httplib::Request&, httplib::Response& response) {
    current->trace().status = response.status;
    response.set_header(kRequestIdField, current->trace().id);
  });
  // The header that the library announces.
  set_keep_alive_max_count(kMaxRequestsPerConnection);
  set_keep_alive_timeout(
      std::chrono::duration_cast<std::chrono::seconds>(LobbyLimits().next_request).count());
}

HttpServer::~HttpServer() {
  pools_.Join();  // they hand connections back to the lobby
  if (const socket_t socket = svr_sock_.exchange(INVALID_SOCKET); socket != INVALID_SOCKET)
    ::close(socket);
}

int HttpServer::Bind(const std::string& host, int port) {
  const bool is_bound = port == 0 ? (port = bind_to_any_port(host)) > 0 : bind_to_port(host, port);
  Require(is_bound, ErrorCode::kUsage,
          "cannot listen on " + host + " port " + std::to_string(port) +
              ": it is taken or not an address of this machine");
  ::listen(svr_sock_, kBacklog);  // the library asks for 5
  ::fcntl(svr_sock_, F_SETFL, ::fcntl(svr_sock_, F_GETFL) | O_NONBLOCK);
  return port;
}

void HttpServer::Run() {
  lobby_.Run(svr_sock_);
  pools_.Join();
}

void HttpServer::Answer(HttpConnection& connection) {
  const bool is_last =
      connection.num_requests() == kMaxRequestsPerConnection || shutdown_signal_.is_stopping();
  bool is_closed = false;
  current = &connection;
  CurrentSocket() = connection.socket();
  bool is_answered = false;
  {
    const LogContext context(LogFields{{"request", connection.trace().id}});
    is_answered = process_request(connection, is_last, is_closed, nullptr);
  }
  CurrentSocket() = -1;
  current = nullptr;
  metrics_.of(connection.route_class())
      .durations.Add(HttpConnection::Clock::now() - connection.request_began());
  connection.LogRequest();  // after the metrics: it forgets when the request began
  connection.set_keeps_alive(is_answered && !is_closed && !is_last && connection.IsBodyRead());
}

}  // namespace parkade
