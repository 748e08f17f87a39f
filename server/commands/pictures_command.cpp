#include <sys/socket.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/error.h"
#include "server/commands/commands.h"
#include "server/commands/failure.h"
#include "server/commands/picture_requests.h"
#include "server/ingest/files/remove_at_signal.h"

namespace parkade {
namespace {

using Json = nlohmann::json;

struct PicturesArguments {
  std::string log, rig, index;
};

/// Lines to and from the service over standard input, which is a socket.
class Service {
 public:
  void Say(const Json& json) const {
    std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    for (size_t sent = 0; sent < line.size();) {
      const ssize_t count =
          ::send(STDIN_FILENO, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
      Require(count > 0 || errno == EINTR, ErrorCode::kInternal,
              "`parkade pictures` talks to a service over a socket, which is not there");
      if (count > 0) sent += static_cast<size_t>(count);
    }
  }

  /// Nothing once the service has gone.
  std::optional<std::string> Hear() {
    size_t end = 0;
    while ((end = heard_.find('\n')) == std::string::npos) {
      std::array<char, 4096> piece{};
      const ssize_t count = ::recv(STDIN_FILENO, piece.data(), piece.size(), 0);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return std::nullopt;
      heard_.append(piece.data(), static_cast<size_t>(count));
    }
    std::string line = heard_.substr(0, end);
    heard_.erase(0, end + 1);
    return line;
  }

 private:
  std::string heard_;
};

Json FailureToJson(const std::exception& exception) {
  const Failure failure = FailureOf(exception);
  return {{"error", failure.sentence}, {"code", failure.code}};
}

int ServePictures(const PicturesArguments& arguments) {
  const RemoveAtSignal removal;
  Service service;
  std::optional<PictureRequests> requests;
  try {
    requests.emplace(arguments.log, arguments.rig, arguments.index);
  } catch (const std::exception& exception) {
    service.Say(FailureToJson(exception));
    return 1;
  }
  service.Say({{"ready", true}});
  while (const std::optional<std::string> line = service.Hear()) {
    try {
      service.Say(requests->Answer(Json::parse(*line)));
    } catch (const std::exception& exception) {
      service.Say(FailureToJson(exception));
    }
  }
  return 0;
}

}  // namespace

void AddPicturesCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<PicturesArguments>();
  CLI::App* command = app.add_subcommand(
      "pictures", "Hand out pictures of a log; for the service, which talks over a socket");
  command->add_option("LOG", arguments->log, "drive log")->required();
  command->add_option("--rig", arguments->rig, "folder with the rig files");
  command->add_option("--index", arguments->index, "file that says where the images lie")
      ->required();
  command->group("");  // not for people
  command->callback(
      [arguments, &action] { action = [arguments] { return ServePictures(*arguments); }; });
}

}  // namespace parkade
