// Records of bakes: read as they are, and, where they are JSON, once more with the checksums that belong to them, so that
// what lies behind these is reached as well.
#include <nlohmann/json.hpp>
#include <string>

#include "plugin/files/checksum.h"
#include "plugin/run/record.h"
#include "tests/fuzz/fuzz.h"

using namespace pelagic;
using fuzz::hold;

namespace {

using Json = nlohmann::ordered_json;

void expect_read(std::string_view text) {
    const fuzz::MemoryFile file(text);
    const RecordReading reading = read_record(file.path(), [](int, const FrameRecord& record) {
        for (const auto& [path, each] : record.files) hold(each.bytes < ~std::uintmax_t{0}, "bytes", path);
    });
    hold(!reading.is_missing && !reading.is_blocked, "the file is there");
    hold(reading.shot.has_value() == reading.problem.empty(), "a shot, or what is wrong", reading.problem);
}

// As record.cpp signs a part.
void sign(const std::string& key, Json& part) {
    if (!part.is_object()) return;
    part.erase("checksum");
    part["checksum"] = files::checksum_of(key + part.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr int kDeepest = 32;  // the JSON library's own dump() and copies are recursive
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    expect_read(text);
    bool is_deep = false;
    const auto watch = [&](int depth, Json::parse_event_t, const Json&) {
        is_deep = is_deep || depth > kDeepest;
        return true;
    };
    Json record = Json::parse(text, watch, false);
    if (is_deep || !record.is_object()) return 0;
    if (const auto frames = record.find("frames"); frames != record.end() && frames->is_object())
        for (auto& [key, part] : frames->items()) sign(key, part);
    Json shot = record;
    shot.erase("frames");
    sign("", shot);
    record["checksum"] = shot["checksum"];
    expect_read(record.dump(-1, ' ', false, Json::error_handler_t::replace));
    return 0;
}
