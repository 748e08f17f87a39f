#include "slam/sessions/reviewed_links.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

struct End {
  size_t drive = 0, keyframe = 0;
};

/// "DRIVE:KEYFRAME". A drive's name may hold anything.
std::optional<End> ParseEnd(const std::string& text, const std::vector<std::string>& names) {
  const size_t colon = text.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  const auto name = std::find(names.begin(), names.end(), text.substr(0, colon));
  End end{static_cast<size_t>(name - names.begin()), 0};
  const char* const stop = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, stop, end.keyframe);
  if (name == names.end() || parsed.ec != std::errc() || parsed.ptr != stop) return std::nullopt;
  return end;
}

std::vector<LinkEnds> EndsOf(const std::vector<std::string>& ids,
                             const std::vector<std::string>& names) {
  std::vector<LinkEnds> links;
  for (const std::string& id : ids)
    if (const auto ends = FindEnds(id, names)) links.push_back(*ends);
  return links;
}

bool Holds(const std::vector<LinkEnds>& links, const LinkEnds& link) {
  return std::find(links.begin(), links.end(), link) != links.end();
}

LinkEnds EndsIn(const DrivePair& pair, const SessionLoop& link) {
  return {pair.drive_a, link.keyframe_a, pair.drive_b, link.keyframe_b};
}

}  // namespace

std::optional<LinkEnds> FindEnds(const std::string& id, const std::vector<std::string>& names) {
  for (size_t at = id.find('~'); at != std::string::npos; at = id.find('~', at + 1)) {
    std::optional<End> a = ParseEnd(id.substr(0, at), names),
                       b = ParseEnd(id.substr(at + 1), names);
    if (!a || !b || a->drive == b->drive) continue;
    if (a->drive > b->drive) std::swap(a, b);
    return LinkEnds{a->drive, a->keyframe, b->drive, b->keyframe};
  }
  return std::nullopt;
}

std::string NameOf(const LinkEnds& ends, const std::vector<std::string>& names) {
  return names[ends.drive_a] + ":" + std::to_string(ends.keyframe_a) + "~" + names[ends.drive_b] +
         ":" + std::to_string(ends.keyframe_b);
}

ReviewedLinks::ReviewedLinks(const LinkReview& review, const std::vector<std::string>& names)
    : rejected_(EndsOf(review.rejected, names)), forced_(EndsOf(review.forced, names)) {}

bool ReviewedLinks::Rejects(const LinkEnds& link) const { return Holds(rejected_, link); }

void ReviewedLinks::Judge(DrivePair& pair) const {
  std::vector<SessionLoop> kept;
  for (SessionLoop& link : pair.found.links) {
    const LinkEnds ends = EndsIn(pair, link);
    if (Rejects(ends)) {
      pair.rejected.push_back({std::move(link), 0});
      continue;
    }
    pair.is_forced.push_back(Holds(forced_, ends));
    kept.push_back(std::move(link));
  }
  pair.found.links = std::move(kept);
  pair.weights.resize(pair.found.links.size());
  pair.chi_squared.resize(pair.found.links.size());
  if (pair.found.links.empty() && !pair.rejected.empty())
    pair.found.rejected = "a reviewer rejected all links";
}

bool HasLink(const DrivePair& pair, const LinkEnds& ends) {
  const auto& links = pair.found.links;
  return std::any_of(links.begin(), links.end(),
                     [&](const SessionLoop& link) { return EndsIn(pair, link) == ends; }) ||
         std::any_of(pair.rejected.begin(), pair.rejected.end(), [&](const RejectedLink& rejected) {
           return EndsIn(pair, rejected.link) == ends;
         });
}

void RequireLinks(const LinkReview& review, const std::vector<std::string>& names,
                  const std::vector<DrivePair>& pairs) {
  const auto ends_of = [&](const std::string& id) {
    const std::optional<LinkEnds> ends = FindEnds(id, names);
    Require(ends.has_value(), ErrorCode::kUsage,
            "'" + id + "' names no two places of drives of this map, DRIVE:PLACE~DRIVE:PLACE");
    return *ends;
  };
  const auto is_there = [&](const LinkEnds& ends) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const DrivePair& pair) { return HasLink(pair, ends); });
  };
  for (const std::string& id : review.rejected)
    Require(is_there(ends_of(id)), ErrorCode::kUsage,
            "no link between the drives is called '" + id + "'; report.json names them");
  for (const std::string& id : review.forced)
    Require(is_there(ends_of(id)), ErrorCode::kUsage,
            "the link '" + id +
                "' cannot be forced: its two places show too little in common to measure it");
}

}  // namespace parkade
