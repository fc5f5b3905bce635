// Between rows of three numbers and runs of lanes, a pair a lane; small functions on lanes.
#pragma once

#include "vector.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace {

// `absolute` in one instruction.
inline Singles magnitude(Singles x) {
    const auto bits = reinterpret_cast<const Integers<float>&>(x) & 0x7fffffff;
    return reinterpret_cast<const Singles&>(bits);
}

// NaN stays NaN, where `larger` would lose it: of NaN and a number the second operand is returned.
inline Singles at_least(Singles x, Singles least) {
#if defined(__AVX512F__)
    return _mm512_maskz_max_ps(0xffff, least, x);
#elif defined(__AVX2__)
    return _mm256_max_ps(least, x);
#elif defined(__SSE2__)
    return _mm_max_ps(least, x);
#else
    return x < least ? least : x;
#endif
}

inline Singles at_most(Singles x, Singles most) {
#if defined(__AVX512F__)
    return _mm512_maskz_min_ps(0xffff, most, x);
#elif defined(__AVX2__)
    return _mm256_min_ps(most, x);
#elif defined(__SSE2__)
    return _mm_min_ps(most, x);
#else
    return x > most ? most : x;
#endif
}

inline Singles root(Singles x) {
    for (int lane = 0; lane < kWidth<float>; ++lane) x[lane] = __builtin_sqrtf(x[lane]);
    return x;
}

// Light, view, and their sum: x, y, z each, one run of lanes after the other.
constexpr int kDirections = 9;

// The sum is made before rounding to single precision: what is left of opposite ones is exact.
template <class T>
inline void round_off(const T* light, const T* view, int size, float* lights, float* views,
                      float* sums) {
    for (int i = 0; i < size; ++i) {
        lights[i] = float(light[i]);
        views[i] = float(view[i]);
        sums[i] = float(light[i] + view[i]);
    }
}

// One run of lanes for each number of a row; those beyond `count` pairs are anything finite.
template <class T, int kPairs>
inline void take(const T* light, const T* view, int count, float* directions) {
    alignas(GONIO_VECTOR_BYTES) float rows[3][3 * kPairs];
    if (count == kPairs) {
        round_off(light, view, 3 * kPairs, rows[0], rows[1], rows[2]);
    } else {
        for (auto& row : rows)
            for (float& x : row) x = 0;
        round_off(light, view, 3 * count, rows[0], rows[1], rows[2]);
    }
    for (int which = 0; which < 3; ++which)
        for (int i = 0; i < kPairs; ++i)
            for (int axis = 0; axis < 3; ++axis)
                directions[(3 * which + axis) * kPairs + i] = rows[which][3 * i + axis];
}

// Rows of the first `count` lanes of three runs.
template <class T, int kPairs>
inline void give(const float* runs, int count, T* values) {
    alignas(GONIO_VECTOR_BYTES) float rows[3 * kPairs];
    for (int i = 0; i < kPairs; ++i)
        for (int axis = 0; axis < 3; ++axis)
            rows[3 * i + axis] = runs[axis * kPairs + i];
    if (count == kPairs)
        for (int i = 0; i < 3 * kPairs; ++i) values[i] = T(rows[i]);
    else
        for (int i = 0; i < 3 * count; ++i) values[i] = T(rows[i]);
}

}  // namespace
