// Python's side of the pixels' kernel: shapes are checked here, and memory is handed out.

#include <pybind11/stl.h>

#include <array>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <tuple>

#include "arrays.hpp"
#include "develop.hpp"
#include "merge.hpp"
#include "rectify.hpp"

namespace {

using Frame = std::tuple<Array<std::uint16_t>, Array<float>, float, float, std::array<float, 4>>;
using Three = std::array<float, 3>;

py::tuple merge(const std::vector<Frame>& bracket, const std::optional<Array<float>>& response,
                std::vector<float> coefficients, float raw_range, float reach, float gain,
                float saturation) {
    check(!bracket.empty(), "a bracket needs a frame");
    const auto& first = std::get<0>(bracket.front());
    check(first.ndim() == 2, "a mosaic has rows and columns");
    const auto height = first.shape(0), width = first.shape(1);
    MergeJob job{{}, nullptr, {std::move(coefficients), raw_range, reach}, gain, saturation,
                 std::size_t(width)};
    for (const auto& [mosaic, dark, exposure, read_variance, stray] : bracket) {
        check_picture(mosaic, height, width);
        check_picture(dark, height, width);
        job.bracket.push_back({mosaic.data(), dark.data(), exposure, read_variance,
                               {stray[0], stray[1], stray[2], stray[3]}});
    }
    if (response) {
        check_picture(*response, height, width);
        job.response = response->data();
    }
    Array<float> value({height, width}), variance({height, width});
    float *values = value.mutable_data(), *variances = variance.mutable_data();
    {
        py::gil_scoped_release unlocked;
        for (py::ssize_t row = 0; row < height; ++row)
            merge_row(job, std::size_t(row), values + row * width, variances + row * width);
    }
    return py::make_tuple(value, variance);
}

// A merged picture on a grid of texels, row by row.
class Texels {
   public:
    Texels(Array<float> value, Array<float> variance, std::array<int, 4> channels,
           std::array<double, 9> rays, std::array<double, 3> camera,
           std::optional<std::array<double, 5>> lens, std::array<double, 3> first_and_pitch,
           std::array<std::size_t, 3> side_and_parts)
        : value_(std::move(value)), variance_(std::move(variance)), side_(side_and_parts[0]) {
        check(value_.ndim() == 2, "a picture has rows and columns");
        check_picture(variance_, value_.shape(0), value_.shape(1));
        check(side_ > 0 && side_and_parts[1] > 0 && side_and_parts[2] > 0, "no texels");
        for (int channel : channels) check(0 <= channel && channel < 3, "no such channel");
        Projection projection{{}, camera[0], camera[1], camera[2], {}, lens.has_value()};
        std::copy(rays.begin(), rays.end(), projection.rays);
        if (lens) std::copy(lens->begin(), lens->end(), projection.lens);
        const auto height = std::size_t(value_.shape(0)), width = std::size_t(value_.shape(1));
        mark(height, width);
        const Picture picture{value_.data(), variance_.data(), odd_.data(), height, width};
        const Lattice lattice{first_and_pitch[0], first_and_pitch[1], first_and_pitch[2], side_,
                              side_and_parts[1], side_and_parts[2]};
        rectifier_ = std::make_unique<Rectifier>(picture, channels.data(), projection, lattice);
    }

    py::tuple rows(std::size_t first, std::size_t last) {
        check(first <= last && last <= side_, "no such rows");
        const std::size_t n = last - first;
        Array<float> value({std::size_t(3), n, side_}), variance({std::size_t(3), n, side_});
        float *values = value.mutable_data(), *variances = variance.mutable_data();
        {
            py::gil_scoped_release unlocked;
            for (std::size_t row = 0; row < n; ++row) {
                float *to[3], *spread[3];
                for (std::size_t k = 0; k < 3; ++k) {
                    to[k] = values + (k * n + row) * side_;
                    spread[k] = variances + (k * n + row) * side_;
                }
                rectifier_->row(first + row, to, spread);
            }
        }
        return py::make_tuple(value, variance);
    }

