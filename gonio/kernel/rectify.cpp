// Texels as weighted means of a mosaic's pixels; gonio/photogrammetry/rectification.py says how.

#include "rectify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "arrays.hpp"

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Sums over the pixels of each place in the 2 x 2 cell.
struct Gathered {
    float weight[4]{}, value[4]{}, variance[4]{};

    void take(int place, float w, float v, float n) {
        // a pixel of no use is NaN; infinite variance times no weight would be, too
        if (!(w > 0) || std::isnan(v)) return;
        weight[place] += w;
        value[place] += w * v;
        variance[place] += w * w * n;
    }
};

void tell(const Gathered& sums, const int* channels, std::size_t texel, float* values[3],
          float* variances[3]) {
    float weight[3]{}, value[3]{}, variance[3]{};
    for (int place = 0; place < 4; ++place) {
        weight[channels[place]] += sums.weight[place];
        value[channels[place]] += sums.value[place];
        variance[channels[place]] += sums.variance[place];
    }
    for (int channel = 0; channel < 3; ++channel) {
        const float share = 1 / weight[channel];
        values[channel][texel] = weight[channel] > 0 ? value[channel] * share : kNan;
        variances[channel][texel] = weight[channel] > 0 ? variance[channel] * share * share : kNan;
    }
}

void hide(std::size_t texel, float* values[3], float* variances[3]) {
    for (int channel = 0; channel < 3; ++channel)
        values[channel][texel] = variances[channel][texel] = kNan;
}

// A tent two pixels to each side, at the four pixels about a place.
inline void tent(float part, float* weights) {
    weights[0] = (1 - part) / 2;
    weights[1] = 1 - part / 2;
    weights[2] = (1 + part) / 2;
    weights[3] = part / 2;
}

bool seen(double column, double line, const Picture& picture) {
    return column >= 1 && line >= 1 && column < double(picture.width) - 2 &&
           line < double(picture.height) - 2;
}

typedef float Four __attribute__((vector_size(16)));

inline Four load(const float* from) {
    Four four;
    __builtin_memcpy(&four, from, sizeof four);
    return four;
}

}  // namespace

MANY_WIDTHS
void project(const double* rays, const double* lens, bool distorts, const double* x, double y,
             std::size_t n, double focal, double centre_x, double centre_y, double* column,
             double* line) {
    for (std::size_t i = 0; i < n; ++i) {
        const double ahead = 1 / (rays[6] * x[i] + (rays[7] * y + rays[8]));
        column[i] = (rays[0] * x[i] + (rays[1] * y + rays[2])) * ahead;
        line[i] = (rays[3] * x[i] + (rays[4] * y + rays[5])) * ahead;
    }
    if (distorts)
        for (std::size_t i = 0; i < n; ++i) {
            // Brown 1971, in OpenCV's order
            const double u = column[i], v = line[i], square = u * u + v * v;
            const double radial =
                1 + square * (lens[0] + square * (lens[1] + square * lens[4]));
            column[i] = u * radial + 2 * lens[2] * u * v + lens[3] * (square + 2 * u * u);
            line[i] = v * radial + lens[2] * (square + 2 * v * v) + 2 * lens[3] * u * v;
        }
    for (std::size_t i = 0; i < n; ++i) {
        column[i] = focal * column[i] + centre_x;
        line[i] = focal * line[i] + centre_y;
    }
}

void Projection::row(const double* x, double y, std::size_t n, double* column,
                     double* line) const {
    project(rays, lens, distorts, x, y, n, focal, centre_x, centre_y, column, line);
}

Rectifier::Rectifier(const Picture& picture, const int* channels, const Projection& projection,
                     const Lattice& lattice)
    : picture_(picture), projection_(projection), lattice_(lattice) {
    std::copy(channels, channels + 4, channels_);
    const std::size_t points = lattice.side * lattice.across;
    x_.resize(points);
    const double step = lattice.pitch / double(lattice.across);
    const double first = lattice.first_x - (lattice.pitch - step) / 2;
    for (std::size_t i = 0; i < points; ++i) x_[i] = first + step * double(i);
    columns_.resize(points * lattice.down);
    lines_.resize(points * lattice.down);
}

void Rectifier::row(std::size_t row, float* values[3], float* variances[3]) {
    const std::size_t points = x_.size();
    const double step = lattice_.pitch / double(lattice_.down);
    const double top = lattice_.first_y - lattice_.pitch * double(row) + (lattice_.pitch - step) / 2;
    for (std::size_t j = 0; j < lattice_.down; ++j)
        projection_.row(x_.data(), top - step * double(j), points, &columns_[j * points],
                        &lines_[j * points]);
    if (lattice_.across == 1 && lattice_.down == 1)
        near(columns_.data(), lines_.data(), values, variances);
    else
        for (std::size_t texel = 0; texel < lattice_.side; ++texel)
            wide(columns_.data(), lines_.data(), texel, values, variances);
}

