// Arrays from Python, their shapes checked; and functions compiled for old and new processors.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>

namespace py = pybind11;

// the loader picks the version that the processor has; results may differ between processors
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__)
#define MANY_WIDTHS __attribute__((target_clones("arch=haswell", "default")))
#else
#define MANY_WIDTHS
#endif

template <class T>
using Array = py::array_t<T, py::array::c_style>;

inline void check(bool fits, const char* problem) {
    if (!fits) throw std::invalid_argument(problem);
}

template <class T>
void check_picture(const Array<T>& picture, py::ssize_t height, py::ssize_t width) {
    check(picture.ndim() == 2 && picture.shape(0) == height && picture.shape(1) == width,
          "pictures differ in size");
}
