// The trains' part of the query, for each instruction set. See trains.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/evaluate/trains.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include "core/evaluate/coast-inl.h"
#include "core/evaluate/trains-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {

std::size_t AddTrainsFloat(const TrainArgs<float>& args, Chunk<float>& chunk) {
    return args.coast ? AddCoastTrains(args, chunk) : AddTrains(args, chunk);
}
std::size_t AddTrainsDouble(const TrainArgs<double>& args, Chunk<double>& chunk) {
    return args.coast ? AddCoastTrains(args, chunk) : AddTrains(args, chunk);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(AddTrainsFloat);
HWY_EXPORT(AddTrainsDouble);

template <>
std::size_t add_trains(const TrainArgs<float>& args, Chunk<float>& chunk) {
    return HWY_DYNAMIC_DISPATCH(AddTrainsFloat)(args, chunk);
}
template <>
std::size_t add_trains(const TrainArgs<double>& args, Chunk<double>& chunk) {
    return HWY_DYNAMIC_DISPATCH(AddTrainsDouble)(args, chunk);
}

}  // namespace pelagic
#endif
