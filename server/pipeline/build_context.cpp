#include "server/pipeline/build_context.h"

#include "core/error.h"
#include "core/log.h"

namespace parkade {
namespace {

/// The map to start from; nothing where the build starts anew, or from a folder without a report.
std::optional<MapReader> OpenFrom(const BuildScope& scope) {
  if (scope.from.empty()) return std::nullopt;
  try {
    return MapReader(scope.from);
  } catch (const Error& error) {
    LogWarning(std::string("all drives are tracked: ") + error.what());
    return std::nullopt;
  }
}

}  // namespace

BuildContext::BuildContext(const MapOptions& map_options, const BuildScope& build_scope)
    : options(map_options),
      scope(build_scope),
      cache(build_scope.from, build_scope.products, build_scope.work),
      from(OpenFrom(build_scope)) {}

}  // namespace parkade
