#include "server/http/lobby.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "core/error.h"
#include "core/log.h"
#include "server/http/host_check.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kListener = 0;  // the number of the listening socket
constexpr size_t kBodyPart = 65536;     // [bytes] of a body that a client shows before it is served
constexpr int kMaxAccepted = 64;        // in one go: those who are here have their turn too
constexpr auto kTick = 250ms;
constexpr auto kTickAtTheEnd = 10ms;

/// True where accept() failed because the process or the machine is full.
bool IsFull(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

}  // namespace

Lobby::Lobby(const LobbyLimits& limits, EntryRules rules, RequestPools& pools,
             const ShutdownSignal& shutdown_signal, Metrics& metrics)
    : limits_(limits),
      rules_(std::move(rules)),
      pools_(pools),
      shutdown_signal_(shutdown_signal),
      metrics_(metrics) {}

void Lobby::Run(socket_t listener) {
  Require(epoll_.Add(listener, kListener), ErrorCode::kInternal, "the service cannot listen");
  bool is_listening = true;
  Clock::time_point next_tick = Clock::now();
  for (;;) {
    const bool is_stopping = shutdown_signal_.is_stopping();
    for (const std::uint64_t number : epoll_.Wait(is_stopping ? kTickAtTheEnd : kTick)) {
      if (number == kListener)
        Accept(listener);
      else if (const auto found = guests_.find(number); found == guests_.end())
        continue;  // dropped for one that came before in this round
      else if (found->second.stage == Stage::kAnswer)
        SendRest(found->second, number);
      else
        Receive(found->second, number);
    }
    // Asked first: whoever was answered before lies in returned_ by now.
    const bool is_nobody_served = pools_.IsIdle();
    TakeReturned();
    if (Clock::now() >= next_tick) {
      Tick(Clock::now());
      next_tick = Clock::now() + kTick;
    }
    metrics_.connections_waiting = static_cast<std::int64_t>(guests_.size());
    if (!is_stopping) continue;
    if (is_listening) {
      Accept(listener);  // who is connected already is a client like any other
      epoll_.Remove(listener);
      ::shutdown(listener, SHUT_RD);
      is_listening = false;
    }
    EndIdle();
    if (shutdown_signal_.is_over() || (guests_.empty() && is_nobody_served && pools_.IsIdle()))
      break;
  }
  guests_.clear();
  metrics_.connections_waiting = 0;
}

void Lobby::Accept(socket_t listener) {
  for (int i = 0; i < kMaxAccepted; ++i) {
    const int socket = ::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket < 0) {
      if (errno == EAGAIN) return;
      if (!IsFull(errno)) continue;  // that client has left meanwhile
      if (guests_.empty()) std::this_thread::sleep_for(1ms);
      DropOldest();
      continue;
    }
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    Enter(std::make_unique<HttpConnection>(socket, shutdown_signal_, metrics_), Stage::kIdle,
          limits_.first_request);
  }
}

void Lobby::Enter(std::unique_ptr<HttpConnection> connection, Stage stage,
                  std::chrono::milliseconds patience) {
  while (guests_.size() >= limits_.max_connections) DropOldest();
  const std::uint64_t number = next_number_++;
  const Epoll::For what = stage == Stage::kAnswer ? Epoll::For::kOutput : Epoll::For::kInput;
  if (!epoll_.Add(connection->socket(), number, what)) return;
  Guest& guest = guests_[number];
  guest.connection = std::move(connection);
  guest.stage = stage;
  guest.deadline = Clock::now() + patience;
  if (stage == Stage::kIdle && guest.connection->num_unread() > 0) Proceed(number);
}

void Lobby::Return(std::unique_ptr<HttpConnection> connection) {
  if (!connection->keeps_alive() && connection->num_unsent() == 0) {
    connection->FinishSending();
    // What a client still sends is taken in for a moment: closing at once would lose the answer on
    // its way.
    if (connection->IsBodyRead()) return;
  }
  const std::lock_guard lock(mutex_);
  returned_.push_back(std::move(connection));
  epoll_.Wake();
}

void Lobby::TakeReturned() {
  std::vector<std::unique_ptr<HttpConnection>> returned;
  {
    const std::lock_guard lock(mutex_);
    returned.swap(returned_);
  }
  for (std::unique_ptr<HttpConnection>& connection : returned) {
    if (!connection->keeps_alive()) connection->DiscardUnread();
    connection->Rest();
    const auto at_least_pace = std::chrono::milliseconds(static_cast<std::int64_t>(
        1000.0 * static_cast<double>(connection->num_unsent()) / PaceMeter::kLeastPace));
    if (connection->num_unsent() > 0)
      Enter(std::move(connection), Stage::kAnswer, limits_.answer + at_least_pace);
    else if (connection->keeps_alive())
      Enter(std::move(connection), Stage::kIdle, limits_.next_request);
    else
      Enter(std::move(connection), Stage::kFarewell, limits_.farewell);
  }
}

void Lobby::SendRest(Guest& guest, std::uint64_t number) {
  const bool is_there = guest.connection->SendRest();
  if (is_there && guest.connection->num_unsent() > 0) return;
  epoll_.Remove(guest.connection->socket());
  if (is_there) Return(std::move(guest.connection));
  guests_.erase(number);
}

