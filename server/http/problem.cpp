#include "server/http/problem.h"

#include <httplib.h>

#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "core/log.h"

namespace parkade {
namespace {

const Problem kOurFault{500, "internal", "the service failed; its log has the reason"};

}  // namespace

const char* TitleOf(int status) {
  switch (status) {
    case 400: return "Bad Request";
    case 401: return "Unauthorized";
    case 403: return "Forbidden";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 408: return "Request Timeout";
    case 409: return "Conflict";
    case 410: return "Gone";
    case 411: return "Length Required";
    case 412: return "Precondition Failed";
    case 413: return "Content Too Large";
    case 414: return "URI Too Long";
    case 415: return "Unsupported Media Type";
    case 416: return "Range Not Satisfiable";
    case 417: return "Expectation Failed";
    case 429: return "Too Many Requests";
    case 431: return "Request Header Fields Too Large";
    case 460: return "Checksum Mismatch";
    case 500: return "Internal Server Error";
    case 503: return "Service Unavailable";
    case 505: return "HTTP Version Not Supported";
    case 507: return "Insufficient Storage";
    default: return "Error";
  }
}

std::string ToJsonText(const Problem& problem) {
  const nlohmann::ordered_json json = {{"type", "about:blank"},
                                       {"title", TitleOf(problem.status)},
                                       {"status", problem.status},
                                       {"detail", problem.detail},
                                       {"code", problem.code}};
  // A sentence may quote a user's file name, whose bytes may be anything.
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Problem ProblemOf(const Error& error) {
  switch (error.code()) {
    case ErrorCode::kInvalidInput: return {400, "invalid_input", error.what()};
    case ErrorCode::kUsage: return {400, "usage", error.what()};
    case ErrorCode::kNotFound: return {404, "not_found", error.what()};
    case ErrorCode::kConflict: return {409, "conflict", error.what()};
    case ErrorCode::kForbidden: return {403, "forbidden", error.what()};
    case ErrorCode::kDiskFull: return {507, "disk_full", error.what()};
    case ErrorCode::kInternal: break;
  }
  LogError(std::string("request error=") + error.what());
  return kOurFault;
}

void SendProblem(httplib::Response& response, const Problem& problem) {
  response.status = problem.status;
  response.set_content(ToJsonText(problem), "application/problem+json");
}

void SendException(httplib::Response& response, std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const HttpError& error) {
    SendProblem(response, error.problem());
  } catch (const Error& error) {
    SendProblem(response, ProblemOf(error));
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::no_space_on_device) {
      SendProblem(response, {507, "disk_full", "the disk of the data directory is full"});
      return;
    }
    LogError(std::string("request exception=") + error.what());
    SendProblem(response, kOurFault);
  } catch (const std::exception& error) {
    LogError(std::string("request exception=") + error.what());
    SendProblem(response, kOurFault);
  }
}

}  // namespace parkade
