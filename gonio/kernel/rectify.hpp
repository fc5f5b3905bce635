// Texels as weighted means of a mosaic's pixels; gonio/photogrammetry/rectification.py says how.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

struct Picture {
    const float *value, *variance;
    const std::uint8_t* odd;  // whether any pixel that a texel here may take is not plain
    std::size_t height, width;
};

// Places on the sample's plane to pixels: a homography, and then the lens.
struct Projection {
    double rays[9];  // (x, y, 1) in mm to across, down and ahead
    double focal, centre_x, centre_y;
    double lens[5];  // k1, k2, p1, p2, k3
    bool distorts;

    void row(const double* x, double y, std::size_t n, double* column, double* line) const;
};

struct Lattice {
    double first_x, first_y, pitch;  // middle of the first texel
    std::size_t side, across, down;  // parts that a texel is cut into
};

// Texels of one row: of each channel values and variances, side numbers each.
class Rectifier {
   public:
    Rectifier(const Picture& picture, const int* channels, const Projection& projection,
              const Lattice& lattice);
    void row(std::size_t row, float* values[3], float* variances[3]);

   private:
    void near(const double* columns, const double* lines, float* values[3], float* variances[3]);
    void wide(const double* columns, const double* lines, std::size_t texel, float* values[3],
              float* variances[3]);

    Picture picture_;
    int channels_[4];
    Projection projection_;
    Lattice lattice_;
    std::vector<double> x_, columns_, lines_;
    std::vector<float> window_;
};
