// Training of one network: each step one pass over a batch that stays in the first cache.
// Compiled once for every vector width; GONIO_ISA names the result.

#include "activations.hpp"
#include "multiply.hpp"

namespace {

constexpr double kBeta1 = 0.9, kBeta2 = 0.999, kEpsilon = 1e-7;

template <class T>
void gather(State<T>& state, const std::uint32_t* samples, int batch) {
    const int wide = state.pitch[0], narrow = state.pitch[state.layers];
    for (int row = 0; row < batch; ++row) {
        const std::int64_t sample = samples[row];
        for (int i = 0; i < wide; i += kWidth<T>)
            at(state.signals[0] + row * wide + i) = at(state.inputs + sample * wide + i);
        for (int i = 0; i < narrow; i += kWidth<T>)
            at(state.wanted + row * narrow + i) = at(state.targets + sample * narrow + i);
    }
}

template <class T>
void forward(State<T>& state, const T* inputs, int batch, bool training) {
    const T* signal = inputs;
    for (int i = 0; i < state.layers; ++i) {
        const int pitch = state.pitch[i + 1], features = state.sizes[i + 1];
        T* next = state.signals[i + 1];
        multiply<T>({signal, state.pitch[i], 1}, state.weights[i], next, batch,
                    state.sizes[i] + 1, pitch);
        signal = next;
        if (i == state.layers - 1) return;
        if (training && state.activation == kRrelu)
            random_rrelu(state, i + 1, batch);
        else
            kActivations<T>[state.activation](next, state.slopes[i + 1], batch, features, pitch);
        for (int row = 0; row < batch; ++row) next[row * pitch + features] = 1;
    }
}

// d mean|r| / dr is sign(r) / n, and 0 at r = 0; r - r is NaN where r is not finite, else 0.
template <class T>
void error_of_outputs(State<T>& state, int batch) {
    const int last = state.layers, size = batch * state.pitch[last];
    const T scale = T(1) / T(batch * state.sizes[last]);
    for (int i = 0; i < size; i += kWidth<T>) {
        const Vector<T> r = at(state.signals[last] + i) - at(state.wanted + i);
        const Vector<T> up = r > 0 ? fill(scale) : Vector<T>{};
        at(state.errors[last] + i) = (r < 0 ? fill(-scale) : up) + (r - r);
    }
}

template <class T>
void times_slopes(State<T>& state, int signal, int batch) {
    T* error = state.errors[signal];
    const T* slope = state.slopes[signal];
    const int pitch = state.pitch[signal];
    if (state.activation != kSoftmax) {
        for (int i = 0; i < batch * pitch; i += kWidth<T>) at(error + i) *= at(slope + i);
        return;
    }
    // row of the Jacobian of softmax p: p_i (delta_ij - p_j)
    for (int row = 0; row < batch; ++row, error += pitch, slope += pitch) {
        T common = 0;
        for (int i = 0; i < state.sizes[signal]; ++i) common += error[i] * slope[i];
        for (int i = 0; i < pitch; i += kWidth<T>)
            at(error + i) = at(slope + i) * (at(error + i) - common);
    }
}

template <class T>
void backward(State<T>& state, int batch) {
    error_of_outputs(state, batch);
    for (int i = state.layers - 1; i >= 0; --i) {
        const T* error = state.errors[i + 1];
        multiply<T>({state.signals[i], 1, state.pitch[i]}, error, state.gradients[i],
                    state.sizes[i] + 1, batch, state.pitch[i + 1]);
        if (i == 0) return;
        multiply<T>({error, state.pitch[i + 1], 1}, state.transposed[i], state.errors[i], batch,
                    state.sizes[i + 1], state.pitch[i]);
        times_slopes(state, i, batch);
    }
}

template <class T>
bool all_finite(const T* values, std::int64_t count) {
    Vector<T> sum = {};
    for (std::int64_t i = 0; i < count; i += kWidth<T>) sum += at(values + i) - at(values + i);
    T total = 0;
    for (int lane = 0; lane < kWidth<T>; ++lane) total += sum[lane];
    return total == 0;
}

template <class T>
void transpose(State<T>& state) {
    for (int i = 1; i < state.layers; ++i)
        for (int out = 0; out < state.sizes[i + 1]; ++out)
            for (int in = 0; in < state.sizes[i]; ++in)
                state.transposed[i][out * state.pitch[i] + in] =
                    state.weights[i][in * state.pitch[i + 1] + out];
}

// Kingma and Ba (2015), algorithm 2; epsilon is added to the norm when it divides, as Keras does.
template <class T>
void adamax(State<T>& state) {
    state.decay *= kBeta1;
    const T rate = T(state.rate / (1 - state.decay));
    for (std::int64_t i = 0; i < state.count; i += kWidth<T>) {
        const Vector<T> gradient = at(state.all_gradients + i);
        Vector<T>& mean = at(state.mean + i);
        Vector<T>& norm = at(state.norm + i);
        mean += T(1 - kBeta1) * (gradient - mean);
        norm = larger(T(kBeta2) * norm, absolute(gradient));
        at(state.all_weights + i) -= rate * mean / (norm + T(kEpsilon));
    }
    transpose(state);
}

// splitmix64 (Steele, Lea and Flood 2014); the high half of the product bounds the draw
template <class T>
std::uint32_t draw_below(State<T>& state, std::uint32_t bound) {
    std::uint64_t z = (state.random += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
    return std::uint32_t(((z >> 32) * bound) >> 32);
}

template <class T>
void shuffle(State<T>& state) {
    for (std::int64_t i = state.samples - 1; i > 0; --i) {
        const auto j = draw_below(state, std::uint32_t(i + 1));
        const auto held = state.order[i];
        state.order[i] = state.order[j];
        state.order[j] = held;
    }
}

template <class T>
void gradient(State<T>& state, const std::uint32_t* samples, int batch) {
    transpose(state);
    gather(state, samples, batch);
    forward(state, state.signals[0], batch, true);
    backward(state, batch);
}

template <class T>
void run(State<T>& state, std::int64_t steps) {
    transpose(state);
    for (std::int64_t end = state.step + steps; state.step < end;) {
        if (state.position == 0) shuffle(state);
        const std::int64_t left = state.samples - state.position;
        const int batch = left < kBatch ? int(left) : kBatch;
        gather(state, state.order + state.position, batch);
        forward(state, state.signals[0], batch, true);
        backward(state, batch);
        if (!all_finite(state.all_gradients, state.count)) {
            state.failed = true;
            return;
        }
        adamax(state);
        state.position = left <= kBatch ? 0 : state.position + kBatch;
        ++state.step;
    }
}

template <class T>
void predict(State<T>& state, const T* inputs, std::int64_t rows, T* outputs) {
    const int features = state.sizes[state.layers], pitch = state.pitch[state.layers];
    for (std::int64_t row = 0; row < rows; row += kBatch) {
        const int batch = rows - row < kBatch ? int(rows - row) : kBatch;
        forward(state, inputs + row * state.pitch[0], batch, false);
        for (int i = 0; i < batch; ++i)
            for (int j = 0; j < features; ++j)
                *outputs++ = state.signals[state.layers][i * pitch + j];
    }
}

template <class T>
void activate(int activation, T* totals, T* slopes, int rows, int features, int pitch) {
    kActivations<T>[activation](totals, slopes, rows, features, pitch);
}

template <class T>
constexpr Functions<T> kFunctions = {run<T>, gradient<T>, predict<T>, activate<T>};

}  // namespace

#define GONIO_TEXT_OF(name) #name
#define GONIO_TEXT(name) GONIO_TEXT_OF(name)
#define GONIO_JOIN_OF(a, b) a##b
#define GONIO_JOIN(a, b) GONIO_JOIN_OF(a, b)

extern const Isa GONIO_JOIN(kIsa_, GONIO_ISA);
const Isa GONIO_JOIN(kIsa_, GONIO_ISA) = {GONIO_TEXT(GONIO_ISA), GONIO_VECTOR_BYTES,
                                          kFunctions<float>, kFunctions<double>};
