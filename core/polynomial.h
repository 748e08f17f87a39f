#pragma once

#include <vector>

namespace parkade {

/// Real roots of c[0] + c[1] x + c[2] x^2 + ... inside (begin, end), in increasing order, where the
/// polynomial changes its sign. For the small degrees of lens models: recursive over the
/// derivative.
std::vector<double> FindSignChanges(const std::vector<double>& coefficients, double begin,
                                    double end);

}  // namespace parkade
