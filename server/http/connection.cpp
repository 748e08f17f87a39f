#include "server/http/connection.h"

#include <arpa/inet.h>
#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "server/http/host_check.h"
#include "server/http/listen_address.h"
#include "server/http/route_table.h"

namespace parkade {
namespace {

constexpr size_t kMaxHeadBytes = 32768;
constexpr size_t kReceiveBytes = 65536;
constexpr int kLookInterval = 250;  // [ms] how often a waiting thread looks at the shutdown signal

bool HasShortAnswer(RouteClass route_class) {
  return route_class == RouteClass::kApi || route_class == RouteClass::kHealth;
}

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

HttpConnection::HttpConnection(socket_t socket, const ShutdownSignal& shutdown_signal,
                               Metrics& metrics)
    : socket_(socket),
      shutdown_signal_(shutdown_signal),
      metrics_(metrics),
      presence_(metrics.connections) {}

HttpConnection::~HttpConnection() { ::close(socket_); }

HttpConnection::Input HttpConnection::Receive() {
  thread_local std::array<char, kReceiveBytes> piece;
  const ssize_t received = ::recv(socket_, piece.data(), piece.size(), MSG_DONTWAIT);
  if (received < 0 && (errno == EAGAIN || errno == EINTR)) return Input::kNone;
  if (received <= 0) return Input::kEnd;
  buffer_.erase(0, buffer_begin_);
  buffer_begin_ = 0;
  buffer_.append(piece.data(), static_cast<size_t>(received));
  pace_.Count(received);
  return Input::kSome;
}

void HttpConnection::DiscardUnread() {
  buffer_ = std::string();
  buffer_begin_ = num_scanned_ = 0;
}

std::optional<RequestHead> HttpConnection::TakeHead() {
  constexpr std::string_view kEnd = "\r\n\r\n";
  const std::string_view unread = std::string_view(buffer_).substr(buffer_begin_);
  const size_t end = unread.find(kEnd, num_scanned_ - std::min(num_scanned_, kEnd.size() - 1));
  const size_t size = end == std::string_view::npos ? unread.size() : end + kEnd.size();
  if (size > kMaxHeadBytes)
    throw HttpError({431, "invalid_request", "the request's head is larger than 32 KiB"});
  num_scanned_ = size;
  if (end == std::string_view::npos) return std::nullopt;
  RequestHead head = ParseRequestHead(unread.substr(0, size));
  buffer_begin_ += size;
  num_scanned_ = 0;
  return head;
}

RequestTrace HttpConnection::TraceOf(const RequestHead& head, const std::string& proxy_host) const {
  RequestTrace trace;
  trace.id = RequestIdFrom(head.Find("x-request-id"));
  trace.method = head.method;
  trace.path = head.Path();
  int port = 0;
  get_remote_ip_and_port(trace.client, port);
  const bool is_handed_on =
      NamesHost(head.Find("host").value_or(""), proxy_host) && IsLoopback(trace.client);
  if (const auto client = ClientAddressFrom(head.Find("x-real-ip")); client && is_handed_on)
    trace.client = *client;
  return trace;
}

void HttpConnection::BeginTrace(const RequestHead& head, const std::string& proxy_host) {
  trace_ = RequestTrace();
  trace_ = TraceOf(head, proxy_host);
}

void HttpConnection::BeginRequest(const RequestHead& head, std::int64_t body_length) {
  head_text_ = ToText(head, body_length);
  head_begin_ = 0;
  body_left_ = body_length_ = body_length;
  route_class_ = RouteOf(head.method, head.Path()).route_class;
  keeps_alive_ = false;
  ++num_requests_;
  request_began_ = Clock::now();
  pace_.Reset();
}

void HttpConnection::LogRequest() {
  LogAccess(trace_,
            {.route_class = NameOf(route_class_),
             .bytes_in = body_length_,
             .bytes_out = num_sent_ - num_sent_before_ + static_cast<std::int64_t>(num_unsent()),
             .duration = Clock::now() - request_began_});
  trace_ = RequestTrace();
  num_sent_before_ = num_sent_;
  request_began_ = Clock::now();
}

bool HttpConnection::AwaitClient(short events) {
  pace_.BeginWaiting(Clock::now());
  bool is_ready = false;
  while (!is_ready && !is_cut_off_ && !shutdown_signal_.is_over()) {
    pollfd wanted{socket_, events, 0};
    const int result = ::poll(&wanted, 1, kLookInterval);
    if (result < 0 && errno != EINTR) break;
    is_ready = result > 0;
    if (events == POLLOUT) CountTaken();
    if (pace_.IsTooSlow(Clock::now())) CutOff();
  }
  pace_.EndWaiting(Clock::now());
  return is_ready && !is_cut_off_;
}

void HttpConnection::CountTaken() {
  int num_queued = 0;
  if (::ioctl(socket_, SIOCOUTQ, &num_queued) != 0) return;
  const std::int64_t num_taken = num_sent_ - num_queued;
  pace_.Count(num_taken - num_taken_);
  num_taken_ = num_taken;
}

void HttpConnection::CutOff() {
  if (!is_cut_off_.exchange(true)) ++metrics_.connections_too_slow;
}

ssize_t HttpConnection::read(char* data, size_t size) {
  if (head_begin_ < head_text_.size()) {
    const size_t count = head_text_.copy(data, size, head_begin_);
    head_begin_ += count;
    return static_cast<ssize_t>(count);
  }
  size = std::min(size, static_cast<size_t>(body_left_));
  if (size == 0) return 0;
  while (num_unread() == 0) {
    const Input input = Receive();
    if (input == Input::kEnd || (input == Input::kNone && !AwaitClient(POLLIN))) return -1;
  }
  const size_t count = buffer_.copy(data, size, buffer_begin_);
  buffer_begin_ += count;
  body_left_ -= static_cast<std::int64_t>(count);
  return static_cast<ssize_t>(count);
}

// Writes all or nothing: the library does not check how much of a head was sent.
ssize_t HttpConnection::write(const char* data, size_t size) {
  if (num_unsent() > 0) {
    rest_.append(data, size);
    return static_cast<ssize_t>(size);
  }
  size_t sent = 0;
  while (sent < size) {
    const ssize_t result = ::send(socket_, data + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (result > 0) {
      sent += static_cast<size_t>(result);
      num_sent_ += result;
      continue;
    }
    if (result < 0 && errno == EINTR) continue;
    if (result < 0 && errno != EAGAIN) return -1;
    if (HasShortAnswer(route_class_)) {
      rest_.assign(data + sent, size - sent);
      break;
    }
    if (!AwaitClient(POLLOUT)) return -1;
  }
  return static_cast<ssize_t>(size);
}

bool HttpConnection::SendRest() {
  const ssize_t sent =
      ::send(socket_, rest_.data() + rest_begin_, num_unsent(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0) return errno == EAGAIN || errno == EINTR;
  num_sent_ += sent;
  rest_begin_ += static_cast<size_t>(sent);
  if (num_unsent() == 0) {
    rest_ = std::string();
    rest_begin_ = 0;
  }
  return true;
}

void HttpConnection::SendProblem(const Problem& problem, int retry_after) {
  if (trace_.id.empty()) trace_.id = RequestIdFrom(std::nullopt);  // its head told nothing
  const std::string body = ToJsonText(problem);
  const std::string text =
      "HTTP/1.1 " + std::to_string(problem.status) + " " + TitleOf(problem.status) +
      "\r\nContent-Type: application/problem+json\r\nContent-Length: " +
      std::to_string(body.size()) +
      (retry_after > 0 ? "\r\nRetry-After: " + std::to_string(retry_after) : "") + "\r\n" +
      kRequestIdField + ": " + trace_.id +
      "\r\nConnection: close\r\nX-Content-Type-Options: nosniff\r\n\r\n" + body;
  num_sent_ +=
      std::max<ssize_t>(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT), 0);
  trace_.status = problem.status;
  LogRequest();
  FinishSending();
}

void HttpConnection::FinishSending() { ::shutdown(socket_, SHUT_WR); }

bool HttpConnection::is_readable() const {
  return head_begin_ < head_text_.size() || body_left_ > 0;
}

bool HttpConnection::is_writable() const {
  if (is_cut_off_ || shutdown_signal_.is_over()) return false;
  // A client may say that it sends no more and still read its answer, but who listens to events
  // says so only when it leaves.
  const short gone =
      POLLERR | POLLHUP | POLLNVAL | (route_class_ == RouteClass::kEvents ? POLLRDHUP : 0);
  pollfd state{socket_, static_cast<short>(POLLOUT | gone), 0};
  return ::poll(&state, 1, 0) >= 0 && (state.revents & gone) == 0;
}

void HttpConnection::get_remote_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  if (::getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    AddressOf(address, ip, port);
  if (!trace_.client.empty()) ip = trace_.client;
}

void HttpConnection::get_local_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    AddressOf(address, ip, port);
}

}  // namespace parkade
