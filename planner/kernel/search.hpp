// Iterated local search for a short open route (Lourenco, Martin and Stuetzle 2003): parts are
// reversed (2-opt), small parts moved (Or-opt), parts exchanged (3-opt without reversal), other
// places taken; then a random kick, kept if what it leads to is no longer, or hardly, at first more
// than at last (Martin, Otto and Felten 1991). Neighbour lists and a queue of the nodes to look at
// after Bentley 1992.

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "metric.hpp"
#include "near.hpp"
#include "tour.hpp"

// What a search is about: the direction of each shot on either arm, and the places of a direction.
struct Shots {
    std::vector<Pose> directions;
    std::vector<std::vector<int>> view_places, light_places;
};

// Numbers that repeat on any machine: splitmix64 (Steele, Lea and Flood 2014).
class Random {
   public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    int below(int bound) { return int(next() % std::uint64_t(bound)); }
    // Between 0 and 1, neither included.
    double unit() { return (double(next() >> 12) + 0.5) / 4503599627370496.0; }

   private:
    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

class Search {
   public:
    // `metric` is between places, `near` between directions; the last shot is nowhere, no time
    // away from any: the route, closed through it, ends there.
    Search(const Metric& metric, const Metric& near, Shots shots, std::vector<Pose> poses,
           std::vector<int> order, std::uint64_t seed);

    // Exchange until nothing is left that saves time.
    void settle();
    // Disturb and settle, until the metric has been looked at `work` times.
    void kick(std::int64_t work);

    // The route without nowhere, and the pose of every shot.
    std::vector<int> order() const;
    const std::vector<Pose>& poses() const { return poses_; }

   private:
    Time time(int a, int b) const {
        ++looked_;
        return metric_.between(poses_[a], poses_[b]);
    }
    bool improve(int node);
    bool take_place(int node);
    bool take_place(int node, int Pose::*arm, const std::vector<int>& places);
    bool turn_parts(int node);
    bool turn(int first, int last);
    Time backwards(int first, int last) const;
    bool move_parts(int node);
    bool move(int node, int first, int last, int length);
    NearLists near_lists(const Metric& near, bool after) const;
    bool insert(int first, int last, int length, int low, bool turned, Time removed);
    template <bool kForward>
    bool exchange_parts(int node);
    template <bool kForward>
    bool exchange(int a, int d, int e, Time gain);
    void look_at(std::initializer_list<int> nodes);
    void shake();

    const Metric& metric_;
    Shots shots_;
    std::vector<Pose> poses_;
    NearLists after_, before_;
    bool symmetric_;
    Tour tour_;
    Random random_;
    std::vector<int> waiting_;
    std::size_t next_ = 0;
    std::vector<char> is_waiting_;
    std::vector<std::pair<int, Pose>> replaced_;
    Time saved_ = 0;
    mutable std::int64_t looked_ = 0;
};
