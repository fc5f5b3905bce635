// Activations by number: value in place of the total, slope beside it. Formulas and parameters
// are those of nnbrdf/activations.py, which names them.
#pragma once

#include "state.hpp"
#include "vector.hpp"

namespace {

constexpr double kRreluLower = 1.0 / 8.0, kRreluUpper = 1.0 / 3.0;

template <class V>
struct Pair {
    V value, slope;
};

template <class V>
inline V sigmoid_of(V x) {
    return 1 / (1 + exponential(-x));
}

// by exp(-2 |x|), which never overflows
template <class V>
inline Pair<V> tanh_of(V x) {
    const V decay = exponential(-2 * absolute(x));
    const V under = 1 / (1 + decay);
    const V size = (1 - decay) * under;
    return {x < 0 ? -size : size, 4 * decay * under * under};
}

template <class T>
struct Linear {
    static Pair<Vector<T>> of(Vector<T> x) { return {x, fill(T(1))}; }
};
template <class T>
struct Sigmoid {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> s = sigmoid_of(x);
        return {s, s * (1 - s)};
    }
};
template <class T>
struct Exponential {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> e = exponential(x);
        return {e, e};
    }
};
template <class T>
struct Tanh {
    static Pair<Vector<T>> of(Vector<T> x) { return tanh_of(x); }
};
template <class T>
struct Relu {
    static Pair<Vector<T>> of(Vector<T> x) {
        return {x > 0 ? x : Vector<T>{}, x > 0 ? fill(T(1)) : Vector<T>{}};
    }
};
template <class T>
struct Elu {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> e = exponential(smaller(x, Vector<T>{}));
        return {x > 0 ? x : e - 1, x > 0 ? fill(T(1)) : e};
    }
};
template <class T>
struct Selu {
    static constexpr T kScale = T(1.0507009873554804934), kAlpha = T(1.6732632423543772848);
    static Pair<Vector<T>> of(Vector<T> x) {
        const auto elu = Elu<T>::of(x);
        return {kScale * (x > 0 ? x : kAlpha * elu.value),
                kScale * (x > 0 ? fill(T(1)) : kAlpha * elu.slope)};
    }
};
template <class T>
struct Softplus {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> rest = logarithm(1 + exponential(-absolute(x)));
        return {larger(x, Vector<T>{}) + rest, sigmoid_of(x)};
    }
};
template <class T>
struct Tanhshrink {
    static Pair<Vector<T>> of(Vector<T> x) {
        const auto tanh = tanh_of(x);
        return {x - tanh.value, tanh.value * tanh.value};
    }
};
template <class T>
struct Softsign {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> root = 1 / (1 + absolute(x));
        return {x * root, root * root};
    }
};
template <class T>
struct Hardshrink {
    static Pair<Vector<T>> of(Vector<T> x) {
        const auto kept = absolute(x) > T(0.5);
        return {kept ? x : Vector<T>{}, kept ? fill(T(1)) : Vector<T>{}};
    }
};
template <class T>
struct Lisht {
    static Pair<Vector<T>> of(Vector<T> x) {
        const auto tanh = tanh_of(x);
        return {x * tanh.value, tanh.value + x * tanh.slope};
    }
};
template <class T>
struct Swish {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> s = sigmoid_of(x);
        return {x * s, s + x * s * (1 - s)};
    }
};
template <class T>
struct HardSigmoid {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> line = T(0.2) * x + T(0.5);
        const Vector<T> slope = absolute(x) < T(2.5) ? fill(T(0.2)) : Vector<T>{};
        return {smaller(larger(line, Vector<T>{}), fill(T(1))), slope};
    }
};
template <class T>
struct Snake {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> s = sine(x);
        return {x + s * s, 1 + sine(2 * x)};
    }
};
template <class T>
struct Mish {
    // tanh(softplus(x)) = n / (n + 2) with n = e^2 + 2 e, e = exp(x); it is 1 beyond x = 20
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> e = exponential(smaller(x, fill(T(20))));
        const Vector<T> n = e * (e + 2);
        const Vector<T> w = n / (n + 2);
        return {x * w, w + x * (1 - w * w) * (e / (1 + e))};
    }
};
template <class T>
struct Gelu {
    static Pair<Vector<T>> of(Vector<T> x) {
        const Vector<T> share = T(0.5) * (1 + error_function(x * T(0.70710678118654752440)));
        const Vector<T> density = T(0.39894228040143267794) * exponential(T(-0.5) * x * x);
        return {x * share, share + x * density};
    }
};
template <class T>
struct Softshrink {
    static Pair<Vector<T>> of(Vector<T> x) {
        const auto kept = absolute(x) > T(0.5);
        const Vector<T> moved = x - (x > 0 ? fill(T(0.5)) : fill(T(-0.5)));
        return {kept ? moved : Vector<T>{}, kept ? fill(T(1)) : Vector<T>{}};
    }
};
// away from training, and what training replaces
template <class T>
struct MeanRrelu {
    static Pair<Vector<T>> of(Vector<T> x) {
        constexpr T kMean = T(0.5 * (kRreluLower + kRreluUpper));
        return {x < 0 ? kMean * x : x, x < 0 ? fill(kMean) : fill(T(1))};
    }
};

