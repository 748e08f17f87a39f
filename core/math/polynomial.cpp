#include "core/math/polynomial.h"

#include <cstddef>

namespace parkade {
namespace {

double Evaluate(const std::vector<double>& coefficients, double x) {
  double value = 0;
  for (size_t i = coefficients.size(); i-- > 0;) value = value * x + coefficients[i];
  return value;
}

double Bisect(const std::vector<double>& coefficients, double begin, double end) {
  const bool is_positive_at_begin = Evaluate(coefficients, begin) > 0;
  for (;;) {
    const double middle = 0.5 * (begin + end);
    if (!(begin < middle && middle < end)) return middle;  // neighboring doubles
    (Evaluate(coefficients, middle) > 0 ? is_positive_at_begin : !is_positive_at_begin)
        ? begin = middle
        : end = middle;
  }
}

}  // namespace

std::vector<double> FindSignChanges(const std::vector<double>& coefficients, double begin,
                                    double end) {
  if (coefficients.size() < 2) return {};
  std::vector<double> derivative;
  for (size_t i = 1; i < coefficients.size(); ++i)
    derivative.push_back(static_cast<double>(i) * coefficients[i]);

  // Between two extrema the polynomial is monotonic: at most one root.
  std::vector<double> borders = {begin};
  for (const double extremum : FindSignChanges(derivative, begin, end)) borders.push_back(extremum);
  borders.push_back(end);
  std::vector<double> roots;
  for (size_t i = 1; i < borders.size(); ++i) {
    const bool changes =
        (Evaluate(coefficients, borders[i - 1]) > 0) != (Evaluate(coefficients, borders[i]) > 0);
    if (changes) roots.push_back(Bisect(coefficients, borders[i - 1], borders[i]));
  }
  return roots;
}

}  // namespace parkade
