#include "server/jobs/pictures/picture_worker.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "core/error.h"
#include "core/files/foreign_json.h"
#include "server/jobs/last_sentence.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::chrono::minutes kStartLimit{15};  // a pass over a log
constexpr int kPatienceMs = 100;
constexpr size_t kMaxAnswer = size_t{1} << 20;  // [byte]

fs::path MadeFolder(const fs::path& folder) {
  fs::create_directory(folder);
  return folder;
}

ErrorCode CodeOf(const Json& answer) {
  const std::string code = answer.value("code", "");
  if (code == "disk_full") return ErrorCode::kDiskFull;
  return code == "invalid_input" ? ErrorCode::kInvalidInput : ErrorCode::kInternal;
}

}  // namespace

PictureWorker::PictureWorker(const std::vector<std::string>& command, WorkerPlace place,
                             std::chrono::seconds answer_limit,
                             const std::atomic<bool>& is_stopping)
    : folder_(MadeFolder(place.folder)), answer_limit_(answer_limit), is_stopping_(is_stopping) {
  std::array<int, 2> pair{-1, -1};
  Require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) == 0,
          ErrorCode::kInternal, "no file descriptor is left to read pictures with");
  socket_ = pair[0];
  try {
    place.log = place.folder / "log.txt";
    place.temporary_files = place.folder;
    place.input = pair[1];
    process_.emplace(command, place);
    ::close(pair[1]);
    pair[1] = -1;
    Hear(kStartLimit);
  } catch (...) {
    if (pair[1] >= 0) ::close(pair[1]);
    process_.reset();
    ::close(socket_);
    throw;
  }
}

PictureWorker::~PictureWorker() {
  process_.reset();
  ::close(socket_);
}

Json PictureWorker::Ask(const Json& request) {
  const std::string line = request.dump() + "\n";
  // A request is far smaller than the socket's buffer, which is empty: the worker answers one by
  // one.
  const ssize_t sent = ::send(socket_, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  is_alive_ = sent == static_cast<ssize_t>(line.size());
  Require(is_alive_, ErrorCode::kInternal, "the process that reads pictures has ended");
  return Hear(answer_limit_);
}

Json PictureWorker::Hear(std::chrono::seconds patience) {
  is_alive_ = false;  // unless it answers in time
  const auto end = std::chrono::steady_clock::now() + patience;
  size_t line_end = 0;
  while ((line_end = heard_.find('\n')) == std::string::npos) {
    Require(!is_stopping_, ErrorCode::kInternal, "the service stops before the picture is read");
    Require(std::chrono::steady_clock::now() < end, ErrorCode::kInternal,
            "reading the picture took too long");
    pollfd readable{socket_, POLLIN, 0};
    if (::poll(&readable, 1, kPatienceMs) <= 0) continue;
    std::array<char, 65536> piece{};
    const ssize_t count = ::recv(socket_, piece.data(), piece.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    Require(
        count > 0 && heard_.size() < kMaxAnswer, ErrorCode::kInternal,
        "the process that reads pictures has failed: " + LastSentence(folder_.get() / "log.txt"));
    heard_.append(piece.data(), static_cast<size_t>(count));
  }
  const Json answer = ParseForeignJson(std::string_view(heard_).substr(0, line_end));
  heard_.erase(0, line_end + 1);
  Require(answer.is_object(), ErrorCode::kInternal,
          "the process that reads pictures talks nonsense");
  is_alive_ = true;
  if (answer.contains("error"))
    throw Error(CodeOf(answer), answer.at("error").is_string()
                                    ? answer.at("error").get<std::string>()
                                    : "the picture cannot be read");
  return answer;
}

}  // namespace parkade
