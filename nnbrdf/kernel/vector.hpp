// Vectors of the width this file is compiled for, and the elementary functions on them.
// Everything is in an unnamed namespace: objects of different widths must not share code.
#pragma once

#include <cstdint>

#if defined(__AVX512F__)
#define GONIO_VECTOR_BYTES 64
#elif defined(__AVX2__)
#define GONIO_VECTOR_BYTES 32
#else
#define GONIO_VECTOR_BYTES 16
#endif

namespace {

template <class T>
struct Lanes;
template <>
struct Lanes<float> {
    typedef float Vector __attribute__((vector_size(GONIO_VECTOR_BYTES), may_alias));
    typedef std::int32_t Integers __attribute__((vector_size(GONIO_VECTOR_BYTES), may_alias));
};
template <>
struct Lanes<double> {
    typedef double Vector __attribute__((vector_size(GONIO_VECTOR_BYTES), may_alias));
    typedef std::int64_t Integers __attribute__((vector_size(GONIO_VECTOR_BYTES), may_alias));
};
template <class T>
using Vector = typename Lanes<T>::Vector;
template <class T>
using Integers = typename Lanes<T>::Integers;
template <class T>
constexpr int kWidth = GONIO_VECTOR_BYTES / int(sizeof(T));

using Singles = Vector<float>;
using Doubles = Vector<double>;

template <class T>
inline Vector<T>& at(T* pointer) {
    return *reinterpret_cast<Vector<T>*>(pointer);
}
template <class T>
inline const Vector<T>& at(const T* pointer) {
    return *reinterpret_cast<const Vector<T>*>(pointer);
}

// x - 0 is x to the bit, and folds to a broadcast; 0 + x is not, for x = -0
template <class T>
inline Vector<T> fill(T value) {
    return value - Vector<T>{};
}

template <class V>
inline V absolute(V x) {
    return x < 0 ? -x : x;
}
template <class V>
inline V larger(V x, V y) {
    return x > y ? x : y;
}
template <class V>
inline V smaller(V x, V y) {
    return x < y ? x : y;
}

template <class F>
inline Doubles each_lane(Doubles x, F function) {
    for (int lane = 0; lane < kWidth<double>; ++lane) x[lane] = function(x[lane]);
    return x;
}

// Double precision serves as the reference and goes through the C library, lane by lane.
inline Doubles exponential(Doubles x) {
    return each_lane(x, [](double y) { return __builtin_exp(y); });
}
inline Doubles logarithm(Doubles x) {
    return each_lane(x, [](double y) { return __builtin_log(y); });
}
inline Doubles sine(Doubles x) {
    return each_lane(x, [](double y) { return __builtin_sin(y); });
}
inline Doubles error_function(Doubles x) {
    return each_lane(x, [](double y) { return __builtin_erf(y); });
}

// The nearest whole number, for |x| < 2^22: adding 1.5 * 2^23 rounds away the fraction.
inline Singles nearest(Singles x) {
    constexpr float kRound = 12582912.0f;
    return (x + kRound) - kRound;
}

// exp by range reduction to |r| <= ln 2 / 2 and its Taylor series to r^7 / 7!, remainder 6e-9.
inline Singles exponential(Singles x) {
    constexpr float kMost = 88.3f, kLeast = -87.3f;
    const Singles inside = smaller(larger(x, fill(kLeast)), fill(kMost));
    const Singles n = nearest(inside * 1.44269504f);
    Singles r = inside - n * 0.693359375f;
    r -= n * -2.12194440e-4f;
    Singles sum = fill(1.0f / 5040.0f);
    sum = sum * r + 1.0f / 720.0f;
    sum = sum * r + 1.0f / 120.0f;
    sum = sum * r + 1.0f / 24.0f;
    sum = sum * r + 1.0f / 6.0f;
    sum = sum * r + 0.5f;
    sum = sum * r + 1.0f;
    sum = sum * r + 1.0f;
    const auto power = (__builtin_convertvector(n, Integers<float>) + 127) << 23;
    const Singles result = sum * reinterpret_cast<const Singles&>(power);
    const Singles high = x > kMost ? fill(__builtin_inff()) : result;
    const Singles bounded = x < kLeast ? Singles{} : high;
    return x == x ? bounded : x;
}

// log of x in [1, 2]: twice the inverse hyperbolic tangent of (x - 1) / (x + 1) <= 1 / 3.
inline Singles logarithm(Singles x) {
    const Singles t = (x - 1.0f) / (x + 1.0f);
    const Singles square = t * t;
    Singles sum = fill(2.0f / 13.0f);
    sum = sum * square + 2.0f / 11.0f;
    sum = sum * square + 2.0f / 9.0f;
    sum = sum * square + 2.0f / 7.0f;
    sum = sum * square + 2.0f / 5.0f;
    sum = sum * square + 2.0f / 3.0f;
    sum = sum * square + 2.0f;
    return sum * t;
}

// sin by reduction modulo pi in three parts (Cody and Waite), series to r^11 on |r| <= pi / 2.
// Beyond 2^22 neighboring numbers lie half a radian apart and more, and it is 0.
inline Singles sine(Singles angle) {
    constexpr float kMost = 4194304.0f;
    const Singles x = absolute(angle) > kMost ? Singles{} : angle;
    const Singles n = nearest(x * 0.318309886f);
    Singles r = x - n * 3.140625f;
    r -= n * 9.67502593994140625e-4f;
    r -= n * 1.509957990978376432e-7f;
    const Singles square = r * r;
    Singles sum = fill(-1.0f / 39916800.0f);
    sum = sum * square + 1.0f / 362880.0f;
    sum = sum * square - 1.0f / 5040.0f;
    sum = sum * square + 1.0f / 120.0f;
    sum = sum * square - 1.0f / 6.0f;
    const Singles value = r + r * square * sum;
    const auto odd = __builtin_convertvector(n, Integers<float>) & 1;
    return odd != 0 ? -value : value;
}

// Abramowitz and Stegun (1964), 7.1.26: error below 1.5e-7.
inline Singles error_function(Singles x) {
    const Singles size = absolute(x);
    const Singles t = 1.0f / (1.0f + 0.3275911f * size);
    Singles sum = fill(1.061405429f);
    sum = sum * t - 1.453152027f;
    sum = sum * t + 1.421413741f;
    sum = sum * t - 0.284496736f;
    sum = sum * t + 0.254829592f;
    const Singles value = 1.0f - sum * t * exponential(-size * size);
    return x < 0 ? -value : value;
}

}  // namespace
