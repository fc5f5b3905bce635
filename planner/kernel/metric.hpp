// How long the arms take between two poses, in whole nanoseconds: sums of them are exact, so no
// exchange hangs on round-off.

#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

using Time = std::int64_t;

// Tables of one arm, places x places: going there, or to where the run-up begins, then the run-up.
struct ArmTimes {
    int places = 0;
    std::vector<Time> go, run;

    Time go_between(int a, int b) const { return go[std::size_t(a) * places + b]; }
    Time run_between(int a, int b) const { return run[std::size_t(a) * places + b]; }
};

// Where both arms are.
struct Pose {
    int view, light;
};

class Metric {
   public:
    Metric(ArmTimes view, ArmTimes light)
        : view_(std::move(view)), light_(std::move(light)), has_runs_(has_runs(view_, light_)) {}

    // The true time of a move that takes longer than its axes alone would.
    void override_move(Pose a, Pose b, Time time) {
        if (slow_.empty()) from_.assign(std::size_t(view_.places) * light_.places, 0);
        from_[number(a)] = 1;
        slow_[number(a) * from_.size() + number(b)] = time;
    }

    // Both arms go together, then those with a run-up make it together.
    Time between(Pose a, Pose b) const {
        Time time = std::max(view_.go_between(a.view, b.view), light_.go_between(a.light, b.light));
        if (has_runs_)
            time += std::max(view_.run_between(a.view, b.view),
                             light_.run_between(a.light, b.light));
        if (!slow_.empty() && from_[number(a)]) {
            const auto found = slow_.find(number(a) * from_.size() + number(b));
            if (found != slow_.end()) return found->second;
        }
        return time;
    }

    // What both arms take one after the other: tells moves apart that take the same time.
    Time effort(Pose a, Pose b) const {
        return view_.go_between(a.view, b.view) + light_.go_between(a.light, b.light);
    }

    bool is_symmetric() const {
        return slow_.empty() && is_symmetric(view_) && is_symmetric(light_);
    }

   private:
    static bool has_runs(const ArmTimes& view, const ArmTimes& light) {
        const auto is_time = [](Time time) { return time != 0; };
        return std::any_of(view.run.begin(), view.run.end(), is_time) ||
               std::any_of(light.run.begin(), light.run.end(), is_time);
    }
    static bool is_symmetric(const ArmTimes& arm) {
        for (int a = 0; a < arm.places; ++a)
            for (int b = 0; b < a; ++b)
                if (arm.go_between(a, b) != arm.go_between(b, a) ||
                    arm.run_between(a, b) != arm.run_between(b, a))
                    return false;
        return true;
    }
    std::uint64_t number(Pose pose) const {
        return std::uint64_t(pose.view) * light_.places + pose.light;
    }

    ArmTimes view_, light_;
    bool has_runs_;
    std::vector<char> from_;
    std::unordered_map<std::uint64_t, Time> slow_;
};
