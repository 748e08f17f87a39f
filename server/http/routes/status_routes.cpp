#include <unistd.h>

#include <fstream>
#include <iomanip>
#include <sstream>

#include "core/error.h"
#include "core/log.h"
#include "server/http/json_response.h"
#include "server/http/routes/openapi.h"
#include "server/http/routes/routes.h"
#include "server/store/disk/durable_file.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/delivery_table.h"
#include "server/store/tables/job_table.h"

namespace parkade {
namespace {

/// [bytes] of memory this process has, from /proc.
std::int64_t ResidentBytes() {
  std::ifstream stream("/proc/self/statm");
  std::int64_t total = 0, resident = 0;
  stream >> total >> resident;
  return resident * ::sysconf(_SC_PAGESIZE);
}

/// A number as it stands in the text: 0.005, 3.
std::string NumberText(double number) {
  std::ostringstream text;
  text << std::setprecision(12) << number;
  return text.str();
}

/// Text format of Prometheus, version 0.0.4.
class MetricsText {
 public:
  void Add(const std::string& name, const std::string& type, const std::string& help) {
    text_ += "# HELP " + name + " " + help + "\n# TYPE " + name + " " + type + "\n";
    name_ = name;
  }
  void Value(std::int64_t value, const std::string& labels = "") {
    text_ += name_ + labels + " " + std::to_string(value) + "\n";
  }
  void Gauge(const std::string& name, const std::string& help, std::int64_t value) {
    Add(name, "gauge", help);
    Value(value);
  }
  void Counter(const std::string& name, const std::string& help, std::int64_t value) {
    Add(name, "counter", help);
    Value(value);
  }
  /// One of several under a name that Add began; `label` is without braces.
  void Histogram(const DurationHistogram& durations, const std::string& label) {
    std::int64_t count = 0;
    for (size_t i = 0; i <= DurationHistogram::kBounds.size(); ++i) {
      const std::string bound = i < DurationHistogram::kBounds.size()
                                    ? NumberText(DurationHistogram::kBounds[i])
                                    : "+Inf";
      count += durations.count(i);
      Line("_bucket", label + ",le=\"" + bound + '"', std::to_string(count));
    }
    Line("_sum", label, NumberText(durations.sum()));
    Line("_count", label, std::to_string(count));
  }
  const std::string& text() const { return text_; }

 private:
  void Line(const char* suffix, const std::string& labels, const std::string& value) {
    text_.append(name_).append(suffix).append("{").append(labels).append("} ");
    text_.append(value).append("\n");
  }

  std::string name_, text_;
};

void AddJobCounts(RouteContext& context, MetricsText& text) {
  text.Add("parkade_jobs", "gauge", "Jobs by state.");
  context.store.database.Read([&](Connection& connection) {
    for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kDone,
                                 JobState::kFailed, JobState::kCancelled})
      text.Value(CountJobs(connection, state), std::string("{state=\"") + ToText(state) + "\"}");
  });
}

std::string LabelOf(RouteClass route_class) {
  return std::string("class=\"") + NameOf(route_class) + "\"";
}

void AddRouteClasses(Metrics& metrics, MetricsText& text) {
  const auto add = [&](const char* name, const char* type, const char* help, const auto& value) {
    text.Add(name, type, help);
    for (const RouteClass route_class : kRouteClasses)
      text.Value(value(metrics.of(route_class)), "{" + LabelOf(route_class) + "}");
  };
  add("parkade_http_threads_busy", "gauge", "Threads that answer, by class of route.",
      [](const RouteClassMetrics& of_class) -> std::int64_t { return of_class.busy; });
  add("parkade_http_requests_waiting", "gauge", "Whole requests that wait for a thread.",
      [](const RouteClassMetrics& of_class) -> std::int64_t { return of_class.waiting; });
  add("parkade_http_requests_busy_total", "counter", "Requests refused for want of threads.",
      [](const RouteClassMetrics& of_class) -> std::int64_t { return of_class.refused; });
  text.Add("parkade_http_request_seconds", "histogram",
           "Time from a whole request to its whole answer.");
  for (const RouteClass route_class : kRouteClasses)
    text.Histogram(metrics.of(route_class).durations, LabelOf(route_class));
}

