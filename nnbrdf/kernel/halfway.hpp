// Inputs made of the half vector, a pair a lane; formulas and order of nnbrdf/halfway.py.
#pragma once

#include "lanes.hpp"

namespace {

// ln of any positive normal number, by its exponent and the logarithm of what is left.
inline Singles full_logarithm(Singles x) {
    const auto bits = reinterpret_cast<const Integers<float>&>(x);
    const auto part = (bits & 0x007fffff) | 0x3f800000;
    const auto exponent = __builtin_convertvector((bits >> 23) - 127, Singles);
    return exponent * 0.693147181f + logarithm(reinterpret_cast<const Singles&>(part));
}

struct Directions {
    Singles lx, ly, lz, vx, vy, vz, half_x, half_y, cos_difference;
};

template <int kPairs>
inline Directions directions_at(const float* from) {
    const auto row = [from](int index) { return at(from + index * kPairs); };
    const Singles sx = row(6), sy = row(7), sz = row(8);
    const Singles length = root(sx * sx + sy * sy + sz * sz);
    const Singles inverse = 1.0f / at_least(length, fill(1e-9f));
    const auto opposite = length <= 1e-9f;
    return {row(0), row(1), row(2), row(3), row(4), row(5),
            opposite ? Singles{} : sx * inverse, opposite ? Singles{} : sy * inverse,
            0.5f * length};
}

// Writes to `inputs`, `stride` floats from one to the next.
class Writer {
   public:
    Writer(float* inputs, int stride) : next_(inputs), stride_(stride) {}
    void operator()(Singles x) {
        at(next_) = x;
        next_ += stride_;
    }

   private:
    float* next_;
    int stride_;
};

inline void cosines(const Directions& d, Writer& write) {
    const Singles light = at_least(d.lz, Singles{}), view = at_least(d.vz, Singles{});
    write(root(light * view));
    write(light + view);
}

inline void isotropic(const Directions& d, Writer& write) {
    const Singles squared = d.half_x * d.half_x + d.half_y * d.half_y;
    write(root(squared));
    cosines(d, write);
    write(d.cos_difference);
    write(0.25f * full_logarithm(squared + 0.01f));
}

inline void anisotropic(const Directions& d, Writer& write) {
    write(d.half_x);
    write(d.half_y);
    cosines(d, write);
    const Singles turned = d.lx * d.vy - d.ly * d.vx;
    write(d.lx * d.vx - d.ly * d.vy);
    write(d.lx * d.vy + d.ly * d.vx);
    write(d.cos_difference);
    write(turned * turned);
}

enum Encoding { kIsotropic, kIsotropicExchange, kAnisotropic, kAnisotropicExchange };

template <int kPairs>
inline void encode(int encoding, const float* directions, float* inputs) {
    for (int lane = 0; lane < kPairs; lane += kWidth<float>) {
        const Directions d = directions_at<kPairs>(directions + lane);
        Writer write(inputs + lane, kPairs);
        if (encoding == kIsotropic || encoding == kIsotropicExchange)
            isotropic(d, write);
        else
            anisotropic(d, write);
        if (encoding == kAnisotropicExchange) {
            write(d.lx - d.vx);
            write(d.ly - d.vy);
        }
        if (encoding == kIsotropicExchange || encoding == kAnisotropicExchange)
            write(d.lz - d.vz);
    }
}

}  // namespace
