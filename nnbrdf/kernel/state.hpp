// What one network in training is, as plain memory that code for any vector width can read.
#pragma once

#include <cstdint>

constexpr int kBatch = 32;
constexpr int kMostLayers = 8;
constexpr int kActivationCount = 20;

// Rows of every matrix start on a multiple of the vector width; `pitch` is their length with the
// padding, in elements. Signal i has sizes[i] features, then a column of ones for the bias.
template <class T>
struct State {
    int layers;
    int sizes[kMostLayers + 1];
    int pitch[kMostLayers + 1];
    int activation;

    // layer i takes signal i to signal i + 1
    T* weights[kMostLayers];     // (sizes[i] + 1) x pitch[i + 1], the last row is the bias
    T* transposed[kMostLayers];  // sizes[i + 1] x pitch[i], without the bias
    T* gradients[kMostLayers];   // as weights

    // all layers of the above in one run each, for the optimizer
    T* all_weights;
    T* all_gradients;
    T* mean;
    T* norm;
    std::int64_t count;

    T* signals[kMostLayers + 1];  // kBatch x pitch[i]
    T* slopes[kMostLayers + 1];   // d signal / d total, as signals
    T* errors[kMostLayers + 1];   // d loss / d total, as signals
    T* wanted;                    // kBatch x pitch[layers]

    const T* inputs;   // samples x pitch[0], the ones in place
    const T* targets;  // samples x pitch[layers]
    std::uint32_t* order;
    std::int64_t samples;
    std::int64_t position;  // in the order
    std::int64_t step;
    std::uint64_t seed;
    std::uint64_t random;
    double rate;
    double decay;
    bool failed;
};

// One set of functions for each vector width.
template <class T>
struct Functions {
    void (*run)(State<T>&, std::int64_t steps);
    void (*gradient)(State<T>&, const std::uint32_t* samples, int batch);
    void (*predict)(State<T>&, const T* inputs, std::int64_t rows, T* outputs);
    void (*activate)(int activation, T* totals, T* slopes, int rows, int features, int pitch);
};

struct Isa {
    const char* name;
    int bytes;  // of one vector
    Functions<float> single;
    Functions<double> twice;
};
