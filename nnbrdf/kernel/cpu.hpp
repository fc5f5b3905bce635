// Which of the compiled vector widths this machine can run.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

// `Isa` is what a source compiled for every width offers; the widest comes first.
template <class Isa>
std::vector<const Isa*> usable(const Isa& base) {
    return {&base};
}

#ifdef GONIO_X86
template <class Isa>
std::vector<const Isa*> usable(const Isa& base, const Isa* avx2, const Isa* avx512) {
    std::vector<const Isa*> isas;
    const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
        isas.push_back(avx512);
    if (has_avx2) isas.push_back(avx2);
    isas.push_back(&base);
    return isas;
}
#endif

// An empty name stands for the widest.
template <class Isa>
const Isa& isa_named(const std::vector<const Isa*>& isas, const std::string& name) {
    for (const Isa* isa : isas)
        if (name.empty() || name == isa->name) return *isa;
    throw std::invalid_argument("this machine has no vector width " + name);
}
