#include "geometry/vtk_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace geometry::detail {
namespace {

constexpr std::size_t most_bytes = std::size_t(1) << 31;

[[noreturn]] void refuse_truncated() { throw std::runtime_error("is truncated or malformed: an array ends early; export it again"); }

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

// Decodes from `at` until `wanted` bytes are out or padding ends the stream; `at` moves behind what was read.
std::string decode_base64(std::string_view text, std::size_t& at, std::size_t wanted) {
  std::string out;
  while (out.size() < wanted) {
    int digits[4], count = 0, padding = 0;
    while (count < 4) {
      if (at >= text.size()) refuse_truncated();
      const char c = text[at++];
      if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
      if (c == '=') ++padding;
      digits[count] = c == '=' ? 0 : base64_digit(c);
      if (digits[count++] < 0) refuse_truncated();
    }
    const std::uint32_t word = std::uint32_t(digits[0] << 18 | digits[1] << 12 | digits[2] << 6 | digits[3]);
    for (int b = 0; b < 3 - padding; ++b) out.push_back(char(word >> (16 - 8 * b) & 0xff));
    if (padding > 0) break;
  }
  return out;
}

std::uint64_t length_word(std::string_view bytes, std::size_t index, const VtkEncoding& encoding) {
  const auto width = std::size_t(encoding.header_bytes);
  if ((index + 1) * width > bytes.size()) refuse_truncated();
  std::uint64_t value = 0;
  for (std::size_t b = 0; b < width; ++b) {
    const std::size_t place = encoding.big_endian ? width - 1 - b : b;
    value |= std::uint64_t(static_cast<unsigned char>(bytes[index * width + b])) << (8 * place);
  }
  if (value > most_bytes) throw std::runtime_error("is malformed: an array claims " + std::to_string(value) + " bytes; export it again");
  return value;
}

struct Blocks {
  std::size_t count = 0, size = 0, last_size = 0, packed = 0;
  std::vector<std::size_t> packed_sizes;
};

Blocks read_blocks(std::string_view header, const VtkEncoding& encoding) {
  Blocks blocks;
  blocks.count = length_word(header, 0, encoding);
  blocks.size = length_word(header, 1, encoding);
  blocks.last_size = length_word(header, 2, encoding);
  if (blocks.count * blocks.size > most_bytes) refuse_truncated();
  for (std::size_t b = 0; b < blocks.count; ++b) {
    blocks.packed_sizes.push_back(length_word(header, 3 + b, encoding));
    blocks.packed += blocks.packed_sizes.back();
  }
  return blocks;
}

std::string inflate_blocks(std::string_view packed, const Blocks& blocks) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t b = 0; b < blocks.count; ++b) {
    const bool last_partial = b + 1 == blocks.count && blocks.last_size > 0;
    std::string block(last_partial ? blocks.last_size : blocks.size, '\0');
    uLongf size = uLongf(block.size());
    if (at + blocks.packed_sizes[b] > packed.size()) refuse_truncated();
    const auto* source = reinterpret_cast<const Bytef*>(packed.data() + at);
    if (uncompress(reinterpret_cast<Bytef*>(block.data()), &size, source, uLong(blocks.packed_sizes[b])) != Z_OK || size != block.size())
      refuse_truncated();
    out += block;
    at += blocks.packed_sizes[b];
  }
  return out;
}

template <class Number>
void convert(std::string_view bytes, bool big_endian, std::vector<double>& out) {
  out.reserve(bytes.size() / sizeof(Number));
  for (std::size_t at = 0; at + sizeof(Number) <= bytes.size(); at += sizeof(Number)) {
    char raw[sizeof(Number)];
    std::memcpy(raw, bytes.data() + at, sizeof(Number));
    if (big_endian) std::reverse(raw, raw + sizeof(Number));
    Number value;
    std::memcpy(&value, raw, sizeof value);
    out.push_back(double(value));
  }
}

}  // namespace

std::vector<double> values_of(std::string_view bytes, std::string_view type, bool big_endian) {
  std::vector<double> out;
  if (type == "Float32" || type == "float")
    convert<float>(bytes, big_endian, out);
  else if (type == "Float64" || type == "double")
    convert<double>(bytes, big_endian, out);
  else if (type == "Int64" || type == "vtktypeint64" || type == "long")
    convert<std::int64_t>(bytes, big_endian, out);
  else if (type == "UInt64" || type == "unsigned_long")
    convert<std::uint64_t>(bytes, big_endian, out);
  else if (type == "Int32" || type == "int" || type == "vtktypeint32")
    convert<std::int32_t>(bytes, big_endian, out);
  else if (type == "UInt32" || type == "unsigned_int")
    convert<std::uint32_t>(bytes, big_endian, out);
  else if (type == "Int16" || type == "short")
    convert<std::int16_t>(bytes, big_endian, out);
  else if (type == "UInt16" || type == "unsigned_short")
    convert<std::uint16_t>(bytes, big_endian, out);
  else if (type == "Int8" || type == "char")
    convert<std::int8_t>(bytes, big_endian, out);
  else if (type == "UInt8" || type == "unsigned_char")
    convert<std::uint8_t>(bytes, big_endian, out);
  else
    throw std::runtime_error("holds an array of unknown type \"" + std::string(type) + "\"");
  return out;
}

std::vector<double> values_of_text(std::string_view text) {
  const std::string copy(text);  // strtod needs the terminating zero
  std::vector<double> out;
  const char* at = copy.c_str();
  for (;;) {
    char* next = nullptr;
    const double value = std::strtod(at, &next);
    if (next == at) break;
    out.push_back(value);
    at = next;
  }
  while (*at == ' ' || *at == '\n' || *at == '\r' || *at == '\t') ++at;
  if (*at != '\0') throw std::runtime_error("is malformed: \"" + std::string(at, strnlen(at, 12)) + "\" stands where a number should");
  return out;
}

std::string decode_base64_array(std::string_view text, const VtkEncoding& encoding) {
  const auto width = std::size_t(encoding.header_bytes);
  std::size_t at = 0;
  if (encoding.compressed) {
    const std::string count_bytes = decode_base64(text, at, width);
    const std::size_t header_bytes = width * (3 + length_word(count_bytes, 0, encoding));
    at = 0;
    const Blocks blocks = read_blocks(decode_base64(text, at, header_bytes), encoding);
    std::string packed = decode_base64(text, at, blocks.packed);
    return inflate_blocks(packed, blocks);
  }
  std::string bytes = decode_base64(text, at, width);
  const std::size_t size = length_word(bytes, 0, encoding);
  if (bytes.size() == width) {  // some writers encode the length word by itself, with its own padding
    bytes = decode_base64(text, at, size);
  } else {
    at = 0;
    bytes = decode_base64(text, at, width + size).substr(width);
  }
  if (bytes.size() < size) refuse_truncated();
  bytes.resize(size);
  return bytes;
}

std::string decode_raw_array(std::string_view bytes, const VtkEncoding& encoding) {
  const auto width = std::size_t(encoding.header_bytes);
  if (encoding.compressed) {
    const std::size_t header_bytes = width * (3 + length_word(bytes, 0, encoding));
    if (header_bytes > bytes.size()) refuse_truncated();
    const Blocks blocks = read_blocks(bytes.substr(0, header_bytes), encoding);
    return inflate_blocks(bytes.substr(header_bytes), blocks);
  }
  const std::size_t size = length_word(bytes, 0, encoding);
  if (width + size > bytes.size()) refuse_truncated();
  return std::string(bytes.substr(width, size));
}

}  // namespace geometry::detail
