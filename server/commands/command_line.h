#pragma once

namespace parkade {

/// `parkade`'s command line. \return the exit status: 0 done, 1 the input is at fault, 2 usage, 3
/// our fault
int RunCommandLine(int argc, const char* const* argv);

}  // namespace parkade
