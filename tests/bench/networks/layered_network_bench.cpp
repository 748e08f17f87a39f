// One core: Parkade's own networks by OpenCV's dnn and by layers of our own. Argument: which.
#include <benchmark/benchmark.h>

#include <array>
#include <opencv2/core.hpp>

#include "mapping/networks/builtin_network.h"
#include "mapping/networks/network_copies.h"

namespace parkade {
namespace {

struct Case {
  std::string_view name, model;
  std::vector<int> sizes;
};

Case CaseOf(std::int64_t which) {
  switch (which) {
    case 0: return {"level", BuiltinLevelNetwork(), {1, 3, 288, 832}};
    case 1: return {"freespace", BuiltinFreespaceNetwork(), {1, 3, 384, 640}};
    default: return {"outlines", BuiltinOutlineNetwork(), {1, 15, 448, 448}};
  }
}

void RunNetwork(benchmark::State& state, NetworkRuntime runtime) {
  cv::setNumThreads(1);
  const Case network = CaseOf(state.range(0));
  NetworkCopies copies(std::string(network.model), runtime);
  cv::Mat input(network.sizes, CV_32F);
  cv::randu(input, 0, 255);
  for (auto _ : state) benchmark::DoNotOptimize(copies.Run(input).data);
  state.SetLabel(std::string(network.name));
}

BENCHMARK_CAPTURE(RunNetwork, opencv, NetworkRuntime::kOpenCv)
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(RunNetwork, layered, NetworkRuntime::kLayered)
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace parkade
