#pragma once

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <opencv2/core/utility.hpp>

#include "core/parallel.h"
#include "core/tune_malloc.h"

namespace parkade {

/// The end of a bench's main: reads the command line into what `app` is bound to, then runs on
/// `num_threads`. What goes wrong is said in one sentence, exit status 2.
template <typename Run>
int RunBench(CLI::App& app, int argc, char** argv, const int& num_threads, Run run) {
  CLI11_PARSE(app, argc, argv);
  try {
    SetNumThreads(num_threads);
    cv::setNumThreads(1);  // as the product: core/parallel works on many images at once
    KeepLinearAlgebraToCaller();
    TuneMalloc();  // as `parkade map`
    return run();
  } catch (const std::exception& error) {
    std::cerr << app.get_name() << ": " << error.what() << "\n";
    return 2;
  }
}

}  // namespace parkade
