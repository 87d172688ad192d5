// How many members a plain struct has, so that a table of them can be checked for completeness when it is
// compiled.
#pragma once

#include <cstddef>
#include <utility>

namespace pelagic {

// Converts to any member: never evaluated.
struct AnyMember {
    template <class Member>
    operator Member() const;
};

template <class Struct, std::size_t... Indices>
constexpr bool takes(std::index_sequence<Indices...>) {
    return requires {
        Struct{(static_cast<void>(Indices), AnyMember{})...};
    };
}

// Of an aggregate: the largest number of initialisers that it takes.
template <class Struct, std::size_t kCount = 1>
constexpr std::size_t member_count() {
    if constexpr (takes<Struct>(std::make_index_sequence<kCount>{}))
        return member_count<Struct, kCount + 1>();
    else
        return kCount - 1;
}

}  // namespace pelagic
