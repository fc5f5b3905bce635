// Python's side of the route: checks shapes and numbers, adds the place that is nowhere.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "bound.hpp"
#include "search.hpp"

namespace py = pybind11;

namespace {

using Table = py::array_t<Time, py::array::c_style>;
using Numbers = py::array_t<std::int64_t, py::array::c_style>;
using Places = std::vector<std::vector<int>>;

void check(bool fits, const char* what) {
    if (!fits) throw std::invalid_argument(what);
}

std::vector<Time> with_nowhere(const Table& table, py::ssize_t places) {
    check(table.ndim() == 2 && table.shape(0) == places && table.shape(1) == places,
          "the tables of an arm must be square and alike");
    std::vector<Time> wide((places + 1) * (places + 1), 0);
    for (py::ssize_t a = 0; a < places; ++a)
        for (py::ssize_t b = 0; b < places; ++b) wide[a * (places + 1) + b] = table.at(a, b);
    return wide;
}

ArmTimes arm_times(const Table& go, const Table& run) {
    const py::ssize_t places = go.ndim() == 2 ? go.shape(0) : -1;
    return {int(places) + 1, with_nowhere(go, places), with_nowhere(run, places)};
}

struct PlacedMetric {
    Metric metric;
    Pose places;

    PlacedMetric(const Table& view_go, const Table& view_run, const Table& light_go,
                const Table& light_run)
        : metric(arm_times(view_go, view_run), arm_times(light_go, light_run)),
          places{int(view_go.shape(0)), int(light_go.shape(0))} {}

    void check_pose(std::int64_t view, std::int64_t light) const {
        check(view >= 0 && view < places.view && light >= 0 && light < places.light,
              "there is no such place");
    }
    std::vector<Pose> poses(const Numbers& numbers) const {
        check(numbers.ndim() == 2 && numbers.shape(1) == 2, "poses must have shape (n, 2)");
        std::vector<Pose> all;
        for (py::ssize_t i = 0; i < numbers.shape(0); ++i) {
            check_pose(numbers.at(i, 0), numbers.at(i, 1));
            all.push_back({int(numbers.at(i, 0)), int(numbers.at(i, 1))});
        }
        return all;
    }
    void override_moves(const Numbers& from, const Numbers& to, const Numbers& times) {
        const auto starts = poses(from), goals = poses(to);
        check(starts.size() == goals.size() && times.ndim() == 1 &&
                  std::size_t(times.shape(0)) == starts.size(),
              "each move needs a start, a goal and a time");
        for (std::size_t i = 0; i < starts.size(); ++i)
            metric.override_move(starts[i], goals[i], times.at(i));
    }
};

std::vector<int> checked_order(const Numbers& numbers, std::size_t count) {
    check(count > 0 && numbers.ndim() == 1 && std::size_t(numbers.shape(0)) == count,
          "the order must name every shot");
    std::vector<char> seen(count, 0);
    std::vector<int> order;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t shot = numbers.at(i);
        check(shot >= 0 && std::size_t(shot) < count && !seen[shot],
              "the order must name every shot once");
        seen[shot] = 1;
        order.push_back(int(shot));
    }
    return order;
}

void check_places(const Places& places, int directions, int count) {
    check(places.size() == std::size_t(directions), "each direction needs its places");
    for (const auto& list : places)
        for (const int place : list) check(place >= 0 && place < count, "there is no such place");
}

py::tuple search(const PlacedMetric& metric, const PlacedMetric& near, Places view_places,
                 Places light_places, const Numbers& directions, const Numbers& poses,
                 const Numbers& order, std::int64_t work, std::uint64_t seed) {
    check_places(view_places, near.places.view, metric.places.view);
    check_places(light_places, near.places.light, metric.places.light);
    Shots shots{near.poses(directions), std::move(view_places), std::move(light_places)};
    auto stands = metric.poses(poses);
    auto route = checked_order(order, shots.directions.size());
    check(stands.size() == route.size(), "each shot needs a pose");
    shots.directions.push_back(near.places);
    stands.push_back(metric.places);
    shots.view_places.push_back({metric.places.view});
    shots.light_places.push_back({metric.places.light});
    const auto count = py::ssize_t(route.size());
    {
        py::gil_scoped_release unlocked;
        Search local(metric.metric, near.metric, std::move(shots), std::move(stands),
                     std::move(route), seed);
        local.settle();
        local.kick(work);
        route = local.order();
        stands = local.poses();
    }
    Numbers best(count), taken({count, py::ssize_t(2)});
    for (py::ssize_t i = 0; i < count; ++i) {
        best.mutable_at(i) = route[i];
        taken.mutable_at(i, 0) = stands[i].view;
        taken.mutable_at(i, 1) = stands[i].light;
    }
    return py::make_tuple(best, taken);
}

Time bound(const PlacedMetric& near, const Numbers& directions, const Numbers& order) {
    const auto nodes = near.poses(directions);
    const auto route = checked_order(order, nodes.size());
    check(near.metric.is_symmetric(), "this bound is for times without a direction");
    py::gil_scoped_release unlocked;
    return least_route(near.metric, nodes, route);
}

}  // namespace

PYBIND11_MODULE(_route, module) {
    module.doc() = "Short routes and what no route can beat; see planner/route.py.";
    py::class_<PlacedMetric>(module, "Metric")
        .def(py::init<const Table&, const Table&, const Table&, const Table&>(),
             py::arg("view_go"), py::arg("view_run"),
             py::arg("light_go"), py::arg("light_run"))
        .def("override", &PlacedMetric::override_moves, py::arg("starts"), py::arg("goals"),
             py::arg("times"));
    module.def("search", &search, py::arg("metric"), py::arg("near"), py::arg("view_places"),
               py::arg("light_places"), py::arg("directions"), py::arg("poses"), py::arg("order"),
               py::arg("work"), py::arg("seed"));
    module.def("bound", &bound, py::arg("near"), py::arg("directions"), py::arg("order"));
}
