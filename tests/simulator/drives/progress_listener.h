#pragma once

#include <functional>
#include <string>

namespace parkade::simulator {

/// Called now and then with what is being done and how far it is, 0..1.
using ProgressListener = std::function<void(const std::string& stage, double fraction)>;

}  // namespace parkade::simulator