void Lobby::Receive(Guest& guest, std::uint64_t number) {
  const HttpConnection::Input input = guest.connection->Receive();
  if (guest.stage == Stage::kFarewell) guest.connection->DiscardUnread();
  if (input == HttpConnection::Input::kSome) Proceed(number);
  if (input != HttpConnection::Input::kEnd) return;
  // Whoever broke off in a large body has sent something that the route may want to keep.
  if (guest.stage == Stage::kBody && guest.connection->body_length() > std::int64_t{kBodyPart})
    Admit(number);
  else
    guests_.erase(number);
}

void Lobby::Proceed(std::uint64_t number) {
  Guest& guest = guests_.at(number);
  try {
    if (guest.stage == Stage::kIdle) {
      guest.stage = Stage::kHead;
      guest.deadline = Clock::now() + limits_.head;
    }
    if (guest.stage == Stage::kHead) TakeHead(guest);
    if (guest.stage == Stage::kBody && guest.connection->num_unread() >= guest.body_part)
      Admit(number);
  } catch (const HttpError& error) {
    ++metrics_.requests_refused;
    Refuse(guest, error.problem());
  } catch (const std::exception& error) {
    LogError(std::string("connection exception=") + error.what());
    guests_.erase(number);
  }
}

void Lobby::TakeHead(Guest& guest) {
  const std::optional<RequestHead> head = guest.connection->TakeHead();
  if (!head) return;
  guest.connection->BeginTrace(*head, rules_.proxy_host);
  const std::int64_t body_length = CheckRequestHead(*head);
  if (!rules_.allows_any_host()) RefuseForeignHost(*head, rules_.proxy_host);
  guest.connection->set_is_known(rules_.is_known(*head));
  guest.connection->BeginRequest(*head, body_length);
  guest.stage = Stage::kBody;
  guest.deadline = Clock::now() + limits_.body;
  // Who asks whether it may send waits for the answer of its route.
  guest.body_part = head->Find("expect")
                        ? 0
                        : static_cast<size_t>(std::min<std::int64_t>(body_length, kBodyPart));
}

void Lobby::Admit(std::uint64_t number) {
  auto guest = guests_.extract(number);
  HttpConnection& connection = *guest.mapped().connection;
  epoll_.Remove(connection.socket());
  // Whatever its route: the thread will have to wait for the rest of the body.
  if (static_cast<std::int64_t>(connection.num_unread()) < connection.body_length())
    connection.set_route_class(RouteClass::kUploads);
  if (pools_.Submit(guest.mapped().connection)) return;
  if (!epoll_.Add(connection.socket(), number)) return;
  BeginFarewell(guests_.insert(std::move(guest)).position->second);
}

void Lobby::Refuse(Guest& guest, const Problem& problem) {
  guest.connection->SendProblem(problem);
  BeginFarewell(guest);
}

void Lobby::BeginFarewell(Guest& guest) {
  guest.connection->DiscardUnread();
  guest.stage = Stage::kFarewell;
  guest.deadline = Clock::now() + limits_.farewell;
}

std::int64_t Lobby::DropOldest() {
  if (guests_.empty()) return 0;
  auto dropped = std::find_if(guests_.begin(), guests_.end(), [](const auto& entry) {
    return !entry.second.connection->is_known();
  });
  if (dropped == guests_.end()) dropped = guests_.begin();
  const Guest& guest = dropped->second;
  const std::int64_t num_held = guest.connection->num_held();
  ++metrics_.connections_refused;
  if (guest.stage == Stage::kHead || guest.stage == Stage::kBody)
    guest.connection->SendProblem({503, "busy", "too many connections: try again in a moment"}, 1);
  guests_.erase(dropped);
  return num_held;
}

void Lobby::EndLate(Clock::time_point now) {
  for (auto next = guests_.begin(); next != guests_.end();) {
    const auto guest = next++;
    if (now < guest->second.deadline) continue;
    const Stage stage = guest->second.stage;
    if (stage == Stage::kIdle || stage == Stage::kFarewell) {
      guests_.erase(guest);
      continue;
    }
    ++metrics_.connections_too_slow;
    if (stage == Stage::kAnswer)
      guests_.erase(guest);
    else
      Refuse(guest->second,
             {408, "timeout",
              stage == Stage::kHead ? "the request's head took longer than 10 seconds"
                                    : "the request's body came too slowly"});
  }
}

void Lobby::EndIdle() {
  for (auto next = guests_.begin(); next != guests_.end();) {
    const auto guest = next++;
    if (guest->second.stage != Stage::kIdle) continue;
    const std::uint64_t number = guest->first;
    Receive(guest->second, number);  // it may have sent a request meanwhile
    const auto found = guests_.find(number);
    if (found != guests_.end() && found->second.stage == Stage::kIdle) guests_.erase(found);
  }
}

void Lobby::Tick(Clock::time_point now) {
  EndLate(now);
  std::int64_t num_bytes = 0;
  for (const auto& [number, guest] : guests_) num_bytes += guest.connection->num_held();
  while (num_bytes > limits_.max_bytes && !guests_.empty()) num_bytes -= DropOldest();
  pools_.Relieve(now);
}

}  // namespace parkade
