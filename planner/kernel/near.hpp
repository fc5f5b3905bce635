// The nearest shots of each shot, over all the places that their directions can be taken from.

#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "metric.hpp"

struct Near {
    int node;
    Time time;
};

using NearLists = std::vector<std::vector<Near>>;

// Up to `width` nodes that are reached soonest from each node, or from which it is, nearest first;
// of equally near ones those that ask least of both arms, then those of the lowest number.
inline NearLists nearest_nodes(const Metric& metric, const std::vector<Pose>& nodes, int width,
                               bool from_it = true) {
    const int count = int(nodes.size());
    using Rank = std::tuple<Time, Time, int>;
    std::vector<Rank> ranks(count);
    NearLists all(count);
    const int wanted = std::min(width, count - 1);
    for (int a = 0; a < count; ++a) {
        for (int b = 0; b < count; ++b) {
            const Pose start = nodes[from_it ? a : b], goal = nodes[from_it ? b : a];
            ranks[b] = {metric.between(start, goal), metric.effort(start, goal), b};
        }
        std::swap(ranks[a], ranks.back());
        std::nth_element(ranks.begin(), ranks.begin() + wanted, ranks.end() - 1);
        std::sort(ranks.begin(), ranks.begin() + wanted);
        for (int i = 0; i < wanted; ++i)
            all[a].push_back({std::get<2>(ranks[i]), std::get<0>(ranks[i])});
    }
    return all;
}
