#include "mapping/networks/tell_classes.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/math/vectorized.h"
#include "mapping/networks/vectors.h"

namespace parkade {
namespace {

constexpr std::size_t kPiece = 64;  // pixels at once
constexpr float kLog2 = 0.693147181F;
constexpr float kLog2High = 0.693145752F, kLog2Low = 1.42860677e-6F;  // parts of it: few bits, rest
constexpr std::uint32_t kExponent = 0x7f800000;                       // all set: infinite or NaN
constexpr auto kLowest = std::bit_cast<std::uint32_t>(-55.0F);        // of scores below the best

/// exp(x) for x in -55..0, to 3e-7 of it: 2^i by the exponent's bits, the rest by its series.
PARKADE_INLINE float Exp(float x) {
  const auto whole = static_cast<std::int32_t>(x * (1 / kLog2) - 0.5F);
  const auto multiple = static_cast<float>(whole);
  const float rest = x - multiple * kLog2High - multiple * kLog2Low;
  const float power =
      1 +
      rest * (1 + rest * (1 / 2.0F +
                          rest * (1 / 6.0F +
                                  rest * (1 / 24.0F + rest * (1 / 120.0F + rest * (1 / 720.0F))))));
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(power) + whole * (1 << 23));
}

/// log(x) of a normal number above 0, to 2e-7 of it or of 1: log(m) + e log(2), with m about 1,
/// by the series of atanh.
PARKADE_INLINE float Log(float x) {
  constexpr std::int32_t kRootOfHalf = 0x3f3504f3;
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - kRootOfHalf) >> 23;
  const float mantissa = std::bit_cast<float>(bits - exponent * (1 << 23));
  const float s = (mantissa - 1) / (mantissa + 1), square = s * s;
  return static_cast<float>(exponent) * kLog2 +
         2 * s *
             (1 + square * (1 / 3.0F + square * (1 / 5.0F + square * (1 / 7.0F + square / 9.0F))));
}

PARKADE_INLINE std::uint32_t IsFinite(float x) {
  return (std::bit_cast<std::uint32_t>(x) & kExponent) == kExponent ? 0 : ~std::uint32_t{0};
}

struct Piece {
  std::array<float, kPiece> highest, for_cars{}, others{};
  std::array<std::int32_t, kPiece> best{};
  std::array<std::uint32_t, kPiece> is_finite;  ///< all bits or none: whether all scores are

  Piece() {
    highest.fill(-std::numeric_limits<float>::infinity());
    is_finite.fill(~std::uint32_t{0});
  }
};

PARKADE_VECTORIZED_FLOATS void FindBest(const float* __restrict scores, std::int32_t number,
                                        Piece& piece) {
  for (std::size_t i = 0; i < kPiece; ++i) {
    const bool is_higher = scores[i] > piece.highest[i];
    piece.highest[i] = is_higher ? scores[i] : piece.highest[i];
    piece.best[i] = is_higher ? number : piece.best[i];
    piece.is_finite[i] &= IsFinite(scores[i]);
  }
}

PARKADE_VECTORIZED_FLOATS void AddLikelihoods(const float* __restrict scores,
                                              const float* __restrict highest,
                                              const std::uint32_t* __restrict is_finite,
                                              float weight, float* __restrict sums) {
  for (std::size_t i = 0; i < kPiece; ++i) {
    // As integers numbers below zero rise with their size; of floats there would be no vectors.
    const std::uint32_t below = std::bit_cast<std::uint32_t>(scores[i] - highest[i]) & is_finite[i];
    sums[i] += weight * Exp(std::bit_cast<float>(below < kLowest ? below : kLowest));
  }
}

PARKADE_VECTORIZED_FLOATS void TakeLogOdds(const float* __restrict for_cars,
                                           const float* __restrict others,
                                           const std::uint32_t* __restrict is_finite,
                                           float* __restrict log_odds) {
  for (std::size_t i = 0; i < kPiece; ++i)
    log_odds[i] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(Log(for_cars[i] / others[i])) &
                                       is_finite[i]);
}

/// Fills in one piece.
void TellPiece(const ClassScores& scores, const std::array<float, kNumSurfaceClasses>& overrated,
               std::uint8_t* classes, float* log_odds) {
  Piece piece;
  for (std::size_t k = 0; k < scores.size(); ++k)
    FindBest(scores[k], static_cast<std::int32_t>(k), piece);
  for (std::size_t k = 0; k < scores.size(); ++k)
    AddLikelihoods(
        scores[k], piece.highest.data(), piece.is_finite.data(), 1 / overrated[k],
        (IsForCars(static_cast<SurfaceClass>(k)) ? piece.for_cars : piece.others).data());
  TakeLogOdds(piece.for_cars.data(), piece.others.data(), piece.is_finite.data(), log_odds);
  for (std::size_t i = 0; i < kPiece; ++i) classes[i] = static_cast<std::uint8_t>(piece.best[i]);
}

}  // namespace

void TellClasses(const ClassScores& scores, const std::array<float, kNumSurfaceClasses>& overrated,
                 std::span<std::uint8_t> classes, float* log_odds) {
  std::size_t begin = 0;
  for (; begin + kPiece <= classes.size(); begin += kPiece) {
    ClassScores of_piece = scores;
    for (const float*& of_class : of_piece) of_class += begin;
    TellPiece(of_piece, overrated, classes.data() + begin, log_odds + begin);
  }
  const std::size_t rest = classes.size() - begin;
  if (rest == 0) return;
  std::array<std::array<float, kPiece>, kNumSurfaceClasses> padded{};
  ClassScores of_padded{};
  for (std::size_t k = 0; k < scores.size(); ++k) {
    std::copy_n(scores[k] + begin, rest, padded[k].begin());
    of_padded[k] = padded[k].data();
  }
  std::array<std::uint8_t, kPiece> last_classes;
  std::array<float, kPiece> last_log_odds;
  TellPiece(of_padded, overrated, last_classes.data(), last_log_odds.data());
  std::copy_n(last_classes.begin(), rest, classes.begin() + static_cast<std::ptrdiff_t>(begin));
  std::copy_n(last_log_odds.begin(), rest, log_odds + begin);
}

}  // namespace parkade
