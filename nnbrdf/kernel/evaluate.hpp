// What the evaluation of one network takes, as plain memory that code for any width can read.
#pragma once

#include <cstdint>

constexpr int kEncodingCount = 4;
constexpr int kChannels = 3;
constexpr int kVectors = 3;  // of pairs, side by side in registers

// What the totals of hidden layers are multiplied with, by their weights, for the quick GELU.
constexpr int kGelu = 16;
constexpr double kGeluScale = 0.1354071416432868;

// The network says ln(value / scale + offset); `tint` is what each channel multiplies that with.
struct Network {
    int layers;
    const int* sizes;             // layers + 1 of them, the last one 1 or kChannels
    const float* const* weights;  // (sizes[i] + 1) x sizes[i + 1], the last row is the bias
    int activation;
    int encoding;
    float scale, offset;
    float tint[kChannels];
};

// Directions and values are `pairs` x 3; scratch has two signals, each the widest layer x kVectors
// vectors, aligned to a vector.
template <class T>
using Evaluate = void (*)(const Network&, const T* light, const T* view, std::int64_t pairs,
                          T* values, float* scratch, int signal_size);

struct EvaluateIsa {
    const char* name;
    int bytes;  // of one vector
    Evaluate<float> single;
    Evaluate<double> twice;
};
