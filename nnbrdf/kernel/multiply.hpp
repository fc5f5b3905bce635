// The one matrix product that forward and backward pass are made of.
#pragma once

#include "vector.hpp"

namespace {

// Element (row, k) of the left factor is data[row * row_stride + k * k_stride].
template <class T>
struct Left {
    const T* data;
    int row_stride, k_stride;
};

// GCC leaves short loops rolled, and an array that a rolled loop indexes goes to memory.
#define GONIO_UNROLL _Pragma("GCC unroll 8")

// c (rows x columns) = left (rows x depth) b (depth x columns); the tile stays in registers.
template <class T, int kRows, int kColumns>
inline void tile(Left<T> left, const T* b, T* c, int depth, int pitch) {
    Vector<T> sums[kRows][kColumns] = {};
    for (int k = 0; k < depth; ++k) {
        Vector<T> row_of_b[kColumns];
        GONIO_UNROLL for (int j = 0; j < kColumns; ++j)
            row_of_b[j] = at(b + k * pitch + j * kWidth<T>);
        GONIO_UNROLL for (int i = 0; i < kRows; ++i) {
            const T a = left.data[i * left.row_stride + k * left.k_stride];
            GONIO_UNROLL for (int j = 0; j < kColumns; ++j) sums[i][j] += a * row_of_b[j];
        }
    }
    GONIO_UNROLL for (int i = 0; i < kRows; ++i)
        GONIO_UNROLL for (int j = 0; j < kColumns; ++j)
            at(c + i * pitch + j * kWidth<T>) = sums[i][j];
}

#if defined(__AVX512F__)
constexpr int kTileRows = 8;  // 8 x 2 sums in 32 registers
#else
constexpr int kTileRows = 4;  // 4 x 2 sums in 16 registers
#endif

// The rows that fill no whole tile.
template <class T, int kColumns, int kRows = kTileRows - 1>
inline void last_rows(Left<T> left, const T* b, T* c, int rows, int depth, int pitch) {
    if constexpr (kRows > 0) {
        if (rows == kRows)
            tile<T, kRows, kColumns>(left, b, c, depth, pitch);
        else
            last_rows<T, kColumns, kRows - 1>(left, b, c, rows, depth, pitch);
    }
}

template <class T, int kColumns>
inline void strip(Left<T> left, const T* b, T* c, int rows, int depth, int pitch) {
    for (; rows >= kTileRows; rows -= kTileRows) {
        tile<T, kTileRows, kColumns>(left, b, c, depth, pitch);
        left.data += kTileRows * left.row_stride;
        c += kTileRows * pitch;
    }
    last_rows<T, kColumns>(left, b, c, rows, depth, pitch);
}

// c (rows x pitch) = left (rows x depth) b (depth x pitch).
template <class T>
void multiply(Left<T> left, const T* b, T* c, int rows, int depth, int pitch) {
    int column = 0;
    for (; column + 2 * kWidth<T> <= pitch; column += 2 * kWidth<T>)
        strip<T, 2>(left, b + column, c + column, rows, depth, pitch);
    if (column < pitch) strip<T, 1>(left, b + column, c + column, rows, depth, pitch);
}

}  // namespace
