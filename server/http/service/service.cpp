#include "server/http/service/service.h"

#include <httplib.h>

#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "server/http/http_server.h"
#include "server/http/listen_address.h"
#include "server/http/problem.h"
#include "server/http/routes/basemap.h"
#include "server/http/routes/routes.h"
#include "server/http/routes/upload_route.h"
#include "server/http/routes/viewer_files.h"
#include "server/jobs/slurm/slurm_engine.h"
#include "server/store/access/tokens.h"
#include "server/store/care/retention.h"
#include "server/store/care/scrubber.h"
#include "server/store/tables/drive_table.h"

namespace parkade {
namespace {

constexpr std::chrono::hours kRetentionInterval{1};

// "blob:" is for textures and the mesh decoder's worker, which three.js makes from bytes it has;
// "wasm-unsafe-eval" for the decoder itself.
std::string ContentSecurityPolicy(const Basemap& basemap) {
  return "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; "
         "connect-src 'self' blob: data: " +
         basemap.origin() + "; img-src 'self' blob: data: " + basemap.origin() +
         "; style-src 'self'; font-src 'self'; object-src 'none'; base-uri 'none'; "
         "form-action 'self'; frame-ancestors 'none'";
}

ListenAddress CheckedAddress(const ServeOptions& options) {
  ListenAddress address = ParseListenAddress(options.listen);
  Require(options.allow_public || IsLoopback(address.host), ErrorCode::kUsage,
          "'" + address.host +
              "' is not a loopback address: put a proxy in front that speaks TLS, or say "
              "--allow-public, which needs a token");
  return address;
}

const ServeOptions& Checked(const ServeOptions& options) {
  CheckedAddress(options);
  Require(options.num_workers >= 1 && options.num_workers <= 512, ErrorCode::kUsage,
          "workers: 1 to 512");
  Require(options.num_threads >= 4 && options.num_threads <= 1024, ErrorCode::kUsage,
          "threads: 4 to 1024");
  Require(options.accel_redirect.empty() ||
              (!options.proxy_host.empty() && options.accel_redirect.starts_with('/') &&
               options.accel_redirect.ends_with('/')),
          ErrorCode::kUsage,
          "accel-redirect: the address of a location of the proxy, \"/NAME/\", beside proxy-host");
  const bool is_slurm = options.engine == SlurmEngine::kName;
  Require(is_slurm || options.engine == kLocalEngine, ErrorCode::kUsage,
          "there is no engine '" + options.engine + "': local, slurm");
  if (is_slurm) CheckSlurmOptions(options.slurm);
  Require(options.job_command && options.compare_command, ErrorCode::kInternal,
          "the service has no worker");
  return options;
}

JobRunnerOptions RunnerOptions(const ServeOptions& options, Store& store) {
  JobRunnerOptions runner;
  runner.command = options.job_command;
  runner.num_workers = options.num_workers;
  runner.limits = options.job_limits;
  if (options.engine == SlurmEngine::kName)
    runner.engine = std::make_shared<SlurmEngine>(store, options.job_command, options.job_limits,
                                                  options.slurm);
  return runner;
}

/// What listeners show of drives and versions has changed.
void AnnounceExpired(const Expired& expired, EventHub& events) {
  for (const std::string& drive : expired.drives) events.Publish("drive", drive);
  for (const auto& [site, version] : expired.maps)
    events.Publish("map", site + "/" + std::to_string(version));
}

}  // namespace

class Service::Parts {
 public:
  explicit Parts(const ServeOptions& options)
      : options_(Checked(options)),
        store_(options_.data),
        comparer_(store_.directory, options_.compare_command),
        accel_(options_.accel_redirect, options_.proxy_host),
        viewer_(options_.web_root),
        basemap_(options_.basemap),
        gate_(store_.database, options_.request_rate),
        http_(shutdown_signal_, metrics_, options_.num_threads,
              {.allows_any_host =
                   [this] {
                     // Where names are named, no others.
                     return options_.allow_public ||
                            (options_.proxy_host.empty() && !gate_.was_open());
                   },
               .proxy_host = options_.proxy_host,
               .is_known = [this](const RequestHead& head) { return gate_.IsKnown(head); }}) {
    RequireTokenForPublic();
    store_.disk_reserve = options_.disk_reserve;
    store_.database.OnFreeze([this] {
      if (on_disk_failure_) on_disk_failure_();
    });
    store_.inspects_drives = static_cast<bool>(options_.inspect_command);
    ReconcileFiles(store_);
    const ListenAddress address = CheckedAddress(options_);
    port_ = http_.Bind(address.host, address.port);
    const bool is_ipv6 = address.host.find(':') != std::string::npos;
    address_ = "http://" + (is_ipv6 ? "[" + address.host + "]" : address.host) + ":" +
               std::to_string(port_);
    jobs_.emplace(store_, events_, RunnerOptions(options_, store_));
    if (options_.inspect_command)
      inspector_.emplace(store_, events_, options_.inspect_command, [this] { jobs_->Wake(); });
    if (options_.pictures.command)
      pictures_.emplace(store_.directory, options_.pictures, [this](const std::string& id) {
        return store_.database.Read([&](Connection& connection) { return HasLog(connection, id); });
      });
    uploads_.emplace(store_, OptionsOfUploads());
    webhooks_.emplace(store_, options_.webhooks);
    context_.emplace(RouteContext{options_, store_, events_, *jobs_, comparer_, *uploads_,
                                  *webhooks_, inspector_ ? &*inspector_ : nullptr,
                                  pictures_ ? &*pictures_ : nullptr, gate_, metrics_,
                                  shutdown_signal_, accel_});
    AddHandlers();
    scrubber_.emplace(store_, std::chrono::days(options_.scrub_days));
    keeper_.emplace(store_, kRetentionInterval,
                    [this](const Expired& expired) { AnnounceExpired(expired, events_); });
  }

