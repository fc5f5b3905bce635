// A bracket merged pixel by pixel; gonio/reduce/hdr.py says how.

#include "merge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "arrays.hpp"

namespace {

constexpr std::size_t kSpan = 512;  // pixels at a time, which stay in cache
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Sums {
    float signal[kSpan], exposed[kSpan], top[kSpan], total[kSpan];
};

MANY_WIDTHS
void above_dark(const Exposed& frame, std::size_t at, std::size_t n, const float* stray,
                const Bending& bending, float* signal) {
    const std::uint16_t* mosaic = frame.mosaic + at;
    const float* dark = frame.dark + at;
    const float per_range = 1 / bending.raw_range;
    for (std::size_t i = 0; i < n; ++i) signal[i] = float(mosaic[i]) - dark[i];
    if (!bending.coefficients.empty()) {
        const std::size_t terms = bending.coefficients.size();
        const float* c = bending.coefficients.data();
        for (std::size_t i = 0; i < n; ++i) {
            const float u = std::min(signal[i] * per_range, bending.reach);
            float bent = 0;
            for (std::size_t k = terms; k-- > 0;) bent = (bent + c[k]) * u;
            signal[i] *= 1 + bent;
        }
    }
    for (std::size_t i = 0; i < n; ++i) signal[i] -= stray[i & 1];
}

MANY_WIDTHS
void gather(const Exposed& frame, std::size_t at, std::size_t n, float saturation,
            const float* signal, Sums& sums) {
    const std::uint16_t* mosaic = frame.mosaic + at;
    for (std::size_t i = 0; i < n; ++i) {
        const bool use = float(mosaic[i]) < saturation;
        sums.signal[i] += use ? signal[i] : 0;
        sums.exposed[i] += use ? frame.exposure : 0;
    }
}

MANY_WIDTHS
void weigh(const Exposed& frame, std::size_t at, std::size_t n, const MergeJob& job,
           const float* stray, const float* signal, const float* response, Sums& sums) {
    const std::uint16_t* mosaic = frame.mosaic + at;
    for (std::size_t i = 0; i < n; ++i) {
        const bool use = float(mosaic[i]) < job.saturation;
        const float together = std::max(sums.signal[i], 0.0f) / sums.exposed[i];
        const float noise = frame.read_variance + job.gain * std::max(stray[i & 1], 0.0f);
        const float per = frame.exposure / (job.gain * together * frame.exposure + noise);
        // of nothing gathered, together is NaN and not used
        sums.top[i] += use ? per * signal[i] : 0;
        sums.total[i] += use ? per * frame.exposure * response[i] : 0;
    }
}

MANY_WIDTHS
void conclude(std::size_t n, const float* bound, const float* response, const Sums& sums,
              float* value, float* variance) {
    for (std::size_t i = 0; i < n; ++i) {
        const bool clipped = sums.exposed[i] == 0;
        value[i] = clipped ? bound[i] / response[i] : sums.top[i] / sums.total[i];
        const float certain = 1 / (sums.total[i] * response[i]);
        // a pixel to leave out has no response
        variance[i] = clipped && response[i] == response[i] ? kInfinity : certain;
    }
}

}  // namespace

void merge_row(const MergeJob& job, std::size_t row, float* value, float* variance) {
    const std::size_t frames = job.bracket.size();
    std::vector<float> signals(frames * kSpan), bound(kSpan), ones(kSpan, 1.0f);
    std::size_t shortest = 0;
    for (std::size_t k = 1; k < frames; ++k)
        if (job.bracket[k].exposure < job.bracket[shortest].exposure) shortest = k;
    for (std::size_t from = 0; from < job.width; from += kSpan) {
        const std::size_t n = std::min(kSpan, job.width - from), at = row * job.width + from;
        const float* response = job.response ? job.response + at : ones.data();
        Sums sums{};
        for (std::size_t k = 0; k < frames; ++k) {
            const Exposed& frame = job.bracket[k];
            const float* stray = frame.stray + 2 * (row % 2);
            above_dark(frame, at, n, stray, job.bending, &signals[k * kSpan]);
            gather(frame, at, n, job.saturation, &signals[k * kSpan], sums);
        }
        for (std::size_t k = 0; k < frames; ++k) {
            const Exposed& frame = job.bracket[k];
            weigh(frame, at, n, job, frame.stray + 2 * (row % 2), &signals[k * kSpan], response,
                  sums);
        }
        const float at_least = 1 / job.bracket[shortest].exposure;
        for (std::size_t i = 0; i < n; ++i) bound[i] = signals[shortest * kSpan + i] * at_least;
        conclude(n, bound.data(), response, sums, value + from, variance + from);
    }
}
