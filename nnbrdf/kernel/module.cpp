// Python's side of the fused trainer: owns the memory, checks shapes, picks the vector width.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "cpu.hpp"
#include "state.hpp"

namespace py = pybind11;

extern const Isa kIsa_base;
#ifdef GONIO_X86
extern const Isa kIsa_avx2;
extern const Isa kIsa_avx512;
#endif

namespace {

constexpr std::align_val_t kAlignment{64};

template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

std::vector<const Isa*> usable_isas() {
#ifdef GONIO_X86
    return usable(kIsa_base, &kIsa_avx2, &kIsa_avx512);
#else
    return usable(kIsa_base);
#endif
}

template <class T>
const Functions<T>& functions_of(const Isa& isa) {
    if constexpr (sizeof(T) == sizeof(float))
        return isa.single;
    else
        return isa.twice;
}

int checked_activation(int number) {
    if (number < 0 || number >= kActivationCount)
        throw std::invalid_argument("there is no activation " + std::to_string(number));
    return number;
}

template <class T>
class Buffer {
   public:
    Buffer() = default;
    explicit Buffer(std::int64_t size)
        : data_(static_cast<T*>(::operator new(sizeof(T) * std::max<std::int64_t>(size, 1),
                                               kAlignment))) {
        std::fill_n(data_.get(), size, T{});
    }
    T* get() const { return data_.get(); }

   private:
    struct Free {
        void operator()(T* data) const { ::operator delete(data, kAlignment); }
    };
    std::unique_ptr<T, Free> data_;
};

template <class T>
class Trainer {
   public:
    Trainer(const std::vector<Array<T>>& layers, int activation, const Array<T>& inputs,
            const Array<T>& targets, std::uint64_t seed, double rate, const std::string& isa)
        : isa_(isa_named(usable_isas(), isa)), state_{} {
        take_sizes(layers);
        state_.activation = checked_activation(activation);
        state_.seed = state_.random = seed;
        state_.rate = rate;
        state_.decay = 1;
        take_samples(inputs, targets);
        take_weights(layers);
        make_signals();
    }
    Trainer(const Trainer&) = delete;
    Trainer& operator=(const Trainer&) = delete;

    std::int64_t run(std::int64_t steps) {
        py::gil_scoped_release unlocked;
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!state_.failed && steps > 0) functions_of<T>(isa_).run(state_, steps);
        return state_.step;
    }

    Array<T> predict(const Array<T>& inputs) {
        if (inputs.ndim() != 2 || inputs.shape(1) != state_.sizes[0])
            throw std::invalid_argument("inputs must have shape (rows, " +
                                        std::to_string(state_.sizes[0]) + ")");
        const std::int64_t rows = inputs.shape(0);
        const Buffer<T> padded = pad(inputs, state_.pitch[0], true);
        Array<T> outputs({rows, std::int64_t(state_.sizes[state_.layers])});
        T* const data = outputs.mutable_data();
        py::gil_scoped_release unlocked;
        const std::lock_guard<std::mutex> lock(mutex_);
        functions_of<T>(isa_).predict(state_, padded.get(), rows, data);
        return outputs;
    }

    std::vector<Array<T>> gradient(const Array<std::uint32_t>& samples) {
        if (samples.ndim() != 1 || samples.size() < 1 || samples.size() > kBatch)
            throw std::invalid_argument("a batch has 1 to 32 samples");
        for (std::int64_t i = 0; i < samples.size(); ++i)
            if (samples.data()[i] >= state_.samples)
                throw std::invalid_argument("there is no such sample");
        const auto lock = held();
        functions_of<T>(isa_).gradient(state_, samples.data(), int(samples.size()));
        return read(state_.gradients);
    }

    std::vector<Array<T>> layers() const {
        const auto lock = held();
        return read(state_.weights);
    }

    std::int64_t step() const {
        const auto lock = held();
        return state_.step;
    }

    bool failed() const {
        const auto lock = held();
        return state_.failed;
    }

    Array<std::uint32_t> order() const {
        const auto lock = held();
        return Array<std::uint32_t>(state_.samples, state_.order);
    }

   private:
    // nobody waits for the state with the GIL in hand: who has the state may want the GIL
    std::unique_lock<std::mutex> held() const {
        py::gil_scoped_release unlocked;
        return std::unique_lock<std::mutex>(mutex_);
    }

    int width() const { return isa_.bytes / int(sizeof(T)); }

    void take_sizes(const std::vector<Array<T>>& layers) {
        if (layers.empty() || layers.size() > kMostLayers)
            throw std::invalid_argument("a network has 1 to 8 layers");
        state_.layers = int(layers.size());
        for (int i = 0; i < state_.layers; ++i) {
            const auto& layer = layers[i];
            if (layer.ndim() != 2 || layer.shape(1) < 2 || layer.shape(0) < 1 ||
                (i > 0 && layer.shape(1) != state_.sizes[i] + 1))
                throw std::invalid_argument("the layers do not fit together");
            state_.sizes[i] = int(layer.shape(1)) - 1;
            state_.sizes[i + 1] = int(layer.shape(0));
        }
        // one more than the features: the column of ones
        for (int i = 0; i <= state_.layers; ++i)
            state_.pitch[i] = (state_.sizes[i] / width() + 1) * width();
    }

    void take_samples(const Array<T>& inputs, const Array<T>& targets) {
        if (inputs.ndim() != 2 || targets.ndim() != 2 || inputs.shape(0) != targets.shape(0) ||
            inputs.shape(0) < 1 || inputs.shape(1) != state_.sizes[0] ||
            targets.shape(1) != state_.sizes[state_.layers])
            throw std::invalid_argument("inputs and targets do not fit the layers");
        state_.samples = inputs.shape(0);
        inputs_ = pad(inputs, state_.pitch[0], true);
        targets_ = pad(targets, state_.pitch[state_.layers], false);
        state_.inputs = inputs_.get();
        state_.targets = targets_.get();
        order_ = Buffer<std::uint32_t>(state_.samples);
        state_.order = order_.get();
        for (std::int64_t i = 0; i < state_.samples; ++i) state_.order[i] = std::uint32_t(i);
    }

