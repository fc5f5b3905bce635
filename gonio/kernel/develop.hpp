// From the camera's channels to BRDF and sigma of a colour space; gonio/reduce/btf/color.py says how.
#pragma once

#include <cstddef>
#include <cstdint>

struct Colors {
    float rate[3];      // of the mean channel over each one's own
    float relative[3];  // variance of the reference, over its square
    float matrix[9], squared[9];
};

// Of n texels side by side, channels apart; out come pixels of three, sigma as float16.
void develop_row(const Colors& colors, std::size_t n, float* const values[3],
                 float* const variances[3], const float* even, float* brdf, std::uint16_t* sigma);
