// Private to read_vtk: the encodings VTK wraps its arrays in.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace geometry::detail {

struct VtkEncoding {
  bool big_endian = false;
  int header_bytes = 4;     // of a length word: 4 or 8
  bool compressed = false;  // zlib blocks
};

// One value of VTK type "Float32", "Int64", ... at each position, as double (exact for the integers that index a mesh).
std::vector<double> values_of(std::string_view bytes, std::string_view type, bool big_endian);

// Numbers as text, blank-separated.
std::vector<double> values_of_text(std::string_view text);

// An array's bytes from where its length word begins. Both throw std::runtime_error when the text ends early or is not what it claims.
std::string decode_base64_array(std::string_view text, const VtkEncoding& encoding);
std::string decode_raw_array(std::string_view bytes, const VtkEncoding& encoding);

}  // namespace geometry::detail
