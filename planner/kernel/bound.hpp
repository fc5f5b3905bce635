// What no open route can beat: a shortest tree with prices on the nodes (Held and Karp 1971).

#pragma once

#include <vector>

#include "metric.hpp"

// A lower bound of the time of any route through all `nodes`, whatever its order.
//
// `metric` must be symmetric; `order` is a route, whose time guides how far each step goes.
Time least_route(const Metric& metric, const std::vector<Pose>& nodes,
                 const std::vector<int>& order);
