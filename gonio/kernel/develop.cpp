// From the camera's channels to BRDF and sigma of a colour space; gonio/reduce/btf/develop.py says how.

#include "develop.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "arrays.hpp"

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A number that is not negative as float16, rounded to even; infinite beyond the largest, or NaN.
inline std::uint16_t half(float number) {
    const float scaled = number * 0x1p-112f;  // the exponent's bias, denormal numbers included
    std::uint32_t bits;
    std::memcpy(&bits, &scaled, sizeof bits);
    const std::uint32_t rounded = (bits + 0xfff + ((bits >> 13) & 1)) >> 13;
    return std::uint16_t(number <= 65504.0f ? rounded : number > 65504.0f ? 0x7c00 : 0x7e00);
}

}  // namespace

MANY_WIDTHS
void develop_row(const Colors& colors, std::size_t n, float* const values[3],
                 float* const variances[3], const float* even, float* brdf,
                 std::uint16_t* sigma) {
    const float *m = colors.matrix, *s = colors.squared;
    const float *v0 = values[0], *v1 = values[1], *v2 = values[2];
    const float *n0 = variances[0], *n1 = variances[1], *n2 = variances[2];
    for (std::size_t i = 0; i < n; ++i) {
        const float scale[3] = {even[i] * colors.rate[0], even[i] * colors.rate[1],
                                even[i] * colors.rate[2]};
        float c0 = v0[i] * scale[0], c1 = v1[i] * scale[1], c2 = v2[i] * scale[2];
        const bool k0 = n0[i] == kInfinity, k1 = n1[i] == kInfinity, k2 = n2[i] == kInfinity;
        const bool clipped = k0 | k1 | k2;
        // clipped channels are cut to the lowest of their bounds, so that a highlight stays white
        const float lowest = std::min({k0 ? c0 : kInfinity, k1 ? c1 : kInfinity,
                                       k2 ? c2 : kInfinity});
        c0 = k0 ? lowest : c0;
        c1 = k1 ? lowest : c1;
        c2 = k2 ? lowest : c2;
        const float e0 = n0[i] * scale[0] * scale[0] + c0 * c0 * colors.relative[0];
        const float e1 = n1[i] * scale[1] * scale[1] + c1 * c1 * colors.relative[1];
        const float e2 = n2[i] * scale[2] * scale[2] + c2 * c2 * colors.relative[2];
        for (int k = 0; k < 3; ++k) {
            const float spread = s[3 * k] * e0 + s[3 * k + 1] * e1 + s[3 * k + 2] * e2;
            brdf[3 * i + k] = m[3 * k] * c0 + m[3 * k + 1] * c1 + m[3 * k + 2] * c2;
            sigma[3 * i + k] = half(clipped ? kInfinity : std::sqrt(spread));
        }
    }
}
