// A closed tour in an array, changed by two exchanges that can be undone: a part is reversed, or
// two parts that follow each other change places.

#pragma once

#include <algorithm>
#include <vector>

class Tour {
   public:
    // `free_direction`: the tour may come to run the other way round, if that is less to write.
    Tour(std::vector<int> nodes, bool free_direction)
        : nodes_(std::move(nodes)), place_(nodes_.size()), free_(free_direction) {
        for (int i = 0; i < size(); ++i) place_[nodes_[i]] = i;
    }

    int size() const { return int(nodes_.size()); }
    int at(int place) const { return nodes_[wrapped(place)]; }
    int place(int node) const { return place_[node]; }
    int after(int node) const {
        const int next = place_[node] + 1;
        return nodes_[next == size() ? 0 : next];
    }
    int before(int node) const {
        const int place = place_[node];
        return nodes_[place == 0 ? size() - 1 : place - 1];
    }
    // How many nodes there are from `first` on to `last`, both counted.
    int length(int first, int last) const {
        const int steps = place_[last] - place_[first];
        return (steps < 0 ? steps + size() : steps) + 1;
    }

    // Turn the part from place `start` on, of `length` nodes, round.
    void reverse(int start, int length) {
        log_.push_back({start, length, 0});
        do_reverse(start, length);
    }
    // Let the parts of `first` and `second` nodes from place `start` on change places.
    void swap(int start, int first, int second) {
        // of the three parts that a tour has then, any two may change places: the shortest do
        const int third = size() - first - second;
        if (first > second && first > third)
            set_down({wrapped(start + first), second, third});
        else if (second > third)
            set_down({wrapped(wrapped(start + first) + second), third, first});
        else
            set_down({start, first, second});
    }
    void forget() { log_.clear(); }
    void undo() {
        for (; !log_.empty(); log_.pop_back()) {
            const Change& change = log_.back();
            if (change.second == 0)
                do_reverse(change.start, change.first);
            else
                do_swap(change.start, change.second, change.first);
        }
    }

   private:
    struct Change {
        int start, first, second;
    };
    void set_down(const Change& change) {
        log_.push_back(change);
        do_swap(change.start, change.first, change.second);
    }
    int wrapped(int place) const { return place >= size() ? place - size() : place; }
    void put(int place, int node) {
        nodes_[place] = node;
        place_[node] = place;
    }
    void do_reverse(int start, int length) {
        if (free_ && 2 * length > size()) {
            start = wrapped(start + length);
            length = size() - length;
        }
        int low = start, high = wrapped(start + length - 1);
        for (int i = 0; i < length / 2; ++i) {
            const int node = nodes_[low];
            put(low, nodes_[high]);
            put(high, node);
            if (++low == size()) low = 0;
            if (--high < 0) high = size() - 1;
        }
    }
    void do_swap(int start, int first, int second) {
        part_.resize(first + second);
        for (int i = 0; i < first; ++i) part_[second + i] = at(start + i);
        for (int i = 0; i < second; ++i) part_[i] = at(wrapped(start + first) + i);
        int place = start;
        for (const int node : part_) {
            put(place, node);
            if (++place == size()) place = 0;
        }
    }

    std::vector<int> nodes_, place_, part_;
    std::vector<Change> log_;
    bool free_;
};