  void Run() {
    http_.Run();
    jobs_->Stop();
  }

  void Stop(std::chrono::milliseconds patience) {
    shutdown_signal_.Cut(patience);
    comparer_.Stop();
    if (pictures_) pictures_->Stop();
    uploads_->Stop();
    events_.Close();
    http_.Wake();
  }

  const std::string& address() const { return address_; }
  int port() const { return port_; }
  void OnDiskFailure(std::function<void()> listener) { on_disk_failure_ = std::move(listener); }
  bool has_disk_failed() const { return store_.database.is_frozen(); }

 private:
  void RequireTokenForPublic() {
    const bool is_public = options_.allow_public || !options_.proxy_host.empty();
    Require(
        !is_public || store_.database.Read(HasUsableAdmin), ErrorCode::kUsage,
        "--allow-public and --proxy-host need a token, so that not everybody may do everything: "
        "parkade token create NAME --role admin --data " +
            options_.data.string());
  }

  UploadOptions OptionsOfUploads() {
    UploadOptions uploads;
    uploads.check_log = [this](const std::filesystem::path& file, const std::string& filename) {
      CheckLog(options_, file, filename);
    };
    uploads.check_paths = options_.check_paths;
    uploads.on_received = [this](const ReceivedDrive& received) {
      AnnounceDrive(received, events_, *jobs_, inspector_ ? &*inspector_ : nullptr);
    };
    uploads.merge_drives = options_.merge_drives;
    return uploads;
  }

