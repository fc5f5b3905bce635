// A bracket merged pixel by pixel; gonio/reduce/hdr.py says how.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

struct Exposed {
    const std::uint16_t* mosaic;
    const float* dark;
    float exposure, read_variance;
    float stray[4];  // of each place in the 2 x 2 cell
};

struct Bending {
    std::vector<float> coefficients;
    float raw_range, reach;
};

struct MergeJob {
    std::vector<Exposed> bracket;
    const float* response;  // or null
    Bending bending;
    float gain, saturation;
    std::size_t width;
};

void merge_row(const MergeJob& job, std::size_t row, float* value, float* variance);
