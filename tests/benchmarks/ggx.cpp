// Lambert plus one anisotropic GGX lobe, compiled with the care that the network's kernel gets:
// single precision, a pair a lane. Formulas of nnbrdf/analytic; for the benchmark only.

#include <cstdint>

#include "lanes.hpp"

namespace {

constexpr int kPairs = 3 * kWidth<float>;
constexpr float kPi = 3.14159265f;

struct Material {
    float diffuse[3], f0[3], alpha_x, alpha_y;
};

Singles square(Singles x) { return x * x; }

void values_of(const Material& material, const float* directions, float* values) {
    const float ax = material.alpha_x, ay = material.alpha_y;
    for (int lane = 0; lane < kPairs; lane += kWidth<float>) {
        const auto row = [&](int index) { return at(directions + index * kPairs + lane); };
        const Singles lz = row(2), vz = row(5);
        // the half vector is never normalized: both of its lengths cancel in the density
        const Singles sum_squared = square(row(6)) + square(row(7)) + square(row(8));
        const Singles slope = square(row(6) / ax) + square(row(7) / ay) + square(row(8));
        const Singles light_length =
            root(square(ax * row(0)) + square(ay * row(1)) + square(lz));
        const Singles view_length = root(square(ax * row(3)) + square(ay * row(4)) + square(vz));
        const Singles lobe = 0.5f * square(sum_squared) /
                             (kPi * ax * ay * square(slope) *
                              (lz * view_length + vz * light_length));
        const Singles missing = 1 - 0.5f * root(sum_squared);
        const Singles schlick = square(square(missing)) * missing;
        for (int channel = 0; channel < 3; ++channel) {
            const float f0 = material.f0[channel];
            const Singles value =
                material.diffuse[channel] / kPi + lobe * (f0 + (1 - f0) * schlick);
            const auto above = (lz > 1e-12f) & (vz > 1e-12f);
            at(values + channel * kPairs + lane) = above ? value : Singles{};
        }
    }
}

template <class T>
void evaluate(const Material& material, const T* light, const T* view, std::int64_t pairs,
              T* values) {
    alignas(GONIO_VECTOR_BYTES) float directions[kDirections * kPairs], told[3 * kPairs];
    for (std::int64_t first = 0; first < pairs; first += kPairs) {
        const int count = pairs - first < kPairs ? int(pairs - first) : kPairs;
        take<T, kPairs>(light + 3 * first, view + 3 * first, count, directions);
        values_of(material, directions, told);
        give<T, kPairs>(told, count, values + 3 * first);
    }
}

}  // namespace

extern "C" void evaluate32(const Material* material, const float* light, const float* view,
                           std::int64_t pairs, float* values) {
    evaluate(*material, light, view, pairs, values);
}
extern "C" void evaluate64(const Material* material, const double* light, const double* view,
                           std::int64_t pairs, double* values) {
    evaluate(*material, light, view, pairs, values);
}
