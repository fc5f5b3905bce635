// Python's side of the evaluation: checks shapes, packs the weights, picks the vector width.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "cpu.hpp"
#include "evaluate.hpp"
#include "state.hpp"

namespace py = pybind11;

extern const EvaluateIsa kEvaluate_base;
#ifdef GONIO_X86
extern const EvaluateIsa kEvaluate_avx2;
extern const EvaluateIsa kEvaluate_avx512;
#endif

namespace {

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
template <class T>
using Rows = py::array_t<T, py::array::c_style>;

std::vector<const EvaluateIsa*> usable_isas() {
#ifdef GONIO_X86
    return usable(kEvaluate_base, &kEvaluate_avx2, &kEvaluate_avx512);
#else
    return usable(kEvaluate_base);
#endif
}

struct alignas(64) Line {
    float values[16];
};

// The weights as the kernel reads them: inputs down, outputs across, the bias last. All hidden
// signals are `scale` times what they are.
class Packed {
   public:
    Packed(const std::vector<Floats>& layers, int inputs, double scale) : sizes_{inputs} {
        for (const Floats& layer : layers) {
            const double to = &layer == &layers.back() ? 1 : scale;
            const double from = &layer == &layers.front() ? 1 : scale;
            if (layer.ndim() != 2 || layer.shape(0) < 1 || layer.shape(1) != sizes_.back() + 1)
                throw std::invalid_argument("the layers do not fit together, or the inputs");
            const int outputs = int(layer.shape(0)), rows = int(layer.shape(1));
            std::vector<float> turned(std::size_t(outputs) * rows);
            for (int out = 0; out < outputs; ++out)
                for (int in = 0; in < rows; ++in)
                    turned[in * outputs + out] =
                        float(layer.at(out, in) * (in == rows - 1 ? to : to / from));
            weights_.push_back(std::move(turned));
            pointers_.push_back(weights_.back().data());
            sizes_.push_back(outputs);
        }
        if (layers.empty() || (sizes_.back() != 1 && sizes_.back() != kChannels))
            throw std::invalid_argument("a network ends with one output or three");
    }
    void fill(Network& network) const {
        network.layers = int(weights_.size());
        network.sizes = sizes_.data();
        network.weights = pointers_.data();
    }
    int widest() const { return *std::max_element(sizes_.begin(), sizes_.end()); }

   private:
    std::vector<int> sizes_;
    std::vector<std::vector<float>> weights_;
    std::vector<const float*> pointers_;
};

constexpr int kInputs[kEncodingCount] = {5, 6, 8, 11};

void check_numbers(int activation, int encoding) {
    if (activation < 0 || activation >= kActivationCount)
        throw std::invalid_argument("there is no activation " + std::to_string(activation));
    if (encoding < 0 || encoding >= kEncodingCount)
        throw std::invalid_argument("there is no encoding " + std::to_string(encoding));
}

template <class T>
void check_rows(const Rows<T>& rows, std::int64_t pairs) {
    if (rows.ndim() != 2 || rows.shape(0) != pairs || rows.shape(1) != 3)
        throw std::invalid_argument("light, view and values must have one shape (n, 3)");
}

template <class T>
void evaluate(const std::vector<Floats>& layers, int activation, int encoding, float scale,
              float offset, const std::array<float, kChannels>& tint, const Rows<T>& light,
              const Rows<T>& view, Rows<T>& values, const std::string& name) {
    const EvaluateIsa& isa = isa_named(usable_isas(), name);
    check_numbers(activation, encoding);
    const std::int64_t pairs = values.ndim() == 2 ? values.shape(0) : -1;
    for (const Rows<T>* rows : {&light, &view, static_cast<const Rows<T>*>(&values)})
        check_rows(*rows, pairs);
    const Packed packed(layers, kInputs[encoding], activation == kGelu ? kGeluScale : 1);
    Network network{};
    packed.fill(network);
    network.activation = activation;
    network.encoding = encoding;
    network.scale = scale;
    network.offset = offset;
    std::copy(tint.begin(), tint.end(), network.tint);
    const int signal_size = packed.widest() * kVectors * isa.bytes / int(sizeof(float));
    std::vector<Line> scratch(2 * std::size_t(signal_size) / 16 + 1);
    const T *from = light.data(), *to = view.data();
    T* const told = values.mutable_data();
    py::gil_scoped_release unlocked;
    if constexpr (sizeof(T) == sizeof(float))
        isa.single(network, from, to, pairs, told, scratch.data()->values, signal_size);
    else
        isa.twice(network, from, to, pairs, told, scratch.data()->values, signal_size);
}

template <class T>
void offer(py::module_& module, const char* name) {
    module.def(name, &evaluate<T>, py::arg("layers"), py::arg("activation"), py::arg("encoding"),
               py::arg("scale"), py::arg("offset"), py::arg("tint"), py::arg("light").noconvert(),
               py::arg("view").noconvert(), py::arg("values").noconvert(), py::arg("isa") = "");
}

}  // namespace

PYBIND11_MODULE(_evaluate, module) {
    module.doc() = "One small network at pairs of directions; see nnbrdf/evaluate.py.";
    offer<float>(module, "evaluate32");
    offer<double>(module, "evaluate64");
    module.def("isas", [] {
        std::vector<std::string> names;
        for (const EvaluateIsa* isa : usable_isas()) names.emplace_back(isa->name);
        return names;
    });
}
