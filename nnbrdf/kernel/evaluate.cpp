// Evaluation of one network at pairs of directions, a pair a lane: inputs, layers and BRDF in one
// pass over as many pairs as fill kVectors vectors. No lane knows of another, so values do not
// depend on which pairs stand beside each other. Compiled once for every vector width.

#include "evaluate.hpp"

#include "activations.hpp"
#include "halfway.hpp"
#include "lanes.hpp"

namespace {

constexpr int kPairs = kVectors * kWidth<float>;
constexpr float kLargestLog = 50.0f;  // as in nnbrdf/prior/lognormal.py

// From k x to k x Phi(x), k = kGeluScale. x Phi(x) = max(x, 0) - |x| Phi(-|x|), where Phi(-|x|) is
// taken as q(k |x|)^16, and 0 where q > 0: a quintic fitted so that the largest error of the
// product is least, 5.5e-7. The scale makes its first coefficient 1, and adding 1/16 lets three
// multiplications do (Knuth, The Art of Computer Programming, section 4.6.4).
struct QuickGelu {
    static Singles of(Singles x) {
        const Singles size = magnitude(x);
        const Singles y = size + 0.0625f;
        const Singles square = y * y + 0.8247466683387756f;
        const Singles cubic = square * (y - 2.371656894683838f) + 3.460217237472534f;
        const Singles q = cubic * (square - 0.5332506895065308f) - 1.4145125150680542f;
        Singles share = at_most(q, Singles{});
        share *= share;
        share *= share;
        share *= share;
        share *= share;
        return at_least(x, Singles{}) - size * share;
    }
};

template <template <class> class Function>
struct ValueOf {
    static Singles of(Singles x) { return Function<float>::of(x).value; }
};

// In place, over `features` rows of kPairs.
using Apply = void (*)(float* signal, int features);

template <class Function>
void each(float* signal, int features) {
    for (int i = 0; i < features * kPairs; i += kWidth<float>)
        at(signal + i) = Function::of(at(signal + i));
}

void nothing(float*, int) {}

void softmax_of_pairs(float* signal, int features) {
    for (int lane = 0; lane < kPairs; lane += kWidth<float>) {
        Singles most = at(signal + lane), sum = {};
        for (int i = 1; i < features; ++i) most = larger(at(signal + i * kPairs + lane), most);
        for (int i = 0; i < features; ++i) {
            Singles& x = at(signal + i * kPairs + lane);
            sum += x = exponential(x - most);
        }
        for (int i = 0; i < features; ++i) at(signal + i * kPairs + lane) /= sum;
    }
}

constexpr Apply kApply[kActivationCount] = {
    nothing,                  each<ValueOf<Sigmoid>>,     each<ValueOf<Exponential>>,
    each<ValueOf<Tanh>>,      each<ValueOf<Relu>>,        each<ValueOf<Elu>>,
    each<ValueOf<Selu>>,      each<ValueOf<Softplus>>,    each<ValueOf<Tanhshrink>>,
    each<ValueOf<Softsign>>,  each<ValueOf<Hardshrink>>,  each<ValueOf<Lisht>>,
    each<ValueOf<Swish>>,     each<ValueOf<HardSigmoid>>, each<ValueOf<Snake>>,
    each<ValueOf<Mish>>,      each<QuickGelu>,            softmax_of_pairs,
    each<ValueOf<MeanRrelu>>, each<ValueOf<Softshrink>>,
};

// Loops that are not unrolled early leave the sums in memory.
#define GONIO_UNROLL _Pragma("GCC unroll 8")

// kRows features of the next signal; their sums stay in registers.
template <int kRows>
inline void tile(const float* signal, int inputs, const float* weights, int outputs, float* next) {
    Singles sums[kRows][kVectors];
    const float* bias = weights + inputs * outputs;
    GONIO_UNROLL for (int i = 0; i < kRows; ++i)
        GONIO_UNROLL for (int j = 0; j < kVectors; ++j) sums[i][j] = fill(bias[i]);
    do {
        Singles column[kVectors];
        GONIO_UNROLL for (int j = 0; j < kVectors; ++j)
            column[j] = at(signal + j * kWidth<float>);
        GONIO_UNROLL for (int i = 0; i < kRows; ++i)
            GONIO_UNROLL for (int j = 0; j < kVectors; ++j) sums[i][j] += weights[i] * column[j];
        signal += kPairs;
        weights += outputs;
    } while (weights != bias);
    GONIO_UNROLL for (int i = 0; i < kRows; ++i)
        GONIO_UNROLL for (int j = 0; j < kVectors; ++j)
            at(next + i * kPairs + j * kWidth<float>) = sums[i][j];
}

#if defined(__AVX512F__)
constexpr int kTile = 8;  // 8 x 3 sums in 32 registers
#else
constexpr int kTile = 4;  // 4 x 3 sums in 16 registers
#endif

// The activation follows each tile at once: it keeps the adders busy beside the next tile.
template <int kRows = kTile>
inline void layer(const float* signal, int inputs, const float* weights, int outputs, float* next,
                  Apply apply, int done = 0) {
    for (; outputs - done >= kRows; done += kRows) {
        tile<kRows>(signal, inputs, weights + done, outputs, next + done * kPairs);
        apply(next + done * kPairs, kRows);
    }
    if constexpr (kRows > 1)
        layer<kRows - 1>(signal, inputs, weights, outputs, next, apply, done);
}

const float* forward(const Network& network, float* signal, float* next) {
    for (int i = 0; i < network.layers; ++i) {
        const bool hidden = i < network.layers - 1, whole = network.activation == kSoftmax;
        const int outputs = network.sizes[i + 1];
        layer(signal, network.sizes[i], network.weights[i], outputs, next,
              hidden && !whole ? kApply[network.activation] : nothing);
        if (hidden && whole) softmax_of_pairs(next, outputs);
        float* const held = signal;
        signal = next;
        next = held;
    }
    return signal;
}

// From logarithms, in place of them: scale (exp(log) - offset), not below 0; NaN stays NaN.
void values_of(const Network& network, const float* logs, float* values) {
    const int outputs = network.sizes[network.layers];
    for (int channel = 0; channel < kChannels; ++channel) {
        const float* log = logs + (outputs == 1 ? 0 : channel * kPairs);
        for (int i = 0; i < kPairs; i += kWidth<float>) {
            const Singles most = fill(kLargestLog);
            const Singles risen = exponential(at(log + i) > most ? most : at(log + i));
            const float unit = network.scale * network.tint[channel];
            at(values + channel * kPairs + i) = unit * at_least(risen - network.offset, Singles{});
        }
    }
}

template <class T>
void evaluate(const Network& network, const T* light, const T* view, std::int64_t pairs,
              T* values, float* scratch, int signal_size) {
    alignas(GONIO_VECTOR_BYTES) float directions[kDirections * kPairs];
    alignas(GONIO_VECTOR_BYTES) float told[kChannels * kPairs];
    for (std::int64_t first = 0; first < pairs; first += kPairs) {
        const int count = pairs - first < kPairs ? int(pairs - first) : kPairs;
        take<T, kPairs>(light + 3 * first, view + 3 * first, count, directions);
        encode<kPairs>(network.encoding, directions, scratch);
        values_of(network, forward(network, scratch, scratch + signal_size), told);
        give<T, kPairs>(told, count, values + kChannels * first);
    }
}

}  // namespace

#define GONIO_TEXT_OF(name) #name
#define GONIO_TEXT(name) GONIO_TEXT_OF(name)
#define GONIO_JOIN_OF(a, b) a##b
#define GONIO_JOIN(a, b) GONIO_JOIN_OF(a, b)

extern const EvaluateIsa GONIO_JOIN(kEvaluate_, GONIO_ISA);
const EvaluateIsa GONIO_JOIN(kEvaluate_, GONIO_ISA) = {
    GONIO_TEXT(GONIO_ISA), GONIO_VECTOR_BYTES, evaluate<float>, evaluate<double>};
