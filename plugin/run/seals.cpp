#include "plugin/run/seals.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "core/base/instruction_set.h"
#include "plugin/files/checksum.h"
#include "plugin/files/files.h"
#include "plugin/files/read.h"
#include "plugin/format/exr/read.h"
#include "plugin/format/png/png.h"

namespace pelagic {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;  // [bytes] holds any header
constexpr const char* kChecksum = "checksum";
constexpr const char* kName = "file";
constexpr const char* kInstructionSet = "instructionSet";
constexpr const char* kUnknown =
    "is no picture of pelagic render, or an older version's, or its header is damaged";
constexpr const char* kDamaged = "holds other bytes than were written (its checksum differs)";

const std::string& no_digits() {
    static const std::string digits(16, '0');
    return digits;
}

// Where the digits of an EXR's checksum stand.
std::size_t digits_at(std::string_view header) {
    const std::string filled = exr::text_attribute_bytes(kChecksum, no_digits());
    const std::string before = filled.substr(0, filled.size() - no_digits().size());
    const std::size_t found = header.find(before);
    return found == std::string_view::npos || found + filled.size() > header.size() ? std::string::npos
                                                                                    : found + before.size();
}

std::string in_comment(const std::string& set) {
    return ", by " + set + '.';
}

std::string another_name(const std::string& name) {
    return "was written under another name than " + name + ": it was renamed, or changed places with another";
}

std::string exr_problem(const std::filesystem::path& path, CheckProgress& progress) {
    files::FileReader file(path);
    std::string piece(kPiece, '\0');
    piece.resize(file.read(piece));
    progress.add(piece.size());
    if (!file.problem().empty()) return file.problem();
    const std::size_t digits = digits_at(piece);
    if (digits == std::string::npos) return kUnknown;
    const std::string name = path.filename().string(), said = piece.substr(digits, no_digits().size());
    const bool has_its_name = piece.find(exr::text_attribute_bytes(kName, name)) != std::string::npos;
    piece.replace(digits, no_digits().size(), no_digits());
    files::Checksum sum;
    while (!piece.empty()) {
        sum.add(piece);
        piece.resize(kPiece);
        piece.resize(file.read(piece));
        progress.add(piece.size());
    }
    if (!file.problem().empty()) return file.problem();
    if (sum.text() != said) return kDamaged;
    return has_its_name ? "" : another_name(name);
}

std::string png_problem(const std::filesystem::path& path, CheckProgress& progress) {
    std::string bytes;
    const std::string problem = files::read_pieces(path, [&](std::string_view piece) {
        progress.add(piece.size());
        bytes += piece;
    });
    if (!problem.empty()) return problem;
    // The comment stands before the pixels.
    constexpr std::string_view kBegin("Comment\0pelagic ", 16);
    const std::size_t comment = std::string_view(bytes).substr(0, 4096).find(kBegin);
    if (comment == std::string::npos) return kUnknown;
    if (!png::is_whole(bytes)) return kDamaged;
    const std::size_t at = comment + kBegin.size() + no_digits().size() + 1;
    const std::string name = path.filename().string();
    return at <= bytes.size() && bytes.compare(at, name.size(), name) == 0 ? "" : another_name(name);
}

}  // namespace

std::vector<exr::Attribute> seal_attributes(const std::string& name) {
    return {{kInstructionSet, instruction_set()}, {kName, name}, {kChecksum, no_digits()}};
}

void seal(std::string& exr) {
    const std::size_t digits = digits_at(std::string_view(exr).substr(0, kPiece));
    if (digits == std::string::npos) throw std::logic_error("a picture without room for its checksum");
    exr.replace(digits, no_digits().size(), files::checksum_of(exr));
}

std::string png_comment(const std::string& name, const std::string& made_of) {
    return "pelagic " + made_of + ' ' + name + in_comment(instruction_set());
}

bool says_instruction_set(const std::filesystem::path& file, const std::string& set) {
    return files::carries(
        file, file.extension() == ".exr" ? exr::text_attribute_bytes(kInstructionSet, set) : in_comment(set));
}

std::string picture_problem(const std::filesystem::path& file, CheckProgress& progress) {
    return file.extension() == ".png" ? png_problem(file, progress) : exr_problem(file, progress);
}

bool seems_whole(const std::filesystem::path& file, const std::string& made_of) {
    if (!files::carries(file, made_of)) return false;
    // A PNG ends with an empty chunk called IEND and its checksum.
    return file.extension() == ".exr" ? exr::ends_whole(file) : files::carries(file, "IEND\xae\x42\x60\x82");
}

}  // namespace pelagic
