#include "server/http/connection.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace parkade {
namespace {

using namespace std::chrono_literals;

constexpr size_t kMaxHeadBytes = 32768;
constexpr size_t kReceiveBytes = 65536;
constexpr auto kHeadPatience = 10s;      // to wait for a head, once it has begun
constexpr auto kProgressPatience = 15s;  // to wait without a single byte moving
constexpr auto kFinishPatience = 2s;
constexpr auto kLookInterval = 250ms;  // how often a waiting thread looks at the shutdown signal
// A body may be slow, but not so slow that it holds a thread for nothing.
constexpr auto kBodyGrace = 30s;
constexpr double kMinBodyPace = 8192;  // [bytes/s]

void AddressOf(const sockaddr_storage& address, std::string& ip, int& port) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.ss_family == AF_INET) {
    const auto& inet = reinterpret_cast<const sockaddr_in&>(address);
    inet_ntop(AF_INET, &inet.sin_addr, text.data(), text.size());
    port = ntohs(inet.sin_port);
  } else if (address.ss_family == AF_INET6) {
    const auto& inet = reinterpret_cast<const sockaddr_in6&>(address);
    inet_ntop(AF_INET6, &inet.sin6_addr, text.data(), text.size());
    port = ntohs(inet.sin6_port);
  }
  ip = text.data();
}

}  // namespace

bool HttpConnection::WaitFor(short events, Clock::time_point deadline) const {
  for (;;) {
    if (shutdown_signal_.is_over()) return false;
    const auto left = deadline - Clock::now();
    if (left <= Clock::duration::zero()) return false;
    const auto slice = std::min<Clock::duration>(left, kLookInterval);
    pollfd wanted{socket_, events, 0};
    const int result = ::poll(
        &wanted, 1,
        static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(slice).count()) + 1);
    if (result > 0) return true;
    if (result < 0 && errno != EINTR) return false;
  }
}

bool HttpConnection::Receive(Clock::time_point deadline) {
  buffer_.erase(0, buffer_begin_);
  buffer_begin_ = 0;
  const size_t old_size = buffer_.size();
  for (;;) {
    if (!WaitFor(POLLIN, deadline)) return false;
    buffer_.resize(old_size + kReceiveBytes);
    const ssize_t received =
        ::recv(socket_, buffer_.data() + old_size, kReceiveBytes, MSG_DONTWAIT);
    buffer_.resize(old_size + static_cast<size_t>(std::max<ssize_t>(received, 0)));
    if (received > 0) return true;
    if (received == 0 || (errno != EAGAIN && errno != EINTR)) return false;
  }
}

std::optional<RequestHead> HttpConnection::ReadHead(std::chrono::milliseconds patience) {
  const Clock::time_point idle_deadline = Clock::now() + patience;
  while (buffer_begin_ == buffer_.size()) {
    // It waits in slices, so that an idle client does not hold up the end of the service.
    if (shutdown_signal_.is_stopping() || Clock::now() >= idle_deadline) return std::nullopt;
    if (!WaitFor(POLLIN, std::min(idle_deadline, Clock::now() + kLookInterval))) continue;
    if (!Receive(idle_deadline)) return std::nullopt;
  }

  const Clock::time_point deadline = Clock::now() + kHeadPatience;
  for (;;) {
    const size_t end = buffer_.find("\r\n\r\n", buffer_begin_);
    const size_t size = (end == std::string::npos ? buffer_.size() : end + 4) - buffer_begin_;
    if (size > kMaxHeadBytes)
      throw HttpError({431, "invalid_request", "the request's head is larger than 32 KiB"});
    if (end != std::string::npos) {
      RequestHead head = ParseRequestHead(std::string_view(buffer_).substr(buffer_begin_, size));
      buffer_begin_ += size;
      return head;
    }
    if (Receive(deadline)) continue;
    if (Clock::now() >= deadline)
      throw HttpError({408, "timeout", "the request's head took longer than 10 seconds"});
    return std::nullopt;
  }
}

void HttpConnection::BeginRequest(std::string head_text, std::int64_t body_length) {
  head_text_ = std::move(head_text);
  head_begin_ = 0;
  body_left_ = body_length_ = body_length;
  body_started_ = Clock::now();
}

bool HttpConnection::IsTooSlow() const {
  const double seconds =
      std::chrono::duration<double>(Clock::now() - body_started_ - kBodyGrace).count();
  return seconds * kMinBodyPace > static_cast<double>(body_length_ - body_left_);
}

ssize_t HttpConnection::read(char* data, size_t size) {
  if (head_begin_ < head_text_.size()) {
    const size_t count = head_text_.copy(data, size, head_begin_);
    head_begin_ += count;
    return static_cast<ssize_t>(count);
  }
  size = std::min(size, static_cast<size_t>(body_left_));
  if (size == 0) return 0;
  if (buffer_begin_ == buffer_.size() &&
      (IsTooSlow() || !Receive(Clock::now() + kProgressPatience)))
    return -1;
  const size_t count = buffer_.copy(data, size, buffer_begin_);
  buffer_begin_ += count;
  body_left_ -= static_cast<std::int64_t>(count);
  return static_cast<ssize_t>(count);
}

// Writes all or nothing: the library does not check how much of a head was sent.
ssize_t HttpConnection::write(const char* data, size_t size) {
  size_t sent = 0;
  while (sent < size) {
    const ssize_t result = ::send(socket_, data + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (result > 0) {
      sent += static_cast<size_t>(result);
      continue;
    }
    if (result < 0 && errno == EINTR) continue;
    if (result < 0 && errno != EAGAIN) return -1;
    if (!WaitFor(POLLOUT, Clock::now() + kProgressPatience)) return -1;
  }
  return static_cast<ssize_t>(size);
}

void HttpConnection::SendProblem(const Problem& problem) {
  const std::string body = ToJsonText(problem);
  const std::string text =
      "HTTP/1.1 " + std::to_string(problem.status) + " " + TitleOf(problem.status) +
      "\r\nContent-Type: application/problem+json\r\nContent-Length: " +
      std::to_string(body.size()) +
      "\r\nConnection: close\r\nX-Content-Type-Options: nosniff\r\n\r\n" + body;
  body_left_ = 1;  // bytes that follow are not a request
  write(text.data(), text.size());
}

void HttpConnection::FinishSending() {
  ::shutdown(socket_, SHUT_WR);
  if (body_left_ == 0) return;
  const Clock::time_point deadline = Clock::now() + kFinishPatience;
  do {
    buffer_begin_ = buffer_.size();
  } while (!shutdown_signal_.is_over() && Receive(deadline));
}

bool HttpConnection::is_readable() const {
  return head_begin_ < head_text_.size() || body_left_ > 0;
}

bool HttpConnection::is_writable() const {
  if (shutdown_signal_.is_over()) return false;
  pollfd state{socket_, POLLOUT, 0};
  return ::poll(&state, 1, 0) >= 0 && (state.revents & (POLLERR | POLLHUP | POLLNVAL)) == 0;
}

void HttpConnection::get_remote_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  if (::getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    AddressOf(address, ip, port);
}

void HttpConnection::get_local_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    AddressOf(address, ip, port);
}

}  // namespace parkade
