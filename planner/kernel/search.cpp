#include "search.hpp"

#include <algorithm>
#include <cmath>

namespace {

constexpr int kWidth = 10;       // neighbours that are tried
constexpr int kNarrow = 5;       // of these where two are tried together
constexpr int kSmallPart = 3;    // longest part that is moved
constexpr int kTurnedPart = 25;  // longest part that is turned where times have a direction
constexpr int kKick = 10;        // longest part that a kick displaces
constexpr double kHeat = 0.03;   // what is accepted at first, in moves of mean time

struct Narrow {
    const Near *first, *last;
    const Near* begin() const { return first; }
    const Near* end() const { return last; }
};

Narrow narrow(const std::vector<Near>& list) {
    return {list.data(), list.data() + std::min<std::size_t>(list.size(), kNarrow + 1)};
}

std::vector<int> with_nowhere(std::vector<int> order) {
    order.push_back(int(order.size()));
    return order;
}

}  // namespace

Search::Search(const Metric& metric, const Metric& near, Shots shots, std::vector<Pose> poses,
               std::vector<int> order, std::uint64_t seed)
    : metric_(metric),
      shots_(std::move(shots)),
      poses_(std::move(poses)),
      symmetric_(metric.is_symmetric()),
      tour_(with_nowhere(std::move(order)), symmetric_),
      random_(seed),
      is_waiting_(poses_.size(), 0) {
    after_ = near_lists(near, true);
    before_ = symmetric_ ? after_ : near_lists(near, false);
    for (int i = 0; i < tour_.size(); ++i) look_at({tour_.at(i)});
}

// The nearest nodes that may follow each, or come before it; nowhere, nearest to all, is first.
NearLists Search::near_lists(const Metric& near, bool after) const {
    const std::vector<Pose> real(shots_.directions.begin(), shots_.directions.end() - 1);
    NearLists lists = nearest_nodes(near, real, kWidth, after);
    for (auto& list : lists) list.insert(list.begin(), {tour_.size() - 1, 0});
    lists.emplace_back();
    return lists;
}

void Search::settle() {
    while (next_ < waiting_.size()) {
        const int node = waiting_[next_++];
        is_waiting_[node] = 0;
        while (improve(node)) {
        }
    }
    waiting_.clear();
    next_ = 0;
}

void Search::kick(std::int64_t work) {
    if (tour_.size() < 4) return;
    Time all = 0;
    for (int i = 0; i < tour_.size(); ++i) all += time(tour_.at(i), tour_.after(tour_.at(i)));
    const double heat = kHeat * double(all) / tour_.size();
    while (looked_ < work) {
        tour_.forget();
        replaced_.clear();
        saved_ = 0;
        shake();
        settle();
        const double warmth = heat * std::max(0.0, 1.0 - double(looked_) / double(work));
        if (saved_ >= 0 || double(-saved_) < -warmth * std::log(random_.unit())) continue;
        tour_.undo();
        for (; !replaced_.empty(); replaced_.pop_back())
            poses_[replaced_.back().first] = replaced_.back().second;
    }
}

std::vector<int> Search::order() const {
    std::vector<int> order;
    const int nowhere = tour_.size() - 1;
    for (int a = tour_.after(nowhere); a != nowhere; a = tour_.after(a)) order.push_back(a);
    return order;
}

void Search::look_at(std::initializer_list<int> nodes) {
    for (const int node : nodes) {
        if (is_waiting_[node]) continue;
        is_waiting_[node] = 1;
        waiting_.push_back(node);
    }
}

bool Search::improve(int node) {
    return take_place(node) || turn_parts(node) || move_parts(node) ||
           exchange_parts<true>(node) || exchange_parts<false>(node);
}

bool Search::take_place(int node) {
    const Pose direction = shots_.directions[node];
    const auto& views = shots_.view_places[direction.view];
    const auto& lights = shots_.light_places[direction.light];
    return (views.size() > 1 && take_place(node, &Pose::view, views)) ||
           (lights.size() > 1 && take_place(node, &Pose::light, lights));
}

bool Search::take_place(int node, int Pose::*arm, const std::vector<int>& places) {
    const Pose before = poses_[tour_.before(node)], after = poses_[tour_.after(node)];
    const Pose old = poses_[node];
    const auto both = [&](Pose pose) {
        looked_ += 2;
        return metric_.between(before, pose) + metric_.between(pose, after);
    };
    const Time now = both(old);
    Time least = now;
    Pose best = old, pose = old;
    for (const int place : places) {
        pose.*arm = place;
        const Time then = both(pose);
        if (then < least) {
            least = then;
            best = pose;
        }
    }
    if (least == now) return false;
    saved_ += now - least;
    replaced_.emplace_back(node, old);
    poses_[node] = best;
    look_at({tour_.before(node), tour_.after(node)});
    return true;
}

bool Search::turn_parts(int a) {
    const Time out = time(a, tour_.after(a)), in = time(tour_.before(a), a);
    const Time most = std::max(out, in);
    for (const Near& near : after_[a]) {
        if (near.time >= most) break;
        if (turn(tour_.after(a), near.node) || turn(a, tour_.before(near.node))) return true;
    }
    // without a direction, these are the same exchanges
    if (symmetric_) return false;
    for (const Near& near : before_[a]) {
        if (near.time >= most) break;
        if (turn(near.node, tour_.before(a)) || turn(tour_.after(near.node), a)) return true;
    }
    return false;
}

bool Search::turn(int first, int last) {
    const int length = tour_.length(first, last);
    if (length >= tour_.size() - 1 || (!symmetric_ && length > kTurnedPart)) return false;
    const int before = tour_.before(first), after = tour_.after(last);
    Time gain = time(before, first) + time(last, after) - time(before, last) - time(first, after);
    // a part is seldom quicker the other way round: that is asked last
    if (gain <= 0) return false;
    if (!symmetric_) gain -= backwards(first, last);
    if (gain <= 0) return false;
    saved_ += gain;
    tour_.reverse(tour_.place(first), length);
    look_at({before, first, last, after});
    return true;
}

