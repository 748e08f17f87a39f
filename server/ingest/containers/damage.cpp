#include "server/ingest/containers/damage.h"

#include <set>

namespace parkade {

DamageReport OfWanted(const DamageReport& damage, const std::vector<TopicInfo>& topics,
                      const std::vector<bool>& wanted) {
  std::set<std::string> unwanted;
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (!wanted[i]) unwanted.insert(topics[i].topic);
  DamageReport rest = damage;
  std::erase_if(rest.ranges, [&](const LostRange& range) {
    const bool is_unwanted = unwanted.contains(range.topic);
    if (is_unwanted) rest.num_lost_messages -= range.num_messages;
    return is_unwanted;
  });
  return rest;
}

}  // namespace parkade
