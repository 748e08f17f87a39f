#include <charconv>

#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/review_view.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"

namespace parkade {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLookInterval{500};
constexpr std::chrono::seconds kHeartbeatInterval{10};
constexpr std::chrono::minutes kMaxLifetime{10};  // then the client comes back with Last-Event-ID

/// The site that an event tells of.
std::string SiteOf(Connection& connection, const Event& event) {
  if (event.kind == "job") return FindJob(connection, event.subject).site;
  if (event.kind == "drive") return FindDriveOrTombstone(connection, event.subject).site;
  return event.subject.substr(0, event.subject.find('/'));
}

struct SubjectParts {
  std::string site;
  std::int64_t version = 0;
  std::string id;
};

/// "<site>/<version>" and, of a comment, "/<id>".
SubjectParts PartsOf(const std::string& subject) {
  const size_t slash = subject.find('/'), second = subject.find('/', slash + 1);
  return {subject.substr(0, slash), std::stoll(subject.substr(slash + 1)),
          second == std::string::npos ? "" : subject.substr(second + 1)};
}

/// The subject of an event as it is now: a listener that comes late gets one state, not the way to
/// it. Nothing where the listener may not know of its site.
std::optional<Json> DataOf(RouteContext& context, const Event& event, const SiteScope& sites) {
  try {
    const std::string site = context.store.database.Read(
        [&](Connection& connection) { return SiteOf(connection, event); });
    if (!Includes(sites, site)) return std::nullopt;
    if (event.kind == "job") {
      const Job job = context.store.database.Read(
          [&](Connection& connection) { return FindJob(connection, event.subject); });
      return ToJson(job, context.jobs.ProgressOf(job.id));
    }
    if (event.kind == "drive")
      return ToJson(context.store.database.Read(
          [&](Connection& connection) { return FindDrive(connection, event.subject); }));
    const auto [_, version, id] = PartsOf(event.subject);
    if (event.kind == "comment")
      return ToJson(context.store.database.Read(
          [&, &comment = id](Connection& connection) { return FindComment(connection, comment); }));
    if (event.kind == "review")
      return context.store.database.Read([&, &number = version](Connection& connection) {
        return ToJson(FindMapRow(connection, site, number), /*with_files=*/false);
      });
    return Json{{"site", site}, {"version", version}, {"url", MapAddress(site, version)}};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNotFound) throw;
    const std::string id = event.subject.substr(event.subject.rfind('/') + 1);
    return Json{{"id", id}, {"deleted", true}};
  }
}

std::string TextOf(const std::string& kind, std::int64_t id, const Json& data) {
  return "event: " + kind + "\nid: " + std::to_string(id) +
         "\ndata: " + data.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n\n";
}

/// One listener.
class EventStream {
 public:
  EventStream(RouteContext& context, std::int64_t last_seen)
      : context_(context), presence_(context.metrics.event_clients), last_seen_(last_seen) {}

  /// Sends the events there are, waiting a moment for some; false at the end.
  bool Send(httplib::DataSink& sink) {
    const steady_clock::time_point now = steady_clock::now();
    if (context_.shutdown_signal.is_stopping() || now - started_ > kMaxLifetime) {
      sink.done();
      return true;
    }
    std::string text = News();
    if (text.empty() && now - last_sent_ >= kHeartbeatInterval) text = ": still here\n\n";
    if (is_first_) text = "retry: 2000\n\n" + text;
    is_first_ = false;
    if (text.empty()) return sink.is_writable();
    last_sent_ = now;
    return sink.write(text.data(), text.size());
  }

 private:
  std::string News() {
    const EventHub::News news = context_.events.WaitFor(
        last_seen_, is_first_ ? std::chrono::milliseconds(0) : kLookInterval);
    std::string text;
    if (news.has_gap) {
      last_seen_ = news.events.empty() ? context_.events.last_id() : news.events.back().id;
      return TextOf("reload", last_seen_, Json::object());
    }
    for (const Event& event : news.events)
      if (const auto data = DataOf(context_, event, sites_))
        text += TextOf(event.kind, event.id, *data);
    if (!news.events.empty()) last_seen_ = news.events.back().id;
    return text;
  }

  RouteContext& context_;
  CountedPresence presence_;
  const SiteScope sites_ = CurrentCaller().sites;  // of the request it is made for
  std::int64_t last_seen_;
  const steady_clock::time_point started_ = steady_clock::now();
  steady_clock::time_point last_sent_ = started_;
  bool is_first_ = true;
};

std::int64_t LastSeen(const httplib::Request& request, const EventHub& events) {
  const std::string text = request.get_header_value("Last-Event-ID");
  std::int64_t id = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), id);
  const bool is_number =
      !text.empty() && parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size();
  if (!text.empty() && !is_number)
    return 0;  // an id that is not ours: the client has missed everything
  return is_number ? id : events.last_id();
}

}  // namespace

void AddEventRoute(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/events", [&context](const httplib::Request& request,
                                             httplib::Response& response) {
    const auto stream = std::make_shared<EventStream>(context, LastSeen(request, context.events));
    response.status = 200;
    response.set_header("Cache-Control", "no-store");
    response.set_header("X-Accel-Buffering", "no");
    response.set_chunked_content_provider(
        "text/event-stream",
        [stream](size_t, httplib::DataSink& sink) { return stream->Send(sink); });
  });
}

}  // namespace parkade
