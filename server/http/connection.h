#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "server/http/metrics.h"
#include "server/http/pace_meter.h"
#include "server/http/request_head.h"
#include "server/http/shutdown_signal.h"
#include "server/http/trace/request_trace.h"

namespace parkade {

/// One client's socket. The lobby fills it until a request is whole; then it is the stream that the
/// HTTP library reads the request from and writes the answer to. What a client can cost is bounded
/// here, where the library has no bounds: bytes of a head, pace of bodies and answers. Never reads
/// past a request's body for the library. It belongs to one thread at a time.
class HttpConnection : public httplib::Stream {
 public:
  using Clock = std::chrono::steady_clock;

  /// Takes a socket that does not block over, and closes it in the end.
  HttpConnection(socket_t socket, const ShutdownSignal& shutdown_signal, Metrics& metrics);
  ~HttpConnection() override;

  // For the lobby: nothing waits.

  enum class Input { kSome, kNone, kEnd };

  /// Takes in what lies in the socket, at most 64 KiB; kEnd when nothing will come any more.
  Input Receive();
  /// [bytes] taken in and not used.
  size_t num_unread() const { return buffer_.size() - buffer_begin_; }
  /// Forgets what was taken in and not used, and gives its memory back.
  void DiscardUnread();
  /// Gives memory back that nothing lies in: an idle connection keeps none.
  void Rest() {
    if (num_unread() == 0) DiscardUnread();
  }

  /// Takes a whole head out of what came; nothing while there is none. Throws HttpError for one
  /// that is too long (431) or malformed.
  std::optional<RequestHead> TakeHead();
  /// Notes what the log says of a request. A proxy of this machine that was asked by the name
  /// `proxy_host` says who its client is.
  void BeginTrace(const RequestHead& head, const std::string& proxy_host);
  /// Sets what the library reads next: the head, then the body from the socket.
  void BeginRequest(const RequestHead& head, std::int64_t body_length);
  RequestTrace& trace() { return trace_; }
  /// Writes the line of the request into the access log, and forgets who asked.
  void LogRequest();
  std::int64_t body_length() const { return body_length_; }
  /// Requests begun so far.
  int num_requests() const { return num_requests_; }
  RouteClass route_class() const { return route_class_; }
  void set_route_class(RouteClass route_class) { route_class_ = route_class; }
  /// Whether somebody with an identity here sent the request, or the last one.
  bool is_known() const { return is_known_; }
  void set_is_known(bool is_known) { is_known_ = is_known; }
  Clock::time_point request_began() const { return request_began_; }

  /// Answers a request the library never sees, where the client takes answers at all, and says that
  /// nothing more comes. A client is asked to come back after `retry_after` seconds, unless 0.
  void SendProblem(const Problem& problem, int retry_after = 0);

  /// [bytes] of a short answer that the client has yet to take.
  size_t num_unsent() const { return rest_.size() - rest_begin_; }
  /// Sends of them what the client takes now; false when it is gone.
  bool SendRest();
  /// [bytes] kept for the client, in and out.
  std::int64_t num_held() const { return static_cast<std::int64_t>(num_unread() + num_unsent()); }

  // For the thread that answers.

  /// True when the library has read the whole body; otherwise what follows in the
  /// socket is not a request.
  bool IsBodyRead() const { return body_left_ == 0; }
  /// Says that nothing more comes.
  void FinishSending();
  void set_keeps_alive(bool keeps_alive) { keeps_alive_ = keeps_alive; }
  /// True when another request may follow.
  bool keeps_alive() const { return keeps_alive_; }

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* data, size_t size) override;
  /// Waits for the client only with long answers, those of downloads and events; of short ones it
  /// keeps what the client does not take.
  ssize_t write(const char* data, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

  // For any thread, while another answers.

  /// Ends reading and writing, because the client is too slow.
  void CutOff();
  bool is_cut_off() const { return is_cut_off_; }
  const PaceMeter& pace() const { return pace_; }

 private:
  /// What the log says of a request by its head.
  RequestTrace TraceOf(const RequestHead& head, const std::string& proxy_host) const;
  /// Waits until the client sends (POLLIN) or reads (POLLOUT); false when it is too slow and at the
  /// end of the service.
  bool AwaitClient(short events);
  /// Tells the meter what the client has taken of the answer.
  void CountTaken();

  const socket_t socket_;
  const ShutdownSignal& shutdown_signal_;
  Metrics& metrics_;
  const CountedPresence presence_;
  std::string buffer_;       ///< received and not yet used
  size_t buffer_begin_ = 0;  ///< what lies before is used
  size_t num_scanned_ = 0;   ///< unread bytes that hold no end of a head
  std::string head_text_;    ///< for the library to read first
  size_t head_begin_ = 0;
  std::string rest_;  ///< of a short answer
  size_t rest_begin_ = 0;
  std::int64_t body_left_ = 0, body_length_ = 0;
  std::int64_t num_sent_ = 0, num_taken_ = 0;  ///< bytes given to the kernel, and by the client
  int num_requests_ = 0;
  RouteClass route_class_ = RouteClass::kApi;
  bool keeps_alive_ = false, is_known_ = false;
  Clock::time_point request_began_ = Clock::now();
  RequestTrace trace_;
  std::int64_t num_sent_before_ = 0;  ///< bytes of the answers to earlier requests
  PaceMeter pace_;
  std::atomic<bool> is_cut_off_ = false;
};

}  // namespace parkade
