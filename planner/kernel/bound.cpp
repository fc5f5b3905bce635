#include "bound.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

#include "near.hpp"

namespace {

constexpr int kWidth = 8;      // neighbours in the graph of short moves
constexpr int kRounds = 3;     // trees of all moves, each after an ascent on short ones
constexpr int kSteps = 80;     // of one ascent
constexpr int kPatience = 8;   // steps without a gain until they are halved

struct Tree {
    Time bound;
    std::vector<int> degree;
};

class Prices {
   public:
    Prices(const Metric& metric, const std::vector<Pose>& nodes, const std::vector<int>& order)
        : metric_(metric), nodes_(nodes), count_(int(nodes.size())), price_(nodes.size(), 0) {
        const auto near = nearest_nodes(metric, nodes, kWidth);
        short_.resize(count_);
        for (int a = 0; a < count_; ++a)
            for (const Near& other : near[a]) join(a, other.node);
        // the route's own moves keep the graph in one piece
        for (int i = 0; i + 1 < count_; ++i) {
            join(order[i], order[i + 1]);
            route_ += time(order[i], order[i + 1]);
        }
    }

    Time rise() {
        Time best = std::max<Time>(0, finish(tree_of_all()).bound);
        for (int round = 0; round < kRounds && best < route_; ++round) {
            ascend();
            best = std::max(best, finish(tree_of_all()).bound);
        }
        return best;
    }

   private:
    using Links = std::vector<std::pair<int, int>>;

    Time time(int a, int b) const { return metric_.between(nodes_[a], nodes_[b]); }
    Time priced(int a, int b) const { return time(a, b) + price_[a] + price_[b]; }
    void join(int a, int b) {
        short_[a].push_back(b);
        short_[b].push_back(a);
    }

    // A route is a tree in which all nodes but two have two links: those two, at best the
    // cheapest, lack one.
    Tree finish(const Links& links) const {
        Tree tree{0, std::vector<int>(count_, 0)};
        for (const auto& [a, b] : links) {
            tree.bound += priced(a, b);
            ++tree.degree[a];
            ++tree.degree[b];
        }
        for (const Time price : price_) tree.bound -= 2 * price;
        std::vector<int> rank(count_);
        for (int i = 0; i < count_; ++i) rank[i] = i;
        std::partial_sort(rank.begin(), rank.begin() + 2, rank.end(), [this](int a, int b) {
            return std::make_pair(price_[a], a) < std::make_pair(price_[b], b);
        });
        for (int i = 0; i < 2; ++i) {
            tree.bound += price_[rank[i]];
            ++tree.degree[rank[i]];
        }
        return tree;
    }

    Links tree_of_short() const {
        using Entry = std::tuple<Time, int, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
        std::vector<char> inside(count_, 0);
        Links links;
        const auto enter = [&](int a) {
            inside[a] = 1;
            for (const int b : short_[a])
                if (!inside[b]) open.emplace(priced(a, b), a, b);
        };
        for (enter(0); !open.empty();) {
            const auto [cost, a, b] = open.top();
            open.pop();
            if (inside[b]) continue;
            links.emplace_back(a, b);
            enter(b);
        }
        return links;
    }

    // Prim 1957, every move tried: only such a tree bounds all routes. Its moves join the graph.
    Links tree_of_all() {
        // all that a look needs lies together: most of the time of a bound is spent here
        struct Outside {
            int node, from;
            Pose pose;
            Time price, cost;
        };
        std::vector<Outside> outside;
        for (int b = 1; b < count_; ++b)
            outside.push_back({b, 0, nodes_[b], price_[b], std::numeric_limits<Time>::max()});
        Links links;
        for (int a = 0; !outside.empty();) {
            const Pose pose = nodes_[a];
            const Time price = price_[a];
            std::size_t nearest = 0;
            for (std::size_t i = 0; i < outside.size(); ++i) {
                Outside& other = outside[i];
                const Time cost = metric_.between(pose, other.pose) + price + other.price;
                if (cost < other.cost) {
                    other.cost = cost;
                    other.from = a;
                }
                if (other.cost < outside[nearest].cost) nearest = i;
            }
            const Outside entered = outside[nearest];
            outside[nearest] = outside.back();
            outside.pop_back();
            links.emplace_back(entered.from, entered.node);
            join(entered.from, entered.node);
            a = entered.node;
        }
        return links;
    }

    // Raise the price of nodes with too many links, lower that of ends: steps after Polyak 1969.
    void ascend() {
        double share = 1.0;
        Time best = std::numeric_limits<Time>::min();
        std::vector<Time> best_price = price_;
        std::vector<double> way(count_, 0.0);
        for (int step = 0, idle = 0; step < kSteps; ++step) {
            const Tree tree = finish(tree_of_short());
            if (tree.bound > best) {
                best = tree.bound;
                best_price = price_;
                idle = 0;
            } else if (++idle == kPatience) {
                idle = 0;
                share /= 2;
            }
            double square = 0;
            for (const int degree : tree.degree) square += double(degree - 2) * (degree - 2);
            if (square == 0 || tree.bound >= route_) break;
            const double length = share * double(route_ - tree.bound) / square;
            for (int i = 0; i < count_; ++i) {
                way[i] = 0.7 * (tree.degree[i] - 2) + 0.3 * way[i];
                price_[i] += Time(length * way[i]);
            }
        }
        price_ = best_price;
    }

    const Metric& metric_;
    const std::vector<Pose>& nodes_;
    int count_;
    std::vector<Time> price_;
    std::vector<std::vector<int>> short_;
    Time route_ = 0;
};

}  // namespace

Time least_route(const Metric& metric, const std::vector<Pose>& nodes,
                 const std::vector<int>& order) {
    return nodes.size() < 2 ? 0 : Prices(metric, nodes, order).rise();
}