  void AddHandlers() {
    http_.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                               {"Content-Security-Policy", ContentSecurityPolicy(basemap_)},
                               {"Referrer-Policy", "no-referrer"},
                               {"Cross-Origin-Resource-Policy", "same-origin"}});
    http_.set_pre_routing_handler(
        [this](const httplib::Request& request, httplib::Response& response) {
          const bool is_sent = viewer_.Send(request, response) || basemap_.Send(request, response);
          return is_sent ? httplib::Server::HandlerResponse::Handled
                         : httplib::Server::HandlerResponse::Unhandled;
        });
    http_.set_exception_handler(
        [this](const httplib::Request&, httplib::Response& response,
               const std::exception_ptr& thrown) { Explain(response, thrown); });
    http_.set_error_handler([this](const httplib::Request& request, httplib::Response& response) {
      const bool is_lost = response.status == 404 && response.body.empty();
      if (!is_lost || !viewer_.SendForLostPerson(request, response))
        ExplainError(request, response);
    });
    http_.set_expect_100_continue_handler(
        [this](const httplib::Request& request, httplib::Response& response) {
          return Expected(request, response);
        });
    http_.set_logger([this](const httplib::Request&, const httplib::Response& response) {
      const size_t status_class = static_cast<size_t>(std::clamp(response.status / 100, 0, 5));
      ++metrics_.answers_by_class[status_class];
    });
    Router router(http_, gate_);
    AddUploadRoute(router, *context_);
    AddTusRoutes(router, *context_);
    AddUploadSetRoutes(router, *context_);
    AddDriveRoutes(router, *context_);
    AddPictureRoutes(router, *context_);
    AddPlotRoutes(router, *context_);
    AddRigRoutes(router, *context_);
    AddJobRoutes(router, *context_);
    AddReviewRoutes(router, *context_);
    AddCommentRoutes(router, *context_);
    AddMapRoutes(router, *context_);
    AddCompareRoute(router, *context_);
    AddSiteRoutes(router, *context_);
    AddOverviewRoutes(router, *context_);
    AddMeasurementRoutes(router, *context_);
    AddWebhookRoutes(router, *context_);
    AddEventRoute(router, *context_);
    AddSessionRoutes(router, *context_);
    AddTokenRoutes(router, *context_);
    AddShareRoutes(router, *context_);
    AddAuditRoute(router, *context_);
    AddStatusRoutes(router, *context_);
  }

  /// A disk that failed under an upload is not written to any more.
  void Explain(httplib::Response& response, const std::exception_ptr& thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const DiskFailure& failure) {
      store_.database.Freeze(failure.what());
      SendProblem(response, {503, "disk_failed",
                             "the disk of the service failed: nothing is stored until it is "
                             "started again"});
    } catch (...) {
      SendException(response, thrown);
    }
  }

  /// Gives the library's own bare refusals a body.
  static void ExplainError(const httplib::Request& request, httplib::Response& response) {
    if (!response.body.empty() || response.status == 503) return;
    if (response.status != 404) {
      SendProblem(response, {response.status, "invalid_request", "the request is malformed"});
      return;
    }
    const std::set<std::string_view> methods = MethodsOf(request.path);
    if (methods.empty() || methods.contains(request.method)) {
      SendProblem(response, {404, "not_found", "there is nothing at this address"});
      return;
    }
    std::string allowed;
    for (const std::string_view method : methods)
      allowed.append(allowed.empty() ? "" : ", ").append(method);
    response.set_header("Allow", allowed);
    SendProblem(response, {405, "method_not_allowed", "this address knows " + allowed});
  }

  /// Tells a client that asked before sending a large body whether it may go on.
  int Expected(const httplib::Request& request, httplib::Response& response) {
    if (request.method != "PUT" || request.path != "/api/v1/drives") return 100;
    try {
      const Caller caller = gate_.Admit(RouteOf(request.method, request.path), request, response);
      const WorkFor scope(caller);
      CheckUpload(request, *context_);
      return 100;
    } catch (const std::exception&) {
      SendException(response, std::current_exception());
      return response.status;
    }
  }

  const ServeOptions options_;
  ShutdownSignal shutdown_signal_;
  Metrics metrics_;
  EventHub events_;
  Store store_;
  MapComparer comparer_;
  AccelRedirect accel_;
  ViewerFiles viewer_;
  Basemap basemap_;
  Gate gate_;
  HttpServer http_;
  std::optional<JobRunner> jobs_;
  std::optional<DriveInspector> inspector_;
  std::optional<PictureDesk> pictures_;
  std::optional<ResumableUploads> uploads_;
  std::optional<WebhookSender> webhooks_;
  std::optional<RouteContext> context_;
  std::optional<Scrubber> scrubber_;
  std::optional<RetentionKeeper> keeper_;
  std::function<void()> on_disk_failure_;
  std::string address_;
  int port_ = 0;
};

Service::Service(const ServeOptions& options) : parts_(std::make_unique<Parts>(options)) {}
Service::~Service() = default;
const std::string& Service::address() const { return parts_->address(); }
int Service::port() const { return parts_->port(); }
void Service::OnDiskFailure(std::function<void()> listener) {
  parts_->OnDiskFailure(std::move(listener));
}
bool Service::has_disk_failed() const { return parts_->has_disk_failed(); }
void Service::Run() { parts_->Run(); }
void Service::Stop(std::chrono::milliseconds patience) { parts_->Stop(patience); }

}  // namespace parkade
