#pragma once

#include "server/http/access/gate.h"
#include "server/http/metrics.h"
#include "server/http/routes/accel_redirect.h"
#include "server/http/serve_options.h"
#include "server/http/shutdown_signal.h"
#include "server/jobs/drive_inspector.h"
#include "server/jobs/event_hub.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/map_comparer.h"
#include "server/jobs/pictures/picture_desk.h"
#include "server/store/store.h"
#include "server/store/uploads/resumable_uploads.h"
#include "server/webhooks/webhook_sender.h"

namespace parkade {

/// The objects that handlers work with. Outlives the server they are added to.
struct RouteContext {
  const ServeOptions& options;
  Store& store;
  EventHub& events;
  JobRunner& jobs;
  MapComparer& comparer;
  ResumableUploads& uploads;
  WebhookSender& webhooks;
  DriveInspector* inspector;  ///< null where nobody looks at logs
  PictureDesk* pictures;      ///< null where nobody reads pictures
  Gate& gate;
  Metrics& metrics;
  const ShutdownSignal& shutdown_signal;
  AccelRedirect& accel;
};

}  // namespace parkade