std::string MetricsOf(RouteContext& context) {
  Metrics& metrics = context.metrics;
  MetricsText text;
  text.Add("parkade_http_answers_total", "counter", "Answers by class of status.");
  for (size_t i = 1; i < metrics.answers_by_class.size(); ++i)
    text.Value(metrics.answers_by_class[i], "{class=\"" + std::to_string(i) + "xx\"}");
  text.Counter("parkade_http_requests_refused_total", "Requests refused by their head.",
               metrics.requests_refused);
  text.Counter("parkade_http_connections_refused_total",
               "Connections dropped for want of places to wait for requests.",
               metrics.connections_refused);
  text.Counter("parkade_http_connections_too_slow_total",
               "Connections ended because the client sent or read too slowly.",
               metrics.connections_too_slow);
  text.Gauge("parkade_http_connections", "Open connections.", metrics.connections);
  text.Gauge("parkade_http_connections_waiting", "Connections that wait for requests.",
             metrics.connections_waiting);
  AddRouteClasses(metrics, text);
  text.Gauge("parkade_event_clients", "Listeners to server-sent events.", metrics.event_clients);
  text.Counter("parkade_upload_bytes_total", "Bytes of drive logs received.", metrics.upload_bytes);
  AddJobCounts(context, text);
  text.Gauge("parkade_damaged_files", "Stored files that are missing or have changed on the disk.",
             context.store.database.Read(CountDamagedFiles));
  text.Gauge("parkade_webhook_deliveries_waiting", "Events that webhooks were not told of yet.",
             context.store.database.Read([](Connection& connection) {
               return CountDeliveries(connection, DeliveryState::kWaiting);
             }));
  text.Gauge("parkade_disk_free_bytes", "Free bytes on the disk of the data directory.",
             FreeBytes(context.store.directory.root()));
  const Quarantine& quarantine = context.store.directory.quarantine();
  text.Gauge("parkade_quarantine_entries", "What lies in quarantine/.", quarantine.num_entries());
  text.Gauge("parkade_quarantine_bytes", "Its bytes.", quarantine.num_bytes());
  text.Gauge("process_resident_memory_bytes", "Memory of the service, without its workers.",
             ResidentBytes());
  const auto uptime = std::chrono::steady_clock::now() - metrics.started;
  text.Gauge("parkade_uptime_seconds", "Time since the start.",
             std::chrono::duration_cast<std::chrono::seconds>(uptime).count());
  return text.text();
}

/// Ready to take a drive: the database answers and there is room on the disk.
Json Readiness(RouteContext& context, bool& is_ready) {
  bool has_database = false, has_room = false;
  try {
    context.store.database.Read(
        [](Connection& connection) { CountJobs(connection, JobState::kQueued); });
    has_database = true;
    has_room = FreeBytes(context.store.directory.root()) > context.store.disk_reserve;
  } catch (const Error& error) {
    LogWarning(std::string("not ready: ") + error.what());
  }
  const bool is_writable = !context.store.database.is_frozen();
  is_ready = has_database && has_room && is_writable && !context.shutdown_signal.is_stopping();
  return {{"ready", is_ready},
          {"database", has_database},
          {"disk", has_room},
          {"writable", is_writable},
          {"stopping", context.shutdown_signal.is_stopping()}};
}

}  // namespace

void AddStatusRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /healthz", [](const httplib::Request&, httplib::Response& response) {
    SendJson(response, 200, {{"healthy", true}});
  });
  routes.On("GET /readyz", [&context](const httplib::Request&, httplib::Response& response) {
    bool is_ready = false;
    const Json json = Readiness(context, is_ready);
    SendJson(response, is_ready ? 200 : 503, json);
  });
  routes.On("GET /metrics", [&context](const httplib::Request&, httplib::Response& response) {
    response.status = 200;
    response.set_header("Cache-Control", "no-store");
    response.set_content(MetricsOf(context), "text/plain; version=0.0.4; charset=utf-8");
  });
  routes.On("GET /api/v1/openapi.json", [](const httplib::Request&, httplib::Response& response) {
    response.status = 200;
    response.set_header("Cache-Control", "no-cache");
    response.set_content(OpenApiText(), "application/json");
  });
}

}  // namespace parkade