    // All of it, developed, into tiles: (down, across, tile, tile, 3); beyond the grid they stay.
    void develop(Three rate, Three relative, std::array<float, 9> matrix, const Array<float>& even,
                 Array<float>& brdf, Array<std::uint16_t>& sigma) {
        check_picture(even, py::ssize_t(side_), py::ssize_t(side_));
        check(brdf.ndim() == 5 && sigma.ndim() == 5, "tiles have five axes");
        const std::size_t tile = std::size_t(brdf.shape(2)), tiles = std::size_t(brdf.shape(1));
        for (int axis = 0; axis < 5; ++axis) {
            const auto wanted = axis < 2 ? tiles : axis < 4 ? tile : 3;
            check(std::size_t(brdf.shape(axis)) == wanted && brdf.shape(axis) == sigma.shape(axis),
                  "tiles are squares");
        }
        check(tiles * tile >= side_, "the tiles do not hold the grid");
        Colors colors{};
        std::copy(rate.begin(), rate.end(), colors.rate);
        std::copy(relative.begin(), relative.end(), colors.relative);
        for (int k = 0; k < 9; ++k) colors.squared[k] = (colors.matrix[k] = matrix[k]) * matrix[k];
        float* to = brdf.mutable_data();
        std::uint16_t* spread = sigma.mutable_data();
        py::gil_scoped_release unlocked;
        std::vector<float> room(6 * side_);
        for (std::size_t row = 0; row < side_; ++row) {
            float *values[3], *variances[3];
            for (std::size_t k = 0; k < 3; ++k) {
                values[k] = &room[k * side_];
                variances[k] = &room[(3 + k) * side_];
            }
            rectifier_->row(row, values, variances);
            for (std::size_t column = 0; column < side_; column += tile) {
                const std::size_t n = std::min(tile, side_ - column);
                const std::size_t at =
                    3 * tile * (tile * ((row / tile) * tiles + column / tile) + row % tile);
                float* const part[3] = {values[0] + column, values[1] + column,
                                        values[2] + column};
                float* const noise[3] = {variances[0] + column, variances[1] + column,
                                         variances[2] + column};
                develop_row(colors, n, part, noise, even.data() + row * side_ + column, to + at,
                            spread + at);
            }
        }
    }

   private:
    // Which squares of 4 x 4 pixels have one that is not plain where a texel of theirs may look.
    void mark(std::size_t height, std::size_t width) {
        const std::size_t across = (width + 3) / 4, down = (height + 3) / 4;
        odd_.assign(across * down, 0);
        const float* variance = variance_.data();
        for (std::size_t row = 0; row < height; ++row)
            for (std::size_t column = 0; column < width; ++column) {
                if (std::isfinite(variance[row * width + column])) continue;
                for (std::size_t j = row < 3 ? 0 : (row - 3) / 4; j <= row / 4; ++j)
                    for (std::size_t i = column < 3 ? 0 : (column - 3) / 4; i <= column / 4; ++i)
                        odd_[j * across + i] = 1;
            }
    }

    Array<float> value_, variance_;
    std::size_t side_;
    std::vector<std::uint8_t> odd_;
    std::unique_ptr<Rectifier> rectifier_;
};

}  // namespace

PYBIND11_MODULE(_pixels, module) {
    module.doc() = "Brackets merged and pictures rectified; see gonio/reduce/hdr.py.";
    module.def("merge", &merge, py::arg("bracket"), py::arg("response"), py::arg("coefficients"),
               py::arg("raw_range"), py::arg("reach"), py::arg("gain"), py::arg("saturation"));
    py::class_<Texels>(module, "Texels")
        .def(py::init<Array<float>, Array<float>, std::array<int, 4>, std::array<double, 9>,
                      std::array<double, 3>, std::optional<std::array<double, 5>>,
                      std::array<double, 3>, std::array<std::size_t, 3>>(),
             py::arg("value"), py::arg("variance"), py::arg("channels"), py::arg("rays"),
             py::arg("camera"), py::arg("lens"), py::arg("first_and_pitch"),
             py::arg("side_and_parts"))
        .def("rows", &Texels::rows, py::arg("first"), py::arg("last"))
        .def("develop", &Texels::develop, py::arg("rate"), py::arg("relative"), py::arg("matrix"),
             py::arg("even"), py::arg("brdf").noconvert(), py::arg("sigma").noconvert());
}
