#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "server/http/connection.h"
#include "server/http/epoll.h"
#include "server/http/request_pools.h"

namespace parkade {

/// What a connection may cost before its request has a thread.
struct LobbyLimits {
  std::chrono::milliseconds first_request{10'000};  ///< until a new client says something
  std::chrono::milliseconds next_request{5'000};    ///< until one that was answered does
  std::chrono::milliseconds head{10'000};           ///< for a head, once it has begun
  std::chrono::milliseconds body{10'000};           ///< for a body, or its first 64 KiB
  std::chrono::milliseconds answer{10'000};   ///< for a short answer, at PaceMeter::kLeastPace
  std::chrono::milliseconds farewell{2'000};  ///< to take in what nobody reads
  size_t max_connections = 4096;
  std::int64_t max_bytes = std::int64_t{64} << 20;  ///< kept here, of all together
};

/// What is asked of requests by their heads. Neither question may wait.
struct EntryRules {
  std::function<bool()> allows_any_host;  ///< or this machine's names alone; see host_check.h
  std::string proxy_host = {};            ///< that a proxy of this machine is reached by; or empty
  std::function<bool(const RequestHead&)> is_known;  ///< sent by somebody with an identity here
};

/// Where connections wait for requests, all in one thread that never waits for a single one. A
/// request leaves for its pool when it is whole, or when 64 KiB of its body are there: clients
/// that send byte by byte cost a place here, and no thread. Connections come back between requests,
/// and where short answers wait for their reader. Where there are too many, the oldest of strangers
/// go first.
class Lobby {
 public:
  using Clock = HttpConnection::Clock;

  /// What is handed over outlives the lobby.
  Lobby(const LobbyLimits& limits, EntryRules rules, RequestPools& pools,
        const ShutdownSignal& shutdown_signal, Metrics& metrics);

  /// Accepts connections of the listening socket `listener`, which must not block, until the
  /// service ends and everybody was answered or the patience of its end is over. Throws
  /// Error{kInternal} where the kernel has no room for it.
  void Run(socket_t listener);

  /// Takes a connection back whose request was answered: to wait for the next one, or to be closed
  /// as soon as the client has its answer. From any thread.
  void Return(std::unique_ptr<HttpConnection> connection);

  /// Makes Run look at the shutdown signal. From any thread.
  void Wake() { epoll_.Wake(); }

 private:
  enum class Stage { kIdle, kHead, kBody, kAnswer, kFarewell };
  struct Guest {
    std::unique_ptr<HttpConnection> connection;
    Stage stage = Stage::kIdle;
    Clock::time_point deadline;
    size_t body_part = 0;  ///< [bytes] of the body that must be there
  };
  using Guests = std::map<std::uint64_t, Guest>;  ///< by number: the first has waited longest

  void Accept(socket_t listener);
  void Receive(Guest& guest, std::uint64_t number);
  void SendRest(Guest& guest, std::uint64_t number);
  /// Goes on with what the guest has sent. It may be gone afterwards.
  void Proceed(std::uint64_t number);
  void TakeHead(Guest& guest);
  void Admit(std::uint64_t number);
  void Refuse(Guest& guest, const Problem& problem);
  void BeginFarewell(Guest& guest);
  void Enter(std::unique_ptr<HttpConnection> connection, Stage stage,
             std::chrono::milliseconds patience);
  void TakeReturned();
  /// Closes one connection, the oldest of strangers where there are some. Returns what was kept of
  /// it [bytes].
  std::int64_t DropOldest();
  void EndLate(Clock::time_point now);
  void EndIdle();
  void Tick(Clock::time_point now);

  const LobbyLimits limits_;
  const EntryRules rules_;
  RequestPools& pools_;
  const ShutdownSignal& shutdown_signal_;
  Metrics& metrics_;
  Epoll epoll_;
  Guests guests_;
  std::uint64_t next_number_ = 1;
  std::mutex mutex_;
  std::vector<std::unique_ptr<HttpConnection>> returned_;  ///< guarded by mutex_
};

}  // namespace parkade
