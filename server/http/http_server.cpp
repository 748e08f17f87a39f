#include "server/http/http_server.h"

#include <netinet/tcp.h>
#include <unistd.h>

#include <chrono>

#include "core/error.h"
#include "core/log.h"
#include "server/http/connection.h"
#include "server/http/connection_queue.h"
#include "server/http/current_socket.h"
#include "server/http/host_check.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

constexpr auto kFirstRequestPatience = 10s;
constexpr auto kKeepAlivePatience = 5s;
constexpr int kMaxRequestsPerConnection = 1000;
constexpr size_t kMaxWaitingConnections = 256;
constexpr int kBacklog = 512;

}  // namespace

HttpServer::HttpServer(const ShutdownSignal& shutdown_signal, Metrics& metrics, int num_threads,
                       bool any_host)
    : shutdown_signal_(shutdown_signal), metrics_(metrics), any_host_(any_host) {
  new_task_queue = [num_threads] {
    return new ConnectionQueue(num_threads, kMaxWaitingConnections);
  };
  // Not SO_REUSEPORT, the library's default: two services would share a port.
  set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  set_tcp_nodelay(true);
  set_keep_alive_max_count(kMaxRequestsPerConnection);  // for the header it announces
  set_keep_alive_timeout(std::chrono::seconds(kKeepAlivePatience).count());
}

HttpServer::~HttpServer() {
  // The library closes the socket only when it has served.
  if (const socket_t socket = svr_sock_.exchange(INVALID_SOCKET); socket != INVALID_SOCKET)
    ::close(socket);
}

int HttpServer::Bind(const std::string& host, int port) {
  const bool is_bound = port == 0 ? (port = bind_to_any_port(host)) > 0 : bind_to_port(host, port);
  Require(is_bound, ErrorCode::kUsage,
          "cannot listen on " + host + " port " + std::to_string(port) +
              ": it is taken or not an address of this machine");
  ::listen(svr_sock_, kBacklog);  // the library asks for 5
  return port;
}

bool HttpServer::process_and_close_socket(socket_t socket) {
  const CountedPresence presence(metrics_.connections);
  try {
    Serve(socket);
  } catch (const std::exception& error) {
    LogError(std::string("connection exception=") + error.what());
  }
  ::close(socket);
  return true;
}

void HttpServer::Serve(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  HttpConnection connection(socket, shutdown_signal_);
  if (ConnectionQueue::is_refusing()) {
    ++metrics_.connections_refused;
    connection.SendProblem({503, "busy", "too many connections: try again in a moment"});
    return;
  }
  for (int count = 1; count <= kMaxRequestsPerConnection; ++count) {
    try {
      const auto head =
          connection.ReadHead(count == 1 ? kFirstRequestPatience : kKeepAlivePatience);
      if (!head) break;
      const std::int64_t body_length = CheckRequestHead(*head);
      if (!any_host_) RefuseForeignHost(*head);
      connection.BeginRequest(ToText(*head, body_length), body_length);
    } catch (const HttpError& error) {
      ++metrics_.requests_refused;
      connection.SendProblem(error.problem());
      break;
    }
    const bool is_last = count == kMaxRequestsPerConnection || shutdown_signal_.is_stopping();
    bool is_closed = false;
    CurrentSocket() = socket;
    const bool is_answered = process_request(connection, is_last, is_closed, nullptr);
    CurrentSocket() = -1;
    if (!is_answered || is_closed || is_last || !connection.IsBodyRead()) break;
  }
  connection.FinishSending();
}

}  // namespace parkade