    void take_weights(const std::vector<Array<T>>& layers) {
        for (int i = 0; i < state_.layers; ++i)
            state_.count += std::int64_t(state_.sizes[i] + 1) * state_.pitch[i + 1];
        T** const runs[] = {&state_.all_weights, &state_.all_gradients, &state_.mean,
                            &state_.norm};
        for (T** run : runs) *run = buffer(state_.count);
        std::int64_t start = 0;
        for (int i = 0; i < state_.layers; ++i) {
            state_.weights[i] = state_.all_weights + start;
            state_.gradients[i] = state_.all_gradients + start;
            state_.transposed[i] = buffer(std::int64_t(state_.sizes[i + 1]) * state_.pitch[i]);
            start += std::int64_t(state_.sizes[i] + 1) * state_.pitch[i + 1];
            for (int out = 0; out < state_.sizes[i + 1]; ++out)
                for (int in = 0; in <= state_.sizes[i]; ++in)
                    state_.weights[i][in * state_.pitch[i + 1] + out] = layers[i].at(out, in);
        }
    }

    void make_signals() {
        for (int i = 0; i <= state_.layers; ++i) {
            const std::int64_t size = std::int64_t(kBatch) * state_.pitch[i];
            state_.signals[i] = buffer(size);
            state_.slopes[i] = buffer(size);
            state_.errors[i] = buffer(size);
        }
        state_.wanted = buffer(std::int64_t(kBatch) * state_.pitch[state_.layers]);
    }

    T* buffer(std::int64_t size) {
        buffers_.emplace_back(size);
        return buffers_.back().get();
    }

    static Buffer<T> pad(const Array<T>& rows, int pitch, bool ones) {
        const std::int64_t features = rows.shape(1);
        Buffer<T> padded(rows.shape(0) * pitch);
        for (std::int64_t row = 0; row < rows.shape(0); ++row) {
            T* const to = padded.get() + row * pitch;
            std::copy_n(rows.data() + row * features, features, to);
            if (ones) to[features] = 1;
        }
        return padded;
    }

    std::vector<Array<T>> read(T* const* matrices) const {
        std::vector<Array<T>> layers;
        for (int i = 0; i < state_.layers; ++i) {
            const int inputs = state_.sizes[i] + 1, outputs = state_.sizes[i + 1];
            Array<T> layer({outputs, inputs});
            for (int out = 0; out < outputs; ++out)
                for (int in = 0; in < inputs; ++in)
                    layer.mutable_at(out, in) = matrices[i][in * state_.pitch[i + 1] + out];
            layers.push_back(std::move(layer));
        }
        return layers;
    }

    const Isa& isa_;
    mutable std::mutex mutex_;  // one thread at a time has the state
    State<T> state_;
    Buffer<T> inputs_, targets_;
    Buffer<std::uint32_t> order_;
    std::vector<Buffer<T>> buffers_;
};

template <class T>
py::tuple activate(int activation, const Array<T>& totals, const std::string& name) {
    const Isa& isa = isa_named(usable_isas(), name);
    if (totals.ndim() != 2) throw std::invalid_argument("totals must have shape (rows, features)");
    const int rows = int(totals.shape(0)), features = int(totals.shape(1));
    const int width = isa.bytes / int(sizeof(T)), pitch = (features + width - 1) / width * width;
    const Buffer<T> values(std::int64_t(rows) * pitch), slopes(std::int64_t(rows) * pitch);
    for (int row = 0; row < rows; ++row)
        std::copy_n(totals.data() + row * features, features, values.get() + row * pitch);
    functions_of<T>(isa).activate(checked_activation(activation), values.get(), slopes.get(), rows, features, pitch);
    Array<T> value({rows, features}), slope({rows, features});
    for (int row = 0; row < rows; ++row) {
        std::copy_n(values.get() + row * pitch, features, value.mutable_data(row, 0));
        std::copy_n(slopes.get() + row * pitch, features, slope.mutable_data(row, 0));
    }
    return py::make_tuple(value, slope);
}

template <class T>
void offer(py::module_& module, const char* trainer, const char* activation) {
    using Self = Trainer<T>;
    py::class_<Self>(module, trainer)
        .def(py::init<const std::vector<Array<T>>&, int, const Array<T>&, const Array<T>&,
                      std::uint64_t, double, const std::string&>(),
             py::arg("layers"), py::arg("activation"), py::arg("inputs"), py::arg("targets"),
             py::arg("seed"), py::arg("rate"), py::arg("isa") = "")
        .def("run", &Self::run)
        .def("predict", &Self::predict)
        .def("gradient", &Self::gradient)
        .def_property_readonly("layers", &Self::layers)
        .def_property_readonly("order", &Self::order)
        .def_property_readonly("step", &Self::step)
        .def_property_readonly("failed", &Self::failed);
    module.def(activation, &activate<T>, py::arg("activation"), py::arg("totals"),
               py::arg("isa") = "");
}

}  // namespace

PYBIND11_MODULE(_fused, module) {
    module.doc() = "Training of one small network, fused; see nnbrdf/fused.py.";
    offer<float>(module, "Trainer32", "activate32");
    offer<double>(module, "Trainer64", "activate64");
    module.def("isas", [] {
        std::vector<std::string> names;
        for (const Isa* isa : usable_isas()) names.emplace_back(isa->name);
        return names;
    });
}