// Texels no larger than pixels: one place each.
MANY_WIDTHS
static void near_row(const Picture& picture, const int* channels, const double* columns,
                     const double* lines, std::size_t side, float* values[3],
                     float* variances[3]) {
    const std::size_t width = picture.width;
    for (std::size_t texel = 0; texel < side; ++texel) {
        if (!seen(columns[texel], lines[texel], picture)) {
            hide(texel, values, variances);
            continue;
        }
        // both are positive
        const std::size_t left = std::size_t(columns[texel]) - 1, top = std::size_t(lines[texel]) - 1;
        float across[4], down[4];
        tent(float(columns[texel] - double(left + 1)), across);
        tent(float(lines[texel] - double(top + 1)), down);
        const float* value = picture.value + top * width + left;
        const float* variance = picture.variance + top * width + left;
        Gathered sums;
        if (picture.odd[(top / 4) * ((width + 3) / 4) + left / 4]) {
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j)
                    sums.take(2 * ((top + i) & 1) + ((left + j) & 1), down[i] * across[j],
                              value[i * width + j], variance[i * width + j]);
            tell(sums, channels, texel, values, variances);
            continue;
        }
        const Four one = load(across), square = one * one;
        const Four even = load(value) * down[0] + load(value + 2 * width) * down[2];
        const Four uneven = load(value + width) * down[1] + load(value + 3 * width) * down[3];
        const Four even_noise = load(variance) * (down[0] * down[0]) +
                                load(variance + 2 * width) * (down[2] * down[2]);
        const Four uneven_noise = load(variance + width) * (down[1] * down[1]) +
                                  load(variance + 3 * width) * (down[3] * down[3]);
        const Four rows[2] = {even * one, uneven * one};
        const Four noise[2] = {even_noise * square, uneven_noise * square};
        float told[3]{}, spread[3]{};
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
                const int channel = channels[2 * ((top + i) & 1) + ((left + j) & 1)];
                told[channel] += rows[i][j] + rows[i][j + 2];
                spread[channel] += noise[i][j] + noise[i][j + 2];
            }
        // the weights of each place add up to one, and one channel has two places
        for (int channel = 0; channel < 3; ++channel) {
            const int places = (channels[0] == channel) + (channels[1] == channel) +
                               (channels[2] == channel) + (channels[3] == channel);
            const float share = places == 2 ? 0.5f : 1.0f;
            values[channel][texel] = told[channel] * share;
            variances[channel][texel] = spread[channel] * share * share;
        }
    }
}

void Rectifier::near(const double* columns, const double* lines, float* values[3],
                     float* variances[3]) {
    near_row(picture_, channels_, columns, lines, lattice_.side, values, variances);
}

// Texels larger than pixels: many places each, whose tents are added up pixel by pixel.
void Rectifier::wide(const double* columns, const double* lines, std::size_t texel,
                     float* values[3], float* variances[3]) {
    const std::size_t points = x_.size(), first = texel * lattice_.across;
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (std::size_t j = 0; j < lattice_.down; ++j)
        for (std::size_t i = first; i < first + lattice_.across; ++i) {
            const double at[2] = {columns[j * points + i], lines[j * points + i]};
            if (!seen(at[0], at[1], picture_)) return hide(texel, values, variances);
            for (int k = 0; k < 2; ++k) {
                low[k] = std::min(low[k], at[k]);
                high[k] = std::max(high[k], at[k]);
            }
        }
    const std::size_t left = std::size_t(low[0]) - 1, top = std::size_t(low[1]) - 1;
    const std::size_t width = std::size_t(high[0]) + 3 - left;
    const std::size_t height = std::size_t(high[1]) + 3 - top;
    window_.assign(width * height, 0.0f);
    for (std::size_t j = 0; j < lattice_.down; ++j)
        for (std::size_t i = first; i < first + lattice_.across; ++i) {
            const double column = columns[j * points + i], line = lines[j * points + i];
            const std::size_t from = std::size_t(column) - 1, above = std::size_t(line) - 1;
            float across[4], down[4];
            tent(float(column - double(from + 1)), across);
            tent(float(line - double(above + 1)), down);
            float* to = &window_[(above - top) * width + from - left];
            for (int k = 0; k < 4; ++k)
                for (int l = 0; l < 4; ++l) to[k * width + l] += down[k] * across[l];
        }
    Gathered sums;
    for (std::size_t j = 0; j < height; ++j)
        for (std::size_t i = 0; i < width; ++i) {
            const std::size_t at = (top + j) * picture_.width + left + i;
            sums.take(2 * ((top + j) & 1) + ((left + i) & 1), window_[j * width + i],
                      picture_.value[at], picture_.variance[at]);
        }
    tell(sums, channels_, texel, values, variances);
}
