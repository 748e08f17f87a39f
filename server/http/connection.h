#pragma once

#include <httplib.h>

#include <chrono>
#include <optional>
#include <string>

#include "server/http/request_head.h"
#include "server/http/shutdown_signal.h"

namespace parkade {

/// One client's socket, as the stream the HTTP library reads a request from and
/// writes the answer to. What a client can cost is bounded here, where the
/// library has no bounds: bytes and time of a head, pace of a body, time without
/// progress. Never reads past a request's body for the library.
class HttpConnection : public httplib::Stream {
 public:
  HttpConnection(socket_t socket, const ShutdownSignal& shutdown_signal)
      : socket_(socket), shutdown_signal_(shutdown_signal) {}

  /// Waits for the next request, at most `patience`, and reads its head. Nothing
  /// when there is none: the client is gone or idle, or the service ends. Throws
  /// HttpError for a head that is too long (431), too slow (408) or malformed.
  std::optional<RequestHead> ReadHead(std::chrono::milliseconds patience);

  /// Sets what the library reads next: `head_text`, then the body from the socket.
  void BeginRequest(std::string head_text, std::int64_t body_length);

  /// True when the library has read the whole body; otherwise what follows in the
  /// socket is not a request.
  bool IsBodyRead() const { return body_left_ == 0; }

  /// Answers a request the library never sees.
  void SendProblem(const Problem& problem);

  /// Says that nothing more comes and takes in what the client still sends, for a
  /// moment: closing at once would lose the answer on its way.
  void FinishSending();

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* data, size_t size) override;
  ssize_t write(const char* data, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Receives more into buffer_; false at the end of the stream, on errors, at
  /// `deadline` and at the end of the service.
  bool Receive(Clock::time_point deadline);
  bool WaitFor(short events, Clock::time_point deadline) const;
  bool IsTooSlow() const;

  socket_t socket_;
  const ShutdownSignal& shutdown_signal_;
  std::string buffer_;       ///< received and not yet used
  size_t buffer_begin_ = 0;  ///< what lies before is used
  std::string head_text_;    ///< for the library to read first
  size_t head_begin_ = 0;
  std::int64_t body_left_ = 0, body_length_ = 0;
  Clock::time_point body_started_;
};

}  // namespace parkade