// How much longer a part takes the other way round.
Time Search::backwards(int first, int last) const {
    Time more = 0;
    for (int a = first; a != last; a = tour_.after(a))
        more += time(tour_.after(a), a) - time(a, tour_.after(a));
    return more;
}

bool Search::move_parts(int a) {
    int last = a, first = a;
    for (int length = 1; length <= std::min(kSmallPart, tour_.size() - 3); ++length) {
        if (move(a, a, last, length) || (length > 1 && move(a, first, a, length))) return true;
        last = tour_.after(last);
        first = tour_.before(first);
    }
    return false;
}

// Move the part `first` to `last`, of which `a` is one end, to where `a` has a near neighbour.
bool Search::move(int a, int first, int last, int length) {
    const int before = tour_.before(first), after = tour_.after(last);
    const Time removed = time(before, first) + time(last, after) - time(before, after);
    for (const Near& near : before_[a]) {
        if (near.time >= removed) break;
        const int c = near.node;
        if (c != before && tour_.length(first, c) > length &&
            insert(first, last, length, c, a != first, removed))
            return true;
    }
    for (const Near& near : after_[a]) {
        if (near.time >= removed) break;
        const int c = near.node;
        if (c != after && tour_.length(first, c) > length &&
            insert(first, last, length, tour_.before(c), a != last, removed))
            return true;
    }
    return false;
}

// Move the part `first` to `last` to behind `low`, turned round or not.
bool Search::insert(int first, int last, int length, int low, bool turned, Time removed) {
    const int high = tour_.after(low), before = tour_.before(first), after = tour_.after(last);
    const int start = turned ? last : first, end = turned ? first : last;
    Time gain = removed + time(low, high) - time(low, start) - time(end, high);
    if (gain <= 0) return false;
    if (turned && !symmetric_) gain -= backwards(first, last);
    if (gain <= 0) return false;
    saved_ += gain;
    tour_.swap(tour_.place(first), length, tour_.length(after, low));
    if (turned) tour_.reverse(tour_.place(first), length);
    look_at({before, after, low, high, first, last});
    return true;
}

// From a, the way to b = next(a) and on to c; then d .. e, then f. Join a to d, e to b, c to f:
// the parts b .. c and d .. e change places. `kForward` says which way next is.
template <bool kForward>
bool Search::exchange_parts(int a) {
    const auto next = [this](int x) { return kForward ? tour_.after(x) : tour_.before(x); };
    const auto previous = [this](int x) { return kForward ? tour_.before(x) : tour_.after(x); };
    const auto link = [this](int x, int y) { return kForward ? time(x, y) : time(y, x); };
    const auto steps = [this](int x, int y) {
        return (kForward ? tour_.length(x, y) : tour_.length(y, x)) - 1;
    };
    const int b = next(a);
    const Time first = link(a, b);
    for (const Near& near : narrow((kForward ? after_ : before_)[a])) {
        if (near.time >= first) break;
        const int d = near.node;
        if (d == b) continue;
        const int c = previous(d);
        const Time open = first - link(a, d) + link(c, d);
        const int part = steps(b, d);
        for (const Near& other : narrow((kForward ? before_ : after_)[b])) {
            if (other.time >= open) break;
            const int e = other.node;
            if (e != a && steps(b, e) >= part && exchange<kForward>(a, d, e, open)) return true;
        }
        for (const Near& other : narrow((kForward ? after_ : before_)[c])) {
            if (other.time >= open) break;
            const int f = other.node;
            if (steps(b, f) > part && exchange<kForward>(a, d, previous(f), open)) return true;
        }
    }
    return false;
}

template <bool kForward>
bool Search::exchange(int a, int d, int e, Time open) {
    const int b = kForward ? tour_.after(a) : tour_.before(a);
    const int c = kForward ? tour_.before(d) : tour_.after(d);
    const int f = kForward ? tour_.after(e) : tour_.before(e);
    const auto link = [this](int x, int y) { return kForward ? time(x, y) : time(y, x); };
    const Time gain = open + link(e, f) - link(e, b) - link(c, f);
    if (gain <= 0) return false;
    saved_ += gain;
    if (kForward)
        tour_.swap(tour_.place(b), tour_.length(b, c), tour_.length(d, e));
    else
        tour_.swap(tour_.place(e), tour_.length(e, d), tour_.length(c, b));
    look_at({a, b, c, d, e, f});
    return true;
}

// Three parts that follow each other take the opposite order, none turned: the double bridge.
void Search::shake() {
    const int longest = std::min(kKick, (tour_.size() - 1) / 3);
    const int b = 1 + random_.below(longest), c = 1 + random_.below(longest),
              d = 1 + random_.below(longest);
    const int start = random_.below(tour_.size());
    const auto at = [&](int steps) { return tour_.at((start + steps) % tour_.size()); };
    const int a = at(tour_.size() - 1), b0 = at(0), b1 = at(b - 1), c0 = at(b), c1 = at(b + c - 1),
              d0 = at(b + c), d1 = at(b + c + d - 1), e = at(b + c + d);
    saved_ += time(a, b0) + time(b1, c0) + time(c1, d0) + time(d1, e);
    saved_ -= time(a, d0) + time(d1, c0) + time(c1, b0) + time(b1, e);
    tour_.swap(tour_.place(b0), b, c + d);
    tour_.swap(tour_.place(c0), c, d);
    look_at({a, b0, b1, c0, c1, d0, d1, e});
}