template <class T>
using Activate = void (*)(T* totals, T* slopes, int rows, int features, int pitch);

template <class T, template <class> class Function>
void elementwise(T* totals, T* slopes, int rows, int, int pitch) {
    for (int i = 0; i < rows * pitch; i += kWidth<T>) {
        const auto pair = Function<T>::of(at(totals + i));
        at(totals + i) = pair.value;
        at(slopes + i) = pair.slope;
    }
}

// Over the features of a row; its slopes are not a vector, so backward() treats it apart.
template <class T>
void softmax(T* totals, T* slopes, int rows, int features, int pitch) {
    for (int row = 0; row < rows; ++row) {
        T* x = totals + row * pitch;
        T most = x[0];
        for (int i = 1; i < features; ++i) most = x[i] > most ? x[i] : most;
        for (int i = 0; i < pitch; i += kWidth<T>) at(x + i) = exponential(at(x + i) - most);
        T sum = 0;
        for (int i = 0; i < features; ++i) sum += x[i];
        for (int i = 0; i < pitch; ++i) {
            x[i] = i < features ? x[i] / sum : T(0);
            slopes[row * pitch + i] = x[i];
        }
    }
}

enum { kSoftmax = 17, kRrelu = 18 };

template <class T>
constexpr Activate<T> kActivations[kActivationCount] = {
    elementwise<T, Linear>,     elementwise<T, Sigmoid>,    elementwise<T, Exponential>,
    elementwise<T, Tanh>,       elementwise<T, Relu>,       elementwise<T, Elu>,
    elementwise<T, Selu>,       elementwise<T, Softplus>,   elementwise<T, Tanhshrink>,
    elementwise<T, Softsign>,   elementwise<T, Hardshrink>, elementwise<T, Lisht>,
    elementwise<T, Swish>,      elementwise<T, HardSigmoid>, elementwise<T, Snake>,
    elementwise<T, Mish>,       elementwise<T, Gelu>,       softmax<T>,
    elementwise<T, MeanRrelu>,  elementwise<T, Softshrink>,
};

// Two rounds of multiply and shift.
inline std::uint32_t scramble(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    return x ^ (x >> 16);
}

// A slope for every sample and feature, new in every step (Xu et al. 2015, equation 3).
template <class T>
void random_rrelu(State<T>& state, int signal, int rows) {
    const int features = state.sizes[signal], pitch = state.pitch[signal];
    const auto step = std::uint32_t(state.step), layer = std::uint32_t(signal);
    const auto key = scramble(std::uint32_t(state.seed) + scramble(step * 16U + layer));
    for (int row = 0; row < rows; ++row) {
        T* x = state.signals[signal] + row * pitch;
        T* slope = state.slopes[signal] + row * pitch;
        for (int i = 0; i < features; ++i) {
            const auto bits = scramble(key + std::uint32_t(row * features + i)) >> 8;
            const T drawn = T(kRreluLower + (kRreluUpper - kRreluLower) * (bits * 0x1p-24));
            slope[i] = x[i] < 0 ? drawn : T(1);
            x[i] *= slope[i];
        }
    }
}

}  // namespace
